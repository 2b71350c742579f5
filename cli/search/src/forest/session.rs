//! The session of a trial, all of it in this process.

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_scenario::expect::TraceEnd;
use onescan_server::observer::RecordError;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::Scheduled;

use onescan_runner::error::Usage;
use onescan_runner::run::RunError;
use onescan_runner::run::judged::{Judged, Judgement, Moment};

/// Steps between two looks at whether a trial is decided: a look takes about as long as a short step.
const LOOK_STRIDE: u64 = 64;

/// Which search forms a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SearchKind {
    Explore,
    Falsify,
    Minimise,
    Mutate,
}

impl SearchKind {
    fn word(self) -> &'static str {
        match self {
            Self::Explore => "explore",
            Self::Falsify => "falsify",
            Self::Minimise => "minimise",
            Self::Mutate => "mutate",
        }
    }

    /// Why the search needs all clients in this process.
    fn need(self) -> &'static str {
        match self {
            Self::Explore | Self::Minimise => ", where it could be saved and forked",
            Self::Falsify => ", where it could be run again and again",
            Self::Mutate => "",
        }
    }
}

/// A session of `scenario` up to `until`, about to begin. Beside what the scenario does by itself it does `more`.
///
/// # Errors
/// The scenario is wrong, or a client is not in this process.
pub(crate) fn form(
    kind: SearchKind,
    scenario: &Scenario,
    until: VirtualTime,
    more: impl IntoIterator<Item = Scheduled>,
) -> Result<Judged<'_>, RunError> {
    let elsewhere = |name: &ClientName, _: &Member| {
        let message = format!("client `{name}` is not in this process{}", kind.need());
        Usage::new(message, Some(format!("{} with a soft PLC in its place", kind.word())))
    };
    Judged::form(scenario, until, more, elsewhere)
}

/// Starts a session at a checkpoint, or at its beginning if there is none.
///
/// # Errors
/// A client cannot be set up, or the checkpoint is of another session.
pub(crate) fn start<E: From<RunError> + From<RecordError>>(
    judged: &mut Judged<'_>,
    checkpoint: Option<&Moment>,
) -> Result<(), E> {
    match checkpoint {
        Some(checkpoint) => Ok(judged.resume(checkpoint).map_err(RunError::Fork)?),
        None => Ok(judged.begin()?),
    }
}

/// Makes steps until `at_boundary` has an answer, which sees the session before each step. Nothing if the session is
/// over before.
///
/// # Errors
/// The session cannot go on, or those of `at_boundary`.
pub(crate) fn run_until<T, E: From<RecordError>>(
    judged: &mut Judged<'_>,
    mut at_boundary: impl FnMut(&mut Judged<'_>) -> Result<Option<T>, E>,
) -> Result<Option<T>, E> {
    loop {
        if let Some(answer) = at_boundary(judged)? {
            return Ok(Some(answer));
        }
        if !judged.step()? {
            return Ok(None);
        }
    }
}

/// Asks `decided` at the first boundary, and then at one of several.
pub(crate) fn now_and_then<T>(decided: impl Fn(&Judged<'_>) -> Option<T>) -> impl FnMut(&Judged<'_>) -> Option<T> {
    let mut boundaries: u64 = 0;
    move |judged| {
        let is_due = boundaries.is_multiple_of(LOOK_STRIDE);
        boundaries += 1;
        if is_due { decided(judged) } else { None }
    }
}

/// Runs a session from its beginning to its end.
///
/// # Errors
/// The session cannot go on.
pub(crate) fn whole(mut judged: Judged<'_>) -> Result<Judgement, RecordError> {
    judged.begin()?;
    while judged.step()? {}
    judged.finish(TraceEnd::Complete)
}
