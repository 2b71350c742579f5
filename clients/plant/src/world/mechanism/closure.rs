//! Loops: joints whose bodies hang together by others already, as constraints of the tree of these.
//!
//! # Method
//! A closure holds some motions of its two bodies against each other: `φ(q) = 0`, so `J v = 0` and `J dv/dt = -γ`. Its
//! rows are made orthogonal to each other in `M⁻¹`, one after the other (Gram and Schmidt); what is then left of a row that
//! others imply is nothing, and it is left out: three of the five rows of a pin in a planar linkage. With such a basis
//! accelerations, velocities, positions and the inverse of the masses are brought to what the loop allows by one pass
//! over its rows, each by its inertia. Accelerations keep to it at each stage of a step, so that loops have the order of
//! trees; what a step leaves of `φ` is taken back at its end. Joints that are led along a path stay where they are in this:
//! they come first in the basis. Only where the others cannot close a loop, as at a dead centre, do they give way.
//!
//! Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, Springer 1996, ch. VII (index reduction
//! and projection).

use nalgebra::{DMatrix, DVector, DVectorView, DVectorViewMut, Vector3};
use rapier3d::math::{Pose, Vector};

use super::Mechanism;
use super::dynamics::{Equations, normalise, rates};
use super::spatial::Twist;
use super::tree::{Closure, End, Tree};
use crate::model::JointKind;

/// Of a row's square, this part is left over by rounding if others imply it.
const IMPLIED: f64 = 1e-10;
/// A loop is closed within this, m or rad.
const CLOSED: f64 = 1e-12;
/// What no motion is left for may be open by this, m or rad: scenes are written with so many digits.
const STUCK: f64 = 1e-9;
/// Newton's steps that close a loop; near it, each squares what is open.
const ROUNDS: usize = 12;
/// The longest of them in any coordinate, m or rad: at a dead centre they know no end.
const LONGEST: f64 = 0.1;
/// What the inverse of the masses keeps of a motion that loops hold, so that nothing is divided by 0.
const GIVES: f64 = 1e-12;

/// How loops are closed after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Closed {
    /// All axes stay that are to.
    Shut,
    /// Not without those axes: they gave way.
    Forced,
    /// Its equations cannot be solved.
    Unsolved,
}

/// What a closure holds along one direction.
#[derive(Clone, Debug, Default)]
struct Direction {
    /// `J`, a factor for each velocity.
    along: DVector<f64>,
    /// `M⁻¹ Jᵀ`.
    answer: DVector<f64>,
    /// `φ`: how far it is open.
    open: f64,
    /// `γ`: what its acceleration is without any of the coordinates'.
    bend: f64,
    /// `J v` as it is to be.
    rate: f64,
}

/// How a frame moves.
struct Seen {
    pose: Pose,
    motion: Twist,
    acceleration: Twist,
    /// From the point that all is taken about.
    arm: Vector3<f64>,
}

impl Seen {
    /// Velocity and acceleration of the frame's origin.
    fn moves(&self) -> [Vector3<f64>; 2] {
        let velocity = self.motion.at(self.arm);
        [velocity, self.acceleration.at(self.arm) + self.motion.angular().cross(&velocity)]
    }
}

/// The directions that loops hold, orthogonal in `M⁻¹` and of unit length.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    directions: Vec<Direction>,
    /// The greatest of `φ`, m or rad.
    open: f64,
    /// The greatest that no motion is left for to close it.
    stuck: f64,
}

impl Basis {
    /// The directions of all loops of a tree, from equations that are evaluated and factored.
    pub(super) fn find(&mut self, tree: &Tree, equations: &Equations, gravity: Vector) {
        self.find_beside(&[], tree, equations, gravity);
    }

    /// The same with axes that are held, each with the velocity that it keeps.
    fn find_beside(&mut self, held: &[(usize, f64)], tree: &Tree, equations: &Equations, gravity: Vector) {
        self.directions.clear();
        (self.open, self.stuck) = (0.0, 0.0);
        for (axis, rate) in held {
            let mut along = DVector::zeros(tree.velocities);
            along[*axis] = 1.0;
            let mut answer = along.clone();
            equations.factored.solve(&mut answer);
            let size = answer[*axis];
            self.take(Direction { along, answer, rate: *rate, ..Direction::default() }, size);
        }
        for closure in &tree.closures {
            closure.hold(tree, equations, gravity, self);
        }
    }

