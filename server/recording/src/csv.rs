//! Trajectories as CSV: a row a step, a column a signal, `t_v_ns` in the first.

use std::io::{self, BufWriter, Write};
use std::sync::Arc;

use onescan_base::disk::DiskFile;

use super::block::Block;
use super::column::Column;
use super::sink::{Shape, Sink};

/// Name of the file in a recording.
pub const CSV: &str = "trajectory.csv";

/// Writes CSV. Whole rows up to the last block are what a kill leaves.
pub(crate) struct CsvSink<W: Write> {
    writer: csv::Writer<W>,
    columns: Arc<[Column]>,
    /// The step that comes next: one before it has come early.
    next_step: u64,
}

impl CsvSink<BufWriter<Box<dyn DiskFile>>> {
    pub(super) fn create(shape: &Shape) -> io::Result<Self> {
        Self::new(BufWriter::new(shape.disk.create(&shape.folder.join(CSV))?), shape.columns.clone())
    }
}

impl<W: Write> CsvSink<W> {
    pub(crate) fn new(out: W, columns: Arc<[Column]>) -> io::Result<Self> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(std::iter::once("t_v_ns").chain(columns.iter().map(|column| column.name.as_str())))?;
        Ok(Self { writer, columns, next_step: 0 })
    }
}

impl<W: Write + Send> Sink for CsvSink<W> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        let written = self.next_step.saturating_sub(block.first_step) as usize;
        for (row, t_v_ns) in block.t_v_ns.iter().enumerate().skip(written) {
            let image = block.image(row);
            self.writer.write_field(t_v_ns.to_string())?;
            for column in self.columns.iter() {
                self.writer.write_field(column.ty.to_text(column.bytes(image)))?;
            }
            self.writer.write_record(None::<&[u8]>)?;
        }
        self.next_step = self.next_step.max(block.first_step + block.rows() as u64);
        self.writer.flush()
    }

    /// A row is a line, whenever it is written.
    fn early(&mut self, rows: &Block) -> io::Result<()> {
        self.block(rows)
    }

    fn end(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}
