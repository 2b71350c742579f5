//! Packed values as Variants (IEC 62541-6 5.1.9), in the types that PLCopen's information model gives to those of
//! IEC 61131-3; durations and dates as Int64, in ns.

use onescan_server::signal::SignalType as T;
use opcua::types::{DataTypeId, UAString, Variant};

/// The built-in type of `ty`.
pub fn data_type(ty: T) -> DataTypeId {
    match ty {
        T::BOOL => DataTypeId::Boolean,
        T::SINT => DataTypeId::SByte,
        T::BYTE | T::USINT | T::CHAR => DataTypeId::Byte,
        T::INT => DataTypeId::Int16,
        T::WORD | T::UINT | T::WCHAR => DataTypeId::UInt16,
        T::DINT => DataTypeId::Int32,
        T::DWORD | T::UDINT => DataTypeId::UInt32,
        T::LWORD | T::ULINT => DataTypeId::UInt64,
        T::REAL => DataTypeId::Float,
        T::LREAL => DataTypeId::Double,
        T::String(_) | T::Wstring(_) | T::Bytes(_) => DataTypeId::String,
        T::LINT | T::TIME | T::LTIME | T::DATE | T::LDATE | T::TOD | T::LTOD | T::DT | T::LDT => DataTypeId::Int64,
    }
}

/// The elementary type that a Variant's type is read as.
pub fn elementary(value: &Variant) -> Option<T> {
    Some(match value {
        Variant::Boolean(_) => T::BOOL,
        Variant::SByte(_) => T::SINT,
        Variant::Byte(_) => T::USINT,
        Variant::Int16(_) => T::INT,
        Variant::UInt16(_) => T::UINT,
        Variant::Int32(_) => T::DINT,
        Variant::UInt32(_) => T::UDINT,
        Variant::Int64(_) => T::LINT,
        Variant::UInt64(_) => T::ULINT,
        Variant::Float(_) => T::REAL,
        Variant::Double(_) => T::LREAL,
        Variant::String(_) => T::String(80),
        _ => return None,
    })
}

/// The name of a Variant's type, as the standard has it.
pub fn type_name(value: &Variant) -> String {
    format!("{:?}", value.type_id()).trim_start_matches("Scalar(").trim_end_matches(')').to_owned()
}

fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut out = [0; N];
    let len = bytes.len().min(N);
    out[..len].copy_from_slice(&bytes[..len]);
    out
}

/// A packed value as a Variant.
pub fn to_variant(ty: T, packed: &[u8]) -> Variant {
    match data_type(ty) {
        DataTypeId::Boolean => Variant::Boolean(packed[0] != 0),
        DataTypeId::SByte => Variant::SByte(i8::from_le_bytes(array(packed))),
        DataTypeId::Byte => Variant::Byte(packed[0]),
        DataTypeId::Int16 => Variant::Int16(i16::from_le_bytes(array(packed))),
        DataTypeId::UInt16 => Variant::UInt16(u16::from_le_bytes(array(packed))),
        DataTypeId::Int32 => Variant::Int32(i32::from_le_bytes(array(packed))),
        DataTypeId::UInt32 => Variant::UInt32(u32::from_le_bytes(array(packed))),
        DataTypeId::UInt64 => Variant::UInt64(u64::from_le_bytes(array(packed))),
        DataTypeId::Float => Variant::Float(f32::from_le_bytes(array(packed))),
        DataTypeId::Double => Variant::Double(f64::from_le_bytes(array(packed))),
        DataTypeId::String => Variant::String(UAString::from(ty.to_text(packed))),
        _ => Variant::Int64(i64::from_le_bytes(array(packed))),
    }
}

/// Takes a value out of a Variant; false if it is of another type, or too long a text.
pub fn from_variant(ty: T, value: &Variant, packed: &mut [u8]) -> bool {
    let mut put = |bytes: &[u8]| packed.copy_from_slice(bytes);
    match (data_type(ty), value) {
        (DataTypeId::Boolean, Variant::Boolean(value)) => put(&[u8::from(*value)]),
        (DataTypeId::SByte, Variant::SByte(value)) => put(&value.to_le_bytes()),
        (DataTypeId::Byte, Variant::Byte(value)) => put(&[*value]),
        (DataTypeId::Int16, Variant::Int16(value)) => put(&value.to_le_bytes()),
        (DataTypeId::UInt16, Variant::UInt16(value)) => put(&value.to_le_bytes()),
        (DataTypeId::Int32, Variant::Int32(value)) => put(&value.to_le_bytes()),
        (DataTypeId::UInt32, Variant::UInt32(value)) => put(&value.to_le_bytes()),
        (DataTypeId::Int64, Variant::Int64(value)) => put(&value.to_le_bytes()),
        (DataTypeId::UInt64, Variant::UInt64(value)) => put(&value.to_le_bytes()),
        (DataTypeId::Float, Variant::Float(value)) => put(&value.to_le_bytes()),
        (DataTypeId::Double, Variant::Double(value)) => put(&value.to_le_bytes()),
        (DataTypeId::String, Variant::String(text)) => return put_text(ty, text.as_ref(), packed),
        _ => return false,
    }
    true
}

/// A text as the image holds it: the count of its characters, then they.
fn put_text(ty: T, text: &str, packed: &mut [u8]) -> bool {
    let units: Vec<u8> = match ty {
        T::String(_) if text.chars().all(|c| u32::from(c) < 256) => text.chars().map(|c| c as u8).collect(),
        T::Wstring(_) => text.encode_utf16().flat_map(u16::to_le_bytes).collect(),
        _ => return false,
    };
    let count = if matches!(ty, T::Wstring(_)) { units.len() / 2 } else { units.len() };
    if units.len() > packed.len() - 2 {
        return false;
    }
    packed.fill(0);
    packed[..2].copy_from_slice(&(count as u16).to_le_bytes());
    packed[2..2 + units.len()].copy_from_slice(&units);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_comes_back() {
        let types = [T::BOOL, T::BYTE, T::WORD, T::DWORD, T::LWORD, T::SINT, T::INT, T::DINT, T::LINT, T::USINT];
        let more = [T::UINT, T::UDINT, T::ULINT, T::REAL, T::LREAL, T::TIME, T::DT, T::CHAR, T::WCHAR];
        for ty in types.into_iter().chain(more) {
            let packed: Vec<u8> = (0..ty.size()).map(|k| if ty == T::BOOL { 1 } else { 0x41 + k as u8 }).collect();
            let mut back = vec![0; packed.len()];
            assert!(from_variant(ty, &to_variant(ty, &packed), &mut back), "{ty}");
            assert_eq!(back, packed, "{ty}");
            assert!(!from_variant(ty, &Variant::Empty, &mut back));
        }
        let packed = *b"\x02\x00ab\0\0";
        let mut back = [9; 6];
        assert!(from_variant(T::String(4), &to_variant(T::String(4), &packed), &mut back));
        assert_eq!(back, packed);
        assert!(!from_variant(T::String(4), &Variant::from("too long"), &mut back));
    }
}
