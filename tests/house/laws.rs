//! Laws that every source must keep: which crate stands on which, who may read a clock, and that nothing is random.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::root;
use crate::tokens::{Token, tokens};

/// The crates of the program, in an order in which each stands only on crates before it, and which of them it may name.
const STANDS_ON: &[(&str, &[&str])] = &[
    ("base", &[]),
    ("base/xml", &[]),
    ("report", &[]),
    ("server", &["base"]),
    ("server/recording", &["base", "server"]),
    ("plc-shim/iec", &["base", "base/xml"]),
    ("plc-shim/iec-run", &["base", "plc-shim/iec"]),
    ("plc-shim/iec-project", &["base", "base/xml", "plc-shim/iec", "plc-shim/iec-run"]),
    ("clients/stream", &["base", "server"]),
    ("clients/operator", &["server"]),
    ("clients/plant", &["base", "base/xml", "server", "plc-shim/iec", "plc-shim/iec-run", "clients/stream"]),
    ("clients/soft-plc", &["base", "server", "plc-shim/iec", "plc-shim/iec-run", "clients/stream"]),
    ("clients/links", &["base", "server", "plc-shim/iec", "plc-shim/iec-run", "clients/soft-plc"]),
    ("clients/opc-ua", &["base", "server", "clients/links"]),
    (
        "scenarios",
        &[
            "base",
            "server",
            "plc-shim",
            "clients/stream",
            "clients/operator",
            "clients/plant",
            "clients/soft-plc",
            "clients/links",
        ],
    ),
    (
        "cli/runner",
        &[
            "base",
            "server",
            "report",
            "plc-shim/iec",
            "plc-shim/iec-run",
            "clients/operator",
            "clients/plant",
            "clients/soft-plc",
            "clients/links",
            "scenarios",
        ],
    ),
    ("cli/regress", &["base", "server", "report", "plc-shim", "clients/soft-plc", "scenarios", "cli/runner"]),
    ("cli/search", &["base", "server", "report", "plc-shim", "scenarios", "cli/runner", "cli/regress"]),
    (
        "cli/edit",
        &[
            "base",
            "server",
            "report",
            "plc-shim/iec-run",
            "clients/plant",
            "clients/soft-plc",
            "scenarios",
            "cli/runner",
        ],
    ),
    ("cli/program", &["base", "server", "report", "plc-shim", "clients", "scenarios", "cli"]),
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
    ("cli", "how long a command took; sessions on a free-wheeling clock"),
];

/// Maps without an order, and random numbers: names that no source needs.
const UNORDERED: &[&str] = &["HashMap", "HashSet", "RandomState", "thread_rng", "getrandom"];

/// Where such a name stands nevertheless, and why that is harmless.
const HARMLESS: &[(&str, &str)] = &[
    ("clients/opc-ua/src/information_model/manager.rs", "the library's interface; looked up by key, never iterated"),
    ("server/src/access/token.rs", "a new token: on which nothing that a session computes depends"),
];

/// Where a file is read otherwise than by `onescan_base::regular`, which refuses what has no end.
const READS: &[(&str, &str)] = &[("base/src/regular.rs", "it is this one")];

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

/// A crate's manifest, and the folders of the crates of ours that it names.
fn dependencies(folder: &str, table: &str) -> Vec<String> {
    let workspace: toml::Table = manifest(".");
    let paths = workspace["workspace"]["dependencies"].as_table().expect("a table of dependencies").clone();
    let folder_of = |name: &str| paths[name]["path"].as_str().expect("a crate of ours has a path").to_owned();
    let manifest = manifest(folder);
    let named = manifest.get(table).and_then(toml::Value::as_table);
    let ours = named.into_iter().flat_map(toml::Table::keys).filter(|name| name.starts_with("onescan"));
    ours.map(|name| folder_of(name)).collect()
}

fn manifest(folder: &str) -> toml::Table {
    let text = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).expect("a manifest that can be read");
    text.parse().expect("a manifest")
}

#[test]
fn crates_stand_on_each_other_in_one_order() {
    let mut found = String::new();
    for (at, (folder, allowed)) in STANDS_ON.iter().enumerate() {
        for named in dependencies(folder, "dependencies") {
            if !allowed.iter().any(|place| Path::new(&named).starts_with(place)) {
                found += &format!("    {folder} may not stand on {named}\n");
            }
            if !STANDS_ON[..at].iter().any(|(before, _)| *before == named) {
                found += &format!("    {folder} stands on {named}, which does not come before it\n");
            }
        }
        for place in *allowed {
            if !dependencies(folder, "dependencies").iter().any(|named| Path::new(named).starts_with(place)) {
                found += &format!("    {folder} may stand on {place}, but does not any more\n");
            }
        }
    }
    assert!(found.is_empty(), "\n{found}");
}

/// Every crate with sources has its place in the table.
#[test]
fn every_crate_has_its_floor() {
    let tests = ["tests", "plc-shim/tests", "web/codegen"];
    let mut crates = crate::crates();
    crates.retain(|source| !tests.iter().any(|test| Path::new(source).starts_with(test)));
    let listed: BTreeSet<String> = STANDS_ON.iter().map(|(folder, _)| format!("{folder}/src")).collect();
    assert_eq!(crates.into_iter().collect::<BTreeSet<_>>(), listed);
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
