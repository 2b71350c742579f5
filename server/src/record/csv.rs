//! Trajectories as CSV: a row a step, a column a signal.
//!
//! The file grows under a temporary name and takes its own when the session ends, however it ends;
//! a process that is killed leaves the temporary one, with whole rows up to the last flush.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use super::{Observer, RecordError};
use crate::session::Session;
use crate::signal::SignalId;

/// Rows between two flushes: what a kill can cost.
const FLUSH_ROWS: u32 = 1_000;

/// Writes all signals of a session to one CSV file, `t_v_ns` in the first column.
pub struct CsvRecorder {
    path: PathBuf,
    partial: PathBuf,
    writer: Option<csv::Writer<BufWriter<File>>>,
    signals: Vec<SignalId>,
    rows_since_flush: u32,
}

impl CsvRecorder {
    /// A recorder that will write `path`; its folder must exist.
    pub fn new(path: &Path) -> Self {
        let mut partial = path.as_os_str().to_owned();
        partial.push(".partial");
        Self { path: path.to_owned(), partial: partial.into(), writer: None, signals: Vec::new(), rows_since_flush: 0 }
    }

    fn io_error(&self, source: impl Into<std::io::Error>) -> RecordError {
        RecordError { path: self.partial.display().to_string(), source: source.into() }
    }

    fn row(&mut self, session: &Session) -> Result<(), RecordError> {
        let Some(writer) = self.writer.as_mut() else { return Ok(()) };
        let write = |writer: &mut csv::Writer<BufWriter<File>>| -> Result<(), csv::Error> {
            writer.write_field(session.t_v().as_nanos().to_string())?;
            for &signal in &self.signals {
                let bytes = session.layout().bytes(signal, session.image());
                writer.write_field(session.layout().ty(signal).to_text(bytes))?;
            }
            writer.write_record(None::<&[u8]>)
        };
        write(writer).map_err(|e| RecordError { path: self.partial.display().to_string(), source: e.into() })?;
        self.rows_since_flush += 1;
        if self.rows_since_flush == FLUSH_ROWS {
            self.rows_since_flush = 0;
            if let Some(Err(error)) = self.writer.as_mut().map(csv::Writer::flush) {
                return Err(self.io_error(error));
            }
        }
        Ok(())
    }
}

impl Observer for CsvRecorder {
    fn begin(&mut self, session: &Session) -> Result<(), RecordError> {
        let file = File::create(&self.partial).map_err(|e| self.io_error(e))?;
        let mut writer = csv::Writer::from_writer(BufWriter::new(file));
        self.signals = session.layout().signals().collect();
        let names = session.plan().signals().iter().map(|signal| signal.name.as_str());
        writer.write_record(std::iter::once("t_v_ns").chain(names)).map_err(|e| self.io_error(e))?;
        self.writer = Some(writer);
        self.rows_since_flush = 0;
        self.row(session)
    }

    fn step(&mut self, session: &Session) -> Result<(), RecordError> {
        self.row(session)
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        let Some(mut writer) = self.writer.take() else { return Ok(()) };
        writer.flush().map_err(|e| self.io_error(e))?;
        drop(writer);
        std::fs::rename(&self.partial, &self.path).map_err(|e| self.io_error(e))
    }
}
