//! Signals that hold their value from one image to the next, in the unit in which they are reported.

/// A signal that is looked at.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub(super) signal: String,
    /// The unit in which it is reported.
    pub(super) unit: Option<String>,
    /// Its place among the values.
    pub(super) column: usize,
    /// What its value is times and by in that unit.
    pub(super) factor: (f64, f64),
}

impl Seen {
    /// Its value among those of an image.
    pub(super) fn value(&self, values: &[f64]) -> f64 {
        let (times, by) = self.factor;
        values.get(self.column).map_or(f64::NAN, |value| value * times / by)
    }
}

/// The value that a signal has, and since when.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Held(Option<(f64, u64)>);

impl Held {
    /// Takes the value of the image of `t_ns`; the value that no longer holds, and since when it did.
    pub(super) fn push(&mut self, t_ns: u64, value: f64) -> Option<(f64, u64)> {
        match self.0 {
            Some((before, _)) if before.to_bits() == value.to_bits() => None,
            before => {
                self.0 = Some((value, t_ns));
                before
            }
        }
    }

    /// The value that holds, and since when.
    pub(super) fn value(self) -> Option<(f64, u64)> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_holds_until_another_comes() {
        let mut held = Held::default();
        assert_eq!(held.push(0, 1.0), None);
        assert_eq!(held.push(10, 1.0), None);
        assert_eq!(held.push(20, 2.0), Some((1.0, 0)));
        assert_eq!(held.value(), Some((2.0, 20)));
    }
}
