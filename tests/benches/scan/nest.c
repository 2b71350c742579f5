#include <stdbool.h>
#include <stdint.h>

uint64_t sum;
static uint64_t seed = 12345;

struct level10 { int32_t x; bool enable; int32_t y, state, count; };

static void level10(struct level10 *l)
{
    l->state = l->state + l->x / 12;
    if (l->enable)
        l->count++;
    l->y = l->state / 2 + l->count;
}

struct level9 { int32_t x; bool enable; int32_t y, state, count; struct level10 inner; };

static void level9(struct level9 *l)
{
    l->state = l->state + l->x / 11;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level10(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 12;
}

struct level8 { int32_t x; bool enable; int32_t y, state, count; struct level9 inner; };

static void level8(struct level8 *l)
{
    l->state = l->state + l->x / 10;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level9(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 11;
}

struct level7 { int32_t x; bool enable; int32_t y, state, count; struct level8 inner; };

static void level7(struct level7 *l)
{
    l->state = l->state + l->x / 9;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level8(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 10;
}

struct level6 { int32_t x; bool enable; int32_t y, state, count; struct level7 inner; };

static void level6(struct level6 *l)
{
    l->state = l->state + l->x / 8;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level7(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 9;
}

struct level5 { int32_t x; bool enable; int32_t y, state, count; struct level6 inner; };

static void level5(struct level5 *l)
{
    l->state = l->state + l->x / 7;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level6(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 8;
}

struct level4 { int32_t x; bool enable; int32_t y, state, count; struct level5 inner; };

static void level4(struct level4 *l)
{
    l->state = l->state + l->x / 6;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level5(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 7;
}

struct level3 { int32_t x; bool enable; int32_t y, state, count; struct level4 inner; };

static void level3(struct level3 *l)
{
    l->state = l->state + l->x / 5;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level4(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 6;
}

struct level2 { int32_t x; bool enable; int32_t y, state, count; struct level3 inner; };

static void level2(struct level2 *l)
{
    l->state = l->state + l->x / 4;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level3(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 5;
}

struct level1 { int32_t x; bool enable; int32_t y, state, count; struct level2 inner; };

static void level1(struct level1 *l)
{
    l->state = l->state + l->x / 3;
    l->inner.x = l->state - l->y;
    l->inner.enable = l->enable && l->state > 0;
    level2(&l->inner);
    if (l->enable)
        l->count++;
    l->y = (l->inner.y + l->state) / 2 + l->count % 4;
}

struct level1 units[100];

void scan(int64_t now)
{
    (void)now;
    for (int i = 0; i < 100; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        units[i].x = (int32_t)(seed / 4294967296u % 2000) - 1000;
        units[i].enable = seed > 0x8000000000000000u;
        level1(&units[i]);
        sum = sum * 31 + (uint64_t)(int64_t)units[i].y;
    }
}
