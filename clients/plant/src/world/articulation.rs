//! Mechanisms and the engine: who moves which bodies in a step.
//!
//! In every step the engine moves all bodies, with the joints and motors that it has for them. Then, of
//! each mechanism on which nothing pressed in that step, the engine's result is put aside and the mechanism's own,
//! exact to a high order, takes its place. Where it touches others, what all of these do to each other is solved again
//! (see [`super::contact`]). Only where joints of the engine's own or very many points take part, or that search does
//! not end, the engine's result stands; the mechanism takes its coordinates from there.
//!
//! A mechanism with nothing near has no joints in the engine, which then has little to do for it. They are
//! back in the step after a body has come near. Should the engine have to move one in its first step there, it has
//! the contacts of single bodies; what they changed in the bodies' momenta goes into the mechanism.
//!
//! Which of these applies follows from the contacts of the step alone, so that it is the same in
//! every run, and after a restore.

use rapier3d::prelude::*;

use super::actuator::{Acts, Actuator};
use super::contact::{Before, Island, Part};
use super::coordinate::Gauge;
use super::mechanism::{AtRest, Coordinates, Guided, Link, Mechanism, Surroundings, guided, mechanisms};
use super::turning::Turning;
use super::turns;
use super::{SWEEPS_WITH_JOINTS, World, local_frames, measured_axis};
use crate::coupled::Coupled;
use crate::effort::{Drives, Mark, Motion};
use crate::fitting::Fitting;
use crate::layout_mismatch::LayoutMismatch;
use crate::model::JointKind;
use crate::model::Mechanics;

/// Mechanisms, fittings of joints, and how joints were measured last.
pub(crate) struct Articulation {
    mechanisms: Vec<Member>,
    /// Joints that are in no mechanism, which the engine moves always.
    others: Vec<usize>,
    /// Joints that close loops of mechanisms, which are measured from their bodies.
    closing: Vec<usize>,
    pub(crate) fittings: Vec<Fitting>,
    gauges: Vec<Gauge>,
    /// All joints of the scene, with their coordinates.
    motions: Vec<Mark>,
    links: Vec<Link>,
    couplings: Vec<Coupled>,
    /// Robots without dynamics, whose joints are not among those of mechanisms and of the engine.
    guided: Vec<Guided>,
    /// Whether each of the scene's joints is of one of these.
    is_guided: Vec<bool>,
    /// All bodies as the step began, if a mechanism can touch any.
    before: Before,
}

/// How a mechanism goes through a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// By its own equations: nothing presses on it.
    Alone,
    /// It has gone, with what it touches.
    Together,
    /// As the engine moves it.
    Engine,
}

/// A mechanism and the shapes of its bodies that collide.
struct Member {
    mechanism: Mechanism,
    colliders: Vec<ColliderHandle>,
    /// The actuators of its joints.
    actuators: Vec<usize>,
    /// All of the engine's joints between its bodies.
    handles: Vec<ImpulseJointHandle>,
    /// Whether the engine has these joints now; not known of a mechanism that was found again.
    attached: Option<bool>,
}

impl Articulation {
    pub(crate) fn empty() -> Self {
        Self {
            mechanisms: Vec::new(),
            others: Vec::new(),
            closing: Vec::new(),
            fittings: Vec::new(),
            gauges: Vec::new(),
            motions: Vec::new(),
            links: Vec::new(),
            couplings: Vec::new(),
            guided: Vec::new(),
            is_guided: Vec::new(),
            before: Before::default(),
        }
    }

