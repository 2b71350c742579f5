//! Sections to placed variables; the interfaces of units (2nd ed. 2.4.3 and 2.5).

use std::collections::{BTreeMap, BTreeSet};

use super::Written;
use super::referred::referred;
use super::start::{OF_CONSTANTS, OF_LOCATED};
use crate::check::declare::{Declarations, Declared, Need, Placement, Scope, Start, Starts, TypedImage, moved};
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{ElementaryType, Place, PouId, Storage, TypeId, Variable};
use crate::syntax::ast::{self, Ident, PouKind, Qualifier, Section, SectionKind};

/// Pointers are offsets in memory.
pub(super) const POINTER: ElementaryType = ElementaryType::Udint;

const OF_INPUTS: &str = "an input that is not given has its value from before the program runs";

impl<'a> Written<'_, 'a> {
    /// Type and initial bytes of a declaration.
    pub(in crate::check) fn declared(&mut self, ast: &'a ast::Variable, need: Need) -> Option<TypedImage<'a>> {
        let declared = self.resolve(&ast.spec, need)?;
        match &ast.initial {
            Some(initial) => self.with_initial(&declared, initial),
            None => Some(declared),
        }
    }

    /// What `declared` is for one of its names, which may be a constant set from outside.
    pub(super) fn set_from_outside(
        &mut self,
        name: &Ident,
        ast: &'a ast::Variable,
        declared: TypedImage<'a>,
    ) -> Option<TypedImage<'a>> {
        let Some(initial) = self.declarations().set_from_outside(name) else { return Some(declared) };
        let bare = self.resolve(&ast.spec, Need::Size)?;
        self.with_initial(&bare, initial)
    }
}

/// The variables of a unit, and what its instances begin with.
pub(super) fn declared<'a>(declarations: &mut Declarations<'a>, id: PouId) -> Declared<'a> {
    let ast = declarations.pou(id).ast();
    let mut interface = Interface::new(declarations, id);
    interface.declare(ast);
    let Interface { written, align, image, starts, fleeting, kept, .. } = interface;
    Declared { scope: written.body.into_scope(), align, image, starts, fleeting, kept }
}

/// The value of a constant that a generic block is given: of the unit's variables it sees the constants.
pub(super) fn template_argument(declarations: &mut Declarations<'_>, id: PouId, argument: &ast::Expr) -> Option<i128> {
    let ast = declarations.pou(id).ast();
    let mut interface = Interface::new(declarations, id);
    let is_constant = |section: &&Section| section.qualifiers.contains(&Qualifier::Constant);
    for section in ast.sections.iter().filter(is_constant) {
        section.variables.iter().for_each(|variable| interface.declare_variables(section, variable));
    }
    let others = ast.sections.iter().filter(|section| !is_constant(section)).flat_map(|section| &section.variables);
    let is_variable = |name: &Ident| others.clone().flat_map(|each| &each.names).any(|each| each.key() == name.key());
    if let Some(name) = names_in(argument).into_iter().find(|name| is_variable(name)) {
        interface.report(Diagnostic::error(Code::NotConstant, name.span, "a constant is wanted here"));
        return None;
    }
    interface.written.body.constant_integer(argument)
}

/// The names that begin places in an expression.
fn names_in(expr: &ast::Expr) -> Vec<&Ident> {
    match &expr.kind {
        ast::ExprKind::Name(name) => vec![name],
        ast::ExprKind::Paren(inner) | ast::ExprKind::Unary(_, inner) => names_in(inner),
        ast::ExprKind::Binary(_, left, right) => [names_in(left), names_in(right)].concat(),
        _ => Vec::new(),
    }
}

/// A unit's variables while they are declared.
pub(in crate::check) struct Interface<'c, 'a> {
    written: Written<'c, 'a>,
    pub(super) kind: PouKind,
    pub(super) align: u32,
    /// Initial bytes of an instance so far.
    pub(super) image: Vec<u8>,
    /// What a start does to an instance so far.
    pub(super) starts: Vec<Start<'a>>,
    /// What a call does to variables that do not outlive it.
    pub(super) fleeting: Vec<(String, Starts<'a>)>,
    /// Where `VAR_INST` of its methods lie in an instance.
    pub(super) kept: BTreeMap<(u32, u32), u32>,
    /// Variables whose address the body takes.
    pub(super) referred: BTreeSet<String>,
}

impl<'c, 'a> Interface<'c, 'a> {
    pub(super) fn written(&mut self) -> &mut Written<'c, 'a> {
        &mut self.written
    }

    pub(super) fn declarations(&self) -> &Declarations<'a> {
        self.written.declarations()
    }

