#include <math.h>
#include <stdint.h>

uint64_t sum;
static uint64_t seed = 12345;
int32_t ring[128], samples[64], sorted[64], queue[100];
static int32_t next;
double a[12][12], b[12][12], c[12][12];
uint32_t bins[16];
uint8_t bytes[256];

void scan(int64_t now)
{
    (void)now;
    for (int i = 0; i < 64; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        samples[i] = (int32_t)(seed / 4294967296u % 100000);
    }

    ring[next] = samples[0];
    next = (next + 1) % 128;
    int32_t average = 0;
    for (int i = 0; i < 128; i++)
        average += ring[i];
    average /= 128;

    for (int i = 0; i < 64; i++) {
        int32_t key = samples[i];
        int j = i - 1;
        while (j >= 0 && sorted[j] > key) {
            sorted[j + 1] = sorted[j];
            j--;
        }
        sorted[j + 1] = key;
    }

    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++) {
            a[i][j] = samples[i + j];
            b[i][j] = samples[63 - i - j];
        }
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < 12; j++) {
            double cell = 0.0;
            for (int k = 0; k < 12; k++)
                cell += a[i][k] * b[k][j];
            c[i][j] = cell;
        }

    for (int i = 0; i < 64; i++)
        bins[samples[i] % 16]++;

    for (int i = 0; i < 256; i++)
        bytes[i] = (uint8_t)(samples[i % 64] + i);
    uint16_t crc = 0xffff;
    for (int i = 0; i < 256; i++) {
        crc ^= bytes[i];
        for (int j = 0; j < 8; j++)
            crc = crc & 1 ? crc >> 1 ^ 0xa001 : crc >> 1;
    }

    for (int i = 99; i >= 1; i--)
        queue[i] = queue[i - 1];
    queue[0] = average;

    sum = sum * 31 + (uint64_t)(sorted[0] + sorted[31] + sorted[63]);
    sum = sum * 31 + (uint64_t)queue[99] + crc + bins[7];
    sum = sum * 31 + (uint64_t)nearbyint(c[3][5] + c[11][11]);
}
