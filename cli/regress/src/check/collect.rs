//! Which files are meant by what was typed, and what is in them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use onescan_base::regular::{self, Limit};
use onescan_iec::input::kind::{EXTENSIONS, FileKind};
use onescan_iec::input::needed;
use onescan_iec::input::project;
use onescan_iec_project::instrument;
use onescan_iec::{Code, Dialect, Input, MemoryLimit, TaskPlan};
use onescan_scenario::Scenario;
use onescan_scenario::load::FILE_NAME;
use onescan_server::signal::ClientName;

use super::error::CheckError;
use super::stubs::FOLDER as LIBRARIES;
use onescan_runner::error::{Unreadable, Usage};

/// Files that are checked together.
pub struct Program {
    /// The files.
    pub inputs: Vec<Input>,
    /// The client of a scenario that it is the program of.
    pub client: Option<ClientName>,
    /// Which programs run in which task, where that is known.
    pub plan: Option<TaskPlan>,
    /// How much memory its variables may take.
    pub memory_limit: MemoryLimit,
}

/// How files are read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading<'a> {
    /// The dialect of all files; it takes precedence over those of scenarios and files.
    pub dialect: Option<Dialect>,
    /// How much memory variables may take; it takes precedence over that of scenarios.
    pub memory_limit: Option<MemoryLimit>,
    /// Sources of libraries that the files use.
    pub libraries: &'a [PathBuf],
}

/// The programs behind `paths`: each soft PLC of a scenario, and all other files, with their libraries, as one.
///
/// # Errors
/// A file is not there, cannot be read, or is of no kind that is read.
pub fn programs(paths: &[PathBuf], reading: Reading) -> Result<Vec<Program>, CheckError> {
    let Reading { dialect, memory_limit, libraries } = reading;
    let mut programs = Vec::new();
    let mut files = Files { dialect, ..Files::default() };
    for path in paths {
        if path.is_dir() && !path.join(FILE_NAME).is_file() {
            files.folder(path)?;
        } else if path.is_dir() || path.file_name().is_some_and(|name| name == FILE_NAME) {
            programs.extend(scenario(path, dialect, memory_limit)?);
        } else {
            files.named(path)?;
        }
    }
    if !files.inputs.is_empty() {
        files.libraries(libraries)?;
        let memory_limit = memory_limit.unwrap_or_default();
        programs.push(Program { inputs: needed(files.inputs), client: None, plan: None, memory_limit });
    }
    if programs.is_empty() {
        let known: Vec<_> = EXTENSIONS.iter().map(|(extension, _)| format!(".{extension}")).collect();
        let help = format!("files with PLC sources end in {}", known.join(" "));
        return Err(Usage::new("there are no PLC sources here", Some(help)).into());
    }
    if files.seen.is_empty() && !libraries.is_empty() {
        let help = "the PLCs of a scenario name all their sources in `scenario.toml`".to_owned();
        return Err(Usage::new("`--library` is for PLC sources, and there are none here", Some(help)).into());
    }
    Ok(programs)
}

fn scenario(
    path: &Path,
    chosen: Option<Dialect>,
    chosen_limit: Option<MemoryLimit>,
) -> Result<Vec<Program>, CheckError> {
    let scenario = Scenario::load(path)?;
    let mut programs = Vec::new();
    for plc in scenario.plcs() {
        let mut files = Files { dialect: chosen.or(plc.dialect), ..Files::default() };
        for source in plc.sources {
            files.named(&scenario.folder().join(source))?;
        }
        let memory_limit = chosen_limit.unwrap_or(plc.memory_limit);
        let client = Some(plc.name.clone());
        programs.push(Program { inputs: files.inputs, client, plan: plc.plan, memory_limit });
    }
    Ok(programs)
}

/// Files, each once.
#[derive(Default)]
struct Files {
    /// The dialect of all of them, if not the one that each file's name says.
    dialect: Option<Dialect>,
    inputs: Vec<Input>,
    seen: BTreeSet<PathBuf>,
    part: Part,
}

/// Whose files are being read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
enum Part {
    /// The program's own.
    #[default]
    Own,
    /// A library's, with the namespace that its project gives it.
    Library(Option<String>),
}