    /// The mechanisms of a world that still stands in the scene's pose.
    pub(crate) fn build(scene: &Mechanics, world: &mut World) -> Self {
        let bodies: Vec<_> = world.physics.bodies.iter().map(|(handle, _)| handle).collect();
        for handle in bodies {
            // the masses of shapes, which the engine else gathers in its first step
            world.physics.bodies[handle].recompute_mass_properties_from_colliders(&world.physics.colliders);
        }
        let links = scene.joints.iter().enumerate().map(|(index, joint)| {
            let bodies = [world.handle(joint.parent), world.handle(Some(joint.child))];
            let frames = local_frames(&world.physics, joint, bodies[0], bodies[1]);
            Link { joint: Some(index), handle: world.joint(index), kind: joint.kind, bodies, frames }
        });
        let links: Vec<_> = links.collect();
        let is_guided: Vec<_> = scene.joints.iter().map(|joint| joint.guided).collect();
        let ours: Vec<_> = links.iter().zip(&is_guided).filter(|(_, guided)| **guided).map(|(link, _)| *link).collect();
        let follows: Vec<_> = scene.joints.iter().map(|joint| joint.follows).collect();
        for link in &ours {
            if let Some(joint) = world.physics.impulse_joints.get_mut(link.handle, false) {
                joint.data.set_enabled(false);
            }
        }
        Self {
            guided: guided(&ours, &follows, &world.physics.bodies),
            is_guided,
            links,
            couplings: Coupled::all(scene),
            fittings: (0..scene.joints.len()).map(|joint| Fitting::new(scene, joint)).collect(),
            gauges: scene.joints.iter().map(|joint| Gauge::new(world, joint)).collect(),
            motions: scene.joints.iter().map(|joint| Mark { position: joint.initial, velocity: 0.0 }).collect(),
            ..Self::empty()
        }
    }

    /// The engine's axis of a joint's coordinate.
    pub(crate) fn along(&self, joint: usize) -> JointAxis {
        measured_axis(self.links[joint].kind)
    }

    /// The joints of all mechanisms, with the inverse of what each moves.
    pub(crate) fn apparent(&mut self, gravity: Vector, held: &dyn Fn(usize) -> bool) -> Vec<(usize, f64)> {
        let each = self.mechanisms.iter_mut().filter_map(|member| member.mechanism.apparent(gravity, held));
        each.flatten().collect()
    }

    /// The equations of all mechanisms at rest.
    pub(crate) fn at_rest(&mut self, gravity: Vector) -> Vec<AtRest> {
        self.mechanisms.iter_mut().map(|member| member.mechanism.at_rest(gravity)).collect()
    }

    /// Whether a joint is in no mechanism, so that the engine moves it.
    pub(crate) fn leaves(&self, joint: usize) -> bool {
        self.others.contains(&joint)
    }

    /// The joints that are in no mechanism, with their kinds, their bodies and where they are.
    pub(crate) fn unmoved<'a>(
        &'a self,
        bodies: &'a RigidBodySet,
    ) -> impl Iterator<Item = (usize, JointKind, [RigidBodyHandle; 2], Pose)> + 'a {
        self.others.iter().map(|joint| {
            let link = &self.links[*joint];
            (*joint, link.kind, link.bodies, *bodies[link.bodies[0]].position() * link.frames[0])
        })
    }

    /// Finds the mechanisms again: a body is held or let go, taken out or put in.
    fn find(
        &mut self,
        holds: &[Link],
        extra: &[(usize, ImpulseJointHandle)],
        physics: &PhysicsWorld,
        actuators: &[Actuator],
    ) {
        let moved = self.links.iter().zip(&self.is_guided).filter(|(_, guided)| !**guided).map(|(link, _)| link);
        let links: Vec<_> = moved.chain(holds).copied().collect();
        let last = |joint: usize| self.motions[joint].position - self.fittings[joint].initial;
        let plain = |joint: usize| {
            let coupled = self.couplings.iter().any(|coupled| coupled.joins(joint));
            let driven = actuators.iter().any(|actuator| actuator.joint == joint);
            self.fittings[joint].is_plain() && !coupled && !driven
        };
        let (found, others) = mechanisms(&links, &self.couplings, &physics.bodies, plain, last);
        self.others = others;
        self.closing = found.iter().flat_map(Mechanism::closing).collect();
        self.mechanisms = found
            .into_iter()
            .map(|mechanism| {
                let shapes = mechanism.bodies().flat_map(|body| physics.bodies[body].colliders().to_vec());
                let collides =
                    |shape: &ColliderHandle| physics.colliders[*shape].collision_groups().memberships != Group::NONE;
                let colliders = shapes.filter(collides).collect();
                let own = |actuator: &Actuator| mechanism.joints().any(|(joint, ..)| joint == actuator.joint);
                let actuators = (0..actuators.len()).filter(|index| own(&actuators[*index])).collect();
                let mut handles = Vec::new();
                for link in mechanism.links() {
                    handles.push(link.handle);
                    let beside = extra.iter().filter(|(joint, _)| Some(*joint) == link.joint);
                    handles.extend(beside.map(|(_, handle)| *handle));
                }
                Member { mechanism, colliders, actuators, handles, attached: None }
            })
            .collect();
    }
}

