//! Parts of bit strings by path, `P.w.%X3`, `P.w.%B1`, `P.n.3` (3rd ed. Table 17).

use super::Application;
use super::variable::Spot;
use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::direct_address::Width;
use onescan_iec::syntax::part;

impl Application {
    /// The part of a value in memory; nothing if it has no such part.
    pub(super) fn part_of(&self, from: &Spot, name: &str) -> Option<Spot> {
        let whole = self.elementary(from).filter(|_| from.bit.is_none())?;
        let (width, number) = part::parse(name)?;
        let has_bits = whole.is_bits() && whole != ElementaryType::Bool;
        if !(has_bits || whole.is_integer() && !name.starts_with('%')) {
            return None;
        }
        let (size, taken) = (whole.size() * 8, width.bits());
        if taken >= size || number >= size / taken {
            return None;
        }
        let path = format!("{}.{}", from.path, name.to_ascii_uppercase());
        let at = number * taken;
        let bit = (width == Width::Bit).then_some((at % 8) as u8);
        let ty = width.bit_string().into();
        Some(Spot { path, offset: from.offset + at / 8, bit, ty, address: None, access: from.access })
    }
}
