//! Structures: members one behind the other, or where their addresses say (3rd ed. 6.4.4.6, Table 11).

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use super::Written;
use crate::check::body::Surrounding;
use crate::check::declare::{Need, Start, TypedImage, Within, align_up, moved};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Field, Place, Storage, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident};
use crate::syntax::direct_address::{DirectAddress, RelativeAddress, Width};

/// Whether members with addresses may lie on the same bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sharing {
    Refused,
    Allowed,
}

/// How members are placed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placing {
    pub(super) sharing: Sharing,
    /// Most bytes that members are aligned to, where an attribute says so.
    pub(super) packing: Option<u32>,
}

impl Placing {
    /// As the types of the members have it.
    pub(super) fn natural(sharing: Sharing) -> Self {
        Self { sharing, packing: None }
    }
}

/// A structure while its members are placed.
struct Making<'a> {
    fields: Vec<Field>,
    /// Their names in capitals.
    names: BTreeSet<String>,
    image: Vec<u8>,
    starts: Vec<Start<'a>>,
    taken: Taken,
    /// Where the member before lies, if it is a `BIT`.
    last_bit: Option<(u32, u8)>,
    base: Option<TypeId>,
}

/// Bits that members take: disjoint ranges, end by begin.
#[derive(Default)]
struct Taken(BTreeMap<u64, u64>);

impl Taken {
    fn touches(&self, bits: &Range<u64>) -> bool {
        self.0.range(..bits.end).next_back().is_some_and(|(_, end)| *end > bits.start)
    }

    fn add(&mut self, bits: Range<u64>) {
        let mut joined = bits;
        while let Some((begin, end)) = self.0.range(..joined.end).next_back().map(|(begin, end)| (*begin, *end)) {
            if end <= joined.start {
                break;
            }
            self.0.remove(&begin);
            joined = joined.start.min(begin)..joined.end.max(end);
        }
        self.0.insert(joined.start, joined.end);
    }
}

