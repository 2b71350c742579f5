//! Frames: a length, a type, a body. See `server/PROTOCOL.md`, section 2.
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 0 | 4 | length of all that follows this field, little-endian |
//! | 4 | 1 | type: `J` JSON, `G` grant, `T` turn, `S` state |
//! | 5 | … | body |
//!
//! A grant's body is sequence (8), `t_v` in ns (8), inputs; a turn's is sequence (8), `t_v` (8),
//! wake (8), outputs.

use bytes::{Buf, BufMut, Bytes, BytesMut};
use serde::Serialize;
use thiserror::Error;
use tokio_util::codec::{Decoder, Encoder};

use crate::client::Wake;
use crate::time::{StepCount, VirtualTime};

const LENGTH_BYTES: usize = 4;
const TYPE_BYTES: usize = 1;
const GRANT_HEADER_BYTES: usize = 16;
const TURN_HEADER_BYTES: usize = 24;

/// A frame as it arrives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Frame {
    /// A JSON message, as text.
    Json(Bytes),
    Grant {
        sequence: StepCount,
        /// Virtual time at the end of the turn.
        t_v: VirtualTime,
        inputs: Bytes,
    },
    /// A turn is done.
    Turn {
        /// The grant it answers.
        sequence: StepCount,
        /// The grant's virtual time.
        t_v: VirtualTime,
        wake: Wake,
        outputs: Bytes,
    },
    State(Bytes),
}

/// A frame as it is sent, borrowed.
#[derive(Clone, Copy, Debug)]
pub enum FrameRef<'a> {
    /// A JSON message, as text.
    Json(&'a [u8]),
    Grant {
        sequence: StepCount,
        /// Virtual time at the end of the turn.
        t_v: VirtualTime,
        inputs: &'a [u8],
    },
    Turn {
        /// The grant it answers.
        sequence: StepCount,
        /// The grant's virtual time.
        t_v: VirtualTime,
        wake: Wake,
        outputs: &'a [u8],
    },
    State(&'a [u8]),
}

/// Why bytes are not a frame.
#[derive(Debug, Error)]
pub enum FrameError {
    #[error("a frame of {length} bytes is over the limit of {limit}")]
    TooLong {
        length: usize,
        /// The limit in force.
        limit: usize,
    },
    /// A type byte that means nothing.
    #[error("unknown frame type 0x{0:02x}")]
    UnknownType(u8),
    /// Too short for what its type says.
    #[error("a frame of type `{}` cannot be {length} bytes long", char::from(*kind))]
    TooShort { kind: u8, length: usize },
    /// The connection ended in the middle of a frame.
    #[error("the connection ended in the middle of a frame")]
    Cut,
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

/// Codec of frames for `tokio_util::codec::Framed`.
#[derive(Clone, Copy, Debug)]
pub struct FrameCodec {
    limit: usize,
}

impl FrameCodec {
    /// A codec that neither takes nor gives a frame with a length field over `limit`.
    pub fn new(limit: usize) -> Self {
        Self { limit }
    }

    /// Changes the limit: it is lower before joining.
    pub fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
    }
}

impl Decoder for FrameCodec {
    type Item = Frame;
    type Error = FrameError;

    fn decode(&mut self, source: &mut BytesMut) -> Result<Option<Frame>, FrameError> {
        let Some(prefix) = source.first_chunk::<LENGTH_BYTES>() else { return Ok(None) };
        let length = u32::from_le_bytes(*prefix) as usize;
        if length > self.limit {
            return Err(FrameError::TooLong { length, limit: self.limit });
        }
        if source.len() < LENGTH_BYTES + length {
            source.reserve(LENGTH_BYTES + length - source.len());
            return Ok(None);
        }
        source.advance(LENGTH_BYTES);
        parse(source.split_to(length).freeze()).map(Some)
    }

    fn decode_eof(&mut self, source: &mut BytesMut) -> Result<Option<Frame>, FrameError> {
        match self.decode(source)? {
            None if !source.is_empty() => Err(FrameError::Cut),
            frame => Ok(frame),
        }
    }
}

fn parse(mut body: Bytes) -> Result<Frame, FrameError> {
    let length = body.len();
    let Some(&kind) = body.first() else { return Err(FrameError::TooShort { kind: b'?', length }) };
    body.advance(TYPE_BYTES);
    let too_short = FrameError::TooShort { kind, length };
    match kind {
        b'J' => Ok(Frame::Json(body)),
        b'S' => Ok(Frame::State(body)),
        b'G' if body.len() < GRANT_HEADER_BYTES => Err(too_short),
        b'G' => Ok(Frame::Grant {
            sequence: StepCount(body.get_u64_le()),
            t_v: VirtualTime::from_nanos(body.get_u64_le()),
            inputs: body,
        }),
        b'T' if body.len() < TURN_HEADER_BYTES => Err(too_short),
        b'T' => Ok(Frame::Turn {
            sequence: StepCount(body.get_u64_le()),
            t_v: VirtualTime::from_nanos(body.get_u64_le()),
            wake: wake_from_wire(body.get_u64_le()),
            outputs: body,
        }),
        other => Err(FrameError::UnknownType(other)),
    }
}

/// 0 stands for one period after the turn: no turn ends at virtual time 0.
fn wake_from_wire(ns: u64) -> Wake {
    if ns == 0 { Wake::NextPeriod } else { Wake::At(VirtualTime::from_nanos(ns)) }
}

fn wake_to_wire(wake: Wake) -> u64 {
    match wake {
        Wake::NextPeriod => 0,
        Wake::At(at) => at.as_nanos(),
    }
}

impl Encoder<FrameRef<'_>> for FrameCodec {
    type Error = FrameError;

    fn encode(&mut self, frame: FrameRef<'_>, out: &mut BytesMut) -> Result<(), FrameError> {
        let body = match frame {
            FrameRef::Json(bytes) | FrameRef::State(bytes) => bytes.len(),
            FrameRef::Grant { inputs, .. } => GRANT_HEADER_BYTES + inputs.len(),
            FrameRef::Turn { outputs, .. } => TURN_HEADER_BYTES + outputs.len(),
        };
        let length = TYPE_BYTES + body;
        if length > self.limit || u32::try_from(length).is_err() {
            return Err(FrameError::TooLong { length, limit: self.limit });
        }
        let end = out.len() + LENGTH_BYTES + length;
        out.reserve(LENGTH_BYTES + length);
        out.put_u32_le(length as u32);
        match frame {
            FrameRef::Json(text) => put(out, b'J', text),
            FrameRef::State(bytes) => put(out, b'S', bytes),
            FrameRef::Grant { sequence, t_v, inputs } => {
                out.put_u8(b'G');
                out.put_u64_le(sequence.0);
                out.put_u64_le(t_v.as_nanos());
                out.put_slice(inputs);
            }
            FrameRef::Turn { sequence, t_v, wake, outputs } => {
                out.put_u8(b'T');
                out.put_u64_le(sequence.0);
                out.put_u64_le(t_v.as_nanos());
                out.put_u64_le(wake_to_wire(wake));
                out.put_slice(outputs);
            }
        }
        debug_assert_eq!(out.len(), end, "the length field counts all that follows it");
        Ok(())
    }
}

