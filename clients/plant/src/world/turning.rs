//! What lies on a body that turns.
//!
//! The engine moves bodies along straight lines in a step, those that touch with one velocity where they touch. On a
//! turntable that is the tangent, on which a part is a little further out after each step: by `ω²h/2` of its radius a
//! second. So friction is asked for a velocity of the contact that brings both surfaces to the same place,
//! `½ h (a₁ - a₂)` with `a = ω × (ω × r)`: that is the tangent's way and half of the step's centripetal motion.

use rapier3d::prelude::*;

/// Gives the contacts of a step of so many seconds their velocities.
pub(super) struct Turning {
    pub(super) dt_s: f64,
}

impl Turning {
    /// Half of what the place of a body at a point is accelerated by in a step, as its turning has it.
    fn bend(&self, body: Option<&RigidBody>, point: Vector) -> Vector {
        let turning = body.filter(|body| !body.is_fixed());
        turning.map_or(Vector::ZERO, |body| {
            let turn = body.angvel();
            turn.cross(turn.cross(point - body.center_of_mass())) * (0.5 * self.dt_s)
        })
    }
}

impl PhysicsHooks for Turning {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext<'_>) {
        let body = |handle: Option<RigidBodyHandle>| handle.and_then(|handle| context.bodies.get(handle));
        let [one, other] = [body(context.rigid_body1), body(context.rigid_body2)];
        let Some(manifold) = context.rigid_mut() else { return };
        let normal = *manifold.normal;
        for contact in manifold.solver_contacts.iter_mut() {
            let point = 0.5 * (contact.anchor1 + contact.anchor2);
            let bend = self.bend(one, point) - self.bend(other, point);
            contact.tangent_velocity = bend - normal * bend.dot(normal);
        }
    }
}
