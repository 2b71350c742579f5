//! The mass matrix and the gravity forces of each mechanism, in the scene's pose.
//!
//! They are those that the plant computes with, so they can be laid beside a drive's sizing or another program's.

use serde::Serialize;

use crate::scene::Scene;
use crate::start::ANY_PERIOD;
use crate::world::World;

/// A mechanism at rest: `M a + g = f`, for accelerations `a` and forces `f` of its joints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dynamics {
    /// Its joints that have one coordinate, by name.
    pub joints: Vec<String>,
    /// `g`, what holds each joint against gravity: N of a joint that slides, Nm of one that turns.
    pub gravity: Vec<f64>,
    /// `M`, a row for each joint: kg, kg·m, kg·m².
    pub mass_matrix: Vec<Vec<f64>>,
}

impl Scene {
    /// The mechanisms in their first pose, without what is fitted to joints or couples them. Joints whose loop the
    /// engine closes, and robots that are `kinematic`, have none.
    pub fn dynamics(&self) -> Vec<Dynamics> {
        let mut world = World::at_the_start(self, ANY_PERIOD);
        let gravity = world.gravity();
        let found = world.articulation.at_rest(gravity).into_iter().filter(|rests| !rests.joints.is_empty());
        let named = found.map(|rests| Dynamics {
            joints: rests.joints.iter().map(|joint| self.joints[*joint].name.clone()).collect(),
            gravity: rests.holding,
            mass_matrix: rests.mass,
        });
        named.collect()
    }
}
