//! Two hundred timers, each an instance of its own, as ST and as C.

use std::fmt::Write;

use super::random::Random;

const TIMERS: u64 = 200;
const KINDS: [&str; 3] = ["TON", "TOF", "TP"];

/// The program in ST and in C; `blocks` is the timers' C.
pub fn programs(seed: u64, blocks: &str) -> [String; 2] {
    let mut random = Random(seed);
    let kinds: Vec<&str> = (0..TIMERS).map(|_| KINDS[random.below(3) as usize]).collect();
    let mut st = "PROGRAM Timers\nVAR sum : ULINT; seed : ULINT := 12345; bits : LWORD;\n".to_owned();
    let mut c = format!("{blocks}\nuint64_t sum;\nstatic uint64_t seed = 12345;\n");
    for (number, kind) in kinds.iter().enumerate() {
        let _ = writeln!(st, "t{number} : {kind};");
        let _ = writeln!(c, "struct timer t{number};");
    }
    st += "END_VAR\nseed := seed * 6364136223846793005 + 1442695040888963407;\nbits := ULINT_TO_LWORD(seed);\n";
    c += "void scan(int64_t now)\n{\nseed = seed * 6364136223846793005u + 1442695040888963407u;\n";
    for (number, kind) in kinds.iter().enumerate() {
        let (ms, bit) = (10 + 10 * random.below(20), random.below(64));
        let _ = writeln!(st, "t{number}(IN := (SHR(bits, {bit}) AND 1) <> 0, PT := T#{ms}ms);");
        let _ = writeln!(
            c,
            "t{number}.in = (seed >> {bit} & 1) != 0; t{number}.pt = {ms}000000; {}(&t{number}, now);",
            kind.to_lowercase()
        );
    }
    for number in 0..TIMERS {
        let _ = writeln!(st, "sum := sum * 3 + BOOL_TO_ULINT(t{number}.Q);");
        let _ = writeln!(c, "sum = sum * 3 + t{number}.q;");
    }
    (st, c) = (st + "END_PROGRAM\n", c + "}\n");
    [st, c]
}
