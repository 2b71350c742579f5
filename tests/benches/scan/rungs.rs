//! A thousand rungs of bit logic, as ST and as C: coils of contacts in series and parallel, some
//! sealed in, with contacts of inputs and of other coils.

use std::fmt::Write;

use super::random::Random;

const INPUTS: u64 = 64;
const RUNGS: u64 = 1000;

/// One contact: an input or a coil, some of them negated.
fn contact(random: &mut Random, rung: u64) -> (String, bool) {
    let coil = rung > 0 && random.below(2) == 0;
    let name = if coil { format!("c{}", random.below(RUNGS)) } else { format!("x{}", random.below(INPUTS)) };
    (name, random.below(3) == 0)
}

/// The right side of a rung, by the words of a language.
fn rung(random: &mut Random, number: u64) -> [String; 2] {
    let mut sides = [String::new(), String::new()];
    let sealed = random.below(4) == 0;
    if sealed {
        let open = format!("(c{number}");
        sides = [open.clone(), open];
    }
    for index in 0..2 + random.below(4) {
        let (name, negated) = contact(random, number);
        let word = match index {
            0 if sealed => 1,
            0 => 0,
            _ => 1 + random.below(5) / 3,
        };
        let ([st, c], close) = match word {
            0 => (["", ""], ""),
            1 if sealed && index == 0 => ([" OR ", " | "], ")"),
            1 => ([" AND ", " & "], ""),
            _ => ([" OR ", " | "], ""),
        };
        let _ = write!(sides[0], "{st}{}{name}{close}", if negated { "NOT " } else { "" });
        let _ = write!(sides[1], "{c}{}{name}{close}", if negated { "!" } else { "" });
    }
    sides
}

/// The program in ST and in C.
pub fn programs(seed: u64) -> [String; 2] {
    let mut random = Random(seed);
    let list = |letter: char, count: u64| (0..count).map(|n| format!("{letter}{n}")).collect::<Vec<_>>().join(", ");
    let (inputs, coils) = (list('x', INPUTS), list('c', RUNGS));
    let mut st = format!(
        "PROGRAM Rungs\nVAR sum : ULINT; seed : ULINT := 12345; bits : LWORD;\n{inputs}, {coils} : BOOL; END_VAR\n"
    );
    let mut c = format!(
        "#include <stdbool.h>\n#include <stdint.h>\nuint64_t sum;\nstatic uint64_t seed = 12345;\nbool {inputs}, {coils};\n\
        void scan(int64_t now)\n{{\n(void)now;\n"
    );
    st += "seed := seed * 6364136223846793005 + 1442695040888963407;\nbits := ULINT_TO_LWORD(seed);\n";
    c += "seed = seed * 6364136223846793005u + 1442695040888963407u;\n";
    for input in 0..INPUTS {
        let _ = writeln!(st, "x{input} := (SHR(bits, {input}) AND 1) <> 0;");
        let _ = writeln!(c, "x{input} = (seed >> {input} & 1) != 0;");
    }
    for number in 0..RUNGS {
        let [right_st, right_c] = rung(&mut random, number);
        let _ = writeln!(st, "c{number} := {right_st};");
        let _ = writeln!(c, "c{number} = {right_c};");
    }
    for number in (0..RUNGS).step_by(37) {
        let _ = writeln!(st, "sum := sum * 31 + BOOL_TO_ULINT(c{number});");
        let _ = writeln!(c, "sum = sum * 31 + c{number};");
    }
    (st, c) = (st + "END_PROGRAM\n", c + "}\n");
    [st, c]
}
