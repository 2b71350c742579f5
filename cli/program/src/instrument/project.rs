//! Which files are meant by what was typed, and which files are written.

use std::path::{Component, Path, PathBuf};

use onescan_base::regular::{self, Limit};
use onescan_iec::Input;
use onescan_iec::input::encoding::{Charset, Encoding, encode};
use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec_project::instrument::{File, Project};
use onescan_report::file::Write;
use onescan_scenario::permission::granted;
use onescan_server::signal::{ClientName, did_you_mean};

use super::error::InstrumentError;
use super::{Destination, InstrumentConfig};
use onescan_regress::check::collect::{self, Program, Reading};
use onescan_runner::error::{Unreadable, Usage};

/// The program behind `project`, and the shim's own files beside it.
///
/// # Errors
/// A file is not there, cannot be read, or is of no kind that is read; or there are several programs.
pub fn program(project: &Path, client: Option<&ClientName>) -> Result<Program, InstrumentError> {
    let mut programs = collect::programs(&[project.to_owned()], Reading::default())?;
    let clients: Vec<String> = programs.iter().filter_map(|each| Some(each.client.as_ref()?.to_string())).collect();
    if let Some(wanted) = client {
        programs.retain(|program| program.client.as_ref() == Some(wanted));
        if programs.is_empty() {
            let help = did_you_mean(wanted.as_str(), clients.iter().map(String::as_str));
            return Err(Usage::new(format!("there is no PLC `{wanted}` with sources here"), help).into());
        }
    }
    let count = programs.len();
    let (Some(mut program), 1) = (programs.pop(), count) else {
        let help = match clients.split_last() {
            Some((last, others)) => {
                format!("say which: `--client {}` or `--client {last}`", others.join("`, `--client "))
            }
            None => "name the folder with the sources of one".to_owned(),
        };
        return Err(Usage::new(format!("there are {count} PLCs here"), Some(help)).into());
    };
    add_own(&mut program.inputs)?;
    add_manifests(project, &mut program.inputs)?;
    Ok(program)
}

/// TwinCAT projects say themselves which files they have.
fn add_manifests(path: &Path, inputs: &mut Vec<Input>) -> Result<(), InstrumentError> {
    let unreadable = Unreadable::at(path);
    if path.is_dir() {
        let mut entries = Vec::new();
        for entry in std::fs::read_dir(path).map_err(&unreadable)? {
            entries.push(entry.map_err(&unreadable)?.path());
        }
        entries.sort();
        // A link to a folder may lead in a circle.
        let inner = |entry: &&PathBuf| !entry.is_symlink() && (entry.is_dir() || is_manifest(entry));
        entries.iter().filter(inner).try_for_each(|entry| add_manifests(entry, inputs))
    } else if is_manifest(path) {
        let bytes = regular::read(path, Limit::TEXT).map_err(&unreadable)?;
        let name = path.strip_prefix(".").unwrap_or(path).display().to_string();
        inputs.push(Input::read(&name, SourceKind::Text, &bytes));
        Ok(())
    } else {
        Ok(())
    }
}

fn is_manifest(path: &Path) -> bool {
    FileKind::of(path) == Some(FileKind::Project)
}

/// A scenario names its sources, and so not those that were added to it.
fn add_own(inputs: &mut Vec<Input>) -> Result<(), InstrumentError> {
    let Some(first) = inputs.first().map(|input| PathBuf::from(input.file().name())) else {
        return Ok(());
    };
    let folder = first.parent().unwrap_or(Path::new(""));
    let shown = if folder == Path::new("") { Path::new(".") } else { folder };
    let unreadable = Unreadable::at(shown);
    let mut own = Vec::new();
    for entry in std::fs::read_dir(shown).map_err(&unreadable)? {
        let path = folder.join(entry.map_err(&unreadable)?.file_name());
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().to_lowercase());
        let known = inputs.iter().any(|input| Path::new(input.file().name()) == path);
        if name.starts_with("sdsp") && !known && path.is_file() {
            own.push(path);
        }
    }
    own.sort();
    for path in own {
        if let Some(FileKind::Source(kind)) = FileKind::of(&path) {
            let bytes = granted().within(shown).read(&path, Limit::TEXT).map_err(Unreadable::at(&path))?;
            inputs.push(Input::read(&path.display().to_string(), kind, &bytes));
        }
    }
    Ok(())
}

/// What is to be written, deleted files among it.
///
/// # Errors
/// A file lies outside of the project, or cannot be encoded.
pub(super) fn writes(config: &InstrumentConfig, project: &Project) -> Result<Vec<Write>, InstrumentError> {
    let mut writes = Vec::new();
    for file in &project.files {
        let path = match &config.destination {
            Destination::Nowhere => continue,
            Destination::InPlace if !file.is_changed() => continue,
            Destination::InPlace => PathBuf::from(&file.name),
            Destination::Folder(_) if file.text.is_none() => continue,
            // What is imported alone needs no copies of the sources beside it.
            Destination::Folder(_) if !project.located.is_empty() && !is_whole(file, project) => continue,
            // The tool is given one file, and not a folder.
            Destination::Folder(folder) if !project.located.is_empty() => {
                folder.join(Path::new(&file.name).file_name().unwrap_or_default())
            }
            Destination::Folder(folder) => folder.join(relative(file, &config.project)?),
        };
        let bytes = match &file.text {
            None => None,
            Some(text) => {
                let encoding = file.encoding.unwrap_or(Encoding { charset: Charset::Utf8, mark: false });
                let encoded = encode(text, encoding);
                Some(encoded.map_err(|error| Usage::new(format!("{}: {error}", file.name), None))?)
            }
        };
        writes.push(Write { path, bytes });
    }
    Ok(writes)
}

fn is_whole(file: &File, project: &Project) -> bool {
    project.whole.as_ref() == Some(&file.name)
}

/// A file's path within the project.
pub(super) fn relative<'f>(file: &'f File, project: &Path) -> Result<&'f Path, InstrumentError> {
    let root = if project.is_dir() { project } else { project.parent().unwrap_or(Path::new("")) };
    let root = root.strip_prefix(".").unwrap_or(root);
    let path = Path::new(&file.name).strip_prefix(root).unwrap_or(Path::new(&file.name));
    let inside = path.components().all(|component| matches!(component, Component::Normal(_) | Component::CurDir));
    if inside {
        return Ok(path);
    }
    let help = "use --in-place, or name the folder that holds all sources".to_owned();
    Err(Usage::new(format!("{} lies outside of the project", file.name), Some(help)).into())
}
