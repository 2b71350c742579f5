//! Words that the field's words replace ([`LIST`]): none of them stands in the sources or in the documents again.

use std::path::Path;

use crate::laws::sources;
use crate::{root, workspace};

const LIST: &str = "tests/house/old_words.txt";

/// Where an old word stands for something else, or has to stay.
const ALLOWED: &[(&str, &str, &str)] = &[
    ("spots", "clients/plant/src", "hot spots of a kiln's shell, and the spots that a scanner sees"),
    ("spots", "scenarios/src/map_file.rs", "the spots that a scanner sees"),
    ("told", "scenarios/src/case/campaign_file.rs", "the key's name before `detected`, read with a warning"),
    ("told", "scenarios/src/case/catalogue.rs", "the key's name before `detected`, read with a warning"),
];

/// The old words of the list; `*` at the end of one stands for every word that begins like it.
fn listed() -> Vec<String> {
    let text = std::fs::read_to_string(root().join(LIST)).expect("a list of old words");
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| line.split_once(" -> ").expect("a line `old -> new`").0.to_owned()).collect()
}

/// The texts in which words are looked for: sources of all crates of the product, and the Markdown below `docs`.
fn texts() -> impl Iterator<Item = (String, String)> {
    let documents = workspace::files_ending(&root().join("docs"), "md").into_iter().map(|path| {
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (workspace::name(&path), text)
    });
    sources().filter(|(file, _)| !file.starts_with("tests")).chain(documents)
}

fn is_old(listed: &[String], word: &str) -> Option<usize> {
    listed.iter().position(|old| match old.strip_suffix('*') {
        Some(start) => word.starts_with(start),
        None => word == old,
    })
}

#[test]
fn old_words_are_gone() {
    let listed = listed();
    let mut used = vec![false; ALLOWED.len()];
    let mut found = String::new();
    for (file, text) in texts() {
        for (at, line) in text.lines().enumerate() {
            for word in line.split(|letter: char| !letter.is_alphanumeric() && letter != '_') {
                let Some(old) = is_old(&listed, word) else { continue };
                let allowed = ALLOWED
                    .iter()
                    .position(|(word, place, _)| *word == listed[old] && Path::new(&file).starts_with(place));
                match allowed {
                    Some(allowed) => used[allowed] = true,
                    None => found += &format!("    {file}:{}: `{word}`\n", at + 1),
                }
            }
        }
    }
    for ((word, place, reason), _) in ALLOWED.iter().zip(used).filter(|(_, used)| !used) {
        found += &format!("    `{word}` is allowed in {place} ({reason}), but does not stand there\n");
    }
    assert!(found.is_empty(), "instead of them, use the words of {LIST}:\n{found}");
}
