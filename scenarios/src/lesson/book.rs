//! `lessons.toml` read and checked: prepared states and lessons, and a lesson put on its scenario.

use std::ops::Range;
use std::path::{Path, PathBuf};

use onescan_base::regular;
use onescan_server::operation::Operation;
use onescan_server::signal::did_you_mean;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::When;
use toml::Spanned;

use super::FILE_NAME;
use super::bind::{self, Lesson};
use super::file::{LessonFile, LessonsFile, MalfunctionFile, VERSION};
use super::shift::Shift;
use crate::case::campaign::is_name;
use crate::case::file::{CaseFile, FaultFile};
use crate::case::{Applied, Case, Catalogue};
use crate::error::{ScenarioError, wrong};
use crate::expect::FormulaError;
use crate::expectations::place_within;
use crate::load::Scenario;
use crate::permission;

/// A prepared state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    /// Its name.
    pub name: String,
    /// What it is.
    pub about: Option<String>,
    /// When it is, in the run that makes it.
    pub at: VirtualTime,
    /// The case of that run.
    pub case: Option<String>,
}

/// The lessons of a scenario.
#[derive(Clone, Debug)]
pub struct Book {
    path: PathBuf,
    text: String,
    file: LessonsFile,
    starts: Vec<Start>,
    lessons: Vec<Lesson>,
}

impl Book {
    /// The lessons of a scenario, all of them checked against its signals.
    ///
    /// # Errors
    /// `lessons.toml` cannot be read or is wrong, each with its place.
    pub fn load(scenario: &Scenario) -> Result<Self, ScenarioError> {
        let path = scenario.folder().join(FILE_NAME);
        permission::granted().check(scenario.folder(), &path)?;
        let text = regular::read_text(&path).map_err(|source| {
            let help = format!("lessons stand in a `{FILE_NAME}` beside the scenario (docs/training.md)");
            ScenarioError::Unreadable { path: path.clone(), source, help: Some(help) }
        })?;
        Self::parse(scenario, path, text)
    }

    fn parse(scenario: &Scenario, path: PathBuf, text: String) -> Result<Self, ScenarioError> {
        let file: LessonsFile = toml::from_str(&text)
            .map_err(|error| wrong(&path, &text, error.message().trim().to_owned(), error.span(), None))?;
        if file.version != VERSION {
            let message = format!("version {} of the format of lessons is not known", file.version);
            return Err(wrong(&path, &text, message, None, Some(format!("write `version = {VERSION}`"))));
        }
        let mut this = Self { path, text, file, starts: Vec::new(), lessons: Vec::new() };
        this.starts = this.read_starts(scenario)?;
        let mut lessons: Vec<Lesson> = Vec::new();
        for file in &this.file.lessons {
            let name = &file.get_ref().name;
            if !is_name(name.get_ref()) {
                let help = "letters, digits, `-`, `_` and `.`".to_owned();
                return Err(this.wrong(
                    format!("`{}` is no name of a lesson", name.get_ref()),
                    name.span(),
                    Some(help),
                ));
            }
            if lessons.iter().any(|other| other.name == *name.get_ref()) {
                return Err(this.wrong(format!("two lessons are called `{}`", name.get_ref()), name.span(), None));
            }
            lessons.push(this.checked(scenario, file.get_ref())?);
        }
        Ok(Self { lessons, ..this })
    }

    fn read_starts(&self, scenario: &Scenario) -> Result<Vec<Start>, ScenarioError> {
        let mut starts: Vec<Start> = Vec::new();
        for file in &self.file.starts {
            let file = file.get_ref();
            let (name, case) = (file.name.get_ref(), file.case.as_ref());
            if starts.iter().any(|other| other.name == *name) {
                return Err(self.wrong(format!("two starts are called `{name}`"), file.name.span(), None));
            }
            if let Some(case) = case {
                let cases = Catalogue::load(scenario.path())?;
                if cases.find(case.get_ref()).is_none() {
                    let help = did_you_mean(case.get_ref(), cases.cases().iter().map(|case| case.name.as_str()));
                    return Err(self.wrong(format!("there is no case `{}`", case.get_ref()), case.span(), help));
                }
            }
            let case = case.map(|case| case.get_ref().clone());
            starts.push(Start { name: name.clone(), about: file.about.clone(), at: file.at, case });
        }
        Ok(starts)
    }

