//! Names, types, constants and calls: from syntax trees to the checked program.

pub(crate) mod asserts;
pub(in crate::check) mod body;
pub(in crate::check) mod configuration;
pub(in crate::check) mod declare;
pub(in crate::check) mod resolve;
pub(in crate::check) mod standard;
pub(in crate::check) mod types;

use std::collections::{BTreeMap, BTreeSet};

use self::declare::declarations::Checker;
use self::declare::start::{self, Occasion};
use crate::diagnostic::Diagnostic;
use crate::dialect::AddressUnit;
use crate::ir::{Areas, Configuration, Entry, Pou, PouId, Program, Row, TypeTable, Variable};
use crate::syntax::ast::CompilationUnit;
use crate::syntax::{FileId, Span};

pub(crate) use self::declare::kept::Kept;
pub(crate) use self::declare::layout::{
    CALL_DEPTH_OFFSET, INIT_RETAINS_OFFSET, VIRTUAL_TIME_NAME, VIRTUAL_TIME_OFFSET,
};
pub(crate) use self::standard::exists as is_standard_function;

/// The checked program.
#[derive(Debug)]
pub(crate) struct Checked {
    pub(crate) types: TypeTable,
    /// The units that run; others have no entry.
    pub(crate) pous: BTreeMap<PouId, Pou>,
    /// The variables of every unit that has been declared, whether it runs or not.
    pub(crate) interfaces: BTreeMap<PouId, Vec<Variable>>,
    /// What methods of units keep in the instance.
    pub(crate) kept: BTreeMap<PouId, Vec<Kept>>,
    /// The global variables that belong to no resource.
    pub(crate) globals: Vec<Variable>,
    pub(crate) programs: Vec<Program>,
    /// What the types run when a method is called that is not known before.
    pub(crate) rows: Vec<Row>,
    /// Where direct addresses lie.
    pub(crate) areas: Areas,
    /// What the numbers of direct addresses count.
    pub(crate) address_unit: AddressUnit,
    pub(crate) configuration: Option<Configuration>,
    /// What tasks can run; those of the programs first.
    pub(crate) entries: Vec<Entry>,
    /// What runs before the first scan after a start, if anything does.
    pub(crate) start: Option<Pou>,
    /// What runs before another start.
    pub(crate) end: Option<Pou>,
    /// The whole memory at a cold start, before `start` runs.
    pub(crate) image: Vec<u8>,
    /// The steps and transitions of charts: where they stand, and what they are called.
    pub(crate) chart_parts: Vec<(Span, String)>,
}

/// Checks all units together. `library` tells the files of the standard function blocks, whose
/// units are compiled only if they are used.
pub(crate) fn check(units: &[(FileId, &CompilationUnit)], library: &BTreeSet<FileId>) -> (Checked, Vec<Diagnostic>) {
    let stages = start::stages(units);
    let mut checker = Checker::new(library, &stages);
    checker.collect(units);
    checker.link_classes();
    checker.resolve_declarations();
    checker.check_inheritance();
    checker.configure();
    checker.enqueue_stages();
    let (start, end) = (checker.occasion(Occasion::Start), checker.occasion(Occasion::End));
    checker.check_bodies();
    checker.report_recursion();
    checker.guard_circles();
    checker.place_areas();
    checker.check_configuration();
    let image = checker.memory_image();
    let globals = checker.shared_globals();
    let (configuration, entries) = checker.take_configuration();
    let interfaces = checker
        .pous
        .iter()
        .enumerate()
        .filter_map(|(index, entry)| Some((PouId(index as u32), entry.scope.as_ref()?.variables.clone())));
    let result = Checked {
        interfaces: interfaces.collect(),
        kept: checker.kept_by_methods(),
        types: checker.types,
        pous: checker.checked,
        globals,
        programs: checker.programs,
        rows: checker.rows.into_list(),
        areas: checker.areas,
        address_unit: checker.address_unit,
        configuration,
        entries,
        start,
        end,
        image,
        chart_parts: checker.chart_parts,
    };
    (result, checker.diagnostics)
}

impl<'a> Checker<'a> {
    pub(in crate::check) fn check_bodies(&mut self) {
        while let Some(id) = self.queue.pop() {
            self.check_body(id);
        }
    }
}
