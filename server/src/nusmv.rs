//! The session as a model for NuSMV, as in the appendix of `[SDSP]`.
//!
//! What follows what is taken from [`ServerState::next`] and [`ServerState::of_clients`], which the running
//! session uses. The barrier and the delays are written here a second time, in NuSMV's words; the proofs
//! hold the states that the text can reach against those that the session reaches.
//!
//! Three things differ from the appendix, because they differ in the session. Server and clients change
//! their states together, where the appendix lets clients follow a transition later. A client asks for its
//! delay when its turn is done, and it is in force from the commit on. The delay is counted down with the
//! commit, so that nobody takes up a step in its middle.

use std::fmt::{self, Write};

use thiserror::Error;

use crate::state::{ClientState, ServerState};

/// How large a model is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    clients: u32,
    delay_max: u32,
    tv_max: u32,
}

/// Why there is no model of a size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SizeError {
    /// Nobody takes part, or more than a checker can hold.
    #[error("a model has 1 to {max} clients, not {0}", max = Size::CLIENTS_MAX)]
    Clients(u32),
    /// Delays beyond what a checker can hold.
    #[error("a client of a model sleeps for up to {max} steps, not {0}", max = Size::DELAY_MAX)]
    Delay(u32),
    /// Time that does not pass, or more of it than a checker can hold.
    #[error("virtual time of a model restarts after 1 to {max} steps, not {0}", max = Size::TV_MAX)]
    Time(u32),
}

impl Size {
    const CLIENTS_MAX: u32 = 64;
    const DELAY_MAX: u32 = 1_000;
    const TV_MAX: u32 = 1_000_000;

    /// A model of `clients` clients, which sleep for up to `delay_max` steps after a turn, and of a virtual
    /// time that restarts after `tv_max` steps.
    ///
    /// # Errors
    /// More than a checker can hold, or nothing to check.
    pub fn new(clients: u32, delay_max: u32, tv_max: u32) -> Result<Self, SizeError> {
        if !(1..=Self::CLIENTS_MAX).contains(&clients) {
            return Err(SizeError::Clients(clients));
        }
        if delay_max > Self::DELAY_MAX {
            return Err(SizeError::Delay(delay_max));
        }
        if !(1..=Self::TV_MAX).contains(&tv_max) {
            return Err(SizeError::Time(tv_max));
        }
        Ok(Self { clients, delay_max, tv_max })
    }
}

/// The model as text.
#[must_use]
pub fn model(size: Size) -> String {
    let mut text = String::new();
    // a String takes all that is written to it
    let _ = write(&mut text, size);
    text
}

/// A state's name as NuSMV takes it.
fn word(state: impl fmt::Display) -> String {
    state.to_string().replace('-', "_")
}

fn words(states: impl Iterator<Item = impl fmt::Display>) -> String {
    states.map(word).collect::<Vec<_>>().join(", ")
}

fn write(out: &mut String, size: Size) -> fmt::Result {
    writeln!(out, "-- A session with {} clients, after Carlsson et al. 2012, appendix.", size.clients)?;
    writeln!(out, "-- Written by `onescan model --nusmv` from the table by which a session runs.\n")?;
    write_client(out, size)?;
    write_server(out, size)?;
    write_main(out, size)?;
    write_specifications(out, size)
}

fn write_client(out: &mut String, size: Size) -> fmt::Result {
    // NuSMV takes no variable that has a single value
    let delays = size.delay_max.max(1);
    let choices = (0..=size.delay_max).map(|delay| delay.to_string()).collect::<Vec<_>>().join(", ");
    let (start, run) = (word(ClientState::Start), word(ClientState::Run));
    let commit = word(ServerState::Write);
    writeln!(
        out,
        "MODULE client (serverstate, synchronize)
VAR
  state       : {{{}}};
  readysignal : boolean;
  tdelay      : 0..{delays}; -- steps to be slept through from here on
  asked       : 0..{delays}; -- the next delay, in force from the commit on
DEFINE
  sync := readysignal | tdelay != 0;
  -- whether the client takes part in the state that the server enters
  takes_part := case
      serverstate = {commit} & tdelay = 0 : asked = 0;
      serverstate = {commit} : tdelay = 1;
      TRUE : tdelay = 0;
    esac;
ASSIGN
  init (state) := {start};
  init (readysignal) := FALSE;
  init (tdelay) := 0;
  init (asked) := 0;
  next (state) := case
      !synchronize | !takes_part : state;",
        words(ClientState::ALL.into_iter())
    )?;
    for server in ServerState::ALL {
        writeln!(out, "      serverstate = {} : {};", word(server), word(server.next().of_clients()))?;
    }
    writeln!(
        out,
        "      TRUE : state;
    esac;
  next (readysignal) := case
      synchronize & takes_part : FALSE;
      sync : readysignal;
      TRUE : {{FALSE, TRUE}};
    esac;
  next (asked) := case
      synchronize & serverstate = {commit} : 0;
      state = {run} & !sync & next (readysignal) : {{{choices}}};
      TRUE : asked;
    esac;
  next (tdelay) := case
      !synchronize | serverstate != {commit} : tdelay;
      tdelay = 0 : asked;
      TRUE : tdelay - 1;
    esac;
"
    )
}

