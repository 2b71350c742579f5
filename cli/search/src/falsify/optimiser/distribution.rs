//! The normal distribution of CMA-ES: it gives points, and learns from what they are worth where and in which
//! directions to look next.
//!
//! Equations, symbols and defaults are those of \[CMA-ES\] (docs/sources.md), with its negative weights. Sums are taken in
//! a fixed order, and `exp`, `ln` and powers come from `libm`, so that the points have the same bits on every platform.

use std::mem::take;

use onescan_server::random::Random;

use super::eigen::{Eigen, Rows, decomposed, identity};
use crate::falsify::space::Point;

/// A generation whose best values have differed by less for some time has found what there is.
const VALUES_TOLERANCE: f64 = 1e-12;
/// So has one whose deviations are smaller, as a share of those at the start.
const STEP_TOLERANCE: f64 = 1e-12;
/// It has gone astray where a deviation is larger than that of the start by this factor.
const STEP_GROWTH_MAX: f64 = 1e8;
/// Beyond this condition number, the matrix has no exact digits left.
const CONDITION_MAX: f64 = 1e14;

/// One search, from its start until it has converged.
pub(super) struct Distribution {
    constants: Constants,
    random: Random,
    /// Where the next generation is drawn around: at first, the start.
    pub(super) mean: Point,
    /// The step size, and what it was at the start.
    sigma: f64,
    sigma_start: f64,
    /// C, and its decomposition: the squares of the deviations along its axes.
    covariance: Rows,
    axes: Eigen,
    /// The evolution paths, of the step size and of the covariance.
    path_sigma: Vec<f64>,
    path_c: Vec<f64>,
    drawn: Vec<Draw>,
    /// The best value of each generation.
    bests: Vec<f64>,
    /// Whether nothing better can come of it.
    pub(super) is_over: bool,
}

/// A point as it was drawn: z from N(0, I), y = B D z from N(0, C).
struct Draw {
    z: Vec<f64>,
    y: Vec<f64>,
}

impl Distribution {
    pub(super) fn new(mean: Point, sigma: f64, random: Random) -> Self {
        let size = mean.len();
        Self {
            constants: Constants::new(size),
            random,
            mean,
            sigma,
            sigma_start: sigma,
            covariance: identity(size),
            axes: Eigen { values: vec![1.0; size], vectors: identity(size) },
            path_sigma: vec![0.0; size],
            path_c: vec![0.0; size],
            drawn: Vec::new(),
            bests: Vec::new(),
            is_over: false,
        }
    }

    /// The points of the next generation.
    pub(super) fn generation(&mut self) -> Vec<Point> {
        self.drawn = self.constants.weights.iter().map(|_| draw(&self.axes, &mut self.random)).collect();
        let point = |draw: &Draw| self.mean.iter().zip(&draw.y).map(|(mean, y)| mean + self.sigma * y).collect();
        self.drawn.iter().map(point).collect()
    }

    /// Takes what these points are worth.
    pub(super) fn learn(&mut self, values: &[f64]) {
        let mut ranked: Vec<(f64, Draw)> = values.iter().copied().zip(take(&mut self.drawn)).collect();
        ranked.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        self.bests.push(ranked[0].0);
        self.update(&ranked);
        self.is_over = values.iter().any(|value| value.is_nan()) || self.has_converged();
    }

    /// The update of a generation, best point first.
    fn update(&mut self, ranked: &[(f64, Draw)]) {
        let Constants { mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi, .. } = self.constants;
        let (size, generation) = (self.mean.len() as f64, self.bests.len() as f64);
        let (mut z_mean, mut y_mean) = (vec![0.0; self.mean.len()], vec![0.0; self.mean.len()]);
        for (weight, (_, Draw { z, y })) in self.constants.weights.iter().zip(ranked).filter(|(w, _)| **w > 0.0) {
            add(&mut z_mean, *weight, z);
            add(&mut y_mean, *weight, y);
        }
        add(&mut self.mean, self.sigma, &y_mean);

        // C^(-1/2) of the mean step is B of that of z: both were drawn by the same B and D.
        let whitened = along(&self.axes.vectors, &z_mean);
        decay(&mut self.path_sigma, 1.0 - c_sigma);
        add(&mut self.path_sigma, (c_sigma * (2.0 - c_sigma) * mu_eff).sqrt(), &whitened);
        let length = square(&self.path_sigma).sqrt();
        let begun = (1.0 - libm::pow(1.0 - c_sigma, 2.0 * generation)).sqrt();
        let h_sigma = if length / begun < (1.4 + 2.0 / (size + 1.0)) * chi { 1.0 } else { 0.0 };
        decay(&mut self.path_c, 1.0 - c_c);
        add(&mut self.path_c, h_sigma * (c_c * (2.0 - c_c) * mu_eff).sqrt(), &y_mean);
        self.sigma *= libm::exp(c_sigma / d_sigma * (length / chi - 1.0));

        let kept = 1.0 + c_1 * (1.0 - h_sigma) * c_c * (2.0 - c_c) - c_1 - c_mu * sum(&self.constants.weights);
        self.covariance.iter_mut().for_each(|row| decay(row, kept));
        add_square(&mut self.covariance, c_1, &self.path_c);
        for (weight, (_, Draw { z, y })) in self.constants.weights.iter().zip(ranked) {
            // However long a bad step is, it takes no more than a share: the matrix stays positive definite.
            let scale = if *weight < 0.0 { size / square(z) } else { 1.0 };
            add_square(&mut self.covariance, c_mu * weight * scale, y);
        }
        if self.bests.len().is_multiple_of(self.constants.lag) {
            self.axes = decomposed(self.covariance.clone());
        }
    }

