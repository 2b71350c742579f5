//! Numbers as faults change them: within their type, and never to NaN.

use onescan_base::ElementaryType;
use onescan_base::elementary::Kind;

use crate::signal::SignalType;

/// The elementary type of a signal that can be shifted: an integer, a bit string or a real.
pub(super) fn number(ty: SignalType) -> Option<ElementaryType> {
    match ty {
        SignalType::Elementary(ty) if ty.is_number() || ty.kind() == Kind::Bits => Some(ty),
        _ => None,
    }
}

/// True for what has bits of its own that a fault may flip: a BOOL or a number.
pub(super) fn has_bits(ty: SignalType) -> bool {
    ty == SignalType::BOOL || number(ty).is_some()
}

/// The bytes of an offset for a signal of type `ty`; nothing if there is no such offset.
pub(super) fn offset(ty: SignalType, by: &str) -> Option<[u8; 8]> {
    if number(ty)?.is_real() {
        let by: f64 = by.parse().ok()?;
        return by.is_finite().then(|| by.to_le_bytes());
    }
    by.parse::<i64>().ok().map(i64::to_le_bytes)
}

/// Shifts a number by a deviate, which is rounded for integers.
pub(super) fn deviate(ty: SignalType, bytes: &mut [u8], by: f64) {
    let is_real = number(ty).is_some_and(ElementaryType::is_real);
    // A deviate beyond the range of i64 saturates, as the sum does.
    shift(ty, bytes, if is_real { by.to_le_bytes() } else { (by.round() as i64).to_le_bytes() });
}

/// Shifts a number in place. NaN stays as it is: its canonical form is part of the digest.
pub(super) fn shift(ty: SignalType, bytes: &mut [u8], by: [u8; 8]) {
    let Some(elementary) = number(ty) else {
        debug_assert!(false, "{ty} cannot be shifted, and `Disturbance::begin` refuses it");
        return;
    };
    if let Some((low, high)) = elementary.range() {
        let size = bytes.len();
        let negative = elementary.is_signed() && bytes[size - 1] & 0x80 != 0;
        let mut wide = [if negative { 0xff } else { 0 }; 16];
        wide[..size].copy_from_slice(bytes);
        let value = (i128::from_le_bytes(wide) + i128::from(i64::from_le_bytes(by))).clamp(low, high);
        bytes.copy_from_slice(&value.to_le_bytes()[..size]);
        return;
    }
    let by = f64::from_le_bytes(by);
    if let Ok(real) = <[u8; 4]>::try_from(&*bytes) {
        let value = f64::from(f32::from_le_bytes(real)) + by;
        if !value.is_nan() {
            bytes.copy_from_slice(&(value as f32).to_le_bytes());
        }
    } else if let Ok(real) = <[u8; 8]>::try_from(&*bytes) {
        let value = f64::from_le_bytes(real) + by;
        if !value.is_nan() {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
    }
}

/// Inverts the bit that `draw` falls on. A real that is not a finite number then stays as it is.
pub(super) fn flip(ty: SignalType, bytes: &mut [u8], draw: u64) {
    let bits = if ty == SignalType::BOOL { 1 } else { 8 * bytes.len() as u64 };
    let Some(bit) = draw.checked_rem(bits).and_then(|bit| usize::try_from(bit).ok()) else { return };
    let mask = 1 << (bit % 8);
    bytes[bit / 8] ^= mask;
    let finite = match *bytes {
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]).is_finite(),
        ref bytes => <[u8; 8]>::try_from(bytes).is_ok_and(|real| f64::from_le_bytes(real).is_finite()),
    };
    if number(ty).is_some_and(ElementaryType::is_real) && !finite {
        bytes[bit / 8] ^= mask;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shifted<const N: usize>(ty: SignalType, value: [u8; N], by: &str) -> [u8; N] {
        let mut bytes = value;
        shift(ty, &mut bytes, offset(ty, by).unwrap());
        bytes
    }

    #[test]
    fn numbers_are_shifted_within_their_type() {
        use SignalType as S;
        assert_eq!(shifted(S::INT, (-5_i16).to_le_bytes(), "-10"), (-15_i16).to_le_bytes());
        assert_eq!(shifted(S::INT, i16::MAX.to_le_bytes(), "1"), i16::MAX.to_le_bytes());
        assert_eq!(shifted(S::SINT, (-128_i8).to_le_bytes(), "-1"), (-128_i8).to_le_bytes());
        assert_eq!(shifted(S::UINT, 3_u16.to_le_bytes(), "-10"), 0_u16.to_le_bytes());
        assert_eq!(shifted(S::ULINT, u64::MAX.to_le_bytes(), "1"), u64::MAX.to_le_bytes());
        assert_eq!(shifted(S::REAL, 1.5_f32.to_le_bytes(), "-0.5"), 1_f32.to_le_bytes());
        assert_eq!(shifted(S::LREAL, f64::NAN.to_le_bytes(), "1"), f64::NAN.to_le_bytes());
        assert_eq!(offset(S::BOOL, "1"), None);
        assert_eq!(offset(S::INT, "0.5"), None);
        assert_eq!(offset(S::LREAL, "inf"), None);
    }

    #[test]
    fn deviates_of_integers_are_rounded() {
        let mut bytes = 7_i16.to_le_bytes();
        deviate(SignalType::INT, &mut bytes, -1.6);
        assert_eq!(bytes, 5_i16.to_le_bytes());
        deviate(SignalType::INT, &mut bytes, f64::MAX);
        assert_eq!(bytes, i16::MAX.to_le_bytes());
    }

    #[test]
    fn a_flip_changes_one_bit_and_leaves_reals_finite() {
        for bit in 0..64 {
            let mut bytes = 1.5_f64.to_le_bytes();
            flip(SignalType::LREAL, &mut bytes, bit);
            let changed = u64::from_le_bytes(bytes) ^ 1.5_f64.to_bits();
            assert!(f64::from_le_bytes(bytes).is_finite());
            // Bit 62 makes a NaN of 1.5, so it stays as it is.
            assert_eq!(changed, if bit == 62 { 0 } else { 1 << bit });
        }
        let mut flag = [1];
        flip(SignalType::BOOL, &mut flag, 77);
        assert_eq!(flag, [0]);
    }
}