    /// A lesson of the file, bound, and put on the scenario once.
    fn checked(&self, scenario: &Scenario, file: &LessonFile) -> Result<Lesson, ScenarioError> {
        let named = &file.start;
        let Some(start) = self.start(named.get_ref()) else {
            let help = did_you_mean(named.get_ref(), self.starts.iter().map(|start| start.name.as_str()));
            return Err(self.wrong(format!("there is no start `{}`", named.get_ref()), named.span(), help));
        };
        if let Some(expert) = &file.expert {
            permission::granted().check(scenario.folder(), &scenario.folder().join(expert.get_ref()))?;
        }
        let mut begins = Vec::new();
        for malfunction in &file.malfunctions {
            begins.push(self.begin(scenario, file, malfunction, start)?);
        }
        let lesson = bind::lesson(self, scenario.file(), file, begins)?;
        self.put(scenario, file, start)?;
        Ok(lesson)
    }

    /// The operation with which a malfunction begins.
    fn begin(
        &self,
        scenario: &Scenario,
        lesson: &LessonFile,
        malfunction: &Spanned<MalfunctionFile>,
        start: &Start,
    ) -> Result<Operation, ScenarioError> {
        let file = malfunction.get_ref();
        let wrong = |message: &str, help: &str| {
            Err(self.wrong(
                format!("malfunction `{}` {message}", file.name.get_ref()),
                file.name.span(),
                Some(help.into()),
            ))
        };
        let (fault, disturbance, force) = (file.fault.is_some(), file.disturbance.is_some(), file.force.is_some());
        if usize::from(fault) + usize::from(disturbance) + usize::from(force) != 1 {
            return wrong("is not one thing", "give it one of `fault`, `disturbance` and `force`");
        }
        let timed = |fault: &Spanned<FaultFile>| {
            let fault = fault.get_ref();
            fault.from.is_some() || fault.until.is_some() || fault.when.is_some() || fault.lasting.is_some()
        };
        if file.by_trainer && file.fault.as_ref().is_none_or(timed) {
            return wrong("comes by the trainer's hand", "give it a `fault` with `component` and `mode`, and no time");
        }
        let mut entry = empty(&lesson.name);
        add(&mut entry, malfunction, shift(scenario, start));
        let mut applied = Applied::default();
        scenario.schedule(&self.catalogue(lesson, entry.clone(), start), &entry, &mut applied)?;
        for scheduled in &applied.timeline {
            if let When::Once { condition, .. } = &scheduled.when
                && condition.has_past()
            {
                return wrong(
                    "waits for something past",
                    "nobody has seen what was before the start: let `when` look at one image",
                );
            }
        }
        match applied.timeline.into_iter().next() {
            Some(scheduled) => Ok(scheduled.operation),
            None => wrong("does nothing", "give it a `fault`, a `disturbance` or a `force`"),
        }
    }

    /// The case that a lesson is from `start` on, in a catalogue of its own.
    fn catalogue(&self, lesson: &LessonFile, entry: CaseFile, start: &Start) -> Catalogue {
        let case = Case {
            name: lesson.name.get_ref().clone(),
            about: lesson.about.clone(),
            until: Some(start.at + lesson.lasts),
            entry: Some(0),
            ..Case::default()
        };
        Catalogue::of_lesson(self.path.clone(), self.text.clone(), entry, case)
    }

    /// The scenario as a lesson wants it from `start` on.
    fn put(&self, scenario: &Scenario, lesson: &LessonFile, start: &Start) -> Result<Scenario, ScenarioError> {
        let shift = shift(scenario, start);
        let mut entry = empty(&lesson.name);
        entry.waive.clone_from(&lesson.waive);
        entry.expect.clone_from(&lesson.expect);
        let prepared = start.case.as_deref().map(|case| Self::prepared_case(scenario, case)).transpose()?;
        if let Some((_, Some(base))) = &prepared {
            entry.inputs.clone_from(&base.inputs);
            entry.faults.clone_from(&base.faults);
            entry.forces.clone_from(&base.forces);
            entry.disturbances.clone_from(&base.disturbances);
            entry.variables.clone_from(&base.variables);
        }
        entry.inputs.extend(lesson.inputs.iter().map(|input| shift.input(input)));
        for malfunction in lesson.malfunctions.iter().filter(|one| !one.get_ref().by_trainer) {
            add(&mut entry, malfunction, shift);
        }
        let mut catalogue = self.catalogue(lesson, entry, start);
        if let Some((case, _)) = prepared {
            catalogue.set_of(&case, lesson.start.span());
        }
        let Some(case) = catalogue.cases().first().cloned() else { return Ok(scenario.clone()) };
        let mut put = scenario.clone().with_case(&catalogue, &case)?;
        let by_hand = lesson.malfunctions.iter().filter(|one| one.get_ref().by_trainer);
        for fault in by_hand.filter_map(|one| one.get_ref().fault.as_ref()) {
            // it is checked with the others when its plant is read, though it does not come by itself
            let failure = scenario.failure(&catalogue, fault)?;
            put.may_fail(failure);
        }
        Ok(put)
    }

