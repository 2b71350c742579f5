//! The MCAP container (mcap.dev, version 0): records in chunks, an index of them at the end.
//!
//! Only what a recording needs is here: schemas and channels up front, messages in lz4 chunks with
//! their indices, and a summary. Schemas and channels stand before the chunks, so a file that was cut
//! off can be read from front to back up to its last chunk.

use std::collections::BTreeMap;
use std::io::{self, Write};

use lz4_flex::frame::FrameEncoder;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Opcodes of records.
mod op {
    pub(super) const HEADER: u8 = 0x01;
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const CHUNK_INDEX: u8 = 0x08;
    pub(super) const STATISTICS: u8 = 0x0b;
    pub(super) const DATA_END: u8 = 0x0f;
}

const COMPRESSION: &str = "lz4";

/// Messages that are written together.
#[derive(Debug, Default)]
struct Chunk {
    records: Vec<u8>,
    start_ns: u64,
    end_ns: u64,
    /// For each channel, time and offset of its messages.
    index: BTreeMap<u16, Vec<u8>>,
}

/// A file that grows.
#[derive(Debug)]
pub(super) struct McapFile<W: Write> {
    out: W,
    /// Bytes written.
    position: u64,
    chunk: Chunk,
    /// Schema and channel records, which the summary has too.
    declared: Vec<u8>,
    channels: u16,
    chunk_indices: Vec<u8>,
    chunks: u32,
    counts: BTreeMap<u16, u64>,
    times_ns: Option<(u64, u64)>,
}

fn record(opcode: u8, content: &[u8], out: &mut Vec<u8>) {
    out.push(opcode);
    out.extend_from_slice(&(content.len() as u64).to_le_bytes());
    out.extend_from_slice(content);
}

fn bytes(value: &[u8], out: &mut Vec<u8>) {
    out.extend_from_slice(&(value.len() as u32).to_le_bytes());
    out.extend_from_slice(value);
}

/// A map of numbers: its length in bytes, then the pairs.
fn map(pairs: impl Iterator<Item = (u16, u64)>, out: &mut Vec<u8>) {
    let flat: Vec<u8> =
        pairs.flat_map(|(key, value)| [&key.to_le_bytes()[..], &value.to_le_bytes()].concat()).collect();
    bytes(&flat, out);
}

impl<W: Write> McapFile<W> {
    pub(super) fn new(out: W) -> io::Result<Self> {
        let mut file = Self {
            out,
            position: 0,
            chunk: Chunk::default(),
            declared: Vec::new(),
            channels: 0,
            chunk_indices: Vec::new(),
            chunks: 0,
            counts: BTreeMap::new(),
            times_ns: None,
        };
        let mut header = Vec::new();
        bytes(b"", &mut header);
        bytes(concat!("onescan ", env!("CARGO_PKG_VERSION")).as_bytes(), &mut header);
        let mut start = MAGIC.to_vec();
        record(op::HEADER, &header, &mut start);
        file.write(&start)?;
        Ok(file)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.position += bytes.len() as u64;
        Ok(())
    }

    /// Declares a topic of protobuf messages called `name`, described by a serialised
    /// `FileDescriptorSet`; gives its channel.
    pub(super) fn channel(&mut self, topic: &str, name: &str, descriptor: &[u8]) -> io::Result<u16> {
        self.channels += 1;
        let id = self.channels.to_le_bytes();
        let mut schema = id.to_vec();
        bytes(name.as_bytes(), &mut schema);
        bytes(b"protobuf", &mut schema);
        bytes(descriptor, &mut schema);
        let mut channel = [id, id].concat();
        bytes(topic.as_bytes(), &mut channel);
        bytes(b"protobuf", &mut channel);
        bytes(b"", &mut channel);
        let mut both = Vec::new();
        record(op::SCHEMA, &schema, &mut both);
        record(op::CHANNEL, &channel, &mut both);
        self.write(&both)?;
        self.declared.extend_from_slice(&both);
        Ok(self.channels)
    }

