//! What the joints of a mechanism have to move: its equations at rest, and the apparent mass of each joint, with
//! couplings kept and driven joints held.

use nalgebra::{DMatrix, DVector};
use rapier3d::math::Vector;

use super::Mechanism;

/// The equations of a mechanism that rests in its pose, for those of its coordinates that are joints of the scene.
pub(crate) struct AtRest {
    /// Indices of these joints in the scene.
    pub(crate) joints: Vec<usize>,
    /// What holds each of them against gravity, N or Nm.
    pub(crate) holding: Vec<f64>,
    /// A row for each of them.
    pub(crate) mass: Vec<Vec<f64>>,
}

impl Mechanism {
    /// Its equations at rest, without fittings and couplings.
    pub(crate) fn at_rest(&mut self, gravity: Vector) -> AtRest {
        let n = self.tree.velocities;
        self.moving.evaluate(&self.lumps, &self.now.q, &vec![0.0; n], gravity);
        let named = self.axes.iter().enumerate().filter_map(|(axis, (_, joint))| joint.map(|joint| (axis, joint)));
        let named: Vec<_> = named.collect();
        let row = |axis: usize| named.iter().map(|(other, _)| self.moving.mass[(axis, *other)]).collect();
        AtRest {
            joints: named.iter().map(|(_, joint)| *joint).collect(),
            holding: named.iter().map(|(axis, _)| self.moving.bias[*axis]).collect(),
            mass: named.iter().map(|(axis, _)| row(*axis)).collect(),
        }
    }

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
        self.find_loops(gravity);
        for row in self.basis.rows() {
            keep(&mut inverse, row);
        }
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
