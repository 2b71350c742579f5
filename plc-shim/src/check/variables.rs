//! Sections to placed variables; the interfaces of units (2nd ed. 2.4.3 and 2.5).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::Checker;
use super::initial::moved;
use super::instance::visibility;
use super::layout::align_up;
use super::located::Placement;
use super::names::{Progress, TypedImage};
use super::overrides::Overrides;
use super::referred::referred;
use super::scope::{Body, Scope};
use super::start::{Start, Started, Starts};
use super::types::Need;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{ElementaryType, Place, PouId, Retention, Storage, TypeId, Value, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, Qualifier, Section, SectionKind};

/// Pointers are offsets in memory.
pub(super) const POINTER: ElementaryType = ElementaryType::Udint;

impl<'a> Checker<'a> {
    /// Keeps what a start does to a variable at a fixed place.
    fn begin(&mut self, storage: Storage, declared: &TypedImage<'a>, span: Span) {
        if !declared.starts.is_empty() {
            let place = Place::whole(storage, declared.ty, span);
            self.started.push(Started { place, starts: declared.starts.clone() });
        }
    }

    /// A global variable, placed in memory; `used` is where it is needed.
    pub(super) fn global(&mut self, key: &str, used: Option<Span>) -> Option<Variable> {
        if self.globals.get(key)?.progress == Progress::Untouched
            && let Some(found) = self.alternative_global(key, used)
        {
            return Some(found);
        }
        let entry = self.globals.get_mut(key)?;
        let (progress, span) = (entry.progress, entry.span);
        if progress == Progress::Done {
            return entry.variable.clone();
        }
        let (ast, qualifiers) = entry.ast?;
        if progress == Progress::Running {
            let message = "the initial value of a variable needs the variable itself";
            self.report(Diagnostic::error(Code::Recursion, used.unwrap_or(span), message));
            return None;
        }
        entry.progress = Progress::Running;
        let home = entry.seen_from.clone();
        let name = ast.names.iter().find(|name| name.span == span);
        let place = |checker: &mut Self| checker.deeper(span, |checker| checker.place_global(name?, ast, qualifiers));
        let variable = self.at_home(home, place);
        if let Some(entry) = self.globals.get_mut(key) {
            entry.progress = Progress::Done;
            entry.variable.clone_from(&variable);
        }
        variable
    }

    fn place_global(&mut self, name: &Ident, ast: &'a ast::Variable, qualifiers: &[Qualifier]) -> Option<Variable> {
        let mut body = Body::outside(self);
        let declared = body.declared(ast, Need::Size)?;
        let declared = body.set_from_outside(name, ast, declared)?;
        body.reject_open_array(declared.ty, name.span)?;
        if qualifiers.contains(&Qualifier::Constant) {
            body.require_constant(&declared.starts, OF_CONSTANTS);
        }
        let storage = match self.located(ast, &declared)? {
            Placement::At(storage) => {
                Body::outside(self).require_constant(&declared.starts, OF_LOCATED);
                storage
            }
            Placement::Free => {
                let (size, align) = (self.types.size(declared.ty), self.types.align(declared.ty));
                let offset = self.allocate(size, align, name.span)?;
                self.placed.push((offset, declared.image.clone()));
                self.begin(Storage::Absolute(offset), &declared, name.span);
                Storage::Absolute(offset)
            }
        };
        let variable = self.variable(name, ast, SectionKind::Global, qualifiers, &declared, storage);
        Some(Variable { name: self.home.full_name(name), ..variable })
    }

    pub(super) fn variable(
        &self,
        name: &Ident,
        ast: &ast::Variable,
        section: SectionKind,
        qualifiers: &[Qualifier],
        declared: &TypedImage<'_>,
        storage: Storage,
    ) -> Variable {
        let is_constant = qualifiers.contains(&Qualifier::Constant);
        let elementary = self.types.elementary(declared.ty);
        Variable {
            name: name.text.clone(),
            section,
            ty: declared.ty,
            storage,
            constant: elementary.filter(|_| is_constant).map(|ty| decode(ty, &declared.image)),
            is_constant,
            retention: Retention::of(qualifiers),
            address: ast.address.as_ref().map(|address| address.text.clone()),
            span: name.span,
            image: declared.image.clone(),
            edge: None,
            of_chart: false,
            visibility: visibility(section, qualifiers),
            owner: None,
        }
    }

