//! What a project uses of motion control: whether the shim can take it over, and of each block what is used.
//!
//! It is all or nothing: an axis is moved either by the PLC's own blocks or by those of the shim.

use std::collections::BTreeMap;

use super::motion::{self, Role, Use};
use super::target::Target;
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::syntax::FileId;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{
    Argument, Call, CompilationUnit, Declaration, Expr, ExprKind, Ident, Initialiser, InitialiserKind, Pou, Section,
    TypeSpec, TypeSpecKind,
};
use onescan_iec::syntax::walk::{self, Visitor};

/// Motion control that is taken over.
#[derive(Debug, Default)]
pub(super) struct Motion {
    /// Names that are replaced, and what by.
    pub(super) renames: Vec<(Ident, String)>,
    /// The blocks, by name in capitals.
    pub(super) blocks: BTreeMap<String, Use>,
    /// True if axes move in groups.
    pub(super) has_groups: bool,
    /// What stands against it, and what is left therefore.
    pub(super) findings: Vec<Diagnostic>,
}

impl Motion {
    /// The name of the block that takes the place of one of this name.
    pub(super) fn replacement(&self, name: &str) -> Option<String> {
        let key = name.to_ascii_uppercase();
        self.blocks.contains_key(&key).then(|| motion::new_name(&key))
    }
}

/// Looks through a project in which `names` stand for blocks and types of motion control.
pub(super) fn motion(target: Target, units: &[(FileId, &CompilationUnit)], names: &[(Ident, Role)]) -> Motion {
    // In TIA Portal axes are technology objects, unless the project has them as PLCopen does.
    let has_axes = names.iter().any(|(_, role)| *role == Role::Axis);
    let is_foreign = target == Target::Scl && !has_axes;
    let mut reader = Reader { has_own_axis: target.has_motion(), ..Reader::default() };
    for (name, role) in names {
        let why = match role {
            Role::Foreign(why) => Some(*why),
            Role::Block if is_foreign => Some("its axes are technology objects in TIA Portal"),
            Role::Group if target == Target::Scl => Some("groups of axes have no form in SCL"),
            Role::Group if matches!(target, Target::OpenPlc | Target::Beremiz) => {
                Some("groups of axes need references, which MatIEC does not have")
            }
            Role::Block => motion::differs(target, &name.key()),
            Role::Axis | Role::Vocabulary | Role::Group => None,
        };
        if let Some(why) = why {
            reader.problem(name.span, format!("`{}` is not replaced: {why}", name.text));
        } else if *role == Role::Block {
            reader.blocks.entry(name.key()).or_default();
        }
    }
    if reader.blocks.is_empty() && target == Target::Scl {
        // What a technology object is called with is not PLCopen's to judge.
        return Motion { findings: reader.findings, ..Motion::default() };
    }
    reader.has_groups = names.iter().any(|(_, role)| *role == Role::Group);
    if reader.blocks.is_empty() && !reader.has_groups && reader.findings.is_empty() {
        return Motion::default();
    }
    let declarations = || units.iter().flat_map(|(_, unit)| &unit.declarations);
    declarations().for_each(|declaration| reader.globals(declaration));
    declarations().for_each(|declaration| reader.declaration(declaration));
    reader.judged(names)
}

/// What a variable is to motion control.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Kind {
    Block(String),
    Axis,
    /// Something else, which hides a global of the name.
    Other,
}

#[derive(Default)]
struct Reader {
    /// True if the PLC has an axis of its own beside that of the shim.
    has_own_axis: bool,
    has_groups: bool,
    globals: BTreeMap<String, Kind>,
    locals: BTreeMap<String, Kind>,
    blocks: BTreeMap<String, Use>,
    findings: Vec<Diagnostic>,
}

impl Reader {
    fn problem(&mut self, span: Span, message: String) {
        self.findings.push(Diagnostic::warning(Code::MotionNotReplaced, span, message));
    }

    /// All or nothing.
    fn judged(mut self, names: &[(Ident, Role)]) -> Motion {
        let replaced = |role: &Role| matches!(role, Role::Block | Role::Axis);
        let names = names.iter().filter(|(_, role)| replaced(role)).map(|(name, _)| name);
        if self.findings.is_empty() {
            let renames = names.map(|name| (name.clone(), motion::new_name(&name.key()))).collect();
            return Motion { renames, blocks: self.blocks, has_groups: self.has_groups, findings: Vec::new() };
        }
        for name in names {
            let known = self.findings.iter().any(|found| found.span == name.span);
            if !known && name.key() != "AXIS_REF" {
                let message = format!(
                    "`{}` is left to the PLC's own clock, since not all motion control of the project can be replaced",
                    name.text
                );
                self.findings.push(Diagnostic::warning(Code::MotionNotReplaced, name.span, message));
            }
        }
        Motion { findings: self.findings, ..Motion::default() }
    }

    fn globals(&mut self, declaration: &Declaration) {
        match declaration {
            Declaration::Globals(section) => Self::variables(section, &mut self.globals),
            Declaration::Configuration(configuration) => {
                for section in configuration.all_sections() {
                    Self::variables(section, &mut self.globals);
                }
            }
            Declaration::Namespace(namespace) => namespace.declarations.iter().for_each(|each| self.globals(each)),
            Declaration::Pou(_) | Declaration::Type(_) | Declaration::Using(_) => {}
        }
    }

