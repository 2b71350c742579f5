//! Trajectories as MCAP, for Foxglove and `PlotJuggler`: a topic a client, a message a step, log time
//! is virtual time, values are protobuf.
//!
//! | module | subject |
//! |---|---|
//! | [`descriptor`] | signals as protobuf |
//! | [`file`] | records, chunks, summary |
//!
//! Each block ends a chunk, which is written in one piece: a file that was cut off is whole up to its
//! last chunk, which readers that go from front to back give.

mod descriptor;
mod file;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;

use super::block::Block;
use super::column::Column;
use super::sink::{Shape, Sink};
use file::McapFile;

/// Name of the file in a recording.
pub const MCAP: &str = "trajectory.mcap";

/// Bytes of messages in a chunk, about.
const CHUNK_BYTES: usize = 1 << 20;

/// The signals that one client writes.
struct Topic {
    channel: u16,
    columns: Vec<usize>,
}

/// Writes MCAP.
pub(crate) struct McapSink<W: Write> {
    file: McapFile<W>,
    topics: Vec<Topic>,
    columns: Arc<[Column]>,
    message: Vec<u8>,
}

impl McapSink<File> {
    pub(super) fn create(shape: &Shape) -> io::Result<Self> {
        // Chunks are put together in memory: there is nothing left to buffer.
        Self::new(File::create(shape.folder.join(MCAP))?, shape.columns.clone())
    }
}

impl<W: Write> McapSink<W> {
    pub(crate) fn new(out: W, columns: Arc<[Column]>) -> io::Result<Self> {
        let mut file = McapFile::new(out)?;
        let mut clients: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, column) in columns.iter().enumerate() {
            let client = column.writer.as_ref().map_or_else(|| "signals".to_owned(), ToString::to_string);
            clients.entry(client).or_default().push(index);
        }
        let mut topics = Vec::new();
        for (client, indices) in clients {
            let name = descriptor::identifier(&client);
            let chosen: Vec<&Column> = indices.iter().map(|index| &columns[*index]).collect();
            let set = descriptor::file_descriptor_set(&name, &chosen);
            let channel = file.channel(&format!("/{client}"), &format!("onescan.{name}"), &set)?;
            topics.push(Topic { channel, columns: indices });
        }
        Ok(Self { file, topics, columns, message: Vec::new() })
    }
}

impl<W: Write + Send> Sink for McapSink<W> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        for (row, t_v_ns) in block.t_v_ns.iter().enumerate() {
            // Viewers look for gaps in it.
            let sequence = (block.first_step + row as u64) as u32;
            for topic in &self.topics {
                self.message.clear();
                let columns = topic.columns.iter().map(|index| &self.columns[*index]);
                descriptor::message(columns, block.image(row), &mut self.message);
                self.file.message(topic.channel, sequence, *t_v_ns, &self.message);
            }
            if self.file.chunk_bytes() >= CHUNK_BYTES {
                self.file.end_chunk()?;
            }
        }
        self.file.end_chunk()
    }

    fn end(&mut self) -> io::Result<()> {
        self.file.finish()
    }
}
