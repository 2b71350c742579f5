//! A lesson put on its scenario, as a case that begins somewhere.

use onescan_server::operation::Operation;
use onescan_server::timeline::When;
use toml::Spanned;

use super::file::{LessonFile, MalfunctionFile};
use super::sheet::Sheet;
use super::shift::Shift;
use super::start::Start;
use crate::case::file::CaseFile;
use crate::case::{Applied, Case, Catalogue};
use crate::error::ScenarioError;
use crate::load::Scenario;
use crate::timed::Timed;

/// The operation with which a malfunction begins.
pub(super) fn begin(
    sheet: &Sheet,
    scenario: &Scenario,
    lesson: &LessonFile,
    malfunction: &Spanned<MalfunctionFile>,
    start: &Start,
) -> Result<Operation, ScenarioError> {
    let file = malfunction.get_ref();
    let wrong = |message: &str, help: &str| {
        Err(sheet.wrong(
            format!("malfunction `{}` {message}", file.name.get_ref()),
            file.name.span(),
            Some(help.into()),
        ))
    };
    let (fault, disturbance, force) = (file.fault.is_some(), file.disturbance.is_some(), file.force.is_some());
    if usize::from(fault) + usize::from(disturbance) + usize::from(force) != 1 {
        return wrong("is not one thing", "give it one of `fault`, `disturbance` and `force`");
    }
    if file.by_trainer && !is_by_hand(file) {
        let help = "give it a `fault` or a `disturbance`, without a time: a panel or the sheet of the part begins it";
        return wrong("comes by the trainer's hand", help);
    }
    let mut entry = CaseFile::empty(&lesson.name);
    add(&mut entry, malfunction, shift(scenario, start));
    let mut applied = Applied::default();
    scenario.schedule(&catalogue(sheet, lesson, entry.clone(), start), &entry, &mut applied)?;
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
fn catalogue(sheet: &Sheet, lesson: &LessonFile, entry: CaseFile, start: &Start) -> Catalogue {
    let case = Case {
        name: lesson.name.get_ref().clone(),
        about: lesson.about.clone(),
        until: Some(start.at + lesson.lasts),
        entry: Some(0),
        ..Case::default()
    };
    Catalogue::of_lesson(sheet.path.clone(), sheet.text.clone(), entry, case)
}

/// The scenario as a lesson wants it from `start` on.
pub(super) fn put(
    sheet: &Sheet,
    scenario: &Scenario,
    lesson: &LessonFile,
    start: &Start,
) -> Result<Scenario, ScenarioError> {
    let shift = shift(scenario, start);
    let mut entry = CaseFile::empty(&lesson.name);
    entry.waive.clone_from(&lesson.waive);
    entry.expect.clone_from(&lesson.expect);
    let prepared = start.case.as_deref().map(|case| prepared_case(scenario, case)).transpose()?;
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
    let mut catalogue = catalogue(sheet, lesson, entry, start);
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

/// Whether what goes wrong can be begun by somebody: no time says when.
fn is_by_hand(file: &MalfunctionFile) -> bool {
    match (&file.fault, &file.disturbance) {
        (Some(fault), None) => !fault.get_ref().says_when(),
        (None, Some(disturbance)) => !disturbance.get_ref().says_when(),
        (None, None) | (Some(_), Some(_)) => false,
    }
}

/// How far a lesson is moved that begins with `start`.
fn shift(scenario: &Scenario, start: &Start) -> Shift {
    Shift { start: start.at, step: scenario.plan().step() }
}

/// Adds what a malfunction does to a case.
fn add(entry: &mut CaseFile, malfunction: &Spanned<MalfunctionFile>, shift: Shift) {
    let file = malfunction.get_ref();
    entry.faults.extend(file.fault.iter().map(|fault| shift.entry(fault)));
    entry.disturbances.extend(file.disturbance.iter().map(|disturbance| shift.entry(disturbance)));
    entry.forces.extend(file.force.iter().map(|force| shift.entry(force)));
}
