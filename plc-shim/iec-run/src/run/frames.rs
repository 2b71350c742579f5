//! The functions that were active when something happened in the module, as wasmtime knows them.

use wasmtime::{Trap, WasmBacktrace};

use super::row;

/// Functions by their index, innermost first, each with the offset in its body.
pub(super) type Frames = Vec<(u32, Option<u32>)>;

/// Most callers that a fault knows, the innermost.
pub(super) const MAX_CALLERS: usize = 1024;

/// A trap: its cause and the functions that were active, innermost first, each with the offset
/// in its body.
#[derive(Debug)]
pub(super) struct Trapped {
    pub(super) trap: Option<Trap>,
    pub(super) frames: Frames,
}

impl Trapped {
    /// What cannot happen has, outside of the program: an internal fault without a place in the source.
    pub(super) const NOWHERE: Self = Self { trap: None, frames: Vec::new() };

    /// What a call of the module has ended with.
    pub(super) fn of(error: &wasmtime::Error) -> Self {
        let backtrace = error.downcast_ref::<WasmBacktrace>();
        let frames = backtrace.map(WasmBacktrace::frames).unwrap_or_default().iter();
        let frames = frames.filter(|frame| frame.module().name() != Some(row::NAME));
        let frames = frames.map(|frame| (frame.func_index(), frame.func_offset().map(|offset| offset as u32)));
        Self { trap: error.downcast_ref::<Trap>().copied(), frames: frames.collect() }
    }
}

/// The statement that wrote, by its point, and the functions that were active.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Writer {
    pub(super) point: u32,
    pub(super) frames: Frames,
    /// The ways that decisions around it had gone, by their points, innermost first.
    pub(super) within: Vec<u32>,
}
