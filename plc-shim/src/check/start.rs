//! What runs before the first scan: initial values that are no constants, and the instances'
//! `FB_init` ([`super::fb_init`]).
//!
//! A variable's initial bytes and what a start adds to them come together from its type and its
//! initial value ([`super::names::TypedImage`]). What belongs to a unit's own variables becomes a
//! function of the unit, so that each instance, wherever it lies, is started by one call.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Checker;
use super::class::{Membership, Role};
use super::convert::constant;
use super::fb_init::Given;
use super::namespace::Home;
use super::scope::{Body, Scope};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{
    ElementaryType, Expr, ExprKind, ForStatement, Guard, Place, Pou, PouId, Statement, StatementKind, Step, Storage,
    TypeId, Value,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, CompilationUnit, Declaration, Ident, PouKind};

/// When a unit's variables are gone through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Occasion {
    /// Before the first scan after a start.
    Start,
    /// Before another start.
    End,
}

impl Occasion {
    const ALL: [Self; 2] = [Self::Start, Self::End];

    fn role(self) -> Role {
        match self {
            Self::Start => Role::Start,
            Self::End => Role::End,
        }
    }
}

/// What is done at a start, in its order.
pub(super) type Starts<'a> = Arc<[Start<'a>]>;

/// What is done to a part of a value.
#[derive(Debug, Clone)]
pub(super) struct Start<'a> {
    /// Bytes from where the value begins.
    pub(super) offset: u32,
    pub(super) kind: StartKind<'a>,
    /// Where it is written.
    pub(super) span: Span,
    /// From where names are seen; nothing for the unit that declares the variable.
    pub(super) home: Option<Arc<Home>>,
}

