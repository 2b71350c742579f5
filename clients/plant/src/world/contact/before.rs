//! Bodies as a step began.

use nalgebra::Matrix3;
use rapier3d::glamx::{DMat3, DQuat};
use rapier3d::prelude::*;

/// Where a body was and how it moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) pose: Pose,
    pub(super) linear: Vector,
    pub(super) angular: Vector,
}

/// Where bodies were as a step began, by their place in the engine's set.
#[derive(Debug, Default)]
pub(in crate::world) struct Before {
    motions: Vec<Option<Motion>>,
}

impl Before {
    /// Notes all bodies.
    pub(in crate::world) fn note(&mut self, bodies: &RigidBodySet) {
        self.motions.clear();
        for (handle, body) in bodies.iter() {
            let place = place(handle);
            self.motions.resize(self.motions.len().max(place + 1), None);
            self.motions[place] = Some(Motion::of(body));
        }
    }

    /// How a body was; as it is if it was not noted.
    pub(super) fn of(&self, handle: RigidBodyHandle, body: &RigidBody) -> Motion {
        let noted = self.motions.get(place(handle)).copied().flatten();
        noted.unwrap_or_else(|| Motion::of(body))
    }
}

fn place(handle: RigidBodyHandle) -> usize {
    handle.0.into_raw_parts().0 as usize
}

impl Motion {
    /// How a body is now.
    fn of(body: &RigidBody) -> Self {
        Self { pose: *body.position(), linear: body.linvel(), angular: body.angvel() }
    }

    /// How fast a point of the body moves.
    pub(super) fn at(&self, point: Vector, centre: Vector) -> Vector {
        self.linear + self.angular.cross(point - centre)
    }

    /// Where it is after a step in which it moves so.
    pub(super) fn after(&self, [linear, angular]: [Vector; 2], local_centre: Vector, dt_s: f64) -> Pose {
        let centre = self.pose * local_centre + linear * dt_s;
        let angle = angular.length() * dt_s;
        let rotation = if angle > 0.0 {
            let (sine, cosine) = libm::sincos(0.5 * angle);
            let axis = angular * (sine * dt_s / angle);
            (DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine) * self.pose.rotation).normalize()
        } else {
            self.pose.rotation
        };
        Pose::from_parts(centre - rotation * local_centre, rotation)
    }
}

/// What turns a body with this rotation under a moment: the inverse of its inertia, in the world's axes.
pub(super) fn inverse_inertia(body: &RigidBody, rotation: DQuat) -> Matrix3<f64> {
    let properties = body.mass_properties().local_mprops;
    let turned = Matrix3::from(DMat3::from_quat(rotation * properties.principal_inertia_local_frame));
    turned * Matrix3::from_diagonal(&properties.inv_principal_inertia.into()) * turned.transpose()
}
