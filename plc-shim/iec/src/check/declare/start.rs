//! What runs before the first scan and before another start, as declarations say it: initial values that are not
//! constants, instances with hooks.
//!
//! A variable's initial bytes and what a start adds to them come together from its type and its
//! initial value ([`TypedImage`](super::entry::TypedImage)). What belongs to a unit's own variables becomes a
//! function of the unit, so that each instance, wherever it lies, is started by one call.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::Declarations;
use super::class::{Membership, Occasion, Role};
use super::namespace::Home;
use crate::ir::{Place, PouId, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Argument, CompilationUnit, Declaration, Ident, PouKind};

/// What is done at a start, in its order.
pub(in crate::check) type Starts<'a> = Arc<[Start<'a>]>;

/// What is done to a part of a value.
#[derive(Debug, Clone)]
pub(in crate::check) struct Start<'a> {
    /// Bytes from where the value begins.
    pub(in crate::check) offset: u32,
    pub(in crate::check) kind: StartKind<'a>,
    /// Where it is written.
    pub(in crate::check) span: Span,
    /// From where names are seen; nothing for the unit that declares the variable.
    pub(in crate::check) home: Option<Arc<Home>>,
    /// The structure whose declaration says it.
    pub(in crate::check) within: Option<Within>,
}

/// Where in a structure something is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) struct Within {
    pub(in crate::check) structure: TypeId,
    /// Bytes from where the structure begins.
    pub(in crate::check) offset: u32,
}

