//! A trap as an error in the source.

use std::fmt;

use onescan_base::VirtualTime;
use wasmtime::Trap;

use super::frames::{Frames, MAX_CALLERS, Trapped, Writer};
use super::way::WayId;
use crate::application::Application;
use crate::compile::fault::{Callee, FaultKind, FunctionMarks, Mark};
use onescan_iec::syntax::Span;

/// The PLC stopped because of an error in its program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlcFault {
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
    pub pou: String,
    /// The instance that ran, as in `P1.axis[i].ramp` with indices as they are written; the unit's
    /// name for a function.
    pub instance: String,
    /// The step or transition of a chart, as in "transition `t`"; else empty.
    pub part: String,
    /// The file; empty if it is not known.
    pub file: String,
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// `Ramp`, or `P1.axis.ramp (Ramp)` if the instance has another name, with the part of its chart.
impl fmt::Display for FaultSite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pou, instance, part, .. } = self;
        let other = if pou == instance { String::new() } else { format!(" ({pou})") };
        let part = if part.is_empty() { String::new() } else { format!(", {part}") };
        write!(formatter, "{instance}{other}{part}")
    }
}

impl PlcFault {
    /// Who called whom: `, called by P1.axis (Axis) at axis.st:5, called by P1 (P) at main.st:9`;
    /// nothing for a program. What called itself is reported once, with how often, and of a long way its two ends.
    pub fn way(&self) -> String {
        let mut lines: Vec<(String, usize)> = Vec::new();
        for site in &self.callers {
            let line = format!(", called by {site} at {}:{}", site.file, site.line);
            match lines.last_mut() {
                Some((last, times)) if *last == line => *times += 1,
                _ => lines.push((line, 1)),
            }
        }
        if lines.len() > 2 * SHOWN_CALLERS {
            let left_out: usize = lines.drain(SHOWN_CALLERS..lines.len() - SHOWN_CALLERS).map(|(_, times)| times).sum();
            lines.insert(SHOWN_CALLERS, (format!(", {left_out} more"), 1));
        }
        let shown = lines.into_iter().map(|(line, times)| match times {
            1 => line,
            times => format!("{line} ({times} times)"),
        });
        shown.collect()
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

/// How many a message shows of the innermost, and as many of the outermost, if the way is long.
const SHOWN_CALLERS: usize = 16;

/// What the trap means in the source.
pub(super) fn explain(application: &Application, trapped: &Trapped, virtual_time: VirtualTime) -> PlcFault {
    let known = known(application, &trapped.frames);
    let (kind, mark) = cause(trapped.trap, known.first().copied());
    let mut sites = sites(application, &active(&known, mark));
    // Nothing is active in a fault of the host, which has no place in the source.
    let mut at = sites.pop().unwrap_or_default();
    place(application, mark.map(|mark| mark.span), &mut at);
    sites.reverse();
    sites.truncate(MAX_CALLERS);
    PlcFault { kind, at, callers: sites, virtual_time }
}

/// What the trap is, wherever it was.
pub(super) fn kind(application: &Application, trapped: &Trapped) -> FaultKind {
    cause(trapped.trap, known(application, &trapped.frames).first().copied()).0
}

/// A statement that wrote something.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WriteSite {
    /// The unit of the statement, and where it is.
    pub at: FaultSite,
    /// The units that were active, each where it called the next; the innermost first.
    pub callers: Vec<FaultSite>,
    /// The statement as it is written, blanks drawn together; its beginning if it is long.
    pub statement: String,
    /// The ways that decisions around it had gone, those of callers too, innermost first.
    pub within: Vec<WayId>,
}

/// The statement at `span`, as `writer` says.
pub(super) fn write_site(application: &Application, span: Span, writer: &Writer) -> WriteSite {
    let Writer { frames, within, .. } = writer;
    let known = known(application, frames);
    let mark = known.first().and_then(|(function, offset)| function.statement_before((*offset)?));
    let mut sites = sites(application, &active(&known, mark));
    let mut at = sites.pop().unwrap_or_default();
    place(application, Some(span), &mut at);
    sites.reverse();
    sites.truncate(MAX_CALLERS);
    let within = within.iter().copied().map(WayId).collect();
    WriteSite { at, callers: sites, statement: application.shown(span), within }
}

/// A function that was active, and the offset in its body.
type Frame<'a> = (&'a FunctionMarks, Option<u32>);

