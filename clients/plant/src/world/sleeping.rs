//! Bodies that rest on a floor or ride on a belt, in a scene with `sleeping`: they cost next to nothing until something
//! changes.
//!
//! A body that has been at rest on its carrier for some steps becomes one of the engine's kinematic bodies: these go
//! straight on, and the solver has nothing to do for them. It is dynamic again in the step in which its carrier runs
//! otherwise, in which it would leave the carrier's face, and before anything else that moves or stands can meet it.
//!
//! All that is remembered is in the engine's bodies: their kind, and the note that each may bear, below its tag. So it is
//! in every saved state, and a session that is restored goes on to the bit.

use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::prelude::*;

use super::World;
use super::nearby::{Nearby, own_box};
use super::tag;

/// For so many steps on end a body must have been at rest.
const STEADY_STEPS: u32 = 3;
/// A body that moves no faster over its carrier, and of which no point is faster as it turns, is at rest.
const REST_M_S: f64 = 3e-4;
/// So near nothing else may be, beside what two bodies go in a step.
const CLEAR_M: f64 = 5e-3;
/// A body lies on a face of its carrier if the normal of their contact is so much along the face's own.
const ALIGNED: f64 = 0.999;

/// A body that may sleep: it has one shape, and hangs on no joint of the scene.
#[derive(Debug)]
pub(super) struct Sleeper {
    handle: RigidBodyHandle,
    collider: ColliderHandle,
    /// Its box as it sees it.
    local: Aabb,
}

/// On what a body is at rest, and for how many steps it has been, at least one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rest {
    carrier: RigidBodyHandle,
    steps: u32,
}

impl Rest {
    fn of(body: &RigidBody) -> Option<Self> {
        let [steps, generation, index] = [0, 32, 64].map(|bits| (body.user_data >> bits) as u32);
        (steps > 0).then(|| Self { carrier: RigidBodyHandle::from_raw_parts(index, generation), steps })
    }

    /// Gives a body its note, and leaves it its tag.
    fn bear(rest: Option<Self>, body: &mut RigidBody) {
        body.user_data = body.user_data & tag::BITS | Self::note(rest);
    }

    fn note(rest: Option<Self>) -> u128 {
        let Some(Self { carrier, steps }) = rest else { return 0 };
        let (index, generation) = carrier.into_raw_parts();
        u128::from(index) << 64 | u128::from(generation) << 32 | u128::from(steps)
    }
}

/// The upper face of a box.
struct Face {
    pose: Pose,
    half_m: [f64; 3],
    /// The axis of the box that is across the face.
    across: usize,
    /// Into the box.
    down: Vector,
}

impl Face {
    /// True if a box, as its body at a pose sees it, is over the face with all of its own.
    fn is_below(&self, local: &Aabb, pose: &Pose) -> bool {
        let seen = local.transform_by(&self.pose.inv_mul(pose));
        let (mins, maxs) = (seen.mins.to_array(), seen.maxs.to_array());
        let within = |axis: usize| mins[axis] > -self.half_m[axis] && maxs[axis] < self.half_m[axis];
        (0..3).all(|axis| axis == self.across || within(axis))
    }
}

/// Bodies that may sleep are dynamic by their scene, so one of the engine's kinematic ones sleeps.
fn sleeps(body: &RigidBody) -> bool {
    body.is_kinematic()
}

impl World {
    /// From now on somebody counts the contacts of these bodies with what may carry them, so that they never sleep.
    pub(crate) fn watch(&mut self, bodies: &[RigidBodyHandle]) {
        self.watched.extend_from_slice(bodies);
    }

    /// Lets bodies of the scene sleep, once all that is tied to the world is known.
    pub(crate) fn let_sleep(&mut self) {
        let may = |handle: &RigidBodyHandle| {
            let body = self.body(*handle);
            body.is_dynamic() && body.colliders().len() == 1 && !self.hangs(*handle) && !self.watched.contains(handle)
        };
        let candidates: Vec<_> = self.bodies.iter().copied().filter(may).collect();
        self.sleepers = candidates.into_iter().filter_map(|handle| self.sleeper(handle)).collect();
        if !self.sleepers.is_empty() {
            let moves = self.physics.bodies.iter().filter(|(_, body)| !body.is_fixed());
            self.movers = moves.map(|(handle, _)| handle).collect();
            self.nearby.get_or_insert_with(|| Nearby::of(&self.physics));
        }
    }

