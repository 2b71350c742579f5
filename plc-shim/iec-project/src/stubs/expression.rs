//! The types of expressions, and what they want of what they are made of.

use super::collect::{Collector, Scope, elementary};
use super::names::Access;
use super::ty::Ty;
use onescan_iec::ElementaryType as E;
use onescan_iec::syntax::ast::{BinaryOp, Expr, ExprKind, Ident, Link, Literal, ReferenceKind, TypedValue, UnaryOp};

impl<'a> Collector<'a> {
    /// The type of a value.
    pub(super) fn infer(&mut self, expr: &Expr, scope: &Scope<'a>) -> Ty {
        self.place(expr, Access::Read, scope)
    }

    /// The type of a place or value; of a reference what it refers to.
    pub(super) fn place(&mut self, expr: &Expr, access: Access, scope: &Scope<'a>) -> Ty {
        match self.typed(expr, access, scope) {
            Ty::Pointer(ReferenceKind::Reference, inner) => *inner,
            other => other,
        }
    }

    fn typed(&mut self, expr: &Expr, access: Access, scope: &Scope<'a>) -> Ty {
        match &expr.kind {
            ExprKind::Literal(literal) => self.literal(literal, expr, scope),
            // A wire of a network is declared nowhere, and has the type of what it is given.
            ExprKind::Name(name) if name.text.starts_with('`') => Ty::Unknown,
            ExprKind::Name(name) => self.name(name, access, scope),
            ExprKind::DirectAddress(_) | ExprKind::Type(_) | ExprKind::Error => Ty::Unknown,
            ExprKind::Member(base, name) => self.member_expression(expr, base, name, access, scope),
            ExprKind::Part(base, part) => {
                let whole = self.infer(base, scope);
                if let (Ty::Slot(slot), true) = (&whole, part.text.contains('%')) {
                    // So written, only a bit string has parts.
                    self.slots.given(*slot, &elementary(E::Dword));
                }
                let is_bit = part
                    .text
                    .trim_start_matches(['.', '%'])
                    .starts_with(|first: char| first.is_ascii_digit() || first == 'X');
                if is_bit { elementary(E::Bool) } else { Ty::Unknown }
            }
            ExprKind::Dereference(inner) => {
                let found = self.infer(inner, scope);
                self.dereferenced(&found)
            }
            ExprKind::Index(base, indices) => {
                let base = self.place(base, access.of_base(), scope);
                let bounds = match self.slots.resolved(&base) {
                    Ty::Array(bounds, _) => bounds,
                    _ => Vec::new(),
                };
                for (place, index) in indices.iter().enumerate() {
                    let found = self.infer(index, scope);
                    self.flow(&found, &Ty::Integer);
                    self.note_first_index(&found, bounds.get(place));
                }
                self.element(&base, indices.len())
            }
            ExprKind::Call(call) => self.call(call, true, scope),
            ExprKind::Unary(op, inner) => {
                let found = self.place(inner, if access == Access::Constant { access } else { Access::Read }, scope);
                match op {
                    UnaryOp::Not if matches!(self.slots.resolved(&found), Ty::Slot(_)) => {
                        // A value that is negated is a flag more often than a bit string.
                        self.beside(&found, &elementary(E::Bool));
                        elementary(E::Bool)
                    }
                    _ => found,
                }
            }
            ExprKind::Binary(op, left, right) => self.binary(*op, left, right, access, scope),
            ExprKind::Paren(inner) => self.place(inner, access, scope),
            ExprKind::Assign(target, value) => {
                let target = self.place(target, Access::Write, scope);
                self.wanted(value, &target, scope);
                target
            }
            ExprKind::Chain(first, links) => self.row(first, links, access, scope),
        }
    }

    /// A long row of operators: each operand stands beside what has been found of those before it.
    fn row(&mut self, first: &Expr, links: &[Link], access: Access, scope: &Scope<'a>) -> Ty {
        let mut found = self.place(first, access, scope);
        for link in links {
            let next = self.place(&link.operand, access, scope);
            self.beside(&found, &next);
            if link.operator.is_comparison() {
                found = elementary(E::Bool);
            }
        }
        found
    }

