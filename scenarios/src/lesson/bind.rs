//! The formulas and costs of a lesson, bound to the signals of its scenario.

use std::path::PathBuf;

use onescan_server::operation::Operation;
use onescan_server::signal::{SignalName, did_you_mean};
use onescan_server::time::TimeSpan;
use toml::Spanned;

use super::file::{CostFile, CostKind, LessonFile, MalfunctionFile, MistakeFile};
use super::sheet::Sheet;
use crate::arrays;
use crate::error::ScenarioError;
use crate::expect::{Expectation, FormulaError, Judge, KnownSignal, Present};
use crate::file::ScenarioFile;
use crate::panel_file::PageFile;

#[derive(Clone, Debug)]
pub struct Lesson {
    pub name: String,
    /// What the trainee reads.
    pub about: Option<String>,
    /// The prepared state with which it begins.
    pub start: String,
    /// The view of the scenario from which its pages see the machine at first.
    pub view: Option<String>,
    /// How long it lasts at most.
    pub lasts: TimeSpan,
    /// It is over as soon as this holds on these signals.
    pub done: Option<(Present, Vec<SignalName>)>,
    pub malfunctions: Vec<Malfunction>,
    pub mistakes: Vec<Mistake>,
    pub costs: Vec<Cost>,
    /// The file or recording of what an expert did, relative to the scenario's folder.
    pub expert: Option<PathBuf>,
}

/// Something that goes wrong, and how it is seen that the trainee knows it and has done what is to be done.
#[derive(Clone, Debug)]
pub struct Malfunction {
    pub name: String,
    /// The operation with which it begins.
    pub begin: Operation,
    /// It comes by the trainer's hand.
    pub by_trainer: bool,
    pub identify: Option<Sought>,
    /// How long that may take.
    pub identify_within: Option<TimeSpan>,
    /// The trainee has acted.
    pub act: Option<Sought>,
    /// How long that may take.
    pub act_within: Option<TimeSpan>,
}

impl Malfunction {
    /// Whether it begins with this operation: the same thing happens to the same component or signal.
    pub fn begins_with(&self, operation: &Operation) -> bool {
        match (&self.begin, operation) {
            (Operation::Disturb { signal, .. }, Operation::Disturb { signal: other, .. })
            | (Operation::Force { signal, .. }, Operation::Force { signal: other, .. }) => signal == other,
            (begin, operation) => begin == operation,
        }
    }
}

/// Something that the trainee must not do more often than is forgiven.
#[derive(Clone, Debug)]
pub struct Mistake {
    pub name: String,
    /// It is made each time this becomes true.
    pub when: Present,
    /// It is none if this holds then or held in the image before.
    pub unless: Option<Present>,
    /// The signals of both, in the order of their columns.
    pub signals: Vec<SignalName>,
    pub at_most: u32,
}

/// A formula whose first time is looked for.
#[derive(Clone, Debug)]
pub struct Sought {
    /// That it never holds: violated when it first does.
    never: Expectation,
    /// Its signals, in the order of their columns.
    pub signals: Vec<SignalName>,
}

impl Sought {
    fn parse(text: &str, known: &[KnownSignal]) -> Result<Self, FormulaError> {
        let mut columns = Vec::new();
        // By itself first: an error has its place in what was written.
        Expectation::parse(text, known, &mut columns)?;
        let never = Expectation::parse(&format!("always not ({text})"), known, &mut columns)?;
        Ok(Self { never, signals: names(columns) })
    }

    /// A judge for whom the formula's first time is the violation of its only expectation.
    pub fn judge(&self) -> Judge {
        Judge::new([self.never.clone()], self.signals.len())
    }
}

/// What a lesson costs.
#[derive(Clone, Debug)]
pub struct Cost {
    pub name: String,
    /// The signals, which are added.
    pub signals: Vec<SignalName>,
    /// What of them counts.
    pub of: CostKind,
    /// The unit of the signals, if they have one in common; that of an integral has `s` with it.
    pub unit: Option<String>,
}

