//! What the files declare, by name.

use std::collections::{BTreeMap, BTreeSet};

use crate::front::Front;
use crate::syntax::ast::{
    Configuration, Connection, Declaration, Expr, ExprKind, Field, Ident, Pou, PouKind, Section, SectionKind,
    TemplateUse, TypeSpec, TypeSpecKind, Variable,
};
use crate::syntax::walk::root;

/// What a unit declares, with its sections, by the keys of their names; of two of one name the first.
type Variables<'a> = BTreeMap<String, (&'a Section, &'a Variable)>;

/// Declarations by the key of their name: each is looked for as often as it is used, so that nobody goes through all of them.
pub(super) struct Index<'a> {
    own: Vec<&'a Pou>,
    members: Vec<&'a Pou>,
    /// What extends a unit, by the last part of that one's name.
    derived: BTreeMap<String, Vec<&'a Pou>>,
    units: BTreeMap<String, &'a Pou>,
    library: BTreeSet<String>,
    types: BTreeMap<String, &'a TypeSpec>,
    globals: Vec<&'a Section>,
    /// Global variables by the keys of their names; of two of one name the first.
    global_names: BTreeMap<String, &'a Variable>,
    /// The variables of the user's units and members.
    variables: BTreeMap<usize, Variables<'a>>,
    /// The members of the structures that have names.
    fields: BTreeMap<usize, BTreeMap<String, &'a TypeSpec>>,
    configurations: Vec<&'a Configuration>,
    /// Names that some unit has for a `VAR_IN_OUT`.
    in_outs: BTreeSet<String>,
    /// First names of namespaces and of lists of global variables.
    namespaces: BTreeSet<String>,
    /// Where generic blocks are named with their constants.
    templates: Vec<&'a TemplateUse>,
}

impl<'a> Index<'a> {
    pub(super) fn new(front: &'a Front) -> Self {
        let mut index = Self {
            own: Vec::new(),
            members: Vec::new(),
            derived: BTreeMap::new(),
            units: BTreeMap::new(),
            library: BTreeSet::new(),
            types: BTreeMap::new(),
            globals: Vec::new(),
            global_names: BTreeMap::new(),
            variables: BTreeMap::new(),
            fields: BTreeMap::new(),
            configurations: Vec::new(),
            in_outs: BTreeSet::new(),
            namespaces: BTreeSet::new(),
            templates: front.units.iter().flat_map(|(_, unit)| &unit.templates).collect(),
        };
        for (file, unit) in &front.units {
            let library = front.library.contains(file);
            for declaration in &unit.declarations {
                index.add(declaration, library);
            }
        }
        for variable in index.globals.iter().copied().flat_map(|section| &section.variables) {
            for name in &variable.names {
                index.global_names.entry(name.key()).or_insert(variable);
            }
        }
        for pou in index.own.iter().chain(&index.members) {
            index.variables.insert(place_of(*pou), variables_by_name(pou));
        }
        index
    }

    fn add(&mut self, declaration: &'a Declaration, library: bool) {
        match declaration {
            Declaration::Pou(pou) => {
                let members = pou.object.members.iter().map(|member| &member.pou);
                for each in members.chain([pou]) {
                    let in_outs = variables(each, SectionKind::InOut).flat_map(|variable| &variable.names);
                    self.in_outs.extend(in_outs.map(Ident::key));
                }
                self.units.insert(pou.name.key(), pou);
                if pou.external {
                    // What it does and uses is not known: nothing is said of it.
                } else if library {
                    self.library.insert(pou.name.key());
                } else {
                    self.own.push(pou);
                    for base in &pou.object.extends {
                        let key = base.template_key();
                        let last = key.rsplit('.').next().unwrap_or(&key).to_owned();
                        self.derived.entry(last).or_default().push(pou);
                    }
                    self.members.extend(pou.object.members.iter().map(|member| &member.pou));
                }
            }
            Declaration::Type(named) => {
                self.types.insert(named.name.key(), &named.spec);
                if let Some(fields) = fields_of(&named.spec) {
                    let mut by_name = BTreeMap::new();
                    for field in fields {
                        by_name.entry(field.name.key()).or_insert(&field.spec);
                    }
                    self.fields.insert(place_of(&named.spec), by_name);
                }
            }
            // What a vendor's library declares is there for whoever wants it.
            Declaration::Globals(_) if library => {}
            Declaration::Globals(section) => self.globals.push(section),
            Declaration::Namespace(namespace) => {
                self.namespaces.extend(namespace.name.key().split('.').map(str::to_owned));
                namespace.declarations.iter().for_each(|each| self.add(each, library));
            }
            Declaration::Using(_) => {}
            Declaration::Configuration(configuration) => {
                self.globals.extend(configuration.all_sections());
                self.configurations.push(configuration);
            }
        }
    }

