//! What a unit's variables do before the first scan and before another start, as statements.

pub(super) mod hook;
mod surrounding;

use std::sync::Arc;

pub(in crate::check) use self::surrounding::Surrounding;

use super::Body;
use crate::check::declare::{Given, Home, Occasion, Start, StartKind};
use crate::check::types::constant;
use crate::check::types::operand::constant;
use crate::ir::{
    ElementaryType, Expr, ExprKind, ForStatement, Place, PouId, Statement, StatementKind, Step, Storage, TypeId, Value,
};
use crate::syntax::Span;

impl<'a> Body<'_, 'a> {
    /// What a unit's occasion does: what its base does, then its own variables in their order.
    pub(super) fn staged(&mut self, owner: PouId, occasion: Occasion) -> Vec<Statement> {
        let span = self.declarations.pou(owner).ast().name.span;
        let mut statements = Vec::new();
        let base = self.declarations.base_of(owner).and_then(|base| self.declarations.stage(base, occasion));
        if let Some(base) = base {
            let instance = self.this(owner, span);
            statements.extend(self.stage_call(&instance, base, span));
        }
        let starts = self.declarations.pou(owner).starts().clone();
        let this = Place::whole(Storage::Instance(0), ElementaryType::Byte.into(), span);
        statements.extend(self.performed(&this, &starts, occasion));
        statements
    }

    /// Statements that do all of a list on the value at `base`.
    pub(in crate::check) fn performed(
        &mut self,
        base: &Place,
        starts: &[Start<'a>],
        occasion: Occasion,
    ) -> Vec<Statement> {
        let mut statements = Vec::new();
        for start in starts {
            let known = self.declarations.mark();
            let around = start.within.and_then(|within| Surrounding::of(base, start.offset, within));
            let outer = around.map(|around| self.surround(Some(around)));
            statements.extend(match &start.home {
                Some(home) => self.seen_from(home.clone(), |body| body.perform(base, start, occasion)),
                None => self.perform(base, start, occasion),
            });
            if let Some(outer) = outer {
                self.surround(outer);
            }
            // What is wrong with a type's text is reported once, however often it is used.
            if self.declarations.has_found_since(known) && !self.declarations.is_first_fault(start.span, occasion) {
                self.declarations.forget_since(known);
            }
        }
        statements
    }

    fn seen_from<T>(&mut self, home: Arc<Home>, make: impl FnOnce(&mut Self) -> T) -> T {
        let named = self.scope.without_names();
        let kept = self.declarations.replace_home(home);
        let made = make(self);
        self.declarations.replace_home(kept);
        self.scope.with_names_of(named);
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
                if !starts.iter().any(|start| self.declarations.acts(start, occasion)) {
                    return Vec::new();
                }
                let place = at(ElementaryType::Byte.into());
                vec![self.repeated(place, (*count, *stride), starts, occasion)]
            }
            _ if occasion != Occasion::Start => Vec::new(),
            StartKind::Value(ty, expr) => {
                let known = self.declarations.mark();
                let value = self.beginning(expr, *ty);
                // Whatever there is to say has been said where it is declared.
                self.declarations.forget_since(known);
                value.map(|value| self.assignment(at(*ty), value, span)).into_iter().collect()
            }
            StartKind::Later(ty, expr) => {
                let value = self.beginning(expr, *ty);
                value.map(|value| self.assignment(at(*ty), value, span)).into_iter().collect()
            }
            StartKind::Bytes(ty, bytes) => vec![self.given_bytes(at(*ty), bytes)],
            StartKind::Property(pou, name, value) => {
                let place = at(self.instance_type(*pou));
                self.property_begins(&place, *pou, name, value).into_iter().collect()
            }
        }
    }

    /// Runs a program that the start calls.
    pub(in crate::check) fn program_at_start(&mut self, pou: PouId, offset: u32) -> Statement {
        let (ty, span) = (self.instance_type(pou), self.declarations.pou(pou).ast().name.span);
        self.bare_call(Place::whole(Storage::Absolute(offset), ty, span), pou, span)
    }

    fn instance_type(&mut self, pou: PouId) -> TypeId {
        let name = &self.declarations.pou(pou).ast().name.text;
        self.declarations.types_mut().block(name, pou)
    }

    fn instance_performed(
        &mut self,
        place: &Place,
        pou: PouId,
        given: Given<'a>,
        occasion: Occasion,
    ) -> Vec<Statement> {
        let mut statements = Vec::new();
        let inner = self.declarations.stage(pou, occasion);
        match occasion {
            Occasion::Start => {
                statements.extend(inner.and_then(|stage| self.stage_call(place, stage, place.span)));
                statements.extend(self.init_calls(place, pou, given));
            }
            Occasion::AfterStart => {
                statements.extend(inner.and_then(|stage| self.stage_call(place, stage, place.span)));
                statements.extend(self.after_init_calls(place, pou));
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

    pub(in crate::check::body) fn given_bytes(&self, place: Place, bytes: &Arc<[u8]>) -> Statement {
        let span = place.span;
        let kind = match self.elementary(place.ty) {
            Some(ty) => {
                let value = constant(constant::decode(ty, bytes), ty, span);
                let value = Expr { ty: place.ty, ..value };
                StatementKind::Assign(place, value)
            }
            None => StatementKind::Initialise(place, bytes.clone()),
        };
        Statement { kind, span }
    }
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