impl<'a> Written<'_, 'a> {
    pub(super) fn structure(
        &mut self,
        name: &str,
        (reserved, extends): (Option<TypeId>, Option<&Ident>),
        (members, placing): (&'a [ast::Field], Placing),
        span: Span,
    ) -> Option<TypedImage<'a>> {
        let mut making = self.extended(extends)?;
        let mut sound = true;
        for member in members {
            if making.names.contains(&member.name.text.to_ascii_uppercase()) {
                self.declarations_mut().report_duplicate(&member.name, None);
                continue;
            }
            // The members so far are around the next one; they are not copied for each.
            let around = reserved.filter(|_| member.initial.is_some()).map(|ty| {
                let place = Place::whole(Storage::Instance(0), ty, span);
                Surrounding { place, declared: std::mem::take(&mut making.fields) }
            });
            let outer = self.body.surround(around);
            // The members behind a wrong one are looked at, too.
            sound &= self.member(&mut making, member, (placing, span)).is_some();
            if let Some(Surrounding { declared, .. }) = self.body.surround(outer) {
                let added = std::mem::replace(&mut making.fields, declared);
                making.fields.extend(added);
            }
        }
        if !sound {
            return None;
        }
        // What has no members takes a byte, so that no array has more elements than bytes.
        let Making { fields, mut image, starts, base, .. } = making;
        image.resize(image.len().max(1), 0);
        let align = self.declarations().types().structure_align(&fields, placing.packing);
        image.resize(align_up(image.len() as u32, align) as usize, 0);
        let image: Arc<[u8]> = image.into();
        let ty = reserved.unwrap_or_else(|| self.declarations_mut().types_mut().structure(name.to_owned()));
        self.declarations_mut().types_mut().complete_structure(ty, fields, align, image.clone());
        if let Some(base) = base {
            self.declarations_mut().note_structure_base(ty, base);
        }
        // What members of other structures do has been said where they are declared.
        let within = |start: &Start<'_>| start.within.or(Some(Within { structure: ty, offset: start.offset }));
        let starts = starts.into_iter().map(|start| Start { within: within(&start), ..start }).collect();
        Some(TypedImage { ty, image, starts })
    }

    fn member(
        &mut self,
        making: &mut Making<'a>,
        member: &'a ast::Field,
        (placing, span): (Placing, Span),
    ) -> Option<()> {
        let mut resolved = self.resolve(&member.spec, Need::Size)?;
        self.body.reject_open_array(resolved.ty, member.spec.span)?;
        if let Some(initial) = &member.initial {
            resolved = self.with_initial(&resolved, initial)?;
        }
        self.place_member(making, member, &resolved, (placing, span))
    }

    /// The members of the structure that another adds to, as vendors have it.
    fn extended(&mut self, base: Option<&Ident>) -> Option<Making<'a>> {
        let (mut fields, mut image, mut starts, mut extended) = (Vec::new(), Vec::new(), Vec::new(), None);
        if let Some(name) = base {
            let resolved = self.type_by_name(name, Need::Size)?;
            let Type::Struct { fields: inherited, .. } = self.declarations().types().get(resolved.ty) else {
                let message = format!("`{}` is not a structure", name.text);
                self.report(Diagnostic::error(Code::WrongBase, name.span, message));
                return None;
            };
            (fields, image, starts) = (inherited.clone(), resolved.image.to_vec(), resolved.starts.to_vec());
            extended = Some(resolved.ty);
        }
        let mut taken = Taken::default();
        if !image.is_empty() {
            taken.add(0..8 * image.len() as u64);
        }
        let names = fields.iter().map(|field: &Field| field.name.to_ascii_uppercase()).collect();
        Some(Making { fields, names, image, starts, taken, last_bit: None, base: extended })
    }

    /// Adds a member where its address says, else behind all that there are.
    fn place_member(
        &mut self,
        making: &mut Making<'a>,
        member: &ast::Field,
        resolved: &TypedImage<'a>,
        (placing, span): (Placing, Span),
    ) -> Option<()> {
        let align = self.declarations().types().packed_align(resolved.ty, placing.packing);
        let behind = align_up(making.image.len() as u32, align);
        let is_bit = self.is_bit(member);
        let open = member.address.as_ref().and_then(open_address);
        let (offset, bit) = match &member.address {
            Some(address) => match open {
                Some(open) => {
                    self.declarations_mut().require_open_width(open, resolved.ty, address)?;
                    (behind, None)
                }
                None => self.relative_place(address, resolved.ty)?,
            },
            None if is_bit => match making.last_bit {
                Some((byte, bit)) if bit < 7 => (byte, Some(bit + 1)),
                _ => (behind, Some(0)),
            },
            None => (behind, None),
        };
        making.last_bit = bit.filter(|_| is_bit).map(|bit| (offset, bit));
        let end = offset as usize + resolved.image.len();
        if end as u64 > self.declarations().memory_limit() {
            self.declarations_mut().report_too_large(span, Some(end as u64));
            return None;
        }
        let begin = 8 * u64::from(offset) + bit.map_or(0, u64::from);
        let bits = begin..begin + if bit.is_some() { 1 } else { 8 * resolved.image.len() as u64 };
        let shares = making.taken.touches(&bits);
        if shares && placing.sharing == Sharing::Refused {
            return self.report_shared(member);
        }
        making.taken.add(bits);
        self.declarations_mut().charge_image(end.saturating_sub(making.image.len()) as u64, span)?;
        making.image.resize(making.image.len().max(end), 0);
        // Of members that share bytes the first begins with its type's value, the others with their own only.
        if !shares || member.initial.is_some() {
            let target = making.image.get_mut(offset as usize..end)?;
            match (bit, target, &resolved.image[..]) {
                (Some(bit), [byte], [value]) => *byte = *byte & !(1 << bit) | (value & 1) << bit,
                (_, target, bytes) => target.copy_from_slice(bytes),
            }
            making.starts.extend(moved(&resolved.starts, offset));
        }
        making.names.insert(member.name.text.to_ascii_uppercase());
        making.fields.push(Field {
            name: member.name.text.clone(),
            ty: resolved.ty,
            offset,
            bit,
            open: open.map(|open| open.area),
        });
        Some(())
    }

    /// True for a member of the vendors' type `BIT`: up to eight that follow each other share a byte.
    pub(super) fn is_bit(&self, member: &ast::Field) -> bool {
        member.address.is_none() && self.is_bit_type(&member.spec)
    }

    /// Byte and bit of `%B4` or `%X3.0`. `%B` is for members of every type, as the standard's examples
    /// have it; the wider ones are for types of their width.
    fn relative_place(&mut self, address: &Ident, ty: TypeId) -> Option<(u32, Option<u8>)> {
        let unit = self.declarations().dialect(address.span).address_unit();
        let found = match RelativeAddress::parse(&address.text, unit) {
            Ok(found) => found,
            Err(error) => return self.declarations_mut().invalid_address(&address.text, error, address.span),
        };
        let is_bool = self.body.elementary(ty) == Some(ElementaryType::Bool);
        let suitable = match found.width {
            Width::Byte => true,
            Width::Bit => is_bool,
            width => self.body.elementary(ty).is_none_or(|ty| ty.size() == width.bytes()),
        };
        if !suitable {
            let message = format!("`{}` does not suit a member of type {}", address.text, self.body.type_name(ty));
            let found = Diagnostic::error(Code::UnsuitableAddress, address.span, message);
            self.report(found.with_help("write %B and the member's first byte; a BOOL may have a bit, as in %X3.0"));
            return None;
        }
        Some((found.byte, found.bit))
    }

    fn report_shared<T>(&mut self, member: &ast::Field) -> Option<T> {
        let message = format!("`{}` lies on bytes of a member before it", member.name.text);
        let span = member.address.as_ref().map_or(member.name.span, |address| address.span);
        let found = Diagnostic::error(Code::SharedBytes, span, message);
        self.report(found.with_help("write STRUCT OVERLAP if members are to share bytes"));
        None
    }
}

/// `%I*`, `%QW*`: each structure has the member in itself, and `VAR_CONFIG` may give it a place (3rd ed. Table 11,
/// feature 11).
fn open_address(address: &Ident) -> Option<DirectAddress> {
    DirectAddress::parse(&address.text).ok().filter(|_| address.text.ends_with('*'))
}

#[cfg(test)]
mod tests {
    use super::Taken;

    #[test]
    fn ranges_that_touch_are_found_and_joined() {
        let mut taken = Taken::default();
        for bits in [0..8, 16..24, 40..41] {
            assert!(!taken.touches(&bits));
            taken.add(bits);
        }
        assert!(!taken.touches(&(8..16)) && !taken.touches(&(41..48)));
        assert!(taken.touches(&(7..9)) && taken.touches(&(23..24)) && taken.touches(&(0..100)));
        taken.add(4..44);
        assert_eq!(taken.0.into_iter().collect::<Vec<_>>(), [(0, 44)]);
    }
}
