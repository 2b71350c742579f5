//! All lessons of a scenario, checked: prepared states and lessons, wherever they stand.

use onescan_server::signal::did_you_mean;

use super::bind::{self, Lesson};
use super::file::LessonFile;
use super::put::{begin, put};
use super::sheet::Sheet;
use super::start::{Start, read_starts};
use crate::case::Catalogue;
use crate::case::campaign::is_name;
use crate::error::ScenarioError;
use crate::load::Scenario;
use crate::permission;

/// The lessons of a scenario.
#[derive(Clone, Debug)]
pub struct Book {
    sheets: Vec<Sheet>,
    starts: Vec<Start>,
    lessons: Vec<Lesson>,
}

impl Book {
    /// The lessons of a scenario, all of them checked against its signals.
    ///
    /// # Errors
    /// There are none, or they cannot be read or are wrong, each with its place.
    pub fn load(scenario: &Scenario) -> Result<Self, ScenarioError> {
        let sheets = Sheet::all(scenario.folder())?;
        let mut this = Self { sheets, starts: Vec::new(), lessons: Vec::new() };
        for sheet in &this.sheets {
            read_starts(sheet, scenario, &mut this.starts)?;
        }
        let mut lessons: Vec<Lesson> = Vec::new();
        let written = this.sheets.iter().flat_map(|sheet| sheet.file.lessons.iter().map(move |file| (sheet, file)));
        for (sheet, file) in written {
            let name = &file.get_ref().name;
            if !is_name(name.get_ref()) {
                let help = "letters, digits, `-`, `_` and `.`".to_owned();
                let message = format!("`{}` is not a name of a lesson", name.get_ref());
                return Err(sheet.wrong(message, name.span(), Some(help)));
            }
            if lessons.iter().any(|other| other.name == *name.get_ref()) {
                return Err(sheet.wrong(format!("two lessons are called `{}`", name.get_ref()), name.span(), None));
            }
            lessons.push(this.checked(sheet, scenario, file.get_ref())?);
        }
        Ok(Self { lessons, ..this })
    }

    /// A lesson of the file, bound, and put on the scenario once.
    fn checked(&self, sheet: &Sheet, scenario: &Scenario, file: &LessonFile) -> Result<Lesson, ScenarioError> {
        let named = &file.start;
        let Some(start) = self.start(named.get_ref()) else {
            let help = did_you_mean(named.get_ref(), self.starts.iter().map(|start| start.name.as_str()));
            return Err(sheet.wrong(format!("there is no start `{}`", named.get_ref()), named.span(), help));
        };
        if let Some(expert) = &file.expert {
            permission::granted().check(scenario.folder(), &scenario.folder().join(expert.get_ref()))?;
        }
        let mut begins = Vec::new();
        for malfunction in &file.malfunctions {
            begins.push(begin(sheet, scenario, file, malfunction, start)?);
        }
        let lesson = bind::lesson(sheet, scenario.file(), file, begins)?;
        put(sheet, scenario, file, start)?;
        Ok(lesson)
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
        let written = self.sheets.iter().find_map(|sheet| Some((sheet, sheet.lesson(&lesson.name)?)));
        written.map_or_else(|| Ok(scenario.clone()), |(sheet, file)| put(sheet, scenario, file, start))
    }
}
