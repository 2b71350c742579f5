//! What presses on a surface: the impulses of its contacts, as the engine found them in the last step.

use rapier3d::prelude::*;

use super::{Surface, World};

impl World {
    /// The mass whose weight is what these bodies, in rising order, pressed on a surface along gravity with, the mean of
    /// the last step, kg; 0 without gravity.
    pub(crate) fn pressed_kg(&self, surface: Surface, by: &[RigidBodyHandle]) -> f64 {
        let fall_m_s2 = self.gravity().length();
        if fall_m_s2 <= 0.0 {
            return 0.0;
        }
        let down = self.gravity() / fall_m_s2;
        let own = self.body(surface.body).colliders().iter();
        let own = own.filter(|own| surface.shape.is_none_or(|shape| shape == **own));
        let mut impulse = 0.0;
        for own in own {
            for pair in self.physics.narrow_phase.contact_pairs_with(*own) {
                let is_second = pair.collider2 == *own;
                let other = if is_second { pair.collider1 } else { pair.collider2 };
                let body = self.physics.colliders.get(other).and_then(Collider::parent);
                let counts = body.is_some_and(|body| by.binary_search_by_key(&body.0, |known| known.0).is_ok());
                if counts && pair.has_any_active_contact() {
                    // the normal looks from the first of the two to the second
                    let along = pair.total_impulse().dot(down);
                    impulse += if is_second { along } else { -along };
                }
            }
        }
        impulse / self.physics.integration_parameters.dt / fall_m_s2
    }
}