    pub(super) fn declarations_mut(&mut self) -> &mut Declarations<'a> {
        self.written.declarations_mut()
    }

    pub(super) fn scope(&self) -> &Scope {
        self.written.body.scope()
    }

    pub(super) fn scope_mut(&mut self) -> &mut Scope {
        self.written.body.scope_mut()
    }

    pub(super) fn unit(&self) -> Option<PouId> {
        self.written.body.unit()
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.written.report(diagnostic);
    }

    pub(in crate::check) fn new(declarations: &'c mut Declarations<'a>, id: PouId) -> Self {
        let ast = declarations.pou(id).ast();
        let (kind, referred) = (ast.kind, referred(ast));
        let written = Written::of_unit(declarations, id);
        let (starts, fleeting, kept) = (Vec::new(), Vec::new(), BTreeMap::new());
        Self { written, kind, align: 1, image: Vec::new(), starts, fleeting, kept, referred }
    }

    pub(in crate::check) fn declare(&mut self, ast: &'a ast::Pou) {
        if self.kind.keeps_nothing() {
            self.declare_this();
            self.inherit();
            self.declare_sections(ast, |kind| matches!(kind, SectionKind::Input | SectionKind::InOut));
            self.declare_new_value(ast);
            self.declare_sections(ast, |kind| kind == SectionKind::Output);
            self.scope_mut().end_parameters();
            self.declare_result(ast);
            let of_callers = [SectionKind::Input, SectionKind::InOut, SectionKind::Output];
            self.declare_sections(ast, |kind| !of_callers.contains(&kind));
            self.declare_views(ast);
        } else {
            // The first parameter is the instance's address.
            self.scope_mut().register(POINTER);
            self.scope_mut().end_parameters();
            self.inherit();
            self.declare_sections(ast, |_| true);
            self.declare_views(ast);
            self.declare_charts(ast);
            self.keep_for_methods(ast);
        }
    }

    fn declare_sections(&mut self, ast: &'a ast::Pou, accept: impl Fn(SectionKind) -> bool) {
        for section in ast.sections.iter().filter(|section| accept(section.kind)) {
            for variable in section.variables.iter().filter(|variable| variable.viewed().is_none()) {
                self.declare_variables(section, variable);
            }
        }
    }

    /// A view has memory of its own for one call, and is not a parameter whatever its section.
    fn declare_views(&mut self, ast: &'a ast::Pou) {
        let declared = ast.sections.iter().flat_map(|section| &section.variables);
        for view in declared.filter(|variable| variable.viewed().is_some()) {
            let declared = self.written.declared(view, Need::Size);
            for name in &view.names {
                if let Some(first) = self.declared_before(name) {
                    self.declarations_mut().report_duplicate(name, Some(first));
                    continue;
                }
                let placed = declared.clone().and_then(|declared| Some((self.temporary(&declared, name)?, declared)));
                let Some((storage, declared)) = placed else {
                    self.declare_broken(name);
                    continue;
                };
                let variable = self.declarations().variable(name, view, SectionKind::Temp, &[], &declared, storage);
                self.add(name, variable);
            }
        }
    }

    fn declare_result(&mut self, ast: &'a ast::Pou) {
        let Some(spec) = ast.result.as_ref().filter(|_| !self.is_setter()) else { return };
        if let Some(parameter) = self.declared_before(&ast.name) {
            self.declarations_mut().report_duplicate(&ast.name, Some(parameter));
            return;
        }
        let declared = self.written.resolve(spec, Need::Size);
        let placed = declared.and_then(|declared| Some((self.temporary(&declared, &ast.name)?, declared)));
        let Some((storage, declared)) = placed else { return self.declare_broken(&ast.name) };
        let span = ast.name.span;
        self.written.body.reject_open_array(declared.ty, spec.span);
        self.scope_mut().set_result(Place::whole(storage, declared.ty, span));
        let shape = ast::Variable { names: Vec::new(), address: None, spec: spec.clone(), edge: None, initial: None };
        let kind = SectionKind::Temp;
        let variable = self.declarations().variable(&ast.name, &shape, kind, &[], &declared, storage);
        self.add(&ast.name, variable);
    }

    fn declare_variables(&mut self, section: &'a Section, ast: &'a ast::Variable) {
        if section.kind == SectionKind::Global {
            let message = "VAR_GLOBAL stands outside of units";
            let span = section.span;
            self.report(Diagnostic::error(Code::WrongSection, span, message));
            return;
        }
        let kind = if self.is_own_in_out(section) { SectionKind::Output } else { section.kind };
        let need = if kind == SectionKind::InOut { Need::Reference } else { Need::Size };
        if !self.kind.has_instances() && section.kind != SectionKind::External {
            self.written.reject_bit(&ast.spec);
        }
        // Every name has the same type; an error in it is reported once.
        let declared = match self.written.generic_input(self.kind, section.kind, &ast.spec) {
            Some(generic) => generic,
            None => self.written.declared(ast, need),
        };
        for name in &ast.names {
            if let Some(first) = self.declared_before(name) {
                self.declarations_mut().report_duplicate(name, Some(first));
                continue;
            }
            let own = declared.clone().and_then(|declared| self.written.set_from_outside(name, ast, declared));
            let Some(declared) = &own else {
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
            let qualifiers = &section.qualifiers;
            let mut variable = self.declarations().variable(name, ast, kind, qualifiers, declared, storage);
            if let Some(edge) = ast.edge {
                variable.edge = self.edge_detection(edge, &variable);
            }
            self.written.check_control(&variable);
            self.add(name, variable);
        }
    }

    /// Keeps what a start, or each call, does to a variable.
    fn note_starts(&mut self, section: &Section, name: &Ident, declared: &TypedImage<'a>, storage: Storage) {
        if declared.starts.is_empty() || section.kind == SectionKind::InOut {
            return;
        }
        if section.qualifiers.contains(&Qualifier::Constant) {
            self.written.require_constant(&declared.starts, OF_CONSTANTS);
        }
        if self.kind.keeps_nothing() && section.kind == SectionKind::Input {
            // An instance is always given, and begins as the one that is.
            if self.written.body.is_instance_type(declared.ty) {
                return;
            }
            return self.written.require_constant(&declared.starts, OF_INPUTS);
        }
        match storage {
            // Its unit starts it.
            Storage::Instance(_) if section.kind == SectionKind::Instance => {}
            Storage::Instance(offset) => self.starts.extend(moved(&declared.starts, offset)),
            Storage::Located(_) => self.written.require_constant(&declared.starts, OF_LOCATED),
            _ if section.kind == SectionKind::Static => self.declarations_mut().begin(storage, declared, name.span),
            _ => self.fleeting.push((name.key(), declared.starts.clone())),
        }
    }

    /// A name whose type is wrong is known all the same, so that its uses are not reported.
    pub(super) fn declare_broken(&mut self, name: &Ident) {
        self.scope_mut().add_broken(name.key());
    }

    pub(in crate::check) fn add(&mut self, name: &Ident, variable: Variable) {
        let variable = Variable { owner: self.unit(), ..variable };
        self.scope_mut().add(name.key(), variable);
    }

    fn declared_storage(
        &mut self,
        section: &Section,
        ast: &ast::Variable,
        declared: &TypedImage<'_>,
        name: &Ident,
    ) -> Option<Storage> {
        if let Some(address) = &ast.address {
            let kind = self.kind;
            self.declarations_mut().may_be_located(kind, section.kind, address)?;
            if let Placement::At(located) = self.declarations_mut().located(ast, declared)? {
                return Some(located);
            }
        }
        self.storage(section, declared, name)
    }

    /// `VAR_EXTERNAL` names a global variable of the same type (2nd ed. 2.4.3).
    fn declare_external(&mut self, name: &Ident, ty: TypeId, section: &Section) {
        let key = self.declarations().global_key(&name.key());
        let known = key.is_some();
        if let Some(key) = &key {
            let unit = self.unit();
            self.declarations_mut().note_global_use(unit, key, name.span);
        }
        let global = key.and_then(|key| self.declarations_mut().global(&key, Some(name.span)));
        let Some(mut variable) = global else {
            if !known {
                self.report_missing_global(name);
            }
            self.declare_broken(name);
            return;
        };
        if variable.ty != ty {
            let types = self.declarations().types();
            let (wanted, found) = (types.name(variable.ty), types.name(ty));
            let message = format!("`{}` is {wanted} in VAR_GLOBAL, {found} here", name.text);
            let found = Diagnostic::error(Code::ExternalWithoutGlobal, name.span, message);
            self.report(found.with_label(variable.span, "declared here"));
        }
        variable.is_constant |= section.qualifiers.contains(&Qualifier::Constant);
        variable.section = SectionKind::External;
        self.add(name, variable);
    }

    fn report_missing_global(&mut self, name: &Ident) {
        let help = did_you_mean(&name.text, self.declarations().global_names());
        let message = format!("no VAR_GLOBAL declares `{}`", name.text);
        let found = Diagnostic::error(Code::ExternalWithoutGlobal, name.span, message);
        self.report(found.with_optional_help(help));
    }
}
