//! What a scenario expects of every run, bound to its signals.

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_server::signal::SignalName;
use toml::Spanned;

use super::file::{ExpectFile, ScenarioFile};
use crate::error::Wrong;
use crate::expect::Expectation;

/// All expectations of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Expectations {
    /// Each with its name.
    pub named: Vec<(String, Expectation)>,
    /// The signals they are judged by, in the order of the columns of their trace.
    pub signals: Vec<SignalName>,
    /// What each is worth where programs are graded, by its name.
    pub worth: BTreeMap<String, Worth>,
}

/// What an expectation is worth where programs are graded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Worth {
    /// The marks of a program that meets it.
    pub marks: u32,
    /// Its violation is one of safety.
    pub is_safety: bool,
    /// Whose it is.
    pub owner: Owner,
    /// What it means, for readers.
    pub about: Option<String>,
}

/// Whose an expectation is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Owner {
    /// The scenario's: it is judged in every case that does not waive it.
    #[default]
    Scenario,
    /// A case's own.
    Case,
}

impl Expectations {
    pub(crate) fn bind(file: &ScenarioFile, text: &str) -> Result<Self, Wrong> {
        let mut all = Self::default();
        all.add(file, (&file.expect, Owner::Scenario), text)?;
        Ok(all)
    }

    /// Adds expectations on signals of `file` that stand in `text`, and whose they are.
    pub(crate) fn add(
        &mut self,
        file: &ScenarioFile,
        (entries, owner): (&[ExpectFile], Owner),
        text: &str,
    ) -> Result<(), Wrong> {
        let known = file.known_signals();
        let mut columns: Vec<String> = self.signals.iter().map(ToString::to_string).collect();
        for ExpectFile { name, formula, about, marks, safety } in entries {
            if self.named.iter().any(|(other, _)| other == name.get_ref()) {
                let message = format!("two expectations are called `{}`", name.get_ref());
                return Err(Wrong { message, place: name.span(), help: None });
            }
            let expectation = Expectation::parse(formula.get_ref(), &known, &mut columns).map_err(|error| Wrong {
                message: error.to_string(),
                place: place_within(formula, text, &error.place),
                help: error.help,
            })?;
            self.named.push((name.get_ref().clone(), expectation));
            let worth = Worth { marks: *marks, is_safety: *safety, owner, about: about.clone() };
            self.worth.insert(name.get_ref().clone(), worth);
        }
        // Columns are names of the file's own signals.
        self.signals = columns.iter().filter_map(|column| SignalName::new(column.as_str()).ok()).collect();
        Ok(())
    }
}

/// The bytes of the file that hold `part` of a formula; all of the formula if it is written with
/// escapes.
pub(crate) fn place_within(formula: &Spanned<String>, text: &str, part: &Range<usize>) -> Range<usize> {
    let whole = formula.span();
    let offset = text.get(whole.clone()).and_then(|written| written.find(formula.get_ref().as_str()));
    match offset {
        Some(offset) => whole.start + offset + part.start..whole.start + offset + part.end,
        None => whole,
    }
}
