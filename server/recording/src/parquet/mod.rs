//! Trajectories as Parquet: part files, each complete, that open together as one data set.
//!
//! | module | subject |
//! |---|---|
//! | [`schema`] | types |
//! | [`transpose`] | rows to columns |
//! | [`encode`] | values to pages |
//! | [`chunk`] | pages to column chunks |
//! | [`guard`] | what the library panics at is an error |
//! | [`read`] | parts read back |
//!
//! A part grows under a name that begins with a dot, which readers of data sets leave out, and takes
//! its own when its footer is written. What has come of it meanwhile is in small files of their own, `part-000003.000001.parquet`
//! and so on, whose place the part takes.

mod chunk;
mod encode;
mod guard;
pub(crate) mod read;
pub(crate) mod schema;
mod transpose;

use std::collections::BTreeSet;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use onescan_base::disk::{Disk, DiskFile, growing};
use parquet::basic::Encoding;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterVersion};
use parquet::file::writer::SerializedFileWriter;

use super::block::Block;
use super::column::Column;
use super::sink::{Shape, Sink};
use encode::Encoded;
use schema::Held;
use transpose::Columns;

/// Name of the folder with the parts of the trajectory.
pub const TRAJECTORY: &str = "trajectory";

/// Key of a part's first step among its metadata.
pub(crate) const FIRST_STEP: &str = "onescan.first_step";

/// The name of a part, counted from 1.
fn part_name(number: u64) -> String {
    format!("part-{number:06}.parquet")
}

/// The name of a file with the next steps of a part that is not complete.
fn early_name(number: u64, file: usize) -> String {
    format!("part-{number:06}.{file:06}.parquet")
}

/// The part that takes the place of a file; nothing if that is a part itself.
fn part_of(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let (part, _) = name.strip_suffix(".parquet")?.split_once('.')?;
    Some(path.with_file_name(format!("{part}.parquet")))
}

/// One file: a schema, row groups, a footer.
pub(crate) struct ParquetFile<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    signals: Arc<[Column]>,
    columns: Columns,
    /// The signals in the order of the image: neighbours are fetched together.
    order: Vec<usize>,
    snappy: snap::raw::Encoder,
}

impl<W: Write + Send> ParquetFile<W> {
    pub(crate) fn new(out: W, signals: Arc<[Column]>, first_step: u64) -> io::Result<Self> {
        let properties = WriterProperties::builder()
            .set_writer_version(WriterVersion::PARQUET_1_0)
            .set_statistics_enabled(EnabledStatistics::None)
            .set_offset_index_disabled(true)
            .set_created_by(concat!("onescan ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let mut writer = SerializedFileWriter::new(out, schema::schema(&signals)?, Arc::new(properties))?;
        writer.append_key_value_metadata(KeyValue::new(FIRST_STEP.to_owned(), first_step.to_string()));
        let mut order: Vec<usize> = (0..signals.len()).collect();
        order.sort_by_key(|index| signals[*index].offset);
        Ok(Self { writer, signals, columns: Columns::default(), order, snappy: snap::raw::Encoder::new() })
    }

    /// Writes a row group.
    fn rows(&mut self, block: &Block) -> io::Result<()> {
        let schema = self.writer.schema_descr();
        let descriptors: Vec<_> = (0..schema.num_columns()).map(|index| schema.column(index)).collect();
        let encoded = self.encoded(block);
        let mut group = self.writer.next_row_group()?;
        for (descriptor, encoded) in descriptors.into_iter().zip(encoded) {
            let (bytes, close) = chunk::chunk(descriptor, encoded, block.rows(), &mut self.snappy)?;
            group.append_column(&bytes, close)?;
        }
        group.close()?;
        Ok(())
    }

    /// The leading columns, then the signals in their order.
    fn encoded(&mut self, block: &Block) -> Vec<Encoded> {
        let rows = block.rows();
        let t_v_ns = &block.t_v_ns;
        let step_ns = t_v_ns.get(1).map_or(0, |second| second.wrapping_sub(t_v_ns[0]));
        let digests = Encoded { dictionary: None, data: block.digests.concat(), encoding: Encoding::PLAIN };
        let mut all =
            vec![encode::arithmetic(block.first_step, 1, rows), encode::arithmetic(t_v_ns[0], step_ns, rows), digests];
        let mut signals: Vec<Option<Encoded>> = self.order.iter().map(|_| None).collect();
        self.columns.begin(block);
        for &index in &self.order {
            let column = &self.signals[index];
            let values = self.columns.get(block, column);
            let text = |bytes: &[u8]| column.ty.to_text(bytes);
            signals[index] = Some(encode::encode(values, rows, column.ty.size(), Held::of(column.ty), &text));
        }
        all.extend(signals.into_iter().flatten());
        all
    }

    /// Writes the footer.
    fn finish(&mut self) -> io::Result<()> {
        self.writer.finish()?;
        self.writer.inner_mut().flush()
    }
}

impl<W: Write + Send> Sink for ParquetFile<W> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        self.rows(block)
    }