#[derive(Debug, Clone)]
pub(in crate::check) enum StartKind<'a> {
    /// Starts what is in the instance, then itself.
    Instance(PouId, Given<'a>),
    /// The same for so many elements, so many bytes apart.
    Each { count: u32, stride: u32, starts: Starts<'a> },
    /// Assigns an initial value that is not a constant.
    Value(TypeId, &'a ast::Expr),
    /// The same of one that is checked then only: what it needs is not known where it is declared.
    Later(TypeId, &'a ast::Expr),
    /// Gives what `FB_init` may have written the value that its instance is declared with.
    Bytes(TypeId, Arc<[u8]>),
    /// Sets a property of an instance.
    Property(PouId, &'a Ident, &'a ast::Expr),
}

/// The units that make starts and ends: they have no text. By where their owners' names stand.
pub(super) type Stages = BTreeMap<(u32, u32), [ast::Pou; 3]>;

/// A unit for each occasion of each unit that has variables.
pub(in crate::check) fn stages(units: &[(crate::syntax::FileId, &CompilationUnit)]) -> Stages {
    let mut stages = Stages::new();
    let mut open: Vec<&[Declaration]> = units.iter().map(|(_, unit)| unit.declarations.as_slice()).collect();
    while let Some(list) = open.pop() {
        for declaration in list {
            match declaration {
                Declaration::Pou(pou) if !matches!(pou.kind, PouKind::Function | PouKind::Interface) => {
                    stages.insert(place_of(&pou.name), ["start", "after start", "end"].map(|name| stage(pou, name)));
                }
                Declaration::Namespace(namespace) => open.push(&namespace.declarations),
                // The others declare no unit that keeps variables.
                _ => {}
            }
        }
    }
    stages
}

fn place_of(name: &Ident) -> (u32, u32) {
    (name.span.file.0, name.span.start)
}

fn stage(owner: &ast::Pou, name: &str) -> ast::Pou {
    ast::Pou {
        kind: PouKind::Method,
        name: Ident { text: name.to_owned(), span: owner.name.span },
        result: None,
        sections: Vec::new(),
        body: Vec::new(),
        chart: ast::Chart::default(),
        object: ast::Object::default(),
        external: owner.external,
        span: owner.span,
    }
}

/// A variable outside of units, and what is done to it.
#[derive(Debug, Clone)]
pub(in crate::check) struct Started<'a> {
    pub(in crate::check) place: Place,
    pub(in crate::check) starts: Starts<'a>,
}

impl Declarations<'_> {
    /// Adds the units of a unit's occasions.
    pub(super) fn collect_stages(&mut self, owner: PouId) {
        let Some(stages) = self.stages.get(&place_of(&self.pou(owner).ast.name)) else { return };
        for (occasion, stage) in Occasion::ALL.into_iter().zip(stages) {
            let id = self.add_pou(stage, Some(Membership { owner, role: occasion.role() }));
            if let Some(class) = self.classes.get_mut(&owner) {
                class.stages.insert(occasion, id);
            }
        }
    }

    /// The unit of an occasion, if there is something to do.
    pub(in crate::check) fn stage(&self, owner: PouId, occasion: Occasion) -> Option<PouId> {
        let stage = self.class(owner)?.stages.get(&occasion).copied()?;
        self.has_inner(owner, occasion).then_some(stage)
    }

    /// True if variables of the unit, or of its bases, have something to do.
    fn has_inner(&self, id: PouId, occasion: Occasion) -> bool {
        self.inner_acts(id, occasion, &mut BTreeSet::new())
    }

    /// `seen` are units that are being looked at: one that contains itself has been reported.
    fn inner_acts(&self, id: PouId, occasion: Occasion, seen: &mut BTreeSet<PouId>) -> bool {
        if !seen.insert(id) {
            return false;
        }
        let own = self.pou(id).starts.iter().any(|start| self.start_acts(start, occasion, seen));
        own || self.base_of(id).is_some_and(|base| self.inner_acts(base, occasion, seen))
    }

    pub(in crate::check) fn acts(&self, start: &Start<'_>, occasion: Occasion) -> bool {
        self.start_acts(start, occasion, &mut BTreeSet::new())
    }

    fn start_acts(&self, start: &Start<'_>, occasion: Occasion, seen: &mut BTreeSet<PouId>) -> bool {
        match &start.kind {
            StartKind::Instance(pou, _) => self.instance_acts(*pou, occasion, seen),
            StartKind::Each { starts, .. } => starts.iter().any(|start| self.start_acts(start, occasion, seen)),
            _ => occasion == Occasion::Start,
        }
    }

    fn instance_acts(&self, pou: PouId, occasion: Occasion, seen: &mut BTreeSet<PouId>) -> bool {
        self.inner_acts(pou, occasion, seen) || self.has_hook(pou, occasion)
    }

    /// True if an instance of a declared unit has something to do at any time.
    pub(in crate::check) fn instance_starts(&self, pou: PouId) -> bool {
        Occasion::ALL.into_iter().any(|occasion| self.instance_acts(pou, occasion, &mut BTreeSet::new()))
    }

    /// Has what each unit does at a start and an end checked.
    pub(in crate::check) fn enqueue_stages(&mut self) {
        let owners: Vec<PouId> = self.classes.keys().copied().collect();
        for owner in owners {
            for occasion in Occasion::ALL {
                if let Some(stage) = self.stage(owner, occasion) {
                    self.enqueue(stage);
                }
            }
        }
    }

    /// The statements of a unit's occasion; nothing for other units.
    pub(in crate::check) fn stage_of(&self, id: PouId) -> Option<(PouId, Occasion)> {
        let Membership { owner, role } = self.pou(id).membership?;
        match role {
            Role::Start => Some((owner, Occasion::Start)),
            Role::AfterStart => Some((owner, Occasion::AfterStart)),
            Role::End => Some((owner, Occasion::End)),
            _ => None,
        }
    }
}

/// The starts of a list, so many bytes further.
pub(in crate::check) fn moved<'a>(starts: &[Start<'a>], offset: u32) -> impl Iterator<Item = Start<'a>> {
    starts.iter().map(move |start| Start { offset: start.offset + offset, ..start.clone() })
}

/// What a declaration gives to the `FB_init` of its instance.
pub(in crate::check) type Given<'a> = &'a [Argument];
