//! Mechanisms: bodies on joints, moved by the coordinates of their joints and nothing else.
//!
//! A tree of joints that stands on the ground or on fixed bodies is integrated here, as long as none of
//! its bodies touches another. Joints are then exact: there is nothing that could come apart. Where
//! bodies touch, the engine computes the step (see [`super::articulation`]), and the mechanism takes
//! its coordinates from where the engine has put the bodies.
//!
//! | module | subject |
//! |---|---|
//! | `spatial` | motions, forces and inertias as vectors of six |
//! | `matrix` | symmetric matrices of any number of rows |
//! | `tree` | which bodies hang together |
//! | `closure` | loops: joints between what hangs together already |
//! | `lump` | what is welded together as one body |
//! | `dynamics` | the equations of motion of a tree |
//! | `rows` | drives, friction and stops within their bounds |
//! | `coupled` | gears, racks, screws, differentials, cams between joints |
//! | `guided` | robots without dynamics |
//! | `free` | steps of what only smooth forces move: Runge-Kutta of order 4 |
//! | `driven` | steps with drives, friction, stops |
//! | `gain` | steps that give energy that nothing gave |
//! | `sprung` | springs and dampers in these |
//! | `apparent` | what joints have to move, and hold at rest |
//! | `touched` | what a mechanism is to others that it touches |
//!
//! # Invariants
//! - What is computed follows from positions, velocities and the drives' states; how often, too.
//! - Only operations of IEC 60559 and `libm`.

mod apparent;
mod closure;
mod coupled;
mod driven;
mod dynamics;
mod free;
mod gain;
mod guided;
mod lump;
pub(super) mod matrix;
mod rows;
mod spatial;
mod sprung;
mod touched;
mod tree;

use nalgebra::{DMatrix, DVector};
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

use super::actuator::Actuator;
use crate::coupled::Coupled;
use crate::effort::Drives;
use crate::fitting::Fitting;
use crate::model::JointKind;
pub(crate) use apparent::AtRest;
use closure::{Basis, Closed};
use coupled::Bond;
use dynamics::Equations;
pub(crate) use guided::{Guided, guided};
use rows::Rows;
use spatial::Twist;
pub(crate) use tree::Link;
use tree::Tree;

/// What a mechanism remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Coordinates {
    q: Vec<f64>,
    v: Vec<f64>,
}

/// A tree of bodies in motion.
pub(crate) struct Mechanism {
    tree: Tree,
    now: Coordinates,
    equations: Equations,
    /// The tree with what is welded together as one body, by which it moves, and its equations.
    lumps: Tree,
    moving: Equations,
    /// For each velocity: its position and the joint of the scene that it is the coordinate of.
    axes: Vec<(usize, Option<usize>)>,
    bonds: Vec<Bond>,
    /// What its loops hold.
    basis: Basis,
    rows: Rows,
    room: Room,
}

/// Room for steps, used again.
#[derive(Default)]
struct Room {
    /// Where a step began.
    start: Coordinates,
    q: Vec<f64>,
    v: Vec<f64>,
    rates: [Vec<f64>; 4],
    accelerations: [Vec<f64>; 4],
    force: DVector<f64>,
    inverse: DMatrix<f64>,
    /// Accelerations that loops ask for by themselves.
    bends: DVector<f64>,
    /// The same with what springs and dampers add in a sub-step.
    stiff: DMatrix<f64>,
    column: DVector<f64>,
    /// What springs and dampers add to each axis, as a mass.
    added: Vec<f64>,
    driven: Vec<bool>,
    /// Axes with springs, and what of viscous friction these take with them.
    sprung: Vec<bool>,
    viscous: Vec<f64>,
    /// Axes that go on with their new velocity in a sub-step.
    exact: Vec<bool>,
}

/// What a mechanism moves in.
pub(crate) struct Surroundings<'s> {
    pub(crate) gravity: Vector,
    /// Fittings of the scene's joints.
    pub(crate) fittings: &'s [Fitting],
    /// Actuators of the scene.
    pub(crate) actuators: &'s mut [Actuator],
    pub(crate) drives: &'s mut dyn Drives,
    /// Parts of the turn at which the step begins and ends.
    pub(crate) part: [f64; 2],
}

