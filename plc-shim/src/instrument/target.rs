//! The forms in which a project takes the shim's own sources.

use super::clock::Form;
use super::marks;
use super::tasks::TaskTable;
use super::template::{self, LongTime};

/// For whom the shim's sources are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Target {
    /// Program text of the standard, in one file.
    #[default]
    Iec,
    /// TwinCAT 3: an object a file.
    TwinCat,
}

/// A file of the shim's own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) name: String,
    pub(super) text: String,
}

/// The shim's sources for these tasks, and for the sources of time that are replaced.
pub(super) fn sources(target: Target, tasks: &TaskTable<'_>, forms: &[&Form]) -> Vec<Source> {
    let long_time = if forms.iter().any(|form| form.long) { LongTime::Used } else { LongTime::Unused };
    let mut names = tasks.names();
    // A TIME has nanoseconds in the one and milliseconds in the other.
    let (now, now_long) = match target {
        Target::Iec => ("TV * T#0.000001ms", "TV * LT#1ns"),
        Target::TwinCat => ("LINT_TO_TIME(TV / 1000000)", "LINT_TO_LTIME(TV)"),
    };
    names.extend([("SDSP_NOW_OF_TV", now.to_owned()), ("SDSP_NOWL_OF_TV", now_long.to_owned())]);
    let filled = |template: &str| template::fill(&template::lines_for(template, long_time), &names);
    let (globals, scheduler) = (filled(template::GLOBALS), filled(template::SCHEDULER));
    match target {
        Target::Iec => {
            let forms = forms.iter().map(|form| form.text());
            let parts: Vec<String> = [globals, scheduler].into_iter().chain(forms).collect();
            let text = format!("{}\n{}", marks::FILE, parts.join("\n"));
            vec![Source { name: "sdsp.st".to_owned(), text }]
        }
        Target::TwinCat => {
            let mut sources = vec![super::twincat::globals("SDSP", &globals)];
            sources.push(super::twincat::unit("SDSP_Scheduler", &scheduler));
            sources.extend(forms.iter().map(|form| super::twincat::unit(&form.new_name(), &form.text())));
            sources
        }
    }
}
