//! Configurations, resources, tasks and instances of programs (2nd ed. 2.7, 3rd ed. 6.8).

use super::{Expr, Ident, Initialiser, Qualifier, Section, Span, TypeSpec};

/// `CONFIGURATION .. END_CONFIGURATION` (2nd ed. 2.7.1, Table 49).
#[derive(Debug, Clone)]
pub struct Configuration {
    pub name: Ident,
    pub sections: Vec<Section>,
    /// Its resources; one without a name if tasks and programs stand in the configuration itself.
    pub resources: Vec<Resource>,
    pub access: Vec<AccessPath>,
    pub instances: Vec<InstanceValue>,
    pub span: Span,
}

impl Configuration {
    /// Its sections of global variables, then those of its resources.
    pub fn all_sections(&self) -> impl Iterator<Item = &Section> {
        self.sections.iter().chain(self.resources.iter().flat_map(|resource| &resource.sections))
    }

    /// True if it declares global variables, and nothing that runs.
    pub(crate) fn has_only_globals(&self) -> bool {
        let has_paths = !self.access.is_empty() || !self.instances.is_empty();
        let runs = self.resources.iter().any(|each| !each.tasks.is_empty() || !each.programs.is_empty());
        self.all_sections().next().is_some() && !has_paths && !runs
    }

    /// Takes over what another part of the same configuration declares.
    pub(crate) fn absorb(&mut self, part: Self) {
        self.sections.extend(part.sections);
        self.access.extend(part.access);
        self.instances.extend(part.instances);
        for resource in part.resources {
            match self.resources.iter_mut().find(|own| own.name.is_none() && resource.name.is_none()) {
                Some(own) => {
                    own.tasks.extend(resource.tasks);
                    own.programs.extend(resource.programs);
                }
                None => self.resources.push(resource),
            }
        }
    }
}

/// `RESOURCE r ON p .. END_RESOURCE`
#[derive(Debug, Clone)]
pub struct Resource {
    /// Its name, and the kind of processor it stands on.
    pub name: Option<(Ident, Ident)>,
    pub sections: Vec<Section>,
    pub tasks: Vec<TaskDeclaration>,
    pub programs: Vec<ProgramDeclaration>,
}

/// `TASK t (INTERVAL := T#10ms, PRIORITY := 1);` (2nd ed. 2.7.2, Table 50)
#[derive(Debug, Clone)]
pub struct TaskDeclaration {
    pub name: Ident,
    /// Its inputs: `SINGLE`, `INTERVAL` and `PRIORITY`.
    pub inputs: Vec<(Ident, Expr)>,
}

/// `PROGRAM RETAIN p WITH t : Pump (level := x, valve => y, fb WITH u);`
#[derive(Debug, Clone)]
pub struct ProgramDeclaration {
    pub qualifier: Option<Qualifier>,
    pub name: Ident,
    pub task: Option<Ident>,
    pub program: Ident,
    /// What its variables are connected to.
    pub connections: Vec<Connection>,
    pub span: Span,
}

/// One element in the parentheses of a program's declaration.
#[derive(Debug, Clone)]
pub enum Connection {
    Input(Expr, Expr),
    Output(Expr, Expr),
    Task(Expr, Ident),
}

/// `Line.P1.ramp.rate AT %QW3 : INT := 5;` (2nd ed. 2.7.1, Table 49 feature 11)
#[derive(Debug, Clone)]
pub struct InstanceValue {
    /// The variable of an instance.
    pub path: Expr,
    pub address: Option<Ident>,
    pub spec: TypeSpec,
    pub initial: Option<Initialiser>,
}

/// `Level : Line.P1.level : INT READ_ONLY;` (2nd ed. 2.7.1, Table 49 feature 10)
#[derive(Debug, Clone)]
pub struct AccessPath {
    /// The name for those outside.
    pub name: Ident,
    pub path: Expr,
    pub spec: TypeSpec,
    /// What may be done with it.
    pub direction: AccessDirection,
}

/// What those outside may do with a variable (2nd ed. 2.7.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AccessDirection {
    /// `READ_ONLY`, also if nothing is said.
    ReadOnly,
    ReadWrite,
}
