//! Classes, function blocks and interfaces with their bases and members (3rd ed. 6.6.5 to 6.6.7).

use std::collections::{BTreeMap, BTreeSet};

use super::Declarations;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::PouId;
use crate::syntax::Span;
use crate::syntax::ast::{Ident, MemberKind, Modifier, PouKind};

/// What of an instance is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::check) enum Role {
    /// The function block's own statements.
    Body,
    /// A method or action.
    Method,
    Getter,
    Setter,
    /// What the unit's variables do before the first scan.
    Start,
    /// What they do once all variables have their first values.
    AfterStart,
    /// What they do before another start.
    End,
}

impl From<MemberKind> for Role {
    fn from(kind: MemberKind) -> Self {
        match kind {
            MemberKind::Method | MemberKind::Action => Self::Method,
            MemberKind::Getter => Self::Getter,
            MemberKind::Setter => Self::Setter,
        }
    }
}

/// When a unit's variables are gone through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::check) enum Occasion {
    /// Before the first scan after a start.
    Start,
    /// Then, once all variables of the application have their first values.
    AfterStart,
    End,
}

impl Occasion {
    pub(super) const ALL: [Self; 3] = [Self::Start, Self::AfterStart, Self::End];

    pub(super) fn role(self) -> Role {
        match self {
            Self::Start => Role::Start,
            Self::AfterStart => Role::AfterStart,
            Self::End => Role::End,
        }
    }
}

/// What stands around a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) struct Membership {
    pub(in crate::check) owner: PouId,
    pub(in crate::check) role: Role,
}

/// A unit with members, or one that is derived or derived from.
#[derive(Debug, Default)]
pub(in crate::check) struct Class {
    pub(in crate::check) base: Option<PouId>,
    /// It extends what is not there, or not what it may extend.
    pub(super) lacks_base: bool,
    /// It implements such a thing.
    pub(super) lacks_interface: bool,
    /// `IMPLEMENTS`, and `EXTENDS` of an interface.
    pub(in crate::check) interfaces: Vec<PouId>,
    pub(in crate::check) members: BTreeMap<(Role, String), PouId>,
    derived: Vec<PouId>,
    pub(in crate::check) stages: BTreeMap<Occasion, PouId>,
    /// The number that an instance begins with, if it can be taken for one of another type.
    pub(in crate::check) type_id: Option<u32>,
}

