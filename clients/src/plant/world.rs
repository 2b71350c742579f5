//! The scene as a world of rigid bodies, built in the order of the file.

use std::f64::consts::FRAC_1_SQRT_2;

use onescan_server::client::ClientFault;
use onescan_server::time::TimeSpan;
use rapier3d::glamx::{DMat3, DQuat};
use rapier3d::parry::bounding_volume::{BoundingSphere, BoundingVolume};
use rapier3d::prelude::*;

use super::machine::Misfit;
use super::pose;
use super::reach::Reach;
use super::scene::model::{Attached, Body, BodyKind, Collisions, FrictionRule, Joint, JointKind, Mass, Scene, Shape};

/// Bodies without a group are members of this one.
const UNGROUPED: Group = Group::GROUP_32;

/// Sweeps over all joints and contacts in one solver iteration.
const SWEEPS: usize = 4;

/// A body, or one shape of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(super) body: RigidBodyHandle,
    pub(super) shape: Option<ColliderHandle>,
}

/// The rigid bodies of a plant, and where each thing of the scene is in them.
pub(crate) struct World {
    /// All of the state that the engine keeps.
    pub(super) physics: PhysicsWorld,
    ground: RigidBodyHandle,
    bodies: Vec<RigidBodyHandle>,
    shapes: Vec<ColliderHandle>,
    joints: Vec<ImpulseJointHandle>,
    /// Belts, and where they stay while their surfaces run.
    belts: Vec<(RigidBodyHandle, Pose)>,
    reach: Reach,
    substeps: u32,
    extent_m: f64,
}

impl World {
    /// Builds the world of a scene for turns of one `period`.
    pub(super) fn build(scene: &Scene, period: TimeSpan) -> Self {
        let mut physics = PhysicsWorld::new();
        physics.gravity = Vector::from_array(scene.gravity_m_s2);
        physics.integration_parameters = integration(scene, period);
        let ground = physics.insert_body(RigidBodyBuilder::fixed());
        let bodies: Vec<_> = scene.bodies.iter().map(|body| insert_body(&mut physics, body)).collect();
        let shapes = scene.shapes.iter().map(|shape| attach(&mut physics, shape, scene, bodies[shape.body])).collect();
        let joints = scene
            .joints
            .iter()
            .map(|joint| {
                let parent = joint.parent.map_or(ground, |index| bodies[index]);
                insert_joint(&mut physics, joint, parent, bodies[joint.child])
            })
            .collect();
        Self {
            reach: Reach::of(&physics),
            physics,
            ground,
            bodies,
            shapes,
            joints,
            belts: Vec::new(),
            substeps: scene.substeps,
            extent_m: scene.extent_m,
        }
    }

