//! The principal moments of a tensor of inertia, and their axes.
//!
//! The engine's own come from the roots of a cubic: where two moments are alike, as in most links of robots, half of the
//! digits of their axes are lost, and the tensor that comes back is off by 1e-9. Jacobi's rotations keep them.
//!
//! Source: C. G. J. Jacobi, *Über ein leichtes Verfahren*, Crelle's Journal 30, 1846; in each plane by the smaller angle.

use rapier3d::glamx::{DMat3, DQuat};
use rapier3d::math::Vector;

/// Each sweep doubles the digits, so that four or five are enough.
const SWEEPS: usize = 12;

/// The moments, and the frame in whose axes the tensor has nothing beside them.
pub(super) fn principal(tensor: DMat3) -> (Vector, DQuat) {
    let mut frame = DQuat::IDENTITY;
    for _ in 0..SWEEPS {
        for (row, column, turn) in [(0, 1, -Vector::Z), (0, 2, Vector::Y), (1, 2, -Vector::X)] {
            let seen = in_frame(tensor, frame);
            let (one, other) = (seen.col(row)[row], seen.col(column)[column]);
            let beside = seen.col(column)[row];
            if beside.abs() > 1e-18 * (one.abs() + other.abs()) {
                frame *= step(one, other, beside, turn);
            }
        }
        frame = frame.normalize();
    }
    let seen = in_frame(tensor, frame);
    (Vector::new(seen.x_axis.x, seen.y_axis.y, seen.z_axis.z), frame)
}

fn in_frame(tensor: DMat3, frame: DQuat) -> DMat3 {
    let turned = DMat3::from_quat(frame);
    turned.transpose() * tensor * turned
}

/// The turn about an axis that takes away what two moments have beside them.
fn step(one: f64, other: f64, beside: f64, axis: Vector) -> DQuat {
    let ratio = (other - one) / (2.0 * beside);
    let tangent = 1.0_f64.copysign(ratio) / (ratio.abs() + (ratio * ratio + 1.0).sqrt());
    let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
    let half_cosine = (0.5 * (1.0 + cosine)).sqrt();
    let half_sine = tangent * cosine / (2.0 * half_cosine);
    let about = axis * half_sine;
    DQuat::from_xyzw(about.x, about.y, about.z, half_cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(tensor: DMat3) -> f64 {
        let (moments, frame) = principal(tensor);
        let turned = DMat3::from_quat(frame);
        let again = turned * DMat3::from_diagonal(moments) * turned.transpose();
        let apart = (again - tensor).to_cols_array().into_iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        apart / tensor.to_cols_array().into_iter().fold(0.0_f64, |most, entry| most.max(entry.abs()))
    }

    #[test]
    fn the_tensor_comes_back() {
        // a quarter turn as files write it, in a dozen digits
        let quarter = DMat3::from_quat(DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2 - 5e-12));
        let turned = DMat3::from_quat(DQuat::from_xyzw(0.1, -0.3, 0.5, 0.7).normalize());
        let all = [
            Vector::new(0.42, 0.42, 0.036),
            Vector::new(1.0, 1.0, 1.0),
            Vector::new(1e-9, 1e-3, 1e-3),
            Vector::new(0.2, 0.3, 0.4),
        ];
        for moments in all {
            for turned in [DMat3::IDENTITY, quarter, turned] {
                let tensor = turned * DMat3::from_diagonal(moments) * turned.transpose();
                assert!(back(tensor) < 2e-15, "{moments} {turned} {}", back(tensor));
            }
        }
    }

    #[test]
    fn what_has_nothing_beside_its_moments_is_not_turned() {
        let moments = Vector::new(3.0, 1.0, 2.0);
        assert_eq!(principal(DMat3::from_diagonal(moments)), (moments, DQuat::IDENTITY));
    }
}
