//! The scene as a world of rigid bodies, built in the order of the file.
//!
//! | module | subject |
//! |---|---|
//! | `solid` | the bodies of a scene and their shapes, as the engine has them |
//! | `principal` | the principal moments of a tensor of inertia |
//! | `reach` | which bodies are too far away to be looked at |
//! | `pressing` | what presses on a surface |
//! | `tag` | the memory of a body's radio tag |
//! | `nearby` | which of many bodies a sensor has to look at |
//! | `sleeping` | bodies at rest on what carries them, which cost nothing |
//! | `turning` | friction with what turns |
//! | `turns` | stops that are a turn or more apart |
//! | `coordinate` | where a joint stands, measured from the poses of its bodies |
//! | `actuator` | what drives a joint: along a path, or by a component's equations |
//! | `mechanism` | bodies on joints, moved by the joints' coordinates |
//! | `contact` | contacts in which mechanisms take part |
//! | `articulation` | mechanisms and the engine: who moves which bodies |

pub(crate) mod actuator;
pub(crate) mod articulation;
mod contact;
pub(crate) mod coordinate;
#[cfg(test)]
mod energy;
mod mechanism;
mod nearby;
mod pressing;
mod principal;
mod reach;
mod sleeping;
pub(crate) mod solid;
mod tag;
mod turning;
mod turns;

use onescan_server::client::ClientFault;
use onescan_server::time::TimeSpan;
use rapier3d::parry::bounding_volume::{BoundingSphere, BoundingVolume};
use rapier3d::prelude::*;

use self::actuator::{Actuator, Friction, springs_beside};
use self::articulation::Articulation;
use self::nearby::Nearby;
pub(crate) use self::nearby::Sought;
use self::reach::Reach;
use self::sleeping::Sleeper;
use self::solid::{attach, insert_body, leave_alone};
use crate::bend::Bend;
use crate::effort::Drives;
use crate::layout_mismatch::LayoutMismatch;
use crate::model::{Joint, JointKind, Mechanics};
use crate::pose;
use crate::temperature_field::TemperatureField;

/// Sweeps over all joints and contacts in one solver iteration while the engine has joints: one between a
/// light and a heavy body needs several to carry the load. Contacts alone need one, as the engine is made.
pub(crate) const SWEEPS_WITH_JOINTS: usize = 4;
/// The spring by which a contact with a fixed body keeps bodies apart swings once in so many of the solver's
/// iterations. The engine gives it a stiffness by the mass that presses, so that a light plate under a strong
/// press would sink in; by iterations, it sinks in by a part of the way that the force would move it in one.
const FIRM_ITERATIONS: f64 = 0.6;
/// The same between two bodies that move. Half as many let a light body between heavy ones shake, twice as many let a
/// stack of ten lean until it falls.
const MOVING_ITERATIONS: f64 = 8.0;

/// A body, or one shape of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) body: RigidBodyHandle,
    shape: Option<ColliderHandle>,
    /// A ball around it, as the body sees it; none for a body without a shape.
    ball: Option<BoundingSphere>,
}

/// The rigid bodies of a plant, and where each thing of the scene is in them.
pub(crate) struct World {
    /// All of the state that the engine keeps.
    pub(crate) physics: PhysicsWorld,
    ground: RigidBodyHandle,
    bodies: Vec<RigidBodyHandle>,
    shapes: Vec<ColliderHandle>,
    pub(crate) joints: Vec<ImpulseJointHandle>,
    /// Joints that brake joints of the scene, by their index, as dry friction does.
    pub(crate) frictions: Vec<(usize, Friction)>,
    /// Joints that stand in for springs, dampers and counterweights of joints.
    pub(crate) springs: Vec<(usize, ImpulseJointHandle)>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) articulation: Articulation,
    /// Belts, and where they stay while their surfaces run.
    belts: Vec<(RigidBodyHandle, Pose)>,
    /// Surfaces that are heated, by the index of their body. What heats them says so in every turn, before others look,
    /// so this is not a state of its own.
    heated: Vec<(usize, TemperatureField)>,
    /// Surfaces that are bent, in the same way.
    bent: Vec<(usize, Bend)>,
    reach: Reach,
    /// None before a sensor looks for many bodies.
    nearby: Option<Nearby>,
    /// Bodies that may sleep; none in a scene without `sleeping`.
    sleepers: Vec<Sleeper>,
    /// All that is not fixed, in such a scene.
    movers: Vec<RigidBodyHandle>,
    /// Bodies that may not.
    watched: Vec<RigidBodyHandle>,
    substeps: u32,
    extent_m: f64,
}