#[derive(Debug, Clone)]
pub(super) enum StartKind<'a> {
    /// Starts what is in the instance, then itself.
    Instance(PouId, Given<'a>),
    /// The same for so many elements, so many bytes apart.
    Each { count: u32, stride: u32, starts: Starts<'a> },
    /// Assigns an initial value that is no constant.
    Value(TypeId, &'a ast::Expr),
    /// Gives what `FB_init` may have written the value that its instance is declared with.
    Bytes(TypeId, Arc<[u8]>),
    /// Sets a property of an instance.
    Property(PouId, &'a Ident, &'a ast::Expr),
}

/// The units that make starts and ends: they have no text. By where their owners' names stand.
pub(super) type Stages = BTreeMap<(u32, u32), [ast::Pou; 2]>;

/// A unit for each occasion of each unit that has variables.
pub(super) fn stages(units: &[(crate::syntax::FileId, &CompilationUnit)]) -> Stages {
    let mut stages = Stages::new();
    let mut open: Vec<&[Declaration]> = units.iter().map(|(_, unit)| unit.declarations.as_slice()).collect();
    while let Some(list) = open.pop() {
        for declaration in list {
            match declaration {
                Declaration::Pou(pou) if !matches!(pou.kind, PouKind::Function | PouKind::Interface) => {
                    stages.insert(place_of(&pou.name), [stage(pou, "start"), stage(pou, "end")]);
                }
                Declaration::Namespace(namespace) => open.push(&namespace.declarations),
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
        span: owner.span,
    }
}

/// A variable outside of units, and what is done to it.
pub(super) struct Started<'a> {
    pub(super) place: Place,
    pub(super) starts: Starts<'a>,
}

impl Checker<'_> {
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
    pub(super) fn stage(&self, owner: PouId, occasion: Occasion) -> Option<PouId> {
        let stage = self.class(owner)?.stages.get(&occasion).copied()?;
        self.has_inner(owner, occasion).then_some(stage)
    }

    /// True if variables of the unit, or of its bases, have something to do.
    fn has_inner(&self, id: PouId, occasion: Occasion) -> bool {
        let own = self.pou(id).starts.iter().any(|start| self.acts(start, occasion));
        own || self.base_of(id).is_some_and(|base| self.has_inner(base, occasion))
    }

    fn acts(&self, start: &Start<'_>, occasion: Occasion) -> bool {
        match &start.kind {
            StartKind::Instance(pou, _) => self.instance_acts(*pou, occasion),
            StartKind::Each { starts, .. } => starts.iter().any(|start| self.acts(start, occasion)),
            _ => occasion == Occasion::Start,
        }
    }

    fn instance_acts(&self, pou: PouId, occasion: Occasion) -> bool {
        self.has_inner(pou, occasion) || self.has_hook(pou, occasion)
    }

    /// True if an instance of a declared unit has something to do at any time.
    pub(super) fn instance_starts(&self, pou: PouId) -> bool {
        Occasion::ALL.into_iter().any(|occasion| self.instance_acts(pou, occasion))
    }

    /// Has what each unit does at a start and an end checked.
    pub(super) fn enqueue_stages(&mut self) {
        let owners: Vec<PouId> = self.classes.keys().copied().collect();
        for owner in owners {
            for occasion in Occasion::ALL {
                if let Some(stage) = self.stage(owner, occasion) {
                    self.enqueue(stage);
                }
            }
        }
    }

    /// What the PLC does at an occasion: global variables in the order of the text, then programs.
    pub(super) fn occasion(&mut self, occasion: Occasion) -> Option<Pou> {
        let mut all = std::mem::take(&mut self.started);
        all.sort_by_key(|each| (each.place.span.file, each.place.span.start));
        let programs = self.programs.clone();
        let mut body = Body::outside(self);
        let mut statements = Vec::new();
        for each in &all {
            statements.extend(body.performed(&each.place, &each.starts, occasion));
        }
        for program in programs {
            let span = body.checker.pou(program.pou).ast.name.span;
            let place = Place::whole(Storage::Absolute(program.offset), ElementaryType::Byte.into(), span);
            let kind = StartKind::Instance(program.pou, &[]);
            let start = Start { offset: 0, kind, span, home: None };
            statements.extend(body.performed(&place, &[start], occasion));
        }
        // What the configuration says goes before what declarations say.
        let values = std::mem::take(&mut body.checker.configured.values);
        for each in &values {
            statements.extend(body.performed(&each.place, &each.starts, occasion));
        }
        body.checker.configured.values = values;
        let registers = body.scope.registers;
        self.started = all;
        let span = statements.first()?.span;
        let name = match occasion {
            Occasion::Start => "PLC start",
            Occasion::End => "PLC end",
        };
        Some(Pou {
            name: name.to_owned(),
            span,
            variables: Vec::new(),
            registers,
            parameters: 0,
            result: None,
            guard: Guard::None,
            body: statements,
        })
    }

    /// The statements of a unit's occasion; nothing for other units.
    pub(super) fn stage_of(&self, id: PouId) -> Option<(PouId, Occasion)> {
        let Membership { owner, role } = self.pou(id).membership?;
        match role {
            Role::Start => Some((owner, Occasion::Start)),
            Role::End => Some((owner, Occasion::End)),
            _ => None,
        }
    }
}

impl<'a> Body<'_, 'a> {
    /// What is done in one of the unit's own variables belongs to its text; all else to where it stands.
    pub(super) fn start(&self, offset: u32, kind: StartKind<'a>, span: Span) -> Start<'a> {
        let home = self.pou.is_none().then(|| self.checker.home.clone());
        Start { offset, kind, span, home }
    }

    /// What a unit's occasion does: what its base does, then its own variables in their order.
    pub(super) fn staged(&mut self, owner: PouId, occasion: Occasion) -> Vec<Statement> {
        let span = self.checker.pou(owner).ast.name.span;
        let mut statements = Vec::new();
        let base = self.checker.base_of(owner).and_then(|base| self.checker.stage(base, occasion));
        if let Some(base) = base {
            let instance = self.this(owner, span);
            statements.extend(self.stage_call(&instance, base, span));
        }
        let starts = self.checker.pou(owner).starts.clone();
        let this = Place::whole(Storage::Instance(0), ElementaryType::Byte.into(), span);
        statements.extend(self.performed(&this, &starts, occasion));
        statements
    }

    /// Statements that do all of a list on the value at `base`.
    pub(super) fn performed(&mut self, base: &Place, starts: &[Start<'a>], occasion: Occasion) -> Vec<Statement> {
        let mut statements = Vec::new();
        for start in starts {
            let known = self.checker.diagnostics.len();
            let done = match &start.home {
                Some(home) => self.seen_from(home.clone(), |body| body.perform(base, start, occasion)),
                None => self.perform(base, start, occasion),
            };
            statements.extend(done);
            // What is wrong with a type's text is told once, however often it is used.
            if self.checker.diagnostics.len() > known
                && !self.checker.faulty_starts.insert(key_of(start.span, occasion))
            {
                self.checker.diagnostics.truncate(known);
            }
        }
        statements
    }

    fn seen_from<T>(&mut self, home: Arc<Home>, make: impl FnOnce(&mut Self) -> T) -> T {
        let registers = std::mem::take(&mut self.scope.registers);
        let outer = std::mem::replace(&mut self.scope, Scope { registers, ..Scope::default() });
        let kept = std::mem::replace(&mut self.checker.home, home);
        let made = make(self);
        self.checker.home = kept;
        let registers = std::mem::take(&mut self.scope.registers);
        self.scope = Scope { registers, has_memory: outer.has_memory || self.scope.has_memory, ..outer };
        made
    }

    fn perform(&mut self, base: &Place, start: &Start<'a>, occasion: Occasion) -> Vec<Statement> {
        let span = start.span;
        let at = |ty| part(base, start.offset, ty, span);
        match &start.kind {
            StartKind::Instance(pou, given) => {
                let place = at(self.instance_type(*pou));
                self.instance_performed(&place, *pou, given, occasion)
            }
            StartKind::Each { count, stride, starts } => {
                if !starts.iter().any(|start| self.checker.acts(start, occasion)) {
                    return Vec::new();
                }
                let place = at(ElementaryType::Byte.into());
                vec![self.repeated(place, (*count, *stride), starts, occasion)]
            }
            _ if occasion == Occasion::End => Vec::new(),
            StartKind::Value(ty, expr) => {
                let known = self.checker.diagnostics.len();
                let value = self.expression_for(expr, *ty);
                // Whatever there is to say has been said where it is declared.
                self.checker.diagnostics.truncate(known);
                value.map(|value| self.assignment(at(*ty), value, span)).into_iter().collect()
            }
            StartKind::Bytes(ty, bytes) => vec![self.given_bytes(at(*ty), bytes)],
            StartKind::Property(pou, name, value) => {
                let place = at(self.instance_type(*pou));
                self.property_begins(&place, *pou, name, value).into_iter().collect()
            }
        }
    }

    fn instance_type(&mut self, pou: PouId) -> TypeId {
        let name = &self.checker.pou(pou).ast.name.text;
        self.checker.types.block(name, pou)
    }

    fn instance_performed(
        &mut self,
        place: &Place,
        pou: PouId,
        given: Given<'a>,
        occasion: Occasion,
    ) -> Vec<Statement> {
        let mut statements = Vec::new();
        let inner = self.checker.stage(pou, occasion);
        match occasion {
            Occasion::Start => {
                statements.extend(inner.and_then(|stage| self.stage_call(place, stage, place.span)));
                statements.extend(self.init_calls(place, pou, given));
            }
            // What was made last ends first.
            Occasion::End => {
                statements.extend(self.exit_calls(place, pou));
                statements.extend(inner.and_then(|stage| self.stage_call(place, stage, place.span)));
            }
        }
        statements
    }

    /// A loop over the elements from `first` on.
    fn repeated(
        &mut self,
        first: Place,
        (count, stride): (u32, u32),
        starts: &[Start<'a>],
        occasion: Occasion,
    ) -> Statement {
        let span = first.span;
        let ty = ElementaryType::Dint;
        let number = |value: u32| constant(Value::Int(i128::from(value)), ty, span);
        let variable = Place::whole(Storage::Register(self.scope.register(ty)), ty.into(), span);
        let index = Box::new(Expr { kind: ExprKind::Load(variable.clone()), ty: ty.into(), span });
        let mut element = first;
        element.steps.push(Step::Index { index, low: 0, count, stride });
        let (last, step) = (self.scope.register(ElementaryType::Lint), self.scope.register(ElementaryType::Lint));
        let body = self.performed(&element, starts, occasion);
        let (from, to, by) = (number(0), number(count.saturating_sub(1)), number(1));
        let inner = ForStatement { variable, from, to, by, last, step, body };
        Statement { kind: StatementKind::For(Box::new(inner)), span }
    }

    fn given_bytes(&self, place: Place, bytes: &Arc<[u8]>) -> Statement {
        let span = place.span;
        let kind = match self.elementary(place.ty) {
            Some(ty) => {
                let value = constant(super::variables::decode(ty, bytes), ty, span);
                let value = Expr { ty: place.ty, ..value };
                StatementKind::Assign(place, value)
            }
            None => StatementKind::Initialise(place, bytes.clone()),
        };
        Statement { kind, span }
    }

    /// Reports a variable that may begin with a constant only.
    pub(super) fn require_constant(&mut self, starts: &[Start<'a>], why: &str) {
        if let Some(start) = starts.iter().find(|start| matches!(start.kind, StartKind::Value(..))) {
            let message = format!("a constant is wanted here: {why}");
            self.report(Diagnostic::error(Code::NotConstant, start.span, message));
        }
    }
}

fn key_of(span: Span, occasion: Occasion) -> (u32, u32, Occasion) {
    (span.file.0, span.start, occasion)
}

/// The value at an offset inside of another.
fn part(base: &Place, offset: u32, ty: TypeId, span: Span) -> Place {
    let place = if offset == 0 && base.steps.is_empty() {
        Place { ty, ..base.clone() }
    } else {
        base.clone().member(offset, ty)
    };
    Place { span, ..place }
}
