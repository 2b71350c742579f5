//! How far a body reaches around its origin: most bodies are far from most sensors, and a distance shows it
//! at once. What it leaves over is looked at exactly, so that it decides nothing.

use rapier3d::math::{Pose, Vector};
use rapier3d::prelude::*;

/// Added to every reach, for numbers are rounded.
const MARGIN_M: f64 = 1e-3;

/// The reaches of all bodies, by their place in the engine's set.
#[derive(Debug)]
pub(crate) struct Reach {
    radii_m: Vec<f64>,
}

impl Reach {
    /// The reaches of the bodies of a world that has all of its shapes.
    pub(crate) fn of(physics: &PhysicsWorld) -> Self {
        let mut radii_m = Vec::new();
        for (handle, body) in physics.bodies.iter() {
            let colliders = body.colliders().iter().filter_map(|collider| physics.colliders.get(*collider));
            let radius = colliders.map(|collider| {
                let local = collider.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
                let sphere = collider.shape().compute_bounding_sphere(&local);
                sphere.center.length() + sphere.radius
            });
            let place = handle.0.into_raw_parts().0 as usize;
            radii_m.resize(radii_m.len().max(place + 1), f64::INFINITY);
            radii_m[place] = radius.reduce(f64::max).unwrap_or(0.0) + MARGIN_M;
        }
        Self { radii_m }
    }

    /// How far a body reaches; without end if it is not known.
    #[inline]
    pub(super) fn radius_m(&self, handle: RigidBodyHandle) -> f64 {
        self.radii_m.get(handle.0.into_raw_parts().0 as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// False only if a body whose origin is at a place cannot touch a ball.
    #[inline]
    pub(crate) fn meets_ball(&self, handle: RigidBodyHandle, origin: Vector, centre: Vector, radius_m: f64) -> bool {
        let reach_m = self.radius_m(handle) + radius_m;
        (origin - centre).length_squared() <= reach_m * reach_m
    }

    /// False only if a body whose origin is at a place cannot be met by a ray of unit length.
    #[inline]
    pub(crate) fn meets_ray(&self, handle: RigidBodyHandle, origin: Vector, ray: &Ray) -> bool {
        let (away, reach_m) = (origin - ray.origin, self.radius_m(handle));
        let along = away.dot(ray.dir);
        along >= -reach_m && away.length_squared() - along * along <= reach_m * reach_m
    }
}
