/* Integers as a target with registers of 64 or 32 bits computes them, written from the manuals of CODESYS and TwinCAT (operators,
   overflow and underflow in the data type) and apart from the compiler. Reads an expression per line in prefix form, prints
   its value as LINT, or `fault` where it divides by zero. A line begins with the bits of the registers; what has 64 bits
   takes two of 32.

   i8:-5 u16:7 b32:9   a variable of a signed, unsigned, bit string type of so many bits
   + - * / %           of two operands
   ~                   the sign
   < > =               1 or 0
   min max abs
   !i16 ...            a conversion, which cuts
*/
#include <inttypes.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char kind; /* of the static type: i, u, b */
    int bits;
    uint64_t held; /* of the register */
} Value;

static jmp_buf fault;
static int width; /* bits of a register */

static uint64_t cut(uint64_t held, char kind, int bits) {
    if (bits == 64) return held;
    uint64_t low = held & ((UINT64_C(1) << bits) - 1);
    int negative = kind == 'i' && (low >> (bits - 1)) & 1;
    return negative ? low | ~((UINT64_C(1) << bits) - 1) : low;
}

static Value common(Value a, Value b) {
    if (a.kind == b.kind) return (Value){a.kind, a.bits > b.bits ? a.bits : b.bits, 0};
    char plain_a = a.kind == 'b' ? 'u' : a.kind, plain_b = b.kind == 'b' ? 'u' : b.kind;
    if (plain_a == plain_b) return (Value){plain_a, a.bits > b.bits ? a.bits : b.bits, 0};
    int signed_bits = plain_a == 'i' ? a.bits : b.bits, other = plain_a == 'i' ? b.bits : a.bits;
    if (signed_bits > other) return (Value){'i', signed_bits, 0};
    if (other == 64) return (Value){'u', 64, 0};
    return (Value){'i', other * 2, 0};
}

/* What the registers that hold a value of its type keep of it. */
static Value kept(Value a) {
    if (a.bits <= width) a.held = cut(a.held, a.kind == 'i' ? 'i' : 'u', width);
    return a;
}

static Value read_value(void);

/* Both operands in registers of their common type. */
static Value operands(Value *a, Value *b) {
    *a = read_value(), *b = read_value();
    Value made = common(*a, *b);
    return made;
}

static Value read_value(void) {
    char *word = strtok(NULL, " \n");
    if (!word) exit(2);
    if (strchr("iub", word[0]) && word[1] >= '0' && word[1] <= '9') {
        int bits = atoi(word + 1);
        return (Value){word[0], bits, cut((uint64_t)strtoll(strchr(word, ':') + 1, NULL, 10), word[0], bits)};
    }
    if (word[0] == '!') {
        char kind = word[1];
        int bits = atoi(word + 2);
        return (Value){kind, bits, cut(read_value().held, kind, bits)};
    }
    if (!strcmp(word, "~")) {
        Value a = read_value();
        if (a.kind != 'i') a = (Value){'i', a.bits == 64 ? 64 : a.bits * 2, a.held};
        a.held = 0 - a.held;
        return kept(a);
    }
    if (!strcmp(word, "abs")) {
        Value a = read_value();
        if (a.kind == 'i' && (int64_t)a.held < 0) a.held = 0 - a.held;
        return kept(a);
    }
    Value a, b, made = operands(&a, &b);
    /* Registers that hold what they did, as the common type has it. */
    a = kept((Value){made.kind, made.bits, a.held}), b = kept((Value){made.kind, made.bits, b.held});
    int is_signed = made.kind == 'i';
    int less = is_signed ? (int64_t)a.held < (int64_t)b.held : a.held < b.held;
    int more = is_signed ? (int64_t)a.held > (int64_t)b.held : a.held > b.held;
    if (!strcmp(word, "<")) return (Value){'i', 8, (uint64_t)less};
    if (!strcmp(word, ">")) return (Value){'i', 8, (uint64_t)more};
    if (!strcmp(word, "=")) return (Value){'i', 8, (uint64_t)(a.held == b.held)};
    if (!strcmp(word, "min")) made.held = more ? b.held : a.held;
    else if (!strcmp(word, "max")) made.held = less ? b.held : a.held;
    else if (!strcmp(word, "+")) made.held = a.held + b.held;
    else if (!strcmp(word, "-")) made.held = a.held - b.held;
    else if (!strcmp(word, "*")) made.held = a.held * b.held;
    else {
        int overflows = is_signed && b.held == UINT64_MAX;
        int is_quotient = word[0] == '/';
        if (b.held == 0 && is_quotient) longjmp(fault, 1);
        /* 2nd ed. 2.5.1.5.2: the remainder of a division by 0 is 0. */
        if (b.held == 0) made.held = 0;
        else if (overflows) made.held = is_quotient ? 0 - a.held : 0;
        else if (is_signed) made.held = (uint64_t)(is_quotient ? (int64_t)a.held / (int64_t)b.held : (int64_t)a.held % (int64_t)b.held);
        else made.held = is_quotient ? a.held / b.held : a.held % b.held;
    }
    return kept(made);
}

int main(void) {
    static char line[1 << 16];
    while (fgets(line, sizeof line, stdin)) {
        /* `strtok` goes on from here. */
        char *first = strtok(line, " \n");
        if (!first) continue;
        width = atoi(first);
        if (setjmp(fault)) {
            puts("fault");
            continue;
        }
        Value whole = read_value();
        printf("%" PRId64 "\n", (int64_t)cut(whole.held, whole.bits == 64 ? whole.kind : 'i', 64));
    }
    return 0;
}
