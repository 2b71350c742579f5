//! What the files declare, and what is known of it so far.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::calls::Rows;
use super::class::Class;
use super::entry::{Enumerator, GlobalEntry, PouEntry, TypeEntry, provided};
use super::layout::{INIT_RETAINS_NAME, INIT_RETAINS_OFFSET, Layout, VIRTUAL_TIME_NAME, VIRTUAL_TIME_OFFSET};
use super::located::Initial;
use super::namespace::Home;
use super::start::{Occasion, Stages, Started};
use crate::check::configuration::Configured;
use crate::check::types::generic::Generic;
use crate::diagnostic::Diagnostic;
use crate::dialect::{AddressUnit, Dialect};
use crate::ir::{Areas, ElementaryType, Pou, PouId, Program, TypeId, TypeTable};
use crate::syntax::{FileId, Span};

/// Greatest number of types, constants or instances that need each other in a row.
pub(in crate::check) const MAX_DEPTH: u32 = 64;

/// What is known so far.
pub(in crate::check) struct Checker<'a> {
    pub(in crate::check) library: &'a BTreeSet<FileId>,
    pub(in crate::check) stages: &'a Stages,
    /// What is done at a start outside of units.
    pub(in crate::check) started: Vec<Started<'a>>,
    /// Where something was wrong already, and when.
    pub(in crate::check) faulty_starts: BTreeSet<(u32, u32, Occasion)>,
    /// Methods `FB_init` that do not suit those of their bases.
    pub(in crate::check) faulty_hooks: BTreeSet<PouId>,
    pub(in crate::check) dialects: BTreeMap<FileId, Dialect>,
    pub(in crate::check) types: TypeTable,
    pub(in crate::check) type_names: BTreeMap<String, TypeEntry<'a>>,
    pub(in crate::check) pous: Vec<PouEntry<'a>>,
    pub(in crate::check) pou_names: BTreeMap<String, PouId>,
    /// Where what is being resolved stands.
    pub(in crate::check) home: Arc<Home>,
    /// Names of namespaces by their keys.
    pub(in crate::check) namespaces: BTreeMap<String, String>,
    /// Full keys of global variables that are known without their list's name.
    pub(in crate::check) open_globals: BTreeMap<String, String>,
    pub(in crate::check) classes: BTreeMap<PouId, Class>,
    /// Names that a method or action has in some unit, and those of properties.
    pub(in crate::check) method_names: BTreeSet<String>,
    pub(in crate::check) property_names: BTreeSet<String>,
    pub(in crate::check) globals: BTreeMap<String, GlobalEntry<'a>>,
    pub(in crate::check) enumerators: BTreeMap<String, Vec<Enumerator>>,
    pub(in crate::check) layout: Layout,
    pub(in crate::check) areas: Areas,
    pub(in crate::check) address_unit: AddressUnit,
    /// Initial values of what is located.
    pub(in crate::check) located: Vec<Initial>,
    /// Offsets of string literals by type and bytes.
    pub(in crate::check) literals: BTreeMap<(TypeId, std::sync::Arc<[u8]>), u32>,
    /// Initial bytes of what has been placed.
    pub(in crate::check) placed: Vec<(u32, std::sync::Arc<[u8]>)>,
    pub(in crate::check) programs: Vec<Program>,
    pub(in crate::check) configured: Configured<'a>,
    pub(in crate::check) checked: BTreeMap<PouId, Pou>,
    /// Units whose bodies are still to be checked, and all that ever were.
    pub(in crate::check) queue: Vec<PouId>,
    pub(in crate::check) queued: BTreeSet<PouId>,
    /// Who calls whom, and where.
    pub(in crate::check) calls: BTreeMap<PouId, Vec<(PouId, Span)>>,
    /// Who may be called in ways that only a run decides.
    pub(in crate::check) dynamic_calls: BTreeMap<PouId, BTreeSet<PouId>>,
    /// What inputs of generic types are inside of their units.
    pub(in crate::check) generics: BTreeMap<TypeId, Generic>,
    pub(in crate::check) rows: Rows,
    pub(in crate::check) depth: u32,
    pub(in crate::check) chart_parts: Vec<(Span, String)>,
    pub(in crate::check) diagnostics: Vec<Diagnostic>,
}

impl<'a> Checker<'a> {
    pub(in crate::check) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub(in crate::check) fn is_library(&self, id: PouId) -> bool {
        self.library.contains(&self.pou(id).ast.name.span.file)
    }

    pub(in crate::check) fn pou(&self, id: PouId) -> &PouEntry<'a> {
        // Ids are made by `collect` only, one for each entry.
        &self.pous[id.0 as usize]
    }
}

impl<'a> Checker<'a> {
    pub(in crate::check) fn new(library: &'a BTreeSet<FileId>, stages: &'a Stages) -> Self {
        Self {
            library,
            stages,
            started: Vec::new(),
            faulty_starts: BTreeSet::new(),
            faulty_hooks: BTreeSet::new(),
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
            dynamic_calls: BTreeMap::new(),
            generics: BTreeMap::new(),
            rows: Rows::default(),
            globals: BTreeMap::from([
                (VIRTUAL_TIME_NAME.to_owned(), provided(VIRTUAL_TIME_NAME, ElementaryType::Time, VIRTUAL_TIME_OFFSET)),
                (INIT_RETAINS_NAME.to_owned(), provided(INIT_RETAINS_NAME, ElementaryType::Bool, INIT_RETAINS_OFFSET)),
            ]),
            enumerators: BTreeMap::new(),
            layout: Layout::new(),
            areas: Areas::default(),
            address_unit: AddressUnit::default(),
            located: Vec::new(),
            literals: BTreeMap::new(),
            placed: Vec::new(),
            programs: Vec::new(),
            configured: Configured::default(),
            checked: BTreeMap::new(),
            queue: Vec::new(),
            queued: BTreeSet::new(),
            calls: BTreeMap::new(),
            depth: 0,
            chart_parts: Vec::new(),
            diagnostics: Vec::new(),
        }
    }
}

impl Checker<'_> {
    /// The dialect of the text at `span`.
    pub(in crate::check) fn dialect(&self, span: Span) -> Dialect {
        self.dialects.get(&span.file).copied().unwrap_or_default()
    }
}