impl World {
    /// Builds the world of a scene for turns of one `period`.
    pub(crate) fn build(scene: &Mechanics, period: TimeSpan) -> Self {
        let mut physics = PhysicsWorld::new();
        physics.gravity = Vector::from_array(scene.gravity_m_s2);
        physics.integration_parameters = integration(scene, period);
        let ground = physics.insert_body(RigidBodyBuilder::fixed());
        let bodies: Vec<_> = scene.bodies.iter().map(|body| insert_body(&mut physics, body)).collect();
        let shapes = scene.shapes.iter().map(|shape| attach(&mut physics, shape, scene, bodies[shape.body])).collect();
        for (body, handle) in scene.bodies.iter().zip(&bodies) {
            leave_alone(&mut physics, body, *handle);
        }
        let joints = scene
            .joints
            .iter()
            .map(|joint| {
                let parent = joint.parent.map_or(ground, |index| bodies[index]);
                insert_joint(&mut physics, joint, parent, bodies[joint.child])
            })
            .collect();
        let mut world = Self {
            reach: Reach::of(&physics),
            nearby: None,
            sleepers: Vec::new(),
            movers: Vec::new(),
            watched: Vec::new(),
            physics,
            ground,
            bodies,
            shapes,
            joints,
            frictions: Vec::new(),
            springs: Vec::new(),
            actuators: Vec::new(),
            articulation: Articulation::empty(),
            belts: Vec::new(),
            heated: Vec::new(),
            bent: Vec::new(),
            substeps: scene.substeps,
            extent_m: scene.extent_m,
        };
        world.articulation = Articulation::build(scene, &mut world);
        for index in 0..scene.joints.len() {
            let fitting = world.articulation.fittings[index];
            let along = measured_axis(scene.joints[index].kind);
            if fitting.pushes() {
                let springs = springs_beside(world.joints[index], along, &fitting, &mut world.physics);
                world.springs.extend(springs.into_iter().map(|spring| (index, spring)));
            }
            if !fitting.is_smooth() {
                world.add_friction(index);
            }
        }
        world
    }

    /// Moves the world by one period.
    ///
    /// # Errors
    /// A body whose state is no longer finite or that has left the world.
    pub(crate) fn step(&mut self, scene: &Mechanics, drives: &mut dyn Drives) -> Result<(), ClientFault> {
        if let Some(index) = self.uncoupled(scene) {
            let name = &scene.couplings[index].name;
            return Err(ClientFault::new(format!(
                "coupling `{name}`: its joints must be in trees that stand on the ground or on fixed bodies, or in loops \
                 of these that a joint closes to which nothing is fitted; here something is fitted to each joint of a \
                 loop, or they stand on nothing"
            )));
        }
        for index in 0..self.substeps {
            let part = [index, index + 1].map(|step| f64::from(step) / f64::from(self.substeps));
            self.rouse();
            self.substep(part, drives);
            self.put_belts_back()?;
            self.settle();
            if let Some(lost) = self.physics.quarantine().bodies().first() {
                return Err(self.fault(scene, *lost, "its position or velocity is no longer a finite number"));
            }
        }
        let extent_squared = self.extent_m * self.extent_m;
        let inside = |handle: RigidBodyHandle| {
            let distance_squared = self.body(handle).translation().length_squared();
            distance_squared <= extent_squared
        };
        match self.bodies.iter().find(|handle| !inside(**handle)) {
            None => Ok(()),
            Some(lost) => Err(self.fault(scene, *lost, "it has left the world, whose extent `extent_m` gives")),
        }
    }

