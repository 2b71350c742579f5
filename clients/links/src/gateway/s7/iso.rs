//! Messages in a stream of bytes: a TPKT says how long it is (RFC 1006 sec. 6), a COTP telegram what it is for (RFC 905
//! sec. 13). Sans-IO: bytes are taken as they come, one or many at a time, and given as whole messages.
//!
//! | TPKT | COTP | then |
//! |---|---|---|
//! | 3, 0, length of all of it in 2 bytes | length of the rest of its head, kind | data |

use thiserror::Error;

pub const PORT: u16 = 102;

/// The first byte of every TPKT.
const VERSION: u8 = 3;
/// Bytes of a TPKT's head.
const HEAD: usize = 4;
/// The longest message that is put together of several telegrams.
const MESSAGE_MAX: usize = 65_535;

const CONNECT_REQUEST: u8 = 0xE0;
const CONNECT_CONFIRM: u8 = 0xD0;
const DISCONNECT: u8 = 0x80;
const DATA: u8 = 0xF0;
/// In the third byte of data: nothing of the message follows.
const LAST: u8 = 0x80;
/// The size of a telegram, as the exponent of 2.
const TPDU_SIZE: u8 = 0xC0;
/// 1024 bytes, the size that S7s agree on.
const TPDU_1024: u8 = 10;
const CALLING_TSAP: u8 = 0xC1;
const CALLED_TSAP: u8 = 0xC2;

/// What one end says to the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Message {
    /// A client wants a connection; its reference.
    ConnectRequest(u16),
    ConnectConfirm,
    /// It has none any more, or none at all.
    Disconnect,
    /// What the connection is for.
    Data(Vec<u8>),
}

/// Bytes that are not a message.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BadTelegram {
    /// It does not begin as a TPKT.
    #[error("a telegram of ISO-on-TCP begins with 3, this one with {0}")]
    Version(u8),
    /// Its length or that of its head is impossible.
    #[error("a telegram of ISO-on-TCP of {0} bytes, which is impossible")]
    Length(usize),
    /// A kind that nobody sends here.
    #[error("a telegram of ISO-on-TCP of kind {0:#x}, which is unknown")]
    Kind(u8),
    /// Its parts have no end.
    #[error("a message of more than {MESSAGE_MAX} bytes")]
    Endless,
}

/// What has come and is not a whole message yet.
#[derive(Debug, Default)]
pub struct Incoming {
    bytes: Vec<u8>,
    /// The parts of a message that came in telegrams before.
    message: Vec<u8>,
}

