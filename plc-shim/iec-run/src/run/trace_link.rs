//! What the module's statements call while it is traced.

use wasmtime::{Caller, Error, Linker, WasmBacktrace};

use super::frames::Frames;
use super::host_state::HostState;
use super::trace::Trace;
use crate::compile::trace::{BEGIN, CHOOSE, END, MODULE, READ};

/// The functions that are active, innermost first, each with the offset in its body.
fn frames(caller: &Caller<'_, HostState>) -> Frames {
    let backtrace = WasmBacktrace::force_capture(caller);
    let frame = |frame: &wasmtime::FrameInfo| (frame.func_index(), frame.func_offset().map(|offset| offset as u32));
    backtrace.frames().iter().map(frame).collect()
}

fn with_trace(caller: &mut Caller<'_, HostState>, work: impl FnOnce(&mut Trace, &[u8], &Caller<'_, HostState>)) {
    let Some(memory) = caller.data().memory else { return };
    let Some(mut trace) = caller.data_mut().trace.take() else { return };
    work(&mut trace, memory.data(&*caller), caller);
    caller.data_mut().trace = Some(trace);
}

/// What changed before a statement begins was the one's around it.
fn begin(mut caller: Caller<'_, HostState>, point: u32) {
    with_trace(&mut caller, |trace, memory, caller| {
        let around = trace.active.last().map(|(statement, _)| *statement);
        trace.look(around, &(0..0), memory, || frames(caller));
        trace.active.push((point, None));
        if let Some(journal) = &mut trace.journal {
            journal.statement_begins(point);
        }
    });
}

fn end(mut caller: Caller<'_, HostState>, point: u32, address: u32, size: u32) {
    with_trace(&mut caller, |trace, memory, caller| {
        let stored = address as usize..(address as usize).saturating_add(size as usize);
        trace.look(Some(point), &stored, memory, || frames(caller));
        if let Some(at) = trace.active.iter().rposition(|(active, _)| *active == point) {
            trace.active.truncate(at);
        }
        if let Some(journal) = &mut trace.journal {
            journal.statement_ends(point);
        }
    });
}

fn choose(mut caller: Caller<'_, HostState>, statement: u32, way: u32) {
    with_trace(&mut caller, |trace, memory, caller| {
        if let Some(journal) = &mut trace.journal {
            journal.wrote(Some(statement), memory, || frames(caller));
            journal.chose(statement, way);
        }
        trace.choose(statement, way);
    });
}

fn read(mut caller: Caller<'_, HostState>, address: u32, size: u32) {
    if let Some(journal) = caller.data_mut().trace.as_mut().and_then(|trace| trace.journal.as_mut()) {
        journal.read(address, size);
    }
}

/// Gives the module what its statements call.
pub(super) fn link(linker: &mut Linker<HostState>) -> Result<(), Error> {
    linker.func_wrap(MODULE, BEGIN, begin)?;
    linker.func_wrap(MODULE, END, end)?;
    linker.func_wrap(MODULE, CHOOSE, choose)?;
    linker.func_wrap(MODULE, READ, read)?;
    Ok(())
}
