//! Three-valued truth, and the margin by which a formula holds.

use serde::Serialize;

use super::formula::Comparison;

/// What a formula may be worth at a sample: a lattice with a complement.
pub(super) trait Scale: Copy {
    const TOP: Self;
    const BOTTOM: Self;
    /// What lies beyond the end of the run.
    const UNKNOWN: Self;

    fn of_comparison(comparison: Comparison, left: f64, right: f64) -> Self;
    fn not(self) -> Self;
    fn and(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;

    fn of_bool(value: bool) -> Self {
        if value { Self::TOP } else { Self::BOTTOM }
    }
}

/// Whether a formula holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Truth {
    False,
    Unknown,
    True,
}

impl Scale for Truth {
    const TOP: Self = Self::True;
    const BOTTOM: Self = Self::False;
    const UNKNOWN: Self = Self::Unknown;

    fn of_comparison(comparison: Comparison, left: f64, right: f64) -> Self {
        Self::of_bool(match comparison {
            Comparison::Less => left < right,
            Comparison::LessEqual => left <= right,
            Comparison::Greater => left > right,
            Comparison::GreaterEqual => left >= right,
            Comparison::Equal => left == right,
            Comparison::NotEqual => left != right,
        })
    }

    fn not(self) -> Self {
        match self {
            Self::False => Self::True,
            Self::Unknown => Self::Unknown,
            Self::True => Self::False,
        }
    }

    fn and(self, other: Self) -> Self {
        self.min(other)
    }

    fn or(self, other: Self) -> Self {
        self.max(other)
    }
}

/// By how much a formula holds, negative where it does not: between these two numbers, whatever
/// would come after the end of the run. In the units of its comparisons; infinite for BOOLs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Margin {
    /// In the units of the comparisons.
    pub least: f64,
    /// In the units of the comparisons.
    pub greatest: f64,
}

impl Margin {
    fn exactly(value: f64) -> Self {
        // A comparison with NaN does not hold.
        let value = if value.is_nan() { f64::NEG_INFINITY } else { value };
        Self { least: value, greatest: value }
    }
}

impl Scale for Margin {
    const TOP: Self = Self { least: f64::INFINITY, greatest: f64::INFINITY };
    const BOTTOM: Self = Self { least: f64::NEG_INFINITY, greatest: f64::NEG_INFINITY };
    const UNKNOWN: Self = Self { least: f64::NEG_INFINITY, greatest: f64::INFINITY };

    fn of_comparison(comparison: Comparison, left: f64, right: f64) -> Self {
        Self::exactly(match comparison {
            Comparison::Less | Comparison::LessEqual => right - left,
            Comparison::Greater | Comparison::GreaterEqual => left - right,
            Comparison::Equal => -(left - right).abs(),
            Comparison::NotEqual => (left - right).abs(),
        })
    }

    fn not(self) -> Self {
        Self { least: -self.greatest, greatest: -self.least }
    }

    fn and(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), greatest: self.greatest.min(other.greatest) }
    }

    fn or(self, other: Self) -> Self {
        Self { least: self.least.max(other.least), greatest: self.greatest.max(other.greatest) }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Worth {
    pub(super) truth: Truth,
    pub(super) margin: Margin,
}

impl Worth {
    pub(super) fn is_false(self) -> bool {
        self.truth == Truth::False
    }
}

impl Scale for Worth {
    const TOP: Self = Self { truth: Truth::TOP, margin: Margin::TOP };
    const BOTTOM: Self = Self { truth: Truth::BOTTOM, margin: Margin::BOTTOM };
    const UNKNOWN: Self = Self { truth: Truth::UNKNOWN, margin: Margin::UNKNOWN };

    fn of_comparison(comparison: Comparison, left: f64, right: f64) -> Self {
        Self {
            truth: Truth::of_comparison(comparison, left, right),
            margin: Margin::of_comparison(comparison, left, right),
        }
    }

    fn not(self) -> Self {
        Self { truth: self.truth.not(), margin: self.margin.not() }
    }

    fn and(self, other: Self) -> Self {
        Self { truth: self.truth.and(other.truth), margin: self.margin.and(other.margin) }
    }

    fn or(self, other: Self) -> Self {
        Self { truth: self.truth.or(other.truth), margin: self.margin.or(other.margin) }
    }
}
