//! Why the session refuses what a page asks.

use onescan_server::signal::SignalType;
use onescan_server::time::VirtualTime;
use thiserror::Error;

/// Why nothing is done.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(super) enum Refused {
    #[error("not a message of the page: {0}")]
    Garbage(String),
    #[error("there is no signal {0}")]
    NoSignal(usize),
    #[error("`{signal}` is {ty}, which {value} is not")]
    Value { signal: String, ty: SignalType, value: String },
    #[error("`{signal}` is written by `{writer}`: `run --operator {writer}` lets people write it")]
    Writer { signal: String, writer: String },
    #[error("there is no variable {0}")]
    NoVariable(usize),
    #[error("there is no component `{0}`")]
    NoComponent(String),
    #[error("there is no disturbance {0}")]
    NoDisturbance(usize),
    #[error("there is no alarm {0}")]
    NoAlarm(usize),
    #[error("an alarm is put aside for more than 0 s and at most a day, not for {0} s")]
    NoShelf(String),
    #[error("that is the trainer's business")]
    Trainee,
    #[error("this session is not a lesson")]
    NoLesson,
    #[error("the PLC is being driven to where the lesson begins: nothing can be operated until it is there")]
    Driven,
    #[error("there is no start `{0}`")]
    NoStart(String),
    #[error("there is no panel `{0}`")]
    NoPanel(String),
    #[error("there is no drawing {0}, or not this instance of it")]
    NoDrawing(usize),
    #[error("there is no map {0}")]
    NoMap(usize),
    #[error("there is no view `{0}`")]
    NoView(String),
    #[error("a view is called for all from the seat of a trainer: take one first")]
    NoTrainer,
    #[error("the past of this session cannot be shown: {0}")]
    Past(String),
    #[error("{t_ns} ns is not a moment of the past, which ends at {end}")]
    NoMoment { t_ns: String, end: VirtualTime },
    #[error("what was done here does not become a case: {0}")]
    NoCase(String),
    #[error("a trace has 1 to {parts_max} parts and at most {steps_max} steps of the past, not {asked}")]
    NoTrace { asked: String, parts_max: u32, steps_max: u64 },
    #[error("a recording is looked at: nobody operates it; `Go on from here` makes a session of it")]
    Recorded,
    #[error("a session that goes on from {t_v} cannot end at {until_ns} ns")]
    NoEnd { until_ns: String, t_v: VirtualTime },
    #[error("the session is over: look back, or let another go on from one of its moments")]
    Over,
    #[error("a viewer's token lets its holder look, and change nothing")]
    LooksOnly,
    #[error("panel `{0}` is a trainer's, and an operator's token does not let its holder sit there")]
    Trainers(String),
    #[error("somebody else has the seat of panel `{0}`")]
    Taken(String),
    #[error("panel `{0}` has no key that resets the session")]
    NoReset(String),
    #[error("a lesson is not reset: `Repeat` on the trainer's page begins it again")]
    InLesson,
    #[error("a session is reset from the seat of the panel that has the key: take that seat first")]
    NotSeated,
    #[error("`{0}` is written from the seat of a panel that has it: take that seat first")]
    NoSeat(String),
}
