/* Scans programs that MatIEC compiled, with the inputs of a trace, and writes the same trace with its own outputs.
 *
 * `table.h` is made for each batch: the programs, and where their variables lie. A program that crashes or does not end
 * takes no other with it.
 */
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "iec_std_lib.h"
#include "POUS.h"

TIME __CURRENT_TIME;
BOOL __DEBUG;
void config_init__(void);

#define PERIOD_NS 10000000
#define LONGEST_S 10
#define LINE 65536

enum kind { NUMBER, DURATION, TEXT };

struct place {
    void *at;
    enum kind kind;
    /* bytes of a number */
    int size;
};

struct program {
    const char *name;
    void (*body)(void *);
    void *data;
    const struct place *inputs;
    int input_count;
    const struct place *outputs;
    int output_count;
};

#include "table.h"

/* The n-th scan is at n periods, the first at one. */
static void set_time(int scan) {
    int64_t ns = (int64_t)scan * PERIOD_NS;
    __CURRENT_TIME.tv_sec = ns / 1000000000;
    __CURRENT_TIME.tv_nsec = ns % 1000000000;
}

static void take(const struct place *place, const char *digits) {
    if (place->kind == TEXT) {
        STRING *text = place->at;
        memset(text, 0, sizeof *text);
        for (; digits[0] && digits[1]; digits += 2) {
            unsigned character;
            sscanf(digits, "%2x", &character);
            text->body[text->len++] = (uint8_t)character;
        }
        return;
    }
    uint64_t value = strtoull(digits, NULL, 16);
    if (place->kind == DURATION) {
        TIME *time = place->at;
        time->tv_sec = (int64_t)value / 1000000000;
        time->tv_nsec = (int64_t)value % 1000000000;
        return;
    }
    memcpy(place->at, &value, place->size);
}

static void give(FILE *file, const struct place *place) {
    if (place->kind == TEXT) {
        const STRING *text = place->at;
        for (int at = 0; at < text->len; at++) fprintf(file, "%02x", text->body[at]);
        return;
    }
    uint64_t value = 0;
    int size = place->size;
    if (place->kind == DURATION) {
        const TIME *time = place->at;
        value = (uint64_t)((int64_t)time->tv_sec * 1000000000 + time->tv_nsec);
        size = 8;
    } else {
        memcpy(&value, place->at, size);
    }
    fprintf(file, "%0*llx", size * 2, (unsigned long long)value);
}

/* Cells are divided by `;`, and may be empty. */
static void run(const struct program *program) {
    static char line[LINE], name[256];
    snprintf(name, sizeof name, "%s.trace", program->name);
    FILE *in = fopen(name, "r");
    snprintf(name, sizeof name, "%s.peer", program->name);
    FILE *out = fopen(name, "w");
    if (!in || !out || !fgets(line, LINE, in)) exit(2);
    fputs(line, out);
    for (int scan = 1; fgets(line, LINE, in) && strncmp(line, "fault", 5) != 0; scan++) {
        char *rest = line;
        for (int at = 0; at < program->input_count; at++) {
            char *cell = strsep(&rest, ";\n");
            fprintf(out, "%s;", cell);
            take(&program->inputs[at], cell);
        }
        set_time(scan);
        program->body(program->data);
        for (int at = 0; at < program->output_count; at++) {
            if (at) fputc(';', out);
            give(out, &program->outputs[at]);
        }
        fputc('\n', out);
        fflush(out);
    }
}

int main(void) {
    /* So that no time passes before the first scan. */
    set_time(1);
    config_init__();
    for (unsigned at = 0; at < sizeof programs / sizeof *programs; at++) {
        fflush(NULL);
        pid_t child = fork();
        if (child == 0) {
            alarm(LONGEST_S);
            run(&programs[at]);
            exit(0);
        }
        int status;
        waitpid(child, &status, 0);
        if (WIFSIGNALED(status)) printf("%s %s\n", programs[at].name, strsignal(WTERMSIG(status)));
    }
    return 0;
}
