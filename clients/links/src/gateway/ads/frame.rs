//! AMS frames over TCP: a header of 6 bytes, one of 32, and data (Beckhoff: TC3 ADS introduction, AMS/TCP packet).

use std::io::{self, Read};
use std::net::Ipv4Addr;
use std::str::FromStr;

use serde::Deserialize;
use thiserror::Error;

/// Data of a frame at most: 500 values of the longest STRING are shorter. What announces more is refused unread.
pub const MAX_DATA: usize = 1 << 20;
/// Bytes of the header behind that of TCP.
const AMS_HEADER: usize = 32;
/// Bytes of both headers.
const HEADERS: usize = 6 + AMS_HEADER;
/// State flags: an ADS command, over TCP.
const REQUEST: u16 = 0x0004;
const RESPONSE: u16 = 0x0005;

/// The name of a device among AMS routers: six numbers, of which the first four are often an IP address.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct NetId(pub [u8; 6]);

impl NetId {
    /// The one that devices have by default.
    pub fn of(address: Ipv4Addr) -> Self {
        let [a, b, c, d] = address.octets();
        Self([a, b, c, d, 1, 1])
    }
}

impl std::fmt::Display for NetId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers = self.0.map(|number| number.to_string());
        f.write_str(&numbers.join("."))
    }
}

impl FromStr for NetId {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<u8>> = text.split('.').map(|number| number.parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.map(Self).ok_or_else(|| format!("`{text}` is not an AMS NetId: write six numbers, as `5.32.116.5.1.1`"))
    }
}

impl TryFrom<String> for NetId {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

/// A device and a port in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AmsAddress {
    pub net_id: NetId,
    /// What listens in it; 851 is the first PLC of TwinCAT 3.
    pub port: u16,
}

impl AmsAddress {
    fn put(self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.net_id.0);
        bytes.extend_from_slice(&self.port.to_le_bytes());
    }

    fn take(bytes: &mut Bytes<'_>) -> Option<Self> {
        Some(Self { net_id: NetId(bytes.array()?), port: bytes.u16()? })
    }
}

impl std::fmt::Display for AmsAddress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.net_id, self.port)
    }
}

/// Whether a frame asks or answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Request,
    Response,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    pub target: AmsAddress,
    pub source: AmsAddress,
    /// A number of [`super::command`].
    pub command: u16,
    /// Whether it asks or answers.
    pub kind: Kind,
    /// What the router says; 0 is not an error.
    pub error: u32,
    /// The response has that of its request.
    pub invoke_id: u32,
    /// What the command says.
    pub data: Vec<u8>,
}

/// Bytes that are not a frame.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BadFrame {
    /// Its length is not that of a frame that anybody here would send.
    #[error("a frame of {0} bytes")]
    Length(u32),
    /// It begins otherwise than a frame with a command.
    #[error("a frame of kind {0:#06x}, which is not an ADS command")]
    NoCommand(u16),
    /// The two headers contradict each other.
    #[error("a frame of {frame} bytes with {data} bytes of data")]
    Inconsistent {
        /// By the header of TCP, without it.
        frame: usize,
        /// By the AMS header.
        data: u32,
    },
    /// Neither asks nor answers.
    #[error("a frame with the state flags {0:#06x}")]
    Flags(u16),
}

