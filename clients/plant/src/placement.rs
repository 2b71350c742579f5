//! Where the bodies of a plant are, for recordings and pictures.

/// Where a body is, with its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPose<'p> {
    pub name: &'p str,
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