    /// Whether steps, values or digits have come to their end.
    fn has_converged(&self) -> bool {
        let (least, greatest) = range(&self.axes.values);
        if !self.axes.values.iter().all(|value| *value > 0.0) || greatest > CONDITION_MAX * least {
            return true;
        }
        let lasting = self.constants.lasting;
        let recent = &self.bests[self.bests.len().saturating_sub(lasting)..];
        let (best, worst) = range(recent);
        let deviation = |place: usize| self.sigma * self.covariance[place][place].sqrt();
        let tolerance = STEP_TOLERANCE * self.sigma_start;
        let is_short =
            |place: usize| deviation(place) < tolerance && (self.sigma * self.path_c[place]).abs() < tolerance;
        let axis = self.bests.len() % self.mean.len();
        let along_axis = 0.1 * self.sigma * self.axes.values[axis].sqrt();
        let mut places = 0..self.mean.len();
        recent.len() == lasting && worst - best < VALUES_TOLERANCE
            || self.sigma * greatest.sqrt() > STEP_GROWTH_MAX * self.sigma_start
            || self.mean.iter().zip(&self.axes.vectors[axis]).all(|(mean, part)| *mean == mean + along_axis * part)
            || places.clone().any(|place| self.mean[place] == self.mean[place] + 0.2 * deviation(place))
            || places.all(is_short)
    }
}

/// What does not change during a search, by the number of dimensions: Table 1 of \[CMA-ES\].
struct Constants {
    /// One for each point of a generation, positive for the better half.
    weights: Vec<f64>,
    mu_eff: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    /// The expected length of a vector from N(0, I).
    chi: f64,
    /// Generations from one decomposition to the next: it changes little in between, and takes the most time.
    lag: usize,
    /// Generations over which best values are compared.
    lasting: usize,
}

impl Constants {
    fn new(dimensions: usize) -> Self {
        let size = dimensions as f64;
        let lambda = 4 + (3.0 * libm::log(size)) as usize;
        let middle = libm::log(0.5 * (lambda as f64 + 1.0));
        let mut weights: Vec<f64> = (1..=lambda).map(|rank| middle - libm::log(rank as f64)).collect();
        let (better, worse) = weights.split_at_mut(lambda / 2);
        let effective = |weights: &[f64]| sum(weights) * sum(weights) / square(weights);
        let (mu_eff, mu_eff_worse) = (effective(better), effective(worse));
        let c_1 = 2.0 / ((size + 1.3) * (size + 1.3) + mu_eff);
        let c_mu = 2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((size + 2.0) * (size + 2.0) + mu_eff);
        let c_mu = c_mu.min(1.0 - c_1);
        let limits = [1.0 + 2.0 * mu_eff_worse / (mu_eff + 2.0), (1.0 - c_1 - c_mu) / (size * c_mu)];
        let share = limits.into_iter().fold(1.0 + c_1 / c_mu, f64::min);
        let (all_better, all_worse) = (sum(better), sum(worse).abs());
        decay(better, 1.0 / all_better);
        decay(worse, share / all_worse);
        let c_sigma = (mu_eff + 2.0) / (size + mu_eff + 5.0);
        let far = ((mu_eff - 1.0) / (size + 1.0)).sqrt() - 1.0;
        Self {
            weights,
            mu_eff,
            c_sigma,
            d_sigma: 1.0 + 2.0 * far.max(0.0) + c_sigma,
            c_c: (4.0 + mu_eff / size) / (size + 4.0 + 2.0 * mu_eff / size),
            c_1,
            c_mu,
            chi: size.sqrt() * (1.0 - 1.0 / (4.0 * size) + 1.0 / (21.0 * size * size)),
            lag: (0.5 / (size * (c_1 + c_mu))).ceil() as usize,
            lasting: 10 + (30.0 * size / lambda as f64).ceil() as usize,
        }
    }
}

