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

pub(in crate::check) mod connections;
pub(in crate::check) mod globals;
pub(in crate::check) mod instances;
pub(in crate::check) mod locations;
pub(in crate::check) mod occasion;
pub(in crate::check) mod path;
pub(in crate::check) mod programs;
pub(in crate::check) mod tasks;

use std::collections::BTreeMap;

use self::locations::InstanceLocation;
use crate::check::declare::declarations::Checker;
use crate::check::declare::global::Alternatives;
use crate::check::declare::start::Started;
use crate::ir::{self, Entry, PouId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};

/// What is known of the configuration so far.
#[derive(Default)]
pub(in crate::check) struct Configured<'a> {
    pub(in crate::check) ast: Option<&'a ast::Configuration>,
    /// Globals that several resources have under one name.
    pub(in crate::check) alternatives: BTreeMap<String, Alternatives>,
    /// Where units use globals, if resources have some of their own.
    pub(in crate::check) uses: Vec<(PouId, String, Span)>,
    pub(in crate::check) resources: Vec<ir::Resource>,
    pub(in crate::check) entries: Vec<Entry>,
    pub(in crate::check) access: Vec<ir::Access>,
    pub(in crate::check) locations: Vec<InstanceLocation>,
    /// What a start does to single instances' values.
    pub(in crate::check) values: Vec<Started<'a>>,
    /// Instances of function blocks with a task of their own: the program, the instance's offset in
    /// it, where that is said.
    pub(in crate::check) task_blocks: Vec<(usize, u32, Span)>,
}

impl<'a> Checker<'a> {
    /// Makes instances, tasks and connections; before the bodies of units are checked.
    pub(in crate::check) fn configure(&mut self) {
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
    pub(in crate::check) fn check_configuration(&mut self) {
        self.report_idle_programs();
        self.report_foreign_globals();
        self.report_double_calls();
    }

    pub(in crate::check) fn take_configuration(&mut self) -> (Option<ir::Configuration>, Vec<Entry>) {
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

    /// A resource's name as it begins a path; nothing for the only one without a name.
    pub(in crate::check) fn resource_name(&self, index: usize) -> Option<&'a Ident> {
        let resource = self.configured.ast?.resources.get(index)?;
        resource.name.as_ref().map(|(name, _)| name)
    }
}
