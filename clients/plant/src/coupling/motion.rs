//! How a body moves: where it is, how fast, and what a mass on it would feel.

use onescan_server::client::ClientFault;
use rapier3d::glamx::DQuat;
use rapier3d::math::Vector;
use rapier3d::prelude::RigidBodyHandle;
use serde::{Deserialize, Serialize};

use super::{BindingKey, Names, Tie, Unbound, needed, optional, wanted};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::pose::to_rpy_deg;
use crate::world::World;
use crate::world::coordinate::Measured;

/// A point of a body.
pub(crate) struct Motion {
    body: RigidBodyHandle,
    /// As the body sees it.
    point: Vector,
    before: Option<Before>,
}

/// How the point moved when the period began.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Before {
    velocity_m_s: [f64; 3],
    dt_s: f64,
}

/// How a point of a body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moving {
    pub(crate) position_m: [f64; 3],
    /// Roll, pitch and yaw of the body.
    pub(crate) rpy_deg: [f64; 3],
    pub(crate) velocity_m_s: [f64; 3],
    /// About the body's own axes.
    pub(crate) turning_rad_s: [f64; 3],
    /// Acceleration less that of free fall, the mean of the last period, along the body's own axes: what
    /// an accelerometer measures.
    pub(crate) felt_m_s2: [f64; 3],
}

impl Default for Moving {
    fn default() -> Self {
        let zero = [0.0; 3];
        Self { position_m: zero, rpy_deg: zero, velocity_m_s: zero, turning_rad_s: zero, felt_m_s2: [0.0, 0.0, 9.81] }
    }
}

impl Motion {
    fn velocity(&self, world: &World) -> Vector {
        let body = world.body(self.body);
        body.velocity_at_point(*body.position() * self.point)
    }
}

impl Tie for Motion {
    const NAME: &'static str = "motion";
    const KEYS: &'static [BindingKey] = &[
        needed("body", Names::Body, "body that it is on; its own axes are the sensor's"),
        optional(
            "point_m",
            Names::Point,
            "where on it, in world coordinates of the scene's pose; the body's origin if absent",
        ),
    ];
    type Seen = Moving;
    type Effect = ();
    type Memory = Option<Before>;

    fn bind(bound: &Bound, _: &Mechanics, world: &mut World) -> Result<Self, Unbound> {
        let body = world.handle(Some(wanted(bound.body, "body")?));
        let pose = world.body(body).position();
        let point = bound.point_m.map(|point| pose.inverse_transform_point(Vector::from_array(point)));
        Ok(Self { body, point: point.unwrap_or(Vector::ZERO), before: None })
    }

    fn see(&self, _: Measured<'_>, world: &World) -> Moving {
        let body = world.body(self.body);
        let velocity = self.velocity(world);
        let acceleration = match self.before {
            Some(before) if before.dt_s > 0.0 => (velocity - Vector::from_array(before.velocity_m_s)) / before.dt_s,
            _ => Vector::ZERO,
        };
        let own: DQuat = body.rotation().inverse();
        Moving {
            position_m: (*body.position() * self.point).to_array(),
            rpy_deg: to_rpy_deg(*body.rotation()),
            velocity_m_s: velocity.to_array(),
            turning_rad_s: (own * body.angvel()).to_array(),
            felt_m_s2: (own * (acceleration - world.gravity())).to_array(),
        }
    }

    fn apply(&mut self, (): (), _: Measured<'_>, dt_s: f64, world: &mut World) -> Result<(), ClientFault> {
        self.before = Some(Before { velocity_m_s: self.velocity(world).to_array(), dt_s });
        Ok(())
    }

    fn memory(&self) -> Option<Before> {
        self.before
    }

    fn restore(&mut self, before: Option<Before>) {
        self.before = before;
    }

    fn in_words(bound: &Bound, scene: &Mechanics) -> String {
        bound.body.map_or_else(String::new, |body| format!("on body {}", scene.bodies[body].name))
    }
}