fn draw(axes: &Eigen, random: &mut Random) -> Draw {
    let z: Vec<f64> = axes.values.iter().map(|_| random.normal()).collect();
    let scaled: Vec<f64> = axes.values.iter().zip(&z).map(|(square, z)| square.sqrt() * z).collect();
    Draw { y: along(&axes.vectors, &scaled), z }
}

/// B times a vector.
fn along(vectors: &Rows, by: &[f64]) -> Vec<f64> {
    let mut total = vec![0.0; by.len()];
    by.iter().zip(vectors).for_each(|(by, vector)| add(&mut total, *by, vector));
    total
}

fn add(to: &mut [f64], factor: f64, what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(to, what)| *to += factor * what);
}

/// A multiple of the vector times itself, transposed.
fn add_square(to: &mut Rows, factor: f64, vector: &[f64]) {
    for (row, part) in to.iter_mut().zip(vector) {
        // The product comes first, so that the matrix stays symmetric to the bit.
        row.iter_mut().zip(vector).for_each(|(to, other)| *to += factor * (part * other));
    }
}

fn decay(what: &mut [f64], factor: f64) {
    for what in what {
        *what *= factor;
    }
}

fn sum(of: &[f64]) -> f64 {
    of.iter().fold(0.0, |sum, value| sum + value)
}

fn square(of: &[f64]) -> f64 {
    of.iter().fold(0.0, |sum, value| sum + value * value)
}

fn range(of: &[f64]) -> (f64, f64) {
    of.iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), value| (least.min(*value), greatest.max(*value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(point: &[f64]) -> f64 {
        square(point)
    }

    fn rosenbrock(point: &[f64]) -> f64 {
        let valley = |pair: &[f64]| {
            let (off, ahead) = (pair[1] - pair[0] * pair[0], 1.0 - pair[0]);
            100.0 * off * off + ahead * ahead
        };
        point.windows(2).map(valley).sum()
    }

    /// Its longest axis is 1000 times its shortest.
    fn ellipsoid(point: &[f64]) -> f64 {
        let share = |place: usize| place as f64 / (point.len() - 1) as f64;
        point.iter().enumerate().map(|(place, x)| libm::pow(1e6, share(place)) * x * x).sum()
    }

    /// How many points it takes until one is worth less than 1e-8.
    fn taken(worth: fn(&[f64]) -> f64, start: f64, dimensions: usize, seed: u64) -> usize {
        let mut search = Distribution::new(vec![start; dimensions], 0.3, Random::new(seed));
        let mut count = 0;
        while !search.is_over {
            let values: Vec<f64> = search.generation().iter().map(|point| worth(point)).collect();
            if let Some(place) = values.iter().position(|value| *value < 1e-8) {
                return count + place + 1;
            }
            count += values.len();
            search.learn(&values);
        }
        usize::MAX
    }

    /// The budgets are 1.25 times the median of the crate `cmaes` 0.2.2 over 21 seeds, from the same starts.
    #[test]
    fn the_usual_functions_are_minimised_within_a_budget() {
        type Case = (fn(&[f64]) -> f64, f64, [(usize, usize); 3]);
        let cases: [Case; 3] = [
            (sphere, 1.0, [(2, 300), (8, 1440), (14, 2315)]),
            (rosenbrock, 0.0, [(2, 591), (8, 4457), (14, 10_972)]),
            (ellipsoid, 1.0, [(2, 642), (8, 3687), (14, 8905)]),
        ];
        for (number, (worth, start, budgets)) in cases.into_iter().enumerate() {
            for (dimensions, budget) in budgets {
                let mut counts: Vec<usize> = (1..=5).map(|seed| taken(worth, start, dimensions, seed)).collect();
                counts.sort_unstable();
                assert!(counts[2] <= budget, "function {number}, {dimensions} dimensions: {counts:?}, budget {budget}");
            }
        }
    }

    #[test]
    fn a_search_ends_where_nothing_is_left_to_find() {
        for (name, worth) in [("flat", (|_| 1.0) as fn(&[f64]) -> f64), ("sphere", sphere), ("no number", |_| f64::NAN)]
        {
            let mut search = Distribution::new(vec![0.5; 4], 0.3, Random::new(1));
            for _ in 0..1000 {
                let values: Vec<f64> = search.generation().iter().map(|point| worth(point)).collect();
                search.learn(&values);
                if search.is_over {
                    break;
                }
            }
            assert!(search.is_over, "{name}");
        }
    }
}
