//! Numbers for people.

/// The number with four digits that count: `7`, `0.05236`, `-1234`, `1.2e-9`.
///
/// Large and small ones have a power of ten; nothing is lost of what the four digits say.
pub fn short(value: f64) -> String {
    significant(value, 4)
}

/// Two numbers with six digits that count, or with as many more as it takes to see that they differ.
pub fn apart(one: f64, other: f64) -> [String; 2] {
    let written = |digits| [one, other].map(|value| significant(value, digits));
    // Seventeen digits name each number.
    (6..17).map(written).find(|[one, other]| one != other).unwrap_or_else(|| written(17))
}

/// The number with so many digits that count, as [`short`] writes it.
fn significant(value: f64, digits: usize) -> String {
    let after = digits.saturating_sub(1);
    let rounded = format!("{value:.after$e}");
    let Some((mantissa, exponent)) = rounded.split_once('e') else { return rounded };
    let Ok(exponent) = exponent.parse::<i32>() else { return rounded };
    let plain = |text: &str| {
        let zeros = if text.contains('.') { text.trim_end_matches('0') } else { text };
        zeros.trim_end_matches('.').to_owned()
    };
    if !(-4..=5).contains(&exponent) {
        return format!("{}e{exponent}", plain(mantissa));
    }
    // The rounded number, not the value: 0.99996 has four digits as 1.
    let decimals = after.saturating_add_signed(-(exponent as isize));
    rounded.parse::<f64>().map_or(rounded, |value| plain(&format!("{value:.decimals$}")))
}

/// So many of something whose plural ends in `s`: `1 run`, `20 edges`.
pub fn counted(count: u64, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_count() {
        let written =
            [7.0, 0.0, 100.0, 0.052_359_9, -1234.56, 123_456.0, 0.999_96, 1.2e-9, 4e12, f64::INFINITY].map(short);
        assert_eq!(
            written,
            ["7", "0", "100", "0.05236", "-1235", "123500", "1", "1.2e-9", "4e12", "inf"].map(str::to_owned)
        );
    }

    #[test]
    fn two_numbers_have_as_many_digits_as_show_that_they_differ() {
        let shown = |one, other| apart(one, other).join(" ");
        assert_eq!(shown(0.013_874_999_998_597_898, 0.014_499_999_998_519_614), "0.013875 0.0145");
        assert_eq!(shown(1.0, 1.000_000_01), "1 1.00000001");
        assert_eq!(shown(0.1 + 0.2, 0.3), "0.30000000000000004 0.29999999999999999");
        assert_eq!(shown(123_456_789.0, 123_456_788.0), "1.23456789e8 1.23456788e8");
        assert_eq!(shown(0.0, -0.0), "0 -0");
        assert_eq!(shown(f64::NAN, 1.0), "NaN 1");
    }

    #[test]
    fn one_is_not_a_plural() {
        assert_eq!([0, 1, 2].map(|count| counted(count, "run")), ["0 runs", "1 run", "2 runs"]);
    }
}
