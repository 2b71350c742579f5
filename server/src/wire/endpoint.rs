//! The client's side of the protocol once it has joined, as a sans-IO machine: which duty a frame
//! brings, and whether it may come now. It keeps a client from acting in a wrong step even if the
//! server or the network is at fault.

use onescan_base::foreign::one_line;
use thiserror::Error;

use super::frame::Frame;
use super::message::ServerMessage;
use crate::client::ClientOperation;
use crate::end::SessionEnd;
use crate::state::ClientState;
use crate::time::{StepCount, VirtualTime};

/// What a client has to do next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Duty {
    /// Initialise, with these operations in force, and answer with a turn of sequence 0.
    Setup(Vec<ClientOperation>),
    /// Do this and answer `operated`.
    Operate(ClientOperation),
    /// Run a turn on these inputs.
    Turn {
        /// To be given back.
        sequence: StepCount,
        /// Virtual time at the end of the turn; to be given back.
        t_v: VirtualTime,
        inputs: bytes::Bytes,
    },
    /// Answer with the state.
    Save,
    /// Take back this state and answer `restored`.
    Restore(bytes::Bytes),
    /// Nothing yet: the message announces the next one.
    Nothing,
    /// The session is over.
    Leave(SessionEnd),
}

/// What a server must not send.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum EndpointError {
    /// A message that has no place in this state.
    #[error("the server sent {what} while this client is in state {state}")]
    OutOfPlace { what: &'static str, state: ClientState },
    /// A grant that is not later than the one before.
    #[error("grant {sequence} for t_v = {t_v} is not later than grant {last} for t_v = {last_t_v}")]
    NotLater {
        sequence: StepCount,
        /// The grant's virtual time.
        t_v: VirtualTime,
        last: StepCount,
        last_t_v: VirtualTime,
    },
    /// Inputs of another size than agreed.
    #[error("a grant carries {got} input bytes, not {expected}")]
    InputSize {
        got: usize,
        /// Bytes agreed at joining.
        expected: usize,
    },
    /// JSON that is not a message of the protocol.
    #[error("not a message of this protocol: {0}")]
    Message(String),
}

/// A joined client, seen from its own side.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Endpoint {
    state: ClientState,
    sequence: StepCount,
    t_v: VirtualTime,
    input_bytes: usize,
    restoring: Option<(StepCount, VirtualTime)>,
    ended: bool,
}

impl Endpoint {
    /// A client that has just joined; its grants carry `input_bytes` bytes.
    pub fn new(input_bytes: usize) -> Self {
        Self {
            state: ClientState::Start,
            sequence: StepCount(0),
            t_v: VirtualTime::ZERO,
            input_bytes,
            restoring: None,
            ended: false,
        }
    }

    /// The state of `[SDSP]` Fig. 9. `ready` and `read` are passed while a grant is taken in, `write`
    /// holds until the next.
    pub fn state(&self) -> ClientState {
        self.state
    }

    /// Virtual time of the last grant.
    pub fn t_v(&self) -> VirtualTime {
        self.t_v
    }

    /// True once the server has ended the session.
    pub fn is_ended(&self) -> bool {
        self.ended
    }

    /// Takes a frame from the server.
    ///
    /// # Errors
    /// See [`EndpointError`]; the client must leave then.
    pub fn receive(&mut self, frame: Frame) -> Result<Duty, EndpointError> {
        match frame {
            Frame::Json(text) => {
                let message = serde_json::from_slice(&text)
                    .map_err(|e| EndpointError::Message(one_line(&e.to_string()).into_owned()))?;
                self.receive_message(message)
            }
            Frame::Grant { sequence, t_v, inputs } => self.receive_grant(sequence, t_v, inputs),
            Frame::State(state) => match self.restoring.take() {
                Some((steps, t_v)) => {
                    (self.sequence, self.t_v) = (steps, t_v);
                    self.state = ClientState::Write;
                    Ok(Duty::Restore(state))
                }
                None => Err(self.out_of_place("a state")),
            },
            Frame::Turn { .. } => Err(self.out_of_place("a turn")),
        }
    }

