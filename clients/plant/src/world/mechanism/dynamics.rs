//! The equations of motion of a tree of bodies: `H(q) dv/dt + b(q, v) = τ`.
//!
//! `H` by the composite rigid body algorithm, `b` (gravity, Coriolis and centrifugal forces) by the
//! recursive Newton-Euler algorithm, both in the world's axes about a point of the tree itself, so that
//! a machine far from the origin is as exact as one that stands there.
//!
//! Source: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, ch. 5 and 6.

use std::ops::Add;

use nalgebra::{DMatrix, DVector, DVectorViewMut, Matrix3, Quaternion, UnitQuaternion, Vector3};
use rapier3d::glamx::{DMat3, DQuat};
use rapier3d::math::{Pose, Vector};

use super::matrix::Factor;
use super::spatial::{Inertia, Twist, Wrench};
use super::tree::{Freedom, Tree};

/// Room for the equations of a tree, used again in every step.
#[derive(Clone, Debug, Default)]
pub(super) struct Equations {
    /// Where the members' joints and bodies are.
    pub(super) poses: Vec<Pose>,
    /// The motion that one unit of each velocity is.
    pub(super) axes: Vec<Twist>,
    pub(super) motions: Vec<Twist>,
    pub(super) accelerations: Vec<Twist>,
    forces: Vec<Wrench>,
    inertias: Vec<Inertia>,
    composites: Vec<Inertia>,
    /// `H`, and its factor once [`factor`](Self::factor) has run.
    pub(super) mass: DMatrix<f64>,
    pub(super) factored: Factor,
    pub(super) bias: DVector<f64>,
    /// The point that all is taken about.
    pub(super) about: Vector,
}

impl Equations {
    pub(super) fn new(tree: &Tree) -> Self {
        let (members, n) = (tree.members.len(), tree.velocities);
        Self {
            poses: vec![Pose::IDENTITY; members],
            axes: vec![Twist::default(); n],
            motions: vec![Twist::default(); members],
            accelerations: vec![Twist::default(); members],
            forces: vec![Wrench::default(); members],
            inertias: vec![Inertia::none(); members],
            composites: vec![Inertia::none(); members],
            mass: DMatrix::zeros(n, n),
            factored: Factor::default(),
            bias: DVector::zeros(n),
            about: tree.members.first().map_or(Vector::ZERO, |root| root.place.translation),
        }
    }

    /// Where everything is at these positions.
    pub(super) fn place(&mut self, tree: &Tree, q: &[f64]) {
        for (index, member) in tree.members.iter().enumerate() {
            let frame = match member.on {
                Some(on) => self.poses[on] * member.place,
                None => member.place,
            };
            let [position, velocity] = member.first;
            let about = self.about;
            let through = Vector3::from(frame.translation - about);
            let moved = match member.freedom {
                Freedom::Weld => frame,
                Freedom::Slide(axis) => {
                    self.axes[velocity] = Twist::sliding((frame.rotation * axis).into());
                    frame * Pose::from_translation(axis * q[position])
                }
                Freedom::Turn(axis) => {
                    self.axes[velocity] = Twist::turning((frame.rotation * axis).into(), through);
                    frame * Pose::from_rotation(turn(axis, q[position]))
                }
                Freedom::Ball => {
                    let rotation = frame.rotation * DQuat::from(quaternion(&q[position..position + 4]));
                    for (k, axis) in [Vector::X, Vector::Y, Vector::Z].into_iter().enumerate() {
                        self.axes[velocity + k] = Twist::turning((rotation * axis).into(), through);
                    }
                    Pose::from_parts(frame.translation, rotation)
                }
            };
            self.poses[index] = moved * member.tip;
        }
    }

    /// The motion of every member at these velocities, where it was placed.
    pub(super) fn moves(&mut self, tree: &Tree, v: &[f64]) {
        for (index, member) in tree.members.iter().enumerate() {
            let base = member.on.map_or_else(Twist::default, |on| self.motions[on]);
            self.motions[index] = base + self.own(member.first[1], member.freedom, v);
        }
    }

    fn own(&self, first: usize, freedom: Freedom, v: &[f64]) -> Twist {
        let each = (first..first + freedom.velocities()).map(|k| self.axes[k] * v[k]);
        each.fold(Twist::default(), Twist::add)
    }

    fn weigh(&mut self, tree: &Tree) {
        for (index, member) in tree.members.iter().enumerate() {
            self.inertias[index] = if member.mass > 0.0 {
                let pose = self.poses[index];
                let turned = Matrix3::from(DMat3::from_quat(pose.rotation));
                let tensor = turned * member.tensor * turned.transpose();
                Inertia::of(member.mass, (pose * member.centre - self.about).into(), tensor)
            } else {
                Inertia::none()
            };
        }
    }

    /// The whole equations at these positions and velocities.
    pub(super) fn evaluate(&mut self, tree: &Tree, q: &[f64], v: &[f64], gravity: Vector) {
        self.place(tree, q);
        self.weigh(tree);
        self.newton_euler(tree, v, gravity);
        self.composite(tree);
    }

    /// The bias at other velocities, where it was evaluated.
    pub(super) fn bias_at(&mut self, tree: &Tree, v: &[f64], gravity: Vector) {
        self.newton_euler(tree, v, gravity);
    }