    fn member_expression(&mut self, expr: &Expr, base: &Expr, name: &Ident, access: Access, scope: &Scope<'a>) -> Ty {
        if let Some(found) = self.dotted(expr, access, scope) {
            return found;
        }
        // `__SYSTEM.Kind.Value`
        if let Some(path) = super::collect::path_of(base)
            && let full = path.iter().map(|name| name.key()).collect::<Vec<_>>().join(".")
            && path.len() > 1
            && self.needs.types.contains_key(&full)
        {
            self.foreign(&full).add_value(&name.text);
            return Ty::Foreign(full);
        }
        let inside = base.names_the_object();
        if is_super(base)
            && let Ty::Foreign(key) = self.infer(base, scope)
        {
            self.foreign(&key).member(&name.text).via_super = true;
        }
        if let ExprKind::Member(inner, middle) = &base.kind
            && let Some(path) = super::collect::path_of(inner)
            && let [first] = path[..]
        {
            self.note_depth(first, middle);
        }
        let base = self.place(base, access.of_base(), scope);
        self.member(&base, name, access, inside)
    }

    /// `a.b.c`: what `a.b` is has members.
    fn note_depth(&mut self, first: &Ident, _middle: &Ident) {
        if let Some(head) = self.needs.heads.get_mut(&first.key()) {
            head.part_deep = true;
        }
    }

    fn literal(&mut self, literal: &Literal, expr: &Expr, scope: &Scope<'a>) -> Ty {
        match literal {
            Literal::Bool(_) => elementary(E::Bool),
            Literal::Integer(value) => integer(*value),
            Literal::Real(_) => Ty::Real,
            Literal::LongDuration(_) => elementary(E::Ltime),
            Literal::Duration { long, .. } => elementary(if *long { E::Ltime } else { E::Time }),
            Literal::Calendar { text, .. } => {
                let prefix = text.split('#').next().unwrap_or("");
                E::of_literal(&prefix.to_ascii_uppercase()).map_or(Ty::Unknown, elementary)
            }
            Literal::String(text) => Ty::Text(text.starts_with('"')),
            Literal::Typed { prefix, value } => {
                if let Some(found) = E::of_literal(&prefix.to_ascii_uppercase()) {
                    return elementary(found);
                }
                if let TypedValue::Name(value) = value {
                    let name = Ident { text: prefix.clone(), span: expr.span };
                    let ty = self.named(&name, &scope.home, 0);
                    if let Ty::Foreign(key) = &ty {
                        self.foreign(key).add_value(value);
                    }
                    return ty;
                }
                Ty::Unknown
            }
        }
    }

    /// Values of an enumeration that are indices begin where the array does.
    fn note_first_index(&mut self, index: &Ty, bounds: Option<&String>) {
        let first = bounds.and_then(|bounds| bounds.split("..").next()).and_then(|low| low.parse().ok());
        if let (Ty::Foreign(key), Some(first)) = (self.slots.resolved(index), first) {
            let found = self.foreign(&key);
            found.first_index = found.first_index.max(first);
        }
    }

    fn dereferenced(&mut self, ty: &Ty) -> Ty {
        // What is followed is a pointer in every pass, whatever an earlier one has decided.
        if let Ty::Slot(slot) = ty {
            let inner = Ty::Slot(self.slots.below(*slot, "^"));
            self.slots.given(*slot, &Ty::Pointer(ReferenceKind::Pointer, Box::new(inner)));
        }
        match self.slots.resolved(ty) {
            Ty::Pointer(_, inner) => *inner,
            Ty::Slot(slot) => Ty::Slot(self.slots.below(slot, "^")),
            Ty::Foreign(key) => match self.alias(&key) {
                // An interface is not followed, an alias may be.
                Some(value) => self.dereferenced(&value),
                None => Ty::Unknown,
            },
            _ => Ty::Unknown,
        }
    }

    /// The type that a foreign one may be another name of.
    fn alias(&mut self, key: &str) -> Option<Ty> {
        let value = Ty::Slot(self.foreign(key).value?);
        (!matches!(self.slots.resolved(&value), Ty::Foreign(_))).then_some(value)
    }

    pub(super) fn element(&mut self, ty: &Ty, dimensions: usize) -> Ty {
        let known = self.slots.resolved(ty);
        if let Ty::Slot(slot) = ty
            && !matches!(known, Ty::Pointer(..) | Ty::Text(_) | Ty::Foreign(_) | Ty::Declared(_))
        {
            let inner = Ty::Slot(self.slots.below(*slot, "[]"));
            let bounds = vec![super::slots::ANY_BOUNDS.to_owned(); dimensions];
            self.slots.given(*slot, &Ty::Array(bounds, Box::new(inner)));
        }
        match known {
            Ty::Array(_, inner) | Ty::Pointer(_, inner) => *inner,
            Ty::Text(_) => elementary(E::Byte),
            Ty::Slot(slot) => Ty::Slot(self.slots.below(slot, "[]")),
            Ty::Foreign(key) => match self.alias(&key) {
                Some(value) => self.element(&value, dimensions),
                None => Ty::Unknown,
            },
            _ => Ty::Unknown,
        }
    }

