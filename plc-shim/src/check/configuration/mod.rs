//! Configurations (2nd ed. 2.7, 3rd ed. 6.8): which programs there are, when they run, and what
//! they are connected to.
//!
//! | module | subject |
//! |---|---|
//! | [`globals`] | which resource sees which global variable |
//! | [`path`] | paths as in `Line.P1.fb.x` to variables |
//! | [`programs`] | instances of programs |
//! | [`connections`] | what runs before and after a program |
//! | [`tasks`] | tasks and their inputs |
//! | [`locations`] | direct addresses of single instances |
//! | [`instances`] | `VAR_CONFIG` and `VAR_ACCESS` |

mod connections;
mod globals;
mod instances;
mod locations;
mod path;
mod programs;
mod tasks;

use std::collections::BTreeMap;

use self::globals::Alternatives;
use self::locations::InstanceLocation;
use super::Checker;
use super::start::Started;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{self, Entry, PouId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};

/// What is known of the configuration so far.
#[derive(Default)]
pub(super) struct Configured<'a> {
    pub(super) ast: Option<&'a ast::Configuration>,
    /// Globals that several resources have under one name.
    alternatives: BTreeMap<String, Alternatives>,
    /// Where units use globals, if resources have some of their own.
    uses: Vec<(PouId, String, Span)>,
    resources: Vec<ir::Resource>,
    pub(super) entries: Vec<Entry>,
    access: Vec<ir::Access>,
    locations: Vec<InstanceLocation>,
    /// What a start does to single instances' values.
    pub(super) values: Vec<Started<'a>>,
    /// Instances of function blocks with a task of their own: the program, the instance's offset in
    /// it, where that is said.
    task_blocks: Vec<(usize, u32, Span)>,
}

impl<'a> Checker<'a> {
    /// Takes the configuration's global variables among the others.
    pub(super) fn collect_configuration(&mut self, ast: &'a ast::Configuration) {
        if let Some(first) = self.configured.ast {
            let message = format!("there is a configuration already, `{}`", first.name.text);
            let found = Diagnostic::error(Code::SecondConfiguration, ast.name.span, message);
            self.report(found.with_label(first.name.span, "first declared here"));
            return;
        }
        self.configured.ast = Some(ast);
        for section in &ast.sections {
            self.collect_globals(section);
        }
        let names: Vec<&Ident> = ast.resources.iter().filter_map(|each| Some(&each.name.as_ref()?.0)).collect();
        self.report_twins(&names);
    }

    /// Makes instances, tasks and connections; before the bodies of units are checked.
    pub(super) fn configure(&mut self) {
        if let Some(ast) = self.configured.ast {
            for (index, resource) in ast.resources.iter().enumerate() {
                let name = resource.name.as_ref().map(|(name, _)| name.text.clone());
                let tasks = self.tasks(resource, index);
                let globals = Vec::new();
                self.configured.resources.push(ir::Resource { name, tasks, background: Vec::new(), globals });
                self.place_instances(resource, index);
            }
        }
        self.place_other_programs();
        if let Some(ast) = self.configured.ast {
            self.resolve_single_inputs(ast);
            self.instance_values(&ast.instances);
            self.access_paths(&ast.access);
        }
        self.make_entries();
    }

    /// What can be said only when every unit's body is known.
    pub(super) fn check_configuration(&mut self) {
        self.report_idle_programs();
        self.report_foreign_globals();
        self.report_double_calls();
    }

    pub(super) fn take_configuration(&mut self) -> (Option<ir::Configuration>, Vec<Entry>) {
        for index in 0..self.configured.resources.len() {
            let globals = self.own_globals(index);
            self.configured.resources[index].globals = globals;
        }
        let configured = std::mem::take(&mut self.configured);
        let made = configured.ast.map(|ast| ir::Configuration {
            name: ast.name.text.clone(),
            resources: configured.resources,
            access: configured.access,
        });
        (made, configured.entries)
    }

    /// Reports every name that occurs before in the list.
    fn report_twins(&mut self, names: &[&Ident]) {
        let mut first: BTreeMap<String, Span> = BTreeMap::new();
        for name in names {
            if let Some(before) = first.get(&name.key()).copied() {
                self.report_duplicate(name, Some(before));
            } else {
                first.insert(name.key(), name.span);
            }
        }
    }

    /// A resource's name as it begins a path; nothing for the only one without a name.
    fn resource_name(&self, index: usize) -> Option<&'a Ident> {
        let resource = self.configured.ast?.resources.get(index)?;
        resource.name.as_ref().map(|(name, _)| name)
    }
}