impl Declarations<'_> {
    pub(in crate::check) fn class(&self, id: PouId) -> Option<&Class> {
        self.classes.get(&id)
    }

    pub(in crate::check) fn base_of(&self, id: PouId) -> Option<PouId> {
        self.class(id)?.base
    }

    /// A unit and its bases, each behind what extends it.
    pub(super) fn with_bases(&self, id: PouId) -> impl Iterator<Item = PouId> {
        std::iter::successors(Some(id), |id| self.base_of(*id))
    }

    /// The unit whose variables a unit sees: its own, or those of what it is a method of.
    pub(in crate::check) fn owner_of(&self, id: PouId) -> PouId {
        self.pou(id).membership.map_or(id, |membership| membership.owner)
    }

    /// Finds the bases and interfaces of all units, and numbers the types.
    pub(in crate::check) fn link_classes(&mut self) {
        for index in 0..self.pous.len() {
            let id = PouId(index as u32);
            let home = self.pou(id).home.clone();
            self.at_home(home, |declarations| declarations.link(id));
        }
        self.break_circles();
        let links: Vec<_> = self.classes.iter().filter_map(|(id, class)| Some((*id, class.base?))).collect();
        for (id, base) in links {
            self.classes.entry(base).or_default().derived.push(id);
        }
        self.number_types();
    }

    fn link(&mut self, id: PouId) {
        let ast = self.pou(id).ast;
        let (kind, object) = (ast.kind, &ast.object);
        if object.extends.is_empty() && object.implements.is_empty() || self.lacks_constants(id) {
            return;
        }
        if kind != PouKind::Interface
            && let [_, second, ..] = object.extends.as_slice()
        {
            let message = "only an interface extends more than one";
            self.report(Diagnostic::error(Code::WrongBase, second.span, message));
        }
        let wanted = |found: PouKind| found == kind || kind == PouKind::FunctionBlock && found == PouKind::Class;
        if kind == PouKind::Interface {
            for name in &object.extends {
                let found = self.base_named(id, name, |found| found == PouKind::Interface, "an interface");
                let class = self.classes.entry(id).or_default();
                class.lacks_base |= found.is_none();
                class.interfaces.extend(found);
            }
        } else if let Some(name) = object.extends.first() {
            let what = if kind == PouKind::Class { "a class" } else { "a function block or class" };
            let base = self.base_named(id, name, |found| found.has_instances() && wanted(found), what);
            let base = base.filter(|base| self.may_be_extended(*base, name));
            let class = self.classes.entry(id).or_default();
            (class.base, class.lacks_base) = (base, base.is_none());
        }
        for name in &object.implements {
            let found = self.base_named(id, name, |found| found == PouKind::Interface, "an interface");
            let class = self.classes.entry(id).or_default();
            class.lacks_interface |= found.is_none();
            class.interfaces.extend(found);
        }
    }

    fn may_be_extended(&mut self, base: PouId, name: &Ident) -> bool {
        if self.pou(base).ast.object.modifiers.contains(&Modifier::Final) {
            let message = format!("`{}` is FINAL and cannot be extended", name.text);
            self.report(Diagnostic::error(Code::Finality, name.span, message));
        }
        true
    }

    fn base_named(&mut self, unit: PouId, name: &Ident, accept: impl Fn(PouKind) -> bool, what: &str) -> Option<PouId> {
        let Some(id) = self.unit_meant(Some(unit), name) else {
            if self.is_wrong_template(name) {
                return None;
            }
            let known = self.pous.iter().filter(|pou| pou.membership.is_none() && accept(pou.ast.kind));
            let help = did_you_mean(&name.text, known.map(|pou| pou.ast.name.text.as_str()));
            let message = format!("{what} is wanted, and `{}` is not declared", name.text);
            let found = Diagnostic::error(Code::WrongBase, name.span, message);
            self.report(found.with_optional_help(help));
            return None;
        };
        self.check_internal(id, name.span);
        if accept(self.pou(id).ast.kind) {
            return Some(id);
        }
        let message = format!("`{}` is not {what}", name.text);
        self.report(Diagnostic::error(Code::WrongBase, name.span, message));
        None
    }

    /// What extends itself is reported, and then extends nothing.
    fn break_circles(&mut self) {
        let ids: Vec<PouId> = self.classes.keys().copied().collect();
        for id in ids {
            if self.ancestors(id).contains(&id) {
                let name = &self.pou(id).ast.name;
                let message = format!("`{}` extends itself", name.text);
                let span = name.span;
                self.report(Diagnostic::error(Code::Recursion, span, message));
                if let Some(class) = self.classes.get_mut(&id) {
                    (class.base, class.lacks_base) = (None, true);
                    class.interfaces.clear();
                }
            }
        }
    }

    /// All bases and interfaces of a unit, itself left out unless it extends itself.
    pub(super) fn ancestors(&self, id: PouId) -> BTreeSet<PouId> {
        let mut found = BTreeSet::new();
        let mut open = vec![id];
        while let Some(class) = open.pop().and_then(|next| self.class(next)) {
            for above in class.base.iter().chain(&class.interfaces) {
                if found.insert(*above) {
                    open.push(*above);
                }
            }
            // What has no entry has nothing above it.
            open.retain(|next| self.classes.contains_key(next));
        }
        found
    }

    /// True if every `derived` is a `base` too, or may be for all that is known.
    pub(in crate::check) fn is_a(&self, derived: PouId, base: PouId) -> bool {
        self.is_known_as(derived, base) || self.may_be_more(derived)
    }

    fn is_known_as(&self, derived: PouId, base: PouId) -> bool {
        derived == base || self.ancestors(derived).contains(&base)
    }

    /// How many steps an ancestor is away: 0 for the unit itself.
    pub(in crate::check) fn generations(&self, derived: PouId, base: PouId) -> u32 {
        let behind = |id: PouId| self.ancestors(id).len() as u32;
        if derived == base { 0 } else { behind(derived).saturating_sub(behind(base)).max(1) }
    }

    /// Numbers what can be taken for something else; what is derived from a unit comes behind it.
    fn number_types(&mut self) {
        let ids: Vec<PouId> = self.classes.keys().copied().collect();
        let mut next = 1;
        for root in ids {
            if !self.pou(root).ast.kind.has_instances() || self.base_of(root).is_some() {
                continue;
            }
            let family = self.family(root);
            let several = family.len() > 1;
            if several || family.iter().any(|id| self.class(*id).is_some_and(|class| !class.interfaces.is_empty())) {
                // Depth first, so that all that is derived from a unit has neighbouring numbers: one range to test for.
                for id in &family {
                    if let Some(class) = self.classes.get_mut(id) {
                        class.type_id = Some(next);
                    }
                    next += 1;
                }
            }
        }
    }

    /// A unit and all that is derived from it, each behind its base.
    fn family(&self, root: PouId) -> Vec<PouId> {
        let mut found = Vec::new();
        let mut open = vec![root];
        while let Some(id) = open.pop() {
            found.push(id);
            if let Some(class) = self.class(id) {
                open.extend(class.derived.iter().rev());
            }
        }
        found
    }

    /// All units with instances that can stand where a `kind` is wanted.
    pub(in crate::check) fn variants(&self, id: PouId) -> Vec<PouId> {
        if self.pou(id).ast.kind != PouKind::Interface {
            return self.family(id);
        }
        let ids = self.classes.keys().copied();
        ids.filter(|each| self.pou(*each).ast.kind.has_instances() && self.is_known_as(*each, id)).collect()
    }

    /// Numbers of the types that can stand where a `kind` is wanted, neighbours joined.
    pub(in crate::check) fn type_ranges(&self, id: PouId) -> Vec<(u32, u32)> {
        let variants = self.variants(id);
        let numbers: BTreeSet<u32> = variants.iter().filter_map(|variant| self.class(*variant)?.type_id).collect();
        let mut ranges: Vec<(u32, u32)> = Vec::new();
        for number in numbers {
            match ranges.last_mut() {
                Some((_, last)) if *last + 1 == number => *last = number,
                _ => ranges.push((number, number)),
            }
        }
        ranges
    }

    /// The member of a unit, its own or that of the nearest base.
    pub(in crate::check) fn find_member(&self, id: PouId, role: Role, name: &str) -> Option<PouId> {
        if role == Role::Body {
            return Some(id);
        }
        let key = (role, name.to_ascii_uppercase());
        let mut next = Some(id);
        while let Some(class) = next.and_then(|id| self.class(id)) {
            if let Some(found) = class.members.get(&key) {
                return Some(*found);
            }
            next = class.base;
        }
        // Of an interface, and of an abstract class that leaves a method to others.
        let above = self.ancestors(id);
        above.iter().find_map(|each| self.class(*each)?.members.get(&key).copied())
    }

    /// True if the unit has a member of the name, with whatever parameters.
    pub(in crate::check) fn has_member(&self, id: PouId, role: Role, name: &str) -> bool {
        match role {
            Role::Method => !self.methods_named(id, name).is_empty(),
            _ => self.find_member(id, role, name).is_some(),
        }
    }

    /// The names of all members of a unit.
    pub(in crate::check) fn member_names(&self, id: PouId) -> Vec<String> {
        let mut all = self.ancestors(id);
        all.insert(id);
        let classes = all.iter().filter_map(|each| self.class(*each));
        let members = classes.flat_map(|class| class.members.values());
        members.map(|member| self.pou(*member).ast.name.text.clone()).collect()
    }

    pub(super) fn is_abstract(&self, id: PouId) -> bool {
        self.pou(id).ast.object.modifiers.contains(&Modifier::Abstract)
    }

    /// True for a method that has no statements: a prototype, or one that is `ABSTRACT`.
    pub(in crate::check) fn is_prototype(&self, id: PouId) -> bool {
        let of_interface = self.pou(self.owner_of(id)).ast.kind == PouKind::Interface;
        self.pou(id).membership.is_some() && (of_interface || self.is_abstract(id))
    }

    /// Reports an instance of what only others can be derived from (3rd ed. 6.6.5.8).
    pub(in crate::check) fn check_instance(&mut self, id: PouId, span: Span) {
        if self.is_abstract(id) {
            let message = format!("`{}` is ABSTRACT and has no instances", self.pou(id).ast.name.text);
            let found = Diagnostic::error(Code::AbstractInstance, span, message);
            self.report(found.with_help("declare an instance of what extends it"));
        }
    }
}
