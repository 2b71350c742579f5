//! The order of the house, read from its sources: modules of one crate stand in rooms, the arrows between rooms point
//! one way, and a closed room is entered through its interface only.
//!
//! The rooms are found: every folder of a crate's sources with three modules or more. What does not hold everywhere is
//! data ([`EXCEPTIONS`]). Modules that only tests compile do not count.

#![expect(clippy::format_push_string, clippy::format_collect, reason = "the text of a failed test, written once")]

mod documented;
mod graph;
mod laws;
mod old_words;
mod processes;
mod products;
mod source;
mod tokens;
mod workspace;

use std::path::Path;

use graph::{Arrow, Rooms};
use source::{Field, Sources};

/// A folder must have so many modules to be a floor: two that name each other are one subject in two files.
const MODULES_MIN: usize = 3;

/// What holds for a folder besides the rule that its rooms stand in no circle.
struct Exception {
    /// From the root of the repository.
    folder: &'static str,
    /// True if rooms are entered only through what their own modules show.
    closed: bool,
    /// Structures that are plain records, whose fields are their interface, if rooms keep the fields of all others to
    /// themselves. `None` where fields are not looked at.
    records: Option<&'static [&'static str]>,
    /// Circles that are still there: the names of their rooms in alphabetical order, and why they stay. A circle that
    /// is gone must go from here, too, so that it cannot come back.
    known: &'static [(&'static [&'static str], &'static str)],
}

const fn known(folder: &'static str, known: &'static [(&'static [&'static str], &'static str)]) -> Exception {
    Exception { folder, closed: false, records: None, known }
}

const EXCEPTIONS: &[Exception] = &[
    known(
        "plc-shim/iec/src/ir",
        &[(
            &["expr", "pou", "statement", "text", "types"],
            "a recursive tree: units hold statements, statements expressions, expressions types",
        )],
    ),
    known(
        "plc-shim/iec/src/syntax/ast",
        &[(
            &["chart", "configuration", "declaration", "expression", "instruction", "object", "statement"],
            "a recursive tree: declarations hold statements, statements expressions, expressions types",
        )],
    ),
    Exception { folder: "plc-shim/iec-run/src/compile", closed: true, records: None, known: &[] },
    Exception {
        folder: "plc-shim/iec/src/check",
        closed: true,
        records: Some(&[
            // Declarations as they are handed on.
            "Class",
            "Conversion",
            "Declared",
            "Enumerator",
            "Home",
            "Kept",
            "Membership",
            "Outcome",
            "Start",
            "Started",
            "Surrounding",
            "TextConversion",
            "TimedFunction",
            "TypedImage",
            "Within",
        ]),
        known: &[],
    },
];

/// Every folder of a crate's sources that has enough modules, with what is in it.
fn floors() -> Vec<(String, Rooms)> {
    let mut found = Vec::new();
    for member in workspace::crates() {
        for folder in workspace::folders(&root().join(member).join("src")) {
            let Some(sources) = Sources::read(&folder) else { continue };
            if sources.modules.iter().filter(|place| place.len() == 1).count() >= MODULES_MIN {
                found.push((workspace::name(&folder), Rooms::new(&sources)));
            }
        }
    }
    found
}

/// The exception for a folder, of which there is one at most.
fn exception(folder: &str) -> Option<&'static Exception> {
    EXCEPTIONS.iter().find(|exception| exception.folder == folder)
}

/// The rooms of a folder in the table; a folder that is not a floor any more must leave it.
fn rooms(exception: &Exception) -> Rooms {
    let sources = Sources::read(&root().join(exception.folder));
    Rooms::new(&sources.unwrap_or_else(|| panic!("{} is not a folder of modules", exception.folder)))
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests stand in the repository")
}

fn open(fields: &[&Field]) -> String {
    let line =
        |field: &&Field| format!("    {}.{} ({}:{})\n", field.structure, field.name, field.file.display(), field.line);
    fields.iter().map(line).collect()
}

/// What stands where, for a message.
fn lines(arrows: &[&Arrow]) -> String {
    arrows.iter().map(|arrow| format!("    {arrow}\n")).collect()
}

#[test]
fn arrows_between_rooms_point_one_way() {
    let mut found = String::new();
    let floors = floors();
    for (folder, rooms) in &floors {
        let known = exception(folder).map_or(&[][..], |exception| exception.known);
        let circles = rooms.circles();
        for circle in circles.iter().filter(|circle| !known.iter().any(|(known, _)| *circle == known)) {
            found += &format!("{folder}: circle of {}\n{}", circle.join(", "), lines(&rooms.inside(circle)));
        }
        for (gone, _) in known.iter().filter(|(known, _)| !circles.iter().any(|circle| circle == known)) {
            found += &format!("{folder}: the circle of {} is gone, so it is not known any more\n", gone.join(", "));
        }
    }
    for exception in EXCEPTIONS.iter().filter(|exception| floors.iter().all(|(folder, _)| folder != exception.folder)) {
        found += &format!("{}: has fewer than {MODULES_MIN} modules, so it needs no exception\n", exception.folder);
    }
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn a_closed_room_is_entered_through_its_interface() {
    let mut found = String::new();
    for floor in EXCEPTIONS.iter().filter(|floor| floor.closed) {
        let rooms = rooms(floor);
        let past = rooms.past_interfaces();
        if !past.is_empty() {
            found += &format!("{}: past a room's interface\n{}", floor.folder, lines(&past));
        }
    }
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn rooms_keep_their_fields() {
    let mut found = String::new();
    for floor in EXCEPTIONS {
        let Some(records) = floor.records else { continue };
        let rooms = rooms(floor);
        let fields = rooms.open_fields(records);
        if !fields.is_empty() {
            found += &format!("{}: fields that other rooms see\n{}", floor.folder, open(&fields));
        }
    }
    assert!(found.is_empty(), "\n{found}");
}