/// Columns are names of the file's own signals.
fn names(columns: Vec<String>) -> Vec<SignalName> {
    columns.into_iter().filter_map(|column| SignalName::new(column).ok()).collect()
}

/// Binds what is written of a lesson; `begins` are the operations with which its malfunctions begin.
pub(super) fn lesson(
    sheet: &Sheet,
    scenario: &ScenarioFile,
    file: &LessonFile,
    begins: Vec<Operation>,
) -> Result<Lesson, ScenarioError> {
    let known = scenario.known_signals();
    let done = file.done.as_ref().map(|done| {
        let mut columns = Vec::new();
        let present = Present::parse(done.get_ref(), &known, &mut columns);
        present.map(|present| (present, names(columns))).map_err(|error| sheet.wrong_formula(done, error))
    });
    let mut malfunctions: Vec<Malfunction> = Vec::new();
    for (file, begin) in file.malfunctions.iter().zip(begins) {
        let file = file.get_ref();
        if malfunctions.iter().any(|other| other.name == *file.name.get_ref()) {
            let message = format!("two malfunctions are called `{}`", file.name.get_ref());
            return Err(sheet.wrong(message, file.name.span(), None));
        }
        malfunctions.push(malfunction(sheet, scenario, &known, file, begin)?);
    }
    let mut mistakes: Vec<Mistake> = Vec::new();
    for file in &file.mistakes {
        let file = file.get_ref();
        if mistakes.iter().any(|other| other.name == *file.name.get_ref()) {
            let message = format!("two mistakes are called `{}`", file.name.get_ref());
            return Err(sheet.wrong(message, file.name.span(), None));
        }
        mistakes.push(mistake(sheet, &known, file)?);
    }
    let mut costs: Vec<Cost> = Vec::new();
    for file in &file.costs {
        let file = file.get_ref();
        if costs.iter().any(|other| other.name == *file.name.get_ref()) {
            return Err(sheet.wrong(format!("two costs are called `{}`", file.name.get_ref()), file.name.span(), None));
        }
        costs.push(cost(sheet, scenario, file)?);
    }
    Ok(Lesson {
        name: file.name.get_ref().clone(),
        about: file.about.clone(),
        start: file.start.get_ref().clone(),
        view: file.view.as_ref().map(|named| view(sheet, scenario, named)).transpose()?,
        lasts: file.lasts,
        done: done.transpose()?,
        malfunctions,
        mistakes,
        costs,
        expert: file.expert.as_ref().map(|path| path.get_ref().clone()),
    })
}

fn malfunction(
    sheet: &Sheet,
    scenario: &ScenarioFile,
    known: &[KnownSignal],
    file: &MalfunctionFile,
    begin: Operation,
) -> Result<Malfunction, ScenarioError> {
    let sought = |written: &Option<Spanned<String>>, within: Option<TimeSpan>, key: &str, has_other: bool| {
        if let (None, Some(_), false) = (written, within, has_other) {
            let message = format!("`{key}_within` says how long `{key}` may take, which is not there");
            return Err(sheet.wrong(message, file.name.span(), None));
        }
        let sought = written
            .as_ref()
            .map(|text| Sought::parse(text.get_ref(), known).map_err(|error| sheet.wrong_formula(text, error)));
        sought.transpose()
    };
    let opened = file.identify_page.as_ref().map(|page| opened(sheet, scenario, page)).transpose()?;
    let identify = match (sought(&file.identify, file.identify_within, "identify", opened.is_some())?, opened) {
        (sought, None) => sought,
        // What was parsed by itself is right, and so is what is made of it.
        (sought, Some(opened)) => {
            let alone = sought.and(file.identify.as_ref()).map(|text| format!("({}) or {opened}", text.get_ref()));
            let either = alone.unwrap_or(opened);
            Some(
                Sought::parse(&either, known)
                    .map_err(|error| sheet.wrong(error.to_string(), file.name.span(), None))?,
            )
        }
    };
    Ok(Malfunction {
        name: file.name.get_ref().clone(),
        begin,
        by_trainer: file.by_trainer,
        identify,
        identify_within: file.identify_within,
        act: sought(&file.act, file.act_within, "act", false)?,
        act_within: file.act_within,
    })
}

