//! What fails.

use std::convert::Infallible;
use std::fmt;

use onescan_scenario::Scenario;
use onescan_scenario::expect::TraceEnd;
use onescan_server::signal::{ClientName, did_you_mean};
use onescan_server::time::VirtualTime;

use crate::forest::{BaseRun, Forest, SearchKind, TrialRun, form};
use onescan_runner::error::Usage;
use onescan_runner::run::SearchError;
use onescan_runner::run::judged::Judgement;

/// What fails, so that another failure is not taken for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// An expectation is violated.
    Expectation(String),
    /// A client fails.
    Failure {
        client: ClientName,
        /// How, without the time.
        cause: String,
    },
}

/// The case as it is: what fails in it.
pub(super) struct First {
    pub(super) target: Target,
    /// When that is certain.
    pub(super) at: VirtualTime,
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Expectation(name) => write!(f, "`{name}` does not hold"),
            Self::Failure { client, cause } => write!(f, "client `{client}` fails: {cause}"),
        }
    }
}

impl Target {
    /// When a run has failed so, if it has.
    pub(super) fn met(&self, judgement: &Judgement) -> Option<VirtualTime> {
        match self {
            Self::Expectation(name) => judgement.violated.iter().find(|one| one.name == *name).and_then(|one| one.at),
            Self::Failure { client, cause } => {
                let same = |failure: &&_| Self::of(failure) == (client, cause.clone());
                judgement.failure.as_ref().filter(same).map(|failure| failure.t_v)
            }
        }
    }

    fn of(failure: &onescan_server::end::Failure) -> (&ClientName, String) {
        (&failure.client, failure.cause.to_string())
    }

    /// The name of the expectation that it is.
    pub(super) fn expectation(&self) -> Option<&str> {
        if let Self::Expectation(name) = self { Some(name) } else { None }
    }
}

/// Runs the case as it is, for trials to fork from; of several failures the first counts, unless one is `wanted`.
///
/// # Errors
/// It does not fail.
pub(super) fn first(
    whole: Scenario,
    until: VirtualTime,
    wanted: Option<&str>,
    forest: &mut Forest,
) -> Result<First, SearchError> {
    let names = || whole.expectations().named.iter().map(|(name, _)| name.as_str());
    if let Some(wanted) = wanted.filter(|wanted| names().all(|name| name != *wanted)) {
        let help = did_you_mean(wanted, names());
        return Err(Usage::new(format!("the scenario has no expectation `{wanted}`"), help).into());
    }
    let mut judged = form(SearchKind::Minimise, &whole, until, [])?;
    let TrialRun { checkpoints, .. } = forest.run(&mut judged, &whole, |_| None::<Infallible>)?;
    let judgement = judged.finish(TraceEnd::Complete)?;
    let violated = judgement.violated.iter().filter(|one| wanted.is_none_or(|wanted| wanted == one.name));
    let violations = violated.filter_map(|one| Some((one.at?, Target::Expectation(one.name.clone()))));
    let failure = judgement.failure.as_ref().filter(|_| wanted.is_none());
    let failure = failure.map(|failure| {
        let (client, cause) = Target::of(failure);
        (failure.t_v, Target::Failure { client: client.clone(), cause })
    });
    // The earliest; of those at one time, the first in the file, and what a client says last.
    let first = violations.chain(failure).min_by_key(|(at, _)| *at);
    if let Some((at, target)) = first {
        forest.keep(BaseRun { scenario: whole, checkpoints });
        return Ok(First { target, at });
    }
    let what = wanted.map_or_else(|| "it does what is expected".to_owned(), |name| format!("`{name}` holds"));
    let help = "minimise a case that fails, as those that `onescan explore --cases` writes (docs/minimise.md)";
    Err(Usage::new(format!("there is nothing to minimise: {what} until {until}"), Some(help.to_owned())).into())
}
