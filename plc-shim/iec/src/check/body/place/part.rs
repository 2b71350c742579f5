//! Parts of bit strings (3rd ed. 6.5.3, Table 17): `a.%X3`, `a.%B1`, and `a.3` of vendors.

use super::Located;
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{ElementaryType, Part, Place, Storage, Type};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};
use crate::syntax::direct_address::Width;
use crate::syntax::part::parse;

impl Body<'_, '_> {
    /// The part of `base` that is written as `name`.
    pub(in crate::check) fn part(&mut self, base: Located, name: &Ident, span: Span) -> Option<Located> {
        let Some((width, number)) = parse(&name.text) else {
            let message = format!("`{}` is not a part: write %X, %B, %W or %D and a number", name.text);
            self.report(Diagnostic::error(Code::InvalidPart, name.span, message));
            return None;
        };
        let plain = !name.text.starts_with('%');
        self.part_at(base, width, u64::from(number), plain, span)
    }

    /// True for the name of a constant, which vendors let stand for a bit's number.
    pub(in crate::check) fn is_constant(&mut self, name: &Ident) -> bool {
        matches!(self.variable_named(name), Some(Ok(variable)) if variable.constant.is_some())
    }

    /// `a.Ready`, where `Ready` is a constant.
    pub(super) fn named_bit(&mut self, base: Located, name: &Ident, span: Span) -> Option<Located> {
        let expr = ast::Expr { kind: ast::ExprKind::Name(name.clone()), span: name.span, height: 1 };
        let number = self.constant_integer(&expr)?;
        self.part_at(base, Width::Bit, u64::try_from(number).unwrap_or(u64::MAX), true, span)
    }

    /// `plain` is true without a `%`: so written, integers have bits everywhere.
    fn part_at(&mut self, base: Located, width: Width, number: u64, plain: bool, span: Span) -> Option<Located> {
        let loose = plain && self.declarations.dialect(span).has(Feature::LooseParts);
        let ty = match self.declarations.types().get(base.place.ty) {
            Type::Elementary(ElementaryType::Bool) if loose && width == Width::Bit && number == 0 => return Some(base),
            Type::Elementary(ty) => Some(*ty),
            Type::Enumeration { base, .. } if loose => Some(*base),
            _ => None,
        };
        let bits = |ty: &ElementaryType| ty.is_bits() && *ty != ElementaryType::Bool;
        let integers = plain || self.declarations.dialect(span).has(Feature::IntegerParts);
        let Some(whole) = ty.filter(|ty| bits(ty) || integers && ty.is_integer()) else {
            let found = self.type_name(base.place.ty);
            let message = format!("BYTE, WORD, DWORD and LWORD have parts, this is {found}");
            self.report(Diagnostic::error(Code::InvalidPart, span, message));
            return None;
        };
        let (size, taken) = (whole.size() * 8, width.bits());
        let count = if taken < size { size / taken } else { 0 };
        if number >= u64::from(count) {
            let message = match count.checked_sub(1) {
                Some(last) => format!("{whole} has the parts 0 to {last} of this width, not {number}"),
                None => format!("{whole} has no parts of {taken} bits"),
            };
            self.report(Diagnostic::error(Code::InvalidPart, span, message));
            return None;
        }
        let place = taken_from(base.place, whole, width, number as u32 * taken);
        Some(Located { place: Place { span, ..place }, access: base.access })
    }
}

/// The part of `width` that begins at bit `shift`. Memory is little-endian, so that a part of whole
/// bytes has an address of its own.
fn taken_from(place: Place, whole: ElementaryType, width: Width, shift: u32) -> Place {
    let ty = width.bit_string().into();
    if let Storage::Register(_) = place.storage {
        let part = match place.part {
            Some(outer) => Part { shift: outer.shift + shift, ..outer },
            None => Part { whole, shift },
        };
        return Place { part: Some(part), ty, ..place };
    }
    let inner = place.member(shift / 8, ty);
    Place { part: (width == Width::Bit).then(|| Part::bit((shift % 8) as u8)), ..inner }
}
