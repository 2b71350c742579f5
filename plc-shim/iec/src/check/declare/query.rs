//! What bodies and the configuration ask of the declarations.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::Declarations;
use super::entry::Enumerator;
use super::namespace::Home;
use super::start::Started;
use crate::check::types::generic::Generic;
use crate::diagnostic::Diagnostic;
use crate::dialect::AddressUnit;
use crate::ir::{Areas, Location, PouId, Program, Row, TypeId, TypeTable, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, PouKind};

/// What of the declarations goes into the checked program.
pub(in crate::check) struct Outcome {
    pub(in crate::check) types: TypeTable,
    pub(in crate::check) programs: Vec<Program>,
    pub(in crate::check) rows: Vec<Row>,
    pub(in crate::check) areas: Areas,
    pub(in crate::check) address_unit: AddressUnit,
    pub(in crate::check) chart_parts: Vec<(Span, String)>,
    pub(in crate::check) long_durations: BTreeSet<Span>,
    pub(in crate::check) findings: Vec<Diagnostic>,
}

impl<'a> Declarations<'a> {
    pub(in crate::check) fn types(&self) -> &TypeTable {
        &self.types
    }

    pub(in crate::check) fn types_mut(&mut self) -> &mut TypeTable {
        &mut self.types
    }

    /// From where names are seen now.
    pub(in crate::check) fn home(&self) -> &Arc<Home> {
        &self.home
    }

    /// The same, for another place; gives the one before.
    pub(in crate::check) fn replace_home(&mut self, home: Arc<Home>) -> Arc<Home> {
        std::mem::replace(&mut self.home, home)
    }

    /// Where the type of the full key is declared.
    pub(in crate::check) fn type_span(&self, key: &str) -> Option<Span> {
        self.type_names.get(key).map(|entry| entry.ast.name.span)
    }

    /// True if the type of the full key is the library's, and not a user's of the same name.
    pub(in crate::check) fn is_library_type(&self, key: &str) -> bool {
        self.type_span(key).is_some_and(|span| self.library.contains(&span.file))
    }

    /// Notes what a structure adds to.
    pub(in crate::check) fn note_structure_base(&mut self, structure: TypeId, base: TypeId) {
        self.structure_bases.insert(structure, base);
    }

    /// True if a structure extends another one, be it through those between.
    pub(in crate::check) fn structure_extends(&self, structure: TypeId, base: TypeId) -> bool {
        let above = |ty: &TypeId| self.structure_bases.get(ty).copied();
        std::iter::successors(above(&structure), above).take(self.structure_bases.len()).any(|each| each == base)
    }

    /// True for a place in a file of the library.
    pub(in crate::check) fn is_in_library(&self, span: Span) -> bool {
        self.library.contains(&span.file)
    }

    /// The names of all types, as written.
    pub(in crate::check) fn type_names(&self) -> impl Iterator<Item = &str> {
        self.type_names.values().map(|entry| entry.ast.name.text.as_str())
    }

    pub(in crate::check) fn unit_ids(&self) -> impl Iterator<Item = PouId> + use<> {
        (0..self.pous.len() as u32).map(PouId)
    }

    /// The unit of the full key.
    pub(in crate::check) fn unit_of_key(&self, key: &str) -> Option<PouId> {
        self.pou_names.get(key).copied()
    }

    /// The names of all units of a kind, as written.
    pub(in crate::check) fn unit_names(&self, accept: impl Fn(PouKind) -> bool) -> impl Iterator<Item = &str> {
        self.pous.iter().filter(move |pou| accept(pou.ast.kind)).map(|pou| pou.ast.name.text.as_str())
    }

    /// True if any unit has a property of the name.
    pub(in crate::check) fn has_property_named(&self, key: &str) -> bool {
        self.property_names.contains(key)
    }

    /// The names of all global variables, as written.
    pub(in crate::check) fn global_names(&self) -> impl Iterator<Item = &str> {
        self.globals.values().map(|entry| entry.name.as_str())
    }

    /// The values of enumerations that the name alone stands for.
    pub(in crate::check) fn enumerators(&self, key: &str) -> &[Enumerator] {
        let key = self.without_libraries(key).unwrap_or(key);
        self.enumerators.get(key).map_or(&[], Vec::as_slice)
    }

    /// Makes a value known by its name alone, if none of a higher rank is.
    pub(in crate::check) fn add_enumerator(&mut self, name: &str, enumerator: Enumerator) {
        let known = self.enumerators.entry(name.to_ascii_uppercase()).or_default();
        known.retain(|each| each.rank <= enumerator.rank);
        if known.iter().all(|each| each.rank == enumerator.rank) {
            known.push(enumerator);
        }
    }

    /// Makes room in an area of direct addresses.
    pub(in crate::check) fn use_area(&mut self, location: Location, size: u32) {
        self.areas.extend(location, size);
    }

    /// The generic type that a unit sees as `ty`.
    pub(in crate::check) fn generic(&self, ty: TypeId) -> Option<Generic> {
        self.generics.get(&ty).copied()
    }

    /// What a unit sees of an input of a generic type.
    pub(in crate::check) fn seen_of_generic(&self, generic: Generic) -> Option<TypeId> {
        self.generics.iter().find(|(_, known)| **known == generic).map(|(ty, _)| *ty)
    }

    pub(in crate::check) fn add_generic(&mut self, ty: TypeId, generic: Generic) {
        self.generics.insert(ty, generic);
    }

    /// An LTIME was given for a TIME here.
    pub(in crate::check) fn note_long_duration(&mut self, at: Span) {
        self.long_durations.insert(at);
    }

    pub(in crate::check) fn note_chart_parts(&mut self, parts: impl IntoIterator<Item = (Span, String)>) {
        self.chart_parts.extend(parts);
    }

    /// What is done at a start outside of units, in the order of the text.
    pub(in crate::check) fn started(&self) -> Vec<Started<'a>> {
        let mut all = self.started.clone();
        all.sort_by_key(|each| (each.place.span.file, each.place.span.start));
        all
    }

    /// The instances of programs, in the order in which they are placed.
    pub(in crate::check) fn programs(&self) -> &[Program] {
        &self.programs
    }

    pub(in crate::check) fn programs_mut(&mut self) -> impl Iterator<Item = &mut Program> {
        self.programs.iter_mut()
    }

    pub(in crate::check) fn add_program(&mut self, program: Program) {
        self.programs.push(program);
    }

    /// The text of the configuration, if there is one.
    pub(in crate::check) fn configuration(&self) -> Option<&'a ast::Configuration> {
        self.configuration
    }

    /// The variables of every unit that has been declared.
    pub(in crate::check) fn interfaces(&self) -> BTreeMap<PouId, Vec<Variable>> {
        let declared = |id: PouId| Some((id, self.pou(id).scope.as_ref()?.variables().to_vec()));
        self.unit_ids().filter_map(declared).collect()
    }

    pub(in crate::check) fn into_outcome(mut self) -> Outcome {
        if !self.templates.is_empty() {
            self.findings.leave_out_repeated();
        }
        Outcome {
            types: self.types,
            programs: self.programs,
            rows: self.calls.into_rows(),
            areas: self.areas,
            address_unit: self.address_unit,
            chart_parts: self.chart_parts,
            long_durations: self.long_durations,
            findings: self.findings.into_list(),
        }
    }
}