    fn sleeper(&self, handle: RigidBodyHandle) -> Option<Sleeper> {
        let body = self.body(handle);
        let collider = *body.colliders().first()?;
        self.physics.colliders.get(collider).filter(|shape| shape.is_enabled())?;
        Some(Sleeper { handle, collider, local: own_box(body, &self.physics.colliders)? })
    }

    /// Wakes those that something could meet in the step that begins, or that could fall.
    pub(super) fn rouse(&mut self) {
        if !self.sleepers.iter().any(|sleeper| sleeps(self.body(sleeper.handle))) {
            return;
        }
        self.look_around();
        let fastest_m_s = self.fastest_m_s();
        for index in 0..self.sleepers.len() {
            let sleeper = &self.sleepers[index];
            let body = self.body(sleeper.handle);
            let stays = || Rest::of(body).is_some_and(|rest| self.stays(sleeper, rest, fastest_m_s));
            if sleeps(body) && !stays() {
                self.awaken(sleeper.handle);
            }
        }
    }

    /// A body that sleeps is dynamic again.
    pub(super) fn awaken(&mut self, handle: RigidBodyHandle) {
        // Only bodies that may sleep ever bear a note.
        if let Some(body) = self.physics.bodies.get_mut(handle).filter(|body| Rest::of(body).is_some()) {
            Rest::bear(None, body);
            body.set_body_type(RigidBodyType::Dynamic, true);
        }
    }

    /// Counts the steps for which bodies have been at rest, and lets those sleep that have been for long enough.
    pub(super) fn settle(&mut self) {
        // Asked for once somebody is about to fall asleep.
        let mut fastest_m_s = None;
        for index in 0..self.sleepers.len() {
            let body = self.body(self.sleepers[index].handle);
            if sleeps(body) {
                continue;
            }
            let before = Rest::of(body);
            let rest = self.carrier(&self.sleepers[index]).map(|carrier| {
                let steps = before.filter(|before| before.carrier == carrier).map_or(0, |before| before.steps);
                Rest { carrier, steps: (steps + 1).min(STEADY_STEPS) }
            });
            if before.is_none() && rest.is_none() {
                continue;
            }
            let is_steady = rest.filter(|rest| rest.steps == STEADY_STEPS);
            if is_steady.is_some() && fastest_m_s.is_none() {
                self.look_around();
                fastest_m_s = Some(self.fastest_m_s());
            }
            let sleeper = &self.sleepers[index];
            let ends =
                is_steady.zip(fastest_m_s).filter(|(rest, fastest_m_s)| self.is_clear(sleeper, *rest, *fastest_m_s));
            let velocity = ends.map(|(rest, _)| self.body(rest.carrier).linvel());
            let Some(body) = self.physics.bodies.get_mut(self.sleepers[index].handle) else { continue };
            Rest::bear(rest, body);
            if let Some(velocity) = velocity {
                body.set_body_type(RigidBodyType::KinematicVelocityBased, true);
                body.set_linvel(velocity, true);
                body.set_angvel(AngVector::ZERO, true);
            }
        }
    }