    fn end(&mut self) -> io::Result<()> {
        self.finish()
    }
}

pub(super) struct ParquetSink {
    folder: PathBuf,
    signals: Arc<[Column]>,
    disk: Arc<dyn Disk>,
    part: Option<ParquetFile<BufWriter<Box<dyn DiskFile>>>>,
    number: u64,
    /// Files with what has come of the part in progress; the part takes their place.
    early: Vec<PathBuf>,
}

impl ParquetSink {
    /// Empties the folder of parts and restarts.
    pub(super) fn create(shape: &Shape) -> io::Result<Self> {
        let (folder, disk) = (shape.folder.join(TRAJECTORY), Arc::clone(&shape.disk));
        disk.create_folder(&folder)?;
        let mut left: Vec<PathBuf> = Vec::new();
        for entry in std::fs::read_dir(&folder)? {
            let entry = entry?;
            if entry.file_name().to_string_lossy().trim_start_matches('.').starts_with("part-") {
                left.push(entry.path());
            }
        }
        // The last first: what a kill leaves of them has its beginning.
        left.sort();
        left.iter().rev().try_for_each(|part| disk.remove_file(part))?;
        Ok(Self { folder, signals: shape.columns.clone(), disk, part: None, number: 0, early: Vec::new() })
    }

    fn part_path(&self) -> PathBuf {
        self.folder.join(part_name(self.number))
    }

    fn end_part(&mut self) -> io::Result<()> {
        let Some(mut part) = self.part.take() else { return Ok(()) };
        part.finish()?;
        // The part takes its name before the early files go: between the two, a kill leaves each step at least once.
        drop(part);
        let path = self.part_path();
        self.disk.rename(&growing(&path), &path)?;
        self.early.drain(..).try_for_each(|early| self.disk.remove_file(&early))
    }
}

impl Sink for ParquetSink {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        if self.part.is_none() {
            self.number += 1;
            let file = BufWriter::new(self.disk.create(&growing(&self.part_path()))?);
            self.part = Some(ParquetFile::new(file, self.signals.clone(), block.first_step)?);
        }
        if let Some(part) = &mut self.part {
            part.rows(block)?;
        }
        if block.ends_part { self.end_part() } else { Ok(()) }
    }

    fn early(&mut self, rows: &Block) -> io::Result<()> {
        let number = if self.part.is_some() { self.number } else { self.number + 1 };
        let whole = self.folder.join(early_name(number, self.early.len() + 1));
        let growing = growing(&whole);
        let file = BufWriter::new(self.disk.create(&growing)?);
        let mut early = ParquetFile::new(file, self.signals.clone(), rows.first_step)?;
        early.rows(rows)?;
        early.finish()?;
        drop(early);
        self.disk.rename(&growing, &whole)?;
        self.early.push(whole);
        Ok(())
    }

    fn end(&mut self) -> io::Result<()> {
        self.end_part()
    }
}

/// The parts in `folder` in their order, and behind them what there is of one that never became whole.
pub(crate) fn parts(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut parts = Vec::new();
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        // A kill may have come before it was made.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(parts),
        Err(error) => return Err(error),
    };
    for entry in entries {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("part-") && path.extension().is_some_and(|extension| extension == "parquet") {
            parts.push(path);
        }
    }
    parts.sort();
    // A kill may have come when the part was there and what it takes the place of was not gone yet.
    let whole: BTreeSet<PathBuf> = parts.iter().cloned().collect();
    parts.retain(|part| part_of(part).is_none_or(|of| !whole.contains(&of)));
    Ok(parts)
}
