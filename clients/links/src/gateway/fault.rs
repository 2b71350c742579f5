//! What can be wrong with a link to a PLC, distinguished by name.

use std::time::Duration;

use thiserror::Error;

use super::answer::Answer;

/// A block of which not everything has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{got} of the {whole} bytes of a block")]
pub struct Partial {
    /// Bytes that have come.
    pub got: usize,
    /// Bytes of the block.
    pub whole: usize,
}

/// Why a link cannot do what it is to do.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LinkFault {
    #[error("unreachable: {url}: {reason}")]
    Unreachable {
        /// Where the PLC should be.
        url: String,
        /// What the operating system or the protocol says.
        reason: String,
    },
    /// The address for PLCs to connect to cannot be had.
    #[error("cannot listen on {url}: {reason}")]
    Listen {
        /// Where the gateway should listen.
        url: String,
        /// What the operating system says.
        reason: String,
    },
    /// The gateway listens, and no PLC has connected.
    #[error("no PLC has connected to {url} within {within:?}")]
    NobodyCame {
        /// Where the gateway listens.
        url: String,
        /// How long it has waited.
        within: Duration,
    },
    /// The PLC does not let this user, certificate or security policy in.
    #[error("authentication refused by {url}: {reason}")]
    Refused {
        url: String,
        /// What the PLC says.
        reason: String,
    },
    /// A signal and the PLC do not fit.
    #[error(transparent)]
    Mapping(#[from] MappingFault),
    /// What the scenario says of the link is wrong.
    #[error("{0}")]
    Setting(String),
    /// There was a connection and it is gone.
    #[error("connection lost: {0}")]
    Lost(String),
    /// What the PLC sent is not what the protocol or the declared layout allows.
    #[error("the PLC sent what cannot be understood: {0}")]
    Nonsense(String),
}

impl LinkFault {
    /// Something is asked of a link that is not connected.
    pub fn not_connected() -> Self {
        Self::Lost("there is no connection".to_owned())
    }

    /// True if another attempt may succeed.
    pub fn is_transient(&self) -> bool {
        matches!(self, Self::Unreachable { .. } | Self::NobodyCame { .. } | Self::Lost(_))
    }

    /// The same, with how often it was tried and for how long.
    pub(super) fn tried(self, times: u32, within: Duration) -> Self {
        let times = if times == 1 { "once".to_owned() } else { format!("{times} times") };
        let described = |reason: String| format!("{reason}; tried {times} in {within:?}");
        match self {
            Self::Unreachable { url, reason } => Self::Unreachable { url, reason: described(reason) },
            Self::NobodyCame { url, .. } => Self::NobodyCame { url, within },
            Self::Lost(reason) => Self::Lost(described(reason)),
            other => other,
        }
    }

    /// True for an answer that may have been garbled on its way.
    pub fn is_garbled(&self) -> bool {
        matches!(self, Self::Nonsense(_))
    }
}

/// A signal whose address and the PLC do not fit.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct MappingFault {
    /// The signal, or the synchronisation word.
    pub point: String,
    pub message: String,
    pub help: Option<String>,
}

impl MappingFault {
    /// `point` is wrong, nothing is known that would solve it.
    pub fn new(point: &str, message: impl Into<String>) -> Self {
        Self { point: point.to_owned(), message: message.into(), help: None }
    }

    /// The same with something to do.
    pub fn with_help(self, help: Option<String>) -> Self {
        Self { help, ..self }
    }
}

