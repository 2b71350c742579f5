//! Sections to placed variables; the interfaces of units (2nd ed. 2.4.3 and 2.5).

use std::collections::{BTreeMap, BTreeSet};

use super::global::{OF_CONSTANTS, OF_LOCATED};
use super::referred::referred;
use crate::check::body::Body;
use crate::check::declare::declarations::Checker;
use crate::check::declare::demand::Need;
use crate::check::declare::entry::TypedImage;
use crate::check::declare::located::Placement;
use crate::check::declare::scope::Scope;
use crate::check::declare::start::{Start, Starts, moved};
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{ElementaryType, Place, PouId, Storage, TypeId, Variable};
use crate::syntax::ast::{self, Ident, PouKind, Qualifier, Section, SectionKind};

/// Pointers are offsets in memory.
pub(in crate::check) const POINTER: ElementaryType = ElementaryType::Udint;

/// A unit's variables as they have been declared.
#[derive(Default)]
pub(in crate::check) struct Declared<'a> {
    pub(in crate::check) scope: Scope,
    pub(in crate::check) align: u32,
    pub(in crate::check) image: Vec<u8>,
    pub(in crate::check) starts: Vec<Start<'a>>,
    pub(in crate::check) fleeting: Vec<(String, Starts<'a>)>,
    pub(in crate::check) kept: BTreeMap<(u32, u32), u32>,
}

const OF_INPUTS: &str = "an input that is not given has its value from before the program runs";

impl<'a> Body<'_, 'a> {
    /// Type and initial bytes of a declaration.
    pub(in crate::check) fn declared(&mut self, ast: &'a ast::Variable, need: Need) -> Option<TypedImage<'a>> {
        let declared = self.resolve(&ast.spec, need)?;
        match &ast.initial {
            Some(initial) => self.with_initial(&declared, initial),
            None => Some(declared),
        }
    }
}

/// A unit's variables while they are declared.
pub(in crate::check) struct Interface<'c, 'a> {
    pub(in crate::check) body: Body<'c, 'a>,
    pub(in crate::check) kind: PouKind,
    pub(in crate::check) align: u32,
    /// Initial bytes of an instance so far.
    pub(in crate::check) image: Vec<u8>,
    /// What a start does to an instance so far.
    pub(in crate::check) starts: Vec<Start<'a>>,
    /// What a call does to variables that do not outlive it.
    pub(in crate::check) fleeting: Vec<(String, Starts<'a>)>,
    /// Where `VAR_INST` of its methods lie in an instance.
    pub(in crate::check) kept: BTreeMap<(u32, u32), u32>,
    /// Variables whose address the body takes.
    pub(in crate::check) referred: BTreeSet<String>,
}

impl<'c, 'a> Interface<'c, 'a> {
    pub(in crate::check) fn new(checker: &'c mut Checker<'a>, id: PouId) -> Self {
        let ast = checker.pou(id).ast;
        let (kind, referred) = (ast.kind, referred(ast));
        let body = Body::new(checker, Scope::default(), Some(id));
        let (starts, fleeting, kept) = (Vec::new(), Vec::new(), BTreeMap::new());
        Self { body, kind, align: 1, image: Vec::new(), starts, fleeting, kept, referred }
    }

    pub(in crate::check) fn declare(&mut self, ast: &'a ast::Pou) {
        if self.kind.keeps_nothing() {
            self.declare_this();
            self.inherit();
            self.declare_sections(ast, |kind| matches!(kind, SectionKind::Input | SectionKind::InOut));
            self.declare_new_value(ast);
            self.declare_sections(ast, |kind| kind == SectionKind::Output);
            self.body.scope.parameters = self.body.scope.registers.len() as u32;
            self.declare_result(ast);
            let of_callers = [SectionKind::Input, SectionKind::InOut, SectionKind::Output];
            self.declare_sections(ast, |kind| !of_callers.contains(&kind));
        } else {
            // The first parameter is the instance's address.
            self.body.scope.register(POINTER);
            self.body.scope.parameters = 1;
            self.inherit();
            self.declare_sections(ast, |_| true);
            self.declare_charts(ast);
            self.keep_for_methods(ast);
        }
    }

    fn declare_sections(&mut self, ast: &'a ast::Pou, accept: impl Fn(SectionKind) -> bool) {
        for section in ast.sections.iter().filter(|section| accept(section.kind)) {
            for variable in &section.variables {
                self.declare_variables(section, variable);
            }
        }
    }

    fn declare_result(&mut self, ast: &'a ast::Pou) {
        let Some(spec) = ast.result.as_ref().filter(|_| !self.is_setter()) else { return };
        if let Some(parameter) = self.declared_before(&ast.name) {
            self.body.checker.report_duplicate(&ast.name, Some(parameter));
            return;
        }
        let Some(declared) = self.body.resolve(spec, Need::Size) else {
            return;
        };
        let Some(storage) = self.temporary(&declared, &ast.name) else {
            return;
        };
        let span = ast.name.span;
        self.body.reject_open_array(declared.ty, spec.span);
        self.body.scope.result = Some(Place::whole(storage, declared.ty, span));
        let shape = ast::Variable { names: Vec::new(), address: None, spec: spec.clone(), edge: None, initial: None };
        let kind = SectionKind::Temp;
        let variable = self.body.checker.variable(&ast.name, &shape, kind, &[], &declared, storage);
        self.add(&ast.name, variable);
    }

