//! The order of the house, read from its sources: modules of one crate stand in rooms, the arrows between rooms point
//! one way, and a closed room is entered through its interface only.
//!
//! The rooms are found by walking: every folder with three modules or more is a floor, and [`FLOORS`] has the exceptions. Modules that only tests compile do not
//! count.

#![expect(clippy::format_push_string, clippy::format_collect, reason = "the text of a failed test, written once")]

mod graph;
mod laws;
mod source;
mod tokens;

use std::path::Path;

use graph::{Arrow, Rooms};
use source::{Field, Sources};

/// What is said of a folder whose modules are rooms: the source of a crate, and every folder below it that is large enough
/// to have an order of its own. A folder without an entry in [`FLOORS`] is open and has no circles.
struct Floor {
    /// From the root of the repository.
    folder: &'static str,
    /// True if rooms are entered only through what their own modules show.
    closed: bool,
    /// Structures that are plain records, whose fields are their interface, if rooms keep the fields of all others to
    /// themselves. Nothing where fields are not looked at.
    records: Option<&'static [&'static str]>,
    /// Circles that are still there, as the names of their rooms in alphabetical order, each with the reason why it
    /// stays. A circle that is gone must go from here, too, so that it cannot come back.
    known: &'static [(&'static [&'static str], &'static str)],
}

/// How many modules make a floor: with two, an arrow back is as easily seen as written.
const ROOMS_MIN: usize = 3;

const FLOORS: &[Floor] = &[
    Floor { folder: "plc-shim/iec-run/src/compile", closed: true, records: None, known: &[] },
    Floor {
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

/// The folders with the source of each crate of the workspace, from the root of the repository.
fn crates() -> Vec<String> {
    let text = std::fs::read_to_string(root().join("Cargo.toml")).expect("the manifest of the workspace");
    let (_, members) = text.split_once("members = [").expect("a list of members");
    let (members, _) = members.split_once(']').expect("the end of the list");
    let members = members.split(',').map(|member| member.trim().trim_matches('"')).filter(|member| !member.is_empty());
    members.map(|member| format!("{member}/src")).filter(|source| root().join(source).is_dir()).collect()
}

/// Every folder of the sources with at least [`ROOMS_MIN`] modules.
fn floors() -> Vec<String> {
    let mut found = Vec::new();
    let mut open = crates();
    while let Some(folder) = open.pop() {
        let mut rooms = 0;
        for entry in std::fs::read_dir(root().join(&folder)).expect("a folder of sources") {
            let entry = entry.expect("an entry of it");
            let name = entry.file_name().into_string().expect("sources have plain names");
            if entry.path().is_dir() {
                rooms += 1;
                open.push(format!("{folder}/{name}"));
            } else if let Some(name) = name.strip_suffix(".rs") {
                rooms += usize::from(!matches!(name, "lib" | "main" | "mod" | "tests"));
            }
        }
        if rooms >= ROOMS_MIN {
            found.push(folder);
        }
    }
    found.sort();
    found
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests stand in the repository")
}

fn open(fields: &[&Field]) -> String {
    let line =
        |field: &&Field| format!("    {}.{} ({}:{})\n", field.structure, field.name, field.file.display(), field.line);
    fields.iter().map(line).collect()
}

fn rooms(folder: &str) -> Rooms {
    Rooms::new(&Sources::read(&root().join(folder)))
}

/// What stands where, for a message.
fn lines(arrows: &[&Arrow]) -> String {
    arrows.iter().map(|arrow| format!("    {arrow}\n")).collect()
}

#[test]
fn arrows_between_rooms_point_one_way() {
    let mut found = String::new();
    let folders = floors();
    for folder in &folders {
        let known = FLOORS.iter().find(|floor| floor.folder == folder).map_or(&[][..], |floor| floor.known);
        let rooms = rooms(folder);
        let circles = rooms.circles();
        for circle in &circles {
            if !known.iter().any(|(known, _)| circle == known) {
                let inside = rooms.inside(circle);
                found += &format!("{folder}: circle of {}\n{}", circle.join(", "), lines(&inside));
            }
        }
        for (known, reason) in known {
            if !circles.iter().any(|circle| circle == known) {
                let known = known.join(", ");
                found += &format!("{folder}: the circle of {known} is gone, so it is not known any more ({reason})\n");
            }
        }
    }
    for floor in FLOORS.iter().filter(|floor| !folders.iter().any(|folder| folder == floor.folder)) {
        found += &format!("{}: there is no such floor any more\n", floor.folder);
    }
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn a_closed_room_is_entered_through_its_interface() {
    let mut found = String::new();
    for floor in FLOORS.iter().filter(|floor| floor.closed) {
        let rooms = rooms(floor.folder);
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
    for floor in FLOORS {
        let Some(records) = floor.records else { continue };
        let rooms = rooms(floor.folder);
        let fields = rooms.open_fields(records);
        if !fields.is_empty() {
            found += &format!("{}: fields that other rooms see\n{}", floor.folder, open(&fields));
        }
    }
    assert!(found.is_empty(), "\n{found}");
}
