//! Kinds of component of the user's own: files in the folders that a scene names in `libraries`.
//!
//! | file | what it is |
//! |---|---|
//! | `NAME.st`, `.scl`, `.TcPOU`, `.xml`, … | a function block `NAME`, which the soft PLC runs |
//! | `NAME.toml` | an assembly: parts of a scene with parameters and ports |
//!
//! | module | subject |
//! |---|---|
//! | `folder` | the files in a folder of kinds |
//! | `assembly` | an assembly as it is written |
//! | `formula` | `"=stroke_m / 2"`: values computed of parameters |
//! | `instance` | a component that is an assembly, as tables of the scene |
//! | `parts` | those tables: named for their component, and moved to its place |
//! | `ports` | inputs, outputs and failure modes of an assembly, as those of its parts |
//! | [`listing`] | the kinds of a folder, for people |

mod assembly;
mod folder;
mod formula;
mod instance;
pub mod listing;
mod parts;
mod ports;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use onescan_base::nearest;
use onescan_base::regular::Limit;

use super::error::{Inside, SceneFaultKind};
use super::faults::Faults;
use super::format::{ComponentTable, SceneFile};
use super::placed::Placed;
use super::text;
use crate::component::library::kinds;
use crate::component::origin::Origin;
use crate::component::program::{Program, ProgramError};
use assembly::Assembly;
pub(super) use assembly::Header;
use folder::{Folder, Form};
use instance::Expansion;
pub(crate) use ports::Aliases;

/// The kinds that a scene's components may be of.
pub(super) struct Kinds {
    folders: Vec<Folder>,
    /// What has been read of the user's own.
    own: BTreeMap<String, Own>,
    /// The files that it was read from, in the order of reading.
    pub(super) files: Vec<PathBuf>,
}

/// A kind of the user's own.
#[derive(Clone)]
enum Own {
    Program(Origin),
    Assembly(Arc<Assembly>),
    /// It is there, and wrong: nobody shall miss it.
    Faulty,
}

/// What came of the kinds of the user's own.
pub(super) struct Expanded {
    pub(super) kinds: Kinds,
    pub(super) aliases: Aliases,
    /// What robots in assemblies were read otherwise than they are written, for people.
    pub(super) remarks: Vec<String>,
}

/// Reads the kinds of all components, and puts parts in the place of those that are assemblies. Components of kinds
/// that are not there stay as they are.
pub(super) fn expand(written: &mut SceneFile, faults: &mut Faults<'_>) -> Expanded {
    let folders = written.libraries.iter().filter_map(|named| Folder::read(named, faults)).collect();
    let mut kinds = Kinds { folders, own: BTreeMap::new(), files: Vec::new() };
    let mut expansion = Expansion::default();
    for table in std::mem::take(&mut written.component) {
        expansion.take(table, &mut kinds, written, faults);
    }
    let (aliases, remarks) = expansion.finish(written, faults);
    Expanded { kinds, aliases, remarks }
}

impl Kinds {
    /// The kind of this name that makes components, if there is one.
    pub(super) fn find(&self, name: &str) -> Option<Origin> {
        match self.own.get(name) {
            Some(Own::Program(own)) => Some(own.clone()),
            Some(Own::Assembly(_) | Own::Faulty) => None,
            None => Origin::of_library(name),
        }
    }

    /// A component of a kind that is not there.
    pub(super) fn miss(&self, kind: &Placed<String>, faults: &mut Faults<'_>) {
        if self.own.contains_key(text(kind)) {
            return;
        }
        let own = self.folders.iter().flat_map(Folder::names);
        let near = nearest(text(kind), kinds().iter().map(|kind| &*kind.name).chain(own));
        let hint = near.map_or_else(
            || "`onescan components` names those of the library, `libraries` folders with others".to_owned(),
            |near| format!("did you mean `{near}`?"),
        );
        faults.add_hinted(kind.span(), SceneFaultKind::ComponentKind(text(kind).to_owned()), Some(hint));
    }

    /// Reads the kind of this name, unless that has been done or no folder has it.
    fn read(&mut self, kind: &Placed<String>, faults: &mut Faults<'_>) -> Option<Own> {
        let name = text(kind);
        if let Some(known) = self.own.get(name) {
            return Some(known.clone());
        }
        let found: Vec<_> = self.folders.iter().flat_map(|folder| folder.find(name)).collect();
        let first = found.first()?;
        let reported = found.iter().map(|file| format!("`{}`", file.named)).collect::<Vec<_>>().join(" and ");
        let cause = match found.len() {
            _ if Origin::of_library(name).is_some() => Some(format!("{reported} is called like a kind of the library")),
            1 => None,
            _ => Some(format!("{reported} both define it")),
        };
        let own = match cause {
            Some(cause) => {
                let hint = Some("rename the file, and what it defines".to_owned());
                faults.add_hinted(kind.span(), SceneFaultKind::OwnKind { kind: name.to_owned(), cause }, hint);
                Own::Faulty
            }
            None => read(first, kind, faults).unwrap_or(Own::Faulty),
        };
        let path = first.path.clone();
        self.files.push(path);
        self.own.insert(name.to_owned(), own.clone());
        Some(own)
    }
}

/// The kind in a file; none if something is wrong with it.
fn read(file: &folder::KindFile, kind: &Placed<String>, faults: &mut Faults<'_>) -> Option<Own> {
    let name = text(kind);
    let bytes = match faults.within().read(&file.path, Limit::TEXT) {
        Ok(bytes) => bytes,
        Err(error) => {
            let cause = format!("{} cannot be read: {error}", file.named);
            faults.add(kind.span(), SceneFaultKind::OwnKind { kind: name.to_owned(), cause });
            return None;
        }
    };
    match file.form {
        Form::Program(source) => match Program::read(name, &file.named, source, &bytes) {
            Ok(program) => Some(Own::Program(Origin::program(Arc::new(program)))),
            Err(error) => {
                refuse(error, kind, faults);
                None
            }
        },
        Form::Assembly => Assembly::read(name, file, bytes, kind, faults).map(|found| Own::Assembly(Arc::new(found))),
    }
}

/// All that is wrong with a function block, at the kind that names it.
fn refuse(error: ProgramError, kind: &Placed<String>, faults: &mut Faults<'_>) {
    let name = || text(kind).to_owned();
    match error {
        ProgramError::Source(found) => {
            for fault in found {
                let start = fault.place.start();
                let cause = format!("{} line {}: {}", start.file, start.line, fault.cause);
                let inside = Inside { reported: fault.cause, place: fault.place };
                faults.add_inside(kind.span(), SceneFaultKind::OwnKind { kind: name(), cause }, fault.hint, inside);
            }
        }
        ProgramError::Run(error) => {
            faults.add(kind.span(), SceneFaultKind::OwnKind { kind: name(), cause: error.to_string() });
        }
    }
}

/// A text behind a key of a component.
fn text_of(table: &ComponentTable, key: &str) -> Option<Placed<String>> {
    let value = table.get(key)?;
    value.get_ref().as_str().map(|text| Placed::new(value.span(), text.to_owned()))
}