fn mistake(sheet: &Sheet, known: &[KnownSignal], file: &MistakeFile) -> Result<Mistake, ScenarioError> {
    let mut columns = Vec::new();
    let mut present = |text: &Spanned<String>| {
        Present::parse(text.get_ref(), known, &mut columns).map_err(|error| sheet.wrong_formula(text, error))
    };
    let when = present(&file.when)?;
    let unless = file.unless.as_ref().map(present).transpose()?;
    Ok(Mistake { name: file.name.get_ref().clone(), when, unless, signals: names(columns), at_most: file.at_most })
}

/// A view that the scenario has.
fn view(sheet: &Sheet, scenario: &ScenarioFile, named: &Spanned<String>) -> Result<String, ScenarioError> {
    let views = scenario.view.iter().map(|view| view.name.get_ref());
    if views.clone().any(|view| view == named.get_ref()) {
        return Ok(named.get_ref().clone());
    }
    let help = did_you_mean(named.get_ref(), views.map(String::as_str));
    Err(sheet.wrong(format!("there is no view `{}`", named.get_ref()), named.span(), help))
}

/// The formula that holds as somebody opens the panel of this name.
fn opened(sheet: &Sheet, scenario: &ScenarioFile, named: &Spanned<String>) -> Result<String, ScenarioError> {
    let panels = || scenario.panel.iter().filter(|panel| panel.page.is_some());
    let Some(page) =
        panels().find(|panel| panel.name.get_ref() == named.get_ref()).and_then(|panel| panel.page.as_ref())
    else {
        let help = did_you_mean(named.get_ref(), panels().map(|panel| panel.name.get_ref().as_str()));
        let help = help.unwrap_or_else(|| "a panel is a page if it has the key `page` (docs/scenario.md)".to_owned());
        return Err(sheet.wrong(format!("there is no page `{}`", named.get_ref()), named.span(), Some(help)));
    };
    let PageFile { signal, value } = page.get_ref();
    Ok(format!("rose(`{}` = {value})", signal.get_ref()))
}

fn cost(sheet: &Sheet, scenario: &ScenarioFile, file: &CostFile) -> Result<Cost, ScenarioError> {
    let mut signals = Vec::new();
    let mut units = Vec::new();
    for written in &file.signals {
        let place = written.span();
        let all = arrays::names(written.get_ref().as_str(), place.clone());
        for name in all.map_err(|found| sheet.wrong(found.message, place.clone(), found.help))? {
            let Some(declared) = scenario.signals.get(&name) else {
                let help = did_you_mean(name.as_str(), scenario.signals.keys().map(SignalName::as_str));
                return Err(sheet.wrong(format!("there is no signal `{name}`"), place, help));
            };
            let ty = declared.get_ref().ty;
            if ty.as_f64(&vec![0; ty.size()]).is_none() {
                return Err(sheet.wrong(format!("`{name}` is {ty}, which is not a number"), place, None));
            }
            units.push(declared.get_ref().unit.clone());
            signals.push(name);
        }
    }
    if signals.is_empty() {
        return Err(sheet.wrong("a cost is made of at least one signal".to_owned(), file.name.span(), None));
    }
    let common = units.first().cloned().flatten().filter(|first| units.iter().all(|unit| unit.as_ref() == Some(first)));
    let unit = match (common, file.of) {
        (Some(unit), CostKind::Integral) => Some(format!("{unit} s")),
        (unit, _) => unit,
    };
    Ok(Cost { name: file.name.get_ref().clone(), signals, of: file.of, unit })
}
