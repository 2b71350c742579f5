//! What each joint of a mechanism has to move: its apparent mass, with couplings kept and driven joints held.

use super::{Mechanism, matrix};
use rapier3d::math::Vector;

impl Mechanism {
    /// Each joint of the scene with the inverse of what it moves, 1/kg or 1/(kg·m²), in the pose that it has; all other
    /// joints are free but for those that are `held`. None if its equations cannot be solved.
    pub(crate) fn apparent(&mut self, gravity: Vector, held: &dyn Fn(usize) -> bool) -> Option<Vec<(usize, f64)>> {
        let n = self.tree.velocities;
        self.moving.evaluate(&self.lumps, &self.now.q, &self.now.v, gravity);
        if !self.moving.factor(&self.lumps) {
            return None;
        }
        let mut inverse = vec![0.0; n * n];
        matrix::inverse(&self.moving.mass, n, &mut inverse);
        let mut tie = |on: usize, with: [Option<(usize, f64)>; 2]| {
            let mut row = vec![0.0; n];
            row[on] = 1.0;
            for (axis, slope) in with.into_iter().flatten() {
                row[axis] += slope;
            }
            keep(&mut inverse, &row);
        };
        for (axis, joint) in self.axes.iter().enumerate() {
            if joint.1.is_some_and(held) {
                tie(axis, [None; 2]);
            }
        }
        for bond in &self.bonds {
            let (on, with) = bond.ties(|axis| self.now.q[self.axes[axis].0]);
            tie(on, with);
        }
        let each = self.axes.iter().enumerate();
        Some(each.filter_map(|(axis, (_, joint))| joint.map(|joint| (joint, inverse[axis * n + axis]))).collect())
    }
}

/// Takes from the inverse of a matrix of masses the motion along a row, which is held from now on.
fn keep(inverse: &mut [f64], row: &[f64]) {
    let n = row.len();
    let column: Vec<f64> = inverse.chunks_exact(n).map(|line| line.iter().zip(row).map(|(a, b)| a * b).sum()).collect();
    let along: f64 = column.iter().zip(row).map(|(a, b)| a * b).sum();
    if along <= 0.0 {
        // it is held already
        return;
    }
    for (line, left) in inverse.chunks_exact_mut(n).zip(&column) {
        for (entry, right) in line.iter_mut().zip(&column) {
            *entry -= left * right / along;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_no_longer_gives_way() {
        // two masses of 1 and 2 kg, with the second counted from the first: [[3, 2], [2, 2]]
        let mut inverse = [1.0, -1.0, -1.0, 1.5];
        keep(&mut inverse, &[1.0, 0.0]);
        for (entry, exact) in inverse.into_iter().zip([0.0, 0.0, 0.0, 0.5]) {
            assert!((entry - exact).abs() < 1e-15, "{inverse:?}");
        }
        keep(&mut inverse, &[1.0, 0.0]);
        assert!(inverse.iter().all(|entry| entry.is_finite()), "{inverse:?}");
    }
}
