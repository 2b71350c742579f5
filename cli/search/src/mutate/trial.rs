//! All cases run with a mistake.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec_run::coverage::Counted;
use onescan_scenario::case::{Case, Catalogue};
use onescan_scenario::expect::TraceEnd;
use onescan_scenario::mistake::Mistake;
use onescan_scenario::{Scenario, ScenarioError};

use crate::forest::{SearchKind, form, now_and_then, run_until, whole};
use onescan_runner::error::Usage;
use onescan_runner::run::judged::Judged;
use onescan_runner::run::{RunError, SearchError};

/// What came of a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It was noticed.
    Killed {
        case: String,
        /// The expectation that did not hold, or how a client failed.
        by: String,
    },
    /// Some signal was another one in this case, and no expectation said so.
    Survived { case: String },
    /// No case executes the line.
    Unreached,
    /// No signal was another one in any step of any case.
    Equivalent,
    /// It is not a program, or one whose signals do not fit.
    Refused { why: String },
}

/// What the cases come to without a mistake.
pub(super) struct Trial<'a> {
    scenario: &'a Scenario,
    catalogue: &'a Catalogue,
    sound: Vec<Sound<'a>>,
    /// Lines with statements, by file, and whether one of them was executed.
    reached: BTreeMap<String, BTreeMap<u32, bool>>,
}

struct Sound<'a> {
    case: &'a Case,
    digest: Option<String>,
    /// What it violates already.
    violated: BTreeSet<String>,
}

impl<'a> Trial<'a> {
    /// Runs `cases` as they are.
    ///
    /// # Errors
    /// One of them cannot be run, or fails.
    pub(super) fn new(
        scenario: &'a Scenario,
        catalogue: &'a Catalogue,
        cases: Vec<&'a Case>,
    ) -> Result<Self, SearchError> {
        let mut covered = scenario.clone();
        covered.cover();
        let mut sound = Vec::new();
        for case in cases {
            let applied = covered.clone().with_case(catalogue, case)?;
            let judgement = whole(form(SearchKind::Mutate, &applied, applied.until(), [])?)?;
            if let Some(failure) = judgement.failure {
                let message = format!("case `{}` fails without any mistake: {failure}", case.name);
                return Err(Usage::new(message, Some("choose others with `--case`".to_owned())).into());
            }
            let violated = judgement.violated.into_iter().map(|one| one.name).collect();
            sound.push(Sound { case, digest: judgement.digest.map(|digest| digest.to_string()), violated });
        }
        let mut reached: BTreeMap<String, BTreeMap<u32, bool>> = BTreeMap::new();
        if let Some(sink) = covered.coverage() {
            let coverage = sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            for row in coverage.rows().into_iter().filter(|row| row.of == Counted::Line) {
                *reached.entry(row.file).or_default().entry(row.line).or_default() |= row.count > 0;
            }
        }
        Ok(Self { scenario, catalogue, sound, reached })
    }

    /// What comes of a mistake: the first case that notices it counts.
    ///
    /// # Errors
    /// A session could not go on for a reason that is not the program's.
    pub(super) fn verdict(&self, mistake: &Mistake) -> Result<Verdict, SearchError> {
        if !self.is_reached(mistake) {
            return Ok(Verdict::Unreached);
        }
        let mistaken = self.scenario.with_mistake(mistake.clone());
        let mut differs = None;
        for sound in &self.sound {
            let applied = mistaken.clone().with_case(self.catalogue, sound.case)?;
            let mut judged = match form(SearchKind::Mutate, &applied, applied.until(), []) {
                Ok(judged) => judged,
                Err(RunError::Scenario(error)) => return Ok(Verdict::Refused { why: first_line(&error) }),
                Err(error) => return Err(error.into()),
            };
            judged.begin()?;
            let is_new =
                |judged: &Judged<'_>| judged.violated().find(|name| !sound.violated.contains(*name)).map(str::to_owned);
            let mut is_new = now_and_then(is_new);
            let early = run_until(&mut judged, |judged| Ok::<_, SearchError>(is_new(judged)))?;
            let killed = |by: String| Verdict::Killed { case: sound.case.name.clone(), by };
            if let Some(by) = early {
                return Ok(killed(by));
            }
            let judgement = judged.finish(TraceEnd::Complete)?;
            if let Some(failure) = judgement.failure {
                return Ok(killed(failure.to_string()));
            }
            if let Some(one) = judgement.violated.into_iter().find(|one| !sound.violated.contains(&one.name)) {
                return Ok(killed(one.name));
            }
            if judgement.digest.map(|digest| digest.to_string()) != sound.digest {
                differs.get_or_insert_with(|| sound.case.name.clone());
            }
        }
        Ok(differs.map_or(Verdict::Equivalent, |case| Verdict::Survived { case }))
    }

    /// False if it is known that no case executes the line of the statement. Declarations are not statements.
    fn is_reached(&self, mistake: &Mistake) -> bool {
        let lines = self.reached.get(&mistake.source);
        lines.and_then(|lines| lines.get(&mistake.mutant.line)).copied().unwrap_or(true)
    }
}

fn first_line(error: &ScenarioError) -> String {
    error.to_string().lines().next().unwrap_or_default().to_owned()
}
