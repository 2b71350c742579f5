//! Names, types, constants and calls: from syntax trees to the checked program.
//!
//! | module | subject |
//! |---|---|
//! | [`names`] | what the files declare, by name |
//! | [`layout`] | offsets in memory |
//! | [`scope`] | what a name means inside a unit |
//! | [`types`], [`subrange`], [`structure`], [`union`] | types as written to types |
//! | [`variables`], [`storage`], [`instance_section`] | sections to placed variables, units' interfaces |
//! | [`located`] | direct addresses to places |
//! | [`initial`] | initial values to bytes |
//! | [`start`], [`fb_init`], [`instance_arguments`] | what runs before the first scan |
//! | [`constant`] | constant expressions to values |
//! | [`convert`], [`enumeration`] | implicit conversions, constants in context |
//! | [`expression`], [`operator`], [`calendar`], [`dtl`], [`place`], [`part`] | expressions |
//! | [`reference`], [`address`], [`referred`] | references and pointers |
//! | [`open_array`] | arrays that come with their bounds |
//! | [`any_input`] | inputs of generic types |
//! | [`call`], [`argument`], [`instance_call`], [`standard_function`], [`vendor_parameter`], [`function_form`], [`conversion_function`], [`memory_function`] | calls |
//! | [`enable`], [`enable_error`] | EN and ENO |
//! | [`text`], [`character`], [`text_function`], [`text_conversion`] | character strings |
//! | [`statement`], [`assignment`], [`edge`], [`build`] | statements |
//! | [`chart`] | Sequential Function Charts |
//! | [`jump`], [`wire`], [`instruction`] | what networks and lists of instructions have beside statements |
//! | [`configuration`] | resources, tasks, instances of programs |
//! | [`dialect`] | what dialects do their own way |
//! | [`recursion`], [`dispatch`] | who calls whom, and what only a run decides |
//! | [`namespace`] | what a name means where it stands |
//! | [`class`], [`inheritance`] | bases, interfaces, members |
//! | [`instance`], [`method_call`], [`property`], [`interface_value`], [`query`] | `THIS`, methods, properties, interfaces |
//!
//! A unit, type or global variable is resolved when it is first needed; what is being resolved
//! and needed again contains itself.

mod address;
mod any_input;
mod argument;
pub(crate) mod asserts;
mod assignment;
mod build;
mod calendar;
mod call;
mod character;
mod chart;
mod class;
mod configuration;
mod constant;
mod conversion_function;
mod convert;
mod dialect;
mod dispatch;
mod dtl;
mod edge;
mod enable;
mod enable_error;
mod enumeration;
mod expression;
mod fb_init;
mod function_form;
mod inheritance;
mod initial;
mod instance;
mod instance_arguments;
mod instance_call;
mod instance_section;
mod instruction;
mod interface_value;
mod jump;
mod layout;
mod located;
mod memory_function;
mod method_call;
mod names;
mod namespace;
mod open_array;
mod operator;
mod part;
mod place;
mod property;
mod query;
mod recursion;
mod reference;
mod referred;
mod scope;
mod standard_function;
mod start;
mod statement;
mod storage;
mod structure;
mod subrange;
mod text;
mod text_conversion;
mod text_function;
mod types;
mod union;
mod variables;
mod vendor_parameter;
mod wire;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use self::class::Class;
use self::configuration::Configured;
use self::dispatch::Rows;
use self::layout::Layout;
use self::names::{Enumerator, GlobalEntry, PouEntry, TypeEntry};
use self::namespace::Home;
use self::start::{Occasion, Stages, Started};
use crate::diagnostic::Diagnostic;
use crate::dialect::AddressUnit;
use crate::dialect::Dialect;
use crate::ir::{Areas, Configuration, Entry, Pou, PouId, Program, Row, TypeId, TypeTable, Variable};
use crate::syntax::ast::CompilationUnit;
use crate::syntax::{FileId, Span};

pub(crate) use instance_section::Kept;
pub(crate) use layout::{CALL_DEPTH_OFFSET, INIT_RETAINS_OFFSET, VIRTUAL_TIME_NAME, VIRTUAL_TIME_OFFSET};
pub(crate) use standard_function::exists as is_standard_function;

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

