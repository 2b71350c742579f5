//! The programs of a task in a row, as one call.
//!
//! A call from the host into the module costs more than many a program. A small module of its own, made for a plan of
//! tasks, has a function a task, which calls in their order what the task runs.

use wasm_encoder::{
    CodeSection, EntityType, ExportKind, ExportSection, Function, FunctionSection, ImportSection, Instruction, Module,
    NameSection, TypeSection,
};
use wasmtime::{Extern, Instance, Store, TypedFunc};

/// The module's name, by which its functions are known where a fault's way is told.
pub(super) const NAME: &str = "rows";

/// Where all imports are.
const IMPORTS: &str = "entries";

/// For each task a function that runs its `functions`, nothing for a task without any.
///
/// # Errors
/// What wasmtime says; there is no reason why it should.
pub(super) fn link<T: 'static>(
    store: &mut Store<T>,
    tasks: &[Vec<TypedFunc<(), ()>>],
) -> Result<Vec<Option<TypedFunc<(), ()>>>, wasmtime::Error> {
    if tasks.iter().all(|functions| functions.len() < 2) {
        return Ok(tasks.iter().map(|functions| functions.first().cloned()).collect());
    }
    let module = wasmtime::Module::new(store.engine(), module(tasks))?;
    let imports: Vec<Extern> = tasks.iter().flatten().map(|function| Extern::from(*function.func())).collect();
    let instance = Instance::new(&mut *store, &module, &imports)?;
    let row = |task: usize| instance.get_typed_func(&mut *store, &export(task)).map(Some);
    (0..tasks.len()).map(row).collect()
}

fn export(task: usize) -> String {
    format!("task_{task}")
}

fn module(tasks: &[Vec<TypedFunc<(), ()>>]) -> Vec<u8> {
    let mut types = TypeSection::new();
    types.ty().function([], []);
    let mut imports = ImportSection::new();
    for _ in tasks.iter().flatten() {
        imports.import(IMPORTS, "", EntityType::Function(0));
    }
    let (mut functions, mut exports, mut code) = (FunctionSection::new(), ExportSection::new(), CodeSection::new());
    let mut next = 0;
    for (task, row) in tasks.iter().enumerate() {
        let mut body = Function::new([]);
        for _ in row {
            body.instruction(&Instruction::Call(next));
            next += 1;
        }
        body.instruction(&Instruction::End);
        code.function(&body);
        exports.export(&export(task), ExportKind::Func, imports.len() + functions.len());
        functions.function(0);
    }
    debug_assert_eq!(next, imports.len(), "what a task runs is imported once, and called once");
    let mut names = NameSection::new();
    names.module(NAME);
    let mut module = Module::new();
    module.section(&types).section(&imports).section(&functions).section(&exports).section(&code).section(&names);
    module.finish()
}
