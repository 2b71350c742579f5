//! Which files are meant by what was typed, and what is in them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use onescan_base::regular::{self, Limit, NotWithin, Within};
use onescan_iec::input::found::Found;
use onescan_iec::input::kind::{EXTENSIONS, FileKind, SourceKind, is_other_program};
use onescan_iec::input::needed;
use onescan_iec::input::project;
use onescan_iec::{Code, Dialect, Input, MemoryLimit, TaskPlan, WordSize};
use onescan_iec_project::instrument;
use onescan_scenario::Scenario;
use onescan_scenario::load;
use onescan_scenario::permission::granted;
use onescan_server::signal::ClientName;

use super::error::CheckError;
use super::listed;
use super::passed_over::PassedOver;
use onescan_runner::error::{Unreadable, Usage};

/// The folder of a project in which stubs of libraries stand.
pub const LIBRARIES: &str = "libraries";

/// Files that are checked together.
pub struct Program {
    pub inputs: Vec<Input>,
    /// The client of a scenario that it is the program of.
    pub client: Option<ClientName>,
    /// That scenario.
    pub scenario: Option<Rc<Scenario>>,
    /// Which programs run in which task, where that is known.
    pub plan: Option<TaskPlan>,
    /// How much memory its variables may take.
    pub memory_limit: MemoryLimit,
}

/// What was typed, as programs.
pub struct Collected {
    pub programs: Vec<Program>,
    /// What is in the folders beside their sources.
    pub passed_over: PassedOver,
}

/// How files are read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading<'a> {
    /// The dialect of all files; it takes precedence over those of scenarios and files.
    pub dialect: Option<Dialect>,
    /// Bits of the registers of the target; it takes precedence over those of scenarios and files.
    pub word_size: Option<WordSize>,
    /// How much memory variables may take; it takes precedence over that of scenarios.
    pub memory_limit: Option<MemoryLimit>,
    /// Sources of libraries that the files use.
    pub libraries: &'a [PathBuf],
}

/// The programs behind `paths`: each soft PLC of a scenario, and all other files, with their libraries, as one.
///
/// # Errors
/// A file is not there, cannot be read, or is of no kind that is read.
pub fn collect(paths: &[PathBuf], reading: Reading) -> Result<Collected, CheckError> {
    let Reading { dialect, word_size, memory_limit, libraries } = reading;
    let mut programs = Vec::new();
    let mut files = Files { dialect, word_size, ..Files::default() };
    for path in paths {
        if load::is_scenario(path) {
            programs.extend(scenario(path, reading)?);
        } else if path.is_dir() {
            files.folder(path)?;
        } else {
            files.named(path)?;
        }
    }
    let has_sources = !files.inputs.is_empty();
    if has_sources {
        files.libraries(libraries)?;
    }
    let passed_over = files.passed_over();
    if has_sources {
        let memory_limit = memory_limit.unwrap_or_default();
        programs.push(Program { inputs: needed(files.inputs), client: None, scenario: None, plan: None, memory_limit });
    }
    if programs.is_empty() {
        let help = match passed_over {
            none if none.is_empty() => endings(),
            some => format!("{some}; {}", endings()),
        };
        return Err(Usage::new("there are no PLC sources here", Some(help)).into());
    }
    if files.seen.is_empty() && !libraries.is_empty() {
        let help = "the PLCs of a scenario name all their sources in `scenario.toml`".to_owned();
        return Err(Usage::new("`--library` is for PLC sources, and there are none here", Some(help)).into());
    }
    Ok(Collected { programs, passed_over })
}

/// As [`collect`], for those who need the programs alone.
///
/// # Errors
/// As [`collect`].
pub fn programs(paths: &[PathBuf], reading: Reading) -> Result<Vec<Program>, CheckError> {
    Ok(collect(paths, reading)?.programs)
}

fn endings() -> String {
    let known: Vec<_> = EXTENSIONS.iter().map(|(extension, _)| format!(".{extension}")).collect();
    format!("files with PLC sources end in {}", known.join(" "))
}

fn scenario(path: &Path, chosen: Reading) -> Result<Vec<Program>, CheckError> {
    let scenario = Rc::new(Scenario::load(path)?);
    let mut programs = Vec::new();
    for plc in scenario.plcs() {
        let (dialect, word_size) = (chosen.dialect.or(plc.dialect), chosen.word_size.or(plc.word_size));
        let mut files = Files { dialect, word_size, ..Files::default() };
        files.within(scenario.folder(), |files| {
            plc.sources.iter().try_for_each(|source| files.named(&scenario.folder().join(source)))
        })?;
        let memory_limit = chosen.memory_limit.unwrap_or(plc.memory_limit);
        let client = Some(plc.name.clone());
        let (plan, scenario) = (plc.plan, Some(Rc::clone(&scenario)));
        programs.push(Program { inputs: files.inputs, client, scenario, plan, memory_limit });
    }
    Ok(programs)
}