impl Member {
    /// True if a shape of it has a pair that `counts`.
    fn meets(&self, narrow: &NarrowPhase, counts: impl Fn(&ContactPair) -> bool) -> bool {
        self.colliders.iter().any(|collider| narrow.contact_pairs_with(*collider).any(&counts))
    }
}

impl Part for Member {
    fn colliders(&self) -> &[ColliderHandle] {
        &self.colliders
    }

    fn mechanism(&mut self) -> &mut Mechanism {
        &mut self.mechanism
    }

    fn seen(&self) -> &Mechanism {
        &self.mechanism
    }
}

impl World {
    /// Finds the mechanisms of the joints that there are now.
    pub(crate) fn find_mechanisms(&mut self) {
        let Self { physics, actuators, articulation, joints, frictions, springs, .. } = self;
        let beside = |handle: ImpulseJointHandle| {
            springs.iter().any(|(_, spring)| *spring == handle)
                || frictions.iter().any(|(_, friction)| friction.handle == handle)
        };
        let known = |handle: ImpulseJointHandle| joints.contains(&handle) || beside(handle);
        let holds = physics.impulse_joints.iter().filter(|(handle, _)| !known(*handle));
        let holds = holds.map(|(handle, joint)| Link {
            joint: None,
            handle,
            kind: JointKind::Fixed,
            bodies: [joint.body1(), joint.body2()],
            frames: [joint.data.local_frame1, joint.data.local_frame2],
        });
        let holds: Vec<_> = holds.collect();
        let extra: Vec<_> = frictions
            .iter()
            .map(|(joint, friction)| (*joint, friction.handle))
            .chain(springs.iter().copied())
            .collect();
        articulation.find(&holds, &extra, physics, actuators);
        // what the engine is to move it has whole, unless a body of it is out of the world
        for joint in &articulation.others {
            let extra = extra.iter().filter(|(known, _)| known == joint).map(|(_, handle)| *handle);
            for handle in extra.chain([joints[*joint]]) {
                attach(&mut physics.impulse_joints, &physics.bodies, handle, true);
            }
        }
    }

    /// The first coupling of the scene whose joints are in no mechanism, which alone keeps couplings; its
    /// index.
    pub(crate) fn uncoupled(&self, scene: &Mechanics) -> Option<usize> {
        scene.couplings.iter().position(|coupling| !self.keeps(coupling.joint))
    }

    /// Whether a mechanism keeps the joint to a coupling.
    pub(crate) fn keeps(&self, joint: usize) -> bool {
        let mut mechanisms = self.articulation.mechanisms.iter();
        mechanisms.any(|member| member.mechanism.coupled().any(|own| own == joint))
    }

    /// Whether the shapes of a pair collide at all.
    pub(crate) fn may_touch(&self, pair: &ContactPair) -> bool {
        may_touch(pair, &self.physics)
    }

    /// The coordinate and velocity of a joint.
    pub(crate) fn motion(&self, joint: usize) -> Mark {
        self.articulation.motions[joint]
    }

