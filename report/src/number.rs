//! Numbers for people.

/// The number with four digits that count: `7`, `0.05236`, `-1234`, `1.2e-9`.
///
/// Large and small ones have a power of ten; nothing is lost of what the four digits say.
pub fn short(value: f64) -> String {
    const DECIMALS: i32 = 3;
    let rounded = format!("{value:.3e}");
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
    let decimals = usize::try_from(DECIMALS - exponent).unwrap_or(0);
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
    fn one_is_not_a_plural() {
        assert_eq!([0, 1, 2].map(|count| counted(count, "run")), ["0 runs", "1 run", "2 runs"]);
    }
}
