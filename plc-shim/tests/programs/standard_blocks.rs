//! Timing diagrams of the standard function blocks, one column a scan.

use std::fmt::Write;

use crate::rig::Rig;

/// Draws `IN` as given and the outputs after each scan of 10 ms; times in ms.
fn diagram(block: &str, preset: &str, inputs: &[(&str, &str)], outputs: &[&str]) -> String {
    let mut rig = Rig::new(&format!("PROGRAM P VAR b : {block} := ({preset}); END_VAR b(); END_PROGRAM"));
    let columns = inputs.first().map_or(0, |(_, levels)| levels.len());
    let mut rows: Vec<String> = outputs.iter().map(|name| format!("{name:4}")).collect();
    for column in 0..columns {
        for (name, levels) in inputs {
            let level = levels.as_bytes()[column] == b'#';
            rig.set(&format!("P.b.{name}"), i64::from(level));
        }
        rig.scan().expect("no fault");
        for (row, name) in rows.iter_mut().zip(outputs) {
            let value = rig.int(&format!("P.b.{name}"));
            let cell = match rig.variable(&format!("P.b.{name}")).type_name.as_str() {
                "BOOL" => (if value == 1 { "#" } else { "." }).to_owned(),
                "TIME" => (value / 1_000_000).to_string(),
                _ => value.to_string(),
            };
            write!(row, "{cell:>4}").expect("a string takes all");
        }
    }
    let mut text = String::new();
    for (name, levels) in inputs {
        write!(text, "{name:4}").expect("a string takes all");
        for level in levels.chars() {
            write!(text, "{level:>4}").expect("a string takes all");
        }
        text.push('\n');
    }
    text + &rows.join("\n")
}

#[test]
fn ton() {
    insta::assert_snapshot!(diagram("TON", "PT := T#30ms", &[("IN", "..######..##..#####")], &["Q", "ET"]));
}

#[test]
fn tof() {
    insta::assert_snapshot!(diagram("TOF", "PT := T#30ms", &[("IN", "..###......###..##....")], &["Q", "ET"]));
}

#[test]
fn tp() {
    insta::assert_snapshot!(diagram("TP", "PT := T#30ms", &[("IN", "..######...#....#.#.##...")], &["Q", "ET"]));
}

#[test]
fn edges() {
    insta::assert_snapshot!(diagram("R_TRIG", "CLK := FALSE", &[("CLK", "#..##.#.")], &["Q"]));
    insta::assert_snapshot!(diagram("F_TRIG", "CLK := FALSE", &[("CLK", "..##.##..")], &["Q"]));
}

#[test]
fn bistables() {
    insta::assert_snapshot!(diagram("SR", "S1 := FALSE", &[("S1", ".#...#.."), ("R", "...#.##.")], &["Q1"]));
    insta::assert_snapshot!(diagram("RS", "S := FALSE", &[("S", ".#...#.#"), ("R1", "...#.##.")], &["Q1"]));
}

#[test]
fn counters() {
    insta::assert_snapshot!(diagram("CTU", "PV := 2", &[("CU", "#.##.#.#.."), ("R", "......##..")], &["Q", "CV"]));
    insta::assert_snapshot!(diagram("CTD", "PV := 2", &[("CD", "#.#.#.#.."), ("LD", ".#.....#.")], &["Q", "CV"]));
    insta::assert_snapshot!(diagram(
        "CTUD",
        "PV := 2",
        &[("CU", "#.#.#..#..."), ("CD", "....#.#...."), ("R", "........#.."), ("LD", ".........#.")],
        &["QU", "QD", "CV"]
    ));
}

#[test]
fn blocks_that_are_not_used_cost_nothing() {
    let size = |declaration: &str, call: &str| {
        let text = format!("PROGRAM P VAR {declaration} END_VAR {call} END_PROGRAM");
        let application = crate::rig::application(&text);
        (application.wasm().len(), application.initial_memory().len())
    };
    let without = size("x : BOOL;", "x := TRUE;");
    let with = size("x : TON;", "x(IN := TRUE);");
    assert!(with.0 > without.0 + 100, "{with:?} {without:?}");
    assert_eq!(without.1, 65);
}
