//! Frames over a blocking socket: the path of every step.
//!
//! A step waits for exactly one thing at a time, so a blocking read is the shortest way: an event
//! loop would ask the operating system three times where this asks once.

use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use bytes::BytesMut;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tokio_util::codec::{Decoder, Encoder};

use super::socket::Socket;
use super::{CLOSE_TIMEOUT, ReceiveError};
use crate::transport::tls::reason;
use crate::wire::{Frame, FrameCodec, FrameError, FrameRef};

/// Bytes asked for in one read: many frames of an ordinary session.
const READ_BYTES: usize = 64 * 1024;

/// A socket and the frames on their way.
pub(super) struct FrameStream {
    stream: Socket,
    codec: FrameCodec,
    incoming: BytesMut,
    outgoing: BytesMut,
    buffer: Box<[u8]>,
    /// The read time-out that the socket has, to set it only when it changes.
    patience: Option<Duration>,
}

impl FrameStream {
    /// Frames over `stream`, none with a length over `limit`. A write that makes no progress for
    /// `write_timeout` fails.
    pub(super) fn new(stream: Socket, limit: usize, write_timeout: Duration) -> std::io::Result<Self> {
        let tcp = stream.tcp();
        tcp.set_nonblocking(false)?;
        tcp.set_nodelay(true)?;
        tcp.set_read_timeout(None)?;
        tcp.set_write_timeout(Some(write_timeout))?;
        Ok(Self {
            stream,
            codec: FrameCodec::new(limit),
            incoming: BytesMut::new(),
            outgoing: BytesMut::new(),
            buffer: vec![0; READ_BYTES].into_boxed_slice(),
            patience: None,
        })
    }

    /// Sends one frame.
    pub(super) fn send(&mut self, frame: FrameRef<'_>) -> Result<(), FrameError> {
        self.outgoing.clear();
        self.codec.encode(frame, &mut self.outgoing)?;
        self.stream.write_all(&self.outgoing)?;
        self.stream.flush()?;
        Ok(())
    }

    /// Sends one message.
    pub(super) fn send_message<M: Serialize>(&mut self, message: &M) -> Result<(), FrameError> {
        let json = crate::wire::frame::to_json(message).map_err(std::io::Error::from)?;
        self.send(FrameRef::Json(&json))
    }

    /// The next frame; with `patience` an error if it is not whole by then.
    pub(super) fn receive(&mut self, patience: Option<Duration>) -> Result<Frame, ReceiveError> {
        let mut begun = None;
        loop {
            if let Some(frame) = self.codec.decode(&mut self.incoming)? {
                return Ok(frame);
            }
            self.be_patient(remaining(patience, &mut begun)?)?;
            match self.stream.read(&mut self.buffer) {
                Ok(0) if self.incoming.is_empty() => return Err(ReceiveError::Closed),
                Ok(0) => return Err(FrameError::Cut.into()),
                Ok(count) => self.incoming.extend_from_slice(&self.buffer[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    return Err(ReceiveError::TimedOut(patience.unwrap_or_default()));
                }
                Err(error) => return Err(FrameError::Io(named(error)).into()),
            }
        }
    }

    /// The next message.
    pub(super) fn receive_message<M: DeserializeOwned>(&mut self, patience: Duration) -> Result<M, ReceiveError> {
        match self.receive(Some(patience))? {
            Frame::Json(text) => Ok(serde_json::from_slice(&text)?),
            _ => Err(ReceiveError::NotJson),
        }
    }

    fn be_patient(&mut self, patience: Option<Duration>) -> Result<(), FrameError> {
        if self.patience != patience {
            self.stream.set_read_timeout(patience)?;
            self.patience = patience;
        }
        Ok(())
    }

    /// Says no more, but lets the other side go on until it has closed or time is up: closing with
    /// unread bytes would make the operating system take the last message back.
    pub(super) fn close(&mut self) {
        let begun = Instant::now();
        if self.stream.shut_down().is_err() {
            return;
        }
        while let Some(rest) = CLOSE_TIMEOUT.checked_sub(begun.elapsed()).filter(|rest| !rest.is_zero()) {
            let waited = self.stream.set_read_timeout(Some(rest));
            match waited.and_then(|()| self.stream.read(&mut self.buffer)) {
                Ok(0) | Err(_) => return,
                Ok(_) => {}
            }
        }
    }
}

/// An error of TLS says in words for people what is wrong; one that comes only now is what the other side thinks of the
/// certificate that it was shown.
fn named(error: std::io::Error) -> std::io::Error {
    let is_tls = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>()).is_some();
    if is_tls { std::io::Error::new(error.kind(), reason(&error)) } else { error }
}

/// What is left of `patience`. The clock is read only from the second read on: one that comes in
/// time costs nothing, one that drips cannot go on for ever.
fn remaining(patience: Option<Duration>, begun: &mut Option<Instant>) -> Result<Option<Duration>, ReceiveError> {
    let Some(patience) = patience else { return Ok(None) };
    match begun {
        None => {
            *begun = Some(Instant::now());
            Ok(Some(patience))
        }
        Some(begun) => match patience.checked_sub(begun.elapsed()) {
            Some(rest) if !rest.is_zero() => Ok(Some(rest)),
            _ => Err(ReceiveError::TimedOut(patience)),
        },
    }
}
