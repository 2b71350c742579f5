//! The joined clients of other processes, seen from the session's thread.

use std::time::Duration;

use thiserror::Error;

use super::lobby::Applicant;
use super::stream::FrameStream;
use super::{HANDSHAKE_TIMEOUT, ReceiveError};
use crate::client::{ClientId, StateError};
use crate::end::{FailureCause, SessionEnd};
use crate::lockstep::Answer;
use crate::signal::PortLayout;
use crate::time::{StepCount, VirtualTime};
use crate::wire::message::placed;
use crate::wire::{ClientMessage, FRAME_BYTES_MAX, Frame, FrameError, FrameRef, ServerMessage};

/// The transport cannot be set up.
#[derive(Debug, Error)]
#[error("cannot set up the TCP transport: {0}")]
pub struct RemoteError(#[from] std::io::Error);

/// A client's connection, and what broke it if it is broken.
struct Remote {
    connection: FrameStream,
    broken: Option<FailureCause>,
}

/// All clients that joined over TCP.
pub struct Remotes {
    seats: Vec<Option<Remote>>,
    reply_timeout: Duration,
}

impl Remotes {
    /// No client yet, of at most `seats`. A client that leaves a grant unanswered for
    /// `reply_timeout` ends the session.
    pub fn new(seats: usize, reply_timeout: Duration) -> Self {
        Self { seats: (0..seats).map(|_| None).collect(), reply_timeout }
    }

    /// Tells an applicant that it is in, and where its signals lie.
    ///
    /// # Errors
    /// The stream cannot be used. A peer that is gone already shows at the setup.
    pub fn admit(&mut self, id: ClientId, applicant: Applicant) -> Result<(), RemoteError> {
        let inputs = PortLayout::new(applicant.request().reads.clone());
        let outputs = PortLayout::new(applicant.request().writes.clone());
        let joined = ServerMessage::Joined {
            input_bytes: inputs.size() as u32,
            inputs: placed(&inputs),
            output_bytes: outputs.size() as u32,
            outputs: placed(&outputs),
        };
        let connection = FrameStream::new(applicant.stream, FRAME_BYTES_MAX, self.reply_timeout)?;
        let mut remote = Remote { connection, broken: None };
        remote.send_message(&joined);
        self.seats[id.index()] = Some(remote);
        Ok(())
    }

    /// Tells an applicant why it is not in.
    pub fn refuse(applicant: Applicant, why: &str) {
        // One who is gone needs no reason.
        if let Ok(mut connection) = FrameStream::new(applicant.stream, FRAME_BYTES_MAX, HANDSHAKE_TIMEOUT) {
            let _ = connection.send_message(&ServerMessage::Refused { message: why.to_owned() });
            connection.farewell();
        }
    }

    pub(crate) fn send_setup(&mut self, clients: impl Iterator<Item = ClientId>) {
        for client in clients {
            if let Some(remote) = &mut self.seats[client.index()] {
                remote.send_message(&ServerMessage::Setup {});
            }
        }
    }

    /// Grants one turn to each of `due`, with its inputs.
    pub(crate) fn send_grants<'a>(
        &mut self,
        due: impl Iterator<Item = (ClientId, &'a [u8])>,
        sequence: StepCount,
        t_v: VirtualTime,
    ) {
        for (client, inputs) in due {
            if let Some(remote) = &mut self.seats[client.index()] {
                let sent = remote.connection.send(FrameRef::Grant { sequence, t_v, inputs });
                remote.note(sent);
            }
        }
    }

    /// The client's answer to its setup or grant; its outputs replace `outputs`.
    pub(crate) fn collect(&mut self, client: ClientId, outputs: &mut Vec<u8>) -> Result<Answer, FailureCause> {
        let Some(remote) = &mut self.seats[client.index()] else { return Err(FailureCause::Disconnected) };
        // What a client said before it broke the connection tells more than the broken connection.
        let broken = remote.broken.take();
        let patience = if broken.is_some() { Duration::from_millis(100) } else { self.reply_timeout };
        match (remote.connection.receive(Some(patience)), broken) {
            (Ok(Frame::Turn { sequence, t_v, wake, outputs: bytes }), None) => {
                outputs.clear();
                outputs.extend_from_slice(&bytes);
                Ok(Answer { sequence, t_v, wake })
            }
            (Ok(frame), broken) => Err(broken_promise(&frame, broken)),
            (Err(_), Some(broken)) => Err(broken),
            (Err(error), None) => Err(cause_of(&error)),
        }
    }

    /// A client whose connection is gone while nobody is asked anything.
    pub(crate) fn find_lost(&mut self) -> Option<(ClientId, FailureCause)> {
        const GLANCE: Duration = Duration::from_millis(1);
        for (index, remote) in self.seats.iter_mut().enumerate() {
            let Some(remote) = remote else { continue };
            let cause = match remote.connection.receive(Some(GLANCE)) {
                Err(ReceiveError::TimedOut(_)) => continue,
                Err(error) => cause_of(&error),
                Ok(frame) => broken_promise(&frame, None),
            };
            return Some((ClientId::from_index(index), cause));
        }
        None
    }

    /// The client's state.
    pub(crate) fn save(&mut self, client: ClientId) -> Result<Vec<u8>, StateError> {
        let Some(remote) = &mut self.seats[client.index()] else { return Err(StateError::Unsupported) };
        remote.connection.send_message(&ServerMessage::Save {}).map_err(|e| corrupt(&e))?;
        match remote.connection.receive(Some(self.reply_timeout)) {
            Ok(Frame::State(state)) => Ok(state.to_vec()),
            Ok(frame) => Err(StateError::Corrupt(broken_promise(&frame, None).to_string())),
            Err(error) => Err(corrupt(&error)),
        }
    }

    /// Gives the client a state back; `steps` and `t_v` are those of the checkpoint.
    pub(crate) fn restore(
        &mut self,
        client: ClientId,
        steps: StepCount,
        t_v: VirtualTime,
        state: &[u8],
    ) -> Result<(), StateError> {
        let Some(remote) = &mut self.seats[client.index()] else { return Err(StateError::Unsupported) };
        remote.connection.send_message(&ServerMessage::Restore { t_v, steps }).map_err(|e| corrupt(&e))?;
        remote.connection.send(FrameRef::State(state)).map_err(|e| corrupt(&e))?;
        match remote.connection.receive_message(self.reply_timeout) {
            Ok(ClientMessage::Restored {}) => Ok(()),
            Ok(ClientMessage::Fault(fault)) => Err(StateError::Corrupt(fault.to_string())),
            Ok(_) => Err(StateError::Corrupt("it answered `restore` with another message".to_owned())),
            Err(error) => Err(corrupt(&error)),
        }
    }

    /// Tells everybody that the session is over. One who is gone, or does not read, is not waited
    /// for longer than a farewell takes.
    pub(crate) fn send_end(&mut self, end: &SessionEnd) {
        let message = ServerMessage::End(end.clone());
        for remote in self.seats.iter_mut().flatten() {
            remote.send_message(&message);
        }
        for remote in self.seats.iter_mut().flatten() {
            remote.connection.farewell();
        }
    }
}

impl Remote {
    fn send_message(&mut self, message: &ServerMessage) {
        let sent = self.connection.send_message(message);
        self.note(sent);
    }

    fn note(&mut self, sent: Result<(), FrameError>) {
        if let Err(error) = sent {
            self.broken.get_or_insert(cause_of(&ReceiveError::Frame(error)));
        }
    }
}

fn corrupt(error: &impl ToString) -> StateError {
    StateError::Corrupt(error.to_string())
}

fn cause_of(error: &ReceiveError) -> FailureCause {
    match error {
        ReceiveError::TimedOut(after) => FailureCause::TimedOut { after_ms: after.as_millis() as u64 },
        error if error.is_disconnect() => FailureCause::Disconnected,
        error => FailureCause::Wire(error.to_string()),
    }
}

/// The cause when `frame` came and it is no answer to a grant.
fn broken_promise(frame: &Frame, broken: Option<FailureCause>) -> FailureCause {
    if let Frame::Json(text) = frame {
        return match serde_json::from_slice(text) {
            Ok(ClientMessage::Fault(fault)) => FailureCause::Fault(fault),
            Ok(_) => FailureCause::Wire("it sent a message of the handshake in the middle of the session".to_owned()),
            Err(error) => FailureCause::Wire(format!("not a message of this protocol: {error}")),
        };
    }
    broken.unwrap_or_else(|| match frame {
        Frame::Grant { .. } => FailureCause::Wire("it sent a grant; only the server grants".to_owned()),
        Frame::State(_) => FailureCause::Wire("it sent a state that nobody asked for".to_owned()),
        Frame::Turn { .. } | Frame::Json(_) => FailureCause::Wire("it sent a turn that nobody granted".to_owned()),
    })
}
