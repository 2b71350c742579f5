//! A task to learn on: one of the program, or a folder of somebody's, without what gives its solution away.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use onescan_base::regular::{self, Limit};
use onescan_report::OutputError;
use onescan_report::file::{Write as Output, write_all_whole};
use onescan_report::table;
use onescan_report::view::Side;
use onescan_scenario::Scenario;
use onescan_scenario::file::ClientFile;
use onescan_scenario::handed_out::is_handed_out;
use onescan_scenario::load::FILE_NAME;
use onescan_scenario::task::Task;
use onescan_server::signal::did_you_mean;
use serde_json::json;

use super::{NewError, name_of};
use crate::plant::describe::{self, DescribeConfig};
use onescan_runner::error::{Unreadable, Usage};
use onescan_runner::format::Format;

/// The sheet of a task, and where those of the program are at home.
const SHEET: &str = "README.md";
const TASKS: &str = "scenarios/learn";
/// The drawing of the machine that a sheet shows.
const DRAWING: &str = "machine.svg";

/// Writes a task into a folder that must not be there, and says what comes next.
///
/// # Errors
/// The program has not such a task and it is not a folder with one, the folder is there, or it cannot be written.
pub fn write(folder: &Path, task: &str, out: &mut dyn Write) -> Result<(), NewError> {
    name_of(folder)?;
    let files = match Task::named(task) {
        Some(task) => of_program(task, folder),
        None => of_folder(task)?,
    };
    let output = |(file, bytes): &(PathBuf, Vec<u8>)| Output { path: folder.join(file), bytes: Some(bytes.clone()) };
    write_all_whole(&files.iter().map(output).collect::<Vec<_>>())?;
    for (file, _) in &files {
        writeln!(out, "{}", folder.join(file).display()).map_err(OutputError)?;
    }
    let drawing = folder.join(DRAWING);
    if !drawing.exists() {
        let (path, svg, side) = (folder.to_owned(), Some(drawing), Side::default());
        describe::write(&DescribeConfig { path, format: Format::Human, svg, side, dynamics: false }, &mut io::sink())?;
    }
    Ok(next(folder, &Scenario::load(folder)?, out).map_err(OutputError)?)
}

/// The files of one of the program's tasks. The commands of its sheet name the folder that it is in now.
fn of_program(task: &Task, folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let (home, place) = (format!("{TASKS}/{}", task.name), folder.display().to_string());
    let written = |file: &str, text: &str| if file == SHEET { text.replace(&home, &place) } else { text.to_owned() };
    task.files.iter().map(|(file, text)| (PathBuf::from(file), written(file, text).into_bytes())).collect()
}

/// The next three steps: what is wanted, what is there, what it is worth.
fn next(folder: &Path, scenario: &Scenario, out: &mut dyn Write) -> io::Result<()> {
    let place = folder.display();
    let sources = scenario.file().clients.values().find_map(|client| match client.get_ref() {
        ClientFile::SoftPlc { sources, .. } => sources.first(),
        _ => None,
    });
    let program = sources.map_or_else(|| place.to_string(), |source| folder.join(source).display().to_string());
    let sheet = folder.join(SHEET);
    writeln!(out, "\nnext: read {}, and write {program}", sheet.display())?;
    writeln!(out, "      onescan run {place} --web 127.0.0.1:8080")?;
    writeln!(out, "      onescan grade {place} {program}")
}

/// What is handed out of a folder with a task.
fn of_folder(task: &str) -> Result<Vec<(PathBuf, Vec<u8>)>, NewError> {
    let folder = Path::new(task);
    if !folder.join(FILE_NAME).is_file() {
        let help = did_you_mean(task, Task::all().iter().map(|task| task.name));
        let help = help.unwrap_or_else(|| {
            format!("`onescan templates` lists its tasks; for one of your own, name a folder with a {FILE_NAME}")
        });
        return Err(Usage::new(format!("onescan has no task `{task}`"), Some(help)).into());
    }
    let mut files = Vec::new();
    gather(folder, Path::new(""), &mut files)?;
    Ok(files)
}

fn gather(task: &Path, below: &Path, files: &mut Vec<(PathBuf, Vec<u8>)>) -> Result<(), Unreadable> {
    let folder = task.join(below);
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(Unreadable::at(&folder))? {
        entries.push(entry.map_err(Unreadable::at(&folder))?.file_name());
    }
    entries.sort();
    for name in entries {
        let own = below.join(name);
        let path = task.join(&own);
        // A link may lead out of the task, or in a circle.
        if !is_handed_out(&own) || path.is_symlink() {
            continue;
        }
        if path.is_dir() {
            gather(task, &own, files)?;
        } else {
            files.push((own, regular::read(&path, Limit::TEXT).map_err(Unreadable::at(&path))?));
        }
    }
    Ok(())
}

/// Lists `templates`, which are names with a line each, and the tasks of the program.
///
/// # Errors
/// Those of `out`.
pub fn list(templates: &[(String, String)], format: Format, out: &mut dyn Write) -> io::Result<()> {
    let tasks: Vec<(String, String)> = Task::all().iter().map(|task| (task.name.to_owned(), task.title())).collect();
    if format == Format::Json {
        let all = |list: &[(String, String)]| -> Vec<serde_json::Value> {
            list.iter().map(|(name, about)| json!({ "name": name, "about": about })).collect()
        };
        writeln!(out, "{}", json!({ "templates": all(templates), "tasks": all(&tasks) }))?;
        return out.flush();
    }
    for (heading, list) in [
        ("to begin with: onescan new my-cell --template NAME", templates),
        ("to learn on: onescan new my-machine --task NAME", &tasks),
    ] {
        if !list.is_empty() {
            writeln!(out, "{heading}")?;
            let rows: Vec<Vec<String>> = list.iter().map(|(name, about)| vec![name.clone(), about.clone()]).collect();
            table::write(&rows, out)?;
        }
    }
    out.flush()
}
