//! Couplings between the coordinates of joints: gears, belts, racks, screws, differentials, cams.

use super::Mechanism;
use super::dynamics::{normalise, rates};
use super::rows::Row;
use crate::coupled::{Coupled, Of};

/// Greatest velocity at which a coupling makes up for a coordinate that is off, m/s or rad/s.
const CATCH_UP: f64 = 0.1;

/// A coupling, by the axes of a mechanism.
pub(super) struct Bond {
    on: usize,
    /// The axes that the first follows.
    of: [Option<usize>; 2],
    coupled: Coupled,
}

impl Bond {
    /// How far the first coordinate is from where the others want it, and how that changes with them.
    fn off(&self, q: impl Fn(usize) -> f64) -> (f64, [Option<(usize, f64)>; 2]) {
        let wanted = |of: &Of, axis: Option<usize>| axis.map(|axis| (axis, of.at(q(axis))));
        let (mut off, mut with) = (q(self.on), [None; 2]);
        for ((with, of), axis) in with.iter_mut().zip(&self.coupled.of).zip(self.of) {
            if let Some((axis, (value, slope))) = wanted(of, axis) {
                off -= value;
                *with = Some((axis, -slope));
            }
        }
        (off, with)
    }

    /// The axis that it leads, and how that changes with those that lead it.
    pub(super) fn ties(&self, q: impl Fn(usize) -> f64) -> (usize, [Option<(usize, f64)>; 2]) {
        (self.on, self.off(q).1)
    }

    /// Its rows in a sub-step that ends at `dt_s`, at no more than `fastest`, with impulses of a time of `over_s`.
    fn rows(&self, q: impl Fn(usize) -> f64, [dt_s, over_s]: [f64; 2], fastest: f64) -> [Option<Row>; 2] {
        let (off, with) = self.off(q);
        if let Some(most) = self.coupled.slip {
            // it knows no place: where it has slipped to, it stays
            return [Some(Row { with, ..Row::rigid(self.on, 0.0, most * over_s) }), None];
        }
        let half = 0.5 * self.coupled.backlash;
        let back = |off: f64| (-off / dt_s).clamp(-fastest, fastest);
        let row = Row { with, ..Row::rigid(self.on, back(off), f64::INFINITY) };
        if half == 0.0 {
            return [Some(row), None];
        }
        // in its backlash it is free: each flank only pushes
        let below =
            Row { wanted: if off < -half { back(off + half) } else { (-half - off) / dt_s }, least: 0.0, ..row };
        let above = Row { wanted: if off > half { back(off - half) } else { (half - off) / dt_s }, most: 0.0, ..row };
        [Some(below), Some(above)]
    }
}

impl Mechanism {
    /// Takes up the couplings between its joints.
    pub(super) fn bind(&mut self, couplings: &[Coupled]) {
        let axis = |joint: usize| self.axes.iter().position(|(_, own)| *own == Some(joint));
        for coupled in couplings {
            let Some(on) = axis(coupled.joint) else { continue };
            let mut of = [None; 2];
            for (of, share) in of.iter_mut().zip(&coupled.of) {
                *of = axis(share.joint);
            }
            self.bonds.push(Bond { on, of, coupled: coupled.clone() });
        }
    }

    /// The joints that lead couplings of it.
    pub(crate) fn coupled(&self) -> impl Iterator<Item = usize> {
        self.bonds.iter().map(|bond| bond.coupled.joint)
    }

    /// The rows of all couplings in a sub-step.
    pub(super) fn couple(&mut self, dt_s: f64) {
        let Self { bonds, rows, room, now, axes, .. } = self;
        for bond in bonds {
            let q = |axis: usize| now.q[axes[axis].0];
            rows.all.extend(bond.rows(q, [dt_s; 2], CATCH_UP).into_iter().flatten());
            for axis in bond.of.into_iter().flatten().chain([bond.on]) {
                room.exact[axis] = true;
            }
        }
    }

    /// Brings coordinates and velocities that the engine has moved back to what the couplings allow, each
    /// by its inertia, after a step of `dt_s`; true if there are any.
    pub(super) fn reconcile(&mut self, dt_s: f64) -> bool {
        let n = self.tree.velocities;
        if self.bonds.is_empty() {
            return false;
        }
        self.equations.factored.inverse(&mut self.room.inverse);
        // first the way back, as a velocity of one second, then what is left of the velocity
        self.room.v.clear();
        self.room.v.resize(n, 0.0);
        self.solve_bonds([1.0, 0.0], f64::INFINITY);
        self.room.rates[0].resize(self.tree.positions, 0.0);
        rates(&self.tree, &self.now.q, &self.room.v, &mut self.room.rates[0]);
        for (q, way) in self.now.q.iter_mut().zip(&self.room.rates[0]) {
            *q += way;
        }
        normalise(&self.tree, &mut self.now.q);
        self.room.v.clone_from(&self.now.v);
        self.solve_bonds([1e-3, dt_s], 0.0);
        self.now.v.clone_from(&self.room.v);
        true
    }

    fn solve_bonds(&mut self, times_s: [f64; 2], fastest: f64) {
        let Self { bonds, rows, room, now, axes, .. } = self;
        rows.all.clear();
        for bond in bonds {
            let q = |axis: usize| now.q[axes[axis].0];
            rows.all.extend(bond.rows(q, times_s, fastest).into_iter().flatten());
        }
        rows.solve(&room.inverse, &mut room.v);
    }
}
