//! Random numbers that are the same everywhere: a generator of our own, with seeds from the scenario.
//!
//! xoshiro256++ 1.0 by D. Blackman and S. Vigna, seeded through `SplitMix64` as its authors advise;
//! normal deviates by Box and Muller's transform, with `libm`.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// A stream of random numbers; its state is part of that of whoever draws from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Random([u64; 4]);

/// `SplitMix64`: the next number of a counter, well mixed.
fn split_mix(counter: &mut u64) -> u64 {
    *counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut mixed = *counter;
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

/// A seed for the thing `name`, from the scenario's: streams of different things are independent, and
/// none depends on what else there is.
pub fn seed_for(scenario: u64, thing: &str, name: &str) -> u64 {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&scenario.to_le_bytes()).update(thing.as_bytes()).update(&[0]).update(name.as_bytes());
    let mut first = [0; 8];
    first.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
    u64::from_le_bytes(first)
}

impl Random {
    /// The stream that begins with `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut counter = seed;
        let state = [(); 4].map(|()| split_mix(&mut counter));
        // SplitMix64 is a bijection of its counter, so of four numbers one at most is 0.
        debug_assert!(state != [0; 4], "a stream of all zeros never leaves that state");
        Self(state)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        let [a, b, c, d] = &mut self.0;
        let result = a.wrapping_add(*d).rotate_left(23).wrapping_add(*a);
        let shifted = *b << 17;
        *c ^= *a;
        *d ^= *b;
        *b ^= *c;
        *a ^= *d;
        *c ^= shifted;
        *d = d.rotate_left(45);
        result
    }

    /// Evenly from 0 (not included) to 1 (included).
    pub fn uniform(&mut self) -> f64 {
        // 53 bits are all that an `f64` holds; the one that is added keeps 0 out, whose logarithm `normal` cannot take.
        ((self.bits() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// From N(0, 1).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        radius * libm::cos(TAU * self.uniform())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_streams_are_those_of_the_authors() {
        let mut random = Random([1, 2, 3, 4]);
        let first: Vec<_> = (0..5).map(|_| random.bits()).collect();
        let published =
            [41_943_041, 58_720_359, 3_588_806_011_781_223, 3_591_011_842_654_386, 9_228_616_714_210_784_205];
        assert_eq!(first, published);
        let mut counter = 1_234_567;
        assert_eq!(split_mix(&mut counter), 6_457_827_717_110_365_317);
        assert_eq!(split_mix(&mut counter), 3_203_168_211_198_807_973);
    }

    #[test]
    fn normal_deviates_have_their_moments() {
        let mut random = Random::new(7);
        let count = 100_000;
        let drawn: Vec<_> = (0..count).map(|_| random.normal()).collect();
        let mean = drawn.iter().sum::<f64>() / f64::from(count);
        let variance = drawn.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / f64::from(count);
        let within = drawn.iter().filter(|x| x.abs() < 1.0).count() as f64 / f64::from(count);
        // five standard errors: 1/√n of the mean, √(2/n) of the variance, √(p(1-p)/n) of the part
        assert!(mean.abs() < 5.0 / 316.0, "{mean}");
        assert!((variance - 1.0).abs() < 5.0 * 0.004_5, "{variance}");
        assert!((within - 0.682_7).abs() < 5.0 * 0.001_5, "{within}");
    }

    #[test]
    fn seeds_depend_on_all_they_are_made_of() {
        let seeds = [seed_for(0, "signal", "a"), seed_for(1, "signal", "a"), seed_for(0, "signal", "b")];
        assert!(seeds[0] != seeds[1] && seeds[0] != seeds[2]);
        assert_ne!(seed_for(0, "sig", "nala"), seed_for(0, "signal", "a"));
    }
}