fn put(out: &mut BytesMut, kind: u8, bytes: &[u8]) {
    out.put_u8(kind);
    out.put_slice(bytes);
}

/// A message as the JSON text of its frame.
///
/// # Errors
/// None for the messages of this crate; the signature is serde's.
pub fn to_json<M: Serialize>(message: &M) -> Result<Vec<u8>, serde_json::Error> {
    serde_json::to_vec(message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn round_trip(frame: FrameRef<'_>) -> Frame {
        let mut codec = FrameCodec::new(1 << 16);
        let mut bytes = BytesMut::new();
        codec.encode(frame, &mut bytes).unwrap();
        let decoded = codec.decode(&mut bytes).unwrap().unwrap();
        assert!(bytes.is_empty());
        decoded
    }

    /// The very bytes that PROTOCOL.md shows.
    #[test]
    fn a_grant_and_a_turn_are_these_bytes() {
        let mut codec = FrameCodec::new(1 << 16);
        let mut bytes = BytesMut::new();
        let t_v = VirtualTime::from_nanos(30_000_000);
        codec.encode(FrameRef::Grant { sequence: StepCount(3), t_v, inputs: &[1, 0] }, &mut bytes).unwrap();
        assert_eq!(&bytes[..], b"\x13\0\0\0G\x03\0\0\0\0\0\0\0\x80\xc3\xc9\x01\0\0\0\0\x01\0");
        bytes.clear();
        let turn = FrameRef::Turn { sequence: StepCount(3), t_v, wake: Wake::NextPeriod, outputs: &[7] };
        codec.encode(turn, &mut bytes).unwrap();
        assert_eq!(&bytes[..], b"\x1a\0\0\0T\x03\0\0\0\0\0\0\0\x80\xc3\xc9\x01\0\0\0\0\0\0\0\0\0\0\0\0\x07");
    }

    #[test]
    fn bad_frames_are_distinguished() {
        let decode = |bytes: &[u8]| FrameCodec::new(100).decode(&mut BytesMut::from(bytes));
        assert!(matches!(decode(b"\x65\0\0\0"), Err(FrameError::TooLong { length: 101, limit: 100 })));
        assert!(matches!(decode(b"\xff\xff\xff\xff"), Err(FrameError::TooLong { .. })));
        assert!(matches!(decode(b"\x01\0\0\0x"), Err(FrameError::UnknownType(b'x'))));
        assert!(matches!(decode(b"\x02\0\0\0G1"), Err(FrameError::TooShort { kind: b'G', length: 2 })));
        assert!(matches!(decode(b"\0\0\0\0"), Err(FrameError::TooShort { .. })));
        assert!(matches!(decode(b"\x02\0\0\0J"), Ok(None)));
        assert!(matches!(
            FrameCodec::new(100).decode_eof(&mut BytesMut::from(&b"\x02\0\0\0J"[..])),
            Err(FrameError::Cut)
        ));
    }

    proptest! {
        #[test]
        fn frames_come_back(sequence: u64, t_v: u64, wake: u64, body in prop::collection::vec(any::<u8>(), 0..400)) {
            let (sequence, t_v) = (StepCount(sequence), VirtualTime::from_nanos(t_v));
            let wake = wake_from_wire(wake);
            let bytes = Bytes::copy_from_slice(&body);
            prop_assert_eq!(round_trip(FrameRef::Json(&body)), Frame::Json(bytes.clone()));
            prop_assert_eq!(round_trip(FrameRef::State(&body)), Frame::State(bytes.clone()));
            prop_assert_eq!(
                round_trip(FrameRef::Grant { sequence, t_v, inputs: &body }),
                Frame::Grant { sequence, t_v, inputs: bytes.clone() }
            );
            prop_assert_eq!(
                round_trip(FrameRef::Turn { sequence, t_v, wake, outputs: &body }),
                Frame::Turn { sequence, t_v, wake, outputs: bytes }
            );
        }

        #[test]
        fn garbage_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut codec = FrameCodec::new(150);
            let mut source = BytesMut::from(&bytes[..]);
            while let Ok(Some(_)) = codec.decode(&mut source) {}
        }
    }
}