/// The mechanisms that joints make of bodies, and the joints, by their index in the scene, of what
/// cannot be one; joints that are `plain` close loops. What holds a body fast never closes one: two that
/// hold one body give way, as grippers do.
pub(crate) fn mechanisms(
    links: &[Link],
    couplings: &[Coupled],
    bodies: &RigidBodySet,
    plain: impl Fn(usize) -> bool,
    last: impl Fn(usize) -> f64,
) -> (Vec<Mechanism>, Vec<usize>) {
    let moved = |handle: RigidBodyHandle| bodies[handle].is_dynamic();
    let forest = tree::forest(links, couplings, bodies, &moved, &|link| link.joint.is_some_and(&plain));
    let mechanisms = forest.trees.into_iter().map(|tree| {
        let mut mechanism = Mechanism::new(tree);
        mechanism.bind(couplings);
        for jointed in &mechanism.tree.joints {
            // where the joint was distinguishes a turn from the next
            if let (Some(joint), JointKind::Revolute) = (jointed.link.joint, jointed.link.kind) {
                mechanism.now.q[jointed.first[0]] = last(joint);
            }
        }
        // no time has passed in which what slips could have driven
        mechanism.measure(bodies, 0.0);
        mechanism
    });
    (mechanisms.collect(), forest.others)
}

impl Mechanism {
    fn new(tree: Tree) -> Self {
        let mut axes = vec![(0, None); tree.velocities];
        for member in &tree.members {
            let [position, velocity] = member.first;
            for k in 0..member.freedom.velocities() {
                axes[velocity + k].0 = position + k;
            }
        }
        for jointed in &tree.joints {
            if matches!(jointed.link.kind, JointKind::Prismatic | JointKind::Revolute | JointKind::Slot) {
                axes[jointed.first[1]].1 = jointed.link.joint;
            }
        }
        let now = Coordinates { q: vec![0.0; tree.positions], v: vec![0.0; tree.velocities] };
        let lumps = tree.lumped();
        let n = tree.velocities;
        let (force, inverse) = (DVector::zeros(n), DMatrix::zeros(n, n));
        let room = Room { column: force.clone(), stiff: inverse.clone(), force, inverse, ..Room::default() };
        Self {
            now,
            equations: Equations::new(&tree),
            moving: Equations::new(&lumps),
            lumps,
            tree,
            axes,
            bonds: Vec::new(),
            basis: Basis::default(),
            rows: Rows::default(),
            room,
        }
    }

