//! Blocks in a stream of bytes: nothing but their length tells them apart.

use std::io;

use bytes::{Buf, Bytes, BytesMut};
use tokio_util::codec::{Decoder, Encoder};

/// Blocks of one length in, blocks of another out.
#[derive(Clone, Copy, Debug)]
pub struct BlockCodec {
    incoming_bytes: usize,
}

impl BlockCodec {
    /// Incoming blocks have `incoming_bytes` bytes, at least one.
    pub fn new(incoming_bytes: usize) -> Self {
        Self { incoming_bytes: incoming_bytes.max(1) }
    }
}

impl Decoder for BlockCodec {
    type Item = Bytes;
    type Error = io::Error;

    /// The newest whole block: those before it are past, and nobody asks what a PLC was.
    fn decode(&mut self, buffer: &mut BytesMut) -> io::Result<Option<Bytes>> {
        let whole = buffer.len() / self.incoming_bytes;
        if whole == 0 {
            buffer.reserve(self.incoming_bytes - buffer.len());
            return Ok(None);
        }
        buffer.advance((whole - 1) * self.incoming_bytes);
        Ok(Some(buffer.split_to(self.incoming_bytes).freeze()))
    }

    fn decode_eof(&mut self, buffer: &mut BytesMut) -> io::Result<Option<Bytes>> {
        match self.decode(buffer)? {
            Some(block) => Ok(Some(block)),
            None if buffer.is_empty() => Ok(None),
            None => {
                let (got, whole) = (buffer.len(), self.incoming_bytes);
                let message = format!(
                    "closed after {got} of the {whole} bytes of a block: is the layout the same on both sides?"
                );
                Err(io::Error::new(io::ErrorKind::UnexpectedEof, message))
            }
        }
    }
}

impl Encoder<&[u8]> for BlockCodec {
    type Error = io::Error;

    fn encode(&mut self, block: &[u8], buffer: &mut BytesMut) -> io::Result<()> {
        buffer.extend_from_slice(block);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_whole_block_counts() {
        let mut codec = BlockCodec::new(3);
        let mut buffer = BytesMut::from(&b"ab"[..]);
        assert_eq!(codec.decode(&mut buffer).unwrap(), None);
        buffer.extend_from_slice(b"cdefgh");
        assert_eq!(codec.decode(&mut buffer).unwrap().as_deref(), Some(&b"def"[..]));
        assert_eq!(codec.decode(&mut buffer).unwrap(), None);
        let error = codec.decode_eof(&mut buffer).unwrap_err();
        assert!(error.to_string().starts_with("closed after 2 of the 3 bytes"));
    }
}