    /// Gives a joint stops, beside those that it has.
    pub(crate) fn restrict(&mut self, joint: usize, [lower, upper]: [f64; 2]) {
        let fitting = &mut self.articulation.fittings[joint];
        fitting.lower = fitting.lower.max(lower - fitting.initial).min(0.0);
        fitting.upper = fitting.upper.min(upper - fitting.initial).max(0.0);
        let limits = [fitting.lower.max(-Real::MAX), fitting.upper.min(Real::MAX)];
        let handle = self.joint(joint);
        let along = self.articulation.along(joint);
        if let Some(joint) = self.physics.impulse_joints.get_mut(handle, false) {
            joint.data.set_limits(along, limits);
        }
    }

    /// One step of the engine and of all mechanisms, which is this part of the turn.
    pub(crate) fn substep(&mut self, part: [f64; 2], drives: &mut dyn Drives) {
        let dt_s = self.physics.integration_parameters.dt;
        let Articulation { links, fittings, motions, .. } = &self.articulation;
        turns::limit(links, fittings, motions, &mut self.physics.impulse_joints);
        self.arm(part, dt_s, drives);
        self.guide(part[1], dt_s);
        if self.articulation.mechanisms.iter().any(|member| !member.colliders.is_empty()) {
            self.articulation.before.note(&self.physics.bodies);
        }
        self.physics.step_with_events(&Turning { dt_s }, &());
        let ways = self.meet(part, drives);
        self.put_guided();
        let Self { physics, actuators, articulation, .. } = self;
        let Articulation { mechanisms, fittings, motions, .. } = articulation;
        let (gravity, iterations) = (physics.gravity, physics.integration_parameters.num_solver_iterations);
        for (member, way) in mechanisms.iter_mut().zip(ways) {
            // without its joints the engine let its bodies go their own ways for this step
            let loose = way == Way::Engine && member.attached == Some(false);
            if loose {
                member.mechanism.take_blow(dt_s, gravity, &physics.bodies);
            }
            let mut around = Surroundings { gravity, fittings, actuators, drives, part };
            let alone = (way == Way::Alone || loose) && member.mechanism.advance(dt_s, &mut around);
            let measured = !alone && way != Way::Together;
            let reconciled = measured && member.mechanism.measure(&physics.bodies, dt_s);
            for (joint, position, velocity) in member.mechanism.joints() {
                let now = Mark { position: fittings[joint].initial + position, velocity };
                let before = std::mem::replace(&mut motions[joint], now);
                let own = member.actuators.iter().copied().find(|index| actuators[*index].joint == joint);
                if let Some(index) = own.filter(|_| !alone) {
                    if measured {
                        actuators[index].read(&physics.impulse_joints, dt_s, iterations);
                    }
                    follow(&actuators[index], [before, now], drives, dt_s);
                }
            }
            // what the engine moved without joints must not come apart
            if !measured || reconciled || member.attached == Some(false) {
                member.mechanism.put(&mut physics.bodies);
            }
        }
        self.measure_others(drives);
    }

    /// Puts the bodies of robots without dynamics where their joints are.
    fn put_guided(&mut self) {
        let Self { physics, articulation, .. } = self;
        let Articulation { fittings, motions, guided, .. } = articulation;
        for robot in guided {
            robot.put(&mut physics.bodies);
            for (joint, position, velocity) in robot.joints() {
                motions[joint] = Mark { position: fittings[joint].initial + position, velocity };
            }
        }
    }

    /// Measures the joints that are in no mechanism or close a loop of one; their drives follow.
    fn measure_others(&mut self, drives: &mut dyn Drives) {
        let Self { physics, actuators, articulation, .. } = self;
        let Articulation { others, closing, gauges, motions, .. } = articulation;
        let parameters = &physics.integration_parameters;
        for joint in others.iter().chain(&*closing).copied() {
            let (bodies, gauge) = (&physics.bodies, &gauges[joint]);
            let now =
                Mark { position: gauge.position(bodies, motions[joint].position), velocity: gauge.velocity(bodies) };
            let before = std::mem::replace(&mut motions[joint], now);
            if let Some(actuator) = actuators.iter_mut().find(|actuator| actuator.joint == joint) {
                actuator.read(&physics.impulse_joints, parameters.dt, parameters.num_solver_iterations);
                follow(actuator, [before, now], drives, parameters.dt);
            }
        }
    }