    fn variables(section: &Section, into: &mut BTreeMap<String, Kind>) {
        for variable in &section.variables {
            let kind = kind_of(&variable.spec);
            into.extend(variable.names.iter().map(|name| (name.key(), kind.clone())));
        }
    }

    fn declaration(&mut self, declaration: &Declaration) {
        match declaration {
            Declaration::Pou(pou) => {
                self.pou(pou);
                pou.object.members.iter().for_each(|member| self.pou(&member.pou));
                self.locals.clear();
            }
            Declaration::Namespace(namespace) => namespace.declarations.iter().for_each(|each| self.declaration(each)),
            Declaration::Globals(section) => self.initial_values(section),
            Declaration::Type(_) | Declaration::Configuration(_) | Declaration::Using(_) => {}
        }
    }

    fn pou(&mut self, pou: &Pou) {
        for section in &pou.sections {
            Self::variables(section, &mut self.locals);
        }
        pou.sections.iter().for_each(|section| self.initial_values(section));
        walk::unit(pou, self);
    }

    fn initial_values(&mut self, section: &Section) {
        for variable in &section.variables {
            if let Some(initial) = &variable.initial {
                self.initial_value(&kind_of(&variable.spec), initial);
            }
        }
    }

    /// `m : MC_MoveAbsolute := (Velocity := 1.0)`, and of arrays.
    fn initial_value(&mut self, of: &Kind, initial: &Initialiser) {
        match &initial.kind {
            // They are the simulated axis's.
            InitialiserKind::Struct(_) if *of == Kind::Axis => {}
            InitialiserKind::Struct(members) => {
                for member in members {
                    self.used(Some(of.clone()), &member.name);
                }
            }
            InitialiserKind::Array(values) => values.iter().for_each(|value| self.initial_value(of, value)),
            InitialiserKind::Repeat(_, value) => value.iter().for_each(|value| self.initial_value(of, value)),
            InitialiserKind::Elements(elements) => {
                for element in elements {
                    self.initial_value(of, &element.value);
                }
            }
            InitialiserKind::Value(_) => {}
        }
    }

    /// The variable that `expr` is, or is an element of.
    fn variable(&self, expr: &Expr) -> Option<Kind> {
        match &expr.kind {
            ExprKind::Name(name) => {
                let key = name.key();
                Some(self.locals.get(&key).or_else(|| self.globals.get(&key)).cloned().unwrap_or(Kind::Other))
            }
            ExprKind::Index(inner, _) | ExprKind::Paren(inner) => self.variable(inner),
            _ => None,
        }
    }

    /// `name` is used of a variable; of one that is not known it may be any block's.
    fn used(&mut self, of: Option<Kind>, name: &Ident) {
        let key = name.key();
        match of {
            Some(Kind::Block(block)) => {
                let known = self.blocks.get_mut(&block).is_some_and(|uses| note(&block, uses, &key));
                if !known && !motion::is_axis(&block, &key) {
                    let message =
                        format!("`{}` is not an input or output of PLCopen's `{}`", name.text, spelled(&block));
                    self.problem(name.span, message);
                }
            }
            Some(Kind::Axis) if self.has_own_axis => {
                let message = format!("`{}` is read or written in the PLC's own axis", name.text);
                self.problem(name.span, message);
            }
            Some(Kind::Axis | Kind::Other) => {}
            None => self.blocks.iter_mut().for_each(|(block, uses)| {
                note(block, uses, &key);
            }),
        }
    }

    fn member(&mut self, expr: &Expr) {
        if let ExprKind::Member(of, name) = &expr.kind {
            self.used(self.variable(of), name);
        }
    }
}

/// Notes what is used of a block; false if the block has no such input or output.
fn note(block: &str, uses: &mut Use, key: &str) -> bool {
    let (input, output) = (motion::is_input(block, key), motion::is_output(block, key));
    if input {
        uses.inputs.insert(key.to_owned());
    }
    if output {
        uses.outputs.insert(key.to_owned());
    }
    input || output
}

/// The name of a block as PLCopen writes it.
fn spelled(block: &str) -> String {
    motion::new_name(block).trim_start_matches("SDSP_").to_owned()
}

fn kind_of(spec: &TypeSpec) -> Kind {
    match &spec.kind {
        TypeSpecKind::Name(name) => match motion::role(&name.key()) {
            Some(Role::Block) => Kind::Block(name.key()),
            Some(Role::Axis) => Kind::Axis,
            _ => Kind::Other,
        },
        TypeSpecKind::Array(_, element) | TypeSpecKind::OpenArray(_, element) => kind_of(element),
        _ => Kind::Other,
    }
}

impl Visitor for Reader {
    fn target(&mut self, target: &Expr) {
        self.member(target);
    }

    fn expression(&mut self, expr: &Expr) {
        self.member(expr);
    }

    fn call(&mut self, call: &Call) {
        let of = self.variable(&call.callee);
        if of == Some(Kind::Other) {
            return;
        }
        for argument in &call.arguments {
            match argument {
                Argument::Input(name, _) | Argument::Output { name, .. } => self.used(of.clone(), name),
                Argument::Positional(value) if of.is_some() => {
                    let message = "an argument without a name: vendors' blocks have their inputs in other orders";
                    self.problem(value.span, message.to_owned());
                }
                Argument::Positional(_) => {}
            }
        }
    }
}
