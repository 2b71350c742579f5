//! Statements that a fault ends, and the PLC goes on: the host runs them, and takes the trap.

use wasmtime::{Caller, Error, Extern, Linker, Memory};

use super::fault;
use super::frames::Trapped;
use super::host_state::HostState;
use crate::application::Application;
use crate::compile::tried::{MODULE, RUN, exception_code, export};

/// Gives the module what its `__TRY` statements call.
pub(super) fn link(linker: &mut Linker<HostState>) -> Result<(), Error> {
    linker.func_wrap(MODULE, RUN, run)?;
    Ok(())
}

/// Runs the statements with this number. Their outcome is the module's own, or the code of the fault that has ended
/// them; one that has none stops the PLC as anywhere else.
fn run(mut caller: Caller<'_, HostState>, number: i32) -> Result<i32, Error> {
    let name = export(number.cast_unsigned());
    let Some(Extern::Func(statements)) = caller.get_export(&name) else {
        return Err(Error::msg("statements that there are not"));
    };
    let statements = statements.typed::<(), i32>(&caller)?;
    let (memory, application) = ran_by(&caller)?;
    let before = guards(memory.data(&caller), &application);
    let traced = caller.data().trace.as_ref().map_or(0, |trace| trace.active.len());
    let error = match statements.call(&mut caller, ()) {
        Ok(outcome) => return Ok(outcome),
        Err(error) => error,
    };
    let Some(code) = exception_code(fault::kind(&application, &Trapped::of(&error))) else { return Err(error) };
    debug_assert!(code > 0, "the code of a fault is no outcome of statements that end by themselves");
    restore(memory.data_mut(&mut caller), &application, &before);
    if let Some(trace) = &mut caller.data_mut().trace {
        trace.active.truncate(traced);
    }
    Ok(code)
}

/// The memory that the statements work on, and what they were compiled from. Both are there before anything runs.
fn ran_by(caller: &Caller<'_, HostState>) -> Result<(Memory, Application), Error> {
    let HostState { memory: Some(memory), application: Some(application), .. } = caller.data() else {
        return Err(Error::msg("the module runs before it is linked"));
    };
    Ok((*memory, application.clone()))
}

/// The bytes that say which units run.
fn guards(memory: &[u8], application: &Application) -> Vec<u8> {
    let ranges = application.guards().iter();
    ranges.filter_map(|range| memory.get(range.start as usize..range.end as usize)).flatten().copied().collect()
}

/// No unit runs any more that the statements have called.
fn restore(memory: &mut [u8], application: &Application, before: &[u8]) {
    let mut rest = before;
    for range in application.guards() {
        let Some(bytes) = memory.get_mut(range.start as usize..range.end as usize) else { continue };
        let Some((own, others)) = rest.split_at_checked(bytes.len()) else { return };
        bytes.copy_from_slice(own);
        rest = others;
    }
    debug_assert!(rest.is_empty(), "what was kept belongs to the same units");
}
