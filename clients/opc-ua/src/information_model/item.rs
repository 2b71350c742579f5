//! What of the session stands behind a node whose value lives.

use super::types::SESSION;

/// What an instance stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    /// A variable or method of the session, by the number of its type.
    Session(u32),
    /// A signal, by its index.
    Signal(usize),
    /// A variable or method of a client's seat, by the number of its type.
    Seat(usize, u32),
    /// An input of a seat.
    Input(usize, usize),
    /// An output of a seat.
    Output(usize, usize),
}

impl Item {
    /// What changes with a grant of a seat, except its inputs: who is granted reads them.
    pub(super) fn grant(seat: usize) -> [Self; 3] {
        use number::{CLIENT_STATE, GRANT, GRANT_TIME};
        [Self::Seat(seat, CLIENT_STATE), Self::Seat(seat, GRANT_TIME), Self::Seat(seat, GRANT)]
    }
}

/// Numbers of members, as the tables of [`super::types`] have them.
pub mod number {
    /// `State` of a session.
    pub const SESSION_STATE: u32 = 2001;
    pub const VIRTUAL_TIME: u32 = 2002;
    pub const TIME_STEP: u32 = 2003;
    pub const STEP_COUNT: u32 = 2004;
    pub const HELD: u32 = 2005;
    pub const DIGEST: u32 = 2006;
    pub const END: u32 = 2007;
    /// `Start` of a session.
    pub const START: u32 = 4001;
    pub const STOP: u32 = 4004;
    pub const PAUSE: u32 = 4007;
    pub const STEP: u32 = 4010;
    pub const RESET: u32 = 4013;
    pub const WRITE: u32 = 4016;
    pub const FORCE: u32 = 4019;
    pub const RELEASE: u32 = 4022;
    /// `State` of a client.
    pub const CLIENT_STATE: u32 = 2101;
    pub const PERIOD: u32 = 2102;
    /// `Start` of a client.
    pub const CLIENT_START: u32 = 2103;
    pub const GRANT: u32 = 2104;
    pub const GRANT_TIME: u32 = 2105;
    pub const WAKE: u32 = 2106;
    pub const DONE: u32 = 2107;
    pub const FAULT: u32 = 2108;
    pub const INPUT_ORDER: u32 = 2109;
    pub const OUTPUT_ORDER: u32 = 2110;
    pub const TURN: u32 = 4101;
}

/// All variables of the session itself.
pub(super) fn session_items() -> Vec<Item> {
    SESSION.variables.iter().map(|variable| Item::Session(variable.number)).collect()
}
