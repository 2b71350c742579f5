//! Sections, functions and exports of the module.

use std::collections::BTreeMap;

use wasm_encoder::{
    CodeSection, DataCountSection, DataSection, EntityType, ExportKind, ExportSection, Function, FunctionSection,
    ImportSection, MemorySection, MemoryType, Module, TypeSection, ValType,
};

use super::emitter::{Shared, value_type};
use super::fault::{FaultTable, FunctionMarks};
use super::{dispatch, entry, function, host, text_host};
use crate::check::Checked;
use crate::ir::{Pou, TypeTable};

/// Name of the exported memory.
pub(crate) const MEMORY_EXPORT: &str = "memory";

const PAGE: u64 = 65_536;

/// Name of the export that runs a part of the entry at this position.
pub(crate) fn entry_export(index: usize, part: usize) -> String {
    format!("entry_{index}_{part}")
}

/// The module and what its instructions stand for.
#[derive(Debug)]
pub(crate) struct Compiled {
    pub(crate) wasm: Vec<u8>,
    pub(crate) faults: FaultTable,
}

/// Compiles what has been checked without errors.
pub(crate) fn compile(checked: &Checked) -> Compiled {
    let first_function = (host::IMPORTS.len() + text_host::IMPORTS.len()) as u32;
    let order = checked.pous.keys().zip(first_function..);
    let functions: BTreeMap<_, _> = order.map(|(id, index)| (*id, index)).collect();
    let mut sections = Sections::default();
    sections.add_imports();
    let rows = dispatch::place_rows(&checked.rows, |parameters, results| sections.add_type(parameters, results));
    let (types, areas, memory_size) = (&checked.types, checked.areas, checked.image.len() as u32);
    let mut shared = Shared { types, functions, rows, areas, memory_size, data: Vec::new() };
    let mut faults = FaultTable { first_function, functions: Vec::new() };
    for pou in checked.pous.values() {
        let (parameters, results) = signature(pou, &checked.types);
        let (body, marks) = function::unit(&mut shared, pou);
        sections.add_function(parameters, results, &body);
        faults.functions.push(FunctionMarks { name: pou.name.clone(), is_entry: false, marks });
    }
    for (index, entry) in checked.entries.iter().enumerate() {
        for (part, unit) in entry.units.iter().enumerate() {
            let (body, marks) = entry::function(&mut shared, unit);
            let at = sections.add_function(Vec::new(), Vec::new(), &body);
            sections.exports.export(&entry_export(index, part), ExportKind::Func, at);
            faults.functions.push(marks);
        }
    }
    Compiled { wasm: sections.finish(checked, &shared), faults }
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

    /// Adds a function and gives its index.
    fn add_function(&mut self, parameters: Vec<ValType>, results: Vec<ValType>, body: &Function) -> u32 {
        let ty = self.add_type(parameters, results);
        self.functions.function(ty);
        self.code.function(body);
        self.imports.len() + self.functions.len() - 1
    }

    fn finish(mut self, checked: &Checked, shared: &Shared<'_>) -> Vec<u8> {
        let pages = (checked.image.len() as u64).div_ceil(PAGE);
        let mut memories = MemorySection::new();
        memories.memory(MemoryType {
            minimum: pages,
            maximum: Some(pages),
            memory64: false,
            shared: false,
            page_size_log2: None,
        });
        self.exports.export(MEMORY_EXPORT, ExportKind::Memory, 0);
        let mut data = DataSection::new();
        for bytes in &shared.data {
            data.passive(bytes.iter().copied());
        }
        let mut module = Module::new();
        module.section(&self.types).section(&self.imports).section(&self.functions);
        if checked.rows.is_empty() {
            module.section(&memories).section(&self.exports);
        } else {
            let (table, elements) = dispatch::table(&checked.rows, shared);
            module.section(&table).section(&memories).section(&self.exports).section(&elements);
        }
        module.section(&DataCountSection { count: data.len() });
        module.section(&self.code).section(&data);
        module.finish()
    }
}
