//! What the files declare, by name, before any of it is resolved.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::Checker;
use super::class::{Class, Membership, Role};
use super::configuration::Configured;
use super::layout::{INIT_RETAINS_NAME, INIT_RETAINS_OFFSET, Layout, VIRTUAL_TIME_NAME, VIRTUAL_TIME_OFFSET};
use super::namespace::Home;
use super::scope::Scope;
use super::start::{Stages, Starts};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::AddressUnit;
use crate::ir::{Areas, ElementaryType, PouId, Storage, TypeId, TypeTable, Variable, Visibility};
use crate::syntax::ast::{self, Ident, PouKind, Qualifier, SectionKind, TypeDeclaration};
use crate::syntax::{FileId, Span};

/// How far something has been resolved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Progress {
    Untouched,
    Running,
    Done,
}

/// A type together with the initial bytes of its variables, and what a start adds to them: an alias
/// may give its own.
#[derive(Debug, Clone)]
pub(super) struct TypedImage<'a> {
    pub(super) ty: TypeId,
    pub(super) image: Arc<[u8]>,
    pub(super) starts: Starts<'a>,
}

pub(super) struct TypeEntry<'a> {
    pub(super) ast: &'a TypeDeclaration,
    pub(super) home: Arc<Home>,
    pub(super) progress: Progress,
    /// The type of a structure as soon as something refers to it.
    pub(super) reserved: Option<TypeId>,
    pub(super) resolved: Option<TypedImage<'a>>,
}

pub(super) struct PouEntry<'a> {
    pub(super) ast: &'a ast::Pou,
    pub(super) home: Arc<Home>,
    /// Set for methods, properties and actions.
    pub(super) membership: Option<Membership>,
    pub(super) progress: Progress,
    /// Set by `declare`.
    pub(super) scope: Option<Arc<Scope>>,
    pub(super) align: u32,
    pub(super) image: Arc<[u8]>,
    /// What a start does to the variables of an instance.
    pub(super) starts: Starts<'a>,
    /// What a call does to variables that do not outlive it: their names, and what.
    pub(super) fleeting: Arc<[(String, Starts<'a>)]>,
    /// Where `VAR_INST` of its methods lie in an instance, by where they are declared.
    pub(super) kept: BTreeMap<(u32, u32), u32>,
}

impl PouEntry<'_> {
    /// Size, alignment and initial bytes of an instance.
    pub(super) fn instance(&self) -> (u32, u32, Arc<[u8]>) {
        (self.image.len() as u32, self.align, self.image.clone())
    }
}

pub(super) struct GlobalEntry<'a> {
    /// Nothing for what the runtime provides.
    pub(super) ast: Option<(&'a ast::Variable, &'a [Qualifier])>,
    pub(super) name: String,
    pub(super) seen_from: Arc<Home>,
    pub(super) span: Span,
    pub(super) progress: Progress,
    pub(super) variable: Option<Variable>,
    /// The resource that declares it.
    pub(super) home: Option<usize>,
}

/// A value of an enumeration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enumerator {
    pub(super) ty: TypeId,
    pub(super) value: i128,
}

impl<'a> Checker<'a> {
    pub(super) fn new(library: &'a BTreeSet<FileId>, stages: &'a Stages) -> Self {
        Self {
            library,
            stages,
            started: Vec::new(),
            faulty_starts: BTreeSet::new(),
            faulty_hooks: BTreeSet::new(),
            dialects: BTreeMap::new(),
            types: TypeTable::new(),
            type_names: BTreeMap::new(),
            pous: Vec::new(),
            pou_names: BTreeMap::new(),
            home: Arc::default(),
            namespaces: BTreeMap::new(),
            open_globals: BTreeMap::new(),
            classes: BTreeMap::new(),
            method_names: BTreeSet::new(),
            property_names: BTreeSet::new(),
            dynamic_calls: BTreeMap::new(),
            generics: BTreeMap::new(),
            rows: super::dispatch::Rows::default(),
            globals: BTreeMap::from([
                (VIRTUAL_TIME_NAME.to_owned(), provided(VIRTUAL_TIME_NAME, ElementaryType::Time, VIRTUAL_TIME_OFFSET)),
                (INIT_RETAINS_NAME.to_owned(), provided(INIT_RETAINS_NAME, ElementaryType::Bool, INIT_RETAINS_OFFSET)),
            ]),
            enumerators: BTreeMap::new(),
            layout: Layout::new(),
            areas: Areas::default(),
            address_unit: AddressUnit::default(),
            located: Vec::new(),
            literals: BTreeMap::new(),
            placed: Vec::new(),
            programs: Vec::new(),
            configured: Configured::default(),
            checked: BTreeMap::new(),
            queue: Vec::new(),
            queued: BTreeSet::new(),
            calls: BTreeMap::new(),
            depth: 0,
            chart_parts: Vec::new(),
            diagnostics: Vec::new(),
        }
    }

