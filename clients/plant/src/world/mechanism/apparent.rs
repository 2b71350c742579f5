//! What each joint of a mechanism has to move: its apparent mass, with couplings kept and driven joints held.

use nalgebra::{DMatrix, DVector};
use rapier3d::math::Vector;

use super::Mechanism;

impl Mechanism {
    /// Each joint of the scene with the inverse of what it moves, 1/kg or 1/(kg·m²), in the pose that it has; all other
    /// joints are free but for those that are `held`. None if its equations cannot be solved.
    pub(crate) fn apparent(&mut self, gravity: Vector, held: &dyn Fn(usize) -> bool) -> Option<Vec<(usize, f64)>> {
        let n = self.tree.velocities;
        self.moving.evaluate(&self.lumps, &self.now.q, &self.now.v, gravity);
        if !self.moving.factor(&self.lumps) {
            return None;
        }
        let mut inverse = DMatrix::zeros(n, n);
        self.moving.factored.inverse(&mut inverse);
        let mut tie = |on: usize, with: [Option<(usize, f64)>; 2]| {
            let mut row = DVector::zeros(n);
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
        Some(each.filter_map(|(axis, (_, joint))| joint.map(|joint| (joint, inverse[(axis, axis)]))).collect())
    }
}

/// Takes from the inverse of a matrix of masses the motion along a row, which is held from now on.
fn keep(inverse: &mut DMatrix<f64>, row: &DVector<f64>) {
    let mut moved = DVector::zeros(row.len());
    moved.gemv(1.0, inverse, row, 0.0);
    let along = moved.dot(row);
    if along <= 0.0 {
        // it is held already
        return;
    }
    inverse.ger(-1.0 / along, &moved, &moved, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_no_longer_gives_way() {
        // two masses of 1 and 2 kg, with the second counted from the first: [[3, 2], [2, 2]]
        let mut inverse = DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.5]);
        let first = DVector::from_vec(vec![1.0, 0.0]);
        keep(&mut inverse, &first);
        for (entry, exact) in inverse.iter().zip([0.0, 0.0, 0.0, 0.5]) {
            assert!((entry - exact).abs() < 1e-15, "{inverse:?}");
        }
        keep(&mut inverse, &first);
        assert!(inverse.iter().all(|entry| entry.is_finite()), "{inverse:?}");
    }
}
