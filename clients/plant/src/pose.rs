//! Orientations and joint frames. All angles go through `libm`.

use rapier3d::glamx::{DMat3, DQuat, DVec3};
use rapier3d::math::{Pose, Vector};

/// The pose at a position, rolled about the world's x, then pitched about its y, then yawed about
/// its z.
pub(super) fn from_rpy_deg(position_m: [f64; 3], rpy_deg: [f64; 3]) -> Pose {
    let [roll, pitch, yaw] = rpy_deg.map(|angle_deg| libm::sincos(angle_deg.to_radians() * 0.5));
    let about_x = DQuat::from_xyzw(roll.0, 0.0, 0.0, roll.1);
    let about_y = DQuat::from_xyzw(0.0, pitch.0, 0.0, pitch.1);
    let about_z = DQuat::from_xyzw(0.0, 0.0, yaw.0, yaw.1);
    Pose::from_parts(Vector::from_array(position_m), about_z * about_y * about_x)
}

/// The angles that [`from_rpy_deg`] takes for a rotation; with the pitch at a quarter turn, where roll
/// and yaw are one, the roll is 0.
pub(super) fn to_rpy_deg(rotation: DQuat) -> [f64; 3] {
    let turned = DMat3::from_quat(rotation);
    let [x, y, z] = [turned.x_axis, turned.y_axis, turned.z_axis];
    // an arc sine would lose half of the digits near a quarter turn
    let level = (y.z * y.z + z.z * z.z).sqrt();
    let roll = if level < 1e-14 { 0.0 } else { libm::atan2(y.z, z.z) };
    let (sine, cosine) = libm::sincos(roll);
    // what yaw is left once the roll is taken back, so that both together are exact where each alone is not
    let yaw = libm::atan2(sine * z.x - cosine * y.x, cosine * y.y - sine * z.y);
    [roll, libm::atan2(-x.z, level), yaw].map(f64::to_degrees)
}

/// The frame of a joint in the world: x along `axis`, y along `across`.
pub(super) fn frame(anchor_m: [f64; 3], axis: [f64; 3], across: [f64; 3]) -> Pose {
    let (x, y) = (Vector::from_array(axis), Vector::from_array(across));
    let rotation = DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y)));
    Pose::from_parts(Vector::from_array(anchor_m), rotation)
}

/// A tensor of inertia `[ixx, iyy, izz, ixy, ixz, iyz]` along axes that are turned so, along the world's.
pub(super) fn turned_tensor([xx, yy, zz, xy, xz, yz]: [f64; 6], rotation: DQuat) -> [f64; 6] {
    let own = DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz));
    let rotation = DMat3::from_quat(rotation);
    let world = rotation * own * rotation.transpose();
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis];
    [x.x, y.y, z.z, x.y, x.z, y.z]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vector, b: Vector) -> bool {
        (a - b).length() < 1e-15
    }

    #[test]
    fn no_angle_is_exactly_no_rotation() {
        assert_eq!(from_rpy_deg([1.0, 2.0, 3.0], [0.0; 3]), Pose::translation(1.0, 2.0, 3.0));
    }

    #[test]
    fn roll_comes_first_and_yaw_last() {
        let pose = from_rpy_deg([0.0; 3], [90.0, 0.0, 90.0]);
        // roll takes y to z, which yaw keeps; roll keeps x, which yaw takes to y
        assert!(close(pose * Vector::Y, Vector::Z));
        assert!(close(pose * Vector::X, Vector::Y));
    }

    #[test]
    fn angles_come_back() {
        let beside_upright = [[10.0, 89.999_999, 30.0], [-60.0, -90.000_01, 5.0], [3.0, 90.0 - 1e-9, 1.0]];
        let upright = [[0.0, 90.0, 40.0], [0.0, -90.0, -25.0], [25.0, 90.0, 0.0]];
        let usual = [[10.0, 20.0, 30.0], [-170.0, -80.0, 100.0], [0.0; 3]];
        for rpy in [usual, upright, beside_upright].concat() {
            let pose = from_rpy_deg([0.0; 3], rpy);
            let again = from_rpy_deg([0.0; 3], to_rpy_deg(pose.rotation));
            for axis in [Vector::X, Vector::Y, Vector::Z] {
                assert!((pose * axis - again * axis).length() < 2e-15, "{rpy:?}");
            }
        }
        assert_eq!(to_rpy_deg(from_rpy_deg([0.0; 3], [25.0, 90.0, 0.0]).rotation)[0], 0.0);
    }

    #[test]
    fn a_frame_has_its_axes_where_it_was_given() {
        let frame = frame([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
        assert!(close(frame * Vector::X, Vector::Z));
        assert!(close(frame * Vector::Y, Vector::Y));
    }
}
