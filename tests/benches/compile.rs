//! Time from program text to machine code, for a program of 50,000 lines.
//!
//! `cargo bench -p onescan-tests --bench compile`; another number of lines after `--`.

use std::fmt::Write;
use std::time::Instant;

use onescan_iec::TimeSpan;
use onescan_iec::syntax::{FileId, parse};
use onescan_iec_run::{Application, SoftPlc};

/// Function blocks of some hundred lines each, every one called by the program.
fn program(lines: usize) -> String {
    let mut text = String::new();
    let mut blocks = 0;
    // A block has 268 lines, and the program two more for each.
    while (blocks + 1) * 270 <= lines {
        // Writing to a string does not fail.
        let _ = write!(text, "FUNCTION_BLOCK Block{blocks}\nVAR_INPUT in : BOOL; x : DINT; END_VAR\n");
        let _ = write!(
            text,
            "VAR_OUTPUT y : DINT; END_VAR\nVAR\n  t : TON; i : DINT; a : ARRAY [0..15] OF DINT;\nEND_VAR\n"
        );
        for part in 0..20 {
            let _ = write!(
                text,
                "  t(IN := in AND x > {part}, PT := T#{part}ms);\n  IF t.Q THEN\n    y := y + x * {part};\n  ELSE\n    \
                 y := y - {part};\n  END_IF;\n  FOR i := 0 TO 15 DO\n    a[i] := a[i] + y;\n  END_FOR;\n  CASE x OF\n    \
                 {part}: y := 1;\n    {}: y := 2;\n  END_CASE;\n",
                part + 100
            );
        }
        text += "END_FUNCTION_BLOCK\n";
        blocks += 1;
    }
    text += "PROGRAM Main\nVAR\n";
    (0..blocks).for_each(|n| writeln!(text, "  b{n} : Block{n};").expect("a String takes all"));
    text += "END_VAR\n";
    (0..blocks).for_each(|n| writeln!(text, "  b{n}(in := TRUE, x := {n});").expect("a String takes all"));
    text + "END_PROGRAM\n"
}

fn main() {
    let lines = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(50_000);
    let text = program(lines);
    println!("{} lines, {} bytes", text.lines().count(), text.len());
    let started = Instant::now();
    let parsed = parse(FileId(0), &text);
    assert!(parsed.diagnostics.is_empty(), "the text is sound");
    println!("parse                     {:>8.2} s", started.elapsed().as_secs_f64());
    let started = Instant::now();
    let application = Application::from_sources([("large.st", text)]).unwrap_or_else(|found| panic!("{found}"));
    println!("parse, check, WebAssembly {:>8.2} s", started.elapsed().as_secs_f64());
    SoftPlc::new(&application, &application.single_task(TimeSpan::millis::<1>())).expect("it can run");
    println!("and machine code          {:>8.2} s", started.elapsed().as_secs_f64());
}
