//! The compiled module with its memory, in wasmtime.

use wasmtime::{Config, Engine, Instance, Linker, Memory, Module, Store, Trap, TypedFunc, WasmBacktrace};

use super::plan::RunError;
use super::text::link::{HostState, link};
use crate::application::Application;
use crate::compile::{MEMORY_EXPORT, entry_export, host};

/// One instance of the module.
pub(super) struct Machine {
    store: Store<HostState>,
    memory: Memory,
    /// Bytes in use; the rest of the last page is never touched.
    size: usize,
    /// The functions in a row of each thing that tasks can run.
    entries: Vec<Vec<TypedFunc<(), ()>>>,
}

/// A trap: its cause and the functions that were active, innermost first, each with the offset
/// in its body.
#[derive(Debug)]
pub(super) struct Trapped {
    pub(super) trap: Option<Trap>,
    pub(super) frames: Vec<(u32, Option<u32>)>,
}

fn engine() -> Result<Engine, String> {
    let mut config = Config::new();
    // Fuel, unlike an epoch, stops an endless loop at the same instruction in every run.
    config.consume_fuel(true);
    config.cranelift_nan_canonicalization(true);
    config.relaxed_simd_deterministic(true);
    Engine::new(&config).map_err(|error| error.to_string())
}

fn module_error(error: &wasmtime::Error) -> RunError {
    RunError::Module(format!("{error:#}"))
}

impl Machine {
    pub(super) fn new(application: &Application) -> Result<Self, RunError> {
        let module = application.module(|wasm| Module::new(&engine()?, wasm).map_err(|error| format!("{error:#}")));
        let module = module.map_err(RunError::Module)?;
        let mut store = Store::new(module.engine(), HostState::default());
        // To fill the table of methods takes instructions too.
        store.set_fuel(u64::MAX).map_err(|error| module_error(&error))?;
        let linker = linker(module.engine()).map_err(|error| module_error(&error))?;
        let instance = linker.instantiate(&mut store, &module);
        let instance = instance.map_err(|error| module_error(&error))?;
        let memory = instance.get_memory(&mut store, MEMORY_EXPORT);
        let memory = memory.ok_or_else(|| RunError::Module("memory is missing".to_owned()))?;
        store.data_mut().memory = Some(memory);
        let size = application.initial_memory().len();
        let parts = application.entry_parts().enumerate();
        let entries = parts.map(|(index, count)| entry(&instance, &mut store, index, count));
        let entries = entries.collect::<Result<_, _>>()?;
        Ok(Self { store, memory, size, entries })
    }

    pub(super) fn memory(&self) -> &[u8] {
        let all = self.memory.data(&self.store);
        all.get(..self.size).unwrap_or(all)
    }

    pub(super) fn memory_mut(&mut self) -> &mut [u8] {
        let all = self.memory.data_mut(&mut self.store);
        let size = self.size.min(all.len());
        &mut all[..size]
    }

    /// Gives the budget for the calls up to the next refill.
    pub(super) fn refuel(&mut self, fuel: u64) {
        // Fails only if the engine does not count fuel, and this one does.
        let counted = self.store.set_fuel(fuel);
        debug_assert!(counted.is_ok(), "the engine counts fuel");
    }

    pub(super) fn parts(&self, entry: usize) -> usize {
        self.entries.get(entry).map_or(0, Vec::len)
    }

    pub(super) fn run(&mut self, entry: usize, part: usize) -> Result<(), Trapped> {
        let Some(function) = self.entries.get(entry).and_then(|parts| parts.get(part)) else {
            return Ok(());
        };
        function.call(&mut self.store, ()).map_err(|error| trapped(&error))
    }
}

fn entry(
    instance: &Instance,
    store: &mut Store<HostState>,
    index: usize,
    count: usize,
) -> Result<Vec<TypedFunc<(), ()>>, RunError> {
    let mut part = |part| instance.get_typed_func(&mut *store, &entry_export(index, part));
    (0..count).map(|at| part(at).map_err(|error| module_error(&error))).collect()
}

fn linker(engine: &Engine) -> Result<Linker<HostState>, wasmtime::Error> {
    let mut linker = Linker::new(engine);
    for import in &host::IMPORTS {
        let (module, name) = (host::MODULE, import.name);
        match import.function {
            host::Function::Single(function) => {
                linker.func_wrap(module, name, move |x: f32| canonical_single(function(x)))?
            }
            host::Function::Double(function) => {
                linker.func_wrap(module, name, move |x: f64| canonical_double(function(x)))?
            }
            host::Function::SinglePair(function) => {
                linker.func_wrap(module, name, move |x: f32, y: f32| canonical_single(function(x, y)))?
            }
            host::Function::DoublePair(function) => {
                linker.func_wrap(module, name, move |x: f64, y: f64| canonical_double(function(x, y)))?
            }
        };
    }
    link(&mut linker)?;
    Ok(linker)
}

/// A NaN's bits would depend on the machine.
fn canonical_single(value: f32) -> f32 {
    if value.is_nan() { f32::from_bits(0x7fc0_0000) } else { value }
}

fn canonical_double(value: f64) -> f64 {
    if value.is_nan() { f64::from_bits(0x7ff8_0000_0000_0000) } else { value }
}

fn trapped(error: &wasmtime::Error) -> Trapped {
    let backtrace = error.downcast_ref::<WasmBacktrace>();
    let frames = backtrace.map(WasmBacktrace::frames).unwrap_or_default().iter();
    let frames = frames.map(|frame| (frame.func_index(), frame.func_offset().map(|offset| offset as u32)));
    Trapped { trap: error.downcast_ref::<Trap>().copied(), frames: frames.collect() }
}
