/* Runs a program's scans and says how long they took: nanoseconds, then the final checksum. */
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void scan(int64_t now_ns);
extern uint64_t sum;

int main(int count, char **arguments)
{
    long scans = count > 1 ? atol(arguments[1]) : 0;
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (long n = 1; n <= scans; n++)
        scan(n * 10000000);
    clock_gettime(CLOCK_MONOTONIC, &end);
    int64_t ns = (end.tv_sec - begin.tv_sec) * INT64_C(1000000000) + (end.tv_nsec - begin.tv_nsec);
    printf("%" PRId64 " %" PRIu64 "\n", ns, sum);
    return 0;
}