    fn declare_variables(&mut self, section: &'a Section, ast: &'a ast::Variable) {
        if section.kind == SectionKind::Global {
            let message = "VAR_GLOBAL stands outside of units";
            let span = section.span;
            self.body.report(Diagnostic::error(Code::WrongSection, span, message));
            return;
        }
        let need = if section.kind == SectionKind::InOut { Need::Reference } else { Need::Size };
        // Every name has the same type; an error in it is told once.
        let declared = match self.body.generic_input(self.kind, section.kind, &ast.spec) {
            Some(generic) => generic,
            None => self.body.declared(ast, need),
        };
        for name in &ast.names {
            if let Some(first) = self.declared_before(name) {
                self.body.checker.report_duplicate(name, Some(first));
                continue;
            }
            let Some(declared) = &declared else {
                self.declare_broken(name);
                continue;
            };
            if section.kind == SectionKind::External {
                self.declare_external(name, declared.ty, section);
                continue;
            }
            let Some(storage) = self.declared_storage(section, ast, declared, name) else {
                self.declare_broken(name);
                continue;
            };
            self.note_starts(section, name, declared, storage);
            let (kind, qualifiers) = (section.kind, &section.qualifiers);
            let checker = &self.body.checker;
            let mut variable = checker.variable(name, ast, kind, qualifiers, declared, storage);
            if let Some(edge) = ast.edge {
                variable.edge = self.edge_detection(edge, &variable);
            }
            self.body.check_control(&variable);
            self.add(name, variable);
        }
    }

    /// Keeps what a start, or each call, does to a variable.
    fn note_starts(&mut self, section: &Section, name: &Ident, declared: &TypedImage<'a>, storage: Storage) {
        if declared.starts.is_empty() || section.kind == SectionKind::InOut {
            return;
        }
        if section.qualifiers.contains(&Qualifier::Constant) {
            self.body.require_constant(&declared.starts, OF_CONSTANTS);
        }
        if self.kind.keeps_nothing() && section.kind == SectionKind::Input {
            // An instance is always given, and begins as the one that is.
            if self.body.is_instance_type(declared.ty) {
                return;
            }
            return self.body.require_constant(&declared.starts, OF_INPUTS);
        }
        match storage {
            // Its unit starts it.
            Storage::Instance(_) if section.kind == SectionKind::Instance => {}
            Storage::Instance(offset) => self.starts.extend(moved(&declared.starts, offset)),
            Storage::Located(_) => self.body.require_constant(&declared.starts, OF_LOCATED),
            _ if section.kind == SectionKind::Static => self.body.checker.begin(storage, declared, name.span),
            _ => self.fleeting.push((name.key(), declared.starts.clone())),
        }
    }

    /// A name whose type is wrong is known all the same, so that its uses are not reported.
    fn declare_broken(&mut self, name: &Ident) {
        self.body.scope.by_name.insert(name.key(), usize::MAX);
    }

    pub(in crate::check) fn add(&mut self, name: &Ident, variable: Variable) {
        let variable = Variable { owner: self.body.pou, ..variable };
        self.body.scope.by_name.insert(name.key(), self.body.scope.variables.len());
        self.body.scope.variables.push(variable);
    }

    fn declared_storage(
        &mut self,
        section: &Section,
        ast: &ast::Variable,
        declared: &TypedImage<'_>,
        name: &Ident,
    ) -> Option<Storage> {
        if let Some(address) = &ast.address {
            self.body.checker.may_be_located(self.kind, section.kind, address)?;
            if let Placement::At(located) = self.body.checker.located(ast, declared)? {
                return Some(located);
            }
        }
        self.storage(section, declared, name)
    }

    /// `VAR_EXTERNAL` names a global variable of the same type (2nd ed. 2.4.3).
    fn declare_external(&mut self, name: &Ident, ty: TypeId, section: &Section) {
        let key = self.body.checker.global_key(&name.key());
        let known = key.is_some();
        if let Some(key) = &key {
            self.body.checker.note_global_use(self.body.pou, key, name.span);
        }
        let global = key.and_then(|key| self.body.checker.global(&key, Some(name.span)));
        let Some(mut variable) = global else {
            if !known {
                self.report_missing_global(name);
            }
            self.declare_broken(name);
            return;
        };
        if variable.ty != ty {
            let types = &self.body.checker.types;
            let (wanted, found) = (types.name(variable.ty), types.name(ty));
            let message = format!("`{}` is {wanted} in VAR_GLOBAL, {found} here", name.text);
            let found = Diagnostic::error(Code::ExternalWithoutGlobal, name.span, message);
            self.body.report(found.with_label(variable.span, "declared here"));
        }
        variable.is_constant |= section.qualifiers.contains(&Qualifier::Constant);
        variable.section = SectionKind::External;
        self.add(name, variable);
    }

    fn report_missing_global(&mut self, name: &Ident) {
        let globals = &self.body.checker.globals;
        let help = did_you_mean(&name.text, globals.values().map(|entry| entry.name.as_str()));
        let message = format!("no VAR_GLOBAL declares `{}`", name.text);
        let found = Diagnostic::error(Code::ExternalWithoutGlobal, name.span, message);
        self.body.report(found.with_optional_help(help));
    }
}
