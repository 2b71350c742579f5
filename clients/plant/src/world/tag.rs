//! The memory of a body's radio tag: 32 bits in the engine's own body, so that they are in every saved state, whoever
//! reads or writes them.

use onescan_server::client::ClientFault;
use rapier3d::prelude::*;

use super::World;

/// The bits below say on what a body rests.
const SHIFT: u32 = 96;
/// Those of the tag among the bits that an engine's body has to spare.
pub(super) const BITS: u128 = 0xffff_ffff << SHIFT;

impl World {
    /// What the tag of a body holds; 0 before anybody has written it.
    pub(crate) fn tag(&self, body: RigidBodyHandle) -> i32 {
        (self.body(body).user_data >> SHIFT) as u32 as i32
    }

    /// Writes the tag of a body.
    ///
    /// # Errors
    /// A body that there is not.
    pub(crate) fn write_tag(&mut self, body: RigidBodyHandle, data: i32) -> Result<(), ClientFault> {
        let body = self.body_mut(body)?;
        body.user_data = body.user_data & !BITS | u128::from(data as u32) << SHIFT;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::time::TimeSpan;

    use super::*;
    use crate::effort::Nobody;
    use crate::scene::Scene;

    const BOX_ON_A_FLOOR: &str = "version = 1\nsleeping = true\n\
        [[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [4, 4, 1]\nposition_m = [0, 0, -0.5]\n\
        [[body]]\nname = \"box\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\nmass_kg = 1.0\n\
        position_m = [0, 0, 0.05]\n";

    /// A body that falls asleep and wakes keeps its tag, and its tag leaves its sleep alone.
    #[test]
    fn a_tag_and_a_note_of_sleep_do_not_meet() {
        let scene = Scene::parse(BOX_ON_A_FLOOR, "scene.toml").unwrap_or_else(|error| panic!("{error}"));
        let mut world = World::build(&scene, TimeSpan::from_millis(10).expect("not zero"));
        world.find_mechanisms();
        world.let_sleep();
        let body = world.handle(Some(1));
        assert_eq!(world.tag(body), 0);
        for data in [-1, i32::MIN, 4711] {
            world.write_tag(body, data).expect("it is there");
            for _ in 0..60 {
                world.step(&scene, &mut Nobody).expect("it stays in the world");
            }
            assert!(world.body(body).is_kinematic(), "it sleeps");
            assert_eq!(world.tag(body), data);
            world.take_out(body).expect("it is there");
            assert!(world.body(body).is_dynamic() && world.tag(body) == data, "awake, with its tag");
            world.put_in(body, body).expect("it is there");
        }
    }
}
