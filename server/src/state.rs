//! The states of `[SDSP]` Figs. 8 and 9.
//!
//! | server | clients | what happens |
//! |---|---|---|
//! | start | start | clients join; `start = AND(start logic, client_i.start)` |
//! | initial-write | setup | every client initialises; the image takes its initial values; `t_v = 0` |
//! | pre-read | ready | |
//! | read | read | every client reads the image; `t_v += t_step` |
//! | pre-write | run | every client runs one turn |
//! | write | write | all outputs are committed to the image at once; then pre-read again |

use std::fmt;

use serde::{Deserialize, Serialize};

/// The state of the server (`[SDSP]` Fig. 8).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ServerState {
    Start,
    /// Clients initialise; virtual time is zero.
    InitialWrite,
    /// Clients come together before they read.
    PreRead,
    /// Clients read; virtual time has advanced.
    Read,
    PreWrite,
    /// All outputs are committed.
    Write,
}

impl ServerState {
    /// Every state, in the order in which a session enters them.
    pub const ALL: [Self; 6] =
        [Self::Start, Self::InitialWrite, Self::PreRead, Self::Read, Self::PreWrite, Self::Write];

    /// The state that follows when the clients are synchronised.
    pub const fn next(self) -> Self {
        match self {
            Self::Start => Self::InitialWrite,
            Self::InitialWrite | Self::Write => Self::PreRead,
            Self::PreRead => Self::Read,
            Self::Read => Self::PreWrite,
            Self::PreWrite => Self::Write,
        }
    }

    /// The state of a client that takes part in this state of the server.
    pub const fn of_clients(self) -> ClientState {
        match self {
            Self::Start => ClientState::Start,
            Self::InitialWrite => ClientState::Setup,
            Self::PreRead => ClientState::Ready,
            Self::Read => ClientState::Read,
            Self::PreWrite => ClientState::Run,
            Self::Write => ClientState::Write,
        }
    }
}

impl fmt::Display for ServerState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::InitialWrite => "initial-write",
            Self::PreRead => "pre-read",
            Self::Read => "read",
            Self::PreWrite => "pre-write",
            Self::Write => "write",
        })
    }
}

/// The state of a client (`[SDSP]` Fig. 9).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClientState {
    Start,
    Setup,
    Ready,
    Read,
    Run,
    /// Its outputs are in the image. A client whose delay has not run out sleeps here.
    Write,
}

impl ClientState {
    /// Every state, in the order in which a client enters them.
    pub const ALL: [Self; 6] = [Self::Start, Self::Setup, Self::Ready, Self::Read, Self::Run, Self::Write];
}

impl fmt::Display for ClientState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Setup => "setup",
            Self::Ready => "ready",
            Self::Read => "read",
            Self::Run => "run",
            Self::Write => "write",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cycle_closes_over_read_and_write() {
        let mut state = ServerState::Start;
        let mut seen = vec![state];
        for _ in 0..6 {
            state = state.next();
            seen.push(state);
        }
        let names: Vec<String> = seen.iter().map(ToString::to_string).collect();
        assert_eq!(names, ["start", "initial-write", "pre-read", "read", "pre-write", "write", "pre-read"]);
    }
}
