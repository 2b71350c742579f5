//! The order of the house, read from its sources: modules of one crate stand in rooms, the arrows between rooms point
//! one way, and a closed room is entered through its interface only.
//!
//! The rooms are data ([`HOUSE`]): a line names a folder whose modules are rooms. Modules that only tests compile do not
//! count.

#![expect(clippy::format_push_string, clippy::format_collect, reason = "the text of a failed test, written once")]

mod graph;
mod laws;
mod source;
mod tokens;

use std::path::Path;

use graph::{Arrow, Rooms};
use source::{Field, Sources};

/// A folder whose modules are rooms: the source of a crate, and rooms large enough to have an order of their own.
struct Floor {
    /// From the root of the repository.
    folder: &'static str,
    /// True if rooms are entered only through what their own modules show.
    closed: bool,
    /// Structures that are plain records, whose fields are their interface, if rooms keep the fields of all others to
    /// themselves. Nothing where fields are not looked at.
    records: Option<&'static [&'static str]>,
    /// Circles that are still there, as the names of their rooms in alphabetical order. A circle that is gone must go
    /// from here, too, so that it cannot come back.
    known: &'static [&'static [&'static str]],
}

const fn open_floor(folder: &'static str) -> Floor {
    Floor { folder, closed: false, records: None, known: &[] }
}

const HOUSE: &[Floor] = &[
    open_floor("base/src"),
    open_floor("base/xml/src"),
    open_floor("server/src"),
    open_floor("server/src/lockstep"),
    open_floor("server/src/wire"),
    open_floor("server/src/transport/tcp"),
    open_floor("server/recording/src"),
    open_floor("clients/src"),
    open_floor("clients/links/src/gateway"),
    open_floor("clients/plant/src/component"),
    open_floor("clients/soft-plc/src"),
    open_floor("clients/links/src/station"),
    open_floor("scenarios/src"),
    open_floor("scenarios/src/case"),
    open_floor("scenarios/src/expect"),
    open_floor("report/src"),
    open_floor("report/src/plot"),
    open_floor("cli/src"),
    open_floor("cli/src/web"),
    open_floor("plc-shim/src"),
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

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests stand in the repository")
}

fn open(fields: &[&Field]) -> String {
    let line =
        |field: &&Field| format!("    {}.{} ({}:{})\n", field.structure, field.name, field.file.display(), field.line);
    fields.iter().map(line).collect()
}

fn rooms(floor: &Floor) -> Rooms {
    let sources = Sources::read(&root().join(floor.folder));
    Rooms::new(&sources)
}

/// What stands where, for a message.
fn lines(arrows: &[&Arrow]) -> String {
    arrows.iter().map(|arrow| format!("    {arrow}\n")).collect()
}

#[test]
fn arrows_between_rooms_point_one_way() {
    let mut found = String::new();
    for floor in HOUSE {
        let rooms = rooms(floor);
        let circles = rooms.circles();
        for circle in &circles {
            if !floor.known.iter().any(|known| circle == known) {
                let inside = rooms.inside(circle);
                found += &format!("{}: circle of {}\n{}", floor.folder, circle.join(", "), lines(&inside));
            }
        }
        for known in floor.known {
            if !circles.iter().any(|circle| circle == known) {
                found += &format!(
                    "{}: the circle of {} is gone, so it is not known any more\n",
                    floor.folder,
                    known.join(", ")
                );
            }
        }
    }
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn a_closed_room_is_entered_through_its_interface() {
    let mut found = String::new();
    for floor in HOUSE.iter().filter(|floor| floor.closed) {
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
    for floor in HOUSE {
        let Some(records) = floor.records else { continue };
        let rooms = rooms(floor);
        let fields = rooms.open_fields(records);
        if !fields.is_empty() {
            found += &format!("{}: fields that other rooms see\n{}", floor.folder, open(&fields));
        }
    }
    assert!(found.is_empty(), "\n{found}");
}