    /// A case of the scenario, and what it does.
    fn prepared_case(scenario: &Scenario, name: &str) -> Result<(Case, Option<CaseFile>), ScenarioError> {
        let cases = Catalogue::load(scenario.path())?;
        let case = cases.named(scenario, name)?.clone();
        let entry = cases.healthy_entry(&case).cloned();
        Ok((case, entry))
    }

    /// The prepared states.
    pub fn starts(&self) -> &[Start] {
        &self.starts
    }

    /// The prepared state of this name.
    pub fn start(&self, name: &str) -> Option<&Start> {
        self.starts.iter().find(|start| start.name == name)
    }

    /// All lessons, in the order of the file.
    pub fn lessons(&self) -> &[Lesson] {
        &self.lessons
    }

    /// The scenario whose run makes a prepared state.
    ///
    /// # Errors
    /// Its case is wrong.
    pub fn prepared(&self, scenario: &Scenario, start: &Start) -> Result<Scenario, ScenarioError> {
        let Some(name) = &start.case else { return Ok(scenario.clone()) };
        let cases = Catalogue::load(scenario.path())?;
        let case = cases.named(scenario, name)?.clone();
        scenario.clone().with_case(&cases, &case)
    }

    /// The scenario as `lesson` wants it from `start` on, which need not be its own.
    ///
    /// # Errors
    /// As those of [`load`](Self::load), for another start.
    pub fn applied(&self, scenario: &Scenario, lesson: &Lesson, start: &Start) -> Result<Scenario, ScenarioError> {
        let file = self.file.lessons.iter().find(|file| file.get_ref().name.get_ref() == &lesson.name);
        file.map_or_else(|| Ok(scenario.clone()), |file| self.put(scenario, file.get_ref(), start))
    }

    /// An error at a place of the file.
    pub(super) fn wrong(&self, message: String, place: Range<usize>, help: Option<String>) -> ScenarioError {
        wrong(&self.path, &self.text, message, Some(place), help)
    }

    /// An error at a part of a formula.
    pub(super) fn wrong_formula(&self, formula: &Spanned<String>, error: FormulaError) -> ScenarioError {
        let place = place_within(formula, &self.text, &error.place);
        self.wrong(error.to_string(), place, error.help)
    }

    /// Where it stands.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// How far a lesson is moved that begins with `start`.
fn shift(scenario: &Scenario, start: &Start) -> Shift {
    Shift { start: start.at, step: scenario.plan().step() }
}

/// Adds what a malfunction does to a case.
fn add(entry: &mut CaseFile, malfunction: &Spanned<MalfunctionFile>, shift: Shift) {
    let file = malfunction.get_ref();
    entry.faults.extend(file.fault.iter().map(|fault| shift.fault(fault)));
    entry.disturbances.extend(file.disturbance.iter().map(|disturbance| shift.disturbance(disturbance)));
    entry.forces.extend(file.force.iter().map(|force| shift.force(force)));
}

/// A case that does nothing.
fn empty(name: &Spanned<String>) -> CaseFile {
    CaseFile {
        name: name.clone(),
        about: None,
        tags: Vec::new(),
        seed: None,
        until: None,
        set: toml::Table::new(),
        matrix: toml::Table::new(),
        inputs: Vec::new(),
        faults: Vec::new(),
        forces: Vec::new(),
        disturbances: Vec::new(),
        variables: Vec::new(),
        tasks: Vec::new(),
        code: Vec::new(),
        waive: Vec::new(),
        expect: Vec::new(),
    }
}
