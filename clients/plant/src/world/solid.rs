//! The bodies of a scene and their shapes, as the engine has them.

use std::f64::consts::FRAC_1_SQRT_2;

use rapier3d::glamx::{DMat3, DQuat};
use rapier3d::prelude::*;

use super::principal::principal;
use crate::model::{Attached, Body, BodyKind, Collisions, FrictionRule, Mass, Mechanics, Shape};
use crate::pose;

/// Bodies without a group are members of this one.
const UNGROUPED: Group = Group::GROUP_32;

pub(crate) fn insert_body(physics: &mut PhysicsWorld, body: &Body) -> RigidBodyHandle {
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
    let (moments, frame) = principal(turned.transpose() * world * turned);
    MassProperties::with_principal_inertia_frame(centre, kg, moments, frame)
}

/// Attaches a shape to its body, which still stands in the scene's pose.
pub(crate) fn attach(
    physics: &mut PhysicsWorld,
    shape: &Attached,
    scene: &Mechanics,
    body: RigidBodyHandle,
) -> ColliderHandle {
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
        .collision_groups(groups(collisions))
        .active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
    physics.insert_collider(collider, Some(body))
}

/// Takes the shapes of a body that nothing collides with from the engine's search for contacts, in which
/// each would be moved with its body and compared with what is near, and gives their masses to the body.
pub(crate) fn leave_alone(physics: &mut PhysicsWorld, body: &Body, handle: RigidBodyHandle) {
    let mut mass = stated(body);
    let shapes: Vec<_> = physics.bodies[handle].colliders().to_vec();
    let alone = |shape: &Collider| shape.collision_groups().memberships == Group::NONE;
    for shape in shapes {
        let Some(shape) = physics.colliders.get_mut(shape).filter(|shape| alone(shape)) else { continue };
        let local = shape.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
        let own = shape.mass_properties();
        if own.mass() > 0.0 {
            mass += own.transform_by(&local);
        }
        shape.set_enabled(false);
    }
    physics.bodies[handle].set_additional_mass_properties(mass, false);
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
        .active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS)
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
