#include <math.h>
#include <stdbool.h>
#include <stdint.h>

struct filter { double u, y, x1, x2; };
struct pid { double setpoint, actual, kp, ki, kd, out; bool saturated; double integral, last, derivative; };
struct rate { double u, limit, y; };

uint64_t sum;
static uint64_t seed = 12345;
struct filter filters[16];
struct pid loops[16];
struct rate rates[16];
double plant[16];
static uint64_t saturated;

static void filter(struct filter *f)
{
    f->x1 = f->x1 + 0.25 * (f->u - f->x1);
    f->x2 = f->x2 + 0.25 * (f->x1 - f->x2);
    f->y = f->x2;
}

static void pid(struct pid *p)
{
    double error = p->setpoint - p->actual;
    p->derivative = 0.8 * p->derivative + 0.2 * (error - p->last) / 0.01;
    double raw = p->kp * error + p->integral + p->kd * p->derivative;
    if (raw > 100.0) {
        p->out = 100.0;
        p->saturated = true;
    } else if (raw < -100.0) {
        p->out = -100.0;
        p->saturated = true;
    } else {
        p->out = raw;
        p->saturated = false;
        p->integral = p->integral + p->ki * error * 0.01;
    }
    p->last = error;
}

static void rate(struct rate *r)
{
    double change = r->u - r->y;
    if (fabs(change) > r->limit)
        change = change > 0.0 ? r->limit : -r->limit;
    r->y = r->y + change;
}

void scan(int64_t now)
{
    (void)now;
    for (int i = 0; i < 16; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        double setpoint = (double)(seed / 4294967296u % 1000) / 10.0;
        filters[i].u = plant[i];
        filter(&filters[i]);
        loops[i].setpoint = setpoint;
        loops[i].actual = filters[i].y;
        loops[i].kp = 2.0;
        loops[i].ki = 0.5;
        loops[i].kd = 0.02;
        pid(&loops[i]);
        rates[i].u = loops[i].out;
        rates[i].limit = 5.0;
        rate(&rates[i]);
        plant[i] = plant[i] + 0.01 * (rates[i].y * 0.7 - plant[i]);
        if (loops[i].saturated)
            saturated++;
    }
    /* LREAL_TO_ULINT rounds to nearest even and saturates. */
    for (int i = 0; i < 16; i++)
        sum = sum * 31 + (uint64_t)nearbyint(fabs(plant[i]) * 1000000.0);
    sum = sum + saturated;
}
