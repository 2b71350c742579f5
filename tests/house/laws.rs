//! Laws that every source must keep: which crate stands on which, who may read a clock, and that nothing is random.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::root;
use crate::tokens::{Token, tokens};
use crate::workspace::{self, name, rust_files};

/// The crates of the workspace from the ground up, and which of them each may depend on: only on those above it here.
const DEPENDS_ON: &[(&str, &[&str])] = &[
    ("base", &[]),
    ("base/xml", &[]),
    ("server", &["onescan-base"]),
    ("server/recording", &["onescan-base", "onescan-server"]),
    ("clients/stream", &["onescan-base", "onescan-server"]),
    ("clients/operator", &["onescan-server"]),
    ("plc-shim/docs", &[]),
    ("plc-shim/iec", &["onescan-base", "onescan-iec-docs", "onescan-xml"]),
    ("plc-shim/iec-run", &["onescan-base", "onescan-iec"]),
    (
        "clients/plant",
        &["onescan-base", "onescan-iec", "onescan-iec-run", "onescan-server", "onescan-stream", "onescan-xml"],
    ),
    ("clients/soft-plc", &["onescan-base", "onescan-iec", "onescan-iec-run", "onescan-server", "onescan-stream"]),
    ("clients/links", &["onescan-base", "onescan-iec", "onescan-iec-run", "onescan-server", "onescan-soft-plc"]),
    ("clients/opc-ua", &["onescan-base", "onescan-links", "onescan-server"]),
    ("plc-shim/iec-project", &["onescan-base", "onescan-iec", "onescan-iec-run", "onescan-xml"]),
    (
        "scenarios",
        &[
            "onescan-base",
            "onescan-iec",
            "onescan-iec-project",
            "onescan-iec-run",
            "onescan-links",
            "onescan-operator",
            "onescan-plant",
            "onescan-server",
            "onescan-soft-plc",
            "onescan-stream",
        ],
    ),
    ("report", &["onescan-base"]),
    ("web", &[]),
    (
        "cli/runner",
        &[
            "onescan-base",
            "onescan-iec",
            "onescan-iec-run",
            "onescan-links",
            "onescan-operator",
            "onescan-page",
            "onescan-plant",
            "onescan-recording",
            "onescan-report",
            "onescan-scenario",
            "onescan-server",
            "onescan-soft-plc",
        ],
    ),
    (
        "cli/regress",
        &[
            "onescan-base",
            "onescan-iec",
            "onescan-iec-project",
            "onescan-iec-run",
            "onescan-recording",
            "onescan-report",
            "onescan-runner",
            "onescan-scenario",
            "onescan-server",
            "onescan-soft-plc",
        ],
    ),
    (
        "cli/search",
        &[
            "onescan-base",
            "onescan-iec",
            "onescan-iec-project",
            "onescan-iec-run",
            "onescan-regress",
            "onescan-report",
            "onescan-runner",
            "onescan-scenario",
            "onescan-server",
        ],
    ),
    (
        "cli/edit",
        &[
            "onescan-base",
            "onescan-iec-run",
            "onescan-plant",
            "onescan-report",
            "onescan-runner",
            "onescan-scenario",
            "onescan-server",
            "onescan-soft-plc",
        ],
    ),
    (
        "cli/program",
        &[
            "onescan-base",
            "onescan-edit",
            "onescan-iec",
            "onescan-iec-project",
            "onescan-iec-run",
            "onescan-links",
            "onescan-opc-ua",
            "onescan-plant",
            "onescan-recording",
            "onescan-regress",
            "onescan-report",
            "onescan-runner",
            "onescan-scenario",
            "onescan-search",
            "onescan-server",
            "onescan-xml",
        ],
    ),
    ("tests/simulation", &["onescan-base", "onescan-recording", "onescan-server"]),
    (
        "tests",
        &[
            "onescan",
            "onescan-base",
            "onescan-iec",
            "onescan-iec-project",
            "onescan-iec-run",
            "onescan-links",
            "onescan-opc-ua",
            "onescan-operator",
            "onescan-plant",
            "onescan-recording",
            "onescan-regress",
            "onescan-runner",
            "onescan-scenario",
            "onescan-server",
            "onescan-simulation",
            "onescan-soft-plc",
            "onescan-stream",
        ],
    ),
    ("tests/fuzzing", &[]),
    ("tests/published", &[]),
    ("tests/xtask", &[]),
    ("web/codegen", &[]),
];

