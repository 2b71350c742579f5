//! Types as written to types (2nd ed. 2.3.3).

use std::sync::Arc;

use super::Written;
use super::structure::{Placing, Sharing};
use crate::check::declare::{Enumerator, Need, Rank, StartKind, TypedImage};
use crate::check::standard::vendor::{is_qualified_only, of_pointer_width};
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::dialect::Feature;
use crate::ir::{Dimension, ElementaryType, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, EnumValue, Ident, PouKind, TypeSpec, TypeSpecKind};

/// The namespace of what vendors' compilers declare.
const SYSTEM: &str = "__SYSTEM";

/// What attributes say of the names of an enumeration's values.
#[derive(Clone, Copy, Default)]
struct Known {
    /// They are known behind the enumeration's name.
    qualified: bool,
    /// They are the text of their values.
    as_text: bool,
    /// It takes its own values only.
    is_strict: bool,
}

impl<'a> Written<'_, 'a> {
    pub(super) fn declared_type(&mut self, ast: &'a ast::TypeDeclaration) -> Option<TypedImage<'a>> {
        let name = &ast.name.text;
        let mut resolved = match &ast.spec.kind {
            TypeSpecKind::Struct(fields) => {
                let ty = self.declarations_mut().own_reserved(&ast.name);
                self.structure(
                    name,
                    (ty, ast.extends.as_ref()),
                    (fields, Placing { sharing: Sharing::Refused, packing: ast.packing }),
                    ast.name.span,
                )
            }
            TypeSpecKind::Overlapping(fields) => {
                let ty = self.declarations_mut().own_reserved(&ast.name);
                self.structure(
                    name,
                    (ty, ast.extends.as_ref()),
                    (fields, Placing { sharing: Sharing::Allowed, packing: ast.packing }),
                    ast.name.span,
                )
            }
            TypeSpecKind::Union(fields) => {
                let ty = self.declarations_mut().own_reserved(&ast.name);
                self.union(name, (ty, ast.packing), fields, ast.name.span)
            }
            TypeSpecKind::Enumeration(values, base) => {
                let known = Known { qualified: ast.qualified_only, as_text: ast.shows_names, is_strict: ast.is_strict };
                self.enumeration(name, values, base.as_ref(), known)
            }
            _ => {
                self.reject_bit(&ast.spec);
                self.resolve(&ast.spec, Need::Size)
            }
        }?;
        if let Some(initial) = &ast.initial {
            resolved = self.with_initial(&resolved, initial)?;
        }
        Some(resolved)
    }

    /// The type and the initial bytes of a variable declared with it.
    pub(in crate::check) fn resolve(&mut self, spec: &'a TypeSpec, need: Need) -> Option<TypedImage<'a>> {
        match &spec.kind {
            TypeSpecKind::Name(name) => self.type_by_name(name, need),
            TypeSpecKind::Array(dimensions, element) => self.array(dimensions, element, spec.span),
            TypeSpecKind::Struct(fields) => {
                self.structure("STRUCT", (None, None), (fields, Placing::natural(Sharing::Refused)), spec.span)
            }
            TypeSpecKind::Overlapping(fields) => {
                self.structure("STRUCT", (None, None), (fields, Placing::natural(Sharing::Allowed)), spec.span)
            }
            TypeSpecKind::Instance(name, arguments) => self.instance_with_arguments(name, arguments, need),
            TypeSpecKind::Reference(kind, target) => self.reference_type(*kind, target),
            TypeSpecKind::OpenArray(dimensions, element) => {
                let element = self.resolve(element, Need::Size)?.ty;
                self.body.reject_open_array(element, spec.span)?;
                let ty = self.declarations_mut().types_mut().open_array(*dimensions, element);
                Some(self.whole(ty))
            }
            TypeSpecKind::Union(fields) => self.union("UNION", (None, None), fields, spec.span),
            TypeSpecKind::Enumeration(values, base) => {
                self.enumeration("enumeration", values, base.as_ref(), Known::default())
            }
            TypeSpecKind::String(name, length) => {
                let ty = self.body.text_type(name.key() == "WSTRING", length.as_deref(), spec.span)?;
                let size = u64::from(self.declarations().types().size(ty));
                self.declarations_mut().charge_image(size, spec.span)?;
                Some(self.whole(ty))
            }
            TypeSpecKind::Subrange(name, range) => self.subrange(name, range),
            TypeSpecKind::Error => None,
        }
    }

    pub(in crate::check) fn whole(&self, ty: TypeId) -> TypedImage<'a> {
        TypedImage::plain(ty, self.declarations().types().image(ty).clone())
    }

    /// A reference's target need not be known yet: structures refer to one another, and to themselves.
    fn reference_type(&mut self, kind: ast::ReferenceKind, target: &'a TypeSpec) -> Option<TypedImage<'a>> {
        self.reject_bit(target);
        let reserved = match &target.kind {
            TypeSpecKind::Name(name) => {
                let key = self.declarations().type_key(&name.key());
                key.and_then(|key| self.declarations_mut().reserved(&key))
            }
            _ => None,
        };
        let target_ty = match reserved {
            Some(ty) => ty,
            None => self.resolve(target, Need::Reference)?.ty,
        };
        self.body.reject_open_array(target_ty, target.span)?;
        let ty = self.declarations_mut().types_mut().reference(Some(kind), target_ty);
        Some(self.whole(ty))
    }

    pub(super) fn type_by_name(&mut self, name: &Ident, need: Need) -> Option<TypedImage<'a>> {
        let key = name.key();
        if let Some(found) = ElementaryType::find(&key) {
            return Some(self.whole(found.into()));
        }
        if let Some(key) = self.declarations().type_key(&key) {
            return self.declarations_mut().named_type(&key, Some(name.span));
        }
        if let Some(found) = of_pointer_width(&key, self.declarations().word_size(name.span)) {
            return Some(self.whole(found.into()));
        }
        // Vendors' BIT is a BOOL; only in their structures do several share a byte.
        if key == "BIT" {
            return Some(self.whole(ElementaryType::Bool.into()));
        }
        if let Some(id) = self.declarations().unit_meant(self.body.unit(), name) {
            self.declarations_mut().check_internal(id, name.span);
            let ast = self.declarations().pou(id).ast();
            if ast.kind == PouKind::Interface {
                let ty = self.declarations_mut().types_mut().interface(&ast.name.text, id);
                return Some(self.whole(ty));
            }
            if ast.kind.has_instances() {
                let ty = self.declarations_mut().types_mut().block(&ast.name.text, id);
                if need == Need::Reference {
                    return Some(self.whole(ty));
                }
                self.declarations_mut().check_instance(id, name.span);
                self.declarations_mut().declare(id, Some(name.span))?;
                let begins = self.declarations().instance_starts(id);
                let start = begins.then(|| self.start(0, StartKind::Instance(id, &[]), name.span));
                return Some(TypedImage { starts: start.into_iter().collect(), ..self.whole(ty) });
            }
            let message = format!("`{}` is a unit that has no instances", name.text);
            self.report(Diagnostic::error(Code::UnknownType, name.span, message));
            return None;
        }
        if !self.declarations().is_wrong_template(name) {
            self.report_unknown_type(name);
        }
        None
    }

    fn report_unknown_type(&mut self, name: &Ident) {
        if self.generic_named(name).is_some() {
            return self.reject_generic(name);
        }
        let elementary = ElementaryType::ALL.iter().map(|ty| ty.name());
        let derived = self.declarations().type_names();
        let blocks = self.declarations().unit_names(PouKind::has_instances);
        let help = did_you_mean(&name.text, elementary.chain(derived).chain(blocks));
        let of_others = (name.key() == "VARIANT").then(|| Feature::Variants.help());
        let help = self.declarations().elsewhere(name).or(of_others).or(help);
        let message = format!("type `{}` is not declared", name.text);
        let found = Diagnostic::error(Code::UnknownType, name.span, message);
        self.report(found.with_optional_help(help));
    }

    fn array(&mut self, dimensions: &'a [ast::Dimension], element: &'a TypeSpec, span: Span) -> Option<TypedImage<'a>> {
        let bounds: Vec<_> = dimensions.iter().map(|each| self.dimension(each)).collect();
        self.reject_bit(element);
        let (element, lists) = self.element_type(element)?;
        self.body.reject_open_array(element.ty, span)?;
        let bounds: Vec<Dimension> = bounds.into_iter().collect::<Option<_>>()?;
        let size = self.declarations().types().size(element.ty);
        let wanted = bounds.iter().try_fold(u64::from(size), |total, each| total.checked_mul(each.count()));
        let limit = self.declarations().memory_limit();
        let Some(total) = wanted.filter(|total| *total <= limit) else {
            self.declarations_mut().report_too_large(span, wanted);
            return None;
        };
        self.declarations_mut().charge_image(total, span)?;
        let count = total / u64::from(size.max(1));
        let ty = self.declarations_mut().types_mut().array(bounds, element.ty, total as u32);
        let starts = match lists {
            Some(lists) => self.listed_starts(element.ty, lists, count, span)?,
            None if element.starts.is_empty() => element.starts,
            None => {
                let kind = StartKind::Each { count: count as u32, stride: size, starts: element.starts };
                Arc::from([self.start(0, kind, span)])
            }
        };
        Some(TypedImage { ty, image: element.image.repeat(count as usize).into(), starts })
    }

    fn dimension(&mut self, ast: &'a ast::Dimension) -> Option<Dimension> {
        let low = self.body.constant_integer(&ast.low);
        let high = self.body.constant_integer(&ast.high);
        let (low, high) = (low?, high?);
        let span = ast.low.span.to(ast.high.span);
        // One below `low` is an array without elements.
        let is_empty = high.checked_add(1) == Some(low) && self.declarations().dialect(span).has(Feature::EmptyArrays);
        match (i32::try_from(low), i32::try_from(high)) {
            (Ok(low), Ok(high)) if low <= high || is_empty => {
                Some(Dimension { low: i64::from(low), high: i64::from(high) })
            }
            _ => {
                let message = format!("bounds {low}..{high} are reversed or beyond 32 bits");
                self.report(Diagnostic::error(Code::InvalidRange, span, message));
                None
            }
        }
    }

    /// Values count on from the one before, from 0 (3rd ed. 6.4.4.2, Table 11).
    fn enumeration(
        &mut self,
        name: &str,
        ast: &'a [EnumValue],
        base: Option<&Ident>,
        names: Known,
    ) -> Option<TypedImage<'a>> {
        let said = base.map(|base| self.integer_base(base).ok_or(())).transpose().ok()?;
        let base = said.unwrap_or(ElementaryType::Int);
        let mut values: Vec<(String, i128)> = Vec::new();
        let mut next = 0;
        for each in ast {
            if values.iter().any(|(other, _)| other.eq_ignore_ascii_case(&each.name.text)) {
                self.declarations_mut().report_duplicate(&each.name, None);
                continue;
            }
            if let Some(expr) = &each.value {
                next = if base.is_bits() {
                    self.body.constant_of_type(expr, base.into())?.as_int()?
                } else {
                    self.body.constant_integer(expr)?
                };
            }
            if base.wrap(next) != next {
                let message = format!("{next} does not fit an enumeration ({base})");
                self.report(Diagnostic::error(Code::OutOfRange, each.name.span, message));
                return None;
            }
            values.push((each.name.text.clone(), next));
            next += 1;
        }
        let attributes = (names.as_text, names.is_strict);
        let types = self.declarations_mut().types_mut();
        let ty = types.enumeration(name.to_owned(), said, values.clone(), attributes);
        // Values of vendors' system are known by their type only: projects have values of the same names.
        let of_library = ast.first().is_some_and(|each| self.declarations().is_in_library(each.name.span));
        let qualified_only = self.declarations().home().namespace == SYSTEM || of_library && is_qualified_only(name);
        let known = if qualified_only { Vec::new() } else { values };
        let rank = match (names.qualified, of_library) {
            (true, _) => Rank::Qualified,
            (false, true) => Rank::Library,
            (false, false) => Rank::User,
        };
        for (name, value) in known {
            self.declarations_mut().add_enumerator(&name, Enumerator { ty, value, rank });
        }
        Some(self.whole(ty))
    }
}
