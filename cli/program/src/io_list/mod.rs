//! Lists of a PLC's inputs and outputs, as engineering tools write them.
//!
//! | module | subject |
//! |---|---|
//! | [`error`] | why a list cannot be read |
//! | [`point`] | one input or output, and where it is in the list |
//! | [`flatten`] | names of types; arrays and structures taken apart |
//! | [`collect`] | points in the order of the list, and what was left out |
//! | `xml` | the elements of a list in XML, with their lines |
//! | [`twincat`], `twincat_types` | TwinCAT projects, their parts, and the types that they declare |
//! | [`eni`] | EtherCAT Network Information |
//! | [`tia`] | what all forms of a tag table of TIA Portal share |
//! | [`tia_xlsx`], [`tia_xml`], [`tia_text`] | the forms |
//! | [`codesys`] | the I/O mapping that CODESYS writes as CSV |
//! | [`sources`] | PLC sources with located variables: program text, PLCopen XML, TwinCAT objects |
//! | [`browsed`] | what a PLC says it has |
//!
//! Invariants. No file can make a reader fail otherwise than by an error, whatever is in it: sizes are bounded,
//! entities are not expanded. What is not taken over is named, with its line.

pub mod browsed;
pub mod codesys;
pub mod collect;
pub mod eni;
pub mod error;
pub mod flatten;
pub mod point;
pub mod sources;
pub mod tia;
pub mod tia_text;
pub mod tia_xlsx;
pub mod tia_xml;
pub mod twincat;
mod twincat_types;
mod xml;

use std::path::{Path, PathBuf};

use onescan_base::regular::{self, Limit};
use onescan_server::time::TimeSpan;

pub use error::ListError;
pub use point::{Direction, IoPoint, LeftOut, Place};

use onescan_runner::error::{Unreadable, Usage};

/// Largest list that is read, in bytes.
pub const BYTES_MAX: u64 = 64 << 20;

/// What wrote a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListKind {
    /// A TwinCAT project (`.tsproj`), a part of one (`.xti`), or the description of a compiled PLC (`.tmc`).
    TwinCat,
    Eni,
    /// A tag table of TIA Portal as a workbook.
    TiaXlsx,
    /// A tag table of TIA Portal as `SimaticML`.
    TiaXml,
    /// A tag table of TIA Portal or STEP 7 as text.
    TiaText,
    /// The I/O mapping of CODESYS as CSV.
    Codesys,
    Sources,
    /// A PLC that says itself what it has, over OPC UA or ADS.
    Server,
}

impl ListKind {
    /// What it is, for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::TwinCat => "TwinCAT project",
            Self::Eni => "EtherCAT Network Information",
            Self::TiaXlsx => "PLC tags of TIA Portal, XLSX",
            Self::TiaXml => "PLC tags of TIA Portal, XML",
            Self::TiaText => "PLC tags of TIA Portal, text",
            Self::Codesys => "I/O mapping of CODESYS, CSV",
            Self::Sources => "PLC sources",
            Self::Server => "PLC that was browsed",
        }
    }
}

/// How a gateway would reach what is in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ListLink {
    /// Symbols of a TwinCAT PLC at this AMS port.
    Ads(Option<u16>),
    /// Variables of a server.
    Server {
        /// Its URL, as a gateway takes it.
        url: String,
        /// True if it has words about the PLC itself.
        system_words: bool,
    },
}

/// A list as it was read.
#[derive(Clone, Debug)]
pub struct IoList {
    pub kind: ListKind,
    /// Where it was found, for people.
    pub from: String,
    /// Its points in its order.
    pub points: Vec<IoPoint>,
    /// What is in it and cannot be a signal.
    pub left_out: Vec<LeftOut>,
    /// How the PLC can be reached, if the list says so.
    pub link: Option<ListLink>,
    /// The cycle time of the PLC's fastest task, if the list says so.
    pub cycle: Option<TimeSpan>,
    /// The PLC's own sources, if the list was read from them.
    pub sources: Option<sources::Sources>,
}

/// What is to be read.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// A file, a folder, or the URL of a PLC that can be browsed.
    pub from: String,
    /// What wrote it; if absent, what its name and text say.
    pub kind: Option<ListKind>,
    /// Of a project with several PLCs, which one.
    pub plc: Option<String>,
}