    /// Takes up a direction, less what those before it hold; `size` is that of its parts before they cancel.
    fn take(&mut self, mut one: Direction, size: f64) {
        let whole = one.open.abs();
        for held in &self.directions {
            let share = one.along.dot(&held.answer);
            one.along.axpy(-share, &held.along, 1.0);
            one.answer.axpy(-share, &held.answer, 1.0);
            one.open -= share * held.open;
            one.bend -= share * held.bend;
            one.rate -= share * held.rate;
        }
        let square = one.along.dot(&one.answer);
        if square > IMPLIED * size {
            self.open = self.open.max(whole);
            let factor = square.sqrt().recip();
            one.along *= factor;
            one.answer *= factor;
            one.open *= factor;
            one.bend *= factor;
            one.rate *= factor;
            self.directions.push(one);
        } else {
            self.stuck = self.stuck.max(one.open.abs());
        }
    }

    /// Takes from velocities what the loops do not allow.
    fn allow(&self, v: &mut [f64]) {
        let n = v.len();
        for held in &self.directions {
            let lost = held.along.dot(&DVectorView::from_slice(v, n)) - held.rate;
            DVectorViewMut::from_slice(v, n).axpy(-lost, &held.answer, 1.0);
        }
    }

    /// Brings accelerations to those that the loops allow.
    pub(super) fn bend(&self, a: &mut DVector<f64>) {
        for held in &self.directions {
            let lost = held.along.dot(a) + held.bend;
            a.axpy(-lost, &held.answer, 1.0);
        }
    }

    /// The accelerations that loops ask for by themselves.
    fn bends(&self, bends: &mut DVector<f64>) {
        let n = self.directions.first().map_or(0, |held| held.along.len());
        bends.resize_vertically_mut(n, 0.0);
        bends.fill(0.0);
        for held in &self.directions {
            bends.axpy(-held.bend, &held.answer, 1.0);
        }
    }

    /// The inverse of the masses with the loops.
    fn hold(&self, inverse: &mut DMatrix<f64>) {
        let free: Vec<f64> = inverse.diagonal().iter().copied().collect();
        for held in &self.directions {
            inverse.ger(-1.0, &held.answer, &held.answer, 1.0);
        }
        for (axis, free) in free.into_iter().enumerate() {
            inverse[(axis, axis)] = inverse[(axis, axis)].max(0.0) + GIVES * free;
        }
    }

    /// The rows `J`, each a factor for each velocity.
    pub(super) fn rows(&self) -> impl Iterator<Item = &DVector<f64>> {
        self.directions.iter().map(|held| &held.along)
    }
}

/// Which motions along and about the axes of its frame a joint holds.
const fn held(kind: JointKind) -> [[bool; 3]; 2] {
    match kind {
        JointKind::Fixed => [[true; 3], [true; 3]],
        JointKind::Ball => [[true; 3], [false; 3]],
        JointKind::Revolute => [[true; 3], [false, true, true]],
        JointKind::Prismatic => [[false, true, true], [true; 3]],
        JointKind::Slot => [[true, false, true], [false, true, true]],
    }
}

impl Closure {
    /// Gives `basis` all directions that it holds.
    fn hold(&self, tree: &Tree, equations: &Equations, gravity: Vector, basis: &mut Basis) {
        let [parent, child] = self.ends.map(|end| seen(end, equations, gravity));
        let axes = [Vector::X, Vector::Y, Vector::Z].map(|axis| Vector3::from(parent.pose.rotation * axis));
        let [along, about] = held(self.kind);
        let [[from_m_s, from_m_s2], [to_m_s, to_m_s2]] = [&parent, &child].map(Seen::moves);
        let [turning, angular] = [parent.motion.angular(), parent.acceleration.angular()];
        let away = child.arm - parent.arm;
        let slides = to_m_s - from_m_s - turning.cross(&away);
        let bends = to_m_s2 - from_m_s2 - angular.cross(&away) - turning.cross(&(to_m_s - from_m_s));
        for (axis, _) in axes.iter().zip(along).filter(|(_, held)| *held) {
            let bend = axis.dot(&bends) + turning.cross(axis).dot(&slides);
            let lever = |motion: &Twist| motion.at(child.arm);
            self.direct(tree, equations, axis, lever, [axis.dot(&away), bend], basis);
        }
        let turns = child.motion.angular() - turning;
        let bends = child.acceleration.angular() - angular;
        let open = turned([&parent, &child], about);
        for ((axis, open), _) in axes.iter().zip(open).zip(about).filter(|(_, held)| *held) {
            let bend = axis.dot(&bends) + turning.cross(axis).dot(&turns);
            self.direct(tree, equations, axis, Twist::angular, [open, bend], basis);
        }
    }