    /// From now on a body keeps its place, whatever its velocity: a belt, which carries what lies on
    /// it and goes nowhere itself.
    pub(crate) fn keep_in_place(&mut self, body: RigidBodyHandle) {
        self.belts.push((body, *self.body(body).position()));
    }

    fn put_belts_back(&mut self) -> Result<(), ClientFault> {
        for index in 0..self.belts.len() {
            let (belt, place) = self.belts[index];
            self.body_mut(belt)?.set_position(place, true);
        }
        Ok(())
    }

    fn fault(&self, scene: &Mechanics, handle: RigidBodyHandle, what: &str) -> ClientFault {
        let name =
            self.index_of(handle).and_then(|index| scene.bodies.get(index)).map_or("ground", |body| body.name.as_str());
        ClientFault::new(format!("body `{name}`: {what}"))
    }

    /// The body of an index in the scene, the ground for none.
    pub(crate) fn handle(&self, index: Option<usize>) -> RigidBodyHandle {
        index.map_or(self.ground, |index| self.bodies[index])
    }

    /// The surface of a body has these temperatures from now on.
    pub(crate) fn heat(&mut self, body: usize, field: &TemperatureField) {
        match self.heated.iter_mut().find(|(heated, _)| *heated == body) {
            Some((_, before)) => *before = *field,
            None => self.heated.push((body, *field)),
        }
    }

    /// The surface of a body is bent so from now on.
    pub(crate) fn bend(&mut self, body: usize, bend: Bend) {
        match self.bent.iter_mut().find(|(bent, _)| *bent == body) {
            Some((_, before)) => *before = bend,
            None => self.bent.push((body, bend)),
        }
    }

    /// The surface of a body with its bend, if it has one; as warm as a room where nothing heats it.
    pub(crate) fn heat_of(&self, body: usize) -> TemperatureField {
        let heated = self.heated.iter().find(|(heated, _)| *heated == body);
        let mut field = heated.map_or_else(TemperatureField::default, |(_, field)| *field);
        if let Some((_, bend)) = self.bent.iter().find(|(bent, _)| *bent == body) {
            field.bend = *bend;
        }
        field
    }

    /// Surfaces that are heated, each with the index of its body.
    pub(crate) fn heated(&self) -> impl Iterator<Item = (usize, &TemperatureField)> {
        self.heated.iter().map(|(body, field)| (*body, field))
    }

