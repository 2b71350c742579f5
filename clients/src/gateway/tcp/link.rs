//! The gateway's side: blocking, as a step waits for exactly one thing at a time.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use bytes::BytesMut;
use tokio_util::codec::{Decoder, Encoder};

use super::codec::BlockCodec;
use super::layout::Layouts;
use crate::gateway::fault::LinkFault;
use crate::gateway::link::Link;
use crate::gateway::socket;

/// Bytes asked for in one read.
const READ_BYTES: usize = 16 * 1024;

/// Data blocks over TCP.
pub struct TcpLink {
    address: String,
    layouts: Layouts,
    stream: Option<TcpStream>,
    codec: BlockCodec,
    incoming: BytesMut,
    outgoing: BytesMut,
    block: Vec<u8>,
    buffer: Vec<u8>,
    patience: Option<Duration>,
    /// For the connection to come about, and for a block to be taken.
    timeout: Duration,
}

impl TcpLink {
    /// A link to `address`, a host and a port.
    pub fn new(address: &str, layouts: Layouts, timeout: Duration) -> Self {
        Self {
            address: address.to_owned(),
            codec: BlockCodec::new(layouts.from_plc.size()),
            block: vec![0; layouts.to_plc.size()],
            layouts,
            stream: None,
            incoming: BytesMut::new(),
            outgoing: BytesMut::new(),
            buffer: vec![0; READ_BYTES],
            patience: None,
            timeout,
        }
    }
}

fn lost(error: &std::io::Error) -> LinkFault {
    LinkFault::Lost(error.to_string())
}

impl Link for TcpLink {
    fn connect(&mut self) -> Result<(), LinkFault> {
        // The old connection goes first: a PLC may have room for one.
        self.stream = None;
        self.incoming.clear();
        self.patience = None;
        let url = || format!("tcp://{}", self.address);
        let stream = socket::connect(&self.address[..], self.timeout)
            .map_err(|reason| LinkFault::Unreachable { url: url(), reason })?;
        self.stream = Some(stream);
        Ok(())
    }

    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault> {
        let stream = self.stream.as_mut().ok_or_else(LinkFault::not_connected)?;
        self.layouts.to_plc.encode(to_plc, &mut self.block);
        self.outgoing.clear();
        self.codec.encode(&self.block, &mut self.outgoing).map_err(|error| lost(&error))?;
        stream.write_all(&self.outgoing).map_err(|error| lost(&error))
    }

    fn is_polled(&self) -> bool {
        false
    }

    fn read(&mut self, patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        let stream = self.stream.as_mut().ok_or_else(LinkFault::not_connected)?;
        if self.patience != Some(patience) {
            stream.set_read_timeout(Some(patience)).map_err(|error| lost(&error))?;
            self.patience = Some(patience);
        }
        loop {
            match stream.read(&mut self.buffer) {
                Ok(0) => {
                    self.codec.decode_eof(&mut self.incoming).map_err(|error| lost(&error))?;
                    return Err(LinkFault::Lost("closed by the PLC".to_owned()));
                }
                Ok(count) => self.incoming.extend_from_slice(&self.buffer[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => return Ok(false),
                Err(error) => return Err(lost(&error)),
            }
            if let Some(block) = self.codec.decode(&mut self.incoming).map_err(|error| lost(&error))? {
                self.layouts.from_plc.decode(&block, from_plc);
                return Ok(true);
            }
        }
    }
}
