//! What is kept of a type, a unit, a global variable: its text, and what it has been resolved to.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::class::Membership;
use super::kept::place_of;
use super::namespace::Home;
use super::scope::Scope;
use super::start::{Start, Starts};
use crate::ir::{ElementaryType, Storage, TypeId, Variable, Visibility};
use crate::syntax::ast::{self, Qualifier, SectionKind, TypeDeclaration};
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
pub(in crate::check) struct TypedImage<'a> {
    pub(in crate::check) ty: TypeId,
    pub(in crate::check) image: Arc<[u8]>,
    pub(in crate::check) starts: Starts<'a>,
}

impl TypedImage<'_> {
    /// An initial value that bytes alone make.
    pub(in crate::check) fn plain(ty: TypeId, image: Arc<[u8]>) -> Self {
        Self { ty, image, starts: Arc::default() }
    }
}

pub(super) struct TypeEntry<'a> {
    pub(super) ast: &'a TypeDeclaration,
    pub(super) home: Arc<Home>,
    pub(super) progress: Progress,
    /// The type of a structure as soon as something refers to it.
    pub(super) reserved: Option<TypeId>,
    pub(super) resolved: Option<TypedImage<'a>>,
}

pub(in crate::check) struct PouEntry<'a> {
    pub(super) ast: &'a ast::Pou,
    pub(super) home: Arc<Home>,
    /// Set for methods, properties and actions.
    pub(super) membership: Option<Membership>,
    pub(super) progress: Progress,
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

impl<'a> PouEntry<'a> {
    pub(in crate::check) fn ast(&self) -> &'a ast::Pou {
        self.ast
    }

    /// From where names are seen in it.
    pub(in crate::check) fn home(&self) -> &Arc<Home> {
        &self.home
    }

    /// What it is a method, property or action of.
    pub(in crate::check) fn membership(&self) -> Option<Membership> {
        self.membership
    }

    /// Its variables, if it has been declared.
    pub(in crate::check) fn scope(&self) -> Option<&Arc<Scope>> {
        self.scope.as_ref()
    }

    /// What a start does to the variables of an instance.
    pub(in crate::check) fn starts(&self) -> &Starts<'a> {
        &self.starts
    }

    /// What a call does to variables that do not outlive it: their names, and what.
    pub(in crate::check) fn fleeting(&self) -> &Arc<[(String, Starts<'a>)]> {
        &self.fleeting
    }

    /// Where a `VAR_INST` of its methods lies in an instance; nothing if its declaration is wrong.
    pub(in crate::check) fn kept(&self, declared: Span) -> Option<u32> {
        self.kept.get(&place_of(declared)).copied()
    }

    /// Size, alignment and initial bytes of an instance.
    pub(in crate::check) fn instance(&self) -> (u32, u32, Arc<[u8]>) {
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
pub(in crate::check) struct Enumerator {
    pub(in crate::check) ty: TypeId,
    pub(in crate::check) value: i128,
    pub(in crate::check) rank: Rank,
}

/// Which of several values of one name the name alone stands for: the first of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::check) enum Rank {
    User,
    Library,
    /// It should be known behind its type's name only, as `{attribute 'qualified_only'}` says.
    Qualified,
}

/// What the runtime provides.
pub(super) fn provided(name: &str, ty: ElementaryType, offset: u32) -> GlobalEntry<'static> {
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