    /// Gives `basis` one direction: of what `lever` makes of a motion, the part along an axis.
    fn direct(
        &self,
        tree: &Tree,
        equations: &Equations,
        axis: &Vector3<f64>,
        lever: impl Fn(&Twist) -> Vector3<f64>,
        [open, bend]: [f64; 2],
        basis: &mut Basis,
    ) {
        let (mut along, mut size) = (DVector::zeros(tree.velocities), 0.0);
        for (end, sign) in self.ends.iter().zip([-1.0, 1.0]) {
            let mut at = end.member;
            while let Some(member) = at.map(|index| &tree.members[index]) {
                for k in member.first[1]..member.first[1] + member.freedom.velocities() {
                    let moved = lever(&equations.axes[k]);
                    along[k] += sign * moved.dot(axis);
                    size += moved.norm_squared() / equations.mass[(k, k)];
                }
                at = member.on;
            }
        }
        let mut answer = along.clone();
        equations.factored.solve(&mut answer);
        basis.take(Direction { along, answer, open, bend, rate: 0.0 }, size);
    }
}

fn seen(end: End, equations: &Equations, gravity: Vector) -> Seen {
    let (pose, motion, acceleration) = match end.member {
        Some(member) => {
            let pose = equations.poses[member] * end.frame;
            (pose, equations.motions[member], equations.accelerations[member])
        }
        // as the equations have it, the ground is accelerated against gravity
        None => (end.frame, Twist::default(), Twist::sliding((-gravity).into())),
    };
    Seen { pose, motion, acceleration, arm: (pose.translation - equations.about).into() }
}

/// How far a child's frame is turned against its parent's, about the axes of that; of a joint that turns about its x
/// axis, how far that axis is.
fn turned([parent, child]: [&Seen; 2], about: [bool; 3]) -> [f64; 3] {
    let between = parent.pose.rotation.inverse() * child.pose.rotation;
    if about[0] {
        let sign = if between.w < 0.0 { -2.0 } else { 2.0 };
        return [sign * between.x, sign * between.y, sign * between.z];
    }
    let axis = between * Vector::X;
    [0.0, -axis.z, axis.y]
}

impl Mechanism {
    /// True if it has loops.
    pub(super) fn has_loops(&self) -> bool {
        !self.lumps.closures.is_empty()
    }

    /// Finds what its loops hold, from equations that are evaluated and factored.
    pub(super) fn find_loops(&mut self, gravity: Vector) {
        self.basis.find(&self.lumps, &self.moving, gravity);
    }

    /// Lets its loops hold in the inverse of its masses.
    pub(super) fn hold_loops(&mut self, gravity: Vector) {
        if self.has_loops() {
            self.find_loops(gravity);
            self.basis.hold(&mut self.room.inverse);
            self.basis.bends(&mut self.room.bends);
        }
    }

    /// Takes what its loops ask for by themselves at the velocities that its equations have now.
    pub(super) fn bend_loops(&mut self, gravity: Vector) {
        if self.has_loops() {
            self.find_loops(gravity);
            self.basis.bends(&mut self.room.bends);
        }
    }

    /// Closes its loops after a step: positions, then velocities. The axes that are `held` stay, unless the loops cannot
    /// be closed without them.
    pub(super) fn close(&mut self, gravity: Vector, held: &[usize]) -> Closed {
        if !self.has_loops() {
            return Closed::Shut;
        }
        let held: Vec<_> = held.iter().map(|axis| (*axis, self.now.v[*axis])).collect();
        let open = if held.is_empty() { None } else { Some(self.now.q.clone()) };
        let (mut solved, mut closed) = (self.shut(gravity, &held), Closed::Shut);
        let is_shut = self.basis.open <= CLOSED && self.basis.stuck <= STUCK;
        if let Some(open) = open.filter(|_| !(solved && is_shut)) {
            self.now.q = open;
            (solved, closed) = (self.shut(gravity, &[]), Closed::Forced);
        }
        if !solved {
            return Closed::Unsolved;
        }
        self.basis.allow(&mut self.now.v);
        closed
    }

    /// Closes its loops as far as Newton's steps do; false if its equations cannot be solved.
    fn shut(&mut self, gravity: Vector, held: &[(usize, f64)]) -> bool {
        for _ in 0..ROUNDS {
            self.moving.evaluate(&self.lumps, &self.now.q, &self.now.v, gravity);
            if !self.moving.factor(&self.lumps) {
                return false;
            }
            let Self { lumps, moving, now, room, basis, .. } = self;
            basis.find_beside(held, lumps, moving, gravity);
            if basis.open <= CLOSED {
                break;
            }
            let mut way = DVector::zeros(lumps.velocities);
            for held in &basis.directions {
                way.axpy(-held.open, &held.answer, 1.0);
            }
            let most = way.amax();
            if most > LONGEST {
                way *= LONGEST / most;
            }
            room.rates[0].resize(lumps.positions, 0.0);
            rates(lumps, &now.q, way.as_slice(), &mut room.rates[0]);
            for (q, rate) in now.q.iter_mut().zip(&room.rates[0]) {
                *q += rate;
            }
            normalise(lumps, &mut now.q);
        }
        true
    }
}