impl Files {
    /// A file that was named: it must be one that is read.
    fn named(&mut self, path: &Path) -> Result<(), CheckError> {
        if let Some(kind) = FileKind::of(path) {
            return self.file(path, kind);
        }
        // A missing file is reported before its wrong name.
        std::fs::metadata(path).map_err(Unreadable::at(path))?;
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("l5x")) {
            return Err(logix(&path.display().to_string()).into());
        }
        let known: Vec<_> = EXTENSIONS.iter().map(|(extension, _)| format!(".{extension}")).collect();
        let help = format!("files with PLC sources end in {}", known.join(" "));
        Err(Usage::new(format!("{} is of no kind that is read", path.display()), Some(help)).into())
    }

    fn file(&mut self, path: &Path, kind: FileKind) -> Result<(), CheckError> {
        let bytes = regular::read(path, Limit::TEXT).map_err(Unreadable::at(path))?;
        self.read(path, kind, &bytes)
    }

    fn read(&mut self, path: &Path, kind: FileKind, bytes: &[u8]) -> Result<(), CheckError> {
        // The same file by two names is still one.
        let identity = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if !self.seen.insert(identity) {
            return Ok(());
        }
        match kind {
            FileKind::Source(kind) => {
                // A file of the folder `.` is named as if the folder had not been.
                let name = path.strip_prefix(".").unwrap_or(path).display().to_string();
                let input = match &self.part {
                    Part::Own => Input::read(&name, kind, bytes),
                    Part::Library(namespace) => Input::of_library(namespace.as_deref(), &name, kind, bytes),
                };
                self.inputs.push(match self.dialect {
                    Some(dialect) => input.in_dialect(dialect),
                    None => input,
                });
                Ok(())
            }
            FileKind::Project => self.project(path, bytes),
        }
    }

    /// Sources of libraries: folders, projects and files.
    fn libraries(&mut self, paths: &[PathBuf]) -> Result<(), CheckError> {
        let outer = std::mem::replace(&mut self.part, Part::Library(None));
        let read = paths.iter().try_for_each(|path| if path.is_dir() { self.folder(path) } else { self.named(path) });
        self.part = outer;
        read
    }

    /// The files of a TwinCAT project; objects without program text, as tasks are, are passed over.
    fn project(&mut self, path: &Path, bytes: &[u8]) -> Result<(), CheckError> {
        let name = path.strip_prefix(".").unwrap_or(path).display().to_string();
        let folder = path.parent().unwrap_or(Path::new(""));
        let outer = self.part.clone();
        match project::listing(bytes) {
            Ok(listing) => {
                if let Part::Library(namespace) = &mut self.part {
                    namespace.clone_from(&listing.namespace);
                }
                let mut missing = Vec::new();
                for listed in &listing.files {
                    let file = folder.join(&listed.path);
                    let Some(kind @ FileKind::Source(_)) = FileKind::of(&file) else { continue };
                    // A library has no tasks of its own.
                    if self.part != Part::Own && is_task(&file) {
                        continue;
                    }
                    match regular::read(&file, Limit::TEXT) {
                        Ok(bytes) => self.read(&file, kind, &bytes)?,
                        // What is there is checked all the same.
                        Err(error) if error.kind() == std::io::ErrorKind::NotFound => missing.push(listed),
                        Err(error) => return Err(Unreadable::at(&file)(error).into()),
                    }
                }
                if !missing.is_empty() {
                    self.inputs.push(Input::with_missing_files(&name, &listing, &missing));
                }
            }
            Err(error) => self.inputs.push(Input::unreadable(&name, Code::MalformedXml, error.to_string())),
        }
        self.part = outer;
        // Libraries stand beside the project, which does not list them.
        let libraries = folder.join(LIBRARIES);
        if libraries.is_dir() { self.libraries(&[libraries]) } else { Ok(()) }
    }

    /// All sources in a folder and below it. Where a project is, it says which files are meant.
    fn folder(&mut self, path: &Path) -> Result<(), CheckError> {
        let mut entries = Vec::new();
        for entry in std::fs::read_dir(path).map_err(Unreadable::at(path))? {
            entries.push(entry.map_err(Unreadable::at(path))?.path());
        }
        entries.sort();
        let is_project = |file: &&PathBuf| FileKind::of(file) == Some(FileKind::Project);
        if let Some(project) = entries.iter().find(is_project) {
            return self.file(project, FileKind::Project);
        }
        let is_source = |file: &PathBuf| matches!(FileKind::of(file), Some(FileKind::Source(_))) && !is_other_xml(file);
        let sources = entries.iter().filter(|file| is_source(file)).count();
        for entry in entries {
            // A link to a folder may lead in a circle.
            if entry.is_dir() && !entry.is_symlink() {
                self.folder(&entry)?;
            } else if let Some(kind) = FileKind::of(&entry).filter(|_| entry.is_file())
                && !is_other_xml(&entry)
                // What was made of the sources beside it is the same program once more.
                && !(sources > 1 && is_whole(&entry))
            {
                self.file(&entry, kind)?;
            }
        }
        Ok(())
    }
}

fn is_task(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("TcTTO"))
}

/// True for XML that is not PLCopen's: folders hold much of it.
fn is_other_xml(path: &Path) -> bool {
    let is_xml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xml"));
    is_xml && !regular::read(path, Limit::TEXT).is_ok_and(|bytes| bytes.windows(11).any(|part| part == b"plcopen.org"))
}

/// True for a project with its shim that `instrument` wrote as one file.
fn is_whole(path: &Path) -> bool {
    let is_own = path.file_stem().is_some_and(|stem| stem.eq_ignore_ascii_case("sdsp"));
    is_own && regular::read(path, Limit::TEXT).is_ok_and(|bytes| instrument::is_whole(&String::from_utf8_lossy(&bytes)))
}

/// Why neither files nor targets of Logix controllers are taken: `docs/decisions/007`.
pub fn logix(what: &str) -> Usage {
    let help = "its timers and motion instructions are the controller's own and have no form in IEC 61131-3; \
        write the program in Structured Text, or let the controller take part as it is by a gateway";
    Usage::new(format!("{what}: projects of Logix controllers are not read or written"), Some(help.to_owned()))
}
