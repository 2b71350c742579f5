//! Laws that every source must keep: which crate stands on which, who may read a clock, and that nothing is random.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::root;
use crate::tokens::{Token, tokens};

/// The crates of the program, and which of them each may stand on.
const STANDS_ON: &[(&str, &[&str])] = &[
    ("base", &[]),
    ("base/xml", &[]),
    ("server", &["onescan-base"]),
    ("server/recording", &["onescan-base", "onescan-server"]),
    ("plc-shim", &["onescan-base", "onescan-xml"]),
    ("report", &[]),
    ("clients", &["onescan-base", "onescan-plc-shim", "onescan-server", "onescan-xml"]),
    ("scenarios", &["onescan-base", "onescan-clients", "onescan-plc-shim", "onescan-server"]),
    (
        "cli",
        &[
            "onescan-base",
            "onescan-clients",
            "onescan-plc-shim",
            "onescan-recording",
            "onescan-report",
            "onescan-scenario",
            "onescan-server",
            "onescan-xml",
        ],
    ),
];

/// Where a wall clock is read, and for what. A folder stands for all that is in it.
const CLOCKS: &[(&str, &str)] = &[
    ("server/src/pacing.rs", "virtual time beside wall time, if it is asked for"),
    ("server/src/formation.rs", "how long clients are waited for"),
    ("server/recording/src/rhythm.rs", "when steps reach the disk, never what they are"),
    ("server/src/transport", "how long an answer is waited for"),
    ("clients/links/src/gateway", "how long a PLC is waited for"),
    ("clients/links/src/station", "a PLC on a clock of its own"),
    ("clients/opc-ua/src/information_model/board.rs", "time stamps of OPC UA"),
    ("clients/opc-ua/src/server/doorkeeper.rs", "the day on which a token ends"),
    ("cli/src", "how long a command took; sessions on a free-wheeling clock"),
];

/// Maps without an order, and random numbers: names that no source needs.
const UNORDERED: &[&str] = &["HashMap", "HashSet", "RandomState", "thread_rng", "getrandom"];

/// Where such a name stands nevertheless, and why that is harmless.
const HARMLESS: &[(&str, &str)] = &[
    ("clients/opc-ua/src/information_model/manager.rs", "the library's interface; looked up by key, never iterated"),
    ("server/src/access/token.rs", "a new token: on which nothing that a session computes depends"),
];

/// Where a file is read otherwise than by `onescan_base::regular`, which refuses what has no end.
const READS: &[(&str, &str)] =
    &[("base/src/regular.rs", "it is this one"), ("clients/src/published.rs", "what is published, compared by tests")];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for entry in entries {
        let path = entry.expect("a folder that can be read").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Places at which one of `words` stands outside of comments and texts, as `file:line: word`, by file.
fn places_of(words: &[&str]) -> BTreeMap<String, Vec<String>> {
    let mut files = Vec::new();
    for (folder, _) in STANDS_ON {
        rust_files(&root().join(folder).join("src"), &mut files);
    }
    files.sort();
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for path in files {
        let text = std::fs::read_to_string(&path).expect("a source that can be read");
        let file = path.strip_prefix(root()).expect("below the root").display().to_string();
        for (token, line) in tokens(&text) {
            if let Token::Word(word) = token
                && words.contains(&word.as_str())
            {
                places.entry(file.clone()).or_default().push(format!("    {file}:{line}: {word}\n"));
            }
        }
    }
    places
}

/// What stands in files that are not among the allowed, and the allowed in which nothing stands.
fn against(places: &BTreeMap<String, Vec<String>>, allowed: &[(&str, &str)]) -> String {
    let mut used = BTreeSet::new();
    let mut found = String::new();
    for (file, lines) in places {
        match allowed.iter().find(|(place, _)| Path::new(file).starts_with(place)) {
            Some((place, _)) => drop(used.insert(place)),
            None => found += &lines.concat(),
        }
    }
    for (place, reason) in allowed.iter().filter(|(place, _)| !used.contains(place)) {
        found += &format!("    {place} is allowed ({reason}), but needs it no more\n");
    }
    found
}

#[test]
fn crates_stand_on_each_other_in_one_order() {
    let mut found = String::new();
    for (folder, allowed) in STANDS_ON {
        let path = root().join(folder).join("Cargo.toml");
        let text = std::fs::read_to_string(&path).expect("a manifest that can be read");
        let manifest: toml::Table = text.parse().expect("a manifest");
        let dependencies = manifest.get("dependencies").and_then(toml::Value::as_table);
        let ours = dependencies.into_iter().flat_map(toml::Table::keys).filter(|name| name.starts_with("onescan"));
        for name in ours.filter(|name| !allowed.contains(&name.as_str())) {
            found += &format!("    {folder} stands on {name}\n");
        }
    }
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn clocks_are_read_where_they_must_be_and_nowhere_else() {
    let found = against(&places_of(&["Instant", "SystemTime"]), CLOCKS);
    assert!(found.is_empty(), "\n{found}");
}

/// Calls that read a file of any kind and size, outside of tests beside the code.
#[test]
fn files_are_read_in_one_way() {
    let mut found = String::new();
    let mut files = Vec::new();
    for (folder, _) in STANDS_ON {
        rust_files(&root().join(folder).join("src"), &mut files);
    }
    files.sort();
    for path in files {
        let text = std::fs::read_to_string(&path).expect("a source that can be read");
        let file = path.strip_prefix(root()).expect("below the root").display().to_string();
        if READS.iter().any(|(place, _)| *place == file) {
            continue;
        }
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for (line, text) in (1..).zip(code.lines()) {
            let reads = ["fs::read(", "fs::read_to_string(", "File::open("];
            if reads.iter().any(|call| text.contains(call)) && !text.trim_start().starts_with("//") {
                found += &format!("    {file}:{line}: {}\n", text.trim());
            }
        }
    }
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn nothing_depends_on_the_order_of_a_hash_or_on_chance() {
    let found = against(&places_of(UNORDERED), HARMLESS);
    assert!(found.is_empty(), "\n{found}");
}
