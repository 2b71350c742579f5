//! Values to text, without allocation.

use std::fmt::{self, Write};

use onescan_base::duration::IecDuration;
use onescan_base::elementary::Kind;

use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::calendar::{DAY_NS, civil_from_days};

/// Text of at most so many bytes, all of them ASCII.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    bytes: [u8; 64],
    used: usize,
}

impl Line {
    pub(crate) fn new() -> Self {
        Self { bytes: [0; 64], used: 0 }
    }

    pub(crate) fn push(&mut self, byte: u8) {
        if let Some(target) = self.bytes.get_mut(self.used) {
            *target = byte;
            self.used += 1;
        }
    }

    /// As many of the bytes as there is room for.
    pub(crate) fn append(&mut self, bytes: &[u8]) {
        let count = bytes.len().min(self.bytes.len() - self.used);
        if let (Some(room), Some(bytes)) = (self.bytes.get_mut(self.used..self.used + count), bytes.get(..count)) {
            room.copy_from_slice(bytes);
            self.used += count;
        }
    }

    pub(crate) fn text(&self) -> &str {
        debug_assert!(self.bytes.iter().take(self.used).all(u8::is_ascii), "a line is ASCII, and so is its beginning");
        self.bytes.get(..self.used).and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or("")
    }
}

impl Write for Line {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.append(text.as_bytes());
        Ok(())
    }
}

/// The text of a value of type `ty`, given by its bits.
pub(crate) fn format(ty: ElementaryType, bits: i64) -> Line {
    let mut line = Line::new();
    // Writing to a line never fails.
    let _ = match (ty.kind(), ty.size()) {
        (Kind::Bool, _) => line.write_str(if bits == 0 { "FALSE" } else { "TRUE" }),
        (Kind::Real, 4) => real(&mut line, f32::from_bits(bits as u32), f64::from(f32::from_bits(bits as u32))),
        (Kind::Real, _) => {
            let value = f64::from_bits(bits.cast_unsigned());
            real(&mut line, value, value)
        }
        (Kind::Duration, _) => write!(line, "{}#{}", ty.literal_prefix(), IecDuration::from_nanos(bits)),
        (Kind::Date | Kind::TimeOfDay | Kind::DateTime, _) => calendar(&mut line, ty, bits),
        // A character is its own text.
        (Kind::Character, _) => Ok(()),
        (Kind::Signed, _) => {
            if bits < 0 {
                line.push(b'-');
            }
            whole(&mut line, bits.unsigned_abs());
            Ok(())
        }
        (Kind::Unsigned | Kind::Bits, _) => {
            whole(&mut line, bits.cast_unsigned());
            Ok(())
        }
    };
    line
}

/// The text of a LTIME without sign, as vendors write it.
pub(crate) fn format_long_time(ns: u64) -> Line {
    let mut line = Line::new();
    // Writing to a line never fails.
    let _ = write!(line, "LTIME#{}", IecDuration::display_unsigned(ns));
    line
}

/// The decimal digits of a number, the last ones first into their places.
fn whole(line: &mut Line, number: u64) {
    let mut digits = [b'0'; 20];
    let (mut rest, mut first) = (number, digits.len());
    for digit in digits.iter_mut().rev() {
        *digit = b'0' + (rest % 10) as u8;
        rest /= 10;
        first -= 1;
        if rest == 0 {
            break;
        }
    }
    line.append(digits.get(first..).unwrap_or_default());
}

/// The shortest digits that read back as the same number. `value` is `number` in its own width.
fn real<T: fmt::Display + fmt::LowerExp>(line: &mut Line, value: T, number: f64) -> fmt::Result {
    let size = number.abs();
    if number.is_nan() {
        return line.write_str("NaN");
    }
    if size.is_infinite() {
        return line.write_str(if number > 0.0 { "INF" } else { "-INF" });
    }
    if number == 0.0 || (1.0e-5..1.0e16).contains(&size) {
        write!(line, "{value}")?;
        return if number.fract() == 0.0 { line.write_str(".0") } else { Ok(()) };
    }
    let mut digits = Line::new();
    write!(digits, "{value:e}")?;
    let (mantissa, exponent) = digits.text().split_once('e').unwrap_or(("0", "0"));
    let point = if mantissa.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    write!(line, "{mantissa}{point}E{sign}{exponent}")
}

/// `D#1984-06-25`, `TOD#15:36:55.36`, `DT#1984-06-25-15:36:55.36` (2nd ed. Table 8).
fn calendar(line: &mut Line, ty: ElementaryType, ns: i64) -> fmt::Result {
    let (days, ns) = (ns.div_euclid(DAY_NS), ns.rem_euclid(DAY_NS));
    write!(line, "{}#", ty.literal_prefix())?;
    if ty.kind() != Kind::TimeOfDay {
        let (year, month, day) = civil_from_days(days);
        write!(line, "{year:04}-{month:02}-{day:02}")?;
    }
    if ty.kind() == Kind::DateTime {
        line.push(b'-');
    }
    if ty.kind() != Kind::Date {
        let seconds = ns / 1_000_000_000;
        write!(line, "{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)?;
        let mut rest = ns % 1_000_000_000;
        if rest > 0 {
            line.push(b'.');
        }
        let mut weight = 100_000_000;
        while rest > 0 {
            write!(line, "{}", rest / weight)?;
            rest %= weight;
            weight /= 10;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(ty: ElementaryType, bits: i64) -> String {
        format(ty, bits).text().to_owned()
    }

    #[test]
    fn reals_are_the_shortest_that_read_back() {
        let lreal = |value: f64| text(ElementaryType::Lreal, value.to_bits().cast_signed());
        let real = |value: f32| text(ElementaryType::Real, i64::from(value.to_bits()));
        let found: Vec<_> = [1.5, 0.1, -0.0, 100.0, 1.0e16, 1.0e-6, 12_345.678, -2.5e-300].map(lreal).into();
        assert_eq!(found, ["1.5", "0.1", "-0.0", "100.0", "1.0E+16", "1.0E-6", "12345.678", "-2.5E-300"]);
        assert_eq!(real(0.1), "0.1");
        assert_eq!(real(16_777_216.0), "16777216.0");
        assert_eq!([lreal(f64::NAN), lreal(f64::NEG_INFINITY)], ["NaN", "-INF"]);
    }

    #[test]
    fn the_longest_text_of_each_type_fits_its_place() {
        for value in [f64::MIN, -f64::MIN_POSITIVE, -1.234_567_890_123_456_7e-5, f64::from(f32::MIN)] {
            assert!(text(ElementaryType::Lreal, value.to_bits().cast_signed()).len() <= 48);
        }
        assert_eq!(text(ElementaryType::Ltime, i64::MIN), "LT#-106751d23h47m16s854ms775us808ns");
        assert_eq!(text(ElementaryType::Time, 0), "T#0s");
        assert_eq!(text(ElementaryType::Ulint, -1), "18446744073709551615");
    }
}
