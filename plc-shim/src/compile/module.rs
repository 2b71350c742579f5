//! Sections, functions and exports of the module.

use std::collections::{BTreeMap, BTreeSet};

use wasm_encoder::{
    BranchHint, BranchHints, CodeSection, DataCountSection, DataSection, EntityType, ExportKind, ExportSection,
    Function, FunctionSection, ImportSection, MemorySection, MemoryType, Module, TypeSection, ValType,
};

use super::budget::{self, BUDGET_EXPORT};
use super::cost::Costs;
use super::emitter::{Shared, value_type};
use super::fault::{FaultTable, FunctionMarks};
use super::function::Made;
use super::points::{NOTES_MEMORY, Point, Points};
use super::{dispatch, entry, function, host, text_host, trace};
use crate::check::Checked;
use crate::ir::{Pou, PouId, TypeTable};
use crate::syntax::FileId;

/// Name of the export of the PLC's memory.
pub(crate) const MEMORY_EXPORT: &str = "memory";
/// Name of the export of the memory that execution is noted in, of a module that notes it.
pub(crate) const NOTES_EXPORT: &str = "notes";

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
    /// What is noted while it runs.
    pub(crate) points: Vec<Point>,
}

/// What the program notes of its execution.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Noted<'l> {
    Nothing,
    /// All that is not in these files.
    AllBut(&'l BTreeSet<FileId>),
    /// Statements that are not in these files tell the host that they run.
    Traced(&'l BTreeSet<FileId>),
}

/// Compiles what has been checked without errors.
pub(crate) fn compile(checked: &Checked, noted: Noted<'_>) -> Compiled {
    let traced = matches!(noted, Noted::Traced(_));
    let tracing = if traced { trace::IMPORTS.len() } else { 0 };
    let first_function = (host::IMPORTS.len() + text_host::IMPORTS.len() + tracing) as u32;
    let order = checked.pous.keys().zip(first_function..);
    let functions: BTreeMap<_, _> = order.map(|(id, index)| (*id, index)).collect();
    let mut sections = Sections::default();
    sections.add_imports();
    if traced {
        sections.add_trace_imports();
    }
    let rows = dispatch::place_rows(&checked.rows, |parameters, results| sections.add_type(parameters, results));
    let (costs, order) = Costs::new(&checked.pous);
    let points = match noted {
        Noted::Nothing => None,
        Noted::Traced(library) => Some(Points::traced(library)),
        Noted::AllBut(library) => Some(Points::new(library)),
    };
    let mut shared = Shared {
        points,
        types: &checked.types,
        pous: &checked.pous,
        costs,
        functions,
        rows,
        areas: checked.areas,
        memory_size: checked.image.len() as u32,
        data: Vec::new(),
    };
    let instances = entry::only_instances(checked);
    // Callees first: a call must know what it costs.
    let mut made: BTreeMap<PouId, Made> = BTreeMap::new();
    for id in order {
        if let Some(pou) = checked.pous.get(&id) {
            made.insert(id, function::unit(&mut shared, id, pou, instances.get(&id).copied()));
        }
    }
    let mut faults = FaultTable { first_function, functions: Vec::new() };
    for (pou, Made { body, marks, units }) in checked.pous.values().zip(made.into_values()) {
        let (parameters, results) = signature(pou, &checked.types);
        sections.add_function(parameters, results, &body);
        faults.functions.push(FunctionMarks { units, is_entry: false, marks });
    }
    for (index, entry) in checked.entries.iter().enumerate() {
        for (part, unit) in entry.units.iter().enumerate() {
            let (body, marks) = entry::function(&mut shared, unit, true);
            let at = sections.add_function(Vec::new(), Vec::new(), &body);
            sections.exports.export(&entry_export(index, part), ExportKind::Func, at);
            faults.functions.push(marks);
        }
    }
    for (unit, export) in [(&checked.start, START_EXPORT), (&checked.end, END_EXPORT)] {
        if let Some(unit) = unit {
            let (body, marks) = entry::function(&mut shared, unit, false);
            let at = sections.add_function(Vec::new(), Vec::new(), &body);
            sections.exports.export(export, ExportKind::Func, at);
            faults.functions.push(marks);
        }
    }
    let points = shared.points.as_ref().map_or(0, Points::bytes);
    let wasm = sections.finish(checked, points, &shared, &hints(&faults));
    Compiled { wasm, faults, points: shared.points.map(Points::into_list).unwrap_or_default() }
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
        self.imports.len() + self.functions.len() - 1
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
        for bytes in &shared.data {
            data.passive(bytes.iter().copied());
        }
        let mut module = Module::new();
        module.section(&self.types).section(&self.imports).section(&self.functions);
        if checked.rows.is_empty() {
            module.section(&memories).section(&budget::globals()).section(&self.exports);
        } else {
            let (table, elements) = dispatch::table(&checked.rows, shared);
            module.section(&table).section(&memories).section(&budget::globals());
            module.section(&self.exports).section(&elements);
        }
        module.section(&DataCountSection { count: data.len() });
        module.section(hints);
        module.section(&self.code).section(&data);
        module.finish()
    }
}
