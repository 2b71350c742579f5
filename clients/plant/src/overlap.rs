//! Bodies that are in each other at the start.
//!
//! The world pushes them apart from the first step on, with a force that has no bound: a carriage that is 0.1 mm in
//! its rail is pressed with more than a meganewton, and its drive feels the friction of that.

use serde::Serialize;

use crate::scene::Scene;
use crate::start::ANY_PERIOD;
use crate::world::World;

/// Bodies that are no deeper in each other are taken to touch: sums of a scene's numbers end so far from another.
pub const OVERLAP_MIN_M: f64 = 1e-6;

/// Two bodies that are in each other in the scene's pose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Overlap {
    /// Their names, in the scene's order.
    pub bodies: [String; 2],
    /// How deep one is in the other, where that is deepest.
    pub depth_m: f64,
}

impl std::fmt::Display for Overlap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [one, other] = &self.bodies;
        write!(f, "`{one}` and `{other}` overlap by {:.3} mm", 1e3 * self.depth_m)
    }
}

impl Scene {
    /// Bodies that are deeper than [`OVERLAP_MIN_M`] in each other at the start, in the scene's order: those that the
    /// world would push apart. Two that no force moves, or that do not collide, are none of them; nor are workpieces
    /// that still wait to be put into the world.
    pub fn overlaps(&self) -> Vec<Overlap> {
        let found = World::at_the_start(self, ANY_PERIOD)
            .overlaps()
            .into_iter()
            .filter(|(_, depth_m)| *depth_m > OVERLAP_MIN_M);
        let name = |body: usize| self.bodies[body].name.clone();
        found.map(|(bodies, depth_m)| Overlap { bodies: bodies.map(name), depth_m }).collect()
    }
}

impl World {
    /// Pairs of the scene's bodies that are in each other, by their indices in rising order, and how deep.
    fn overlaps(&mut self) -> Vec<([usize; 2], f64)> {
        self.physics.detect_collisions(&(), &());
        let mut found: Vec<([usize; 2], f64)> = Vec::new();
        for pair in self.physics.narrow_phase.contact_pairs().filter(|pair| self.may_touch(pair)) {
            let points = pair.manifolds().iter().flat_map(|manifold| &manifold.points);
            let depth_m = points.map(|point| -point.dist).fold(0.0, f64::max);
            let bodies = [pair.collider1, pair.collider2].map(|shape| self.body_of(shape));
            if let ([Some(one), Some(other)], true) = (bodies, depth_m > 0.0) {
                found.push(([one.min(other), one.max(other)], depth_m));
            }
        }
        // of several shapes of a pair the deepest counts
        found.sort_by(|one, other| one.0.cmp(&other.0).then(other.1.total_cmp(&one.1)));
        found.dedup_by_key(|(bodies, _)| *bodies);
        found
    }
}
