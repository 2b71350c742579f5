//! Optimisers: which points are simulated next, by what those before them were worth.
//!
//! Those of crates call a function for what a point is worth. Here points are simulated several at a time, and elsewhere:
//! so an optimiser is run anew for each batch, with the values that are known so far, and its points are taken where these
//! end. That costs less than one simulation, and makes a search a function of its seed and of nothing else.
//!
//! | module | subject |
//! |---|---|
//! | `opening` | what is looked at before a search is led |
//! | `cma_es` | CMA-ES, by the crate `cmaes` |
//! | `annealing` | simulated annealing, by the crate `argmin` |
//! | `random` | each point by itself |

mod annealing;
mod cma_es;
mod opening;
mod random;

use onescan_server::random::{Random, seed_for};

use super::config::OptimiserKind;
use super::space::Point;
use super::trial::FAR;
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

    #[test]
    fn it_finds_the_bottom_of_a_bowl() {
        let (cma_es, by_chance) = (searched(OptimiserKind::CmaEs, 1, 40).1, searched(OptimiserKind::Random, 1, 20).1);
        assert!(cma_es < 1e-3 && cma_es < by_chance, "{cma_es}, by chance {by_chance}");
        // A point at a time: as many as the 20 batches by chance.
        let annealed = searched(OptimiserKind::Annealing, 1, 320).1;
        assert!(annealed < by_chance, "{annealed}, by chance {by_chance}");
    }
}