    /// Moves mechanisms that touch others, and these, through the step that the engine has gone through; how each
    /// mechanism goes.
    fn meet(&mut self, part: [f64; 2], drives: &mut dyn Drives) -> Vec<Way> {
        let Self { physics, actuators, articulation, .. } = self;
        let Articulation { mechanisms, fittings, before, .. } = articulation;
        let (dt_s, gravity) = (physics.integration_parameters.dt, physics.gravity);
        let mut ways = vec![None; mechanisms.len()];
        for index in 0..mechanisms.len() {
            if ways[index].is_some() {
                continue;
            }
            if !mechanisms[index].meets(&physics.narrow_phase, ContactPair::has_any_active_contact) {
                ways[index] = Some(Way::Alone);
                continue;
            }
            let Some(island) = Island::around(index, mechanisms, physics) else {
                ways[index] = Some(Way::Engine);
                continue;
            };
            let mut around = Surroundings { gravity, fittings, actuators, drives, part };
            let pressed = island.step(dt_s, mechanisms, physics, before, &mut around);
            for member in &island.members {
                let goes = |pressed: &Vec<usize>| if pressed.contains(member) { Way::Together } else { Way::Alone };
                ways[*member] = Some(pressed.as_ref().map_or(Way::Engine, goes));
            }
        }
        ways.into_iter().map(|way| way.unwrap_or(Way::Alone)).collect()
    }

    /// Sends robots without dynamics on their way.
    fn guide(&mut self, part: f64, dt_s: f64) {
        let Self { physics, actuators, articulation, .. } = self;
        let Articulation { guided, fittings, .. } = articulation;
        for robot in guided {
            robot.lead((part, dt_s), actuators, fittings, &mut physics.bodies);
        }
    }

    /// Makes all actuators motors of the engine.
    fn arm(&mut self, part: [f64; 2], dt_s: f64, drives: &dyn Drives) {
        let Self { physics, actuators, articulation, frictions, .. } = self;
        let is_guided = &articulation.is_guided;
        let mut moves: Vec<_> = actuators.iter().map(|actuator| !is_guided[actuator.joint]).collect();
        for member in &mut articulation.mechanisms {
            let near = member.meets(&physics.narrow_phase, |pair| may_touch(pair, physics));
            if member.attached != Some(near) {
                member.attached = Some(near);
                for handle in &member.handles {
                    attach(&mut physics.impulse_joints, &physics.bodies, *handle, near);
                }
            }
            for index in member.actuators.iter().filter(|_| !near) {
                moves[*index] = false;
            }
        }
        let jointed = physics.impulse_joints.iter().any(|(_, joint)| joint.data.is_enabled());
        physics.integration_parameters.num_internal_pgs_iterations = if jointed { SWEEPS_WITH_JOINTS } else { 1 };
        let detached =
            |joint: usize| actuators.iter().zip(&moves).any(|(actuator, moves)| actuator.joint == joint && !moves);
        for (joint, friction) in frictions.iter().filter(|(joint, _)| !detached(*joint)) {
            let dry = articulation.fittings[*joint].dry(articulation.motions[*joint].velocity);
            friction.brake(dry, &mut physics.impulse_joints);
        }
        for (actuator, _) in actuators.iter().zip(&moves).filter(|(_, moves)| **moves) {
            let Mark { position, velocity } = articulation.motions[actuator.joint];
            let motion = Motion { position, velocity, mass: f64::INFINITY, exerted: actuator.exerted };
            let own = frictions.iter().find(|(joint, _)| *joint == actuator.joint).map(|(_, friction)| *friction);
            let fitted = articulation.fittings[actuator.joint].dry(velocity);
            let dry = actuator.arm(motion, part, dt_s, drives, &mut physics.impulse_joints);
            if let Some(friction) = own {
                friction.brake(dry + fitted, &mut physics.impulse_joints);
            }
        }
    }

