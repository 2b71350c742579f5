//! The I/O mapping that CODESYS writes as CSV (`Export mappings to CSV`), with commas or semicolons.

use std::path::Path;

use super::collect::{Collected, Entry};
use super::error::ListError;
use super::flatten::Nothing;
use super::point::Direction;
use super::tia_text::records;
use super::xml::text;
use super::{IoList, ListKind};

/// Reads the mapped variables.
///
/// # Errors
/// It is not a mapping.
pub fn read(path: &Path, bytes: &[u8]) -> Result<IoList, ListError> {
    let text = text(path, bytes)?;
    let delimiter = if text.lines().take(3).any(|line| line.contains(';')) { b';' } else { b',' };
    let mut collected = Collected::of(path);
    let records = records(path, &text, delimiter)?;
    let is_mapping = records.first().is_some_and(|(_, first)| {
        first.get(0).is_some_and(|title| title.to_ascii_lowercase().contains("codesys mapping export"))
    });
    if !is_mapping {
        let what = "it does not begin with `//CoDeSys Mapping Export`".to_owned();
        let help = Some("in the context menu of a device: `Export mappings to CSV`".to_owned());
        return Err(ListError::Other { file: path.display().to_string(), what, help });
    }
    for (line, record) in &records {
        let field = |at: usize| record.get(at).map(str::trim).unwrap_or_default();
        let (name, parameter, unit, about, address) = (field(0), field(1), field(2), field(3), field(4));
        // Channels without a variable are listed, too.
        if name.is_empty() || name.starts_with("//") || parameter.starts_with("//") {
            continue;
        }
        let Some((direction, ty)) = place(address) else {
            let why = format!("`{address}` is neither an input nor an output");
            collected.leave_out(name, why, Some(*line));
            continue;
        };
        // A mapping to a variable that is there already names it with its application.
        let name = name.strip_prefix("Application.").unwrap_or(name);
        let device = field(5);
        let about = [about, unit, device].into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(", ");
        let (address, comment, line) = (Some(address), Some(about.as_str()), Some(*line));
        collected.take(&Entry { name, ty, direction, address, comment, line }, &Nothing)?;
    }
    Ok(collected.list(ListKind::Codesys))
}

/// The direction of an address, and the type that its size stands for: the mapping has no types.
fn place(address: &str) -> Option<(Direction, &'static str)> {
    let mut letters = address.strip_prefix('%')?.chars();
    let direction = match letters.next()?.to_ascii_uppercase() {
        'I' => Direction::Input,
        'Q' => Direction::Output,
        _ => return None,
    };
    let ty = match letters.next()?.to_ascii_uppercase() {
        'X' => "BOOL",
        'B' => "BYTE",
        'W' => "WORD",
        'D' => "DWORD",
        'L' => "LWORD",
        digit if digit.is_ascii_digit() => "BOOL",
        _ => return None,
    };
    Some((direction, ty))
}