/// The functions among `frames` that the application's units were made to.
fn known<'a>(application: &'a Application, frames: &Frames) -> Vec<Frame<'a>> {
    let table = application.faults();
    frames.iter().filter_map(|(index, offset)| Some((table.function(*index)?, *offset))).collect()
}

/// A unit that was active, and the call that it had made.
struct Active<'a> {
    unit: &'a str,
    is_entry: bool,
    made: Option<(Callee, Span)>,
}

/// The units that were active, the innermost first: in each function those put in the place of
/// calls, then its own. `mark` is where the innermost function stopped.
fn active<'a>(frames: &[Frame<'a>], mark: Option<Mark>) -> Vec<Active<'a>> {
    let mut found = Vec::new();
    for (index, (function, offset)) in frames.iter().enumerate() {
        let call = offset.and_then(|offset| function.call_at(offset)).filter(|_| index > 0);
        if let Some((Callee::Itself, mark)) = call {
            // The unit is there already, as the function of these statements; it is the unit's own that was called.
            debug_assert_eq!(mark.unit, 0, "what has such statements is put in the place of no call");
            continue;
        }
        let mut made = call.map(|(callee, mark)| (callee, mark.span));
        let stopped = if index == 0 { mark } else { call.map(|(_, mark)| mark) };
        let mut next = Some(stopped.map_or(0, |mark| mark.unit));
        while let Some(unit) = next.and_then(|unit| function.units.get(unit as usize)) {
            let is_entry = function.is_entry && unit.caller.is_none();
            found.push(Active { unit: &unit.name, is_entry, made });
            made = unit.caller.map(|(_, callee, span)| (callee, span));
            next = unit.caller.map(|(caller, _, _)| caller);
        }
    }
    found
}

/// The sites of units that were active, the outermost first. What a task runs is not a unit of its
/// own, unless the fault is in it.
fn sites(application: &Application, active: &[Active<'_>]) -> Vec<FaultSite> {
    let mut sites = Vec::new();
    let mut instance = String::new();
    let mut call: Option<(Callee, Span)> = None;
    for (index, Active { unit, is_entry, made }) in active.iter().enumerate().rev() {
        let name = |span| application.sources().text(span).split_whitespace().collect::<String>();
        instance = match call {
            _ if *is_entry => (*unit).to_owned(),
            Some((Callee::Inner, span)) => format!("{instance}.{}", name(span)),
            Some((Callee::Global, span)) => name(span),
            Some((Callee::Function | Callee::Itself, _)) => (*unit).to_owned(),
            None if instance.is_empty() => (*unit).to_owned(),
            None => instance,
        };
        call = if *is_entry { None } else { *made };
        if *is_entry && index > 0 {
            continue;
        }
        let mut site = FaultSite { pou: (*unit).to_owned(), instance: instance.clone(), ..FaultSite::default() };
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
    application.chart_part(span).unwrap_or_default().clone_into(&mut site.part);
}

fn cause(trap: Option<Trap>, innermost: Option<Frame<'_>>) -> (FaultKind, Option<Mark>) {
    let statement = innermost.and_then(|(function, offset)| function.statement_before(offset?));
    match trap {
        Some(Trap::OutOfFuel) => (FaultKind::EndlessLoop, statement),
        Some(Trap::StackOverflow) => (FaultKind::CallTooDeep, statement),
        Some(Trap::MemoryOutOfBounds) => (FaultKind::InvalidPointer, statement),
        _ => match innermost.and_then(|(function, offset)| function.fault_at(offset?)) {
            Some((kind, mark)) => (kind, Some(mark)),
            None => (FaultKind::Internal, statement),
        },
    }
}