    /// What the mechanisms remember.
    pub(crate) fn coordinates(&self) -> ArticulationMemory {
        ArticulationMemory {
            motions: self.articulation.motions.clone(),
            mechanisms: self.articulation.mechanisms.iter().map(|member| member.mechanism.memory()).collect(),
            exerted: self.actuators.iter().map(|actuator| actuator.exerted).collect(),
        }
    }

    /// Takes in what mechanisms remembered, in a world whose engine's state is restored.
    ///
    /// # Errors
    /// A memory of other mechanisms.
    pub(crate) fn restore_coordinates(&mut self, memory: ArticulationMemory) -> Result<(), LayoutMismatch> {
        let counts = (memory.motions.len(), memory.exerted.len());
        if counts != (self.articulation.motions.len(), self.actuators.len()) {
            return Err(LayoutMismatch("it has other joints and drives".to_owned()));
        }
        self.articulation.motions = memory.motions;
        let Articulation { guided, motions, fittings, .. } = &mut self.articulation;
        for robot in guided {
            robot.restore(motions, fittings);
        }
        self.find_mechanisms();
        let members = &mut self.articulation.mechanisms;
        if members.len() != memory.mechanisms.len()
            || !members.iter().zip(&memory.mechanisms).all(|(member, memory)| member.mechanism.fits(memory))
        {
            return Err(LayoutMismatch("its mechanisms are others".to_owned()));
        }
        for (member, memory) in members.iter_mut().zip(memory.mechanisms) {
            member.mechanism.restore(memory);
        }
        for (actuator, exerted) in self.actuators.iter_mut().zip(memory.exerted) {
            actuator.exerted = exerted;
        }
        Ok(())
    }
}

/// Whether the shapes of a pair collide at all: not if a joint between their bodies keeps them apart.
fn may_touch(pair: &ContactPair, physics: &PhysicsWorld) -> bool {
    let body = |shape: ColliderHandle| physics.colliders.get(shape).and_then(Collider::parent);
    let (Some(one), Some(other)) = (body(pair.collider1), body(pair.collider2)) else { return true };
    let mut between = physics.impulse_joints.joints_between(one, other);
    between.all(|(_, joint)| joint.data.contacts_enabled())
}

/// Gives the engine a joint, or takes it away; one of a body that is out of the world is not there.
fn attach(joints: &mut ImpulseJointSet, bodies: &RigidBodySet, handle: ImpulseJointHandle, attached: bool) {
    let Some(joint) = joints.get(handle) else { return };
    let whole =
        [joint.body1(), joint.body2()].into_iter().all(|body| bodies.get(body).is_some_and(RigidBody::is_enabled));
    if whole
        && joint.data.is_enabled() != attached
        && let Some(joint) = joints.get_mut(handle, false)
    {
        joint.data.set_enabled(attached);
    }
}

/// What mechanisms and actuators remember between two turns.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct ArticulationMemory {
    motions: Vec<Mark>,
    mechanisms: Vec<Coordinates>,
    exerted: Vec<f64>,
}

/// Moves the state of an actuator's drive through a step in which its joint went this way.
fn follow(actuator: &Actuator, [from, to]: [Mark; 2], drives: &mut dyn Drives, dt_s: f64) {
    if let Acts::Law { drive } = actuator.acts {
        let velocity = (to.position - from.position) / dt_s;
        let motion = Motion { position: from.position, velocity, mass: f64::INFINITY, exerted: actuator.exerted };
        advance(drives, drive, motion, dt_s);
    }
}

/// Moves a drive's state by a step of constant velocity, in sub-steps as short as it wants them.
fn advance(drives: &mut dyn Drives, drive: usize, motion: Motion, dt_s: f64) {
    let (count, part_s) = crate::effort::substeps(dt_s, drives.longest_s(drive));
    for index in 0..count {
        let position = motion.position + motion.velocity * part_s * f64::from(index);
        drives.advance(drive, Motion { position, ..motion }, part_s);
    }
}
