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
mod occasion;
mod path;
mod programs;
mod tasks;

use std::collections::BTreeMap;

use self::locations::InstanceLocation;
use crate::check::declare::{Declarations, Started};
use crate::ir::{self, Entry, Pou, PouId};
use crate::syntax::Span;
use crate::syntax::ast::Ident;

/// What is known of the configuration so far.
#[derive(Default)]
pub(super) struct Configured<'a> {
    resources: Vec<ir::Resource>,
    entries: Vec<Entry>,
    access: Vec<ir::Access>,
    locations: Vec<InstanceLocation>,
    /// What a start does to single instances' values.
    values: Vec<Started<'a>>,
    /// Instances of function blocks with a task of their own: the program, the instance's offset in
    /// it, where that is said.
    task_blocks: Vec<(usize, u32, Span)>,
}

/// Works out the configuration from the declarations: first what runs, and when bodies are checked the rest.
pub(super) struct Configurer<'d, 'a> {
    declarations: &'d mut Declarations<'a>,
    configured: &'d mut Configured<'a>,
}

impl<'d, 'a> Configurer<'d, 'a> {
    pub(super) fn new(declarations: &'d mut Declarations<'a>, configured: &'d mut Configured<'a>) -> Self {
        Self { declarations, configured }
    }

    /// Makes instances, tasks and connections; before the bodies of units are checked.
    pub(super) fn configure(&mut self) {
        if let Some(ast) = self.declarations.configuration() {
            for (index, resource) in ast.resources.iter().enumerate() {
                let name = resource.name.as_ref().map(|(name, _)| name.text.clone());
                let tasks = self.tasks(resource, index);
                let globals = Vec::new();
                self.configured.resources.push(ir::Resource { name, tasks, background: Vec::new(), globals });
                self.place_instances(resource, index);
            }
        }
        self.place_other_programs();
        if let Some(ast) = self.declarations.configuration() {
            self.resolve_single_inputs(ast);
            self.instance_values(&ast.instances);
            self.access_paths(&ast.access);
        }
        self.make_entries();
        if let Some(ast) = self.declarations.configuration() {
            self.free_tasks(ast);
        }
    }

    /// What can be said only when every unit's body is known.
    pub(super) fn check(&mut self, checked: &BTreeMap<PouId, Pou>) {
        self.note_called_programs();
        self.report_idle_programs();
        self.report_unbound_programs();
        self.report_foreign_globals();
        self.report_double_calls(checked);
    }

    pub(super) fn finish(&mut self) -> (Option<ir::Configuration>, Vec<Entry>) {
        for index in 0..self.configured.resources.len() {
            let globals = self.declarations.own_globals(index);
            self.configured.resources[index].globals = globals;
        }
        let configured = std::mem::take(self.configured);
        let made = self.declarations.configuration().map(|ast| ir::Configuration {
            name: ast.name.text.clone(),
            resources: configured.resources,
            access: configured.access,
        });
        (made, configured.entries)
    }

    /// A resource's name as it begins a path; nothing for the only one without a name.
    fn resource_name(&self, index: usize) -> Option<&'a Ident> {
        let resource = self.declarations.configuration()?.resources.get(index)?;
        resource.name.as_ref().map(|(name, _)| name)
    }
}
