#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 81 };

uint64_t sum;
static uint64_t seed = 12345;
char telegram[SIZE], head[SIZE], body[SIZE], field[SIZE], best[SIZE], rest[SIZE];

/* Position from 1, 0 if it is not there. */
static int find(const char *whole, const char *part)
{
    const char *found = strstr(whole, part);
    return found ? (int)(found - whole) + 1 : 0;
}

static void append(char *target, const char *more)
{
    size_t used = strlen(target), count = strlen(more);
    if (count > SIZE - 1 - used)
        count = SIZE - 1 - used;
    memcpy(target + used, more, count);
    target[used + count] = 0;
}

static void middle(char *target, const char *source, int length, int position)
{
    int used = (int)strlen(source);
    if (position < 1 || position > used || length < 0)
        length = 0, position = 1;
    if (length > used - position + 1)
        length = used - position + 1;
    memcpy(target, source + position - 1, length);
    target[length] = 0;
}

/* Takes `length` characters away at `position` and puts `part` there. */
static void replace(char *text, const char *part, int length, int position)
{
    char made[SIZE];
    int used = (int)strlen(text);
    if (position < 1 || position > used + 1)
        return;
    memcpy(made, text, position - 1);
    made[position - 1] = 0;
    append(made, part);
    if (position - 1 + length < used)
        append(made, text + position - 1 + length);
    strcpy(text, made);
}

void scan(int64_t now)
{
    (void)now;
    best[0] = 0;
    for (int i = 0; i < 20; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        int32_t value = (int32_t)(seed / 4294967296u % 100000);

        snprintf(body, sizeof body, "%d", value);
        snprintf(head, sizeof head, "AXIS:%d", i);
        strcpy(telegram, head);
        append(telegram, ";POS=");
        append(telegram, body);
        append(telegram, ";STATE=RUNNING;END");

        int at = find(telegram, "POS=");
        middle(field, telegram, 20, at + 4);
        int n = find(field, ";");
        field[n - 1] = 0;
        int32_t read = atoi(field);

        replace(telegram, "STOPPED", 7, find(telegram, "RUNNING"));
        replace(telegram, "", 5, 1);
        replace(telegram, "X", 0, 1);
        if (strcmp(telegram, best) > 0)
            strcpy(best, telegram);
        if (strcmp(field, body) == 0)
            sum = sum + 1;

        sum = sum * 31 + (uint64_t)read + strlen(telegram) + (uint64_t)find(best, ";");
        size_t used = strlen(telegram), wanted = (size_t)(value % 40);
        strcpy(rest, telegram + (wanted < used ? used - wanted : 0));
        sum = sum * 31 + strlen(rest);
    }
}