    /// The bodies of the scene, in its order.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = &RigidBody> {
        self.bodies.iter().map(|handle| self.body(*handle))
    }

    /// Checks that an engine's state has every body, shape and joint that this world knows by handle.
    ///
    /// Handles follow from the order of insertion, which is the scene's, so a state that the same
    /// scene's plant saved has them at the same places.
    ///
    /// # Errors
    /// A state of another world.
    pub(crate) fn check(&self, physics: &PhysicsWorld) -> Result<(), LayoutMismatch> {
        let bodies = self.bodies.iter().chain([&self.ground]).all(|handle| physics.bodies.contains(*handle));
        let shapes = self.shapes.iter().all(|handle| physics.colliders.contains(*handle));
        let joints = self
            .joints
            .iter()
            .chain(self.springs.iter().map(|(_, spring)| spring))
            .chain(self.frictions.iter().map(|(_, friction)| &friction.handle))
            .all(|handle| physics.impulse_joints.contains(*handle));
        // the engine takes the bodies of its joints for granted
        let mut ends = physics.impulse_joints.iter().flat_map(|(_, joint)| [joint.body1(), joint.body2()]);
        let joined = ends.all(|body| physics.bodies.contains(body));
        if bodies && shapes && joints && joined {
            return Ok(());
        }
        Err(LayoutMismatch("it lacks a body, a shape or a joint of this plant".to_owned()))
    }

    /// A body by its handle.
    pub(crate) fn body(&self, handle: RigidBodyHandle) -> &RigidBody {
        &self.physics.bodies[handle]
    }

    /// The joint of an index in the scene.
    pub(crate) fn joint(&self, index: usize) -> ImpulseJointHandle {
        self.joints[index]
    }

    /// The shape of an index in the scene's `[[shape]]`s.
    pub(crate) fn shape(&self, index: usize) -> ColliderHandle {
        self.shapes[index]
    }

    /// The shapes of a body that is in the world, each where it is now.
    fn shapes(&self, handle: RigidBodyHandle) -> impl Iterator<Item = (Pose, &dyn rapier3d::parry::shape::Shape)> {
        let body = self.body(handle);
        let colliders = body.colliders().iter().filter(|_| body.is_enabled());
        colliders.filter_map(|handle| self.physics.colliders.get(*handle)).map(|collider| {
            let local = collider.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
            (*body.position() * local, collider.shape())
        })
    }

    /// True if a ray meets the shape of a body within its range.
    fn ray_meets(&self, ray: &Ray, range_m: f64, handle: RigidBodyHandle) -> bool {
        self.is_near_ray(ray, handle)
            && self.shapes(handle).any(|(pose, shape)| shape.intersects_ray(&pose, ray, range_m))
    }

    /// How far along a ray it meets the shape of a body.
    fn ray_distance(&self, ray: &Ray, handle: RigidBodyHandle) -> Option<f64> {
        if !self.is_near_ray(ray, handle) {
            return None;
        }
        let hits = self.shapes(handle).filter_map(|(pose, shape)| shape.cast_ray(&pose, ray, self.extent_m, true));
        hits.reduce(f64::min)
    }

    fn is_near_ray(&self, ray: &Ray, handle: RigidBodyHandle) -> bool {
        self.reach.meets_ray(handle, self.body(handle).translation(), ray)
    }

    /// A body, or one shape of it.
    pub(crate) fn surface(&self, body: RigidBodyHandle, shape: Option<ColliderHandle>) -> Surface {
        let own = self.body(body).colliders().iter().filter(|own| shape.is_none_or(|shape| shape == **own));
        let balls = own.filter_map(|own| self.physics.colliders.get(*own)).map(|collider| {
            let local = collider.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
            collider.shape().compute_bounding_sphere(&local)
        });
        Surface { body, shape, ball: balls.reduce(|one, other| one.merged(&other)) }
    }

    /// A ball around a surface; none for one without a shape, and for one that is out of the world.
    pub(crate) fn ball_around(&self, one: Surface) -> Option<BoundingSphere> {
        let body = self.body(one.body);
        one.ball.filter(|_| body.is_enabled()).map(|ball| ball.transform_by(body.position()))
    }

    /// False only if a body cannot touch anything in a ball.
    fn is_near_ball(&self, ball: &BoundingSphere, handle: RigidBodyHandle) -> bool {
        let body = self.body(handle);
        body.is_enabled() && self.reach.meets_ball(handle, body.translation(), ball.center, ball.radius)
    }

    /// True if a surface touches a body or is in it, whether they collide or not.
    pub(crate) fn touch(&self, one: Surface, other: RigidBodyHandle) -> bool {
        if !self.body(other).is_enabled() {
            return false;
        }
        match one.shape.and_then(|shape| self.physics.colliders.get(shape)) {
            Some(collider) => {
                let local = collider.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
                self.meets(&(*self.body(one.body).position() * local), collider.shape(), other)
            }
            None => self.shapes(one.body).any(|(pose, shape)| self.meets(&pose, shape, other)),
        }
    }

    /// True if a shape touches a body. Of a body with several shapes most are far away: spheres show it.
    fn meets(&self, pose: &Pose, shape: &dyn rapier3d::parry::shape::Shape, other: RigidBodyHandle) -> bool {
        use rapier3d::parry::query::intersection_test;
        // the engine's shapes all know how to meet each other
        let meet = |place, met| intersection_test(pose, shape, &place, met).is_ok_and(|met| met.intersecting);
        if self.body(other).colliders().len() == 1 {
            return self.shapes(other).any(|(place, met)| meet(place, met));
        }
        let sphere = shape.compute_bounding_sphere(pose);
        let near = |place: &Pose, met: &dyn rapier3d::parry::shape::Shape| {
            met.compute_bounding_sphere(place).intersects(&sphere)
        };
        self.shapes(other).any(|(place, met)| near(&place, met) && meet(place, met))
    }

    /// How many pairs of these bodies, which are in rising order, are in contact.
    pub(crate) fn contacts_among(&self, bodies: &[RigidBodyHandle]) -> u32 {
        let known = |collider: ColliderHandle| {
            let parent = self.physics.colliders.get(collider).and_then(Collider::parent);
            parent.is_some_and(|parent| bodies.binary_search_by_key(&parent.0, |body| body.0).is_ok())
        };
        let pairs = self.physics.narrow_phase.contact_pairs();
        let touching =
            pairs.filter(|pair| pair.has_any_active_contact() && known(pair.collider1) && known(pair.collider2));
        touching.count() as u32
    }

    /// Takes a body out of the world until it is put in again.
    ///
    /// # Errors
    /// A body that there is not, as in all that follow.
    pub(crate) fn take_out(&mut self, handle: RigidBodyHandle) -> Result<(), ClientFault> {
        self.awaken(handle);
        self.body_mut(handle)?.set_enabled(false);
        self.find_mechanisms_of(handle);
        Ok(())
    }

    /// Takes a body of the scene out of a world that nothing moves yet.
    pub(crate) fn leave_out(&mut self, body: usize) {
        self.physics.bodies[self.bodies[body]].set_enabled(false);
    }

    /// The body of a shape, by its index in the scene.
    pub(crate) fn body_of(&self, shape: ColliderHandle) -> Option<usize> {
        let parent = self.physics.colliders.get(shape).and_then(Collider::parent)?;
        self.index_of(parent)
    }

    /// A body's index in the scene; none of the ground.
    fn index_of(&self, handle: RigidBodyHandle) -> Option<usize> {
        self.bodies.iter().position(|known| *known == handle)
    }

    /// Puts a body into the world, at rest where another one is.
    pub(crate) fn put_in(&mut self, handle: RigidBodyHandle, place: RigidBodyHandle) -> Result<(), ClientFault> {
        let pose = *self.body(place).position();
        self.awaken(handle);
        let body = self.body_mut(handle)?;
        body.set_enabled(true);
        body.set_position(pose, true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(AngVector::ZERO, true);
        self.find_mechanisms_of(handle);
        Ok(())
    }

    /// Gives a belt the velocity of its surface.
    pub(crate) fn run(&mut self, belt: RigidBodyHandle, velocity: Vector) -> Result<(), ClientFault> {
        self.body_mut(belt)?.set_linvel(velocity, true);
        Ok(())
    }

    fn body_mut(&mut self, handle: RigidBodyHandle) -> Result<&mut RigidBody, ClientFault> {
        let body = self.physics.bodies.get_mut(handle);
        body.ok_or_else(|| ClientFault::new("a body of the scene is not in the world"))
    }

    fn find_mechanisms_of(&mut self, body: RigidBodyHandle) {
        if self.hangs(body) {
            self.find_mechanisms();
        }
    }

    /// Gives a joint of the scene dry friction in the engine too, if it has none yet.
    pub(crate) fn add_friction(&mut self, joint: usize) {
        if self.frictions.iter().all(|(known, _)| *known != joint) {
            let along = self.articulation.along(joint);
            let friction = Friction::beside(self.joints[joint], along, &mut self.physics);
            self.frictions.extend(friction.map(|friction| (joint, friction)));
        }
    }

    /// Acceleration of free fall.
    pub(crate) fn gravity(&self) -> Vector {
        self.physics.gravity
    }

    /// True if a body hangs on a joint.
    pub(crate) fn hangs(&self, handle: RigidBodyHandle) -> bool {
        self.physics.impulse_joints.attached_joints(handle).next().is_some()
    }

    /// Holds a body fast where it is in relation to another, until the joint is removed.
    pub(crate) fn hold(&mut self, holder: RigidBodyHandle, held: RigidBodyHandle) -> ImpulseJointHandle {
        self.awaken(holder);
        self.awaken(held);
        let between = self.body(holder).position().inv_mul(self.body(held).position());
        let joint = FixedJointBuilder::new().local_frame1(between).contacts_enabled(false);
        let joint = self.physics.insert_impulse_joint(holder, held, joint);
        self.find_mechanisms();
        joint
    }

    /// Removes the joint that [`hold`](Self::hold) gave.
    ///
    /// # Errors
    /// A joint that there is not.
    pub(crate) fn let_go(&mut self, joint: ImpulseJointHandle) -> Result<(), ClientFault> {
        let removed = self.physics.remove_impulse_joint(joint);
        self.find_mechanisms();
        removed.map(|_| ()).ok_or_else(|| ClientFault::new("the joint that holds a body is not in the world"))
    }
}

