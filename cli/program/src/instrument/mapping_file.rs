//! The gateway's mapping beside an instrumented project: written with the shim, and deleted with it.

use std::path::{Path, PathBuf};

use onescan_base::regular::{self, Limit};
use onescan_iec_project::instrument::Project;
use onescan_report::file::Write as FileWrite;

use super::error::InstrumentError;
use super::{Destination, InstrumentConfig};
use onescan_runner::error::{Unreadable, Usage};

/// The name of the file.
const FILE: &str = "gateway.toml";
/// Its first line: who finds it may write the file again, and delete it.
const MARK: &str = "# Written by `onescan instrument`, which deletes it with --remove.\n";

/// The file with its mapping.
///
/// # Errors
/// A file of somebody else stands there, or cannot be read.
pub(super) fn written(path: &Path, mapping: &str) -> Result<FileWrite, InstrumentError> {
    if path.exists() && !is_own(path)? {
        let help = "rename it, or choose another folder with -o".to_owned();
        let message = format!("{} was not written by `onescan instrument`, and is left as it is", path.display());
        return Err(Usage::new(message, Some(help)).into());
    }
    Ok(FileWrite { path: path.to_owned(), bytes: Some(format!("{MARK}{mapping}").into_bytes()) })
}

/// The file that goes from beside the shim, as the shim does, or as another target has none.
///
/// # Errors
/// It cannot be read.
pub(super) fn deleted(config: &InstrumentConfig, project: &Project) -> Result<Option<FileWrite>, InstrumentError> {
    if config.destination != Destination::InPlace {
        return Ok(None);
    }
    let Some(path) = beside_shim(project).filter(|path| path.exists()) else { return Ok(None) };
    Ok(if is_own(&path)? { Some(FileWrite { path, bytes: None }) } else { None })
}

fn is_own(path: &Path) -> Result<bool, InstrumentError> {
    let bytes = regular::read(path, Limit::TEXT).map_err(Unreadable::at(path))?;
    Ok(bytes.starts_with(MARK.as_bytes()))
}

/// Where the file stands; nothing if nothing is written.
pub(super) fn place(config: &InstrumentConfig, project: &Project) -> Option<PathBuf> {
    match &config.destination {
        Destination::Nowhere => None,
        Destination::Folder(folder) => Some(folder.join(FILE)),
        Destination::InPlace => {
            project.whole.as_ref().map(|whole| Path::new(whole).with_file_name(FILE)).or_else(|| beside_shim(project))
        }
    }
}

/// The file beside the first of the shim's own.
fn beside_shim(project: &Project) -> Option<PathBuf> {
    let is_shim = |path: &&Path| {
        path.file_name().is_some_and(|name| name.to_string_lossy().to_ascii_lowercase().starts_with("sdsp"))
    };
    let mut files = project.files.iter().map(|file| Path::new(&file.name));
    files.find(is_shim).map(|shim| shim.with_file_name(FILE))
}
