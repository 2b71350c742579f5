//! Words that the field's words replace ([`LIST`]): one that is done must not come back, and the others become fewer.

use std::path::PathBuf;

use crate::{root, workspace};

const LIST: &str = "tests/house/old_words.txt";

/// How often an old word may still stand in the sources of the crates and in the documents: nowhere once it is done.
/// A count may only fall.
const BOUNDS: &[(&str, usize)] = &[
    ("told", 469),
    ("Told", 20),
    ("tell_*", 15),
    ("tells", 78),
    ("heed", 17),
    ("Heed", 6),
    ("Makeup", 12),
    ("lookout", 17),
    ("Lookout", 8),
    ("reception", 50),
    ("Guest", 16),
    ("farewell", 12),
    ("seating", 22),
    ("Places", 43),
    ("Doorstep", 11),
    ("Door", 17),
    ("Doorkeeper", 5),
    ("Barred", 11),
    ("Applicant", 8),
    ("Berth", 4),
    ("berth", 49),
    ("interference", 27),
    ("mend", 22),
    ("Misfit", 23),
    ("rhythm", 19),
    ("beat", 7),
    ("Beat", 5),
    ("gaze", 0),
    ("Gazer", 9),
    ("look_closer", 0),
    ("Onward", 7),
    ("Offspring", 4),
    ("rewound", 15),
    ("hindrance", 3),
    ("Desk", 34),
    ("Bench", 33),
    ("Trunk", 0),
    ("spots", 41),
    ("Ground", 0),
    ("Leeway", 0),
    ("Crew", 0),
    ("spelt", 17),
    ("anew", 40),
];

/// The old words of the list; `*` at the end of one stands for every word that begins like it.
fn listed() -> Vec<String> {
    let text = std::fs::read_to_string(root().join(LIST)).expect("a list of old words");
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| line.split_once(" -> ").expect("a line `old -> new`").0.to_owned()).collect()
}

/// The texts in which words are counted: sources of all crates, and the Markdown below `docs`.
fn texts() -> Vec<String> {
    let mut files: Vec<PathBuf> = Vec::new();
    for member in workspace::crates() {
        files.extend(workspace::rust_files(&root().join(member).join("src")));
    }
    files.extend(workspace::files_ending(&root().join("docs"), "md"));
    let read =
        |path: &PathBuf| std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    files.iter().map(read).collect()
}

fn count(texts: &[String], old: &str) -> usize {
    let words = texts.iter().flat_map(|text| text.split(|letter: char| !letter.is_alphanumeric() && letter != '_'));
    match old.strip_suffix('*') {
        Some(start) => words.filter(|word| word.starts_with(start)).count(),
        None => words.filter(|word| *word == old).count(),
    }
}

#[test]
fn old_words_become_fewer() {
    let texts = texts();
    let mut found = String::new();
    for old in listed() {
        let count = count(&texts, &old);
        match BOUNDS.iter().find(|(word, _)| *word == old) {
            Some((_, most)) if count > *most => {
                found += &format!("    `{old}` stands {count} times, {most} are allowed\n");
            }
            Some(_) => {}
            None => found += &format!("    `{old}` has no bound; it stands {count} times\n"),
        }
    }
    for (word, _) in BOUNDS.iter().filter(|(word, _)| !listed().iter().any(|old| old == word)) {
        found += &format!("    `{word}` has a bound, but the list does not name it\n");
    }
    assert!(found.is_empty(), "\n{found}");
}
