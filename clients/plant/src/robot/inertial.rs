//! Which mass and inertia a link can have.

use super::Inertial;

/// Least mass of a body, kg. Simulators refuse links without mass, so files give mere frames less than a body can have.
pub(crate) const MASS_MIN_KG: f64 = 1e-6;

/// What a file says of a link's mass, unless the link is a mere frame.
pub(super) fn of_a_body(written: Inertial) -> Option<Inertial> {
    Some(written).filter(|inertial| inertial.mass_kg >= MASS_MIN_KG)
}

/// The remark on a link that is a mere frame by its mass.
pub(super) fn remark(link: &str, mass_kg: f64) -> String {
    // small numbers with their exponent, as files write them
    let mass = if mass_kg == 0.0 { "0".to_owned() } else { format!("{mass_kg:e} kg") };
    format!("link `{link}` has a mass of {mass}: it is a frame")
}

/// Whether a body can have these moments: all principal ones are above 0.
pub(super) fn is_tensor([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> bool {
    let minor = xx * yy - xy * xy;
    let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    xx > 0.0 && minor > 0.0 && determinant > 0.0 && determinant.is_finite()
}