    /// Moves the world by one period.
    ///
    /// # Errors
    /// A body whose state is no longer finite or that has left the world.
    pub(super) fn step(&mut self, scene: &Scene) -> Result<(), ClientFault> {
        for _ in 0..self.substeps {
            self.physics.step();
            self.put_belts_back()?;
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
    pub(super) fn keep_in_place(&mut self, body: RigidBodyHandle) {
        self.belts.push((body, *self.body(body).position()));
    }

    fn put_belts_back(&mut self) -> Result<(), ClientFault> {
        for index in 0..self.belts.len() {
            let (belt, place) = self.belts[index];
            self.body_mut(belt)?.set_position(place, true);
        }
        Ok(())
    }

    fn fault(&self, scene: &Scene, handle: RigidBodyHandle, what: &str) -> ClientFault {
        let index = self.bodies.iter().position(|known| *known == handle);
        let name = index.and_then(|index| scene.bodies.get(index)).map_or("ground", |body| body.name.as_str());
        ClientFault::new(format!("body `{name}`: {what}"))
    }

    /// The body of an index in the scene, the ground for none.
    pub(super) fn handle(&self, index: Option<usize>) -> RigidBodyHandle {
        index.map_or(self.ground, |index| self.bodies[index])
    }

    /// The bodies of the scene, in its order.
    pub(super) fn bodies(&self) -> impl Iterator<Item = &RigidBody> {
        self.bodies.iter().map(|handle| self.body(*handle))
    }

    /// Checks that an engine's state has every body, shape and joint that this world knows by handle.
    ///
    /// Handles follow from the order of insertion, which is the scene's, so a state that the same
    /// scene's plant saved has them at the same places.
    ///
    /// # Errors
    /// A state of another world.
    pub(super) fn check(&self, physics: &PhysicsWorld) -> Result<(), Misfit> {
        let bodies = self.bodies.iter().chain([&self.ground]).all(|handle| physics.bodies.contains(*handle));
        let shapes = self.shapes.iter().all(|handle| physics.colliders.contains(*handle));
        let joints = self.joints.iter().all(|handle| physics.impulse_joints.contains(*handle));
        if bodies && shapes && joints {
            return Ok(());
        }
        Err(Misfit("it lacks a body, a shape or a joint of this plant".to_owned()))
    }

    /// A body by its handle.
    pub(super) fn body(&self, handle: RigidBodyHandle) -> &RigidBody {
        &self.physics.bodies[handle]
    }

    /// The joint of an index in the scene.
    pub(super) fn joint(&self, index: usize) -> ImpulseJointHandle {
        self.joints[index]
    }

    /// The shape of an index in the scene's `[[shape]]`s.
    pub(super) fn shape(&self, index: usize) -> ColliderHandle {
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
    pub(super) fn ray_meets(&self, ray: &Ray, range_m: f64, handle: RigidBodyHandle) -> bool {
        self.is_near_ray(ray, handle)
            && self.shapes(handle).any(|(pose, shape)| shape.intersects_ray(&pose, ray, range_m))
    }

    /// How far along a ray it meets the shape of a body.
    pub(super) fn ray_distance(&self, ray: &Ray, handle: RigidBodyHandle) -> Option<f64> {
        if !self.is_near_ray(ray, handle) {
            return None;
        }
        let hits = self.shapes(handle).filter_map(|(pose, shape)| shape.cast_ray(&pose, ray, self.extent_m, true));
        hits.reduce(f64::min)
    }

    fn is_near_ray(&self, ray: &Ray, handle: RigidBodyHandle) -> bool {
        self.reach.meets_ray(handle, self.body(handle).translation(), ray)
    }

    /// A ball around a surface; none for one without a shape.
    pub(super) fn ball_around(&self, one: Surface) -> Option<BoundingSphere> {
        let alone = one.shape.and_then(|shape| self.physics.colliders.get(shape)).map(|collider| {
            let local = collider.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
            collider.shape().compute_bounding_sphere(&(*self.body(one.body).position() * local))
        });
        let all = || self.shapes(one.body).map(|(pose, shape)| shape.compute_bounding_sphere(&pose));
        alone.or_else(|| all().reduce(|one, other| one.merged(&other)))
    }

    /// False only if a body cannot touch anything in a ball.
    pub(super) fn is_near_ball(&self, ball: &BoundingSphere, handle: RigidBodyHandle) -> bool {
        self.reach.meets_ball(handle, self.body(handle).translation(), ball.center, ball.radius)
    }

    /// True if a surface touches a body or is in it, whether they collide or not.
    pub(super) fn touch(&self, one: Surface, other: RigidBodyHandle) -> bool {
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

    /// True if a shape touches a body. Spheres around both come first: most bodies are far away.
    fn meets(&self, pose: &Pose, shape: &dyn rapier3d::parry::shape::Shape, other: RigidBodyHandle) -> bool {
        use rapier3d::parry::query::intersection_test;
        let sphere = shape.compute_bounding_sphere(pose);
        self.shapes(other).any(|(place, met)| {
            // the engine's shapes all know how to meet each other
            met.compute_bounding_sphere(&place).intersects(&sphere)
                && intersection_test(pose, shape, &place, met).is_ok_and(|met| met.intersecting)
        })
    }

    /// How many pairs of these bodies, which are in rising order, are in contact.
    pub(super) fn contacts_among(&self, bodies: &[RigidBodyHandle]) -> u32 {
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
    pub(super) fn take_out(&mut self, handle: RigidBodyHandle) -> Result<(), ClientFault> {
        self.body_mut(handle)?.set_enabled(false);
        Ok(())
    }

    /// Puts a body into the world, at rest where another one is.
    pub(super) fn put_in(&mut self, handle: RigidBodyHandle, place: RigidBodyHandle) -> Result<(), ClientFault> {
        let pose = *self.body(place).position();
        let body = self.body_mut(handle)?;
        body.set_enabled(true);
        body.set_position(pose, true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(AngVector::ZERO, true);
        Ok(())
    }

    /// Gives a belt the velocity of its surface.
    pub(super) fn run(&mut self, belt: RigidBodyHandle, velocity: Vector) -> Result<(), ClientFault> {
        self.body_mut(belt)?.set_linvel(velocity, true);
        Ok(())
    }

    fn body_mut(&mut self, handle: RigidBodyHandle) -> Result<&mut RigidBody, ClientFault> {
        let body = self.physics.bodies.get_mut(handle);
        body.ok_or_else(|| ClientFault::new("a body of the scene is not in the world"))
    }

    /// Acceleration of free fall.
    pub(super) fn gravity(&self) -> Vector {
        self.physics.gravity
    }

    /// True if a body hangs on a joint.
    pub(super) fn hangs(&self, handle: RigidBodyHandle) -> bool {
        self.physics.impulse_joints.attached_joints(handle).next().is_some()
    }

    /// Holds a body fast where it is in relation to another, until the joint is removed.
    pub(super) fn hold(&mut self, holder: RigidBodyHandle, held: RigidBodyHandle) -> ImpulseJointHandle {
        let between = self.body(holder).position().inv_mul(self.body(held).position());
        let joint = FixedJointBuilder::new().local_frame1(between).contacts_enabled(false);
        self.physics.insert_impulse_joint(holder, held, joint)
    }

    /// Removes the joint that [`hold`](Self::hold) gave.
    ///
    /// # Errors
    /// A joint that there is not.
    pub(super) fn let_go(&mut self, joint: ImpulseJointHandle) -> Result<(), ClientFault> {
        let removed = self.physics.remove_impulse_joint(joint);
        removed.map(|_| ()).ok_or_else(|| ClientFault::new("the joint that holds a body is not in the world"))
    }
}

fn integration(scene: &Scene, period: TimeSpan) -> IntegrationParameters {
    IntegrationParameters {
        dt: period.as_secs_f64() / f64::from(scene.substeps),
        num_solver_iterations: scene.solver_iterations as usize,
        // a joint between a light and a heavy body needs several sweeps to carry the load
        num_internal_pgs_iterations: SWEEPS,
        // without it a motor below a load converges over many steps and lets the load sag meanwhile
        warmstart_joints: true,
        ..IntegrationParameters::default()
    }
}

fn insert_body(physics: &mut PhysicsWorld, body: &Body) -> RigidBodyHandle {
    let builder = match body.kind {
        BodyKind::Fixed => RigidBodyBuilder::fixed(),
        BodyKind::Dynamic => RigidBodyBuilder::dynamic(),
        BodyKind::Kinematic => RigidBodyBuilder::kinematic_velocity_based(),
    };
    let builder = builder
        .pose(pose::from_rpy_deg(body.position_m, body.rpy_deg))
        .linvel(Vector::from_array(body.velocity_m_s))
        .can_sleep(false)
        .additional_mass_properties(stated(body));
    match &body.shape {
        None => physics.insert_body(builder),
        Some(shape) => physics.insert(builder, collider(body, shape)).0,
    }
}

/// Mass properties that a body has beside those of its shapes.
fn stated(body: &Body) -> MassProperties {
    let Mass::Stated { kg, centre_m, inertia_kg_m2: [xx, yy, zz, xy, xz, yz] } = body.mass else {
        return MassProperties::default();
    };
    let place = pose::from_rpy_deg(body.position_m, body.rpy_deg);
    let world = DMat3::from_cols(Vector::new(xx, xy, xz), Vector::new(xy, yy, yz), Vector::new(xz, yz, zz));
    let turned = DMat3::from_quat(place.rotation);
    let centre = place.inverse_transform_point(Vector::from_array(centre_m));
    MassProperties::with_inertia_matrix(centre, kg, turned.transpose() * world * turned)
}

/// Attaches a shape to its body, which still stands in the scene's pose.
fn attach(physics: &mut PhysicsWorld, shape: &Attached, scene: &Scene, body: RigidBodyHandle) -> ColliderHandle {
    let place = pose::from_rpy_deg(shape.position_m, shape.rpy_deg);
    let local = physics.bodies[body].position().inv_mul(&place);
    let own = form(&shape.shape);
    let turned = local * own.position;
    let collisions = if shape.collides { scene.bodies[shape.body].collisions } else { Collisions::None };
    let weighed = match shape.density_kg_m3 {
        Some(density_kg_m3) => own.density(density_kg_m3),
        None => own.mass(shape.mass_kg),
    };
    let collider = weighed
        .position(turned)
        .friction(shape.friction)
        .friction_combine_rule(combined(shape.friction_rule))
        .restitution(shape.restitution)
        .collision_groups(groups(collisions));
    physics.insert_collider(collider, Some(body))
}

fn collider(body: &Body, shape: &Shape) -> ColliderBuilder {
    let builder = form(shape);
    let builder = match body.mass {
        Mass::Total { kg } => builder.mass(kg),
        Mass::Density { kg_m3 } => builder.density(kg_m3),
        Mass::Stated { .. } => builder.mass(0.0),
    };
    builder
        .friction(body.friction)
        .friction_combine_rule(combined(body.friction_rule))
        .restitution(body.restitution)
        .collision_groups(groups(body.collisions))
}

/// The engine's rule; of two it takes the later one in its own order, which is that of the scene's rules.
fn combined(rule: FrictionRule) -> CoefficientCombineRule {
    match rule {
        FrictionRule::Mean => CoefficientCombineRule::Average,
        FrictionRule::Least => CoefficientCombineRule::Min,
        FrictionRule::Product => CoefficientCombineRule::Multiply,
        FrictionRule::Greatest => CoefficientCombineRule::Max,
    }
}

fn form(shape: &Shape) -> ColliderBuilder {
    match *shape {
        Shape::Box { size_m: [x, y, z] } => ColliderBuilder::cuboid(x * 0.5, y * 0.5, z * 0.5),
        Shape::Sphere { radius_m } => ColliderBuilder::ball(radius_m),
        // the engine's cylinder stands along y; a quarter turn about x puts it along z
        Shape::Cylinder { radius_m, length_m } => ColliderBuilder::cylinder(length_m * 0.5, radius_m)
            .position(Pose::from_rotation(DQuat::from_xyzw(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2))),
        Shape::Capsule { radius_m, length_m } => ColliderBuilder::capsule_z(length_m * 0.5, radius_m),
        // a checked scene has meshes with a hull and with triangles only
        Shape::Hull { ref corners_m, .. } => {
            ColliderBuilder::convex_hull(&points(corners_m)).unwrap_or_else(|| ColliderBuilder::ball(0.0))
        }
        Shape::Surface { ref corners_m, ref triangles, .. } => {
            let surface = ColliderBuilder::trimesh(points(corners_m), triangles.clone());
            surface.unwrap_or_else(|_| ColliderBuilder::ball(0.0))
        }
    }
}

fn points(corners_m: &[[f64; 3]]) -> Vec<Vector> {
    corners_m.iter().map(|corner| Vector::from_array(*corner)).collect()
}

fn groups(collisions: Collisions) -> InteractionGroups {
    let (memberships, filter) = match collisions {
        Collisions::None => (Group::NONE, Group::NONE),
        Collisions::All => (UNGROUPED, Group::ALL),
        Collisions::OutsideGroup(index) => {
            let own = Group::from_bits_truncate(1 << index);
            (own, Group::ALL.difference(own))
        }
    };
    InteractionGroups::new(memberships, filter, InteractionTestMode::And)
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
pub(super) fn measured_axis(kind: JointKind) -> JointAxis {
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
pub(super) fn local_frames(
    physics: &PhysicsWorld,
    joint: &Joint,
    parent: RigidBodyHandle,
    child: RigidBodyHandle,
) -> [Pose; 2] {
    let frame = pose::frame(joint.anchor_m, joint.axis, joint.across);
    [parent, child].map(|handle| physics.bodies[handle].position().inv_mul(&frame))
}
