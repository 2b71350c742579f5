//! What a PLC's scheduler says of a grant.

/// `SDSP_Answer`: what the scheduler says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Answer {
    /// 0: it has nothing to do.
    #[default]
    Ready,
    Running,
    /// 2: a grant that was run before.
    OldGrant,
    /// 3: the number of the grant is not the next one.
    Missing,
    /// 4: the grant is beyond the limit.
    Held,
    /// 5: the grant is not later than the one before.
    TimeStandsStill,
    /// 6: a session is to begin and programs have run.
    MustBeStarted,
    /// 7: `SDSP_Simulated` is FALSE.
    NotSimulated,
    /// No scheduler says this.
    Other(i16),
}

impl From<i16> for Answer {
    fn from(word: i16) -> Self {
        match word {
            0 => Self::Ready,
            1 => Self::Running,
            2 => Self::OldGrant,
            3 => Self::Missing,
            4 => Self::Held,
            5 => Self::TimeStandsStill,
            6 => Self::MustBeStarted,
            7 => Self::NotSimulated,
            other => Self::Other(other),
        }
    }
}

impl Answer {
    /// The number that the scheduler writes.
    pub fn word(self) -> i16 {
        match self {
            Self::Ready => 0,
            Self::Running => 1,
            Self::OldGrant => 2,
            Self::Missing => 3,
            Self::Held => 4,
            Self::TimeStandsStill => 5,
            Self::MustBeStarted => 6,
            Self::NotSimulated => 7,
            Self::Other(word) => word,
        }
    }

    /// Why a grant that was answered so is not done.
    pub fn why(self) -> String {
        match self {
            Self::Ready => {
                "its scheduler has not seen it: the PLC is in STOP, or no task runs SDSP_Scheduler".to_owned()
            }
            Self::Running => "programs have begun and do not end: is each in a task that runs?".to_owned(),
            Self::OldGrant => "the PLC answers that it is old".to_owned(),
            Self::Missing => "the PLC answers that a grant before it is missing".to_owned(),
            Self::Held => "the PLC answers that it is held by SDSP_Limit".to_owned(),
            Self::TimeStandsStill => "the PLC answers that its virtual time is not later than the last".to_owned(),
            Self::MustBeStarted => "the PLC answers that it must be restarted".to_owned(),
            Self::NotSimulated => "the PLC answers that it does not simulate".to_owned(),
            Self::Other(word) => format!("SDSP_Answer is {word}, which no scheduler writes"),
        }
    }
}