    /// What a body is at rest on, if it touches nothing else.
    fn carrier(&self, sleeper: &Sleeper) -> Option<RigidBodyHandle> {
        let body = self.body(sleeper.handle);
        let turns_m_s = body.angvel().length() * self.reach.radius_m(sleeper.handle);
        if !body.is_enabled() || turns_m_s > REST_M_S || self.hangs(sleeper.handle) {
            return None;
        }
        let pairs = self.physics.narrow_phase.contact_pairs_with(sleeper.collider);
        let mut touching = pairs.filter(|pair| pair.has_any_active_contact());
        let (pair, None) = (touching.next()?, touching.next()) else { return None };
        let first = pair.collider1 == sleeper.collider;
        let other = self.physics.colliders.get(if first { pair.collider2 } else { pair.collider1 })?.parent()?;
        let carrier = self.body(other);
        let carries = carrier.is_fixed() || self.belts.iter().any(|(belt, _)| *belt == other);
        let slips_m_s = (body.linvel() - carrier.linvel()).length();
        if !carries || slips_m_s > REST_M_S {
            return None;
        }
        let normal = pair.manifolds().iter().find(|manifold| !manifold.points.is_empty())?.data.normal;
        let down = if first { normal } else { -normal };
        let face = self.face(carrier)?;
        let lies = down.dot(face.down) > ALIGNED && face.is_below(&sleeper.local, body.position());
        lies.then_some(other)
    }

    /// The face of a carrier that looks against gravity, of a box alone.
    fn face(&self, carrier: &RigidBody) -> Option<Face> {
        let [collider] = carrier.colliders() else { return None };
        let collider = self.physics.colliders.get(*collider)?;
        let half_m = collider.shape().as_cuboid()?.half_extents.to_array();
        let pose = *collider.position();
        let gravity = (pose.rotation.inverse() * self.gravity()).to_array();
        let across = (0..3).max_by(|one, other| gravity[*one].abs().total_cmp(&gravity[*other].abs()))?;
        let mut down = [0.0; 3];
        down[across] = gravity[across].signum();
        Some(Face { pose, half_m, across, down: pose.rotation * Vector::from_array(down) })
    }

    /// True if a body that sleeps can go on so for a step.
    fn stays(&self, sleeper: &Sleeper, rest: Rest, fastest_m_s: f64) -> bool {
        let body = self.body(sleeper.handle);
        let Some(carrier) = self.physics.bodies.get(rest.carrier).filter(|carrier| carrier.is_enabled()) else {
            return false;
        };
        let (velocity, dt_s) = (body.linvel(), self.physics.integration_parameters.dt);
        let mut then = *body.position();
        then.translation += velocity * dt_s;
        carrier.linvel() == velocity
            && carrier.angvel() == AngVector::ZERO
            && self.face(carrier).is_some_and(|face| face.is_below(&sleeper.local, &then))
            && self.is_clear(sleeper, rest, fastest_m_s)
    }

    /// True if nothing but its carrier, and what rests on that as it does itself, can meet a body in a step.
    fn is_clear(&self, sleeper: &Sleeper, rest: Rest, fastest_m_s: f64) -> bool {
        let (Some(nearby), Some(own)) = (&self.nearby, self.physics.colliders.get(sleeper.collider)) else {
            return false;
        };
        let body = self.body(sleeper.handle);
        let way_m = (fastest_m_s + body.linvel().length()) * self.physics.integration_parameters.dt;
        let around = sleeper.local.transform_by(body.position()).loosened(CLEAR_M + way_m);
        nearby.bodies_in(&around).all(|other| {
            let met = self.body(other);
            let rests_alike = Rest::of(met).is_some_and(|other| other.carrier == rest.carrier);
            let mut shapes = met.colliders().iter().filter_map(|shape| self.physics.colliders.get(*shape));
            let collides =
                |shape: &Collider| shape.is_enabled() && own.collision_groups().test(shape.collision_groups());
            other == sleeper.handle
                || other == rest.carrier
                || rests_alike
                || !met.is_enabled()
                || !shapes.any(collides)
        })
    }

