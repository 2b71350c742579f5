//! Dates and times of day (2nd ed. 2.2.3.2, 3rd ed. 6.3.5), in the proleptic Gregorian calendar.

/// Nanoseconds of a day.
pub const DAY_NS: i64 = 86_400_000_000_000;

/// What a literal stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CalendarKind {
    Date,
    TimeOfDay,
    DateAndTime,
    /// `DTL#1994-06-15-15:36:55.36` of Siemens, a structure
    Parts,
}

/// The kind and length (`true` for the types of 64 bits of the 3rd edition) of a prefix.
pub fn calendar_prefix(prefix: &str) -> Option<(CalendarKind, bool)> {
    Some(match prefix.to_ascii_uppercase().as_str() {
        "D" | "DATE" => (CalendarKind::Date, false),
        "LD" | "LDATE" => (CalendarKind::Date, true),
        "TOD" | "TIME_OF_DAY" => (CalendarKind::TimeOfDay, false),
        "LTOD" | "LTIME_OF_DAY" => (CalendarKind::TimeOfDay, true),
        "DT" | "DATE_AND_TIME" => (CalendarKind::DateAndTime, false),
        "LDT" | "LDATE_AND_TIME" => (CalendarKind::DateAndTime, true),
        "DTL" => (CalendarKind::Parts, true),
        _ => return None,
    })
}

/// Nanoseconds since 1970-01-01, or since midnight for a time of day.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn parse_calendar(kind: CalendarKind, text: &str) -> Result<i64, String> {
    let (date, time) = match kind {
        CalendarKind::Date => (Some(text), None),
        CalendarKind::TimeOfDay => (None, Some(text)),
        CalendarKind::DateAndTime | CalendarKind::Parts => {
            let middle = text.match_indices('-').nth(2).map(|(at, _)| at).ok_or("the time of day is missing")?;
            (Some(&text[..middle]), Some(&text[middle + 1..]))
        }
    };
    let days = date.map_or(Ok(0), parse_date)?;
    let time = time.map_or(Ok(0), parse_time_of_day)?;
    let ns = i128::from(days) * i128::from(DAY_NS) + i128::from(time);
    i64::try_from(ns).map_err(|_| "dates reach from 1677-09-22 to 2262-04-11".to_owned())
}

fn field(text: Option<&str>, what: &str, range: std::ops::RangeInclusive<i64>) -> Result<i64, String> {
    let text = text.unwrap_or("").replace('_', "");
    let number = text.parse().ok().filter(|_| text.bytes().all(|digit| digit.is_ascii_digit()));
    let number = number.ok_or_else(|| format!("the {what} is missing or no number"))?;
    if range.contains(&number) {
        return Ok(number);
    }
    Err(format!("{what} {number} is not within {} to {}", range.start(), range.end()))
}

/// Days since 1970-01-01.
fn parse_date(text: &str) -> Result<i64, String> {
    let mut parts = text.splitn(3, '-');
    let year = field(parts.next(), "year", 1..=9999)?;
    let month = field(parts.next(), "month", 1..=12)?;
    let day = field(parts.next(), "day", 1..=days_in(year, month))?;
    Ok(days_from_civil(year, month, day))
}

fn parse_time_of_day(text: &str) -> Result<i64, String> {
    let mut parts = text.splitn(3, ':');
    let hour = field(parts.next(), "hour", 0..=23)?;
    let minute = field(parts.next(), "minute", 0..=59)?;
    // Vendors leave the seconds out: `TOD#12:00`.
    let seconds = parts.next().unwrap_or("0").replace('_', "");
    let (whole, fraction) = seconds.split_once('.').unwrap_or((&seconds, ""));
    let second = field(Some(whole), "second", 0..=59)?;
    if !fraction.bytes().all(|digit| digit.is_ascii_digit()) {
        return Err("the fraction of a second is not a number".to_owned());
    }
    let mut ns = ((hour * 60 + minute) * 60 + second) * 1_000_000_000;
    let mut weight = 100_000_000;
    for digit in fraction.bytes() {
        ns += i64::from(digit - b'0') * weight;
        weight /= 10;
    }
    Ok(ns)
}

fn is_leap(year: i64) -> bool {
    year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)
}

fn days_in(year: i64, month: i64) -> i64 {
    match month {
        2 if is_leap(year) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Days from 1970-01-01 to a date. A year is taken to begin in March, so that the leap day is
/// its last.
fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    year * 365 + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + day_of_year - 719_468
}

/// Year, month and day of a number of days since 1970-01-01.
pub fn civil_from_days(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let era = days.div_euclid(146_097);
    let day_of_era = days.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    (year, month, day_of_year - (153 * shifted + 2) / 5 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_and_dates_are_inverse() {
        for days in (-110_000..110_000).step_by(7) {
            let (year, month, day) = civil_from_days(days);
            assert_eq!(days_from_civil(year, month, day), days, "{year}-{month}-{day}");
            assert!((1..=days_in(year, month)).contains(&day));
        }
        assert_eq!(civil_from_days(0), (1970, 1, 1));
    }

    #[test]
    fn iec2_2_2_3_2_literals_are_valid_dates_only() {
        let date = |text| parse_calendar(CalendarKind::Date, text);
        assert_eq!(date("1970-01-02"), Ok(DAY_NS));
        assert_eq!(date("1984-06-25"), Ok(456_969_600_000_000_000));
        assert!(date("2000-02-29").is_ok() && date("2024-2-29").is_ok());
        for wrong in ["1900-02-29", "2023-02-29", "2023-13-01", "2023-04-31", "2023-00-01", "2023-01", "9999-01-01", ""]
        {
            assert!(date(wrong).is_err(), "{wrong}");
        }
        let time = |text| parse_calendar(CalendarKind::TimeOfDay, text);
        assert_eq!(time("15:36:55.36"), Ok(56_215_360_000_000));
        assert_eq!(time("00:00:00.0000000019"), Ok(1));
        assert_eq!(time("12:30"), time("12:30:00"));
        for wrong in ["24:00:00", "23:60:00", "23:59:60", "23", "1:2:x", "1:2:3.x"] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
        let both = parse_calendar(CalendarKind::DateAndTime, "1984-06-25-15:36:55.360");
        assert_eq!(both, Ok(456_969_600_000_000_000 + 56_215_360_000_000));
        assert!(parse_calendar(CalendarKind::DateAndTime, "1984-06-25").is_err());
    }
}