/// Reads a list.
///
/// # Errors
/// It cannot be read, or is none.
pub fn read(wanted: &Wanted) -> Result<IoList, ListError> {
    if wanted.kind == Some(ListKind::Server) || wanted.from.contains("://") {
        return browsed::read(&wanted.from);
    }
    let path = PathBuf::from(&wanted.from);
    let project = path.is_dir().then(|| project_in(&path)).transpose()?.flatten();
    let path = project.unwrap_or(path);
    let mut list = if path.is_dir() { sources::read(&path)? } else { of_file(&path, wanted)? };
    list.from = path.display().to_string();
    if list.points.is_empty() {
        let (title, left_out, help) = (list.kind.title(), list.left_out.len(), error::help_for_empty(list.kind));
        return Err(ListError::Empty { file: list.from, title, left_out, help });
    }
    Ok(list)
}

fn of_file(path: &Path, wanted: &Wanted) -> Result<IoList, ListError> {
    let bytes = bytes_of(path)?;
    let kind = match wanted.kind {
        Some(kind) => kind,
        None => guess(path, &bytes)?,
    };
    match kind {
        ListKind::TwinCat => twincat::read(path, &bytes, wanted.plc.as_deref()),
        ListKind::Eni => eni::read(path, &bytes),
        ListKind::TiaXlsx => tia_xlsx::read(path, bytes),
        ListKind::TiaXml => tia_xml::read(path, &bytes),
        ListKind::TiaText => tia_text::read(path, &bytes),
        ListKind::Codesys => codesys::read(path, &bytes),
        ListKind::Sources => sources::read(path),
        ListKind::Server => browsed::read(&wanted.from),
    }
}

/// What is in a file, unless it is too large to be a list.
fn bytes_of(path: &Path) -> Result<Vec<u8>, ListError> {
    let size = std::fs::metadata(path).map_err(Unreadable::at(path))?.len();
    if size > BYTES_MAX {
        return Err(ListError::TooLarge { file: path.display().to_string(), mib: BYTES_MAX >> 20 });
    }
    Ok(regular::read(path, Limit::TEXT).map_err(Unreadable::at(path))?)
}

/// The only TwinCAT project in a folder or in the folders in it.
fn project_in(folder: &Path) -> Result<Option<PathBuf>, ListError> {
    let is_project =
        |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("tsproj"));
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    for depth in 0..2 {
        let mut below = Vec::new();
        for folder in folders {
            for entry in std::fs::read_dir(&folder).map_err(Unreadable::at(&folder))? {
                let path = entry.map_err(Unreadable::at(&folder))?.path();
                if path.is_dir() && !path.is_symlink() && depth == 0 {
                    below.push(path);
                } else if is_project(&path) {
                    found.push(path);
                }
            }
        }
        folders = below;
    }
    found.sort();
    if let [first, second, ..] = &found[..] {
        let help = format!("name one of them, as in `--from {}`", first.display());
        let text =
            format!("there are several projects in {}: {} and {}", folder.display(), first.display(), second.display());
        return Err(Usage::new(text, Some(help)).into());
    }
    Ok(found.pop())
}

/// What a file is, by its name, and where many kinds share a name, by its text.
fn guess(path: &Path, bytes: &[u8]) -> Result<ListKind, ListError> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 16)]).replace('\0', "");
    let has = |text: &str| head.contains(text);
    Ok(match extension.as_deref().unwrap_or_default() {
        "tsproj" | "xti" | "tmc" => ListKind::TwinCat,
        "eni" => ListKind::Eni,
        "xlsx" | "xlsm" => ListKind::TiaXlsx,
        "csv" | "txt" if head.to_ascii_lowercase().contains("codesys mapping export") => ListKind::Codesys,
        "sdf" | "csv" | "txt" => ListKind::TiaText,
        "xml" if has("<EtherCATConfig") => ListKind::Eni,
        "xml" if has("SW.Tags.") || has("<Tagtable") => ListKind::TiaXml,
        "xml" if has("<TcSmProject") || has("<TcSmItem") || has("<TcModuleClass") => ListKind::TwinCat,
        _ if onescan_iec::input::kind::FileKind::of(path).is_some() => ListKind::Sources,
        _ => {
            let help =
                "lists are read from TwinCAT (.tsproj, .xti, .tmc, ENI .xml), TIA Portal (.xlsx, .xml, .sdf, .csv), \
                        CODESYS (.csv, PLCopen .xml), PLC sources and opc.tcp:// URLs; `--as` names the kind"
                    .to_owned();
            return Err(
                Usage::new(format!("{} is not an I/O list that onescan reads", path.display()), Some(help)).into()
            );
        }
    })
}

#[cfg(test)]
mod tests;