    pub(super) fn collect_pou(&mut self, ast: &'a ast::Pou) {
        // The library comes last: what it finds taken, the user has named like the standard.
        if self.library.contains(&ast.name.span.file)
            && let Some(user) = self.declared_at(&ast.name)
        {
            // Functions of the 3rd edition are younger than many programs, whose own go before.
            if ast.kind != ast::PouKind::Function {
                self.report_reserved(&ast.name, user);
            }
            return;
        }
        if self.is_taken(&ast.name) {
            return;
        }
        let id = self.add_pou(ast, None);
        self.pou_names.insert(self.home.key(&ast.name), id);
        let mut class = Class::default();
        for member in &ast.object.members {
            let role = member.kind.into();
            let found = self.add_pou(&member.pou, Some(Membership { owner: id, role }));
            let name = &member.pou.name;
            if let Some(first) = class.members.insert((role, name.key()), found) {
                let first = self.pou(first).ast.name.span;
                self.report_duplicate(name, Some(first));
            }
            match role {
                Role::Getter | Role::Setter => self.property_names.insert(name.key()),
                Role::Method | Role::Body | Role::Start | Role::End => self.method_names.insert(name.key()),
            };
        }
        if ast.kind != PouKind::Function {
            self.classes.insert(id, class);
            self.collect_stages(id);
        }
    }

    pub(super) fn add_pou(&mut self, ast: &'a ast::Pou, membership: Option<Membership>) -> PouId {
        let id = PouId(self.pous.len() as u32);
        let (home, progress) = (self.home.with(&ast.object.using), Progress::Untouched);
        let image = Arc::from([]);
        let (starts, fleeting) = (Starts::default(), Arc::default());
        self.pous.push(PouEntry {
            ast,
            home,
            membership,
            progress,
            scope: None,
            align: 1,
            image,
            starts,
            fleeting,
            kept: BTreeMap::new(),
        });
        id
    }

    pub(super) fn collect_type(&mut self, ast: &'a TypeDeclaration) {
        // The library comes last. What it declares of vendors many projects declare for themselves.
        if self.library.contains(&ast.name.span.file) && self.declared_at(&ast.name).is_some() {
            return;
        }
        if !self.is_taken(&ast.name) {
            let (home, progress) = (self.home.clone(), Progress::Untouched);
            let entry = TypeEntry { ast, home, progress, reserved: None, resolved: None };
            self.type_names.insert(self.home.key(&ast.name), entry);
        }
    }

    pub(super) fn collect_globals(&mut self, section: &'a ast::Section) {
        for variable in &section.variables {
            for name in &variable.names {
                let key = self.home.key(name);
                if let Some(first) = self.globals.get(&key) {
                    let first = first.ast.map(|_| first.span);
                    self.report_duplicate(name, first);
                    continue;
                }
                let entry = GlobalEntry {
                    ast: Some((variable, &section.qualifiers)),
                    name: name.text.clone(),
                    seen_from: self.home.clone(),
                    span: name.span,
                    progress: Progress::Untouched,
                    variable: None,
                    home: None,
                };
                if self.home.open {
                    self.open_globals.entry(name.key()).or_insert_with(|| key.clone());
                }
                self.globals.insert(key, entry);
            }
        }
    }

    /// True, with a report, if a type or unit of the name exists already.
    fn is_taken(&mut self, name: &Ident) -> bool {
        if ElementaryType::find(&name.text).is_some()
            || matches!(name.key().as_str(), "STRING" | "WSTRING")
            || super::standard_function::is_reserved(&name.key())
        {
            self.report_reserved(name, name.span);
            return true;
        }
        let first = self.declared_at(name);
        if first.is_some() {
            self.report_duplicate(name, first);
        }
        first.is_some()
    }

    /// Where a unit or type of the name is declared.
    fn declared_at(&self, name: &Ident) -> Option<Span> {
        let key = self.home.key(name);
        let pou = self.pou_names.get(&key).map(|id| self.pou(*id).ast.name.span);
        pou.or_else(|| self.type_names.get(&key).map(|ty| ty.ast.name.span))
    }

    fn report_reserved(&mut self, name: &Ident, span: Span) {
        let message = format!("`{}` is a name of the standard", name.text);
        self.report(Diagnostic::error(Code::ReservedName, span, message));
    }

    pub(super) fn report_duplicate(&mut self, name: &Ident, first: Option<Span>) {
        let message = format!("`{}` is declared twice", name.text);
        let mut found = Diagnostic::error(Code::DuplicateName, name.span, message);
        if let Some(first) = first {
            found = found.with_label(first, "first declared here");
        }
        self.report(found);
    }
}

/// What the runtime provides.
fn provided(name: &str, ty: ElementaryType, offset: u32) -> GlobalEntry<'static> {
    let span = Span::new(FileId(u32::MAX), 0, 0);
    let variable = Variable {
        name: name.to_owned(),
        section: SectionKind::Global,
        ty: ty.into(),
        storage: Storage::Absolute(offset),
        constant: None,
        is_constant: true,
        retention: None,
        address: None,
        span,
        image: vec![0; ty.size() as usize].into(),
        edge: None,
        of_chart: false,
        visibility: Visibility::Public,
        owner: None,
    };
    let name = name.to_owned();
    let (seen_from, home) = (Arc::default(), None);
    let (progress, variable) = (Progress::Done, Some(variable));
    GlobalEntry { ast: None, name, seen_from, span, progress, variable, home }
}