    /// Resolves a unit's variables and, for what has instances, their layout. Nothing, with a
    /// report, if the unit contains itself.
    pub(super) fn declare(&mut self, id: PouId, used: Option<Span>) -> Option<()> {
        let index = id.0 as usize;
        let ast = self.pou(id).ast;
        match self.pous[index].progress {
            Progress::Done => return Some(()),
            Progress::Running => {
                let message = format!("`{}` contains itself", ast.name.text);
                let span = used.unwrap_or(ast.name.span);
                self.report(Diagnostic::error(Code::Recursion, span, message));
                return None;
            }
            Progress::Untouched => self.pous[index].progress = Progress::Running,
        }
        let home = self.pou(id).home.clone();
        let declared = self.at_home(home, |checker| {
            checker.deeper(ast.name.span, |checker| {
                let mut interface = Interface::new(checker, id);
                interface.declare(ast);
                Some(Declared {
                    scope: interface.body.scope,
                    align: interface.align,
                    image: interface.image,
                    starts: interface.starts,
                    fleeting: interface.fleeting,
                    kept: interface.kept,
                })
            })
        });
        let Declared { scope, align, mut image, starts, fleeting, kept } = declared.unwrap_or_default();
        // At least a byte, as for structures.
        image.resize(align_up(image.len().max(1) as u32, align) as usize, 0);
        let (align, image): (u32, Arc<[u8]>) = (align.max(1), image.into());
        if ast.kind.has_instances() {
            let ty = self.types.block(&ast.name.text, id);
            self.types.complete_block(ty, align, image.clone());
        }
        let mut scope = scope;
        self.add_vendor_names(id, &mut scope);
        let entry = &mut self.pous[index];
        entry.scope = Some(Arc::new(scope));
        entry.align = align;
        entry.image = image;
        (entry.starts, entry.fleeting, entry.kept) = (starts.into(), fleeting.into(), kept);
        entry.progress = Progress::Done;
        Some(())
    }

    /// The interface of a unit that is not being declared right now.
    pub(super) fn interface(&mut self, id: PouId, used: Span) -> Option<Arc<Scope>> {
        self.declare(id, Some(used))?;
        self.pou(id).scope.clone()
    }
}

/// A unit's variables as they have been declared.
#[derive(Default)]
struct Declared<'a> {
    scope: Scope,
    align: u32,
    image: Vec<u8>,
    starts: Vec<Start<'a>>,
    fleeting: Vec<(String, Starts<'a>)>,
    kept: BTreeMap<(u32, u32), u32>,
}

const OF_CONSTANTS: &str = "a CONSTANT is one before the program runs";
const OF_LOCATED: &str = "a variable with a direct address begins with its bytes";
const OF_INPUTS: &str = "an input that is not given has its value from before the program runs";

/// The value that an elementary variable's bytes stand for.
pub(super) fn decode(ty: ElementaryType, image: &[u8]) -> Value {
    let mut bytes = [0; 8];
    for (target, source) in bytes.iter_mut().zip(image) {
        *target = *source;
    }
    let raw = u64::from_le_bytes(bytes);
    match ty {
        ElementaryType::Bool => Value::Bool(raw != 0),
        ElementaryType::Real => Value::Real(f32::from_bits(raw as u32)),
        ElementaryType::Lreal => Value::Lreal(f64::from_bits(raw)),
        _ => Value::Int(ty.wrap(i128::from(raw))),
    }
}

impl<'a> Body<'_, 'a> {
    /// Type and initial bytes of a declaration.
    pub(super) fn declared(&mut self, ast: &'a ast::Variable, need: Need) -> Option<TypedImage<'a>> {
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
        let overrides: &'a Overrides = self.checker.overrides;
        let Some(initial) = overrides.get(name) else { return Some(declared) };
        let bare = self.resolve(&ast.spec, Need::Size)?;
        self.with_initial(&bare, initial)
    }
}

/// A unit's variables while they are declared.
pub(super) struct Interface<'c, 'a> {
    pub(super) body: Body<'c, 'a>,
    pub(super) kind: PouKind,
    pub(super) align: u32,
    /// Initial bytes of an instance so far.
    pub(super) image: Vec<u8>,
    /// What a start does to an instance so far.
    pub(super) starts: Vec<Start<'a>>,
    /// What a call does to variables that do not outlive it.
    fleeting: Vec<(String, Starts<'a>)>,
    /// Where `VAR_INST` of its methods lie in an instance.
    pub(super) kept: BTreeMap<(u32, u32), u32>,
    /// Variables whose address the body takes.
    pub(super) referred: BTreeSet<String>,
}

impl<'c, 'a> Interface<'c, 'a> {
    fn new(checker: &'c mut Checker<'a>, id: PouId) -> Self {
        let ast = checker.pou(id).ast;
        let (kind, referred) = (ast.kind, referred(ast));
        let body = Body::new(checker, Scope::default(), Some(id));
        let (starts, fleeting, kept) = (Vec::new(), Vec::new(), BTreeMap::new());
        Self { body, kind, align: 1, image: Vec::new(), starts, fleeting, kept, referred }
    }

    fn declare(&mut self, ast: &'a ast::Pou) {
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
            let own = declared.clone().and_then(|declared| self.body.set_from_outside(name, ast, declared));
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

    pub(super) fn add(&mut self, name: &Ident, variable: Variable) {
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
