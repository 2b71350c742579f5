//! Where a body, a geom or a mass is.

use rapier3d::glamx::{DMat3, DQuat, DVec3};
use rapier3d::math::Pose;

use super::Reader;
use crate::pose::to_rpy_deg;
use crate::robot::Origin;
use crate::robot::xml::{Element, RobotFault};

impl Reader<'_> {
    /// `pos`, and one of `quat`, `axisangle`, `xyaxes`, `zaxis`, `euler`.
    pub(super) fn pose(&self, element: &Element) -> Result<Pose, RobotFault> {
        let angle = |angle: f64| if self.compiler.degrees { angle.to_radians() } else { angle };
        let position = DVec3::from_array(element.triple("pos", [0.0; 3])?);
        let rotation = if let Some([w, x, y, z]) = element.numbers::<4>("quat")? {
            let length = (w * w + x * x + y * y + z * z).sqrt();
            if length == 0.0 {
                return Err(element.wrong_at("quat", "a quaternion of no length"));
            }
            DQuat::from_xyzw(x / length, y / length, z / length, w / length)
        } else if let Some([x, y, z, turned]) = element.numbers::<4>("axisangle")? {
            about(DVec3::new(x, y, z), angle(turned))
        } else if let Some([a, b, c, d, e, f]) = element.numbers::<6>("xyaxes")? {
            let x = unit(DVec3::new(a, b, c));
            let y = DVec3::new(d, e, f);
            let y = unit(y - x * y.dot(x));
            DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y)))
        } else if let Some(z) = element.numbers::<3>("zaxis")? {
            along(DVec3::from_array(z))
        } else if let Some(angles) = element.numbers::<3>("euler")? {
            let mut turned = DQuat::IDENTITY;
            for (axis, turn) in self.compiler.euler.chars().zip(angles) {
                let vector = match axis.to_ascii_lowercase() {
                    'x' => DVec3::X,
                    'y' => DVec3::Y,
                    _ => DVec3::Z,
                };
                let step = about(vector, angle(turn));
                // small letters turn with the frame, capitals about fixed axes
                turned = if axis.is_ascii_lowercase() { turned * step } else { step * turned };
            }
            turned
        } else {
            DQuat::IDENTITY
        };
        Ok(Pose::from_parts(position, rotation))
    }
}

fn unit(vector: DVec3) -> DVec3 {
    let length = vector.length();
    if length > 0.0 { vector / length } else { DVec3::X }
}

fn about(axis: DVec3, angle_rad: f64) -> DQuat {
    let (sin, cos) = libm::sincos(0.5 * angle_rad);
    let axis = unit(axis) * sin;
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cos)
}

/// The least rotation that takes z to a direction.
pub(super) fn along(direction: DVec3) -> DQuat {
    let to = unit(direction);
    let across = DVec3::Z.cross(to);
    if across.length() < 1e-12 {
        return if to.z > 0.0 { DQuat::IDENTITY } else { DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0) };
    }
    about(across, libm::atan2(across.length(), to.z))
}

pub(super) fn origin(pose: &Pose) -> Origin {
    Origin { xyz_m: pose.translation.to_array(), rpy_rad: to_rpy_deg(pose.rotation).map(f64::to_radians) }
}
