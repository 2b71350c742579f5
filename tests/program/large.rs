//! Sessions of many signals and many clients. That they come to their end within the time of a test is what is shown: what
//! grows with the square of the number did not (30,000 signals took more than seven minutes to their first step).

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