impl Incoming {
    /// Takes what has come.
    pub fn take(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// True if a message has begun that has not ended.
    pub fn is_cut(&self) -> bool {
        !(self.bytes.is_empty() && self.message.is_empty())
    }

    /// The next whole message, if it is there.
    ///
    /// # Errors
    /// See [`BadTelegram`]; there is nothing to be had of this stream any more.
    pub fn next_message(&mut self) -> Result<Option<Message>, BadTelegram> {
        while let Some(length) = self.telegram()? {
            let telegram: Vec<u8> = self.bytes.drain(..length).skip(HEAD).collect();
            if let Some(message) = self.open(&telegram)? {
                return Ok(Some(message));
            }
        }
        Ok(None)
    }

    /// The length of the telegram at the front, once all of it is there.
    fn telegram(&self) -> Result<Option<usize>, BadTelegram> {
        if let Some(other) = self.bytes.first().filter(|first| **first != VERSION) {
            return Err(BadTelegram::Version(*other));
        }
        let Some([_, _, high, low]) = self.bytes.first_chunk::<HEAD>() else { return Ok(None) };
        let length = usize::from(u16::from_be_bytes([*high, *low]));
        if length < HEAD + 2 {
            return Err(BadTelegram::Length(length));
        }
        Ok((self.bytes.len() >= length).then_some(length))
    }

    /// The message that ends with this telegram.
    fn open(&mut self, telegram: &[u8]) -> Result<Option<Message>, BadTelegram> {
        let impossible = || BadTelegram::Length(HEAD + telegram.len());
        let (rest_of_head, body) = telegram.split_first().ok_or_else(impossible)?;
        let (head, data) = body.split_at_checked(usize::from(*rest_of_head)).ok_or_else(impossible)?;
        // Some kinds have a credit in their lower half, which class 0 does not use.
        let kind = head.first().ok_or_else(impossible)? & 0xF0;
        match kind {
            CONNECT_REQUEST => match head {
                [_, _, _, high, low, ..] => Ok(Some(Message::ConnectRequest(u16::from_be_bytes([*high, *low])))),
                _ => Err(impossible()),
            },
            CONNECT_CONFIRM => Ok(Some(Message::ConnectConfirm)),
            DISCONNECT => Ok(Some(Message::Disconnect)),
            DATA => {
                if self.message.len() + data.len() > MESSAGE_MAX {
                    return Err(BadTelegram::Endless);
                }
                self.message.extend_from_slice(data);
                let is_last = head.get(1).ok_or_else(impossible)? & LAST != 0;
                Ok(is_last.then(|| Message::Data(std::mem::take(&mut self.message))))
            }
            other => Err(BadTelegram::Kind(other)),
        }
    }
}

/// What a client sends first, to reach the end `called` of the PLC.
pub fn connect_request(called: [u8; 2]) -> Vec<u8> {
    connect(CONNECT_REQUEST, [0, 0], [0, 1], called)
}

/// What a server answers to the client that calls itself `reference`.
pub fn connect_confirm(reference: u16) -> Vec<u8> {
    connect(CONNECT_CONFIRM, reference.to_be_bytes(), [0, 1], [1, 0])
}

fn connect(kind: u8, destination: [u8; 2], source: [u8; 2], called: [u8; 2]) -> Vec<u8> {
    let class = 0;
    let mut head = vec![kind];
    head.extend([destination, source].concat());
    head.extend([class, TPDU_SIZE, 1, TPDU_1024, CALLING_TSAP, 2, 1, 0, CALLED_TSAP, 2]);
    head.extend(called);
    telegram(&head, &[])
}

/// A message of data in one telegram; it has at most [`MESSAGE_MAX`] bytes with its head.
pub fn data(message: &[u8]) -> Vec<u8> {
    telegram(&[DATA, LAST], message)
}

fn telegram(head: &[u8], data: &[u8]) -> Vec<u8> {
    let length = (HEAD + 1 + head.len() + data.len()) as u16;
    let mut telegram = vec![VERSION, 0];
    telegram.extend(length.to_be_bytes());
    telegram.push(head.len() as u8);
    telegram.extend(head);
    telegram.extend(data);
    telegram
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn stream() -> Vec<u8> {
        let part = telegram(&[DATA, 0], b"one ");
        [connect_request([1, 2]), connect_confirm(1), part, data(b"message"), data(b""), data(b"last")].concat()
    }

    fn messages() -> Vec<Message> {
        let data = |text: &[u8]| Message::Data(text.to_vec());
        let first = [Message::ConnectRequest(1), Message::ConnectConfirm];
        first.into_iter().chain([data(b"one message"), data(b""), data(b"last")]).collect()
    }

    fn read(parts: &[&[u8]]) -> Result<Vec<Message>, BadTelegram> {
        let (mut incoming, mut messages) = (Incoming::default(), Vec::new());
        for part in parts {
            incoming.take(part);
            while let Some(message) = incoming.next_message()? {
                messages.push(message);
            }
        }
        assert!(!incoming.is_cut());
        Ok(messages)
    }

    /// TCP keeps no boundaries: where its segments end is nobody's business.
    #[test]
    fn a_stream_may_be_cut_anywhere() {
        let stream = stream();
        for at in 0..=stream.len() {
            let (front, rest) = stream.split_at(at);
            assert_eq!(read(&[front, rest]), Ok(messages()), "cut at {at}");
        }
        let bytes: Vec<&[u8]> = stream.chunks(1).collect();
        assert_eq!(read(&bytes), Ok(messages()));
    }

    #[test]
    fn what_is_not_a_telegram_is_reported() {
        let reported = |bytes: &[u8]| read(&[bytes]).unwrap_err();
        assert_eq!(reported(b"HTTP/1.1"), BadTelegram::Version(b'H'));
        assert_eq!(reported(&[3, 0, 0, 5, 0]), BadTelegram::Length(5));
        assert_eq!(reported(&[3, 0, 0, 7, 9, DATA, LAST]), BadTelegram::Length(7));
        assert_eq!(reported(&[3, 0, 0, 7, 2, 0x20, LAST]), BadTelegram::Kind(0x20));
        let part = telegram(&[DATA, 0], &vec![0; 40_000]);
        assert_eq!(reported(&[part.clone(), part].concat()), BadTelegram::Endless);
    }

    proptest! {
        /// Whatever comes: no panic, no message out of less than it needs.
        #[test]
        fn any_bytes_are_borne(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut incoming = Incoming::default();
            incoming.take(&[&[VERSION, 0, 0], &bytes[..]].concat());
            while let Ok(Some(_)) = incoming.next_message() {}
        }
    }
}
