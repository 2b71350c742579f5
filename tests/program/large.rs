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
