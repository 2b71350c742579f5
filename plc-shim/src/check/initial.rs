//! Initial values to bytes (2nd ed. 2.4.3.2).

use std::sync::Arc;

use super::names::TypedImage;
use super::scope::Body;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{Dimension, Field, Storage, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{Expr, Initialiser, InitialiserKind, StructureInit};

impl Body<'_, '_> {
    /// The bytes of a variable with an initial value.
    pub(super) fn initial_image(&mut self, declared: &TypedImage, initial: &Initialiser) -> Option<Arc<[u8]>> {
        self.checker.charge_image(declared.image.len() as u64, initial.span)?;
        let mut image = declared.image.to_vec();
        self.fill(declared.ty, initial, &mut image)?;
        Some(image.into())
    }

    fn fill(&mut self, ty: TypeId, initial: &Initialiser, image: &mut [u8]) -> Option<()> {
        let shape = self.checker.types.get(ty).clone();
        match (&initial.kind, shape) {
            (InitialiserKind::Value(expr), _) if self.elementary(ty).is_some() => self.fill_elementary(ty, expr, image),
            (InitialiserKind::Value(expr), Type::Text(shape)) => {
                let bytes = self.text_image(shape, expr)?;
                image.iter_mut().zip(bytes).for_each(|(target, source)| *target = source);
                Some(())
            }
            (InitialiserKind::Array(elements), Type::Array { dimensions, element }) => {
                let count = dimensions.iter().map(|each: &Dimension| each.count()).product();
                self.fill_array(element, count, elements, image)
            }
            (InitialiserKind::Struct(members), Type::Struct { fields, .. }) => {
                self.fill_members(ty, &fields, members, image)
            }
            (InitialiserKind::Struct(members), Type::FunctionBlock { pou, .. }) => {
                let scope = self.checker.interface(pou, initial.span)?;
                let fields = scope.variables.iter().filter_map(|variable| match variable.storage {
                    Storage::Instance(offset) => Some(Field { name: variable.name.clone(), ty: variable.ty, offset }),
                    _ => None,
                });
                let fields: Vec<Field> = fields.collect();
                self.fill_members(ty, &fields, members, image)
            }
            _ => {
                let message = format!("this does not initialise {}", self.type_name(ty));
                self.report(Diagnostic::error(Code::InvalidInitialiser, initial.span, message));
                None
            }
        }
    }

    fn fill_elementary(&mut self, ty: TypeId, expr: &Expr, image: &mut [u8]) -> Option<()> {
        let value = self.constant_of_type(expr, ty)?;
        for (target, source) in image.iter_mut().zip(value.bytes()) {
            *target = source;
        }
        Some(())
    }

    fn fill_array(&mut self, element: TypeId, count: u64, elements: &[Initialiser], image: &mut [u8]) -> Option<()> {
        let size = self.checker.types.size(element) as usize;
        let mut next: u64 = 0;
        for initial in elements {
            let (times, value) = match &initial.kind {
                InitialiserKind::Repeat(times, value) => (self.constant_integer(times)?, value.as_deref()),
                _ => (1, Some(initial)),
            };
            let times = u64::try_from(times).unwrap_or(u64::MAX);
            if next.checked_add(times).is_none_or(|end| end > count) {
                return self.too_many_elements(count, initial.span);
            }
            let first = next as usize * size;
            let range = first..first + times as usize * size;
            next += times;
            let (Some(value), Some(target)) = (value, image.get_mut(range)) else {
                continue;
            };
            if let Some((target, others)) = target.split_at_mut_checked(size) {
                self.fill(element, value, target)?;
                others.chunks_mut(size).for_each(|other| other.copy_from_slice(target));
            }
        }
        Some(())
    }

    fn too_many_elements<T>(&mut self, count: u64, span: Span) -> Option<T> {
        let message = format!("more values than the array's {count} elements");
        self.report(Diagnostic::error(Code::InvalidInitialiser, span, message));
        None
    }

    fn fill_members(
        &mut self,
        ty: TypeId,
        fields: &[Field],
        members: &[StructureInit],
        image: &mut [u8],
    ) -> Option<()> {
        for member in members {
            let name = &member.name.text;
            let field = fields.iter().find(|field| field.name.eq_ignore_ascii_case(name));
            let Some(field) = field else {
                let message = format!("{} has no member `{name}`", self.type_name(ty));
                let help = did_you_mean(name, fields.iter().map(|field| field.name.as_str()));
                let found = Diagnostic::error(Code::UnknownMember, member.name.span, message);
                self.report(found.with_optional_help(help));
                return None;
            };
            let start = field.offset as usize;
            let end = start + self.checker.types.size(field.ty) as usize;
            let target = image.get_mut(start..end)?;
            self.fill(field.ty, &member.value, target)?;
        }
        Some(())
    }
}