    /// Adds a message to the chunk that is open.
    pub(super) fn message(&mut self, channel: u16, sequence: u32, t_ns: u64, data: &[u8]) {
        let chunk = &mut self.chunk;
        (chunk.start_ns, chunk.end_ns) =
            if chunk.records.is_empty() { (t_ns, t_ns) } else { (chunk.start_ns.min(t_ns), chunk.end_ns.max(t_ns)) };
        let index = chunk.index.entry(channel).or_default();
        index.extend_from_slice(&t_ns.to_le_bytes());
        index.extend_from_slice(&(chunk.records.len() as u64).to_le_bytes());
        chunk.records.push(op::MESSAGE);
        chunk.records.extend_from_slice(&(22 + data.len() as u64).to_le_bytes());
        chunk.records.extend_from_slice(&channel.to_le_bytes());
        chunk.records.extend_from_slice(&sequence.to_le_bytes());
        chunk.records.extend_from_slice(&t_ns.to_le_bytes());
        chunk.records.extend_from_slice(&t_ns.to_le_bytes());
        chunk.records.extend_from_slice(data);
        *self.counts.entry(channel).or_default() += 1;
    }

    /// Bytes in the chunk that is open.
    pub(super) fn chunk_bytes(&self) -> usize {
        self.chunk.records.len()
    }

    /// Writes the chunk in one piece, with the indices of its messages.
    pub(super) fn end_chunk(&mut self) -> io::Result<()> {
        let chunk = std::mem::take(&mut self.chunk);
        if chunk.records.is_empty() {
            return Ok(());
        }
        let mut encoder = FrameEncoder::new(Vec::new());
        encoder.write_all(&chunk.records)?;
        let compressed = encoder.finish().map_err(io::Error::other)?;
        let mut content = Vec::with_capacity(compressed.len() + 64);
        content.extend_from_slice(&chunk.start_ns.to_le_bytes());
        content.extend_from_slice(&chunk.end_ns.to_le_bytes());
        content.extend_from_slice(&(chunk.records.len() as u64).to_le_bytes());
        content.extend_from_slice(&crc32fast::hash(&chunk.records).to_le_bytes());
        bytes(COMPRESSION.as_bytes(), &mut content);
        content.extend_from_slice(&(compressed.len() as u64).to_le_bytes());
        content.extend_from_slice(&compressed);
        let begin = self.position;
        let mut all = Vec::with_capacity(content.len() + 16);
        record(op::CHUNK, &content, &mut all);
        let length = all.len() as u64;
        let mut offsets = Vec::new();
        for (channel, entries) in &chunk.index {
            offsets.push((*channel, begin + all.len() as u64));
            let mut content = channel.to_le_bytes().to_vec();
            bytes(entries, &mut content);
            record(op::MESSAGE_INDEX, &content, &mut all);
        }
        self.write(&all)?;
        self.out.flush()?;
        let mut index = Vec::new();
        for number in [chunk.start_ns, chunk.end_ns, begin, length] {
            index.extend_from_slice(&number.to_le_bytes());
        }
        map(offsets.into_iter(), &mut index);
        index.extend_from_slice(&(all.len() as u64 - length).to_le_bytes());
        bytes(COMPRESSION.as_bytes(), &mut index);
        index.extend_from_slice(&(compressed.len() as u64).to_le_bytes());
        index.extend_from_slice(&(chunk.records.len() as u64).to_le_bytes());
        record(op::CHUNK_INDEX, &index, &mut self.chunk_indices);
        self.chunks += 1;
        let (start, end) = self.times_ns.unwrap_or((chunk.start_ns, chunk.end_ns));
        self.times_ns = Some((start.min(chunk.start_ns), end.max(chunk.end_ns)));
        Ok(())
    }

    /// Writes the summary and the footer.
    pub(super) fn finish(&mut self) -> io::Result<()> {
        self.end_chunk()?;
        let mut end = Vec::new();
        record(op::DATA_END, &[0; 4], &mut end);
        let summary = self.position + end.len() as u64;
        end.extend_from_slice(&self.declared);
        end.extend_from_slice(&self.chunk_indices);
        record(op::STATISTICS, &self.statistics(), &mut end);
        let mut footer = summary.to_le_bytes().to_vec();
        footer.extend_from_slice(&[0; 12]);
        record(op::FOOTER, &footer, &mut end);
        end.extend_from_slice(MAGIC);
        self.write(&end)?;
        self.out.flush()
    }

    fn statistics(&self) -> Vec<u8> {
        let messages: u64 = self.counts.values().sum();
        let (start, end) = self.times_ns.unwrap_or_default();
        let mut content = messages.to_le_bytes().to_vec();
        content.extend_from_slice(&self.channels.to_le_bytes());
        for count in [u32::from(self.channels), 0, 0, self.chunks] {
            content.extend_from_slice(&count.to_le_bytes());
        }
        content.extend_from_slice(&start.to_le_bytes());
        content.extend_from_slice(&end.to_le_bytes());
        map(self.counts.iter().map(|(channel, count)| (*channel, *count)), &mut content);
        content
    }
}
