//! What the files declare, by name, and what is known of it: the room that bodies ask.
//!
//! [`Declarations`] is the whole interface. Nothing here knows an expression: what takes one to resolve is left to the
//! [`Resolve`] that the declarations are made with.

pub(in crate::check) mod calls;
pub(in crate::check) mod chart;
pub(in crate::check) mod class;
pub(in crate::check) mod demand;
pub(in crate::check) mod entry;
pub(in crate::check) mod findings;
pub(in crate::check) mod global;
pub(in crate::check) mod hook;
pub(in crate::check) mod inheritance;
pub(in crate::check) mod kept;
pub(in crate::check) mod layout;
pub(in crate::check) mod located;
pub(in crate::check) mod names;
pub(in crate::check) mod namespace;
pub(in crate::check) mod query;
pub(in crate::check) mod recursion;
pub(in crate::check) mod scope;
pub(in crate::check) mod start;
pub(in crate::check) mod variable;
pub(in crate::check) mod vendor_parameter;
pub(in crate::check) mod visibility;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use self::calls::Calls;
use self::class::Class;
use self::demand::Resolve;
use self::entry::{Enumerator, GlobalEntry, PouEntry, TypeEntry, provided};
use self::findings::Findings;
use self::global::Alternatives;
use self::layout::{INIT_RETAINS_NAME, INIT_RETAINS_OFFSET, Memory, VIRTUAL_TIME_NAME, VIRTUAL_TIME_OFFSET};
use self::located::Initial;
use self::namespace::Home;
use self::start::{Stages, Started};
use crate::check::types::generic::Generic;
use crate::dialect::{AddressUnit, Dialect};
use crate::ir::{Areas, ElementaryType, PouId, Program, TypeId, TypeTable};
use crate::syntax::{FileId, Span, ast};

/// Greatest number of types, constants or instances that need each other in a row.
const MAX_DEPTH: u32 = 64;

/// What is known so far.
pub(in crate::check) struct Declarations<'a> {
    resolver: &'static dyn Resolve,
    library: &'a BTreeSet<FileId>,
    stages: &'a Stages,
    /// What is done at a start outside of units.
    started: Vec<Started<'a>>,
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
    memory: Memory,
    areas: Areas,
    address_unit: AddressUnit,
    /// Initial values of what is located.
    located: Vec<Initial>,
    programs: Vec<Program>,
    configuration: Option<&'a ast::Configuration>,
    /// Globals that several resources have under one name.
    alternatives: BTreeMap<String, Alternatives>,
    /// Where units use globals, if resources have some of their own.
    global_uses: Vec<(PouId, String, Span)>,
    calls: Calls,
    /// What inputs of generic types are inside of their units.
    generics: BTreeMap<TypeId, Generic>,
    depth: u32,
    chart_parts: Vec<(Span, String)>,
    findings: Findings,
}

impl<'a> Declarations<'a> {
    pub(in crate::check) fn is_library(&self, id: PouId) -> bool {
        self.library.contains(&self.pou(id).ast.name.span.file)
    }

    pub(in crate::check) fn pou(&self, id: PouId) -> &PouEntry<'a> {
        // Ids are made by `collect` only, one for each entry.
        &self.pous[id.0 as usize]
    }
}

impl<'a> Declarations<'a> {
    pub(in crate::check) fn new(
        library: &'a BTreeSet<FileId>,
        stages: &'a Stages,
        resolver: &'static dyn Resolve,
    ) -> Self {
        Self {
            resolver,
            library,
            stages,
            started: Vec::new(),
            dialects: BTreeMap::new(),
            types: TypeTable::new(),
            type_names: BTreeMap::new(),
            pous: Vec::new(),
            pou_names: BTreeMap::new(),
            home: Arc::default(),
            namespaces: BTreeMap::new(),
            open_globals: BTreeMap::new(),
            classes: BTreeMap::new(),
            method_names: BTreeSet::new(),
            property_names: BTreeSet::new(),
            generics: BTreeMap::new(),
            globals: BTreeMap::from([
                (VIRTUAL_TIME_NAME.to_owned(), provided(VIRTUAL_TIME_NAME, ElementaryType::Time, VIRTUAL_TIME_OFFSET)),
                (INIT_RETAINS_NAME.to_owned(), provided(INIT_RETAINS_NAME, ElementaryType::Bool, INIT_RETAINS_OFFSET)),
            ]),
            enumerators: BTreeMap::new(),
            memory: Memory::default(),
            areas: Areas::default(),
            address_unit: AddressUnit::default(),
            located: Vec::new(),
            programs: Vec::new(),
            configuration: None,
            alternatives: BTreeMap::new(),
            global_uses: Vec::new(),
            calls: Calls::default(),
            depth: 0,
            chart_parts: Vec::new(),
            findings: Findings::default(),
        }
    }
}

impl Declarations<'_> {
    /// The dialect of the text at `span`.
    pub(in crate::check) fn dialect(&self, span: Span) -> Dialect {
        self.dialects.get(&span.file).copied().unwrap_or_default()
    }
}
