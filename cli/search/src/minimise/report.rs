//! What is left, as a case.

use std::io::{self, Write};

use onescan_report::number::counted;
use onescan_scenario::Scenario;
use onescan_scenario::case::written::Entry;
use onescan_server::time::VirtualTime;
use serde_json::json;

use super::config::MinimiseConfig;
use super::target::Target;
use super::trial::Trials;
use crate::forest::{SearchKind, form, whole};
use onescan_runner::format::Format;
use onescan_runner::run::SearchError;

/// What came of a minimisation.
pub(super) struct Minimised {
    pub(super) target: Target,
    /// Entries of the case as it was.
    pub(super) before: usize,
    pub(super) left: Vec<Entry>,
    /// When that fails.
    pub(super) at: VirtualTime,
    /// Trials until no entry could be left out.
    pub(super) trials_to_fewest: u64,
}

/// What is left, run from its start.
pub(super) struct Case {
    pub(super) text: String,
    pub(super) digest: Option<String>,
}

impl Minimised {
    /// What is left as a case, run from its start: no longer than it takes to fail, if that is enough.
    ///
    /// # Errors
    /// The session cannot be formed or go on.
    pub(super) fn case(
        &self,
        config: &MinimiseConfig,
        until: VirtualTime,
        trials: &Trials<'_>,
    ) -> Result<Case, SearchError> {
        let about = match &config.case {
            Some(case) => format!("the least of `{case}` with which {}", self.target),
            None => format!("the least of what was done with which {}", self.target),
        };
        let run = |until: VirtualTime| -> Result<(Case, bool), SearchError> {
            let text = trials.text(&config.name, &self.left, Some(until), Some(&about));
            let applied = trials.applied(&text)?;
            let judgement = whole(form(SearchKind::Minimise, &applied, until, [])?)?;
            let fails = self.target.met(&judgement).is_some();
            Ok((Case { text, digest: judgement.digest.map(|digest| digest.to_string()) }, fails))
        };
        match run(self.at)? {
            (case, true) => Ok(case),
            _ => Ok(run(until)?.0),
        }
    }
}

/// Writes what came of a minimisation.
pub(super) fn write(
    config: &MinimiseConfig,
    scenario: &Scenario,
    minimised: &Minimised,
    case: &Case,
    trials: &Trials<'_>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let Minimised { target, before, left, at, trials_to_fewest } = minimised;
    match config.format {
        Format::Human => {
            writeln!(out, "{}: {target}, at {at}, with", scenario.name())?;
            for line in case.text.lines() {
                writeln!(out, "    {line}")?;
            }
            let known = if trials.is_spent() {
                "not all of them were left out once, because the limit was reached (see `--runs`)".to_owned()
            } else if left.is_empty() {
                "nothing of the case is needed".to_owned()
            } else {
                "without any one of them it does not".to_owned()
            };
            let entries = counted(*before as u64, "entry").replace("entrys", "entries");
            writeln!(
                out,
                "{}: {} of {entries} left after {}; {known}",
                scenario.name(),
                left.len(),
                counted(trials.done(), "trial")
            )?;
            if let Some(digest) = &case.digest {
                writeln!(out, "  digest {digest}")?;
            }
        }
        Format::Json => {
            let (expectation, failure) = match target {
                Target::Expectation(name) => (Some(name), None),
                Target::Failure { .. } => (None, Some(target.to_string())),
            };
            let statement = json!({ "scenario": scenario.name(), "case": config.case, "violated": expectation,
                "failure": failure, "at_ns": at, "entries": before, "left": left.len(),
                "trials_to_fewest": trials_to_fewest, "trials": trials.done(), "minimal": !trials.is_spent(),
                "minimised": case.text, "digest": case.digest, "version": env!("CARGO_PKG_VERSION") });
            writeln!(out, "{statement}")?;
        }
    }
    out.flush()
}
