use crate::rig::result;

const TABLE: &[(&str, &str, i64)] = &[
    ("r : INT; x : REAL := 2.5;", "r := REAL_TO_INT(x);", 2),
    ("r : INT; x : REAL := 3.5;", "r := REAL_TO_INT(x);", 4),
    ("r : INT; x : LREAL := -2.5;", "r := LREAL_TO_INT(x);", -2),
    ("r : INT; x : LREAL := 1.0E9;", "r := LREAL_TO_INT(x);", 32767),
    ("r : USINT; x : LREAL := -5.0;", "r := LREAL_TO_USINT(x);", 0),
    ("r : UDINT; x : LREAL := 4.0E9;", "r := LREAL_TO_UDINT(x);", 4_000_000_000),
    ("r : DINT; x : LREAL := -2.9;", "r := TRUNC(x);", -2),
    ("r : SINT; x : REAL := 2.9;", "r := REAL_TRUNC_SINT(x);", 2),
    ("r : SINT; x : INT := 300;", "r := INT_TO_SINT(x);", 44),
    ("r : UINT; x : INT := -1;", "r := INT_TO_UINT(x);", 65535),
    ("r : LWORD; x : INT := 16#7F;", "r := INT_TO_LWORD(x);", 127),
    ("r : BOOL; x : WORD := 2;", "r := WORD_TO_BOOL(x);", 0),
    ("r : BOOL; x : INT := 2;", "r := INT_TO_BOOL(x);", 1),
    ("r : DINT; x : TIME := T#1.5s;", "r := TIME_TO_DINT(x);", 1500),
    ("r : TIME; x : INT := 20;", "r := INT_TO_TIME(x);", 20_000_000),
    ("r : LTIME; x : DINT := 20;", "r := DINT_TO_LTIME(x);", 20),
    ("r : TIME; x : REAL := 1.5;", "r := REAL_TO_TIME(x);", 1_500_000),
    ("r : SINT; x : DINT := -1;", "r := TO_SINT(x);", -1),
    ("r : DWORD; x : REAL := 1.0;", "r := REAL_TO_DWORD(x);", 0x3f80_0000),
    ("r : LWORD; x : LREAL := -2.0;", "r := TO_LWORD(x);", i64::MIN | 1 << 62),
    ("r : DINT; x : DWORD := 16#C0200000;", "r := REAL_TO_DINT(DWORD_TO_REAL(x) * 2.0);", -5),
    ("r : LINT; x : LWORD := 16#4008000000000000;", "r := TO_LINT(LWORD_TO_LREAL(x));", 3),
    ("r : INT; x : LREAL := -7.9;", "r := TRUNC_INT(x) + LREAL_TRUNC_INT(1.9);", -6),
    ("r : UINT; x : WORD := 16#1234;", "r := WORD_BCD_TO_UINT(x);", 1234),
    ("r : ULINT; x : LWORD := 16#1234567890123456;", "r := BCD_TO_ULINT(x);", 1_234_567_890_123_456),
    ("r : WORD; x : UINT := 51234;", "r := UINT_TO_BCD_WORD(x);", 0x1234),
    ("r : BYTE; x : USINT := 42;", "r := TO_BCD_BYTE(x);", 0x42),
    ("r : USINT; x : BYTE := 16#1A;", "r := BCD_TO_USINT(x);", 20),
    ("r : INT := -5;", "r := ABS(r);", 5),
    ("r : SINT := -128;", "r := ABS(r);", -128),
    ("r : INT := 3;", "r := MAX(r, 7, 5) * 10 + MIN(r, 7, 5);", 73),
    ("r : INT := 30;", "r := LIMIT(0, r, 20);", 20),
    ("r : INT := 30;", "r := LIMIT(MN := 0, MX := 40, IN := r);", 30),
    ("r : INT := 3; g : BOOL := TRUE;", "r := SEL(g, r, 9);", 9),
    ("r : INT := 3; g : BOOL;", "r := SEL(G := g, IN0 := r, IN1 := 9);", 3),
    ("r : INT := 2;", "r := MUX(r, 10, 20, 30);", 30),
    ("r : INT := 5;", "r := ADD(r, 1, 2) + MUL(2, 3, r) + SUB(r, 1) + DIV(r, 2) + MOD(r, 3);", 8 + 30 + 4 + 2 + 2),
    ("r : BOOL; a : INT := 5;", "r := GT(a, 4, 3) AND LE(a, 5) AND NE(a, 6) AND NOT EQ(a, 4, 5);", 1),
    ("r : BOOL; a : BOOL := TRUE;", "r := AND(a, TRUE, NOT FALSE) AND OR(a, FALSE) AND NOT XOR(a, a);", 1),
    ("r : BYTE := 2#1000_0001;", "r := SHL(r, 1);", 2),
    ("r : BYTE := 2#1000_0001;", "r := SHR(r, 1);", 0x40),
    ("r : BYTE := 2#1000_0001;", "r := ROL(r, 1);", 3),
    ("r : BYTE := 2#1000_0001;", "r := ROR(IN := r, N := 9);", 0xc0),
    ("r : BYTE := 255; n : INT := 8;", "r := SHL(r, n);", 0),
    ("r : DWORD := 16#8000_0001;", "r := ROL(r, 4);", 0x18),
    ("r : LWORD := 1; n : INT := 64;", "r := SHL(r, n) OR ROL(r, 64);", 1),
    ("r : INT := 4;", "r := MOVE(r);", 4),
];

#[test]
fn functions_give_what_their_tables_say() {
    for (declarations, statements, wanted) in TABLE {
        let rig = result(declarations, statements);
        assert_eq!(rig.int("P.r"), *wanted, "{declarations} {statements}");
    }
}

#[test]
fn transcendental_functions_are_those_of_libm_in_their_own_width() {
    type Pair = (&'static str, fn(f64) -> f64, fn(f32) -> f32);
    let functions: [Pair; 10] = [
        ("SIN", libm::sin, libm::sinf),
        ("COS", libm::cos, libm::cosf),
        ("TAN", libm::tan, libm::tanf),
        ("ASIN", libm::asin, libm::asinf),
        ("ACOS", libm::acos, libm::acosf),
        ("ATAN", libm::atan, libm::atanf),
        ("EXP", libm::exp, libm::expf),
        ("LN", libm::log, libm::logf),
        ("LOG", libm::log10, libm::log10f),
        ("SQRT", libm::sqrt, libm::sqrtf),
    ];
    for (name, double, single) in functions {
        let rig =
            result("r : LREAL; x : LREAL := 0.7; s, y : REAL := 0.7;", &format!("r := {name}(x); s := {name}(y);"));
        assert_eq!(rig.real("P.r").to_bits(), double(0.7).to_bits(), "{name}");
        assert_eq!(rig.real("P.s").to_bits(), f64::from(single(0.7)).to_bits(), "{name}");
    }
    let rig = result("r, x : LREAL := 1.7; s, y : REAL := 1.7;", "r := EXPT(x, 3); s := y ** 2.5;");
    assert_eq!(rig.real("P.r"), libm::pow(1.7, 3.0));
    assert_eq!(rig.real("P.s"), f64::from(libm::powf(1.7, 2.5)));
}