fn integration(scene: &Mechanics, period: TimeSpan) -> IntegrationParameters {
    let dt = period.as_secs_f64() / f64::from(scene.substeps);
    let per_second = f64::from(scene.solver_iterations) / dt;
    let at_least = |usual: SpringCoefficients<f64>, iterations: f64| SpringCoefficients {
        natural_frequency: usual.natural_frequency.max(per_second / iterations),
        ..usual
    };
    IntegrationParameters {
        dt,
        contact_softness: at_least(SpringCoefficients::contact_defaults(), MOVING_ITERATIONS),
        static_contact_softness: at_least(SpringCoefficients::contact_static_defaults(), FIRM_ITERATIONS),
        num_solver_iterations: scene.solver_iterations as usize,
        num_internal_pgs_iterations: 1,
        // without it a motor below a load converges over many steps and lets the load sag meanwhile
        warmstart_joints: true,
        // kept for 5 cm of motion, points and normals are those of another place: what passes an edge with
        // clearance would hit it, and what lies on a turntable would slide off
        contact_recycling: false,
        ..IntegrationParameters::default()
    }
}

/// Locked axes of a joint in its frame, and the one that its coordinate is measured along.
fn axes(kind: JointKind) -> (JointAxesMask, JointAxis) {
    match kind {
        JointKind::Prismatic => (JointAxesMask::LOCKED_PRISMATIC_AXES, JointAxis::LinX),
        JointKind::Revolute => (JointAxesMask::LOCKED_REVOLUTE_AXES, JointAxis::AngX),
        JointKind::Fixed => (JointAxesMask::LOCKED_FIXED_AXES, JointAxis::LinX),
        JointKind::Ball => (JointAxesMask::LOCKED_SPHERICAL_AXES, JointAxis::AngX),
        JointKind::Slot => {
            (JointAxesMask::LIN_X | JointAxesMask::LIN_Z | JointAxesMask::ANG_Y | JointAxesMask::ANG_Z, JointAxis::LinY)
        }
    }
}

