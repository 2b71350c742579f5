//! What of a project has to do with time: programs, sources of time, names.

use std::collections::BTreeSet;

use super::chart_plan::charts;
use super::chart_time;
use super::clock::{self, Fate, Form};
use super::foreign::{self, Kind};
use super::motion::Role;
use super::real_inputs::RealInputs;
use super::scl_timer::TimerCalls;
use super::target::Target;
use super::template::Only;
use onescan_iec::check::{VIRTUAL_TIME_NAME, is_standard_function};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::front::library;
use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::ast::{
    Call, CompilationUnit, Configuration, Declaration, Expr, ExprKind, Ident, Initialiser, InitialiserKind, Pou,
    PouKind, Section, TypeSpec, TypeSpecKind,
};
use onescan_iec::syntax::constant::{self, Constants};
use onescan_iec::syntax::walk::{self, Visitor};
use onescan_iec::syntax::{FileId, Span, parse};

#[derive(Debug, Default)]
pub(super) struct Survey<'a> {
    /// For whom the project is instrumented.
    pub(super) target: Target,
    /// True if signals go in data blocks of the shim's.
    pub(super) is_exchanged: bool,
    /// The programs in their order.
    pub(super) programs: Vec<&'a Pou>,
    /// The first configuration; all its parts, of which each of TwinCAT's task files is one.
    pub(super) configurations: Vec<&'a Configuration>,
    pub(super) constants: Constants<'a>,
    /// Programs that others call.
    pub(super) called: BTreeSet<String>,
    /// Actions and methods that are called, by their keys: `UNIT.NAME` within a unit, `.NAME` of an instance.
    called_members: BTreeSet<String>,
    /// Programs and function blocks that are charts, or have actions that are.
    pub(super) charts: Vec<&'a Pou>,
    /// Inputs that are taken over.
    pub(super) inputs: RealInputs<'a>,
    /// Names to be replaced.
    pub(super) renames: Vec<(Ident, &'static Form)>,
    /// What is an LTIME, where the shim's timers have a TIME.
    pub(super) long_durations: BTreeSet<Span>,
    /// Names of blocks and types of motion control.
    pub(super) motion: Vec<(Ident, Role)>,
    /// Calls of timers by what they are, in SCL.
    pub(super) timer_calls: TimerCalls,
    /// What goes with the timers that are replaced, in SCL.
    pub(super) cuts: Vec<Span>,
    /// Keys of the units and types that the project declares.
    declared: BTreeSet<String>,
    /// Keys of its global variables.
    globals: BTreeSet<String>,
    /// What cannot be replaced, and names that the shim needs for itself.
    pub(super) findings: Vec<Diagnostic>,
}

impl Survey<'_> {
    /// Lines of a controller's template that not every project has.
    pub(super) fn wanted(&self) -> &'static [Only] {
        if self.is_exchanged { &[Only::Exchange] } else { &[] }
    }
}

/// Looks through all files of a project.
pub(super) fn survey<'a>(units: &[(FileId, &'a CompilationUnit)], target: Target) -> Survey<'a> {
    let declarations = || units.iter().flat_map(|(_, unit)| &unit.declarations);
    let mut names = Names::default();
    declarations().for_each(|declaration| names.add(declaration));
    let timer_calls = if target == Target::Scl { TimerCalls::of(units) } else { TimerCalls::default() };
    let (declared, globals) = (names.units_and_types.clone(), names.globals.clone());
    let survey = Survey { target, timer_calls, declared, globals, ..Survey::default() };
    let mut surveyor = Surveyor { names: &names, target, unit: String::new(), local: BTreeSet::new(), survey };
    declarations().for_each(|declaration| surveyor.declaration(declaration));
    let mut survey = surveyor.survey;
    survey.cuts = survey.timer_calls.cuts(units, &survey.renames);
    survey
}

