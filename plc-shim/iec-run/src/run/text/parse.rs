//! Text to values: the longest beginning that is a value, blanks in front passed.

use onescan_base::duration::IecDuration;
use onescan_base::elementary::Kind;

use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::calendar::{CalendarKind, parse_calendar};

/// The bits of the value of type `ty` that `text` begins with; 0 if there is none.
pub(super) fn parse(ty: ElementaryType, text: &str) -> i64 {
    let text = text.trim_start_matches([' ', '\t']);
    match (ty.kind(), ty.size()) {
        (Kind::Bool, _) => i64::from(boolean(text)),
        (Kind::Real, 4) => i64::from(number(text).parse::<f32>().unwrap_or(0.0).to_bits()),
        (Kind::Real, _) => number(text).parse::<f64>().unwrap_or(0.0).to_bits().cast_signed(),
        (Kind::Duration, _) => duration(text),
        (Kind::Date, _) => calendar(CalendarKind::Date, text),
        (Kind::TimeOfDay, _) => calendar(CalendarKind::TimeOfDay, text),
        (Kind::DateTime, _) => calendar(CalendarKind::DateAndTime, text),
        // A text's first character is taken as it is.
        (Kind::Character, _) => 0,
        (Kind::Signed | Kind::Unsigned | Kind::Bits, _) => {
            let (low, high) = ty.range().unwrap_or((0, 0));
            integer(text).clamp(low, high) as i64
        }
    }
}

fn boolean(text: &str) -> bool {
    let word = text.get(..4).is_some_and(|word| word.eq_ignore_ascii_case("TRUE"));
    word || integer(text) != 0
}

fn sign(text: &str) -> (bool, &str) {
    match text.as_bytes().first() {
        Some(b'-') => (true, &text[1..]),
        Some(b'+') => (false, &text[1..]),
        _ => (false, text),
    }
}

/// `12`, `-5`, `16#FF`.
fn integer(text: &str) -> i128 {
    let (negative, digits) = sign(text);
    let bases = [("16#", 16), ("8#", 8), ("2#", 2)];
    let based = bases.iter().find_map(|(mark, base)| Some((digits.strip_prefix(mark)?, *base)));
    let (digits, base) = based.unwrap_or((digits, 10));
    let value = digits
        .chars()
        .map_while(|digit| digit.to_digit(base))
        .fold(0_i128, |value, digit| value.saturating_mul(i128::from(base)).saturating_add(i128::from(digit)));
    if negative { -value } else { value }
}

fn digits(text: &str) -> usize {
    text.bytes().take_while(u8::is_ascii_digit).count()
}

/// The beginning that is a number: `-1`, `1.5`, `1.5E-3`.
fn number(text: &str) -> &str {
    let (_, rest) = sign(text);
    let mut end = text.len() - rest.len();
    let whole = digits(rest);
    end += whole;
    let rest = &text[end..];
    let fraction = rest.strip_prefix('.').map_or(0, digits);
    if fraction > 0 {
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return "0";
    }
    let rest = &text[end..];
    if rest.starts_with(['e', 'E']) {
        let (_, exponent) = sign(&rest[1..]);
        let count = digits(exponent);
        if count > 0 {
            end += rest.len() - exponent.len() + count;
        }
    }
    &text[..end]
}

/// `T#1h30m` or `1h30m`.
fn duration(text: &str) -> i64 {
    after_prefix(text, &["LTIME", "TIME", "LT", "T"]).parse().map_or(0, IecDuration::nanos)
}

/// What follows one of the prefixes and its `#`; all if there is none. Blanks behind are cut off.
fn after_prefix<'t>(text: &'t str, prefixes: &[&str]) -> &'t str {
    let text = text.trim_end_matches([' ', '\t']);
    match text.split_once('#') {
        Some((prefix, rest)) if prefixes.iter().any(|known| known.eq_ignore_ascii_case(prefix)) => rest,
        _ => text,
    }
}

/// `D#1984-06-25` or `1984-06-25`.
fn calendar(kind: CalendarKind, text: &str) -> i64 {
    let prefixes = match kind {
        CalendarKind::Date => ["D", "DATE", "LD", "LDATE"],
        CalendarKind::TimeOfDay => ["TOD", "TIME_OF_DAY", "LTOD", "LTIME_OF_DAY"],
        CalendarKind::DateAndTime | CalendarKind::Parts => ["DT", "DATE_AND_TIME", "LDT", "LDATE_AND_TIME"],
    };
    parse_calendar(kind, after_prefix(text, &prefixes)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_beginning_counts() {
        let int = |text| parse(ElementaryType::Int, text);
        let found = ["12", " -5x", "16#fF ", "99999", "-99999", "", "x", "2#101", "+7"].map(int);
        assert_eq!(found, [12, -5, 255, 32767, -32768, 0, 0, 5, 7]);
        let lreal = |text| f64::from_bits(parse(ElementaryType::Lreal, text).cast_unsigned());
        let found = ["1.5", "-1.5E-3kg", "1.", ".5", "1e", "1E+2", "-", "e5", "1e999"].map(lreal);
        assert_eq!(found, [1.5, -1.5e-3, 1.0, 0.5, 1.0, 100.0, 0.0, 0.0, f64::INFINITY]);
        let bool = |text| parse(ElementaryType::Bool, text);
        assert_eq!(["TRUE", "true!", "1", "FALSE", "", "0"].map(bool), [1, 1, 1, 0, 0, 0]);
        let time = |text| parse(ElementaryType::Time, text);
        assert_eq!(["T#1s", "time#1.5ms ", "2us", "x"].map(time), [1_000_000_000, 1_500_000, 2_000, 0]);
    }
}
