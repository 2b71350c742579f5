//! Object orientation (3rd ed. 6.6.5 to 6.6.8) and namespaces (3rd ed. 6.9).

use super::{Declaration, Ident, Pou};

/// What may stand before the name of a unit or method (3rd ed. 6.6.5.4, 6.6.5.10).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Modifier {
    /// `PUBLIC`: used from everywhere.
    Public,
    /// `PROTECTED`: used by the unit and what is derived from it.
    Protected,
    /// `PRIVATE`: used by the unit alone.
    Private,
    /// `INTERNAL`: used inside of the namespace.
    Internal,
    /// `ABSTRACT`: to be given by what is derived.
    Abstract,
    /// `FINAL`: not to be derived or overridden.
    Final,
    /// `OVERRIDE`: replaces a method of the base.
    Override,
}

impl Modifier {
    pub const ALL: [Self; 7] =
        [Self::Public, Self::Protected, Self::Private, Self::Internal, Self::Abstract, Self::Final, Self::Override];

    /// The modifier that `text` spells in any case.
    pub fn find(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|each| each.text().eq_ignore_ascii_case(text))
    }

    /// Its spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::Public => "PUBLIC",
            Self::Protected => "PROTECTED",
            Self::Private => "PRIVATE",
            Self::Internal => "INTERNAL",
            Self::Abstract => "ABSTRACT",
            Self::Final => "FINAL",
            Self::Override => "OVERRIDE",
        }
    }
}

/// What of a unit is object orientation.
#[derive(Debug, Clone, Default)]
pub struct Object {
    /// What stands before its name.
    pub modifiers: Vec<Modifier>,
    /// `EXTENDS`: one unit, or any number of interfaces.
    pub extends: Vec<Ident>,
    pub implements: Vec<Ident>,
    /// `USING` of this unit alone.
    pub using: Vec<Ident>,
    /// Its methods, properties and actions.
    pub members: Vec<Member>,
    /// True behind `{attribute 'call_after_init'}`, of a block and of its method that runs then.
    pub call_after_init: bool,
    /// True for an organization block that runs once at a start, as OB100 of S7.
    pub runs_at_start: bool,
}

/// What a member is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MemberKind {
    /// `METHOD` (3rd ed. 6.6.5.4)
    Method,
    /// `GET` of a `PROPERTY`, which vendors have: its result is the property's type.
    Getter,
    /// `SET` of a `PROPERTY`: the property's type, given as `result`, is that of the new value.
    Setter,
    /// `ACTION` (2nd ed. 2.6.4.1, as vendors call it by name).
    Action,
}

/// A method, one half of a property, or an action.
#[derive(Debug, Clone)]
pub struct Member {
    pub kind: MemberKind,
    /// Its name, variables and statements.
    pub pou: Pou,
}

/// Who sees the names of a namespace without its own name before them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NamespaceKind {
    Plain,
    /// `NAMESPACE INTERNAL` (3rd ed. 6.9.3)
    Internal,
    /// `NAMESPACE OPEN`, a vendor's list of global variables: its names are known without it, too.
    Open,
}

/// `NAMESPACE a.b .. END_NAMESPACE`
#[derive(Debug, Clone)]
pub struct Namespace {
    /// Who sees its names.
    pub kind: NamespaceKind,
    /// Its name, with dots.
    pub name: Ident,
    /// `USING` inside of it.
    pub using: Vec<Ident>,
    pub declarations: Vec<Declaration>,
    /// True behind `{external}`: the name of a library, whose declarations may stand outside of it.
    pub external: bool,
}