impl Frame {
    /// All bytes of it.
    pub fn encoded(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADERS + self.data.len());
        bytes.extend_from_slice(&[0, 0]);
        bytes.extend_from_slice(&((AMS_HEADER + self.data.len()) as u32).to_le_bytes());
        self.target.put(&mut bytes);
        self.source.put(&mut bytes);
        bytes.extend_from_slice(&self.command.to_le_bytes());
        let flags = if self.kind == Kind::Request { REQUEST } else { RESPONSE };
        bytes.extend_from_slice(&flags.to_le_bytes());
        for number in [self.data.len() as u32, self.error, self.invoke_id] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes.extend_from_slice(&self.data);
        bytes
    }

    /// Waits for a whole frame; nothing if the other side has closed the connection between two.
    ///
    /// # Errors
    /// The connection is gone or its time is up; [`BadFrame`] as [`io::ErrorKind::InvalidData`].
    pub fn read(stream: &mut impl Read) -> io::Result<Option<Self>> {
        let invalid = |bad: BadFrame| io::Error::new(io::ErrorKind::InvalidData, bad);
        let mut head = [0; 6];
        loop {
            match stream.read(&mut head[..1]) {
                Ok(0) => return Ok(None),
                Ok(_) => break,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        stream.read_exact(&mut head[1..])?;
        let kind = u16::from_le_bytes([head[0], head[1]]);
        if kind != 0 {
            return Err(invalid(BadFrame::NoCommand(kind)));
        }
        let length = u32::from_le_bytes([head[2], head[3], head[4], head[5]]);
        if !(AMS_HEADER..=AMS_HEADER + MAX_DATA).contains(&(length as usize)) {
            return Err(invalid(BadFrame::Length(length)));
        }
        let mut rest = vec![0; length as usize];
        stream.read_exact(&mut rest)?;
        Self::decoded(&rest).map(Some).map_err(invalid)
    }

    /// A frame without the header of TCP.
    fn decoded(bytes: &[u8]) -> Result<Self, BadFrame> {
        let mut rest = Bytes(bytes);
        let short = || BadFrame::Length(bytes.len() as u32);
        let target = AmsAddress::take(&mut rest).ok_or_else(short)?;
        let source = AmsAddress::take(&mut rest).ok_or_else(short)?;
        let (command, flags) = (rest.u16().ok_or_else(short)?, rest.u16().ok_or_else(short)?);
        let mut number = || rest.u32().ok_or_else(short);
        let (length, error, invoke_id) = (number()?, number()?, number()?);
        let kind = match flags {
            REQUEST => Kind::Request,
            RESPONSE => Kind::Response,
            other => return Err(BadFrame::Flags(other)),
        };
        let data = rest.0.to_vec();
        if data.len() != length as usize {
            return Err(BadFrame::Inconsistent { frame: bytes.len(), data: length });
        }
        Ok(Self { target, source, command, kind, error, invoke_id, data })
    }
}

/// Little-endian numbers from the front of some bytes; nothing where they end.
#[derive(Clone, Copy, Debug)]
pub struct Bytes<'b>(pub &'b [u8]);

impl<'b> Bytes<'b> {
    /// So many bytes.
    pub fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let (front, back) = self.0.split_at_checked(count)?;
        self.0 = back;
        Some(front)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    /// A UINT.
    pub fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    /// A UDINT.
    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn frames() -> impl Strategy<Value = Frame> {
        let address = || (any::<[u8; 6]>(), any::<u16>()).prop_map(|(id, port)| AmsAddress { net_id: NetId(id), port });
        let kind = prop_oneof![Just(Kind::Request), Just(Kind::Response)];
        let data = prop::collection::vec(any::<u8>(), 0..100);
        (address(), address(), any::<(u16, u32, u32)>(), kind, data).prop_map(
            |(target, source, numbers, kind, data)| {
                let (command, error, invoke_id) = numbers;
                Frame { target, source, command, kind, error, invoke_id, data }
            },
        )
    }

    proptest! {
        #[test]
        fn a_frame_comes_as_it_went(frame in frames(), behind in prop::collection::vec(any::<u8>(), 0..9)) {
            let bytes = [frame.encoded(), behind.clone()].concat();
            let mut rest = &bytes[..];
            prop_assert_eq!(Frame::read(&mut rest).unwrap(), Some(frame));
            prop_assert_eq!(rest, &behind[..]);
        }

        #[test]
        fn a_frame_that_is_cut_is_reported(frame in frames(), at in any::<prop::sample::Index>()) {
            let bytes = frame.encoded();
            let cut = at.index(bytes.len());
            let read = Frame::read(&mut &bytes[..cut]);
            let is_reported = if cut == 0 { matches!(read, Ok(None)) } else { read.is_err() };
            prop_assert!(is_reported);
        }

        #[test]
        fn any_bytes_are_a_frame_or_reported(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = Frame::read(&mut &bytes[..]);
        }
    }

    #[test]
    fn what_announces_too_much_is_refused_unread() {
        for (length, text) in [(u32::MAX, "a frame of 4294967295 bytes"), (31, "a frame of 31 bytes")] {
            let bytes = [&[0, 0][..], &length.to_le_bytes()].concat();
            assert_eq!(Frame::read(&mut &bytes[..]).unwrap_err().to_string(), text);
        }
    }

    #[test]
    fn net_ids_are_six_numbers() {
        assert_eq!("5.32.116.5.1.1".parse(), Ok(NetId([5, 32, 116, 5, 1, 1])));
        for wrong in ["", "1.2.3.4", "1.2.3.4.5.256", "1.2.3.4.5.6.7"] {
            assert!(wrong.parse::<NetId>().is_err(), "{wrong}");
        }
        assert_eq!(NetId::of(Ipv4Addr::LOCALHOST).to_string(), "127.0.0.1.1.1");
    }
}