/// Where a wall clock is read, and for what. A folder stands for all that is in it.
const CLOCKS: &[(&str, &str)] = &[
    ("server/src/pacing.rs", "virtual time beside wall time, if it is asked for"),
    ("server/src/formation.rs", "how long clients are waited for"),
    ("server/recording/src/flush_policy.rs", "when steps reach the disk, never what they are"),
    ("server/src/transport", "how long an answer is waited for"),
    ("clients/links/src/accept.rs", "how long somebody who connects may say nothing"),
    ("clients/links/src/gateway", "how long a PLC is waited for"),
    ("clients/links/src/station", "a PLC on a clock of its own"),
    ("clients/opc-ua/src/information_model/board.rs", "time stamps of OPC UA"),
    ("clients/opc-ua/src/server/authenticator.rs", "the day on which a token ends"),
    ("cli/edit/src/edit/server.rs", "how much of the time goes into looking at files"),
    ("cli/regress/src/grade/mod.rs", "how long a submission took, for CI servers"),
    ("cli/regress/src/regress", "how long a test took and may take"),
    ("cli/runner/src", "how long a command took; sessions on a free-wheeling clock"),
    ("tests/fuzzing/src", "how long inputs are looked for"),
    ("tests/simulation/src/histories.rs", "how long histories take, for whoever runs them"),
];

/// Maps without an order, and random numbers: names that no source needs.
const UNORDERED: &[&str] = &["HashMap", "HashSet", "RandomState", "thread_rng", "getrandom"];

/// Where such a name stands nevertheless, and why that is harmless.
const HARMLESS: &[(&str, &str)] = &[
    ("clients/opc-ua/src/information_model/manager.rs", "the library's interface; looked up by key, never iterated"),
    ("server/src/access/token.rs", "a new token: on which nothing that a session computes depends"),
];

/// Where a file is read otherwise than by `onescan_base::regular`, which refuses what has no end.
const READS: &[(&str, &str)] = &[
    ("base/src/regular.rs", "it is this one"),
    ("tests/fuzzing/src", "inputs and seeds of the repository"),
    ("tests/published/src", "what is published, compared by tests"),
    ("tests/xtask/src/workspace.rs", "sources of the repository"),
    ("web/codegen/src/published.rs", "what is published, compared by tests"),
];

/// Where a thread is started otherwise than by `onescan_base::threads`, whose errors are to be handled.
const THREADS: &[(&str, &str)] = &[
    ("base/src/threads.rs", "it is this one"),
    ("tests/fuzzing/src", "a tool of the repository"),
    ("tests/simulation/src", "sessions and histories of the tests"),
];

/// Where the largest number of a width stands, as a number.
const LARGEST: &[(&str, &str)] = &[
    ("base/src/time.rs", "the last moment there is"),
    ("clients/links/src/gateway/handshake.rs", "a limit that no order reaches"),
    ("clients/operator/src/operator.rs", "the last moment on the grid of steps"),
    ("clients/plant/src/component/library/logic/loopback.rs", "takes all there is"),
    ("clients/plant/src/scene/failures.rs", "a failure without an end; an `Option` would say it"),
    ("clients/soft-plc/src/client.rs", "texts are shown whole"),
    ("plc-shim/iec-project/src/output/plcopen", "sorts last what has no place"),
    ("plc-shim/iec-project/src/output/scl/standard.rs", "functions of any number of operands"),
    ("plc-shim/iec-run/src/compile/emit/entry.rs", "no program; an `Option` would say it"),
    ("plc-shim/iec-run/src/compile/emit/part.rs", "a mask of bits"),
    ("plc-shim/iec-run/src/run/state/mod.rs", "a time that never comes, in the image of a program"),
    ("plc-shim/iec/src/check/body/call/dynamic_memory.rs", "a bound of the arithmetic"),
    ("plc-shim/iec/src/check/body/chart/evolution.rs", "sorts last what has no priority"),
    ("plc-shim/iec/src/check/configuration/connections.rs", "a program without a task; an `Option` would say it"),
    ("plc-shim/iec/src/check/declare/entry.rs", "a place in no file; an `Option` would say it"),
    ("plc-shim/iec/src/check/declare/scope.rs", "a type that is broken; an enum would say it"),
    ("plc-shim/iec/src/check/standard/form.rs", "functions of any number of operands"),
    ("plc-shim/iec/src/input/drawing", "flags that cannot be read; a diagnostic would say it"),
    ("scenarios/src/expect", "a window without an end; an `Option` would say it"),
    ("scenarios/src/mutants.rs", "takes all there are"),
    ("scenarios/src/report/distribution.rs", "the least of none so far"),
    ("scenarios/src/report/offline.rs", "the part after the last beginning"),
    ("server/src/lockstep/rest.rs", "the neutral element of a minimum"),
    ("tests/fuzzing/src/change.rs", "a number worth trying"),
    ("web/codegen/src/lib.rs", "sorts last what is not required"),
];

/// The sources of all crates, by their paths from the root.
pub fn sources() -> impl Iterator<Item = (String, String)> {
    let files = workspace::crates().into_iter().flat_map(|member| rust_files(&root().join(member).join("src")));
    files.map(|path| (name(&path), std::fs::read_to_string(&path).expect("a source that can be read")))
}

