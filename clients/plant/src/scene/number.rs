//! Numbers of a scene: finite, of the right sign, in the right unit.

use super::placed::Placed;

use super::error::SceneFaultKind;
use super::faults::Faults;
use super::format::Triple;
use crate::robot::MASS_MIN_KG;

/// The greatest number of a scene, in any unit: nothing of a machine is larger.
const GREATEST: f64 = 1e9;

/// What a number may be.
#[derive(Clone, Copy)]
pub(super) enum Allowed {
    Finite,
    Positive,
    NotNegative,
    /// Between two bounds, which are allowed too.
    Within(f64, f64),
}

impl Allowed {
    fn in_words(self) -> String {
        match self {
            Self::Finite => format!("a number from -{GREATEST:e} to {GREATEST:e}"),
            Self::Positive => format!("a number above 0, up to {GREATEST:e}"),
            Self::NotNegative => format!("a number from 0 to {GREATEST:e}"),
            Self::Within(least, most) => format!("a number from {least:e} to {most:e}"),
        }
    }

    fn admits(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => value.abs() <= GREATEST,
                Self::Positive => value > 0.0 && value <= GREATEST,
                Self::NotNegative => (0.0..=GREATEST).contains(&value),
                Self::Within(least, most) => (least..=most).contains(&value),
            }
    }
}

/// The unit that a coordinate is measured in.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Metre,
    Radian,
}

/// A key and what stands behind it, if anything.
#[derive(Clone, Copy)]
pub(super) struct Entry<'f> {
    pub(super) key: &'static str,
    pub(super) value: Option<&'f Placed<f64>>,
}

impl<'f> Entry<'f> {
    pub(super) fn new(key: &'static str, value: Option<&'f Placed<f64>>) -> Self {
        Self { key, value }
    }
}

impl Faults<'_> {
    /// The number of an entry, if there is one and it is allowed.
    pub(super) fn number(&mut self, entry: Entry<'_>, allowed: Allowed) -> Option<f64> {
        let written = entry.value?;
        let value = *written.get_ref();
        if allowed.admits(value) {
            return Some(value);
        }
        self.add(
            written.span(),
            SceneFaultKind::Number { key: entry.key.into(), wanted: allowed.in_words(), value: value.to_string() },
        );
        None
    }

    /// A whole number from 1 to `max`.
    pub(super) fn count(&mut self, key: &'static str, written: Option<&Placed<i64>>, max: u32) -> Option<u32> {
        let written = written?;
        let value = u32::try_from(*written.get_ref()).ok().filter(|value| (1..=max).contains(value));
        if value.is_none() {
            let value = written.get_ref().to_string();
            self.add(
                written.span(),
                SceneFaultKind::Number { key: key.into(), wanted: format!("a whole number from 1 to {max}"), value },
            );
        }
        value
    }

    /// The entry of the two that is in `unit`; the other one is a fault if it is there.
    pub(super) fn in_unit<'f>(&mut self, whose: &str, unit: Unit, metre: Entry<'f>, radian: Entry<'f>) -> Entry<'f> {
        let (right, wrong, named) = match unit {
            Unit::Metre => (metre, radian, "metres"),
            Unit::Radian => (radian, metre, "radians"),
        };
        if let Some(written) = wrong.value {
            self.add_hinted(
                written.span(),
                SceneFaultKind::Misplaced { whose: whose.to_owned(), key: wrong.key },
                Some(format!("its joint is measured in {named}: write `{}`", right.key)),
            );
        }
        right
    }

    /// Three finite components.
    pub(super) fn triple(&mut self, key: &'static str, written: Option<&Triple>) -> Option<[f64; 3]> {
        let written = written?;
        self.components(key, written, Allowed::Finite)
    }

    /// Three components that are allowed one by one.
    pub(super) fn components(&mut self, key: &'static str, written: &Triple, allowed: Allowed) -> Option<[f64; 3]> {
        let value = *written.get_ref();
        match value.iter().find(|component| !allowed.admits(**component)) {
            None => Some(value),
            Some(wrong) => {
                let value = wrong.to_string();
                self.add(written.span(), SceneFaultKind::Number { key: key.into(), wanted: allowed.in_words(), value });
                None
            }
        }
    }

    /// The unit vector along three finite components that are not all zero.
    pub(super) fn direction(&mut self, key: &'static str, written: &Triple) -> Option<[f64; 3]> {
        let [x, y, z] = self.components(key, written, Allowed::Finite)?;
        let length = (x * x + y * y + z * z).sqrt();
        if length.is_finite() && length > 1e-9 {
            return Some([x / length, y / length, z / length]);
        }
        let value = format!("[{x}, {y}, {z}]");
        let wanted = "a direction, of any length but 0".to_owned();
        self.add(written.span(), SceneFaultKind::Number { key: key.into(), wanted, value });
        None
    }
}

// What the engine computes with for certain: beyond, products of several such numbers leave the
// range in which a double is precise, long before it overflows.
pub(super) const LENGTH_M: Allowed = Allowed::Within(LENGTH_MIN_M, 1e4);
/// Least size of a shape, m.
pub(super) const LENGTH_MIN_M: f64 = 1e-4;
pub(super) const MASS_KG: Allowed = Allowed::Within(MASS_MIN_KG, 1e9);
pub(super) const DENSITY_KG_M3: Allowed = Allowed::Within(1e-2, 1e5);
pub(super) const FRICTION: f64 = 0.5;
pub(super) const RESTITUTION: f64 = 0.0;
