//! Rooms and the arrows between them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::PathBuf;

use crate::source::{Field, Named, Place, Sources};

/// The room of what stands in the folder's own file.
const ENTRANCE: &str = "mod";

/// That something in one room names something in another.
#[derive(Debug)]
pub struct Arrow {
    file: PathBuf,
    line: usize,
    from: String,
    to: String,
    path: String,
    /// True if it leads to a module that only the room itself may enter.
    past_interface: bool,
}

impl fmt::Display for Arrow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, from, to, path, .. } = self;
        write!(f, "{from} -> {to}: {path} ({}:{line})", file.display())
    }
}

/// The rooms of a folder.
pub struct Rooms {
    arrows: Vec<Arrow>,
    /// Fields that more than their room sees.
    open: Vec<Field>,
}

impl Rooms {
    pub fn new(sources: &Sources) -> Self {
        let arrows = sources.named.iter().filter_map(|named| arrow(sources, named)).collect();
        let open = sources.fields.iter().filter(|field| is_open(sources, field)).cloned().collect();
        Self { arrows, open }
    }

    /// The circles of rooms, each in alphabetical order.
    pub fn circles(&self) -> Vec<Vec<&str>> {
        let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        // A crate's root, and the file of a folder, name all rooms: that is what they are for.
        let of_rooms = |arrow: &&Arrow| arrow.from != ENTRANCE;
        for arrow in self.arrows.iter().filter(of_rooms) {
            next.entry(&arrow.from).or_default().insert(&arrow.to);
        }
        let mut circles: Vec<Vec<&str>> = Vec::new();
        for room in next.keys() {
            let ahead = reached(room, &next);
            let circle: Vec<&str> =
                ahead.iter().copied().filter(|other| reached(other, &next).contains(room)).collect();
            if !circle.is_empty() && !circles.contains(&circle) {
                circles.push(circle);
            }
        }
        circles
    }

    /// The arrows between the rooms of a circle, one of each kind and file.
    pub fn inside(&self, circle: &[&str]) -> Vec<&Arrow> {
        let mut seen = BTreeSet::new();
        let known = |room: &str| circle.contains(&room);
        let inside = self.arrows.iter().filter(|arrow| known(&arrow.from) && known(&arrow.to));
        inside.filter(|arrow| seen.insert((&arrow.from, &arrow.to, &arrow.file))).collect()
    }

    /// Fields of structures, except of `records`, that more than their room sees.
    pub fn open_fields(&self, records: &[&str]) -> Vec<&Field> {
        self.open.iter().filter(|field| !records.contains(&field.structure.as_str())).collect()
    }

    pub fn past_interfaces(&self) -> Vec<&Arrow> {
        self.arrows.iter().filter(|arrow| arrow.past_interface).collect()
    }
}

/// All that can be reached in one step or more.
fn reached<'r>(room: &str, next: &BTreeMap<&'r str, BTreeSet<&'r str>>) -> BTreeSet<&'r str> {
    let mut found = BTreeSet::new();
    let mut open: Vec<&str> = next.get(room).into_iter().flatten().copied().collect();
    while let Some(each) = open.pop() {
        if found.insert(each) {
            open.extend(next.get(each).into_iter().flatten().copied());
        }
    }
    found
}

fn arrow(sources: &Sources, named: &Named) -> Option<Arrow> {
    let target = absolute(sources, &named.from, &named.to)?;
    let target = followed(sources, target);
    let from = named.from.first().map_or(ENTRANCE, String::as_str).to_owned();
    let module = module_of(sources, &target);
    let to = module.first().map_or(ENTRANCE, String::as_str).to_owned();
    if from == to {
        return None;
    }
    let whole = absolute(sources, &named.from, &named.to)?;
    let entered = module_of(sources, &whole);
    // A room may show modules whose names say what their items mean; what lies below these is its own. What it shows
    // under the name of a private module is an item.
    let is_item = entered.len() == whole.len()
        && whole.split_last().is_some_and(|(name, room)| sources.imports.contains_key(&(room.to_vec(), name.clone())));
    let is_private = sources.private.contains(entered) && !is_item;
    let past_interface = entered.len() > 2 || entered.len() == 2 && is_private;
    Some(Arrow { file: named.file.clone(), line: named.line, from, to, path: named.to.join("::"), past_interface })
}

/// True if a field in a room is seen outside of the room.
fn is_open(sources: &Sources, field: &Field) -> bool {
    if field.of.is_empty() {
        return false;
    }
    // `pub` and `pub(crate)` lead out of every room; a path into the folder leads into one if it is not empty.
    let seen = absolute(sources, &field.of, &field.sight).unwrap_or_default();
    field.sight.first().is_none_or(|first| first == "crate" && field.sight.len() == 1) || seen.is_empty()
}

/// The path from the folder on; nothing for what lies outside of it.
fn absolute(sources: &Sources, from: &Place, path: &[String]) -> Option<Vec<String>> {
    let first = path.first()?.as_str();
    if first == "crate" {
        return path[1..].strip_prefix(sources.above.as_slice()).map(<[String]>::to_vec);
    }
    let mut base = from.clone();
    let mut rest = path;
    if !matches!(first, "super" | "self") {
        // A module of this one; any other name is a crate's or one that is imported.
        base.push(first.to_owned());
        return sources.modules.contains(&base).then(|| from.iter().chain(path).cloned().collect());
    }
    while let Some((step, after)) = rest.split_first() {
        match step.as_str() {
            "self" => {}
            "super" => drop(base.pop()?),
            _ => break,
        }
        rest = after;
    }
    Some(base.into_iter().chain(rest.iter().cloned()).collect())
}

/// The module that a path leads into: the longest of its beginnings that is one.
fn module_of<'p>(sources: &Sources, path: &'p [String]) -> &'p [String] {
    let is_module = |length: &usize| sources.modules.contains(&path[..*length]);
    let length = (0..=path.len()).rev().find(is_module).unwrap_or(0);
    &path[..length]
}

/// Where a path leads that goes through an import of the folder's own file: `crate::Span` is `crate::syntax::Span`.
fn followed(sources: &Sources, path: Vec<String>) -> Vec<String> {
    let Some(name) = path.first().filter(|_| module_of(sources, &path).is_empty()) else { return path };
    let Some(import) = sources.imports.get(&(Vec::new(), name.clone())) else { return path };
    absolute(sources, &Vec::new(), import).filter(|found| !found.is_empty()).unwrap_or(path)
}
