//! Trajectories as MCAP, for Foxglove and `PlotJuggler`: a topic a client, a message a step, log time
//! is virtual time, values are protobuf.
//!
//! Each block ends a chunk, which is put together in memory before it is written: a file that was cut
//! off is whole up to its last chunk, which readers that go from front to back give.

mod descriptor;

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Seek, Write};
use std::sync::Arc;

use mcap::records::MessageHeader;
use mcap::{Compression, McapError, WriteOptions, Writer};
use onescan_base::disk::DiskFile;

use super::block::Block;
use super::column::Column;
use super::sink::{Shape, Sink};

/// Name of the file in a recording.
pub const MCAP: &str = "trajectory.mcap";

/// Bytes of messages in a chunk, about.
const CHUNK_BYTES: u64 = 1 << 20;

/// How values are encoded, for messages and schemas.
const ENCODING: &str = "protobuf";

/// The signals that one client writes.
struct Topic {
    channel: u16,
    columns: Vec<usize>,
}

pub(crate) struct McapSink<W: Write + Seek> {
    file: Writer<W>,
    topics: Vec<Topic>,
    columns: Arc<[Column]>,
    message: Vec<u8>,
}

impl McapSink<BufWriter<Box<dyn DiskFile>>> {
    pub(super) fn create(shape: &Shape) -> io::Result<Self> {
        Self::new(BufWriter::new(shape.disk.create(&shape.folder.join(MCAP))?), shape.columns.clone())
    }
}

impl<W: Write + Seek> McapSink<W> {
    pub(crate) fn new(out: W, columns: Arc<[Column]>) -> io::Result<Self> {
        // Seeking back would leave the head of a chunk unwritten until its end.
        let options = WriteOptions::new()
            .library(concat!("onescan ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(CHUNK_BYTES))
            .disable_seeking(true);
        let mut file = options.create(out).map_err(of_file)?;
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
            let schema = file.add_schema(&format!("onescan.{name}"), ENCODING, &set).map_err(of_file)?;
            let channel =
                file.add_channel(schema, &format!("/{client}"), ENCODING, &BTreeMap::new()).map_err(of_file)?;
            topics.push(Topic { channel, columns: indices });
        }
        Ok(Self { file, topics, columns, message: Vec::new() })
    }
}

impl<W: Write + Seek + Send> Sink for McapSink<W> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        for (row, t_v_ns) in block.t_v_ns.iter().enumerate() {
            // Viewers look for gaps in it.
            let sequence = (block.first_step + row as u64) as u32;
            for topic in &self.topics {
                self.message.clear();
                let columns = topic.columns.iter().map(|index| &self.columns[*index]);
                descriptor::message(columns, block.image(row), &mut self.message);
                let header =
                    MessageHeader { channel_id: topic.channel, sequence, log_time: *t_v_ns, publish_time: *t_v_ns };
                self.file.write_to_known_channel(&header, &self.message).map_err(of_file)?;
            }
        }
        self.file.flush().map_err(of_file)
    }

    fn end(&mut self) -> io::Result<()> {
        self.file.finish().map(drop).map_err(of_file)
    }
}

/// A full disk stays one.
fn of_file(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
