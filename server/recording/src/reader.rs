//! A recording read back: its header, its events, the steps that it holds.
//!
//! A recording whose run was killed is read up to its last whole part.

use std::io;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use onescan_base::regular::{self, Limit};
use thiserror::Error;

use onescan_server::digest::Digest;
use onescan_server::operation::OperatorInput;
use onescan_server::signal::pattern::{SignalPattern, Unmatched, choose};
use onescan_server::time::{StepCount, VirtualTime};

use crate::block::Block;
use crate::column::Column;
use crate::event::{self, Event, EventKind};
use crate::header::{FORMAT, Header};
use crate::parquet::read::Part;
use crate::parquet::{ParquetFile, TRAJECTORY, parts};
use crate::place::SCENARIO;
use crate::recorder::{EVENTS, HEADER};
use crate::sink::Sink;
use crate::{csv, mcap};

/// Why a folder is not read as a recording.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// Nothing says that it is one.
    #[error("{} is not a recording: it has no `{HEADER}`{}", path.display(), several(runs))]
    Foreign { path: PathBuf, runs: Vec<String> },
    /// A layout that this version does not know.
    #[error("{}: version {version} of the layout of recordings is not known; this program knows {FORMAT}", path.display())]
    Version { path: PathBuf, version: u32 },
    /// A file that cannot be read, or is not what its name says.
    #[error("cannot read {}: {source}", path.display())]
    Damaged { path: PathBuf, source: io::Error },
    /// A pattern of no signal.
    #[error(transparent)]
    Unmatched(#[from] Unmatched),
    /// What is written of it cannot be.
    #[error("cannot write: {0}")]
    Output(io::Error),
}

fn several(runs: &[String]) -> String {
    match runs {
        [] => String::new(),
        runs => format!("; name one of the recordings in it: {}", runs.join(", ")),
    }
}

/// A form of trajectory that a recording can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    Csv,
    Parquet,
    Mcap,
}

/// A recording.
///
/// ```no_run
/// use onescan_recording::Recording;
///
/// let recording = Recording::open("out".as_ref())?;
/// if let Some(steps) = recording.steps() {
///     println!("{}", recording.digest(*steps.end())?);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Recording {
    folder: PathBuf,
    header: Header,
    parts: Vec<Part>,
}

/// Chosen signals of a recording over some steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// The signals, in the order of their names.
    pub columns: Vec<Column>,
    /// A row a step.
    pub rows: Vec<Row>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    pub step: StepCount,
    pub t_v: VirtualTime,
    /// The digest of all steps up to it.
    pub digest: Digest,
    image: Vec<u8>,
}

impl Row {
    /// The bytes of a signal, as in an image.
    pub fn bytes(&self, column: &Column) -> &[u8] {
        column.bytes(&self.image)
    }
}

impl Recording {
    /// Opens the recording in `folder`, or the only one in a folder of recordings.
    ///
    /// # Errors
    /// See [`RecordingError`].
    pub fn open(folder: &Path) -> Result<Self, RecordingError> {
        let path = folder.join(HEADER);
        if !path.is_file() {
            let mut runs = recordings_in(folder);
            return match runs.len() {
                1 => Self::open(&folder.join(runs.remove(0))),
                _ => Err(RecordingError::Foreign { path: folder.to_owned(), runs }),
            };
        }
        let damaged = |path: &Path| {
            let path = path.to_owned();
            move |source| RecordingError::Damaged { path, source }
        };
        let text = regular::read(&path, Limit::TEXT).map_err(damaged(&path))?;
        // The version alone, first: a header of another version may have other fields.
        let version: Versioned = serde_json::from_slice(&text).map_err(|e| damaged(&path)(e.into()))?;
        if version.recording != FORMAT {
            return Err(RecordingError::Version { path: folder.to_owned(), version: version.recording });
        }
        let header: Header = serde_json::from_slice(&text).map_err(|e| damaged(&path)(e.into()))?;
        let trajectory = folder.join(TRAJECTORY);
        let mut found: Vec<Part> = Vec::new();
        for part in parts(&trajectory).map_err(damaged(&trajectory))? {
            let part = Part::open(&part).map_err(damaged(&part))?;
            let expected = found.last().map_or(header.first_step.0, |last| last.first_step + last.rows);
            if part.first_step != expected {
                let message = format!("its first step is {}, but step {expected} comes next", part.first_step);
                return Err(damaged(&part.path)(io::Error::other(message)));
            }
            found.push(part);
        }
        Ok(Self { folder: folder.to_owned(), header, parts: found })
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What was run.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Where the scenario is that was run.
    pub fn scenario(&self) -> PathBuf {
        self.folder.join(SCENARIO).join(&self.header.provenance.folder)
    }

    /// What happened beside the steps.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn events(&self) -> Result<Vec<Event>, RecordingError> {
        let path = self.folder.join(EVENTS);
        event::read(&path).map_err(|source| RecordingError::Damaged { path, source })
    }

