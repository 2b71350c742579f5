//! What holds at a joint within bounds: drives, friction, brakes, stops, couplings, as rows of one small
//! problem that is solved for their impulses.
//!
//! A row wants its velocity `u = J v` to be `wanted - softness λ`, with an impulse `λ` from `least` to
//! `most`. Where the impulse is at a bound, the velocity is what it is:
//! - a rigid row has softness 0: a brake, dry friction, a stop, a coupling, a drive that follows a path;
//! - a soft row is a force that falls with the velocity, as viscous friction and a velocity loop.
//!
//! # Method
//! An active set: all rows within their bounds are solved at once, those that break a bound are set to
//! it, those at a bound that want back are freed. It ends after a few rounds; where it should not, sweeps
//! over the rows one by one (projected Gauss-Seidel) go on from there. Both count, neither looks at a
//! clock.

use nalgebra::{DMatrix, DVectorViewMut};

use super::matrix::Factor;

/// Added to each diagonal, as a part of it: two rigid rows of one joint share their impulse.
const REGULAR: f64 = 1e-11;
/// Sweeps where the active set goes round in circles.
const SWEEPS: usize = 200;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// The coordinate that it acts on.
    pub(super) on: usize,
    /// Others, with factors: `u = v[on] + Σ factor v[other]`.
    pub(super) with: [Option<(usize, f64)>; 2],
    pub(super) wanted: f64,
    pub(super) softness: f64,
    pub(super) least: f64,
    pub(super) most: f64,
    pub(super) impulse: f64,
    /// The actuator whose row it is.
    pub(super) actuator: Option<usize>,
}

impl Row {
    /// A row of one coordinate that wants a velocity with an impulse up to `most` either way.
    pub(super) const fn rigid(on: usize, wanted: f64, most: f64) -> Self {
        Self { on, with: [None; 2], wanted, softness: 0.0, least: -most, most, impulse: 0.0, actuator: None }
    }

    /// The coordinates that it acts on, with their factors.
    pub(super) fn parts(&self) -> impl Iterator<Item = (usize, f64)> {
        [Some((self.on, 1.0)), self.with[0], self.with[1]].into_iter().flatten()
    }

    fn velocity(&self, v: &[f64]) -> f64 {
        self.parts().map(|(axis, factor)| factor * v[axis]).sum()
    }

    /// What one unit of its impulse adds to a velocity.
    fn adds(&self, axis: usize, inverse: &DMatrix<f64>) -> f64 {
        let column = inverse.column(axis);
        self.parts().map(|(other, factor)| factor * column[other]).sum()
    }

    /// `J M⁻¹ J'ᵀ` of two rows.
    fn between(&self, other: &Self, inverse: &DMatrix<f64>) -> f64 {
        self.parts().map(|(axis, factor)| factor * other.adds(axis, inverse)).sum()
    }
}

/// Where a row stands in the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    Free,
    Least,
    Most,
}

/// The problem of all rows of a mechanism in a sub-step, with room that is used again.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) all: Vec<Row>,
    between: DMatrix<f64>,
    held: Vec<Held>,
    free: Vec<usize>,
    reduced: Factor,
    right: Vec<f64>,
    start: Vec<f64>,
}

impl Rows {
    /// Finds all impulses and gives the velocities `v` that they lead to; `inverse` is `M⁻¹`.
    pub(super) fn solve(&mut self, inverse: &DMatrix<f64>, v: &mut [f64]) {
        match self.all.as_mut_slice() {
            [] => return,
            [only] => {
                let stiffness = only.between(only, inverse) + only.softness;
                only.impulse = ((only.wanted - only.velocity(v)) / stiffness).clamp(only.least, only.most);
            }
            _ => self.search(inverse, v),
        }
        for row in &self.all {
            for (axis, v) in v.iter_mut().enumerate() {
                *v += row.adds(axis, inverse) * row.impulse;
            }
        }
    }

    fn search(&mut self, inverse: &DMatrix<f64>, v: &[f64]) {
        let count = self.all.len();
        if self.between.nrows() != count {
            self.between.resize_mut(count, count, 0.0);
        }
        for (r, row) in self.all.iter().enumerate() {
            for (s, other) in self.all.iter().enumerate() {
                let mut entry = row.between(other, inverse);
                if r == s {
                    entry += row.softness + REGULAR * entry;
                }
                self.between[(r, s)] = entry;
            }
        }
        self.start.clear();
        self.start.extend(self.all.iter().map(|row| row.wanted - row.velocity(v)));
        self.held.clear();
        self.held.resize(count, Held::Free);
        for _ in 0..4 * count + 4 {
            if !self.solve_free() {
                break;
            }
            if !self.revise() {
                return;
            }
        }
        self.sweep();
    }