    /// Its bodies.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = RigidBodyHandle> {
        self.tree.members.iter().filter(|member| !member.is_part).filter_map(|member| member.body)
    }

    /// The engine's joints between its bodies.
    pub(crate) fn links(&self) -> impl Iterator<Item = &Link> {
        let closures = self.tree.closures.iter().filter_map(|closure| closure.link.as_ref());
        self.tree.joints.iter().map(|jointed| &jointed.link).chain(closures)
    }

    /// The joints of the scene that close its loops.
    pub(crate) fn closing(&self) -> impl Iterator<Item = usize> {
        self.tree.closures.iter().filter_map(|closure| closure.link?.joint)
    }

    /// The joints of the scene whose coordinates it has, each with coordinate, from the scene's pose, and
    /// velocity.
    pub(crate) fn joints(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let each = self.axes.iter().zip(&self.now.v);
        each.filter_map(|((position, joint), v)| joint.map(|joint| (joint, self.now.q[*position], *v)))
    }

    /// What it remembers.
    pub(crate) fn memory(&self) -> Coordinates {
        self.now.clone()
    }

    /// Whether a memory is one of such a mechanism.
    pub(crate) fn fits(&self, memory: &Coordinates) -> bool {
        (memory.q.len(), memory.v.len()) == (self.now.q.len(), self.now.v.len())
    }

    /// Takes a memory in that [`fits`](Self::fits).
    pub(crate) fn restore(&mut self, memory: Coordinates) {
        self.now = memory;
    }

    /// Takes its coordinates from where its bodies are and how they move after a step of `dt_s`; true if couplings or
    /// loops have changed them.
    pub(crate) fn measure(&mut self, bodies: &RigidBodySet, dt_s: f64) -> bool {
        for jointed in &self.tree.joints {
            let (slid, turned, rotation) = tree::between(&jointed.link, bodies);
            let first = jointed.first[0];
            let q = &mut self.now.q;
            match jointed.link.kind {
                JointKind::Fixed => {}
                JointKind::Prismatic => q[first] = slid.x,
                JointKind::Revolute => q[first] = super::coordinate::nearest_turn(turned, q[first]),
                JointKind::Slot => {
                    q[first] = slid.y;
                    q[jointed.second] = super::coordinate::nearest_turn(turned, q[jointed.second]);
                }
                JointKind::Ball => {
                    let rotation = if jointed.reversed { rotation.inverse() } else { rotation };
                    q[first..first + 4].copy_from_slice(&rotation.to_array());
                }
            }
        }
        let Coordinates { q, v } = &mut self.now;
        let own = own_motion(&self.tree, self.equations.about, bodies);
        if self.equations.project(&self.tree, q, own, v) {
            let reconciled = self.reconcile(dt_s);
            return (self.has_loops() && self.close(Vector::ZERO, &[]) != Closed::Unsolved) || reconciled;
        }
        v.fill(0.0);
        false
    }

    /// Adds to its velocities what contacts changed in a step in which the engine moved each body by
    /// itself, under gravity and contacts alone: what their momenta have beyond gravity's, as the joints
    /// allow it. The mechanism's own step comes after it, in which drives and stops resist.
    pub(crate) fn take_blow(&mut self, dt_s: f64, gravity: Vector, bodies: &RigidBodySet) {
        let Self { tree, now, equations, .. } = self;
        let mut moved = vec![0.0; tree.velocities];
        let own = own_motion(tree, equations.about, bodies);
        if !equations.project(tree, &now.q, own, &mut moved) {
            return;
        }
        let rest = vec![0.0; tree.velocities];
        equations.evaluate(tree, &now.q, &rest, gravity);
        if equations.factor(tree) {
            // the bias at rest is what would hold it against gravity
            let mut held = equations.bias.clone();
            equations.factored.solve(&mut held);
            for ((v, moved), held) in now.v.iter_mut().zip(moved).zip(&held) {
                *v = moved + dt_s * held;
            }
            // what cannot be solved here cannot be in its own step either, which says so
            self.close(gravity, &[]);
        }
    }

    /// Puts its bodies where its coordinates say.
    pub(crate) fn put(&mut self, bodies: &mut RigidBodySet) {
        self.equations.place(&self.tree, &self.now.q);
        self.put_as_placed(bodies);
    }

    /// The same once all is placed by these coordinates.
    fn put_as_placed(&mut self, bodies: &mut RigidBodySet) {
        self.equations.moves(&self.tree, &self.now.v);
        for (index, member) in self.tree.members.iter().enumerate().filter(|(_, member)| !member.is_part) {
            let Some(body) = member.body.and_then(|handle| bodies.get_mut(handle)) else { continue };
            let (pose, motion) = (self.equations.poses[index], self.equations.motions[index]);
            let centre = pose * member.centre - self.equations.about;
            body.set_position(pose, false);
            body.set_linvel(motion.at(centre.into()).into(), false);
            body.set_angvel(motion.angular().into(), false);
        }
    }

    /// Moves it by a step that nothing touches it in; false, and unmoved, if its equations cannot be
    /// solved.
    #[must_use]
    pub(crate) fn advance(&mut self, dt_s: f64, around: &mut Surroundings<'_>) -> bool {
        (self.is_smooth(around) && self.step_freely(dt_s, around)) || self.step_driven(dt_s, around)
    }

    /// True if no drive, friction, brake or coupling acts on it.
    fn is_smooth(&self, around: &Surroundings<'_>) -> bool {
        let joints = self.axes.iter().filter_map(|(_, joint)| *joint);
        self.bonds.is_empty()
            && joints.clone().all(|joint| around.fittings[joint].is_smooth())
            && !around.actuators.iter().any(|actuator| joints.clone().any(|joint| joint == actuator.joint))
    }
}

/// How the engine has each member move, about a point.
fn own_motion<'b>(tree: &'b Tree, about: Vector, bodies: &'b RigidBodySet) -> impl Fn(usize) -> Twist + 'b {
    move |index| {
        let body = tree.members[index].body.map(|handle| &bodies[handle]);
        body.map_or_else(Twist::default, |body| {
            let angular = body.angvel();
            let lever = about - body.mass_properties().world_com;
            Twist::of(angular.into(), (body.linvel() + angular.cross(lever)).into())
        })
    }
}
