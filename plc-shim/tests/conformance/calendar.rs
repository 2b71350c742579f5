//! Dates and times of day to nanoseconds, by counting days; it shares nothing with the compiler.

const DAY_NS: i128 = 86_400_000_000_000;

/// Nanoseconds since 1970-01-01 of `1994-06-15`, since midnight of `15:36:55.36`, or of both joined by `-`.
pub(crate) fn parse(text: &str) -> Option<i128> {
    let parts: Vec<&str> = text.splitn(4, '-').collect();
    match parts[..] {
        [time] => time_of_day(time),
        [year, month, day] => Some(days(year, month, day)? * DAY_NS),
        [year, month, day, time] => Some(days(year, month, day)? * DAY_NS + time_of_day(time)?),
        _ => None,
    }
}

fn time_of_day(text: &str) -> Option<i128> {
    let mut parts = text.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next()?);
    let whole: i128 = hours.parse::<i128>().ok()? * 60 + minutes.parse::<i128>().ok()?;
    Some(whole * 60 * 1_000_000_000 + super::cell::scaled(seconds, 1_000_000_000)?)
}

fn is_leap(year: i128) -> bool {
    year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)
}

fn days(year: &str, month: &str, day: &str) -> Option<i128> {
    let (year, month, day): (i128, usize, i128) = (year.parse().ok()?, month.parse().ok()?, day.parse().ok()?);
    let length = |year: i128| if is_leap(year) { 366 } else { 365 };
    let before: i128 =
        if year >= 1970 { (1970..year).map(length).sum() } else { -(year..1970).map(length).sum::<i128>() };
    let february = if is_leap(year) { 29 } else { 28 };
    let months = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    Some(before + months.get(..month.checked_sub(1)?)?.iter().sum::<i128>() + day - 1)
}

#[test]
fn days_are_counted_from_1970() {
    assert_eq!(parse("1970-01-01"), Some(0));
    assert_eq!(parse("1969-12-31"), Some(-DAY_NS));
    assert_eq!(parse("2000-03-01"), Some(11_017 * DAY_NS));
    assert_eq!(parse("1970-01-02-00:01:00.5"), Some(DAY_NS + 60_500_000_000));
}
