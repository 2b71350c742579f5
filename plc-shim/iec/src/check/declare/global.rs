//! Which resource sees which global variable (2nd ed. 2.7.1).
//!
//! Code is compiled once for all resources. A name that one resource alone declares is a variable
//! like any other, which units of other resources must not use. A name with several declarations
//! stands for the address of the running resource's own, set before each program.

use std::collections::BTreeMap;

use super::Declarations;
use super::entry::{GlobalEntry, Progress};
use super::layout::INIT_RETAINS_NAME;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, PouId, Storage, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};

/// A name that several resources, or a resource and the configuration, declare.
pub(super) struct Alternatives {
    /// Where the address of the running resource's variable stands.
    cell: u32,
    /// The key of each resource's variable.
    by_resource: BTreeMap<usize, String>,
    /// The key of the variable of all other resources.
    shared: Option<String>,
}

/// One declared name of a section.
struct Declared<'a> {
    name: &'a Ident,
    ast: &'a ast::Variable,
    section: &'a ast::Section,
}

impl<'a> Declarations<'a> {
    /// Takes the resources' global variables among the others; all of those are known.
    pub(super) fn collect_resource_globals(&mut self) {
        let Some(ast) = self.configuration else { return };
        let mut homes: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        let mut found = Vec::new();
        for (index, resource) in ast.resources.iter().enumerate() {
            let declared: Vec<Declared<'a>> = resource.sections.iter().flat_map(declared).collect();
            self.report_twins(&declared.iter().map(|each| each.name).collect::<Vec<_>>());
            for each in declared {
                let homes = homes.entry(each.name.key()).or_default();
                if homes.last() != Some(&index) {
                    homes.push(index);
                    found.push((index, each));
                }
            }
        }
        for (index, each) in found {
            let key = each.name.key();
            let shared = homes.get(&key).is_some_and(|homes| homes.len() > 1) || self.globals.contains_key(&key);
            let key = if shared { self.add_alternative(index, &key, each.name.span) } else { Some(key) };
            if let Some(key) = key {
                let entry = GlobalEntry {
                    ast: Some((each.ast, &each.section.qualifiers)),
                    name: each.name.text.clone(),
                    span: each.name.span,
                    progress: Progress::Untouched,
                    variable: None,
                    home: Some(index),
                    seen_from: std::sync::Arc::default(),
                };
                self.globals.insert(key, entry);
            }
        }
    }

    /// Makes `key` stand for several variables, and gives the key of this resource's own.
    fn add_alternative(&mut self, resource: usize, key: &str, span: Span) -> Option<String> {
        if !self.alternatives.contains_key(key) {
            let cell = self.allocate(ElementaryType::Udint.size(), ElementaryType::Udint.size(), span)?;
            let shared = self.globals.remove(key).map(|entry| {
                // No identifier has a dot, so no other variable has the key.
                let shared = format!(".{key}");
                self.globals.insert(shared.clone(), entry);
                shared
            });
            let alternatives = Alternatives { cell, by_resource: BTreeMap::new(), shared };
            self.alternatives.insert(key.to_owned(), alternatives);
            let entry = GlobalEntry {
                ast: None,
                name: key.to_owned(),
                span,
                progress: Progress::Untouched,
                variable: None,
                home: None,
                seen_from: std::sync::Arc::default(),
            };
            self.globals.insert(key.to_owned(), entry);
        }
        let own = format!("{resource}.{key}");
        self.alternatives.get_mut(key)?.by_resource.insert(resource, own.clone());
        Some(own)
    }

    /// What a name with several declarations stands for inside of units.
    pub(super) fn alternative_global(&mut self, key: &str, used: Option<Span>) -> Option<Variable> {
        let alternatives = self.alternatives.get(key)?;
        let cell = alternatives.cell;
        let keys: Vec<String> = alternatives.by_resource.values().chain(&alternatives.shared).cloned().collect();
        let variables: Vec<Variable> = keys.iter().map(|key| self.global(key, used)).collect::<Option<_>>()?;
        let (first, others) = variables.split_first()?;
        for other in others.iter().filter(|other| other.ty != first.ty) {
            let (wanted, found) = (self.types.name(first.ty), self.types.name(other.ty));
            let message = format!("`{}` is {wanted} in one resource, {found} in another", other.name);
            let found = Diagnostic::error(Code::ExternalWithoutGlobal, other.span, message);
            let found = found.with_label(first.span, "declared here");
            self.report(found.with_help("give the two variables different names"));
        }
        let storage = Storage::AbsolutePointer(cell);
        let is_constant = variables.iter().all(|variable| variable.is_constant);
        let variable = Variable { storage, constant: None, is_constant, ..first.clone() };
        if let Some(entry) = self.globals.get_mut(key) {
            entry.progress = Progress::Done;
            entry.variable = Some(variable.clone());
        }
        Some(variable)
    }

