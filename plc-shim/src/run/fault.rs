//! A trap as an error in the source.

use std::fmt;

use wasmtime::Trap;

use super::VirtualTime;
use super::machine::Trapped;
use crate::application::Application;
use crate::compile::fault::{Callee, FaultKind, FunctionMarks};
use crate::syntax::Span;

/// The PLC stopped because of an error in its program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlcFault {
    /// What happened.
    pub kind: FaultKind,
    /// The unit in which it happened, and where.
    pub at: FaultSite,
    /// The units that were active, each where it called the next; the innermost first.
    pub callers: Vec<FaultSite>,
    /// The virtual time of the scan.
    pub virtual_time: VirtualTime,
}

/// A place in a unit that was active.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FaultSite {
    /// The unit.
    pub pou: String,
    /// The instance that ran, as in `P1.axis[i].ramp` with indices as they are written; the unit's
    /// name for a function.
    pub instance: String,
    /// The file; empty if it is not known.
    pub file: String,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// `Ramp`, or `P1.axis.ramp (Ramp)` if the instance has another name.
impl fmt::Display for FaultSite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pou, instance, .. } = self;
        if pou == instance { formatter.write_str(pou) } else { write!(formatter, "{instance} ({pou})") }
    }
}

impl PlcFault {
    /// Who called whom: `, called by P1.axis (Axis) at axis.st:5, called by P1 (P) at main.st:9`;
    /// nothing for a program.
    pub fn way(&self) -> String {
        let site = |site: &FaultSite| format!(", called by {site} at {}:{}", site.file, site.line);
        self.callers.iter().map(site).collect()
    }
}

impl fmt::Display for PlcFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, at, virtual_time, .. } = self;
        let FaultSite { file, line, column, .. } = at;
        write!(formatter, "{kind} at {file}:{line}:{column} in {at}{}, t_v = {virtual_time}", self.way())
    }
}

impl std::error::Error for PlcFault {}

/// Most callers that a fault reports, the innermost.
const MAX_CALLERS: usize = 64;

/// What the trap means in the source.
pub(super) fn explain(application: &Application, trapped: &Trapped, virtual_time: VirtualTime) -> PlcFault {
    let table = application.faults();
    let frames = trapped.frames.iter();
    let known: Vec<Frame<'_>> = frames.filter_map(|(index, offset)| Some((table.function(*index)?, *offset))).collect();
    let (kind, span) = cause(trapped.trap, known.first().copied());
    let mut sites = sites(application, &known);
    let mut at = sites.pop().unwrap_or_default();
    place(application, span, &mut at);
    sites.reverse();
    sites.truncate(MAX_CALLERS);
    PlcFault { kind, at, callers: sites, virtual_time }
}

/// A function that was active, and the offset in its body.
type Frame<'a> = (&'a FunctionMarks, Option<u32>);

/// The units that were active, the outermost first. What a task runs is no unit of its own, unless
/// the fault is in it.
fn sites(application: &Application, frames: &[Frame<'_>]) -> Vec<FaultSite> {
    let mut sites = Vec::new();
    let mut instance = String::new();
    let mut call: Option<(Callee, Span)> = None;
    for (index, (function, offset)) in frames.iter().enumerate().rev() {
        let name = |span| application.sources().text(span).split_whitespace().collect::<String>();
        instance = match call {
            _ if function.is_entry => function.name.clone(),
            Some((Callee::Inner, span)) => format!("{instance}.{}", name(span)),
            Some((Callee::Global, span)) => name(span),
            Some((Callee::Function, _)) => function.name.clone(),
            None => instance,
        };
        let made = offset.and_then(|offset| function.call_at(offset));
        call = if function.is_entry { None } else { made };
        if function.is_entry && index > 0 {
            continue;
        }
        let mut site = FaultSite { pou: function.name.clone(), instance: instance.clone(), ..FaultSite::default() };
        place(application, made.map(|(_, span)| span), &mut site);
        sites.push(site);
    }
    sites
}

fn place(application: &Application, span: Option<Span>, site: &mut FaultSite) {
    let Some(span) = span else { return };
    let (file, place) = application.sources().locate(span);
    file.clone_into(&mut site.file);
    (site.line, site.column) = (place.line, place.column);
}

fn cause(trap: Option<Trap>, innermost: Option<Frame<'_>>) -> (FaultKind, Option<Span>) {
    let statement = innermost.and_then(|(function, offset)| function.statement_before(offset?));
    match trap {
        Some(Trap::OutOfFuel) => (FaultKind::EndlessLoop, statement),
        Some(Trap::StackOverflow) => (FaultKind::CallTooDeep, statement),
        Some(Trap::MemoryOutOfBounds) => (FaultKind::InvalidPointer, statement),
        _ => match innermost.and_then(|(function, offset)| function.fault_at(offset?)) {
            Some((kind, span)) => (kind, Some(span)),
            None => (FaultKind::Internal, statement),
        },
    }
}