fn write_server(out: &mut String, size: Size) -> fmt::Result {
    writeln!(
        out,
        "MODULE server (synchronize)
VAR
  state : {{{}}};
  tv    : 0..{};
ASSIGN
  init (state) := {};
  init (tv) := 0;
  next (state) := case
      !synchronize : state;",
        words(ServerState::ALL.into_iter()),
        size.tv_max,
        word(ServerState::Start)
    )?;
    for state in ServerState::ALL {
        writeln!(out, "      state = {} : {};", word(state), word(state.next()))?;
    }
    writeln!(
        out,
        "      TRUE : state;
    esac;
  next (tv) := case
      !synchronize | state != {} : tv;
      tv = {} : 0;
      TRUE : tv + 1;
    esac;
",
        word(ServerState::PreRead),
        size.tv_max
    )
}

fn write_main(out: &mut String, size: Size) -> fmt::Result {
    writeln!(out, "MODULE main\nVAR\n  simulationserver : server (synchronize);")?;
    for client in 1..=size.clients {
        writeln!(out, "  client{client} : client (simulationserver.state, synchronize);")?;
    }
    let all = (1..=size.clients).map(|client| format!("client{client}.sync")).collect::<Vec<_>>().join(" & ");
    writeln!(out, "DEFINE\n  synchronize := {all};\n")
}

fn write_specifications(out: &mut String, size: Size) -> fmt::Result {
    let server = |state: ServerState| format!("simulationserver.state = {}", word(state));
    let (read, pre_write, write) =
        (server(ServerState::Read), server(ServerState::PreWrite), server(ServerState::Write));
    let pairs = (1..=size.clients).flat_map(|a| (a + 1..=size.clients).map(move |b| (a, b)));
    for (a, b) in pairs {
        if size.delay_max == 0 {
            writeln!(out, "-- Client {a} follows client {b}.\nSPEC AG (client{a}.state = client{b}.state)")?;
        } else {
            writeln!(out, "-- Client {a} follows client {b} where their delays are equal.")?;
            writeln!(out, "SPEC AG (client{a}.tdelay = client{b}.tdelay -> client{a}.state = client{b}.state)")?;
        }
    }
    writeln!(out, "-- Liveness: no deadlock.\nSPEC AG EF ({write})")?;
    writeln!(out, "-- Specific order.\nSPEC AG ({read} -> E [{read} U {pre_write}])")?;
    writeln!(out, "-- Who does not sleep is in the state that belongs to the server's.")?;
    for client in 1..=size.clients {
        let belongs = ServerState::ALL
            .map(|state| format!("({} -> client{client}.state = {})", server(state), word(state.of_clients())));
        writeln!(out, "SPEC AG (client{client}.tdelay = 0 -> {})", belongs.join(" & "))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_has_as_many_clients_as_asked_for() {
        let text = model(Size::new(3, 5, 1000).expect("a size"));
        assert_eq!(text.matches(": client (simulationserver.state, synchronize);").count(), 3);
        assert_eq!(text.matches("follows client").count(), 3);
        assert!(text.contains("asked       : 0..5;") && text.contains("tv    : 0..1000;"));
        let equal = model(Size::new(2, 0, 1).expect("a size"));
        assert!(equal.contains("tdelay      : 0..1;") && equal.contains(": {0};"));
    }

    #[test]
    fn what_nobody_can_check_is_refused() {
        assert_eq!(Size::new(0, 5, 1000), Err(SizeError::Clients(0)));
        assert_eq!(Size::new(65, 5, 1000), Err(SizeError::Clients(65)));
        assert_eq!(Size::new(2, 1001, 1000), Err(SizeError::Delay(1001)));
        assert_eq!(Size::new(2, 5, 0), Err(SizeError::Time(0)));
        assert!(Size::new(64, 1000, 1_000_000).is_ok());
    }
}
