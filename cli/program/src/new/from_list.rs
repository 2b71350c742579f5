//! A scenario made of an I/O list: signals, a plant whose signals are zero, and the PLC or a stand-in for it.

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_report::file::{Write as Output, write_all_whole};

use super::listed::{Listed, report};
use super::names::Taken;
use super::signal::{Plc, Signal};
use super::{IGNORED, NewError, name_of, proposal, text};
use crate::io_list::{self, IoList, Wanted};
use onescan_runner::error::Unreadable;
use onescan_runner::format::Format;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct FromListConfig {
    /// The folder to make.
    pub folder: PathBuf,
    pub list: Wanted,
    /// For whom the report is.
    pub format: Format,
}

/// Makes the scenario, and reports to `out`.
///
/// # Errors
/// The list cannot be read, or the scenario not be written.
pub fn write(config: &FromListConfig, out: &mut dyn Write) -> Result<(), NewError> {
    let name = name_of(&config.folder)?;
    let list = io_list::read(&config.list)?;
    let mut taken = Taken::default();
    let signals: Vec<_> =
        list.points.iter().map(|point| Signal { name: taken.signal(&point.name), point: point.clone() }).collect();
    let mut variables = Taken::default();
    let variables: Vec<_> = signals.iter().map(|signal| (signal, variables.variable(&signal.name))).collect();
    let plc = plc(&config.folder, &list, &variables)?;
    let proposals = proposal::of(&signals);
    let mut files = vec![
        ("scenario.toml", text::scenario(&name, &list, &signals, &plc)),
        ("README.md", text::readme(&name, &list, &plc, proposals.len())),
        (IGNORED.0, IGNORED.1.to_owned()),
    ];
    if !proposals.is_empty() {
        files.push(("plant.toml", proposal::scene(&name, &proposals)));
    }
    if matches!(plc, Plc::StandIn { .. }) {
        files.push(("plc/main.st", text::stand_in(&name, &variables)));
    }
    let written: Vec<_> = files
        .iter()
        .map(|(file, text)| Output { path: config.folder.join(file), bytes: Some(text.clone().into_bytes()) })
        .collect();
    write_all_whole(&written)?;
    let files: Vec<_> = files.iter().map(|(file, _)| config.folder.join(file).display().to_string()).collect();
    let listed =
        Listed { folder: &config.folder, files: &files, list: &list, signals: &signals, proposals: &proposals };
    Ok(report(&listed, config.format, out)?)
}

fn plc(folder: &Path, list: &IoList, variables: &[(&Signal, String)]) -> Result<Plc, NewError> {
    let Some(sources) = &list.sources else {
        let bind = variables.iter().filter(|(signal, variable)| !signal.name.eq_ignore_ascii_case(variable));
        let bind = bind.map(|(signal, variable)| (signal.name.clone(), format!("Main.{variable}"))).collect();
        return Ok(Plc::StandIn { bind });
    };
    let bind = variables.iter().filter_map(|(signal, _)| {
        let variable = sources.variables.get(&signal.point.name)?;
        Some((signal.name.clone(), variable.clone()))
    });
    let files: Result<_, Unreadable> = sources.files.iter().map(|file| seen_from(folder, file)).collect();
    Ok(Plc::Sources {
        files: files.map_err(io_list::ListError::from)?,
        programs: sources.programs.clone(),
        bind: bind.collect(),
    })
}

/// The way from a folder that is to be made to a file.
fn seen_from(folder: &Path, file: &Path) -> Result<String, Unreadable> {
    let file = file.canonicalize().map_err(Unreadable::at(file))?;
    let above = match folder.parent() {
        Some(above) if above != Path::new("") => above,
        _ => Path::new("."),
    };
    // Where the folder is to be made, there may be no folder yet: then the file is named from the root.
    let Ok(above) = above.canonicalize() else { return Ok(file.display().to_string()) };
    let shared = above.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let up = above.components().skip(shared).map(|_| Path::new("..").as_os_str());
    let down = file.components().skip(shared).map(|part| part.as_os_str().to_owned());
    let way: PathBuf = std::iter::once(Path::new("..").as_os_str().to_owned())
        .chain(up.map(std::ffi::OsStr::to_owned))
        .chain(down)
        .collect();
    Ok(way.display().to_string().replace('\\', "/"))
}
