//! Sessions of many signals and many clients. That they come to their end within the time of a test is what is shown: what
//! grows with the square of the number did not (30,000 signals took more than seven minutes to their first step).

use std::time::{Duration, Instant};

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_tests::large;

use crate::typed::typed;

fn runs(signals: usize, clients: usize, words: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    large::write(folder.path(), signals, clients);
    let said = typed(folder.path(), &[&["run", "."], words].concat());
    assert_eq!(said.code, Some(0), "{said:?}");
    said.out.split_whitespace().find(|word| word.starts_with("d2:")).expect("a digest").to_owned()
}

#[test]
fn thirty_thousand_signals_of_one_plc() {
    assert_eq!(runs(30_000, 1, &[]), runs(30_000, 1, &["--transport", "tcp"]));
}

#[test]
fn sixty_four_plcs() {
    runs(64 * 500, 64, &[]);
}

/// The map of all signals, as `onescan wiring` and the editor make it.
#[test]
fn the_wiring_of_thirty_thousand_signals() {
    let folder = tempfile::tempdir().unwrap();
    large::write(folder.path(), 30_000, 1);
    let said = typed(folder.path(), &["wiring", "."]);
    assert!(said.code == Some(0) || said.code == Some(1), "{said:?}");
    assert!(said.out.len() > 1_000, "{said:?}");
}

/// A program of so many statements is checked: what each assigns, and what each counts, is looked for in one walk.
#[test]
fn the_check_of_fifty_thousand_statements() {
    let folder = tempfile::tempdir().unwrap();
    let declared: Vec<String> = (0..1_000).map(|number| format!("o{number} : DINT; n{number} : DINT;\n")).collect();
    let counts = |number| format!("o{number} := b;\nn{number} := n{number} + 1;\n");
    let body: Vec<String> = (0..25_000).map(|number| counts(number % 1_000)).collect();
    let (declared, body) = (declared.concat(), body.concat());
    let text = format!("PROGRAM Main\nVAR_INPUT b : DINT; END_VAR\nVAR\n{declared}END_VAR\n{body}END_PROGRAM\n");
    std::fs::write(folder.path().join("main.st"), text).unwrap();
    let said = typed(folder.path(), &["check", "main.st"]);
    assert!(said.code == Some(0) || said.code == Some(1), "{said:?}");
}

/// Thousands of errors are not drawn one by one: each looks through its source once more.
#[test]
fn the_errors_of_ten_thousand_statements() {
    let folder = tempfile::tempdir().unwrap();
    let body = "a := a + 1; IF a > 2 THEN a := 0; END_IF\n".repeat(10_000);
    let program = format!("PROGRAM Main\nVAR_OUTPUT a : DINT; END_VAR\n{body}END_PROGRAM\n");
    std::fs::write(folder.path().join("main.st"), program).unwrap();
    let scenario = "version = 1\nstep = \"10ms\"\nuntil = \"50ms\"\n[signals]\na = { type = \"DINT\", writer = \"plc\" }\n\
        [clients.plc]\nkind = \"soft-plc\"\nsources = [\"main.st\"]\n\
        tasks = [{ name = \"main\", interval = \"10ms\", programs = [\"Main\"] }]\n";
    std::fs::write(folder.path().join("scenario.toml"), scenario).unwrap();
    let said = typed(folder.path(), &["run", "."]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("more errors are not shown: `onescan check` lists them"), "{}", said.err.len());
}

/// `count` lines, each of its number.
fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).map(line).collect()
}

/// A program with so many variables, by how they are declared.
fn programs(count: usize) -> Vec<(&'static str, String)> {
    let next = |number: usize| (number * 7 + 1) % count;
    let counts = |number| format!("v{number} := v{} + 1;\n", next(number));
    let declared = |ty: &str| lines(count, |number| format!("v{number} : {ty};\n"));
    let program = |head: &str, body: String| format!("{head}END_VAR\n{body}END_PROGRAM\n");
    let inner = |kind: &str, ty: &str| format!("PROGRAM Main\n{kind}\n{}", declared(ty));
    let global = |kind: &str| format!("{kind}\n{}END_VAR\nPROGRAM Main\nVAR x : INT;\n", declared("INT"));
    let located = lines(count, |number| format!("v{number} AT %QX{}.{} : BOOL;\n", number / 8, number % 8));
    let members = lines(count, |number| format!("v{number} : INT := {};\n", number % 100));
    let structure = format!("TYPE S : STRUCT\n{members}END_STRUCT; END_TYPE\nPROGRAM Main\nVAR s : S;\n");
    vec![
        ("local", program(&inner("VAR", "INT"), lines(count, counts))),
        ("outputs", program(&inner("VAR_OUTPUT", "INT"), lines(count, counts))),
        ("global", program(&global("VAR_GLOBAL"), lines(count, counts))),
        (
            "located",
            program(
                &format!("PROGRAM Main\nVAR\n{located}"),
                lines(count, |number| format!("v{number} := NOT v{};\n", next(number))),
            ),
        ),
        ("members", program(&structure, lines(count, |number| format!("s.v{number} := s.v{} + 1;\n", next(number))))),
        (
            "instances",
            program(
                &inner("VAR", "TON"),
                lines(count, |number| format!("v{number}(IN := v{}.Q, PT := T#1s);\n", next(number))),
            ),
        ),
    ]
}

/// The shortest of some times that a check took: what else the machine did is in the longer ones.
fn checked(text: &str) -> Duration {
    let one = |_| {
        let input = Input::from_text("main.st", SourceKind::Text, text);
        let began = Instant::now();
        let found = onescan_iec::inspect([input], None);
        assert!(!found.has_errors(), "{found}");
        began.elapsed()
    };
    (0..3).map(one).min().expect("three times")
}

/// Eight times as many variables take about eight times as long to check, and not sixty-four times: nobody goes through all of
/// them for each. Both are measured in this run, on this machine.
#[test]
fn the_check_grows_with_the_number_of_variables() {
    for ((kind, few), (_, many)) in programs(2_000).into_iter().zip(programs(16_000)) {
        let (few, many) = (checked(&few), checked(&many));
        let ratio = many.as_secs_f64() / few.as_secs_f64();
        assert!(ratio < 24.0, "{kind}: {few:?} and {many:?}, {ratio:.1} times as long");
    }
}