/// What the project declares, and what everybody has.
#[derive(Default)]
struct Names {
    programs: BTreeSet<String>,
    units_and_types: BTreeSet<String>,
    globals: BTreeSet<String>,
}

impl Survey<'_> {
    /// True for a name that the project gives to a unit or type of its own.
    pub(super) fn is_declared(&self, name: &str) -> bool {
        self.declared.contains(&name.to_ascii_uppercase())
    }

    /// True for a global variable of the project.
    pub(super) fn is_global(&self, name: &str) -> bool {
        self.globals.contains(&name.to_ascii_uppercase())
    }

    /// True if an action of `unit` is called by its name, there or elsewhere.
    pub(super) fn calls(&self, unit: &Pou, action: &Ident) -> bool {
        let keys = [format!("{}.{}", unit.name.key(), action.key()), format!(".{}", action.key())];
        keys.iter().any(|key| self.called_members.contains(key))
    }
}

impl Names {
    fn add(&mut self, declaration: &Declaration) {
        match declaration {
            Declaration::Pou(pou) => {
                if pou.kind == PouKind::Program {
                    self.programs.insert(pou.name.key());
                }
                self.units_and_types.insert(pou.name.key());
            }
            Declaration::Type(named) => {
                self.units_and_types.insert(named.name.key());
            }
            Declaration::Globals(section) => self.globals.extend(variable_names(section)),
            Declaration::Namespace(namespace) => namespace.declarations.iter().for_each(|each| self.add(each)),
            Declaration::Using(_) => {}
            Declaration::Configuration(configuration) => {
                self.globals.extend(configuration.all_sections().flat_map(variable_names));
            }
        }
    }
}

fn variable_names(section: &Section) -> impl Iterator<Item = String> {
    section.variables.iter().flat_map(|variable| &variable.names).map(Ident::key)
}

/// Units of the standard's own, by name.
fn is_standard_unit(key: &str) -> bool {
    static NAMES: std::sync::OnceLock<BTreeSet<String>> = std::sync::OnceLock::new();
    let names = NAMES.get_or_init(|| {
        let units = library::FILES.iter().map(|(_, text)| parse(FileId(0), text).unit);
        let mut names = Names::default();
        units.for_each(|unit| unit.declarations.iter().for_each(|each| names.add(each)));
        names.units_and_types
    });
    names.contains(key)
}

struct Surveyor<'n, 'a> {
    names: &'n Names,
    target: Target,
    /// The key of the unit that is looked through; empty outside of one.
    unit: String,
    /// Variables of the unit that is looked through.
    local: BTreeSet<String>,
    survey: Survey<'a>,
}

