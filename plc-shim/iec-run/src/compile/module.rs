//! Sections, functions and exports of the module.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use wasm_encoder::{
    BranchHint, BranchHints, CodeSection, DataCountSection, DataSection, EntityType, ExportKind, ExportSection,
    Function, FunctionSection, ImportSection, MemorySection, MemoryType, Module, TypeSection, ValType,
};

use super::analyse::Program;
use super::emit::{self, Made, Shared, value_type};
use super::fault::{FaultTable, FunctionMarks};
use super::points::{NOTES_MEMORY, Point, Points};
use super::{host, text_host, trace, tried};
use onescan_iec::check::{CALL_DEPTH_OFFSET, Checked};
use onescan_iec::ir::{Guard, Pou, PouId, TypeTable};
use onescan_iec::syntax::FileId;

/// Name of the export of the PLC's memory.
pub(crate) const MEMORY_EXPORT: &str = "memory";
/// Name of the export of the memory that execution is noted in, of a module that notes it.
pub(crate) const NOTES_EXPORT: &str = "notes";

/// Name of the export of the global that holds the budget of instructions.
pub(crate) const BUDGET_EXPORT: &str = "budget";

const PAGE: u64 = 65_536;

/// Name of the export that runs a part of the entry at this position.
pub(crate) fn entry_export(index: usize, part: usize) -> String {
    format!("entry_{index}_{part}")
}

/// Name of the export that runs before the first scan.
pub(crate) const START_EXPORT: &str = "start";
/// Name of the export that runs before another start.
pub(crate) const END_EXPORT: &str = "end";

/// The module and what its instructions stand for.
#[derive(Debug)]
pub(crate) struct Compiled {
    pub(crate) wasm: Vec<u8>,
    pub(crate) faults: FaultTable,
    /// Memory that says which units run, by offset and size: as before once a fault has ended statements.
    pub(crate) guards: Vec<Range<u32>>,
    /// What is noted while it runs.
    pub(crate) points: Vec<Point>,
}