    /// Whether its run came to an end, of whatever kind. One without events, of which somebody kept the trajectory alone, counts
    /// as whole.
    pub fn is_whole(&self) -> bool {
        if !self.folder.join(EVENTS).exists() {
            return true;
        }
        let is_end = |event: &Event| matches!(event.what, EventKind::Ended { .. });
        self.events().is_ok_and(|events| events.iter().any(is_end))
    }

    /// What operators did, to be replayed.
    ///
    /// # Errors
    /// The file of events cannot be read.
    pub fn operator_inputs(&self) -> Result<Vec<OperatorInput>, RecordingError> {
        self.events().map(|events| event::operator_inputs(&events))
    }

    /// The first and the last step recorded; nothing if there is none.
    pub fn steps(&self) -> Option<RangeInclusive<u64>> {
        let (first, last) = (self.parts.first()?, self.parts.last()?);
        (last.rows > 0).then(|| first.first_step..=last.first_step + last.rows - 1)
    }

    /// The recorded signals that `patterns` choose, each with its place among them.
    fn columns(&self, patterns: &[SignalPattern]) -> Result<Vec<(usize, Column)>, Unmatched> {
        let recorded: Vec<_> = self.header.signals.iter().filter(|signal| signal.recorded).collect();
        let mut offset = 0;
        let chosen = choose(patterns, recorded.iter().map(|signal| &signal.name))?;
        let column = |place: usize| {
            let signal = recorded[place];
            let (name, unit, writer) = (signal.name.clone(), signal.unit.clone(), signal.writer.clone());
            let column = Column { name, ty: signal.ty, unit, writer, offset };
            offset += signal.ty.size();
            (place, column)
        };
        Ok(chosen.into_iter().map(column).collect())
    }

    /// Chosen signals, all without patterns, over some steps; those that are not recorded are left out.
    ///
    /// # Errors
    /// A part cannot be read, a pattern matches no signal.
    pub fn rows(&self, patterns: &[SignalPattern], steps: RangeInclusive<u64>) -> Result<Rows, RecordingError> {
        let columns = self.columns(patterns)?;
        let mut rows = Vec::new();
        self.each_row(&columns, steps, &mut |row| {
            rows.push(row);
            Ok(())
        })?;
        Ok(Rows { columns: columns.into_iter().map(|(_, column)| column).collect(), rows })
    }

    /// Hands chosen signals over step by step, all signals without patterns, without holding more than a block of steps;
    /// those that are not recorded are left out.
    ///
    /// # Errors
    /// A part cannot be read, a pattern matches no signal.
    pub fn each(
        &self,
        patterns: &[SignalPattern],
        steps: RangeInclusive<u64>,
        each: &mut dyn FnMut(&[Column], &Row),
    ) -> Result<(), RecordingError> {
        let places = self.columns(patterns)?;
        let columns: Vec<Column> = places.iter().map(|(_, column)| column.clone()).collect();
        self.each_row(&places, steps, &mut |row| {
            each(&columns, &row);
            Ok(())
        })
    }

    /// Calls `each` with every row of `steps`, without holding more than a block of them.
    fn each_row(
        &self,
        columns: &[(usize, Column)],
        steps: RangeInclusive<u64>,
        each: &mut dyn FnMut(Row) -> io::Result<()>,
    ) -> Result<(), RecordingError> {
        self.blocks(columns, &steps, &mut |block| {
            for row in 0..block.rows() {
                let step = block.first_step + row as u64;
                if steps.contains(&step) {
                    each(Row {
                        step: StepCount(step),
                        t_v: VirtualTime::from_nanos(block.t_v_ns[row]),
                        digest: Digest::from_bytes(block.digests[row]),
                        image: block.image(row).to_vec(),
                    })?;
                }
            }
            Ok(())
        })
    }

