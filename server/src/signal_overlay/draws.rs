//! What a fault draws, and what it knows when it begins.

use serde::{Deserialize, Serialize};

use crate::random::{Random, seed_for};
use crate::signal::SignalType;
use crate::time::{StepCount, TimeSpan};

/// What a fault begins with.
pub(crate) struct Onset<'a> {
    pub(crate) ty: SignalType,
    pub(crate) committed: &'a [u8],
    pub(crate) step: TimeSpan,
    /// Steps committed so far: a fault that comes again draws other numbers.
    pub(crate) steps: StepCount,
}

/// A stream of random numbers and the number that they are held against or multiplied by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) struct Draws {
    random: Random,
    /// A rate or a standard deviation, as the bits of an `f64`.
    number: u64,
}

impl Draws {
    pub(super) fn new(number: f64, seed: u64, onset: &Onset<'_>) -> Self {
        let random = Random::new(seed_for(seed, "onset", &onset.steps.to_string()));
        Self { random, number: number.to_bits() }
    }

    /// A stream with a rate from 0 to 1; nothing for what is not a rate.
    pub(super) fn at_rate(rate: &str, seed: u64, onset: &Onset<'_>) -> Option<Self> {
        let rate: f64 = rate.parse().ok()?;
        (0.0..=1.0).contains(&rate).then(|| Self::new(rate, seed, onset))
    }

    fn number(&self) -> f64 {
        f64::from_bits(self.number)
    }

    pub(super) fn happens(&mut self) -> bool {
        // From 0, which is never drawn, to 1.
        self.random.uniform() <= self.number()
    }

    pub(super) fn bit(&mut self) -> Option<u64> {
        self.happens().then(|| self.random.bits())
    }

    pub(super) fn normal(&mut self) -> u64 {
        (self.number() * self.random.normal()).to_bits()
    }
}
