//! `onescan model`: the states of a session, and the same for a model checker.

use crate::typed::{scenario, typed};

/// `[SDSP]` Figs. 8 and 9.
#[test]
fn the_table_is_that_of_the_paper() {
    let said = typed(&scenario(""), &["model"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    let rows: Vec<Vec<&str>> = said.out.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(
        rows,
        [
            ["server", "clients", "then"],
            ["start", "start", "initial-write"],
            ["initial-write", "setup", "pre-read"],
            ["pre-read", "ready", "read"],
            ["read", "read", "pre-write"],
            ["pre-write", "run", "write"],
            ["write", "write", "pre-read"],
        ]
    );
}

#[test]
fn a_model_goes_to_a_file_or_to_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["model", "--nusmv", "--clients", "3", "--delay-max", "2", "--tv-max", "7"];
    let shown = typed(folder.path(), &words);
    let written = typed(folder.path(), &[&words[..], &["-o", "session.smv"]].concat());
    assert_eq!((shown.code, written.code, written.out.as_str()), (Some(0), Some(0), ""), "{written:?}");
    assert_eq!(std::fs::read_to_string(folder.path().join("session.smv")).unwrap(), shown.out);
    for part in ["client3 : client (", "tdelay      : 0..2;", "tv    : 0..7;", "SPEC AG EF"] {
        assert!(shown.out.contains(part), "{part}: {}", shown.out);
    }
}

#[test]
fn a_model_that_nobody_can_check_is_refused() {
    for (words, why) in [
        (&["--nusmv", "--clients", "0"][..], "1 to 64 clients, not 0"),
        (&["--nusmv", "--delay-max", "5000"], "up to 1000 steps, not 5000"),
        (&["--nusmv", "--tv-max", "0"], "1 to 1000000 steps, not 0"),
        (&["--clients", "3"], "--nusmv"),
    ] {
        let said = typed(&scenario(""), &[&["model"], words].concat());
        assert!(said.code == Some(2) && said.err.contains(why), "{said:?}");
    }
}
