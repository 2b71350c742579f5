//! A trap as an error in the source.

use std::fmt;

use wasmtime::Trap;

use super::VirtualTime;
use super::machine::Trapped;
use crate::application::Application;
use crate::compile::fault::{FaultKind, FunctionMarks, Mark};

/// The PLC stopped because of an error in its program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlcFault {
    /// What happened.
    pub kind: FaultKind,
    /// The file; empty if it is not known.
    pub file: String,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// The unit in which it happened.
    pub pou: String,
    /// The units that were active, the program first, `pou` last.
    pub call_path: Vec<String>,
    /// The virtual time of the scan.
    pub virtual_time: VirtualTime,
}

impl fmt::Display for PlcFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, file, line, column, pou, call_path, virtual_time } = self;
        write!(formatter, "{kind} at {file}:{line}:{column} in {pou}")?;
        if call_path.len() > 1 {
            write!(formatter, " (called by way of {})", call_path.join(", "))?;
        }
        write!(formatter, ", t_v = {virtual_time}")
    }
}

impl std::error::Error for PlcFault {}

/// Longest call path that a fault reports.
const MAX_PATH: usize = 64;

/// What the trap means in the source.
pub(super) fn explain(application: &Application, trapped: &Trapped, virtual_time: VirtualTime) -> PlcFault {
    let table = application.faults();
    let frames = trapped.frames.iter();
    let mut known = frames.filter_map(|(index, offset)| Some((table.function(*index)?, *offset)));
    let innermost = known.next();
    let (kind, mark) = cause(trapped.trap, innermost);
    let mut call_path: Vec<String> = Vec::new();
    if let Some((function, _)) = innermost {
        call_path.extend(function.active(mark.map_or(0, |mark| mark.unit)).map(str::to_owned));
    }
    for (function, offset) in known {
        let call = offset.and_then(|offset| function.statement_before(offset));
        call_path.extend(function.active(call.map_or(0, |mark| mark.unit)).map(str::to_owned));
    }
    let pou = call_path.first().cloned().unwrap_or_default();
    call_path.truncate(MAX_PATH + 1);
    call_path.reverse();
    let span = mark.map(|mark| mark.span);
    let (file, place) = span.map_or(("", None), |span| {
        let (file, place) = application.sources().locate(span);
        (file, Some(place))
    });
    PlcFault {
        kind,
        file: file.to_owned(),
        line: place.map_or(0, |place| place.line),
        column: place.map_or(0, |place| place.column),
        pou,
        call_path,
        virtual_time,
    }
}

fn cause(trap: Option<Trap>, innermost: Option<(&FunctionMarks, Option<u32>)>) -> (FaultKind, Option<Mark>) {
    let statement = innermost.and_then(|(function, offset)| function.statement_before(offset?));
    match trap {
        Some(Trap::OutOfFuel) => (FaultKind::EndlessLoop, statement),
        Some(Trap::StackOverflow) => (FaultKind::CallTooDeep, statement),
        _ => {
            let mark = innermost.and_then(|(function, offset)| function.fault_at(offset?));
            match mark.and_then(|mark| Some((mark.fault?, mark))) {
                Some((kind, mark)) => (kind, Some(mark)),
                None => (FaultKind::Internal, statement),
            }
        }
    }
}