/// What the program notes of its execution.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Noted<'l> {
    Nothing,
    /// All that is not in these files.
    AllBut(&'l BTreeSet<FileId>),
    /// Statements that are not in these files report to the host that they run.
    Traced(&'l BTreeSet<FileId>),
}

/// Compiles what has been checked without errors.
///
/// Types, imports and functions are numbered in the order in which they are added, and code refers to them by number:
/// 1. the host's functions, which are known beforehand;
/// 2. the signatures of the rows of methods, which calls name;
/// 3. the units, in the order of their ids: their numbers are given out before any is compiled, as one calls the
///    other;
/// 4. what tasks run, then what runs at the start and the end, which nothing calls;
/// 5. statements that a fault ends, which the host calls by their numbers.
///
/// [`Sections::finish`] puts the sections into the order that WebAssembly prescribes.
pub(crate) fn compile(checked: &Checked, noted: Noted<'_>) -> Compiled {
    let mut sections = Sections::default();
    sections.add_imports();
    if matches!(noted, Noted::Traced(_)) {
        sections.add_trace_imports();
    }
    let first_function = sections.imports.len();
    let traced = if matches!(noted, Noted::Traced(_)) { trace::IMPORTS.len() } else { 0 };
    debug_assert_eq!(
        first_function as usize,
        tried::index() as usize + 1 + traced,
        "calls of the host name its functions by these numbers"
    );
    debug_assert!(u32::try_from(checked.image.len()).is_ok(), "memory is addressed with 32 bits");
    let functions = checked.pous.keys().copied().zip(first_function..).collect();
    let rows = emit::place_rows(&checked.rows, |parameters, results| sections.add_type(parameters, results));
    let points = match noted {
        Noted::Nothing => None,
        Noted::Traced(library) => Some(Points::traced(library)),
        Noted::AllBut(library) => Some(Points::new(library)),
    };
    let (program, order) = Program::new(&checked.types, &checked.pous, checked.areas, points.is_some());
    let mut shared = Shared::new(program, functions, rows, checked.image.len() as u32, points);
    let mut faults = FaultTable { first_function, functions: Vec::new() };
    sections.add_units(checked, order, &mut shared, &mut faults);
    sections.add_entries(checked, &mut shared, &mut faults);
    sections.add_tries(&mut shared, &mut faults);
    debug_assert_eq!(
        faults.functions.len(),
        sections.functions.len() as usize,
        "the marks of a function are found by its number"
    );
    let points = shared.points().map_or(0, Points::bytes);
    let wasm = sections.finish(checked, points, &shared, &hints(&faults));
    Compiled {
        wasm,
        faults,
        guards: guards(checked),
        points: shared.into_points().map_or_else(Vec::new, Points::into_list),
    }
}

/// Where it stands which units run, of those that a call may come back to.
fn guards(checked: &Checked) -> Vec<Range<u32>> {
    let flags = checked.pous.values().filter_map(|pou| match pou.guard {
        Guard::Once(flag) => Some(flag..flag + 1),
        Guard::Depth | Guard::None => None,
    });
    let depth = CALL_DEPTH_OFFSET..CALL_DEPTH_OFFSET + 4;
    std::iter::once(depth).chain(flags).collect()
}

/// Which branches are taken as a rule.
fn hints(faults: &FaultTable) -> BranchHints {
    let mut hints = BranchHints::new();
    for (index, function) in (faults.first_function..).zip(&faults.functions) {
        let likely = function.likely().map(|at| BranchHint { branch_func_offset: at, branch_hint_value: 1 });
        let likely: Vec<_> = likely.collect();
        if !likely.is_empty() {
            hints.function_hints(index, likely);
        }
    }
    hints
}

/// A memory of a fixed size that has room for so many bytes.
fn memory_of(bytes: usize) -> MemoryType {
    let pages = (bytes as u64).div_ceil(PAGE);
    debug_assert!(pages <= PAGE, "a memory of 32 bits has 65,536 pages at most");
    MemoryType { minimum: pages, maximum: Some(pages), memory64: false, shared: false, page_size_log2: None }
}

fn signature(pou: &Pou, types: &TypeTable) -> (Vec<ValType>, Vec<ValType>) {
    let parameters = pou.registers.iter().take(pou.parameters as usize);
    let parameters = parameters.map(|ty| value_type(*ty)).collect();
    let result = pou.result.as_ref();
    // An aggregate result is given by its address.
    let result = result.map(|place| types.elementary(place.ty).map_or(ValType::I32, value_type));
    (parameters, result.into_iter().collect())
}

#[derive(Default)]
struct Sections {
    types: TypeSection,
    imports: ImportSection,
    functions: FunctionSection,
    exports: ExportSection,
    code: CodeSection,
}

impl Sections {
    fn add_type(&mut self, parameters: Vec<ValType>, results: Vec<ValType>) -> u32 {
        let index = self.types.len();
        self.types.ty().function(parameters, results);
        index
    }

    fn add_imports(&mut self) {
        for import in &host::IMPORTS {
            let (value, count) = match import.function {
                host::Function::Single(_) => (ValType::F32, 1),
                host::Function::Double(_) => (ValType::F64, 1),
                host::Function::SinglePair(_) => (ValType::F32, 2),
                host::Function::DoublePair(_) => (ValType::F64, 2),
            };
            let ty = self.add_type(vec![value; count], vec![value]);
            self.imports.import(host::MODULE, import.name, EntityType::Function(ty));
        }
        for import in text_host::IMPORTS {
            let (parameters, result) = import.signature();
            let ty = self.add_type(parameters, vec![result]);
            self.imports.import(text_host::MODULE, import.name(), EntityType::Function(ty));
        }
        let (parameters, results) = tried::signature();
        let ty = self.add_type(parameters, results);
        self.imports.import(tried::MODULE, tried::RUN, EntityType::Function(ty));
    }

    fn add_trace_imports(&mut self) {
        for (name, count) in trace::IMPORTS {
            let ty = self.add_type(trace::parameters(count), Vec::new());
            self.imports.import(trace::MODULE, name, EntityType::Function(ty));
        }
    }

    /// Adds a function and gives its index.
    fn add_function(&mut self, parameters: Vec<ValType>, results: Vec<ValType>, body: &Function) -> u32 {
        let ty = self.add_type(parameters, results);
        self.functions.function(ty);
        self.code.function(body);
        debug_assert_eq!(self.functions.len(), self.code.len(), "every function that is declared has its body");
        self.imports.len() + self.functions.len() - 1
    }

    /// Compiles the units in this `order`, callees first, as a call must know what it costs; adds them in that of their
    /// ids, by which they are numbered.
    fn add_units(&mut self, checked: &Checked, order: Vec<PouId>, shared: &mut Shared<'_>, faults: &mut FaultTable) {
        let instances = emit::only_instances(checked);
        let mut made: BTreeMap<PouId, Made> = BTreeMap::new();
        for id in order {
            if let Some(pou) = checked.pous.get(&id) {
                made.insert(id, emit::unit(shared, id, pou, instances.get(&id).copied()));
            }
        }
        debug_assert_eq!(made.len(), checked.pous.len(), "every unit has its place in the order");
        debug_assert!(made.keys().eq(checked.pous.keys()), "units are numbered in the order of their ids");
        for (pou, Made { body, marks, units }) in checked.pous.values().zip(made.into_values()) {
            let (parameters, results) = signature(pou, &checked.types);
            self.add_function(parameters, results, &body);
            faults.functions.push(FunctionMarks { units, is_entry: false, marks });
        }
    }

    /// What tasks run, what runs before the first scan, and what before another start.
    fn add_entries(&mut self, checked: &Checked, shared: &mut Shared<'_>, faults: &mut FaultTable) {
        for (index, entry) in checked.entries.iter().enumerate() {
            for (part, unit) in entry.units.iter().enumerate() {
                let (body, marks) = emit::entry_function(shared, unit, true);
                self.add_export(&entry_export(index, part), &body);
                faults.functions.push(marks);
            }
        }
        for (unit, export) in [(&checked.start, START_EXPORT), (&checked.end, END_EXPORT)] {
            if let Some(unit) = unit {
                let (body, marks) = emit::entry_function(shared, unit, false);
                self.add_export(export, &body);
                faults.functions.push(marks);
            }
        }
    }

    /// Statements that a fault ends, by the numbers that they have been given.
    fn add_tries(&mut self, shared: &mut Shared<'_>, faults: &mut FaultTable) {
        for (number, Made { body, marks, units }) in (0..).zip(shared.take_tries()) {
            let at = self.add_function(Vec::new(), vec![ValType::I32], &body);
            self.exports.export(&tried::export(number), ExportKind::Func, at);
            faults.functions.push(FunctionMarks { units, is_entry: false, marks });
        }
    }

    /// A function without parameters for the host to call.
    fn add_export(&mut self, name: &str, body: &Function) {
        let at = self.add_function(Vec::new(), Vec::new(), body);
        self.exports.export(name, ExportKind::Func, at);
    }

    /// `noted` bytes, for what is noted while the program runs, lie in a memory of their own.
    fn finish(mut self, checked: &Checked, noted: usize, shared: &Shared<'_>, hints: &BranchHints) -> Vec<u8> {
        let mut memories = MemorySection::new();
        memories.memory(memory_of(checked.image.len()));
        self.exports.export(MEMORY_EXPORT, ExportKind::Memory, 0);
        if noted > 0 {
            memories.memory(memory_of(noted));
            self.exports.export(NOTES_EXPORT, ExportKind::Memory, NOTES_MEMORY);
        }
        self.exports.export(BUDGET_EXPORT, ExportKind::Global, 0);
        let mut data = DataSection::new();
        for bytes in shared.data() {
            data.passive(bytes.iter().copied());
        }
        // Of the sections that WebAssembly has, in its order (core specification 2.0, 5.5.2): type, import, function,
        // table, memory, global, export, element, data count, code, data; the hints are a custom section that must
        // stand before the code.
        let mut module = Module::new();
        module.section(&self.types).section(&self.imports).section(&self.functions);
        if checked.rows.is_empty() {
            module.section(&memories).section(&emit::globals(shared)).section(&self.exports);
        } else {
            let (table, elements) = emit::table(&checked.rows, shared);
            module.section(&table).section(&memories).section(&emit::globals(shared));
            module.section(&self.exports).section(&elements);
        }
        module.section(&DataCountSection { count: data.len() });
        module.section(hints);
        module.section(&self.code).section(&data);
        module.finish()
    }
}
