#include <stdbool.h>
#include <stdint.h>

/* 2nd ed. 2.5.2.3.4; times in nanoseconds. */
struct timer { bool in; int64_t pt; bool q; int64_t et; bool m, running; int64_t since; };

static void ton(struct timer *t, int64_t now)
{
    if (!t->in) {
        t->q = false;
        t->et = 0;
    } else {
        if (!t->m)
            t->since = now;
        if (!t->q)
            t->et = now - t->since;
        if (t->et >= t->pt) {
            t->q = true;
            t->et = t->pt;
        }
    }
    t->m = t->in;
}

static void tof(struct timer *t, int64_t now)
{
    if (t->in) {
        t->q = true;
        t->et = 0;
    } else {
        if (t->m)
            t->since = now;
        if (t->q) {
            t->et = now - t->since;
            if (t->et >= t->pt) {
                t->q = false;
                t->et = t->pt;
            }
        }
    }
    t->m = t->in;
}

static void tp(struct timer *t, int64_t now)
{
    if (t->in && !t->m && !t->running) {
        t->running = true;
        t->since = now;
        t->q = true;
    }
    if (t->running) {
        t->et = now - t->since;
        if (t->et >= t->pt) {
            t->q = false;
            t->running = false;
            t->et = t->pt;
        }
    }
    if (!t->running && !t->in)
        t->et = 0;
    t->m = t->in;
}
