//! What the files declare, by name, and what is known of it: the room that bodies ask.
//!
//! [`Declarations`] is the whole interface. Nothing here knows an expression: what takes one to resolve is left to the
//! [`Resolve`] that the declarations are made with.

mod calls;
pub(super) mod chart;
mod class;
mod demand;
mod entry;
mod findings;
mod global;
mod hook;
mod inheritance;
mod kept;
mod layout;
mod located;
mod names;
mod namespace;
mod numbered;
mod overload;
mod overrides;
mod program;
mod query;
mod recursion;
mod scope;
mod start;
mod stub;
mod template;
mod too_large;
mod unknown;
mod variable;
mod vendor_parameter;
mod visibility;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use self::calls::Calls;
use self::class::Class;
use self::entry::{GlobalEntry, PouEntry, TypeEntry, provided};
use self::findings::Findings;
use self::global::Alternatives;
use self::layout::Memory;
use self::located::Initial;
use self::namespace::OpenNames;
use self::overload::Overloads;
use self::start::Stages;
use self::stub::Stubs;
use crate::check::types::generic::Generic;
use crate::dialect::{AddressUnit, Dialect, WordSize};
use crate::ir::{Areas, ElementaryType, MemoryLimit, PouId, Program, TypeId, TypeTable};
use crate::syntax::{FileId, Span, ast};

pub(super) use self::class::{Membership, Occasion, Role};
pub(super) use self::demand::{Need, Resolve};
pub(super) use self::entry::{Declared, Enumerator, Rank, TypedImage};
pub(super) use self::hook::{EXIT_INPUTS, INIT_INPUTS, is_hook, is_init, suits_init};
pub use self::kept::Kept;
pub(super) use self::kept::place_of;
pub use self::layout::{CALL_DEPTH_OFFSET, INIT_RETAINS_OFFSET, VIRTUAL_TIME_NAME, VIRTUAL_TIME_OFFSET};
pub(super) use self::layout::{INIT_RETAINS_NAME, align_up};
pub(super) use self::located::Placement;
pub(super) use self::namespace::Home;
pub use self::namespace::{find_key, is_library_name, is_list, joined, short_inside};
pub(super) use self::numbered::Numbered;
pub use self::overrides::Overrides;
pub(super) use self::query::Outcome;
pub(super) use self::scope::Scope;
pub(super) use self::start::{Given, Start, StartKind, Started, Starts, Within, moved, stages};
pub(super) use self::template::Templates;
pub(super) use self::visibility::method_visibility;

/// Greatest number of types, constants or instances that need each other in a row.
const MAX_DEPTH: u32 = 64;

/// What is known so far.
pub(super) struct Declarations<'a> {
    resolver: &'static dyn Resolve,
    library: &'a BTreeSet<FileId>,
    stages: &'a Stages,
    templates: &'a Templates,
    overrides: &'a Overrides,
    /// What is done at a start outside of units.
    started: Vec<Started<'a>>,
    dialects: BTreeMap<FileId, (Dialect, WordSize)>,
    types: TypeTable,
    type_names: BTreeMap<String, TypeEntry<'a>>,
    /// Structures that something refers to, and whose declarations are wrong.
    unmade: BTreeSet<TypeId>,
    /// The structure that another one extends.
    structure_bases: BTreeMap<TypeId, TypeId>,
    pous: Vec<PouEntry<'a>>,
    pou_names: BTreeMap<String, PouId>,
    /// Where what is being resolved stands.
    home: Arc<Home>,
    /// Names of namespaces by their keys.
    namespaces: BTreeMap<String, String>,
    open: OpenNames,
    /// Keys of namespaces that are names of libraries: what they lack is looked for outside of them.
    libraries: BTreeSet<String>,
    classes: BTreeMap<PouId, Class>,
    /// Names that a method or action has in some unit, and those of properties.
    method_names: BTreeSet<String>,
    property_names: BTreeSet<String>,
    overloads: Overloads,
    globals: BTreeMap<String, GlobalEntry<'a>>,
    enumerators: BTreeMap<String, Vec<Enumerator>>,
    memory: Memory,
    memory_limit: MemoryLimit,
    /// What did not fit, and how large it is.
    too_large: Vec<(Span, Option<u64>)>,
    areas: Areas,
    address_unit: AddressUnit,
    /// Offset and size of what lies at hierarchical addresses, by their texts in capitals.
    hierarchical: BTreeMap<String, (u32, u32)>,
    /// Initial values of what is located.
    located: Vec<Initial>,
    programs: Vec<Program>,
    /// Where the first instances of programs lie.
    program_places: BTreeMap<PouId, u32>,
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
    long_durations: BTreeSet<Span>,
    stubs: Stubs,
    findings: Findings,
}