    /// The key under which `resource`, or what is outside of resources, finds a global variable.
    pub(in crate::check) fn key_in(&self, key: &str, resource: Option<usize>) -> Option<String> {
        if let Some(alternatives) = self.alternatives.get(key) {
            let own = resource.and_then(|index| alternatives.by_resource.get(&index));
            return own.or(alternatives.shared.as_ref()).cloned();
        }
        let key = self.open.globals.get(key).map_or(key, String::as_str);
        let entry = self.globals.get(key)?;
        (entry.home.is_none() || entry.home == resource).then(|| key.to_owned())
    }

    /// Notes that a unit uses a global variable by its name.
    pub(in crate::check) fn note_global_use(&mut self, pou: Option<PouId>, key: &str, span: Span) {
        if let (Some(pou), true) = (pou, self.configuration.is_some()) {
            self.global_uses.push((pou, key.to_owned(), span));
        }
    }

    /// The names with several declarations, and where the address of the running resource's own stands.
    pub(in crate::check) fn alternatives(&self) -> Vec<(String, u32)> {
        self.alternatives.iter().map(|(key, each)| (key.clone(), each.cell)).collect()
    }

    /// Where units use global variables by their names; nothing without a configuration.
    pub(in crate::check) fn global_uses(&self) -> &[(PouId, String, Span)] {
        &self.global_uses
    }

    /// The name of a global variable as written, and where it is declared.
    pub(in crate::check) fn global_declared(&self, key: &str) -> Option<(&str, Span)> {
        self.globals.get(key).map(|entry| (entry.name.as_str(), entry.span))
    }

    /// The resource that declares a global variable, if one does.
    pub(in crate::check) fn resource_of_global(&self, key: &str) -> Option<usize> {
        self.globals.get(key)?.home
    }

    /// The names of the global variables that `resource`, or what is outside of resources, sees.
    pub(in crate::check) fn global_names_in(&self, resource: Option<usize>) -> impl Iterator<Item = &str> {
        let seen = self.globals.values().filter(move |each| each.home.is_none() || each.home == resource);
        seen.map(|each| each.name.as_str())
    }

    /// The global variables that belong to no resource.
    pub(in crate::check) fn shared_globals(&self) -> Vec<Variable> {
        let all = self.globals_of(None).into_iter();
        all.filter(|variable| !matches!(variable.storage, Storage::AbsolutePointer(_))).collect()
    }

    /// The resource's own global variables.
    pub(in crate::check) fn own_globals(&self, resource: usize) -> Vec<Variable> {
        self.globals_of(Some(resource))
    }

    fn globals_of(&self, home: Option<usize>) -> Vec<Variable> {
        let found = self.globals.values().filter(|entry| entry.home == home && entry.name != INIT_RETAINS_NAME);
        found.filter_map(|entry| entry.variable.clone()).collect()
    }
}

fn declared(section: &ast::Section) -> impl Iterator<Item = Declared<'_>> {
    let each = move |ast| move |name| Declared { name, ast, section };
    section.variables.iter().flat_map(move |ast: &ast::Variable| ast.names.iter().map(each(ast)))
}

impl<'a> Declarations<'a> {
    /// Takes the configuration's global variables among the others.
    pub(super) fn collect_configuration(&mut self, ast: &'a ast::Configuration) {
        if let Some(first) = self.configuration {
            let message = format!("there is a configuration already, `{}`", first.name.text);
            let found = Diagnostic::error(Code::SecondConfiguration, ast.name.span, message);
            self.report(found.with_label(first.name.span, "first declared here"));
            return;
        }
        self.configuration = Some(ast);
        for section in &ast.sections {
            self.collect_globals(section);
        }
        let names: Vec<&Ident> = ast.resources.iter().filter_map(|each| Some(&each.name.as_ref()?.0)).collect();
        self.report_twins(&names);
    }

    /// Reports every name that occurs before in the list.
    pub(in crate::check) fn report_twins(&mut self, names: &[&Ident]) {
        let mut first: BTreeMap<String, Span> = BTreeMap::new();
        for name in names {
            if let Some(before) = first.get(&name.key()).copied() {
                self.report_duplicate(name, Some(before));
            } else {
                first.insert(name.key(), name.span);
            }
        }
    }
}