    fn newton_euler(&mut self, tree: &Tree, v: &[f64], gravity: Vector) {
        // what stands still in a field of gravity is as what is accelerated against it
        let ground = (Twist::default(), Twist::sliding((-gravity).into()));
        for (index, member) in tree.members.iter().enumerate() {
            let (motion, acceleration) = member.on.map_or(ground, |on| (self.motions[on], self.accelerations[on]));
            let own = self.own(member.first[1], member.freedom, v);
            let motion = motion + own;
            let acceleration = acceleration + motion.carries(&own);
            let inertia = &self.inertias[index];
            self.forces[index] = inertia.times(&acceleration) + motion.carries_force(&inertia.times(&motion));
            (self.motions[index], self.accelerations[index]) = (motion, acceleration);
        }
        self.gather(tree);
    }

    /// Sums the members' forces from the tips down, and what of them acts on each coordinate: `bias`.
    fn gather(&mut self, tree: &Tree) {
        for (index, member) in tree.members.iter().enumerate().rev() {
            let force = self.forces[index];
            let first = member.first[1];
            for k in first..first + member.freedom.velocities() {
                self.bias[k] = self.axes[k].power(&force);
            }
            if let Some(on) = member.on {
                self.forces[on] = self.forces[on] + force;
            }
        }
    }

    fn composite(&mut self, tree: &Tree) {
        self.composites.copy_from_slice(&self.inertias);
        self.mass.fill(0.0);
        for (index, member) in tree.members.iter().enumerate().rev() {
            let composite = self.composites[index];
            let first = member.first[1];
            for k in first..first + member.freedom.velocities() {
                let force = composite.times(&self.axes[k]);
                let mut below = Some(index);
                while let Some(other) = below {
                    let member = &tree.members[other];
                    let start = member.first[1];
                    for j in start..start + member.freedom.velocities() {
                        let entry = self.axes[j].power(&force);
                        self.mass[(k, j)] = entry;
                        self.mass[(j, k)] = entry;
                    }
                    below = member.on;
                }
            }
            if let Some(on) = member.on {
                self.composites[on] = self.composites[on] + composite;
            }
        }
    }

    /// Kinetic energy, that of heights, and that of a metre of height, J, at these positions and velocities.
    pub(super) fn energy(&mut self, tree: &Tree, [q, v]: [&[f64]; 2], gravity: Vector) -> (f64, f64, f64) {
        self.place(tree, q);
        self.weigh(tree);
        self.moves(tree, v);
        let (mut kinetic, mut height, mut weight) = (0.0, 0.0, 0.0);
        for (index, member) in tree.members.iter().enumerate() {
            let motion = self.motions[index];
            kinetic += 0.5 * motion.power(&self.inertias[index].times(&motion));
            height -= member.mass * gravity.dot(self.poses[index] * member.centre - self.about);
            weight += member.mass * gravity.length();
        }
        (kinetic, height, weight)
    }

    /// Factors `H`; false where the masses are so far apart that it cannot be.
    #[must_use]
    pub(super) fn factor(&mut self, tree: &Tree) -> bool {
        let Self { mass, factored, .. } = self;
        factored.take(tree.velocities, |row, column| mass[(row, column)])
    }

    /// The velocities that have the momentum of the bodies' own motions: of all that the joints allow,
    /// those that are nearest to them by kinetic energy.
    #[must_use]
    pub(super) fn project(&mut self, tree: &Tree, q: &[f64], own: impl Fn(usize) -> Twist, v: &mut [f64]) -> bool {
        self.place(tree, q);
        self.weigh(tree);
        for (index, inertia) in self.inertias.iter().enumerate() {
            self.forces[index] = inertia.times(&own(index));
        }
        self.gather(tree);
        self.composite(tree);
        v.copy_from_slice(self.bias.as_slice());
        let factored = self.factor(tree);
        if factored {
            self.factored.solve(&mut DVectorViewMut::from_slice(v, tree.velocities));
        }
        factored
    }
}

/// A quaternion as it stands among the positions, of unit length except for the rounding of a step.
fn quaternion(q: &[f64]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(q[3], q[0], q[1], q[2]))
}

fn turn(axis: Vector, angle: f64) -> DQuat {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    DQuat::from_xyzw(axis.x * sine, axis.y * sine, axis.z * sine, cosine)
}

/// How positions change with these velocities; for a ball half the quaternion's product with its turning.
pub(super) fn rates(tree: &Tree, q: &[f64], v: &[f64], rates: &mut [f64]) {
    for member in &tree.members {
        let [position, velocity] = member.first;
        match member.freedom {
            Freedom::Weld => {}
            Freedom::Slide(_) | Freedom::Turn(_) => rates[position] = v[velocity],
            Freedom::Ball => {
                let turning = Quaternion::new(0.0, 0.5 * v[velocity], 0.5 * v[velocity + 1], 0.5 * v[velocity + 2]);
                let rate = quaternion(&q[position..position + 4]).into_inner() * turning;
                rates[position..position + 4].copy_from_slice(rate.coords.as_slice());
            }
        }
    }
}

/// Takes the rounding of a step out of the quaternions.
pub(super) fn normalise(tree: &Tree, q: &mut [f64]) {
    for member in &tree.members {
        if member.freedom == Freedom::Ball {
            let [position, _] = member.first;
            let unit = UnitQuaternion::new_normalize(quaternion(&q[position..position + 4]).into_inner());
            q[position..position + 4].copy_from_slice(unit.coords.as_slice());
        }
    }
}
