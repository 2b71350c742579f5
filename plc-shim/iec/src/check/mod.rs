//! Names, types, constants and calls: from syntax trees to the checked program.
//!
//! | room | subject | asks |
//! |---|---|---|
//! | [`types`] | rules on types and values: constants, operands, what converts to what | |
//! | [`standard`] | standard functions and those of vendors, by what their names say | |
//! | [`asserts`] | where asserts stand | |
//! | [`declare`] | what the files declare: names, namespaces, classes, scopes, memory, who calls whom | `types`, `standard` |
//! | [`body`] | expressions and statements inside of a scope, the bodies of units | `declare` and what it asks |
//! | [`resolve`] | declarations as written to types, initial values, placed variables | `body` and what it asks |
//! | [`configuration`] | resources, tasks, instances of programs, what a start does | all of them |
//!
//! A unit, type or global variable is resolved when it is first needed; what is being resolved
//! and needed again contains itself. Bodies need declarations, and declarations constant expressions: so
//! `declare` has a trait, [`Resolve`](declare::Resolve), for what takes an expression, and `resolve`, which stands
//! above bodies, implements it. A test of the workspace (`house`) reads these arrows from the sources.

pub mod asserts;
mod body;
mod configuration;
mod declare;
mod resolve;
mod standard;
mod types;

use std::collections::{BTreeMap, BTreeSet};

use self::body::check_unit;
use self::configuration::{Configured, Configurer};
use self::declare::{Declarations, Outcome, Templates, stages};
use self::resolve::Resolver;
use crate::diagnostic::Diagnostic;
use crate::dialect::AddressUnit;
use crate::ir::{Areas, Configuration, Entry, Expr, MemoryLimit, Pou, PouId, Program, Row, TypeTable, Value, Variable};
use crate::syntax::ast::CompilationUnit;
use crate::syntax::{FileId, Span};

pub use self::declare::{
    CALL_DEPTH_OFFSET, INIT_RETAINS_OFFSET, Kept, Overrides, VIRTUAL_TIME_NAME, VIRTUAL_TIME_OFFSET, find_key,
    is_library_name, is_list, joined, short_inside,
};
pub use self::standard::vendor::{is_qualified_only, of_pointer_width};
pub use self::standard::{exists as is_standard_function, is_known as knows_function};
pub use self::types::number::as_number;

#[derive(Debug)]
pub struct Checked {
    pub types: TypeTable,
    /// The units that run; others have no entry.
    pub pous: BTreeMap<PouId, Pou>,
    /// The variables of every unit that has been declared, whether it runs or not.
    pub interfaces: BTreeMap<PouId, Vec<Variable>>,
    /// What methods of units keep in the instance.
    pub kept: BTreeMap<PouId, Vec<Kept>>,
    /// The global variables that belong to no resource.
    pub globals: Vec<Variable>,
    pub programs: Vec<Program>,
    /// What the types run when a method is called that is not known before.
    pub rows: Vec<Row>,
    /// Where direct addresses lie.
    pub areas: Areas,
    /// What the numbers of direct addresses count.
    pub address_unit: AddressUnit,
    pub configuration: Option<Configuration>,
    /// What tasks can run; those of the programs first.
    pub entries: Vec<Entry>,
    /// What runs before the first scan after a start, if anything does.
    pub start: Option<Pou>,
    /// What runs before another start.
    pub end: Option<Pou>,
    /// The whole memory at a cold start, before `start` runs.
    pub image: Vec<u8>,
    /// The steps and transitions of charts: where they stand, and what they are called.
    pub chart_parts: Vec<(Span, String)>,
    /// Where a standard timer is given an LTIME for its TIME (3rd ed. Table 46).
    pub long_durations: BTreeSet<Span>,
}

/// The value of an expression that is constant.
pub(crate) fn constant_value(types: &TypeTable, expr: &Expr) -> Option<Value> {
    types::constant::fold(types, expr).ok()
}

/// Checks all units together. `library` identifies the files of the standard function blocks, whose
/// units are compiled only if they are used. Constants named by `overrides` have the initial values that it gives. All variables
/// together take no more than `limit`.
pub fn check(
    units: &[(FileId, &CompilationUnit)],
    library: &BTreeSet<FileId>,
    overrides: &Overrides,
    limit: MemoryLimit,
) -> (Checked, Vec<Diagnostic>) {
    let stages = stages(units);
    let given = (overrides, limit);
    let templates = Templates::of(units, (library, &stages), given, &Resolver);
    let mut declarations = Declarations::new(library, (&stages, &templates), given, &Resolver);
    declarations.collect(units);
    templates.findings().iter().for_each(|found| declarations.report(found.clone()));
    declarations.link_classes();
    declarations.resolve_declarations();
    declarations.check_inheritance();
    let mut configured = Configured::default();
    let mut configurer = Configurer::new(&mut declarations, &mut configured);
    configurer.configure();
    declarations.enqueue_stages();
    let mut configurer = Configurer::new(&mut declarations, &mut configured);
    let (start, end) = (configurer.start(), configurer.end());
    let mut pous = BTreeMap::new();
    // Bodies name further units, which are queued.
    while let Some(id) = declarations.next_unit() {
        pous.extend(check_unit(&mut declarations, id).map(|unit| (id, unit)));
    }
    declarations.report_recursion();
    declarations.report_stubs();
    declarations.guard_circles(&mut pous);
    declarations.place_areas();
    let mut configurer = Configurer::new(&mut declarations, &mut configured);
    configurer.check(&pous);
    let (configuration, entries) = configurer.finish();
    declarations.explain_too_large();
    let (image, globals) = (declarations.memory_image(), declarations.shared_globals());
    let (interfaces, kept) = (declarations.interfaces(), declarations.kept_by_methods());
    let Outcome { types, programs, rows, areas, address_unit, chart_parts, long_durations, findings } =
        declarations.into_outcome();
    let checked = Checked {
        types,
        pous,
        interfaces,
        kept,
        globals,
        programs,
        rows,
        areas,
        address_unit,
        configuration,
        entries,
        start,
        end,
        image,
        chart_parts,
        long_durations,
    };
    (checked, findings)
}
