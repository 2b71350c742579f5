//! The signals that a report looks at, as numbers.

use onescan_server::signal::{SignalName, SignalType};

/// Their bytes and their values, as they were last.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    types: Vec<SignalType>,
    /// The bytes, one behind the other.
    image: Vec<u8>,
    values: Vec<f64>,
}

impl Numbers {
    /// Of which nothing is known yet.
    pub(super) fn new(signals: &[(SignalName, SignalType)]) -> Self {
        let types: Vec<SignalType> = signals.iter().map(|(_, ty)| *ty).collect();
        let bytes = types.iter().map(|ty| ty.size()).sum();
        Self { image: vec![0; bytes], values: vec![f64::NAN; types.len()], types }
    }

    /// Takes the bytes; true if they have changed.
    pub(super) fn take<'b>(&mut self, bytes: impl Iterator<Item = &'b [u8]>) -> bool {
        let (mut changed, mut rest) = (false, self.image.as_mut_slice());
        for ((ty, value), bytes) in self.types.iter().zip(&mut self.values).zip(bytes) {
            let (own, others) = rest.split_at_mut(ty.size());
            rest = others;
            let bytes = &bytes[..ty.size()];
            // A signal whose bytes are 0 from the start on must be read once.
            if own != bytes || value.is_nan() {
                own.copy_from_slice(bytes);
                *value = ty.as_f64(bytes).unwrap_or(f64::NAN);
                changed = true;
            }
        }
        changed
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The whole number in this place.
    pub(super) fn whole(&self, column: usize) -> Option<i128> {
        let offset: usize = self.types.iter().take(column).map(|ty| ty.size()).sum();
        self.types.get(column)?.integer(self.image.get(offset..)?)
    }
}