#[derive(Default)]
struct Files {
    /// The dialect of all of them, if not the one that each file's name says.
    dialect: Option<Dialect>,
    /// Bits of the registers of the target, if not those that each file says.
    word_size: Option<WordSize>,
    inputs: Vec<Input>,
    /// The files of `inputs`, and the projects.
    seen: BTreeSet<Identity>,
    left_out: BTreeMap<Identity, Reason>,
    part: Part,
    /// Where what is read must lie: in the outermost folder or project that is being read. Nothing for files that the
    /// user names.
    bounds: Option<Within>,
}

/// A file, by whatever name it was found.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Identity(PathBuf);

impl Identity {
    fn of(path: &Path) -> Self {
        Self(path.canonicalize().unwrap_or_else(|_| path.to_owned()))
    }
}

/// Why a file of a folder is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reason {
    OtherXml,
    /// It was made of the sources beside it, and is the same program once more.
    InstrumentedProject,
    /// It holds a program in a form that is not read.
    OtherProgram,
    /// Beremiz or `OpenPLC` Editor made it of the project's `plc.xml`, and it declares the same once more.
    Generated,
}

/// What a folder holds.
enum Entry {
    Folder(PathBuf),
    Source(PathBuf, Found),
}

/// Whose files are being read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
enum Part {
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
        Err(Usage::new(format!("{} is of no kind that is read", path.display()), Some(endings())).into())
    }

    /// What is in a file. One that the user names is read wherever it is, one that a folder or project has only within.
    fn read(&self, path: &Path) -> std::io::Result<Vec<u8>> {
        let Some(bounds) = &self.bounds else { return regular::read(path, Limit::TEXT) };
        match bounds.find(path) {
            Ok(real) => regular::read(&real, Limit::TEXT),
            Err(NotWithin::Missing(error)) => Err(error),
            Err(NotWithin::Elsewhere(real)) => {
                let text = format!("it is {}, outside of the folder; `--allow-path` allows more", real.display());
                Err(std::io::Error::new(std::io::ErrorKind::PermissionDenied, text))
            }
        }
    }

    /// Does `action` with what lies in a folder alone, if it is not in one already that is being read.
    fn within<T>(&mut self, folder: &Path, action: impl FnOnce(&mut Self) -> T) -> T {
        let outer = self.bounds.clone();
        self.bounds.get_or_insert_with(|| granted().within(folder));
        let done = action(self);
        self.bounds = outer;
        done
    }

    fn file(&mut self, path: &Path, kind: FileKind) -> Result<(), CheckError> {
        if self.seen.contains(&Identity::of(path)) {
            return Ok(());
        }
        let bytes = self.read(path).map_err(Unreadable::at(path))?;
        match kind {
            FileKind::Source(kind) => {
                self.source(path, Found::decode(kind, &bytes));
                Ok(())
            }
            FileKind::Project => {
                self.seen.insert(Identity::of(path));
                self.project(path, &bytes)
            }
        }
    }

    fn source(&mut self, path: &Path, found: Found) {
        if !self.seen.insert(Identity::of(path)) {
            return;
        }
        // A file of the folder `.` is named as if the folder had not been.
        let name = path.strip_prefix(".").unwrap_or(path).display().to_string();
        let input = match &self.part {
            Part::Own => Input::found(&name, found),
            Part::Library(namespace) => Input::of_library(namespace.as_deref(), &name, found),
        };
        self.inputs.push(input.read_as(self.dialect, self.word_size));
    }

    /// What was left out of folders and not named elsewhere.
    fn passed_over(&self) -> PassedOver {
        let reasons = self.left_out.iter().filter(|(file, _)| !self.seen.contains(file)).map(|(_, reason)| *reason);
        let mut counts = PassedOver::default();
        for reason in reasons {
            match reason {
                Reason::OtherXml => counts.other_xml += 1,
                Reason::InstrumentedProject => counts.instrumented_projects += 1,
                Reason::OtherProgram => counts.other_programs += 1,
                Reason::Generated => counts.generated += 1,
            }
        }
        counts
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
                    let file = listed::on_disk(folder, &listed.path);
                    let Some(FileKind::Source(kind)) = FileKind::of(&file) else { continue };
                    // A library has no tasks of its own.
                    if self.part != Part::Own && is_task(&file) || self.seen.contains(&Identity::of(&file)) {
                        continue;
                    }
                    match self.within(folder, |files| files.read(&file)) {
                        Ok(bytes) => self.source(&file, Found::decode(kind, &bytes)),
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
        self.within(path, |files| files.all_below(path))
    }

    fn all_below(&mut self, path: &Path) -> Result<(), CheckError> {
        let mut entries = Vec::new();
        for entry in std::fs::read_dir(path).map_err(Unreadable::at(path))? {
            entries.push(entry.map_err(Unreadable::at(path))?.path());
        }
        entries.sort();
        let is_project = |file: &&PathBuf| FileKind::of(file) == Some(FileKind::Project);
        if let Some(project) = entries.iter().find(is_project) {
            return self.file(project, FileKind::Project);
        }
        if is_beremiz_project(path) {
            self.leave_out_generated(&mut entries)?;
        }
        let (entries, sources) = self.entries(entries)?;
        for entry in entries {
            match entry {
                Entry::Folder(path) => self.folder(&path)?,
                Entry::Source(path, found) if sources > 1 && is_instrumented_project(&path, &found) => {
                    self.left_out.insert(Identity::of(&path), Reason::InstrumentedProject);
                }
                Entry::Source(path, found) => self.source(&path, found),
            }
        }
        Ok(())
    }

    /// Takes out of the entries of a project of Beremiz what was made of its `plc.xml`: program text beside it, and `build`.
    fn leave_out_generated(&mut self, entries: &mut Vec<PathBuf>) -> Result<(), CheckError> {
        let is_build = |path: &Path| path.is_dir() && path.file_name().is_some_and(|name| name == "build");
        let is_text = |path: &Path| FileKind::of(path) == Some(FileKind::Source(SourceKind::Text)) && path.is_file();
        let (generated, kept) = entries.drain(..).partition(|path: &PathBuf| is_build(path) || is_text(path));
        *entries = kept;
        let mut unread: Vec<PathBuf> = generated;
        while let Some(path) = unread.pop() {
            if path.is_dir() && !path.is_symlink() {
                for entry in std::fs::read_dir(&path).map_err(Unreadable::at(&path))? {
                    unread.push(entry.map_err(Unreadable::at(&path))?.path());
                }
            } else if is_text(&path) {
                self.left_out.insert(Identity::of(&path), Reason::Generated);
            }
        }
        Ok(())
    }

    /// The folders and the new sources among `paths`, and how many sources there are with those that are known. Each
    /// file is read here, and only once.
    fn entries(&mut self, paths: Vec<PathBuf>) -> Result<(Vec<Entry>, usize), CheckError> {
        let mut entries = Vec::new();
        let mut sources = 0;
        for path in paths {
            // A link to a folder may lead in a circle.
            if path.is_dir() && !path.is_symlink() {
                entries.push(Entry::Folder(path));
                continue;
            }
            let Some(FileKind::Source(kind)) = FileKind::of(&path).filter(|_| path.is_file()) else {
                if is_other_program(&path) && path.is_file() {
                    self.left_out.insert(Identity::of(&path), Reason::OtherProgram);
                }
                continue;
            };
            let identity = Identity::of(&path);
            if self.seen.contains(&identity) {
                sources += 1;
                continue;
            }
            let bytes = self.read(&path).map_err(Unreadable::at(&path))?;
            let found = Found::decode(kind, &bytes);
            if found.is_other_xml() {
                self.left_out.insert(identity, Reason::OtherXml);
            } else {
                sources += 1;
                entries.push(Entry::Source(path, found));
            }
        }
        Ok((entries, sources))
    }
}

/// True for a folder as Beremiz and `OpenPLC` Editor have it: they compile its `plc.xml`, and nothing beside it.
fn is_beremiz_project(folder: &Path) -> bool {
    folder.join("plc.xml").is_file() && folder.join("beremiz.xml").is_file()
}

fn is_task(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("TcTTO"))
}

/// True for a project with its shim that `instrument` wrote as one file.
fn is_instrumented_project(path: &Path, found: &Found) -> bool {
    let is_own = path.file_stem().is_some_and(|stem| stem.eq_ignore_ascii_case("sdsp"));
    is_own && found.text().is_some_and(instrument::is_whole)
}

/// Why neither files nor targets of Logix controllers are taken: `docs/decisions/007`.
pub fn logix(what: &str) -> Usage {
    let help = "its timers and motion instructions are the controller's own and have no form in IEC 61131-3; \
        write the program in Structured Text, or let the controller take part as it is by a gateway";
    Usage::new(format!("{what}: projects of Logix controllers are not read or written"), Some(help.to_owned()))
}