    fn binary(&mut self, op: BinaryOp, left: &Expr, right: &Expr, access: Access, scope: &Scope<'a>) -> Ty {
        let access = if access == Access::Constant { access } else { Access::Read };
        let (null_left, null_right) = (is_null(left), is_null(right));
        let (left, right) = (self.place(left, access, scope), self.place(right, access, scope));
        let bool = elementary(E::Bool);
        for (other, beside_null) in [(&left, null_right), (&right, null_left)] {
            if let (Ty::Foreign(key), true) = (other, beside_null) {
                // What refers to nothing is a reference, of an instance to an interface.
                self.foreign(key).is_value = true;
            }
        }
        if matches!(op, BinaryOp::AndThen | BinaryOp::OrElse) {
            self.beside(&left, &bool);
            self.beside(&right, &bool);
            return bool;
        }
        if op.is_comparison() {
            self.beside(&left, &right);
            return bool;
        }
        let is_logic = matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor);
        let is_open = |ty: &Ty| matches!(ty, Ty::Slot(_));
        let (known_left, known_right) = (self.slots.resolved(&left), self.slots.resolved(&right));
        if is_logic && is_open(&known_left) && is_open(&known_right) {
            // Two flags more often than two bit strings.
            self.beside(&left, &bool);
            self.beside(&right, &bool);
            return bool;
        }
        // Times and dates are joined with others.
        let is_time = |ty: &Ty| matches!(ty, Ty::Elementary(found) if found.is_duration() || found.is_calendar());
        let is_pointer = |ty: &Ty| matches!(ty, Ty::Pointer(..));
        if !is_time(&known_left) && !is_time(&known_right) && !is_pointer(&known_left) && !is_pointer(&known_right) {
            self.beside(&left, &right);
        }
        // What is added to a duration, or taken from one, is one.
        if matches!(op, BinaryOp::Add | BinaryOp::Subtract) {
            let is_duration = |ty: &Ty| matches!(ty, Ty::Elementary(found) if found.is_duration());
            if is_duration(&known_left) && is_open(&known_right) {
                self.beside(&right, &known_left);
            } else if is_duration(&known_right) && is_open(&known_left) && op == BinaryOp::Subtract {
                self.beside(&left, &known_right);
            }
        }
        joined(known_left, known_right, left, right)
    }
}

/// The type of an operation, by those of its operands.
fn joined(known_left: Ty, known_right: Ty, left: Ty, right: Ty) -> Ty {
    match (&known_left, &known_right) {
        (Ty::Elementary(one), Ty::Elementary(other)) => {
            let weight = |ty: &E| (ty.is_duration() || ty.is_calendar(), ty.is_real(), ty.size());
            elementary(if weight(other) > weight(one) { *other } else { *one })
        }
        // An integer beside a literal with a point is reckoned with as a real number.
        (Ty::Elementary(found), Ty::Real) | (Ty::Real, Ty::Elementary(found)) if found.is_integer() => Ty::Real,
        (Ty::Elementary(_) | Ty::Pointer(..) | Ty::Text(_) | Ty::Declared(_), _) => known_left,
        (_, Ty::Elementary(_) | Ty::Pointer(..) | Ty::Text(_) | Ty::Declared(_)) => known_right,
        (Ty::Real, _) | (_, Ty::Real) => Ty::Real,
        (Ty::Slot(_), _) => left,
        _ => right,
    }
}

fn is_null(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Name(name) if name.key() == "NULL")
}

fn is_super(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Name(name) if name.key() == "SUPER")
}

/// What a number without a type says: one that fits an INT could be of any integer type.
fn integer(value: i128) -> Ty {
    let fits = |ty: &E| ty.wrap(value) == value;
    let wide = [E::Int, E::Uint, E::Dint, E::Udint, E::Lint, E::Ulint].into_iter().find(fits);
    wide.filter(|ty| *ty != E::Int).map_or(Ty::Integer, Ty::Wide)
}
