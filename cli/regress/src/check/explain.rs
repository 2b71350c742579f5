//! The page behind a code.

use std::io::{self, Write};

use onescan_iec::{Code, explain};
use onescan_report::OutputError;

use super::error::CheckError;
use onescan_runner::error::Usage;

/// Writes every code with a line about it.
///
/// # Errors
/// Those of `out`.
pub fn list(out: &mut dyn Write) -> io::Result<()> {
    Code::ALL.iter().try_for_each(|code| writeln!(out, "{}  {}", code.text(), code.about()))
}

/// Writes the page of a code, in any case.
///
/// # Errors
/// There is no such code.
pub fn page(code: &str, out: &mut dyn Write) -> Result<(), CheckError> {
    let found = Code::ALL.iter().copied().find(|known| known.text().eq_ignore_ascii_case(code));
    let text = found.and_then(explain::page).ok_or_else(|| {
        let help = "`onescan explain --list` names them all".to_owned();
        Usage::new(format!("there is no code `{code}`"), Some(help))
    })?;
    Ok(out.write_all(text.as_bytes()).map_err(OutputError)?)
}
