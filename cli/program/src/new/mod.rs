//! Scenarios to begin with: complete, commented, green at once.
//!
//! | module | subject |
//! |---|---|
//! | [`from_list`] | a scenario made of an I/O list |
//! | `names` | names that signals and variables can have |
//! | `proposal` | components that signals may stand for |
//! | [`signal`] | what a list becomes: signals, and who runs as the PLC |
//! | `text` | the files of such a scenario |
//! | [`listed`] | what was taken over and what was not |
//! | [`task`] | a task to learn on, without its solutions |

mod error;
pub mod from_list;
pub mod listed;
mod names;
mod proposal;
pub mod signal;
pub mod task;
mod text;

use std::io::Write;
use std::path::Path;

use onescan_report::OutputError;
use onescan_report::file::{Write as Output, write_all_whole};
use onescan_scenario::template;
use onescan_server::signal::BadName;
use onescan_server::signal::ClientName;

pub use error::NewError;

use onescan_runner::error::Usage;

/// What to begin with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Template {
    /// Bodies, a conveyor, a sensor, pneumatics.
    #[default]
    Cell,
    /// Process engineering, no bodies.
    Tank,
    /// A plant in Python.
    Python,
    /// A program, and no machine yet.
    Blank,
}

impl Template {
    /// Files and what is in them.
    fn files(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Cell => template::CELL,
            Self::Tank => template::TANK,
            Self::Blank => template::BLANK,
            Self::Python => template::PYTHON,
        }
    }
}

/// What git leaves out of a scenario's repository.
const IGNORED: (&str, &str) = (
    ".gitignore",
    "# What waits for `onescan review`; what was reviewed, snapshots/*.traj, belongs into the repository.\n*.traj.new\n",
);

/// Writes a scenario into a folder that must not be there.
///
/// # Errors
/// The folder is there, its name cannot be a scenario's, or it cannot be written.
pub fn write(folder: &Path, template: Template, out: &mut dyn Write) -> Result<(), NewError> {
    let name = name_of(folder)?;
    let place = folder.display().to_string();
    let filled = |text: &str| text.replace("{name}", &name);
    let files = || template.files().iter().copied().chain([IGNORED]);
    let written =
        files().map(|(file, text)| Output { path: folder.join(file), bytes: Some(filled(text).into_bytes()) });
    write_all_whole(&written.collect::<Vec<_>>())?;
    for (file, _) in files() {
        writeln!(out, "{}", folder.join(file).display()).map_err(OutputError)?;
    }
    if template == Template::Python {
        let package = "pip install onescan   # brings onescan_client, which plant.py needs";
        writeln!(out, "\nnext: {package}").map_err(OutputError)?;
        return Ok(writeln!(out, "      onescan run {place}").map_err(OutputError)?);
    }
    Ok(writeln!(out, "\nnext: onescan run {place}").map_err(OutputError)?)
}

/// The name of the scenario that a folder is to hold.
fn name_of(folder: &Path) -> Result<String, Usage> {
    let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    ClientName::new(name.as_str()).map_err(|BadName(name)| {
        let help = "use letters, digits, `_` and `-`, beginning with a letter".to_owned();
        Usage::new(format!("`{name}` cannot name a scenario"), Some(help))
    })?;
    if folder.exists() {
        let help = "choose another name, or remove it first".to_owned();
        return Err(Usage::new(format!("{} is there already", folder.display()), Some(help)));
    }
    Ok(name)
}