    fn receive_message(&mut self, message: ServerMessage) -> Result<Duty, EndpointError> {
        let between_turns = matches!(self.state, ClientState::Start | ClientState::Write);
        match message {
            ServerMessage::End(end) => {
                self.ended = true;
                Ok(Duty::Leave(end))
            }
            ServerMessage::Setup { operations } if between_turns => {
                self.state = ClientState::Setup;
                (self.sequence, self.t_v) = (StepCount(0), VirtualTime::ZERO);
                Ok(Duty::Setup(operations))
            }
            ServerMessage::Operate(operation) if self.state == ClientState::Write => Ok(Duty::Operate(operation)),
            ServerMessage::Save {} if self.state == ClientState::Write => Ok(Duty::Save),
            ServerMessage::Restore { t_v, steps } if self.state == ClientState::Start => {
                self.restoring = Some((steps, t_v));
                Ok(Duty::Nothing)
            }
            ServerMessage::Setup { .. } => Err(self.out_of_place("setup")),
            ServerMessage::Operate(_) => Err(self.out_of_place("an operation")),
            ServerMessage::Save {} => Err(self.out_of_place("save")),
            ServerMessage::Restore { .. } => Err(self.out_of_place("restore")),
            ServerMessage::Welcome { .. }
            | ServerMessage::Joined { .. }
            | ServerMessage::Refused { .. }
            | ServerMessage::Status(_) => Err(self.out_of_place("a message of the handshake")),
        }
    }

    fn receive_grant(
        &mut self,
        sequence: StepCount,
        t_v: VirtualTime,
        inputs: bytes::Bytes,
    ) -> Result<Duty, EndpointError> {
        if self.state != ClientState::Write || self.restoring.is_some() {
            return Err(self.out_of_place("a grant"));
        }
        if sequence <= self.sequence || t_v <= self.t_v {
            let (last, last_t_v) = (self.sequence, self.t_v);
            return Err(EndpointError::NotLater { sequence, t_v, last, last_t_v });
        }
        if inputs.len() != self.input_bytes {
            return Err(EndpointError::InputSize { got: inputs.len(), expected: self.input_bytes });
        }
        (self.sequence, self.t_v) = (sequence, t_v);
        self.state = ClientState::Run;
        Ok(Duty::Turn { sequence, t_v, inputs })
    }

    /// The answer to a setup or a grant is on its way.
    pub fn answered(&mut self) {
        if matches!(self.state, ClientState::Setup | ClientState::Run) {
            self.state = ClientState::Write;
        }
    }

    fn out_of_place(&self, what: &'static str) -> EndpointError {
        EndpointError::OutOfPlace { what, state: self.state }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grant(sequence: u64, ms: u64) -> Frame {
        let t_v = VirtualTime::from_nanos(ms * 1_000_000);
        Frame::Grant { sequence: StepCount(sequence), t_v, inputs: bytes::Bytes::new() }
    }

    fn set_up() -> Endpoint {
        let mut endpoint = Endpoint::new(0);
        let setup = ServerMessage::Setup { operations: Vec::new() };
        assert_eq!(endpoint.receive_message(setup), Ok(Duty::Setup(Vec::new())));
        endpoint.answered();
        endpoint
    }

    #[test]
    fn a_doubled_or_old_grant_is_refused() {
        let mut endpoint = set_up();
        endpoint.receive(grant(1, 10)).unwrap();
        assert!(matches!(endpoint.receive(grant(2, 20)), Err(EndpointError::OutOfPlace { .. })), "one at a time");
        endpoint.answered();
        assert!(matches!(endpoint.receive(grant(1, 10)), Err(EndpointError::NotLater { .. })));
        assert!(matches!(endpoint.receive(grant(2, 10)), Err(EndpointError::NotLater { .. })));
        assert!(endpoint.receive(grant(3, 30)).is_ok(), "a client with a longer period skips steps");
    }

    #[test]
    fn no_grant_before_setup() {
        assert!(matches!(Endpoint::new(0).receive(grant(1, 10)), Err(EndpointError::OutOfPlace { .. })));
    }

    #[test]
    fn a_second_setup_is_a_reset() {
        let mut endpoint = set_up();
        endpoint.receive(grant(5, 50)).unwrap();
        endpoint.answered();
        endpoint.receive_message(ServerMessage::Setup { operations: Vec::new() }).unwrap();
        endpoint.answered();
        assert!(endpoint.receive(grant(1, 10)).is_ok());
    }

    #[test]
    fn garbage_is_an_error() {
        assert!(matches!(set_up().receive(Frame::Json("{".into())), Err(EndpointError::Message(_))));
    }
}