/// Why a PLC cannot go on in lockstep.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GatewayFault {
    #[error(transparent)]
    Link(#[from] LinkFault),
    /// The connection broke and did not come back in time.
    #[error("connection lost during {what} and not back within {after:?}: {reason}")]
    NotBack {
        /// The grant or the start under way.
        what: String,
        /// How long it was tried, wall clock.
        after: Duration,
        /// What the last attempt said.
        reason: String,
    },
    /// The PLC is in STOP.
    #[error("the PLC is in STOP: {what} is not answered; set it to RUN")]
    InStop {
        /// The grant or the start under way.
        what: String,
    },
    /// The PLC was restarted while a session was under way.
    #[error("the PLC was restarted in mid-session, during {what}{}; the session cannot go on", boots.map(|(was, is)| format!(" (boot counter {was}, now {is})")).unwrap_or_default())]
    Restarted {
        /// The grant under way.
        what: String,
        /// The boot counter before and after, if the PLC has one.
        boots: Option<(u32, u32)>,
    },
    /// A grant was not run in time.
    #[error("{what} is not answered within {after:?}: {}", answer.why())]
    NotAnswered {
        /// The grant or the start under way.
        what: String,
        /// How long was waited, wall clock.
        after: Duration,
        /// What the scheduler said last.
        answer: Answer,
    },
    /// The PLC began a block and did not go on.
    #[error(
        "{what} is not answered within {after:?}: the PLC has sent {partial} and then nothing; is the layout the same on both sides?"
    )]
    BrokenOff {
        /// The grant or the start under way.
        what: String,
        /// How long was waited, wall clock.
        after: Duration,
        partial: Partial,
    },
    /// A PLC whose blocks are counted has sent none.
    #[error(
        "no block has come within {after:?} after {what} went out; is the PLC in RUN, and does it send at an interval?"
    )]
    NoBlock {
        /// The step under way.
        what: String,
        /// How long was waited, wall clock.
        after: Duration,
    },
    /// The PLC answers a grant that this gateway did not give.
    #[error(
        "an answer to another grant: the PLC has run grant {done}, {what} is under way; does another gateway drive it?"
    )]
    OtherGrant {
        /// The grant under way.
        what: String,
        /// The grant that the PLC has run last, numbered as in this session.
        done: u32,
    },
    /// The PLC takes part in a session of somebody else.
    #[error("the PLC takes part in session {joined}, not in {session}; does another gateway drive it?")]
    OtherSession {
        /// The session that it is in.
        joined: u32,
        /// The session of this gateway.
        session: u32,
    },
    /// Somebody else's grants are being run.
    #[error(
        "the PLC takes part in session {joined} and runs its grants: another gateway drives it; end that session first"
    )]
    InUse {
        /// The session that it is in.
        joined: u32,
    },
    /// The program is not instrumented to be simulated.
    #[error(
        "the PLC free-wheels: SDSP_Simulated is FALSE, so that it runs no grant; set it to TRUE and start the PLC cold, or run with `--mode freewheel`"
    )]
    NotSimulated,
    /// The PLC waits for grants, and nobody would give any.
    #[error(
        "the PLC is in lockstep: SDSP_Answer is {answer} and not 7, so that no program runs without a grant; set SDSP_Simulated to FALSE (`onescan plc --mode freewheel`), or run with `--mode lockstep`"
    )]
    InLockstep {
        /// What its scheduler says.
        answer: i16,
    },
    /// The program was made for another mapping.
    #[error(
        "the PLC runs a program that was made for another mapping: SDSP_Layout is {found}, that of this scenario is {expected}; run `onescan instrument` again and download the result, or compare the mappings with `onescan map`"
    )]
    OtherLayout {
        /// The number of the scenario's mapping.
        expected: u32,
        /// What the PLC shows.
        found: u32,
    },
    /// Its programs have run, so that its state is not that of a cold start.
    #[error("the PLC has run since its last start: start it cold, then begin the session")]
    MustBeStarted,
    /// A word that the scheduler never writes.
    #[error("the PLC answers nonsense during {what}: {reason}")]
    Nonsense {
        /// The grant or the start under way.
        what: String,
        /// What is impossible about it.
        reason: String,
    },
    /// All numbers of grants are used up.
    #[error("the PLC has counted {0} grants and cannot count on: start it cold")]
    NumbersUsedUp(u32),
}
