//! The sources of a submission, within limits.

use std::path::{Path, PathBuf};

use onescan_iec::Input;
use onescan_iec::input::kind::FileKind;
use onescan_scenario::load::FILE_NAME;
use onescan_server::signal::ClientName;

use super::line::text_of;
use crate::check::collect::{Program, Reading, collect};

/// Bytes that the sources of a submission may have together: a hundred times what a task asks for.
const BYTES_MAX: u64 = 2 << 20;
/// Files and folders that a submission may have, hidden ones aside.
const ENTRIES_MAX: usize = 2_000;

/// The program behind a folder or a file. A folder with a scenario is one in which somebody worked: its scenario names the
/// sources, and says nothing else here. An error says in words why there is no program.
pub(super) fn read(client: &ClientName, path: &Path) -> Result<Vec<Input>, String> {
    within_limits(path)?;
    let collected = collect(&[path.to_owned()], Reading::default()).map_err(|error| text_of(&error))?;
    let own =
        |program: Program| (program.client.is_none() || program.client.as_ref() == Some(client)).then_some(program);
    let found = collected.programs.into_iter().find_map(own);
    found.map(|program| program.inputs).ok_or_else(|| format!("its {FILE_NAME} has no soft PLC `{client}`"))
}

/// Refuses what nobody would hand in, before it is read.
fn within_limits(path: &Path) -> Result<(), String> {
    let (mut entries, mut bytes) = (0, 0);
    let mut unread: Vec<PathBuf> = vec![path.to_owned()];
    while let Some(path) = unread.pop() {
        let unreadable = |error: std::io::Error| format!("{}: {error}", path.display());
        entries += 1;
        if entries > ENTRIES_MAX {
            return Err(format!("it has more than {ENTRIES_MAX} files and folders"));
        }
        // A link to a folder is not followed when sources are looked for either, unless it is the submission itself.
        if path.is_dir() && (entries == 1 || !path.is_symlink()) {
            for entry in std::fs::read_dir(&path).map_err(unreadable)? {
                let entry = entry.map_err(unreadable)?;
                if !entry.file_name().to_string_lossy().starts_with('.') {
                    unread.push(entry.path());
                }
            }
        } else if FileKind::of(&path).is_some() && path.is_file() {
            bytes += std::fs::metadata(&path).map_err(unreadable)?.len();
        }
    }
    if bytes > BYTES_MAX {
        return Err(format!("its sources have {bytes} bytes, and {BYTES_MAX} are read"));
    }
    Ok(())
}