/// The axis in a joint's frame that its coordinate is measured along.
pub(crate) fn measured_axis(kind: JointKind) -> JointAxis {
    axes(kind).1
}

fn insert_joint(
    physics: &mut PhysicsWorld,
    joint: &Joint,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
) -> ImpulseJointHandle {
    let (locked, measured) = axes(joint.kind);
    let [frame1, frame2] = local_frames(physics, joint, parent, child);
    let mut builder =
        GenericJointBuilder::new(locked).local_frame1(frame1).local_frame2(frame2).contacts_enabled(joint.contacts);
    if joint.lower.is_some() || joint.upper.is_some() {
        // the engine measures from the scene's pose
        let lower = joint.lower.map_or(-Real::MAX, |lower| lower - joint.initial);
        let upper = joint.upper.map_or(Real::MAX, |upper| upper - joint.initial);
        builder = builder.limits(measured, [lower, upper]);
    }
    physics.insert_impulse_joint(parent, child, builder)
}

/// The joint's frame as each of its bodies sees it in the pose of the scene.
pub(crate) fn local_frames(
    physics: &PhysicsWorld,
    joint: &Joint,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
) -> [Pose; 2] {
    let frame = pose::frame(joint.anchor_m, joint.axis, joint.across);
    [parent, child].map(|handle| physics.bodies[handle].position().inv_mul(&frame))
}
