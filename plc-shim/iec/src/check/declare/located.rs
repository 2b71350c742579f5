//! Direct addresses to places (2nd ed. 2.4.1.1, 2.4.3.1; 3rd ed. 6.5.5).

use std::sync::Arc;

use super::Declarations;
use super::entry::TypedImage;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature};
use crate::ir::{ElementaryType, Location, Storage, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, SectionKind};
use crate::syntax::direct_address::{AREA_LIMIT, AddressError, DirectAddress, Width};

/// Initial bytes of a located variable.
#[derive(Debug)]
pub(super) struct Initial {
    location: Location,
    image: Arc<[u8]>,
    /// True for a value of the variable's own, which goes before those of types.
    explicit: bool,
}

/// Where a declaration puts its variable.
#[derive(Debug, Clone, Copy)]
pub(in crate::check) enum Placement {
    /// Where there is room.
    Free,
    /// At its direct address.
    At(Storage),
}

impl Declarations<'_> {
    pub(in crate::check) fn invalid_address<T>(&mut self, text: &str, error: AddressError, span: Span) -> Option<T> {
        let message = format!("`{text}` is not a direct address: {error}");
        self.report(Diagnostic::error(Code::InvalidAddress, span, message));
        None
    }

    /// A direct address and its place; the place is nothing for `%I*`.
    pub(in crate::check) fn direct_address(
        &mut self,
        text: &str,
        span: Span,
    ) -> Option<(DirectAddress, Option<Location>)> {
        let address = DirectAddress::parse(text);
        let placed = address.and_then(|address| Ok((address, address.place(self.dialect(span).address_unit())?)));
        match placed {
            Ok((address, place)) => {
                let location = place.map(|(offset, bit)| Location { area: address.area, offset, bit });
                Some((address, location))
            }
            Err(error) => self.invalid_address(text, error, span),
        }
    }

    /// Where a declaration, with `AT` or without, puts its variable; an open address leaves it free.
    pub(in crate::check) fn located(&mut self, ast: &ast::Variable, declared: &TypedImage<'_>) -> Option<Placement> {
        let Some(name) = &ast.address else { return Some(Placement::Free) };
        if DirectAddress::is_hierarchical(&name.text) {
            return self.located_apart(name, ast.initial.is_some(), declared);
        }
        let (address, location) = self.direct_address(&name.text, name.span)?;
        let Some(location) = location else {
            self.require_open_width(address, declared.ty, name)?;
            return Some(Placement::Free);
        };
        if address.width == Width::Bit && self.is_apart_from_bit(declared.ty, name) {
            return Some(Placement::Free);
        }
        self.require_width(address.width, declared.ty, name)?;
        let size = self.types.size(declared.ty);
        if location.offset + size > AREA_LIMIT {
            return self.invalid_address(&name.text, AddressError::TooLarge, name.span);
        }
        self.areas.extend(location, size);
        let (image, explicit) = (declared.image.clone(), ast.initial.is_some());
        self.located.push(Initial { location, image, explicit });
        Some(Placement::At(Storage::Located(location)))
    }

    /// True for a structure or the like at a bit, where `MatIEC` accepts it: nothing of it is at the address.
    fn is_apart_from_bit(&mut self, ty: TypeId, address: &Ident) -> bool {
        let whole = matches!(self.types.get(ty), Type::FunctionBlock { .. } | Type::Nothing);
        let loose = self.dialect(address.span) == Dialect::Matiec;
        let apart = loose && !whole && self.types.elementary(ty).is_none();
        if apart {
            let found = self.types.name(ty);
            let message = format!("`{}` is a bit, so {found} lies elsewhere: nothing connects the two", address.text);
            self.report(Diagnostic::warning(Code::UnsuitableAddress, address.span, message));
        }
        apart
    }

    /// A hierarchical address has a place of its own, wherever it is named.
    fn located_apart(&mut self, name: &Ident, explicit: bool, declared: &TypedImage<'_>) -> Option<Placement> {
        let width = match DirectAddress::parse_hierarchical(&name.text) {
            Ok((_, width)) => width,
            Err(error) => return self.invalid_address(&name.text, error, name.span),
        };
        self.require_width(width, declared.ty, name)?;
        let offset = self.hierarchical_place(&name.text, self.types.size(declared.ty), name.span)?;
        if explicit || declared.image.iter().any(|byte| *byte != 0) {
            self.place(offset, declared.image.clone());
        }
        Some(Placement::At(Storage::Absolute(offset)))
    }

    /// Where a hierarchical address lies, which is the same for all that name it.
    pub(in crate::check) fn hierarchical_place(&mut self, text: &str, size: u32, span: Span) -> Option<u32> {
        let key = text.to_ascii_uppercase();
        if let Some((offset, known)) = self.hierarchical.get(&key)
            && *known >= size
        {
            return Some(*offset);
        }
        let offset = self.allocate(size.max(8), 8, span)?;
        self.hierarchical.insert(key, (offset, size.max(8)));
        Some(offset)
    }

    /// What is located has a place of its own: no parameter of a block, nothing of a function.
    pub(in crate::check) fn may_be_located(
        &mut self,
        unit: PouKind,
        section: SectionKind,
        address: &Ident,
    ) -> Option<()> {
        let open = address.text.ends_with('*');
        let suitable = match section {
            SectionKind::Local | SectionKind::Global => unit != PouKind::Function,
            SectionKind::Input | SectionKind::Output => unit == PouKind::Program || open && unit != PouKind::Function,
            SectionKind::InOut
            | SectionKind::Temp
            | SectionKind::Static
            | SectionKind::Instance
            | SectionKind::External => false,
        };
        if !suitable {
            let message = "a variable of this section has no direct address";
            let found = Diagnostic::error(Code::UnsuitableAddress, address.span, message);
            self.report(found.with_help("declare it in VAR or VAR_GLOBAL"));
            return None;
        }
        Some(())
    }

    /// An open address without a letter for its width, `%I*`, suits every type.
    pub(in crate::check) fn require_open_width(
        &mut self,
        open: DirectAddress,
        ty: TypeId,
        address: &Ident,
    ) -> Option<()> {
        if open.width == Width::Bit { Some(()) } else { self.require_width(open.width, ty, address) }
    }

    /// An elementary variable is as wide as its address says; others begin at a byte.
    pub(in crate::check) fn require_width(&mut self, width: Width, ty: TypeId, address: &Ident) -> Option<()> {
        let found = self.types.name(ty);
        let elementary = self.types.elementary(ty);
        let (suitable, help) = match (elementary, self.types.get(ty)) {
            (_, Type::FunctionBlock { .. } | Type::Nothing) => (false, "instances have no direct address".to_owned()),
            (Some(ElementaryType::Bool), _) => (width == Width::Bit, "a BOOL takes a bit, as in %X0.0".to_owned()),
            (Some(ty), _) => {
                let bits = ty.size() * 8;
                let letter = ["B", "W", "D", "L"][ty.size().trailing_zeros().min(3) as usize];
                (width.bits() == bits, format!("{found} takes {bits} bits: write %{letter} behind the area"))
            }
            (None, _) => (width != Width::Bit, format!("{found} begins at a byte, as in %B0")),
        };
        if !suitable && elementary.is_some() && self.has_loose_width(width, address.span) {
            let message = format!("`{}` is of another width than {found}, which lies at its beginning", address.text);
            self.report(Diagnostic::warning(Code::UnsuitableAddress, address.span, message));
            return Some(());
        }
        if !suitable {
            let message = format!("`{}` does not suit a variable of type {found}", address.text);
            let help = help.replace('%', &format!("%{}", area_letter(&address.text)));
            self.report(Diagnostic::error(Code::UnsuitableAddress, address.span, message).with_help(help));
            return None;
        }
        Some(())
    }

    /// True where an elementary variable lies at an address of another width. A bit holds no more than a BOOL, except
    /// where `MatIEC` takes its byte.
    fn has_loose_width(&self, width: Width, span: Span) -> bool {
        let dialect = self.dialect(span);
        dialect.has(Feature::LooseWidths) && (width != Width::Bit || dialect == Dialect::Matiec)
    }

    /// Writes the initial values of what is located. Where several overlap, a value of a variable's own
    /// goes before that of a type, and what is declared later before what is earlier.
    pub(super) fn initialise_located(&self, image: &mut [u8]) {
        for explicit in [false, true] {
            for initial in self.located.iter().filter(|initial| initial.explicit == explicit) {
                let start = self.areas.offset(initial.location) as usize;
                let Some(target) = image.get_mut(start..start + initial.image.len()) else { continue };
                match (initial.location.bit, target, &initial.image[..]) {
                    (Some(bit), [byte], [value]) => *byte = *byte & !(1 << bit) | (value & 1) << bit,
                    (_, target, bytes) if explicit || bytes.iter().any(|byte| *byte != 0) => {
                        target.copy_from_slice(bytes);
                    }
                    // Zeros that a type gives leave what other variables give to the same bytes.
                    _ => {}
                }
            }
        }
    }
}

fn area_letter(text: &str) -> char {
    text.chars().nth(1).unwrap_or('M').to_ascii_uppercase()
}
