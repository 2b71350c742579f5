//! Values as they stand in a trace, to bytes of the PLC's memory and back.

use onescan_iec::ElementaryType;
use onescan_iec_run::Variable;

use super::calendar;

/// Units of durations, in nanoseconds; longer names before their endings.
const UNITS: [(&str, i128); 7] = [
    ("ms", 1_000_000),
    ("us", 1_000),
    ("ns", 1),
    ("s", 1_000_000_000),
    ("m", 60_000_000_000),
    ("h", 3_600_000_000_000),
    ("d", 86_400_000_000_000),
];

/// A decimal number times `unit`, exactly.
pub(crate) fn scaled(text: &str, unit: i128) -> Option<i128> {
    let (sign, text) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let digits: i128 = format!("{whole}{fraction}").parse().ok()?;
    let parts = digits * unit;
    let divisor = 10_i128.checked_pow(fraction.len() as u32)?;
    (parts % divisor == 0).then_some(sign * parts / divisor)
}

/// Nanoseconds of `1.5s`.
pub(crate) fn duration_ns(text: &str) -> Option<i128> {
    UNITS.iter().find_map(|(name, unit)| scaled(text.strip_suffix(name)?, *unit))
}

fn integer(text: &str) -> Option<i128> {
    match text.split_once('#') {
        Some((radix, digits)) => i128::from_str_radix(digits, radix.parse().ok()?).ok(),
        None => text.parse().ok(),
    }
}

fn unquoted(text: &str) -> Option<&str> {
    text.strip_prefix('\'')?.strip_suffix('\'')
}

/// The bytes that a variable holds when its value is `text`.
pub(crate) fn bytes(text: &str, variable: &Variable) -> Option<Vec<u8>> {
    use ElementaryType as E;
    let Some(ty) = variable.ty else {
        return string_bytes(unquoted(text)?, variable);
    };
    let number = match ty {
        E::Bool => match text {
            "#" | "TRUE" | "1" => 1,
            "." | "FALSE" | "0" => 0,
            _ => return None,
        },
        E::Real => i128::from(text.parse::<f32>().ok()?.to_bits()),
        E::Lreal => i128::from(text.parse::<f64>().ok()?.to_bits()),
        E::Char | E::Wchar => i128::from(u32::from(unquoted(text)?.chars().next()?)),
        _ if ty.is_duration() => duration_ns(text)?,
        _ if ty.is_calendar() => calendar::parse(text)?,
        _ => integer(text)?,
    };
    Some(number.to_le_bytes()[..ty.size() as usize].to_vec())
}

fn is_wide(variable: &Variable) -> bool {
    variable.type_name.starts_with("WSTRING")
}

/// A count of 16 bits, the characters, zeros.
fn string_bytes(text: &str, variable: &Variable) -> Option<Vec<u8>> {
    if !variable.type_name.contains("STRING") {
        return None;
    }
    let units: Vec<u16> = text.encode_utf16().collect();
    let mut bytes = (units.len() as u16).to_le_bytes().to_vec();
    for unit in units {
        let width = if is_wide(variable) { 2 } else { 1 };
        bytes.extend_from_slice(&unit.to_le_bytes()[..width]);
    }
    bytes.resize(variable.size as usize, 0);
    Some(bytes)
}

/// True if a variable that holds `found` has the value that `wanted` encodes: every NaN is one.
pub(crate) fn same(wanted: &[u8], found: &[u8], variable: &Variable) -> bool {
    let nan = |bytes: &[u8]| match variable.ty {
        Some(ElementaryType::Real) => f32::from_bits(raw(bytes) as u32).is_nan(),
        Some(ElementaryType::Lreal) => f64::from_bits(raw(bytes)).is_nan(),
        _ => false,
    };
    wanted == found || nan(wanted) && nan(found)
}

fn raw(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte))
}

/// What a variable holds, for a message.
pub(crate) fn text(bytes: &[u8], variable: &Variable) -> String {
    use ElementaryType as E;
    let Some(ty) = variable.ty else {
        let used = usize::from(u16::from_le_bytes([bytes[0], bytes[1]]));
        let width = if is_wide(variable) { 2 } else { 1 };
        let units: Vec<u16> = bytes[2..].chunks(width).take(used).map(|unit| raw(unit) as u16).collect();
        return format!("'{}'", String::from_utf16_lossy(&units));
    };
    let raw = raw(bytes);
    let unused = 64 - ty.size() * 8;
    match ty {
        E::Bool => if raw == 1 { "TRUE" } else { "FALSE" }.to_owned(),
        E::Real => f32::from_bits(raw as u32).to_string(),
        E::Lreal => f64::from_bits(raw).to_string(),
        E::Char | E::Wchar => format!("'{}'", char::from_u32(raw as u32).unwrap_or('?')),
        _ if ty.is_duration() || ty.is_calendar() => format!("{}ns", raw as i64),
        _ if ty.is_signed() => ((raw as i64) << unused >> unused).to_string(),
        _ if ty.is_bits() => format!("16#{raw:X}"),
        _ => raw.to_string(),
    }
}

#[test]
fn durations_are_exact() {
    assert_eq!(duration_ns("1.5s"), Some(1_500_000_000));
    assert_eq!(duration_ns("-20ms"), Some(-20_000_000));
    assert_eq!(duration_ns("0.1ns"), None);
}
