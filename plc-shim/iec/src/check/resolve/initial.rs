//! Initial values to bytes (2nd ed. 2.4.3.2), and to what a start must do where bytes do not do.

use std::collections::BTreeMap;
use std::ops::Range;

use super::Written;
use crate::check::body::is_dtl_literal;
use crate::check::declare::{Occasion, Role, Start, StartKind, TypedImage};
use crate::check::types::constant::{NoValue, fold};
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::dialect::Feature;
use crate::ir::{self, Dimension, Field, PouId, Storage, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{
    Argument, ElementInit, Expr, ExprKind, Ident, Initialiser, InitialiserKind, PouKind, ReferenceKind, StructureInit,
};
use crate::syntax::walk::{names, root};

/// A variable's initial value while it is made.
struct Making<'a> {
    image: Vec<u8>,
    starts: Vec<Start<'a>>,
}

/// What an element is given.
#[derive(Clone, Copy)]
enum Given<'a> {
    Written(&'a Initialiser),
    Value(&'a Expr),
}

/// A value inside of the variable: its type, and bytes from the variable's beginning.
#[derive(Clone, Copy)]
struct Spot {
    ty: TypeId,
    offset: u32,
    /// Of a BOOL that is one bit of its byte, which.
    bit: Option<u8>,
}

impl<'a> Written<'_, 'a> {
    /// What a variable of the type with an initial value begins with.
    pub(in crate::check) fn with_initial(
        &mut self,
        declared: &TypedImage<'a>,
        initial: &'a Initialiser,
    ) -> Option<TypedImage<'a>> {
        self.declarations_mut().charge_image(declared.image.len() as u64, initial.span)?;
        let mut making = Making { image: declared.image.to_vec(), starts: declared.starts.to_vec() };
        self.fill(Spot { ty: declared.ty, offset: 0, bit: None }, initial, &mut making)?;
        Some(TypedImage { ty: declared.ty, image: making.image.into(), starts: making.starts.into() })
    }

    fn range(&self, spot: Spot) -> Range<usize> {
        let start = spot.offset as usize;
        start..start + self.declarations().types().size(spot.ty) as usize
    }

    fn fill(&mut self, spot: Spot, initial: &'a Initialiser, making: &mut Making<'a>) -> Option<()> {
        if let InitialiserKind::Value(expr) = &initial.kind {
            return self.fill_value(spot, expr, making);
        }
        let shape = self.declarations().types().get(spot.ty).clone();
        match (&initial.kind, shape) {
            (InitialiserKind::Array(elements), Type::Array { dimensions, element }) => {
                let whole = self.row(&dimensions, element, initial, elements);
                self.fill_array(Spot { ty: whole.1, ..spot }, whole.0, elements, making)
            }
            (InitialiserKind::Elements(elements), Type::Array { dimensions, element }) => {
                let first = Spot { ty: element, ..spot };
                elements.iter().try_for_each(|each| self.fill_element(first, &dimensions, each, making))
            }
            (InitialiserKind::Struct(members), Type::Struct { fields, .. }) => {
                self.fill_members(spot, &Fields::of(fields), members, making)
            }
            (InitialiserKind::Struct(members), Type::FunctionBlock { pou, .. }) => {
                self.fill_instance(spot, pou, members, (initial.span, making))
            }
            _ => self.does_not_initialise(spot, initial.span),
        }
    }

    fn fill_value(&mut self, spot: Spot, expr: &'a Expr, making: &mut Making<'a>) -> Option<()> {
        if self.needs_instance(expr) {
            return self.begins_later(spot, expr, making);
        }
        match self.declarations().types().get(spot.ty).clone() {
            Type::Text(_) if !self.is_constant_text(expr) => {
                self.begins_with(spot, expr, making);
                Some(())
            }
            _ if self.body.elementary(spot.ty).is_some() => self.fill_elementary(spot, expr, making),
            Type::Text(shape) => {
                let bytes = self.body.text_image(shape, expr)?;
                let range = self.range(spot);
                making.image.get_mut(range)?.iter_mut().zip(bytes).for_each(|(target, source)| *target = source);
                Some(())
            }
            Type::Struct { .. } if is_dtl_literal(expr) => {
                let bytes = self.body.dtl_bytes(expr, spot.ty)?;
                let range = self.range(spot);
                making.image.get_mut(range)?.copy_from_slice(&bytes);
                Some(())
            }
            Type::Struct { .. } | Type::Array { .. } | Type::FunctionBlock { .. } => {
                if let Some(constant) = self.whole_constant(expr, spot.ty) {
                    let range = self.range(spot);
                    making.image.get_mut(range)?.copy_from_slice(&constant);
                    return Some(());
                }
                if !self.declarations().dialect(expr.span).has(Feature::ComputedInitialValues) {
                    return self.does_not_initialise(spot, expr.span);
                }
                self.begins_with(spot, expr, making);
                Some(())
            }
            _ => self.does_not_initialise(spot, expr.span),
        }
    }

    fn does_not_initialise<T>(&mut self, spot: Spot, span: Span) -> Option<T> {
        let message = format!("this does not initialise {}", self.body.type_name(spot.ty));
        self.report(Diagnostic::error(Code::InvalidInitialiser, span, message));
        None
    }

    /// The bytes of a constant of several parts.
    fn whole_constant(&mut self, expr: &Expr, wanted: ir::TypeId) -> Option<std::sync::Arc<[u8]>> {
        let name = match &expr.kind {
            ExprKind::Name(name) => name.clone(),
            ExprKind::Member(..) => self.body.qualified_name(expr)?,
            _ => return None,
        };
        let variable = self.body.variable_named(&name)?.ok()?;
        (variable.is_constant && variable.ty == wanted).then_some(variable.image)
    }

    fn begins_with(&mut self, spot: Spot, expr: &'a Expr, making: &mut Making<'a>) {
        making.starts.push(self.start(spot.offset, StartKind::Value(spot.ty, expr), expr.span));
    }

    fn fill_elementary(&mut self, spot: Spot, expr: &'a Expr, making: &mut Making<'a>) -> Option<()> {
        if self.refers_to_later(spot.ty, expr) {
            return self.begins_later(spot, expr, making);
        }
        let typed = self.body.beginning(expr, spot.ty)?;
        if matches!(fold(self.declarations().types(), &typed), Err(NoValue::NotConstant(_)))
            && self.may_be_computed(&typed)
        {
            self.require_byte(spot, expr)?;
            self.begins_with(spot, expr, making);
            return Some(());
        }
        let value = self.body.value_of(&typed)?;
        let range = self.range(spot);
        if let Some(bit) = spot.bit {
            let byte = making.image.get_mut(range.start)?;
            *byte = *byte & !(1 << bit) | (value.bytes()[0] & 1) << bit;
            return Some(());
        }
        making.image.get_mut(range)?.iter_mut().zip(value.bytes()).for_each(|(target, source)| *target = source);
        Some(())
    }

    fn require_byte(&mut self, spot: Spot, expr: &Expr) -> Option<()> {
        if spot.bit.is_none() {
            return Some(());
        }
        let message = "a member that is one bit of a byte begins with a constant";
        self.report(Diagnostic::error(Code::InvalidInitialiser, expr.span, message));
        None
    }

    fn begins_later(&mut self, spot: Spot, expr: &'a Expr, making: &mut Making<'a>) -> Option<()> {
        self.require_byte(spot, expr)?;
        making.starts.push(self.start(spot.offset, StartKind::Later(spot.ty, expr), expr.span));
        Some(())
    }

    /// True for what names the instance whose variables are being declared, as vendors let `THIS^` do.
    fn needs_instance(&self, expr: &Expr) -> bool {
        let unit = self.body.unit().map(|unit| self.declarations().pou(unit).ast().kind);
        let computed = || self.declarations().dialect(expr.span).has(Feature::ComputedInitialValues);
        unit.is_some_and(PouKind::has_instances) && computed() && names(expr, "THIS")
    }

    /// True for a reference to a variable of the unit that is declared behind it, as vendors have it, and to a global
    /// variable that needs this one in its turn: where that lies is known at the start, when the value is checked and made.
    fn refers_to_later(&self, ty: TypeId, expr: &Expr) -> bool {
        let types = self.declarations().types();
        if !matches!(types.get(ty), Type::Reference { .. } | Type::Interface { .. }) {
            return false;
        }
        let place = match &expr.kind {
            ExprKind::Call(call) => match &call.arguments[..] {
                [Argument::Positional(place)] => place,
                _ => return false,
            },
            _ => expr,
        };
        let Some(name) = root(place).map(Ident::key).filter(|name| !self.body.scope().declares(name)) else {
            return false;
        };
        let Some(unit) = self.body.unit() else { return self.declarations().is_being_placed(&name) };
        let declared = self.declarations().pou(unit).ast().sections.iter().flat_map(|section| &section.variables);
        let is_later = declared.flat_map(|variable| &variable.names).any(|each| each.key() == name);
        is_later && self.declarations().dialect(expr.span).has(Feature::ComputedInitialValues)
    }

    /// A reference may begin with `REF` of any variable (3rd ed. 6.4.4.10.2).
    fn may_be_computed(&self, value: &ir::Expr) -> bool {
        let refers = matches!(
            self.declarations().types().get(value.ty),
            Type::Reference { kind: ReferenceKind::RefTo | ReferenceKind::Pointer, .. } | Type::Interface { .. }
        );
        refers || self.declarations().dialect(value.span).has(Feature::ComputedInitialValues)
    }

    /// True for what [`Self::text_image`] takes or reports.
    fn is_constant_text(&mut self, expr: &Expr) -> bool {
        let computed = self.declarations().dialect(expr.span).has(Feature::ComputedInitialValues);
        let literal = matches!(expr.kind, ExprKind::Literal(_));
        !computed || literal || self.body.constant_text(expr).is_some()
    }

    /// How many values an array takes, and of which type. A list without brackets has those of inner arrays in one row
    /// (`CoDeSys` V2.3: ARRAY).
    fn row(
        &self,
        dimensions: &[Dimension],
        element: TypeId,
        initial: &Initialiser,
        elements: &[Initialiser],
    ) -> (u64, TypeId) {
        let number = |dimensions: &[Dimension]| dimensions.iter().map(|each| each.count()).product::<u64>();
        let is_bare = elements.first().is_some_and(|first| first.span.start == initial.span.start);
        let is_plain = |each: &Initialiser| match &each.kind {
            InitialiserKind::Value(_) => true,
            InitialiserKind::Repeat(_, inner) => {
                inner.as_deref().is_none_or(|inner| matches!(inner.kind, InitialiserKind::Value(_)))
            }
            _ => false,
        };
        let (mut count, mut ty) = (number(dimensions), element);
        while is_bare
            && elements.iter().all(is_plain)
            && let Type::Array { dimensions, element } = self.declarations().types().get(ty)
        {
            count = count.saturating_mul(number(dimensions));
            ty = *element;
        }
        (count, ty)
    }

    fn fill_array(
        &mut self,
        element: Spot,
        count: u64,
        elements: &'a [Initialiser],
        making: &mut Making<'a>,
    ) -> Option<()> {
        let size = self.declarations().types().size(element.ty);
        let mut next: u64 = 0;
        for initial in elements {
            let (times, value) = match &initial.kind {
                InitialiserKind::Repeat(times, value) => {
                    (self.body.constant_integer(times)?, value.as_deref().map(Given::Written))
                }
                InitialiserKind::Value(expr) => match self.named_count(expr) {
                    Some((count, value)) => (self.body.constant_integer(count)?, value.map(Given::Value)),
                    None => (1, Some(Given::Value(expr))),
                },
                _ => (1, Some(Given::Written(initial))),
            };
            let times = u64::try_from(times).unwrap_or(u64::MAX);
            if next.checked_add(times).is_none_or(|end| end > count) {
                return self.too_many_elements(count, initial.span);
            }
            let spot = Spot { offset: element.offset + next as u32 * size, ..element };
            next += times;
            if let Some(value) = value.filter(|_| times > 0) {
                self.fill_alike(spot, times as u32, value, making)?;
            }
        }
        Some(())
    }

    /// One element by its indices; `first` is that of the smallest ones.
    fn fill_element(
        &mut self,
        first: Spot,
        dimensions: &[Dimension],
        element: &'a ElementInit,
        making: &mut Making<'a>,
    ) -> Option<()> {
        let span = element.indices.first().map_or(element.value.span, |index| index.span);
        if element.indices.len() != dimensions.len() {
            let message = format!("{} indices for {} dimensions", element.indices.len(), dimensions.len());
            self.report(Diagnostic::error(Code::WrongDimensions, span, message));
            return None;
        }
        let mut number: u64 = 0;
        for (bounds, index) in dimensions.iter().zip(&element.indices) {
            let value = self.body.constant_integer(index)?;
            let Some(value) = i64::try_from(value).ok().filter(|value| (bounds.low..=bounds.high).contains(value))
            else {
                let message = format!("index {value} is outside of {}..{}", bounds.low, bounds.high);
                self.report(Diagnostic::error(Code::IndexOutOfRange, index.span, message));
                return None;
            };
            number = number * bounds.count() + (value - bounds.low) as u64;
        }
        let offset = first.offset + number as u32 * self.declarations().types().size(first.ty);
        self.fill(Spot { offset, ..first }, &element.value, making)
    }

    /// Gives so many elements in a row the same value.
    fn fill_alike(&mut self, first: Spot, times: u32, value: Given<'a>, making: &mut Making<'a>) -> Option<()> {
        let known = making.starts.len();
        let span = match value {
            Given::Written(initial) => {
                self.fill(first, initial, making)?;
                initial.span
            }
            Given::Value(expr) => {
                self.fill_value(first, expr, making)?;
                expr.span
            }
        };
        let (range, size) = (self.range(first), self.declarations().types().size(first.ty));
        let (from, end) = (range.start, range.start + size as usize * times as usize);
        let row = making.image.get_mut(from..end)?;
        if let Some((first, others)) = row.split_at_mut_checked(size as usize) {
            others.chunks_mut(size as usize).for_each(|other| other.copy_from_slice(first));
        }
        if times > 1 && making.starts.len() > known {
            let own = making.starts.split_off(known);
            let inside = own.into_iter().map(|start| Start { offset: start.offset - first.offset, ..start });
            let kind = StartKind::Each { count: times, stride: size, starts: inside.collect() };
            making.starts.push(self.start(first.offset, kind, span));
        }
        Some(())
    }

    /// `N(5)` is five `N` times where `N` is a variable, which must be a constant, and else a call (CODESYS, TwinCAT).
    fn named_count(&mut self, expr: &'a Expr) -> Option<(&'a Expr, Option<&'a Expr>)> {
        let ExprKind::Call(call) = &expr.kind else { return None };
        let value = match &call.arguments[..] {
            [] => None,
            [Argument::Positional(value)] => Some(value),
            _ => return None,
        };
        if !self.declarations().dialect(expr.span).has(Feature::NamedCounts) || !self.body.is_value_named(&call.callee)
        {
            return None;
        }
        Some((&*call.callee, value))
    }

    fn too_many_elements<T>(&mut self, count: u64, span: Span) -> Option<T> {
        let message = format!("more values than the array's {count} elements");
        self.report(Diagnostic::error(Code::InvalidInitialiser, span, message));
        None
    }

    /// The variables of an instance, and its properties, which vendors allow here too.
    fn fill_instance(
        &mut self,
        spot: Spot,
        pou: PouId,
        members: &'a [StructureInit],
        (span, making): (Span, &mut Making<'a>),
    ) -> Option<()> {
        let scope = self.declarations_mut().interface(pou, span)?;
        let fields = scope.variables().iter().filter_map(|variable| match variable.storage {
            Storage::Instance(offset) => {
                Some(Field { name: variable.name.clone(), ty: variable.ty, offset, bit: None, open: None })
            }
            _ => None,
        });
        let fields = Fields::of(fields.collect());
        let overwritten = self.declarations().has_hook(pou, Occasion::Start);
        for member in members {
            let is_field = fields.find(&member.name.text).is_some();
            let setter = self.declarations().find_member(pou, Role::Setter, &member.name.text);
            if let (false, Some(_), InitialiserKind::Value(value)) = (is_field, setter, &member.value.kind) {
                let kind = StartKind::Property(pou, &member.name, value);
                making.starts.push(self.start(spot.offset, kind, member.name.span));
                continue;
            }
            let known = making.starts.len();
            let filled = self.fill_member(spot, &fields, member, making)?;
            if overwritten {
                let bytes = making.image.get(self.range(filled))?.into();
                let start = self.start(filled.offset, StartKind::Bytes(filled.ty, bytes), member.name.span);
                // What is computed comes behind the bytes around it.
                making.starts.insert(known, start);
            }
        }
        Some(())
    }

    fn fill_members(
        &mut self,
        spot: Spot,
        fields: &Fields,
        members: &'a [StructureInit],
        making: &mut Making<'a>,
    ) -> Option<()> {
        members.iter().try_for_each(|member| self.fill_member(spot, fields, member, making).map(|_| ()))
    }

    fn fill_member(
        &mut self,
        spot: Spot,
        fields: &Fields,
        member: &'a StructureInit,
        making: &mut Making<'a>,
    ) -> Option<Spot> {
        let name = &member.name.text;
        let Some(field) = fields.find(name) else {
            let unknown = match self.declarations().types().get(spot.ty) {
                Type::FunctionBlock { pou, .. } => self.declarations().may_inherit(*pou),
                _ => self.declarations().is_unmade(spot.ty),
            };
            if unknown {
                return None;
            }
            let message = format!("{} has no member `{name}`", self.body.type_name(spot.ty));
            let help = did_you_mean(name, fields.all.iter().map(|field| field.name.as_str()));
            let found = Diagnostic::error(Code::UnknownMember, member.name.span, message);
            self.report(found.with_optional_help(help));
            return None;
        };
        let inner = Spot { ty: field.ty, offset: spot.offset + field.offset, bit: field.bit };
        self.fill(inner, &member.value, making)?;
        Some(inner)
    }
}

/// Members to be given values, each found by its name without looking at all of them.
struct Fields {
    all: Vec<Field>,
    /// Which of them has a name, in capitals.
    by_name: BTreeMap<String, usize>,
}

impl Fields {
    fn of(all: Vec<Field>) -> Self {
        let mut by_name = BTreeMap::new();
        for (at, field) in all.iter().enumerate() {
            by_name.entry(field.name.to_ascii_uppercase()).or_insert(at);
        }
        Self { all, by_name }
    }

    fn find(&self, name: &str) -> Option<&Field> {
        self.all.get(*self.by_name.get(&name.to_ascii_uppercase())?)
    }
}
