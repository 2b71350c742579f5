//! Every place of the product that starts a process: what it starts, what that sees of the environment, and why it must.

use std::collections::BTreeMap;

use crate::root;
use crate::tokens::{Token, tokens};
use crate::workspace::{crates, name, rust_files};

/// What a process that is started sees of the user's environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Environment {
    /// All: it is this program once more.
    Own,
    /// What programs need to run, and what a scenario names.
    Confined,
    /// Where programs are, and nothing else.
    Emptied,
}

/// File, how many processes it starts, what they see, and the reason for each.
const STARTED: &[(&str, usize, Environment, &str)] = &[
    (
        "cli/regress/src/regress/pool.rs",
        1,
        Environment::Own,
        "a test in a process of its own: what it breaks is its own",
    ),
    (
        "cli/regress/src/repository/git.rs",
        1,
        Environment::Emptied,
        "git, for the reviewed program: with commands that read objects alone; not with `--no-commands`",
    ),
    ("cli/runner/src/run/forked.rs", 1, Environment::Own, "a fork of a session is a session of its own"),
    ("cli/runner/src/run/guard.rs", 1, Environment::Own, "the guard ends clients when the server is killed"),
    (
        "cli/runner/src/run/processes.rs",
        2,
        Environment::Confined,
        "clients: this program for `join`, and a scenario's own command; that is refused with `--no-commands`",
    ),
    ("cli/runner/src/shot/browser.rs", 1, Environment::Confined, "the user's Chromium, which draws our own page"),
];

/// What the file does to the environment, as far as its text shows.
fn confines(text: &str) -> Option<Environment> {
    if text.contains(".env_clear()") {
        return Some(Environment::Emptied);
    }
    text.contains("environment::confine(").then_some(Environment::Confined)
}

/// How often a file makes a `Command`, outside of its tests.
fn commands(text: &str) -> usize {
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    let text = text.split("#[cfg(all(test").next().unwrap_or_default();
    let all = tokens(text);
    let words: Vec<&Token> = all.iter().map(|(token, _)| token).collect();
    let is_made =
        |three: &&[&Token]| three[0].is_word("Command") && *three[1] == Token::Path && three[2].is_word("new");
    words.windows(3).filter(is_made).count()
}

#[test]
fn every_process_that_is_started_is_listed_with_its_environment() {
    let mut found: BTreeMap<String, (usize, Option<Environment>)> = BTreeMap::new();
    // The tools of the tests are not in the product.
    let folders = crates().into_iter().filter(|folder| !folder.starts_with("tests") && !folder.ends_with("/tests"));
    for folder in folders {
        for file in rust_files(&root().join(&folder).join("src")) {
            if file.ends_with("tests.rs") {
                continue;
            }
            let text = std::fs::read_to_string(&file).expect("a source");
            let count = commands(&text);
            if count > 0 {
                found.insert(name(&file), (count, confines(&text)));
            }
        }
    }
    let listed = STARTED.iter().map(|(file, count, environment, _)| {
        let shown = Some(*environment).filter(|environment| *environment != Environment::Own);
        ((*file).to_owned(), (*count, shown))
    });
    assert_eq!(found, listed.collect(), "left: what the sources start; right: the list of this test");
}

#[test]
fn a_start_is_seen() {
    assert_eq!(commands("fn f() { std::process::Command::new(\"git\"); Command::new(x).arg(1); } // Command::new"), 2);
    assert_eq!(commands("struct Command; #[cfg(test)] mod tests { fn f() { Command::new(1); } }"), 0);
}