impl<'a> Declarations<'a> {
    pub(super) fn is_library(&self, id: PouId) -> bool {
        self.library.contains(&self.pou(id).ast.name.span.file)
    }

    pub(super) fn pou(&self, id: PouId) -> &PouEntry<'a> {
        // Ids are made by `collect` only, one for each entry.
        &self.pous[id.0 as usize]
    }
}

impl<'a> Declarations<'a> {
    pub(super) fn new(
        library: &'a BTreeSet<FileId>,
        (stages, templates): (&'a Stages, &'a Templates),
        (overrides, memory_limit): (&'a Overrides, MemoryLimit),
        resolver: &'static dyn Resolve,
    ) -> Self {
        Self {
            resolver,
            library,
            stages,
            templates,
            overrides,
            started: Vec::new(),
            dialects: BTreeMap::new(),
            types: TypeTable::new(),
            type_names: BTreeMap::new(),
            unmade: BTreeSet::new(),
            structure_bases: BTreeMap::new(),
            pous: Vec::new(),
            pou_names: BTreeMap::new(),
            home: Arc::default(),
            namespaces: BTreeMap::new(),
            open: OpenNames::default(),
            libraries: BTreeSet::new(),
            classes: BTreeMap::new(),
            method_names: BTreeSet::new(),
            property_names: BTreeSet::new(),
            overloads: Overloads::default(),
            generics: BTreeMap::new(),
            globals: BTreeMap::from([
                (VIRTUAL_TIME_NAME.to_owned(), provided(VIRTUAL_TIME_NAME, ElementaryType::Time, VIRTUAL_TIME_OFFSET)),
                (INIT_RETAINS_NAME.to_owned(), provided(INIT_RETAINS_NAME, ElementaryType::Bool, INIT_RETAINS_OFFSET)),
            ]),
            enumerators: BTreeMap::new(),
            memory: Memory::default(),
            memory_limit,
            too_large: Vec::new(),
            areas: Areas::default(),
            address_unit: AddressUnit::default(),
            hierarchical: BTreeMap::new(),
            located: Vec::new(),
            programs: Vec::new(),
            program_places: BTreeMap::new(),
            configuration: None,
            alternatives: BTreeMap::new(),
            global_uses: Vec::new(),
            calls: Calls::default(),
            depth: 0,
            chart_parts: Vec::new(),
            long_durations: BTreeSet::new(),
            stubs: Stubs::default(),
            findings: Findings::default(),
        }
    }
}

impl Declarations<'_> {
    /// The dialect of the text at `span`.
    pub(super) fn dialect(&self, span: Span) -> Dialect {
        // What the runtime provides stands in no file.
        self.dialects.get(&span.file).map_or_else(Dialect::default, |(dialect, _)| *dialect)
    }

    /// Bits of the registers of the target that runs the text at `span`.
    pub(super) fn word_size(&self, span: Span) -> WordSize {
        self.dialects.get(&span.file).map_or_else(WordSize::default, |(_, size)| *size)
    }
}