/// Places at which one of `words` stands outside of comments and texts, as `file:line: word`, by file.
fn places_of(words: &[&str]) -> BTreeMap<String, Vec<String>> {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, text) in sources() {
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
pub fn against(places: &BTreeMap<String, Vec<String>>, allowed: &[(&str, &str)]) -> String {
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
fn crates_depend_on_each_other_in_one_order() {
    let mut found = String::new();
    let listed: BTreeSet<String> = DEPENDS_ON.iter().map(|(folder, _)| (*folder).to_owned()).collect();
    let crates: BTreeSet<String> = workspace::crates().into_iter().collect();
    for other in listed.symmetric_difference(&crates) {
        found += &format!("    {other} stands in the table or in the workspace, but not in both\n");
    }
    let mut below: BTreeSet<String> = BTreeSet::new();
    for (folder, allowed) in DEPENDS_ON {
        let dependencies = workspace::dependencies(folder);
        for name in dependencies.iter().filter(|name| !allowed.contains(&name.as_str())) {
            found += &format!("    {folder} depends on {name}\n");
        }
        for name in allowed.iter().filter(|name| !dependencies.iter().any(|dependency| dependency == *name)) {
            found += &format!("    {folder} may depend on {name}, but does not\n");
        }
        for name in allowed.iter().filter(|name| !below.contains(**name)) {
            found += &format!("    {folder} may depend on {name}, which is not above it in the table\n");
        }
        below.insert(workspace::package(folder));
    }
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn clocks_are_read_where_they_must_be_and_nowhere_else() {
    let found = against(&places_of(&["Instant", "SystemTime"]), CLOCKS);
    assert!(found.is_empty(), "\n{found}");
}

/// Places outside of tests beside the code at which a line has one of `calls`, by file.
fn calls_of(calls: &[&str]) -> BTreeMap<String, Vec<String>> {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, text) in sources().filter(|(file, _)| !file.ends_with("/tests.rs")) {
        // Tests stand at the end of a file.
        let code = text.split("\nmod tests {").next().expect("a text has a beginning");
        for (line, text) in (1..).zip(code.lines().map(str::trim)) {
            if !text.starts_with("//") && calls.iter().any(|call| text.contains(call)) {
                places.entry(file.clone()).or_default().push(format!("    {file}:{line}: {text}\n"));
            }
        }
    }
    places
}

/// Calls that read a file of any kind and size.
#[test]
fn files_are_read_in_one_way() {
    let found = against(&calls_of(&["fs::read(", "fs::read_to_string(", "File::open("]), READS);
    assert!(found.is_empty(), "\n{found}");
}

/// What strangers can cause as often as they like is reported from one place, which counts how often.
#[test]
fn what_happens_to_listeners_is_reported_in_one_place() {
    for message in ["cannot accept a connection", "all places are taken"] {
        let found: Vec<String> = sources().filter(|(_, text)| text.contains(message)).map(|(file, _)| file).collect();
        assert_eq!(found, ["server/src/transport/accept.rs"], "`{message}`");
    }
}

/// The largest number of a width, which stands for "none" or "no limit" where an `Option` would say it.
#[test]
fn numbers_do_not_stand_for_something_else() {
    let mut places = calls_of(&["usize::MAX", "u64::MAX", "u32::MAX"]);
    for lines in places.values_mut() {
        // A conversion that saturates means the number itself.
        lines.retain(|line| !(line.contains("try_from(") && line.contains(".unwrap_or(")));
    }
    places.retain(|_, lines| !lines.is_empty());
    let found = against(&places, LARGEST);
    assert!(found.is_empty(), "\n{found}");
}

/// Ways to start a thread that panic, or say nothing of which one it was, where the system has none to give.
#[test]
fn threads_are_started_in_one_way() {
    let found =
        against(&calls_of(&["thread::spawn(", "scope.spawn(", "thread::Builder", "Builder::new().name("]), THREADS);
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn nothing_depends_on_the_order_of_a_hash_or_on_chance() {
    let found = against(&places_of(UNORDERED), HARMLESS);
    assert!(found.is_empty(), "\n{found}");
}

/// Calls whose result says what went wrong.
const FALLIBLE: &[&str] = &[
    ".ok()",
    "canonicalize()",
    "from_slice(",
    "from_str(",
    "from_utf8(",
    "parse()",
    "parse::<",
    "read_to_string(",
    "to_string_pretty(",
    "try_from(",
    "try_into()",
];

/// A default in place of an error hides what is wrong. In place of a `None` it is a value like any other, so the law
/// looks for calls that can fail in the same chain.
#[test]
fn no_error_becomes_a_default() {
    let is_such = |line: &str| {
        line.split_once(".unwrap_or_default()").is_some_and(|(chain, _)| {
            let chain = chain.rsplit(['=', ';', '{']).next().unwrap_or(chain);
            FALLIBLE.iter().any(|call| chain.contains(call)) && !chain.contains(".and_then(") && !chain.contains('|')
        })
    };
    let found = sources().flat_map(|(file, text)| {
        let such = text.lines().enumerate().filter(|(_, line)| is_such(line));
        such.map(|(at, line)| format!("    {file}:{}: {}\n", at + 1, line.trim())).collect::<Vec<_>>()
    });
    let found: String = found.collect();
    assert!(found.is_empty(), "\n{found}");
    assert!(is_such("let a = text.parse::<u8>().unwrap_or_default();"));
    assert!(!is_such("let a = list.first().copied().unwrap_or_default();"));
}