    fn blocks(
        &self,
        columns: &[(usize, Column)],
        steps: &RangeInclusive<u64>,
        each: &mut dyn FnMut(&Block) -> io::Result<()>,
    ) -> Result<(), RecordingError> {
        let overlaps = |part: &&Part| part.first_step <= *steps.end() && *steps.start() < part.first_step + part.rows;
        for part in self.parts.iter().filter(overlaps) {
            let damaged = |source| RecordingError::Damaged { path: part.path.clone(), source };
            part.blocks(columns, each).map_err(damaged)?;
        }
        Ok(())
    }

    /// The steps from `from` to `to`, both included where they are recorded.
    ///
    /// # Errors
    /// A part cannot be read.
    pub fn steps_between(
        &self,
        from: VirtualTime,
        to: VirtualTime,
    ) -> Result<Option<RangeInclusive<u64>>, RecordingError> {
        let (Some(steps), Some(first)) = (self.steps(), self.parts.first()) else { return Ok(None) };
        let start = self.rows_of(first.first_step)?.t_v.as_nanos();
        let span = self.header.step.as_nanos();
        // Virtual time grows by one step a row.
        let after = |t: VirtualTime| t.as_nanos().saturating_sub(start);
        let low = *steps.start() + after(from).div_ceil(span);
        let high = (*steps.start() + after(to) / span).min(*steps.end());
        Ok((to.as_nanos() >= start && low <= high).then_some(low..=high))
    }

    fn rows_of(&self, step: u64) -> Result<Row, RecordingError> {
        let mut found = None;
        self.each_row(&[], step..=step, &mut |row| {
            found = Some(row);
            Ok(())
        })?;
        found.ok_or_else(|| RecordingError::Damaged {
            path: self.folder.join(TRAJECTORY),
            source: io::Error::other(format!("step {step} is missing")),
        })
    }

    /// Some steps without their signals.
    ///
    /// # Errors
    /// A part cannot be read.
    pub fn digests(&self, steps: RangeInclusive<u64>) -> Result<Vec<Row>, RecordingError> {
        let mut rows = Vec::new();
        self.each_row(&[], steps, &mut |row| {
            rows.push(row);
            Ok(())
        })?;
        Ok(rows)
    }

    /// The digest up to `step`.
    ///
    /// # Errors
    /// It is not recorded, or its part cannot be read.
    pub fn digest(&self, step: u64) -> Result<Digest, RecordingError> {
        self.rows_of(step).map(|row| row.digest)
    }

    /// The first step of each part that begins within `steps`, to search by.
    pub fn part_starts(&self) -> impl Iterator<Item = u64> {
        self.parts.iter().map(|part| part.first_step)
    }

    /// Writes chosen signals over some steps to `path`.
    ///
    /// # Errors
    /// A part cannot be read, a pattern matches no signal, the file cannot be written.
    pub fn export(
        &self,
        format: ExportFormat,
        patterns: &[SignalPattern],
        steps: RangeInclusive<u64>,
        out: std::fs::File,
    ) -> Result<(), RecordingError> {
        let columns = self.columns(patterns)?;
        let shape: Arc<[Column]> = columns.iter().map(|(_, column)| column.clone()).collect();
        let mut sink = sink(format, io::BufWriter::new(out), shape, *steps.start()).map_err(RecordingError::Output)?;
        // `blocks` reports what it is given as damage of the recording; an error of the output is another one.
        let mut failed = None;
        self.blocks(&columns, &steps, &mut |block| {
            if let Some(part) = block.within(&steps)
                && failed.is_none()
            {
                failed = sink.block(&part).err();
            }
            Ok(())
        })?;
        failed.map_or_else(|| sink.end(), Err).map_err(RecordingError::Output)
    }
}

fn sink(
    format: ExportFormat,
    out: io::BufWriter<std::fs::File>,
    columns: Arc<[Column]>,
    first_step: u64,
) -> io::Result<Box<dyn Sink>> {
    Ok(match format {
        ExportFormat::Csv => Box::new(csv::CsvSink::new(out, columns)?),
        ExportFormat::Mcap => Box::new(mcap::McapSink::new(out, columns)?),
        ExportFormat::Parquet => Box::new(ParquetFile::new(out, columns, first_step)?),
    })
}

#[derive(serde::Deserialize)]
struct Versioned {
    recording: u32,
}

/// The recordings in a folder, by name.
fn recordings_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let recorded = entries.filter(|entry| entry.path().join(HEADER).is_file());
    let mut names: Vec<String> = recorded.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
