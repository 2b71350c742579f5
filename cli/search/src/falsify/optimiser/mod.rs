//! Optimisers: which points are simulated next, by what those before them were worth.
//!
//! Points are simulated several at a time, and elsewhere: so an optimiser is asked for a batch, and takes what its points
//! were worth. A search is a function of its seed and of these values. It computes in a fixed order, and takes
//! transcendental functions from `libm`: its points have the same bits on every platform.
//!
//! | module | subject |
//! |---|---|
//! | `opening` | what is looked at before a search is led |
//! | `cma_es` | CMA-ES: when a search starts, and where |
//! | `distribution` | one search of CMA-ES: points drawn from a normal distribution, which learns from them |
//! | `eigen` | the axes of that distribution |
//! | `annealing` | simulated annealing |
//! | `random` | each point by itself |

mod annealing;
mod cma_es;
mod distribution;
mod eigen;
mod opening;
mod random;

use onescan_server::random::{Random, seed_for};

use super::config::OptimiserKind;
use super::evaluator::FAR;
use super::space::Point;
use opening::Opening;

/// What chooses points.
pub(super) trait Optimiser {
    /// The points that are to be simulated next, at least one.
    fn ask(&mut self) -> Vec<Point>;

    /// What they are worth, in their order; the less the better.
    fn tell(&mut self, values: &[f64]);
}

/// The optimiser that was asked for. Those that are led by margins look at some points by chance first, and at `corners`:
/// what breaks easily breaks anywhere, and much else in a corner.
pub(super) fn new(
    kind: OptimiserKind,
    dimensions: usize,
    seed: u64,
    corners: impl FnOnce(&mut Random) -> Vec<Point>,
) -> Box<dyn Optimiser> {
    let mut random = Random::new(seed_for(seed, "falsify", kind.word()));
    let opening =
        |corners: Vec<Point>, random: &mut Random| Opening::new(dimensions, Random::new(random.bits()), corners);
    match kind {
        OptimiserKind::CmaEs => {
            let opening = opening(corners(&mut random), &mut random);
            Box::new(cma_es::CmaEs::new(dimensions, random, opening))
        }
        OptimiserKind::Annealing => {
            let opening = opening(corners(&mut random), &mut random);
            Box::new(annealing::Annealing::new(dimensions, random, opening))
        }
        OptimiserKind::Random => Box::new(random::Evenly::new(dimensions, random)),
    }
}

/// A point, evenly from the cube.
fn anywhere(dimensions: usize, random: &mut Random) -> Point {
    (0..dimensions).map(|_| random.uniform()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Batches of a search for the least of a bowl whose middle is at 0.3, until one is near it.
    fn searched(kind: OptimiserKind, seed: u64, batches: usize) -> (Vec<Point>, f64) {
        let mut optimiser = new(kind, 4, seed, |_| vec![vec![0.0; 4], vec![1.0; 4]]);
        let (mut all, mut least) = (Vec::new(), f64::INFINITY);
        for _ in 0..batches {
            let points = optimiser.ask();
            assert!(!points.is_empty() && points.iter().flatten().all(|x| (0.0..=1.0).contains(x)), "{points:?}");
            let worth = |point: &Point| point.iter().map(|x| (x - 0.3) * (x - 0.3)).sum::<f64>();
            let values: Vec<f64> = points.iter().map(worth).collect();
            least = values.iter().copied().fold(least, f64::min);
            optimiser.tell(&values);
            all.extend(points);
        }
        (all, least)
    }

    #[test]
    fn a_search_is_a_function_of_its_seed() {
        for kind in [OptimiserKind::CmaEs, OptimiserKind::Annealing, OptimiserKind::Random] {
            let (first, again, other) = (searched(kind, 1, 30), searched(kind, 1, 30), searched(kind, 2, 30));
            assert_eq!(first, again, "{kind:?}");
            assert_ne!(first.0, other.0, "{kind:?}");
        }
    }

    /// The points of the first 200 simulations and more, each bit of each number, by FNV-1a.
    fn digest(kind: OptimiserKind) -> u64 {
        let mut optimiser = new(kind, 4, 1, |_| vec![vec![0.0; 4], vec![1.0; 4]]);
        let (mut count, mut digest) = (0, 0xcbf2_9ce4_8422_2325_u64);
        while count < 200 {
            let points = optimiser.ask();
            let worth = |point: &Point| point.iter().fold(0.0, |sum, x| 1.5 * sum + (x - 0.3) * (x - 0.3));
            optimiser.tell(&points.iter().map(worth).collect::<Vec<_>>());
            let bytes = points.iter().flatten().flat_map(|x| x.to_bits().to_le_bytes());
            digest = bytes.fold(digest, |digest, byte| (digest ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
            count += points.len();
        }
        digest
    }

    #[test]
    fn points_have_the_same_bits_on_every_platform() {
        for (kind, expected) in [
            (OptimiserKind::CmaEs, 0xb6ae_083f_dfec_fa57_u64),
            (OptimiserKind::Annealing, 0xcd34_5aa2_7a3c_5355),
            (OptimiserKind::Random, 0xcb21_56d1_d128_1227),
        ] {
            assert_eq!(format!("{:016x}", digest(kind)), format!("{expected:016x}"), "{kind:?}");
        }
    }

    #[test]
    fn it_finds_the_bottom_of_a_bowl() {
        let (cma_es, by_chance) = (searched(OptimiserKind::CmaEs, 1, 40).1, searched(OptimiserKind::Random, 1, 20).1);
        assert!(cma_es < 1e-3 && cma_es < by_chance, "{cma_es}, by chance {by_chance}");
        // A point at a time: as many as the 20 batches by chance.
        let annealed = searched(OptimiserKind::Annealing, 1, 320).1;
        assert!(annealed < by_chance, "{annealed}, by chance {by_chance}");
    }
}