    /// The greatest speed of a point of what moves and does not sleep, m/s.
    fn fastest_m_s(&self) -> f64 {
        let stays = |handle: RigidBodyHandle, body: &RigidBody| {
            let is_belt = || self.belts.iter().any(|(belt, _)| *belt == handle);
            sleeps(body) && (Rest::of(body).is_some() || is_belt())
        };
        let movers = self.movers.iter().map(|handle| (*handle, self.body(*handle)));
        let awake = movers.filter(|(handle, body)| body.is_enabled() && !stays(*handle, body));
        let speed = |(handle, body): (RigidBodyHandle, &RigidBody)| {
            let turning_m_s = body.angvel().length() * self.reach.radius_m(handle);
            body.linvel().length() + if turning_m_s.is_finite() { turning_m_s } else { 0.0 }
        };
        awake.map(speed).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::time::TimeSpan;

    use super::*;
    use crate::effort::Nobody;
    use crate::scene::Scene;

    const SCENE: &str = r#"
        version = 1
        sleeping = true
        [[body]]
        name = "belt"
        kind = "kinematic"
        shape = "box"
        size_m = [4.0, 0.5, 0.1]
        position_m = [0.0, 0.0, -0.05]
        [[body]]
        name = "box"
        kind = "dynamic"
        shape = "box"
        size_m = [0.2, 0.2, 0.2]
        position_m = [0.0, 0.0, 0.1]
        mass_kg = 1.0
        [[body]]
        name = "hand"
        kind = "fixed"
        shape = "box"
        size_m = [0.1, 0.1, 0.1]
        position_m = [0.0, 0.0, 0.5]
    "#;

    fn world() -> (Scene, World) {
        let scene = Scene::parse(SCENE, "belt.toml").unwrap_or_else(|error| panic!("{error}"));
        let mut world = World::build(&scene, TimeSpan::from_millis(10).expect("not zero"));
        world.keep_in_place(world.handle(Some(0)));
        world.find_mechanisms();
        (scene, world)
    }

    fn steps(world: &mut World, scene: &Scene, count: u32) {
        for _ in 0..count {
            world.step(scene, &mut Nobody).expect("a step");
        }
    }

    fn is_asleep(world: &World) -> bool {
        sleeps(world.body(world.handle(Some(1))))
    }

    #[test]
    fn it_sleeps_on_a_belt_that_runs_evenly_and_wakes_when_that_runs_otherwise() {
        let (scene, mut world) = world();
        world.let_sleep();
        let belt = world.handle(Some(0));
        world.run(belt, Vector::X * 0.2).expect("a belt");
        steps(&mut world, &scene, 60);
        assert!(is_asleep(&world));
        let before_m = world.body(world.handle(Some(1))).translation().x;
        steps(&mut world, &scene, 10);
        let after_m = world.body(world.handle(Some(1))).translation().x;
        assert!((after_m - before_m - 0.02).abs() < 1e-12, "{before_m} {after_m}");
        world.run(belt, Vector::X * 0.1).expect("a belt");
        steps(&mut world, &scene, 1);
        assert!(!is_asleep(&world));
    }

    #[test]
    fn what_is_held_or_taken_out_is_awake() {
        let (scene, mut world) = world();
        world.let_sleep();
        steps(&mut world, &scene, 30);
        assert!(is_asleep(&world));
        let (hand, held) = (world.handle(Some(2)), world.handle(Some(1)));
        let joint = world.hold(hand, held);
        assert!(!is_asleep(&world));
        steps(&mut world, &scene, 30);
        assert!(!is_asleep(&world), "what is held never sleeps");
        world.let_go(joint).expect("it holds");
        steps(&mut world, &scene, 30);
        assert!(is_asleep(&world));
        world.take_out(held).expect("it is there");
        assert!(!is_asleep(&world));
    }

    #[test]
    fn what_somebody_counts_the_contacts_of_does_not_sleep() {
        let (scene, mut world) = world();
        world.watch(&[world.handle(Some(1))]);
        world.let_sleep();
        steps(&mut world, &scene, 60);
        assert!(!is_asleep(&world));
    }

    #[test]
    fn a_note_of_a_carrier_that_there_is_not_wakes_a_body() {
        let (scene, mut world) = world();
        world.let_sleep();
        steps(&mut world, &scene, 30);
        let held = world.handle(Some(1));
        let nowhere = Rest { carrier: RigidBodyHandle::from_raw_parts(99, 7), steps: STEADY_STEPS };
        world.physics.bodies[held].user_data = Rest::note(Some(nowhere));
        assert_eq!(Rest::of(world.body(held)), Some(nowhere));
        steps(&mut world, &scene, 1);
        assert!(!is_asleep(&world));
    }
}