/// What something written means: nothing if it is not of the kind asked for, else what it is, if it is right.
type Meant<T> = Option<Option<T>>;

/// Greatest number of types, constants or instances that need each other in a row.
const MAX_DEPTH: u32 = 64;

/// What is known so far.
struct Checker<'a> {
    library: &'a BTreeSet<FileId>,
    stages: &'a Stages,
    /// What is done at a start outside of units.
    started: Vec<Started<'a>>,
    /// Where something was wrong already, and when.
    faulty_starts: BTreeSet<(u32, u32, Occasion)>,
    /// Methods `FB_init` that do not suit those of their bases.
    faulty_hooks: BTreeSet<PouId>,
    dialects: BTreeMap<FileId, Dialect>,
    types: TypeTable,
    type_names: BTreeMap<String, TypeEntry<'a>>,
    pous: Vec<PouEntry<'a>>,
    pou_names: BTreeMap<String, PouId>,
    /// Where what is being resolved stands.
    home: Arc<Home>,
    /// Names of namespaces by their keys.
    namespaces: BTreeMap<String, String>,
    /// Full keys of global variables that are known without their list's name.
    open_globals: BTreeMap<String, String>,
    classes: BTreeMap<PouId, Class>,
    /// Names that a method or action has in some unit, and those of properties.
    method_names: BTreeSet<String>,
    property_names: BTreeSet<String>,
    globals: BTreeMap<String, GlobalEntry<'a>>,
    enumerators: BTreeMap<String, Vec<Enumerator>>,
    layout: Layout,
    areas: Areas,
    address_unit: AddressUnit,
    /// Initial values of what is located.
    located: Vec<located::Initial>,
    /// Offsets of string literals by type and bytes.
    literals: BTreeMap<(TypeId, std::sync::Arc<[u8]>), u32>,
    /// Initial bytes of what has been placed.
    placed: Vec<(u32, std::sync::Arc<[u8]>)>,
    programs: Vec<Program>,
    configured: Configured<'a>,
    checked: BTreeMap<PouId, Pou>,
    /// Units whose bodies are still to be checked, and all that ever were.
    queue: Vec<PouId>,
    queued: BTreeSet<PouId>,
    /// Who calls whom, and where.
    calls: BTreeMap<PouId, Vec<(PouId, Span)>>,
    /// Who may be called in ways that only a run decides.
    dynamic_calls: BTreeMap<PouId, BTreeSet<PouId>>,
    /// What inputs of generic types are inside of their units.
    generics: BTreeMap<TypeId, any_input::Generic>,
    rows: Rows,
    depth: u32,
    chart_parts: Vec<(Span, String)>,
    diagnostics: Vec<Diagnostic>,
}

impl<'a> Checker<'a> {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    fn resolve_declarations(&mut self) {
        let names: Vec<String> = self.type_names.keys().cloned().collect();
        for name in names {
            self.named_type(&name, None);
        }
        let names: Vec<String> = self.globals.keys().cloned().collect();
        for name in names {
            self.global(&name, None);
        }
        for index in 0..self.pous.len() {
            let id = PouId(index as u32);
            if !self.is_library(id) && self.stage_of(id).is_none() {
                self.declare(id, None);
                if !self.is_prototype(id) {
                    self.enqueue(id);
                }
            }
        }
    }

    fn is_library(&self, id: PouId) -> bool {
        self.library.contains(&self.pou(id).ast.name.span.file)
    }

    fn pou(&self, id: PouId) -> &PouEntry<'a> {
        // Ids are made by `collect` only, one for each entry.
        &self.pous[id.0 as usize]
    }

    /// Has the unit's body checked, once.
    fn enqueue(&mut self, id: PouId) {
        if self.queued.insert(id) {
            self.queue.push(id);
        }
    }

    fn check_bodies(&mut self) {
        while let Some(id) = self.queue.pop() {
            self.check_body(id);
        }
    }

    fn memory_image(&self) -> Vec<u8> {
        let mut image = vec![0; self.layout.size() as usize];
        for (offset, bytes) in &self.placed {
            let start = *offset as usize;
            if let Some(target) = image.get_mut(start..start + bytes.len()) {
                target.copy_from_slice(bytes);
            }
        }
        self.initialise_located(&mut image);
        image
    }
}
