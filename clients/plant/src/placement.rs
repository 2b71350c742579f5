//! Where the bodies of a plant are, for recordings and pictures.

use super::client::Plant;
use super::machine::Machine;

/// Where a body is, with its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPose<'p> {
    /// The body.
    pub name: &'p str,
    /// Its origin.
    pub position_m: [f64; 3],
    /// Its orientation, a unit quaternion with the scalar last.
    pub rotation_xyzw: [f64; 4],
}

/// Where a body is; it owns all that it says and may be sent to another thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The body's origin, m.
    pub position_m: [f64; 3],
    /// The body's orientation, a unit quaternion with the scalar last.
    pub rotation_xyzw: [f64; 4],
}

impl Plant {
    /// Where the bodies are, in the scene's order; nothing before the set-up.
    pub fn poses(&self) -> impl Iterator<Item = BodyPose<'_>> {
        self.placements().zip(&self.scene().bodies).map(|(placement, body)| {
            let Placement { position_m, rotation_xyzw } = placement;
            BodyPose { name: &body.name, position_m, rotation_xyzw }
        })
    }

    /// Where the bodies are, in the order of [`scene`](Self::scene)`().bodies`, in place of what
    /// `into` held; nothing before the set-up. From the second call on it allocates nothing.
    pub fn write_poses(&self, into: &mut Vec<Placement>) {
        into.clear();
        into.extend(self.placements());
    }

    fn placements(&self) -> impl Iterator<Item = Placement> {
        self.machine().into_iter().flat_map(Machine::placements)
    }
}