    /// The user's units in their order.
    pub(super) fn own(&self) -> impl Iterator<Item = &'a Pou> {
        self.own.iter().copied()
    }

    /// The methods, properties and actions of the user's units that have statements.
    pub(super) fn own_members(&self) -> impl Iterator<Item = &'a Pou> {
        self.members.iter().copied().filter(|member| !member.body.is_empty())
    }

    /// A unit with its members, and all that is derived from it: what may use its variables.
    pub(super) fn users(&self, pou: &'a Pou) -> Vec<&'a Pou> {
        let mut found: Vec<&'a Pou> = Vec::new();
        let mut open = vec![pou];
        while let Some(next) = open.pop() {
            // A circle of bases is an error of its own.
            if found.iter().any(|each| std::ptr::eq(*each, next)) {
                continue;
            }
            found.push(next);
            found.extend(next.object.members.iter().map(|member| &member.pou));
            if next.kind.has_instances() {
                open.extend(self.derived.get(&next.name.key()).into_iter().flatten());
            }
        }
        found
    }

    /// What the constants of generic blocks are given, everywhere or in one unit.
    pub(super) fn constants_given(&self, unit: Option<&Pou>) -> impl Iterator<Item = &'a Expr> {
        let inside = |each: &&&TemplateUse| {
            unit.is_none_or(|pou| {
                let (all, part) = (pou.span, each.span);
                all.file == part.file && all.start <= part.start && part.end <= all.end
            })
        };
        self.templates.iter().filter(inside).flat_map(|each| &each.arguments).collect::<Vec<_>>().into_iter()
    }

    pub(super) fn unit(&self, key: &str) -> Option<&'a Pou> {
        self.units.get(key).copied()
    }

    pub(super) fn globals(&self) -> impl Iterator<Item = &'a Section> {
        self.globals.iter().copied()
    }

    /// What the configuration does with variables: what it reads, and what it may write.
    pub(super) fn configured(&self) -> (Vec<&'a Expr>, Vec<&'a Expr>) {
        let (mut read, mut written) = (Vec::new(), Vec::new());
        for configuration in &self.configurations {
            let resources = &configuration.resources;
            let tasks = resources.iter().flat_map(|resource| &resource.tasks).flat_map(|task| &task.inputs);
            read.extend(tasks.map(|(_, value)| value));
            let programs = resources.iter().flat_map(|resource| &resource.programs);
            for connection in programs.flat_map(|program| &program.connections) {
                match connection {
                    Connection::Input(_, source) => read.push(source),
                    Connection::Output(_, target) => written.push(target),
                    Connection::Task(..) => {}
                }
            }
            written.extend(configuration.access.iter().map(|access| &access.path));
            written.extend(configuration.instances.iter().map(|instance| &instance.path));
        }
        (read, written)
    }

    /// The tasks that the configuration has for a program; nothing without a configuration. What has
    /// no task stands for itself.
    pub(super) fn configured_tasks(&self, program: &Ident) -> Option<Vec<String>> {
        let configuration = self.configurations.first()?;
        let tasks = configuration.resources.iter().flat_map(|resource| {
            let runs = |each: &&crate::syntax::ast::ProgramDeclaration| each.program.key() == program.key();
            resource.programs.iter().filter(runs).map(|each| {
                let task = each.task.as_ref().unwrap_or(&each.name).text.clone();
                resource.name.as_ref().map_or_else(|| task.clone(), |(home, _)| format!("{}.{task}", home.text))
            })
        });
        Some(tasks.collect::<BTreeSet<_>>().into_iter().collect())
    }

    /// What the user's types are.
    pub(super) fn type_specs(&self) -> impl Iterator<Item = &'a TypeSpec> {
        self.types.values().copied()
    }

    pub(super) fn global(&self, key: &str) -> Option<&'a Variable> {
        self.global_names.get(key).copied()
    }

    /// The declaration of a name in a unit, with its section.
    pub(super) fn declared(&self, pou: &'a Pou, key: &str) -> Option<(&'a Section, &'a Variable)> {
        match self.variables.get(&place_of(pou)) {
            Some(variables) => variables.get(key).copied(),
            // A block of a library has a few variables.
            None => variables_by_name(pou).remove(key),
        }
    }

    /// The type of a member of a structure.
    pub(super) fn field(&self, structure: &'a TypeSpec, key: &str) -> Option<&'a TypeSpec> {
        match self.fields.get(&place_of(structure)) {
            Some(fields) => fields.get(key).copied(),
            // One without a name is declared where it is used.
            None => fields_of(structure)?.iter().find(|field| field.name.has_key(key)).map(|field| &field.spec),
        }
    }

    /// True for a place that begins with the name of a namespace.
    pub(super) fn is_in_namespace(&self, place: &Expr) -> bool {
        !self.namespaces.is_empty() && root(place).is_some_and(|name| self.namespaces.contains(&name.key()))
    }

    /// The variable that a place is a part of; in a namespace all names on the way, one of which it is.
    pub(super) fn variables_of<'e>(&self, place: &'e Expr) -> Vec<&'e Ident> {
        if !self.is_in_namespace(place) {
            return root(place).into_iter().collect();
        }
        let (mut names, mut next) = (Vec::new(), place);
        while let ExprKind::Member(inner, _) | ExprKind::Index(inner, _) | ExprKind::Paren(inner) = &next.kind {
            if let ExprKind::Member(_, name) = &next.kind {
                names.push(name);
            }
            next = inner;
        }
        names
    }

    /// True for a name that a `VAR_IN_OUT` has in some unit: an argument of that name may be written.
    pub(super) fn is_in_out(&self, key: &str) -> bool {
        self.in_outs.contains(key)
    }

    /// What a type's name stands for, aliases followed.
    pub(super) fn resolved(&self, spec: &'a TypeSpec) -> &'a TypeSpec {
        let mut spec = spec;
        // A longer chain of aliases is an error of its own.
        for _ in 0..16 {
            let TypeSpecKind::Name(name) = &spec.kind else { return spec };
            match self.types.get(&name.key()) {
                Some(next) => spec = next,
                None => return spec,
            }
        }
        spec
    }

    /// The function block whose instance, or array of instances, a type is.
    pub(super) fn block(&self, spec: &'a TypeSpec) -> Option<&'a Pou> {
        match &self.resolved(spec).kind {
            TypeSpecKind::Name(name) | TypeSpecKind::Instance(name, _) => {
                self.unit(&name.template_key()).filter(|pou| pou.kind == PouKind::FunctionBlock)
            }
            TypeSpecKind::Array(_, element) => self.block(element),
            _ => None,
        }
    }

    /// True for timers, counters and edge detections of the standard: they must see every scan.
    pub(super) fn needs_every_scan(&self, block: &Pou) -> bool {
        let key = block.name.key();
        self.library.contains(&key)
            && (matches!(key.as_str(), "TON" | "TOF" | "TP" | "R_TRIG" | "F_TRIG") || key.starts_with("CT"))
    }
}

/// The variables of one kind of section.
pub(super) fn variables(pou: &Pou, kind: SectionKind) -> impl Iterator<Item = &Variable> {
    pou.sections.iter().filter(move |section| section.kind == kind).flat_map(|section| &section.variables)
}

/// Where a node of the tree lies, which distinguishes it from all others: they may have equal names. Nothing is done in this
/// order.
fn place_of<T>(node: &T) -> usize {
    std::ptr::from_ref(node).addr()
}

fn variables_by_name(pou: &Pou) -> Variables<'_> {
    let mut found = Variables::new();
    for section in &pou.sections {
        for variable in &section.variables {
            for name in &variable.names {
                found.entry(name.key()).or_insert((section, variable));
            }
        }
    }
    found
}

/// The members of a structure or union.
fn fields_of(spec: &TypeSpec) -> Option<&[Field]> {
    match &spec.kind {
        TypeSpecKind::Struct(fields) | TypeSpecKind::Overlapping(fields) | TypeSpecKind::Union(fields) => {
            Some(fields.as_slice())
        }
        _ => None,
    }
}