impl<'a> Surveyor<'_, 'a> {
    fn declaration(&mut self, declaration: &'a Declaration) {
        match declaration {
            Declaration::Pou(pou) => self.pou(pou),
            Declaration::Type(named) => {
                self.own_name(&named.name);
                self.spec(&named.spec);
                named.initial.iter().for_each(|initial| self.initialiser(initial));
            }
            Declaration::Globals(section) => self.globals(section),
            Declaration::Configuration(configuration) => self.configuration(configuration),
            Declaration::Namespace(namespace) => namespace.declarations.iter().for_each(|each| self.declaration(each)),
            Declaration::Using(_) => {}
        }
    }

    fn pou(&mut self, pou: &'a Pou) {
        self.own_name(&pou.name);
        // The PLC itself runs an organization block of the start.
        if pou.kind == PouKind::Program && !pou.object.runs_at_start {
            self.survey.programs.push(pou);
        }
        if pou.kind == PouKind::FunctionBlock {
            pou.object.extends.iter().for_each(|base| self.base(base));
        }
        self.local = pou.sections.iter().flat_map(variable_names).collect();
        self.unit = pou.name.key();
        // An action is called by its name.
        self.local.extend(pou.object.members.iter().map(|member| member.pou.name.key()));
        pou.result.iter().for_each(|result| self.spec(result));
        pou.sections.iter().for_each(|section| self.section(section));
        if charts(pou).next().is_some() {
            self.survey.charts.push(pou);
            self.survey.findings.extend(chart_time::findings(pou));
        }
        self.own_parts(pou);
        walk::unit(pou, self);
        for member in pou.object.members.iter().map(|member| &member.pou) {
            self.local.extend(member.sections.iter().flat_map(variable_names));
            member.result.iter().for_each(|result| self.spec(result));
            member.sections.iter().for_each(|section| self.section(section));
            walk::unit(member, self);
        }
        self.local.clear();
        self.unit.clear();
    }

    /// What a function block is derived from. How a derived one is used says nothing of a motion block's inputs.
    fn base(&mut self, name: &Ident) {
        self.type_name(name);
        if let Some((_, role)) = self.survey.motion.last_mut().filter(|(met, _)| met.span == name.span) {
            *role = Role::Foreign("a function block is derived from it");
        }
    }

    fn globals(&mut self, section: &'a Section) {
        constant::note(section, &mut self.survey.constants);
        section.variables.iter().flat_map(|each| &each.names).for_each(|name| self.own_name(name));
        self.section(section);
    }

    fn configuration(&mut self, configuration: &'a Configuration) {
        let first = self.survey.configurations.first();
        if first.is_none_or(|first| first.name.key() == configuration.name.key()) {
            self.survey.configurations.push(configuration);
        }
        configuration.all_sections().for_each(|section| self.globals(section));
        configuration.access.iter().for_each(|access| self.spec(&access.spec));
        configuration.instances.iter().for_each(|instance| self.spec(&instance.spec));
    }

    /// Steps and actions have names among those of the shim's own.
    fn own_parts(&mut self, pou: &Pou) {
        charts(pou).flat_map(|chart| &chart.chart.steps).for_each(|step| self.own_name(&step.name));
        pou.object.members.iter().for_each(|member| self.own_name(&member.pou.name));
    }

    /// A name that a project gives must not be one of the shim's.
    fn own_name(&mut self, name: &Ident) {
        if name.key().starts_with("SDSP_") {
            let message = format!("`{}`: names that begin with `SDSP_` are the shim's", name.text);
            self.survey.findings.push(Diagnostic::error(Code::ShimNameTaken, name.span, message));
        }
    }

    fn section(&mut self, section: &Section) {
        for variable in &section.variables {
            match self.survey.timer_calls.replacement(&self.unit, variable) {
                Some((name, form)) => self.survey.renames.push((name.clone(), form)),
                None => self.spec(&variable.spec),
            }
            variable.initial.iter().for_each(|initial| self.initialiser(initial));
        }
    }

    fn spec(&mut self, spec: &TypeSpec) {
        match &spec.kind {
            TypeSpecKind::Name(name) => self.type_name(name),
            TypeSpecKind::Instance(name, arguments) => {
                self.type_name(name);
                arguments.values().for_each(|value| walk::expression(value, self));
            }
            TypeSpecKind::Array(_, element)
            | TypeSpecKind::OpenArray(_, element)
            | TypeSpecKind::Reference(_, element) => self.spec(element),
            TypeSpecKind::Struct(fields) | TypeSpecKind::Overlapping(fields) | TypeSpecKind::Union(fields) => {
                for field in fields {
                    self.spec(&field.spec);
                    field.initial.iter().for_each(|initial| self.initialiser(initial));
                }
            }
            TypeSpecKind::String(..)
            | TypeSpecKind::Subrange(..)
            | TypeSpecKind::Enumeration(..)
            | TypeSpecKind::Error => {}
        }
    }

    fn initialiser(&mut self, initialiser: &Initialiser) {
        match &initialiser.kind {
            InitialiserKind::Value(value) => walk::expression(value, self),
            InitialiserKind::Array(values) => values.iter().for_each(|value| self.initialiser(value)),
            InitialiserKind::Repeat(_, value) => value.iter().for_each(|value| self.initialiser(value)),
            InitialiserKind::Struct(members) => members.iter().for_each(|member| self.initialiser(&member.value)),
            InitialiserKind::Elements(elements) => elements.iter().for_each(|each| self.initialiser(&each.value)),
        }
    }

    fn type_name(&mut self, name: &Ident) {
        let key = name.key();
        // What a project declares itself goes before what others have by the name.
        if self.names.units_and_types.contains(&key) || ElementaryType::find(&key).is_some() {
            return;
        }
        match clock::fate(&key, Kind::Block) {
            Some(fate) => self.met(name, fate),
            None if is_standard_unit(&key) => {}
            None => self.unknown("type", name),
        }
    }

    fn function_name(&mut self, name: &Ident) {
        let key = name.key();
        if self.local.contains(&key) || self.names.globals.contains(&key) {
            return;
        }
        if self.names.programs.contains(&key) {
            self.survey.called.insert(key);
        } else if self.names.units_and_types.contains(&key) {
        } else if let Some(fate) = clock::fate(&key, Kind::Function) {
            self.met(name, fate);
        } else if library::is_assert(&key) {
            self.assert(name);
        } else if !is_standard_unit(&key) && !is_standard_function(&key) {
            self.unknown("function", name);
        }
    }

    fn met(&mut self, name: &Ident, fate: Fate) {
        match fate {
            Fate::Replaced(form) if form.suits(self.target) => self.survey.renames.push((name.clone(), form)),
            Fate::Replaced(_) | Fate::Reported => self.report(&name.text, name.span),
            Fate::Motion(role) => self.survey.motion.push((name.clone(), role)),
        }
    }

    fn report(&mut self, name: &str, span: Span) {
        let key = |name: &str| name.trim_matches('"').to_ascii_uppercase();
        let library = [Kind::Block, Kind::Function].into_iter().find_map(|kind| foreign::find(&key(name), kind));
        let of = library.map_or(String::new(), |library| format!(" ({})", library.name));
        let message = format!("`{name}`{of} reads the PLC's own clock and cannot be replaced");
        let help = "read the time from SDSP_Now while SDSP_Simulated is TRUE";
        self.survey.findings.push(Diagnostic::warning(Code::ClockNotReplaced, span, message).with_help(help));
    }

    /// What only tests of onescan have; program text for `iec` may still go to its own soft PLC.
    fn assert(&mut self, name: &Ident) {
        let message = format!("`{}` is a function of onescan for tests, which no PLC has", name.text);
        let found = match self.target {
            Target::Iec => Diagnostic::warning(Code::ClockNotReplaced, name.span, message),
            _ => Diagnostic::error(Code::UnsupportedFeature, name.span, message),
        };
        let help = "keep tests in files of their own, and leave those out of the project that you instrument";
        self.survey.findings.push(found.with_help(help));
    }

    fn unknown(&mut self, what: &str, name: &Ident) {
        let message = format!("the {what} `{}` is not in the project: it may read the PLC's own clock", name.text);
        let help = "add its source to the project, or make sure that it does not";
        self.survey.findings.push(Diagnostic::warning(Code::ClockNotReplaced, name.span, message).with_help(help));
    }
}

impl Visitor for Surveyor<'_, '_> {
    fn call(&mut self, call: &Call) {
        match &call.callee.kind {
            ExprKind::Name(name) => {
                self.survey.called_members.insert(format!("{}.{}", self.unit, name.key()));
                self.function_name(name);
            }
            ExprKind::Member(_, name) => {
                self.survey.called_members.insert(format!(".{}", name.key()));
            }
            _ => {}
        }
    }

    fn expression(&mut self, expr: &Expr) {
        if let ExprKind::Name(name) = &expr.kind
            && name.key() == VIRTUAL_TIME_NAME
        {
            self.report(&name.text, name.span);
        }
    }
}
