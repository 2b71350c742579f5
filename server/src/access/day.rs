//! Days of the calendar, in universal time: when a token ends.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use thiserror::Error;

const SECONDS_OF_DAY: u64 = 86_400;
/// Days from the first of March of year 0 to the first of January 1970.
const EPOCH_DAYS: i64 = 719_468;
const ERA_DAYS: i64 = 146_097;

/// A day, counted from 1970-01-01; written as in `2027-03-31`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Day(u32);

/// A text that is not a day.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is not a day from 1970 to 9999: write it as in `2027-03-31`")]
pub struct BadDay(String);

impl Day {
    /// The last day that can be written.
    const LAST: Self = Self(2_932_896);
    /// The first day that can be written.
    pub const EPOCH: Self = Self(0);

    /// The day of which it is, that long after 1970-01-01T00:00:00Z.
    pub fn of(since_epoch: Duration) -> Self {
        Self((since_epoch.as_secs() / SECONDS_OF_DAY).min(u64::from(Self::LAST.0)) as u32)
    }

    /// The day `days` later, or the last one there is.
    pub fn later(self, days: u32) -> Self {
        Self(self.0.saturating_add(days).min(Self::LAST.0))
    }

    /// The day `days` earlier, or the first one there is.
    pub fn earlier(self, days: u32) -> Self {
        Self(self.0.saturating_sub(days))
    }

    /// Year, month and day of the Gregorian calendar. Years are taken to begin in March, so that the day that may be
    /// missing is the last.
    pub fn parts(self) -> (i64, i64, i64) {
        // `civil_from_days` of H. Hinnant's "chrono-Compatible Low-Level Date Algorithms", for years from 0 on.
        let days = i64::from(self.0) + EPOCH_DAYS;
        let (era, of_era) = (days / ERA_DAYS, days % ERA_DAYS);
        let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * year + year / 4 - year / 100);
        let from_march = (5 * of_year + 2) / 153;
        let day = of_year - (153 * from_march + 2) / 5 + 1;
        let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
        (year + era * 400 + i64::from(month <= 2), month, day)
    }

    fn from_parts(year: i64, month: i64, day: i64) -> Option<Self> {
        // `days_from_civil` of the same paper.
        let year = if month <= 2 { year - 1 } else { year };
        let (era, of_era) = (year / 400, year % 400);
        let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
        let days = era * ERA_DAYS + of_era * 365 + of_era / 4 - of_era / 100 + of_year - EPOCH_DAYS;
        u32::try_from(days).ok().map(Self)
    }
}

impl fmt::Display for Day {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (year, month, day) = self.parts();
        write!(f, "{year:04}-{month:02}-{day:02}")
    }
}

impl FromStr for Day {
    type Err = BadDay;

    fn from_str(text: &str) -> Result<Self, BadDay> {
        let bad = || BadDay(text.to_owned());
        let mut parts = text.split('-').map(|part| part.parse::<u16>().map(i64::from));
        let (Some(Ok(year)), Some(Ok(month)), Some(Ok(day)), None) =
            (parts.next(), parts.next(), parts.next(), parts.next())
        else {
            return Err(bad());
        };
        let found = Self::from_parts(year, month, day).ok_or_else(bad)?;
        // A day that there is comes back as it was written.
        if found.to_string() == text { Ok(found) } else { Err(bad()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        for (text, days) in [
            ("1970-01-01", 0),
            ("1970-03-01", 59),
            ("1999-12-31", 10_956),
            ("2000-02-29", 11_016),
            ("2024-02-29", 19_782),
            ("2100-03-01", 47_541),
            ("9999-12-31", 2_932_896),
        ] {
            assert_eq!(text.parse(), Ok(Day(days)), "{text}");
            assert_eq!(Day(days).to_string(), text);
        }
    }

    #[test]
    fn every_day_comes_back() {
        for days in (0..=Day::LAST.0).step_by(7) {
            assert_eq!(Day(days).to_string().parse(), Ok(Day(days)));
        }
    }

    #[test]
    fn what_is_not_a_day_is_refused() {
        for text in
            ["2023-02-29", "1969-12-31", "2024-13-01", "2024-00-10", "2024-1-1", "24-01-01", "", "x", "2024-01-01-"]
        {
            assert!(text.parse::<Day>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_moment_has_its_day() {
        assert_eq!(Day::of(Duration::from_secs(86_399)), Day(0));
        assert_eq!(Day::of(Duration::from_hours(24)).later(30), Day(31));
        assert_eq!(Day::of(Duration::MAX), Day::LAST);
    }
}