    /// Solves for the impulses of all free rows, the others at their bounds.
    fn solve_free(&mut self) -> bool {
        let count = self.all.len();
        for (row, held) in self.all.iter_mut().zip(&self.held) {
            match held {
                Held::Free => {}
                Held::Least => row.impulse = row.least,
                Held::Most => row.impulse = row.most,
            }
        }
        let Self { all: rows, between, held, free, reduced, right, start } = self;
        free.clear();
        free.extend((0..count).filter(|index| held[*index] == Held::Free));
        right.clear();
        for r in free.iter() {
            let fixed = (0..count).filter(|s| held[*s] != Held::Free);
            right.push(start[*r] - fixed.map(|s| between[(*r, s)] * rows[s].impulse).sum::<f64>());
        }
        if !reduced.take(free.len(), |row, column| between[(free[row], free[column])]) {
            return false;
        }
        reduced.solve(&mut DVectorViewMut::from_slice(right, free.len()));
        for (index, impulse) in free.iter().zip(right.iter()) {
            rows[*index].impulse = *impulse;
        }
        true
    }

    /// Sets rows to the bounds that they break and frees those that want back; false if none does.
    fn revise(&mut self) -> bool {
        let count = self.all.len();
        let mut revised = false;
        for (row, held) in self.all.iter().zip(self.held.iter_mut()) {
            if *held == Held::Free && row.impulse < row.least {
                (*held, revised) = (Held::Least, true);
            } else if *held == Held::Free && row.impulse > row.most {
                (*held, revised) = (Held::Most, true);
            }
        }
        if revised {
            return true;
        }
        for r in 0..count {
            let held = self.held[r];
            if held == Held::Free {
                continue;
            }
            let reached: f64 = (0..count).map(|s| self.between[(r, s)] * self.all[s].impulse).sum();
            let missing = self.start[r] - reached;
            // less than what rounding leaves of the largest term is nothing
            let slack = 1e-12 * (self.start[r].abs() + reached.abs());
            if (held == Held::Least && missing > slack) || (held == Held::Most && missing < -slack) {
                (self.held[r], revised) = (Held::Free, true);
            }
        }
        revised
    }

    fn sweep(&mut self) {
        let count = self.all.len();
        for row in &mut self.all {
            row.impulse = row.impulse.clamp(row.least, row.most);
            if !row.impulse.is_finite() {
                row.impulse = 0.0;
            }
        }
        for _ in 0..SWEEPS {
            for r in 0..count {
                let reached: f64 = (0..count).map(|s| self.between[(r, s)] * self.all[s].impulse).sum();
                let row = &mut self.all[r];
                let change = (self.start[r] - reached) / self.between[(r, r)];
                row.impulse = (row.impulse + change).clamp(row.least, row.most);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(rows: &[Row], inverse: &[f64], v: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut problem = Rows { all: rows.to_vec(), ..Rows::default() };
        let mut v = v.to_vec();
        problem.solve(&DMatrix::from_row_slice(v.len(), v.len(), inverse), &mut v);
        (v, problem.all.iter().map(|row| row.impulse).collect())
    }

    #[test]
    fn friction_stops_what_it_can_and_brakes_the_rest() {
        // 2 kg at 1 m/s: 2 Ns stop it
        let (v, _) = solved(&[Row::rigid(0, 0.0, 3.0)], &[0.5], &[1.0]);
        assert_eq!(v, [0.0]);
        let (v, _) = solved(&[Row::rigid(0, 0.0, 0.5)], &[0.5], &[1.0]);
        assert_eq!(v, [0.75]);
    }

    #[test]
    fn a_drive_overcomes_friction_and_a_stop_overcomes_the_drive() {
        let drive = Row::rigid(0, 0.4, 10.0);
        let friction = Row::rigid(0, 0.0, 1.0);
        let (v, impulses) = solved(&[drive, friction], &[0.5], &[0.0]);
        // both rigid rows act on one coordinate, regularised by 1e-11
        assert!((v[0] - 0.4).abs() < 1e-9, "{v:?}");
        assert!((impulses[0] - 1.8).abs() < 1e-9 && (impulses[1] + 1.0).abs() < 1e-9, "{impulses:?}");
        let stop = Row { wanted: 0.1, least: f64::NEG_INFINITY, most: 0.0, ..Row::rigid(0, 0.0, 0.0) };
        let (v, _) = solved(&[drive, friction, stop], &[0.5], &[0.0]);
        assert!((v[0] - 0.1).abs() < 1e-9, "{v:?}");
    }

    #[test]
    fn a_soft_row_is_viscous_friction_taken_implicitly() {
        // m = 2, h c = 6: v1 = v0 m/(m + h c)
        let row = Row { softness: 1.0 / 6.0, ..Row::rigid(0, 0.0, f64::INFINITY) };
        let (v, _) = solved(&[row], &[0.5], &[1.0]);
        assert!((v[0] - 0.25).abs() < 1e-15);
    }

    #[test]
    fn a_coupling_keeps_its_ratio() {
        let gear = Row { with: [Some((1, -3.0)), None], ..Row::rigid(0, 0.0, f64::INFINITY) };
        let (v, _) = solved(&[gear], &[1.0, 0.0, 0.0, 0.2], &[1.0, 0.0]);
        assert!((v[0] - 3.0 * v[1]).abs() < 1e-12, "{v:?}");
    }
}
