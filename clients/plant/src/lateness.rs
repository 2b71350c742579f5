//! How late a value arrives: a constant time, an even part up to the jitter, and a normal part.
//!
//! `[SDSP]` sec. III-C wants the jitter of real equipment modelled "in a standard way", as N(µ, σ): here
//! µ is `delay_s` and σ is `delay_sigma_s`. A time from the lower tail that would be negative is 0: no
//! value arrives before it was sent.

use super::model::Condition;
use onescan_server::random::Random;

/// How much later than it was sent a value arrives, ns.
///
/// A part that is not there draws no number, so that scenes without it keep their streams.
pub(super) fn late_ns(condition: &Condition, random: &mut Random) -> u64 {
    let even_ns = match condition.jitter_ns {
        0 => 0,
        jitter_ns => (jitter_ns as f64 * random.uniform()) as u64,
    };
    let sent_on_ns = condition.delay_ns + even_ns;
    match condition.delay_sigma_ns {
        0 => sent_on_ns,
        // a cast from a negative number is 0
        sigma_ns => (sent_on_ns as f64 + sigma_ns as f64 * random.normal()).round() as u64,
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::{SignalName, SignalType};

    use super::*;

    const COUNT: usize = 100_000;
    const MEAN_NS: u64 = 8_000_000;
    const SIGMA_NS: u64 = 1_500_000;

    fn condition(delay_ns: u64, jitter_ns: u64, delay_sigma_ns: u64) -> Condition {
        Condition {
            signal: SignalName::new("x").expect("a name"),
            inner: SignalType::BOOL,
            scale: None,
            delay_ns,
            jitter_ns,
            delay_sigma_ns,
            sample_ns: 0,
            quantum: 0.0,
            noise_mean: 0.0,
            noise_sigma: 0.0,
            lost_rate: 0.0,
            flip_rate: 0.0,
        }
    }

    fn drawn(condition: &Condition) -> Vec<u64> {
        let mut random = Random::new(2012);
        (0..COUNT).map(|_| late_ns(condition, &mut random)).collect()
    }

    /// The largest distance of the samples' distribution from a given one (Kolmogorov and Smirnov).
    fn distance(samples: &[u64], distribution: impl Fn(f64) -> f64) -> f64 {
        let mut sorted = samples.to_vec();
        sorted.sort_unstable();
        let n = sorted.len() as f64;
        let at = |(k, x): (usize, &u64)| {
            let below = distribution(*x as f64);
            (below - k as f64 / n).abs().max(((k + 1) as f64 / n - below).abs())
        };
        sorted.iter().enumerate().map(at).fold(0.0, f64::max)
    }

    fn normal(x: f64) -> f64 {
        let z = (x - MEAN_NS as f64) / SIGMA_NS as f64;
        libm::erfc(-z / std::f64::consts::SQRT_2) / 2.0
    }

    /// Where the distance of equal distributions stays in all but one of a thousand trials.
    fn bound() -> f64 {
        1.949 / (COUNT as f64).sqrt()
    }

    #[test]
    fn a_normal_delay_is_normal_by_kolmogorov_and_smirnov() {
        let found = distance(&drawn(&condition(MEAN_NS, 0, SIGMA_NS)), normal);
        assert!(found < bound(), "{found} of {}", bound());
    }

    /// The test distinguishes distributions that have the same mean and deviation.
    #[test]
    fn an_even_delay_of_the_same_moments_is_not_taken_for_a_normal_one() {
        let width_ns = (SIGMA_NS as f64 * 12_f64.sqrt()) as u64;
        let found = distance(&drawn(&condition(MEAN_NS - width_ns / 2, width_ns, 0)), normal);
        assert!(found > 5.0 * bound(), "{found}");
        let even = |x: f64| (x - (MEAN_NS - width_ns / 2) as f64) / width_ns as f64;
        assert!(distance(&drawn(&condition(MEAN_NS - width_ns / 2, width_ns, 0)), even) < bound());
    }

    #[test]
    fn nothing_arrives_before_it_was_sent() {
        let drawn = drawn(&condition(1_000_000, 0, 1_000_000));
        // Φ(-1) of them, within 5 σ
        let at_once = drawn.iter().filter(|late| **late == 0).count() as f64 / COUNT as f64;
        assert!((at_once - 0.158_7).abs() < 5.0 * 0.001_16, "{at_once}");
    }

    #[test]
    fn what_is_not_there_draws_nothing() {
        let mut random = Random::new(1);
        assert_eq!(late_ns(&condition(5, 0, 0), &mut random), 5);
        assert_eq!(random, Random::new(1));
    }
}
