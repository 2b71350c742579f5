//! A shell that is bent: how far its axis is off the line about which it turns, and where who looks at it then meets it.
//!
//! The axis is off by `e(x) = a·exp(−(x−x_b)²/2w²)` towards the angle `φ_b` of the shell's own. While `φ` faces who looks at
//! it, and with `ψ = φ_b − φ`:
//! - the surface is nearer by `r(x) = e·cos ψ + √(R² − e²·sin²ψ) − R`;
//! - what faces him is `φ − asin(e·sin ψ/R)`, since the shell has gone aside by `e·sin ψ`;
//! - a look that met the straight shell at `x_0 + d·tan α` meets this one at `x = x_0 + (d − r(x))·tan α`.
//!
//! # Approximation
//! Each cross section stays a circle, and square to the straight axis: that a bend tilts it is left out, which moves a point
//! along the shell by `R·de/dx` at most, 1 cm where 4 m of shell are off by 10 cm over 15 m.

use serde::{Deserialize, Serialize};

/// Halvings of twice the run-out, after which less than 10⁻¹² m is left of a metre.
const HALVINGS: u32 = 41;

/// How a shell is bent; not at all by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bend {
    /// How far its axis is off where that is most, m.
    pub(crate) off_m: f64,
    /// Where that is along the shell, m.
    pub(crate) at_m: f64,
    /// Its standard deviation along the shell, m; more than 0 where it is off.
    pub(crate) width_m: f64,
    /// Towards which angle of the shell's own.
    pub(crate) at_rad: f64,
}

/// From where a shell is looked at: beside a place of its axis, at a distance from the straight shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Standpoint {
    pub(crate) beside_m: f64,
    pub(crate) distance_m: f64,
}

impl Bend {
    /// How far the axis is off at a place, m.
    fn off_at(&self, x_m: f64) -> f64 {
        if self.off_m == 0.0 {
            return 0.0;
        }
        let aside = (x_m - self.at_m) / self.width_m;
        self.off_m * libm::exp(-0.5 * aside * aside)
    }

    /// By how much the surface is nearer to who looks at it while `facing_rad` faces him, m.
    pub(crate) fn nearer_m(&self, x_m: f64, facing_rad: f64, radius_m: f64) -> f64 {
        let (off_m, behind) = (self.off_at(x_m), self.at_rad - facing_rad);
        let aside_m = off_m * libm::sin(behind);
        let chord_m = (radius_m * radius_m - aside_m * aside_m).max(0.0).sqrt();
        off_m * libm::cos(behind) + chord_m - radius_m
    }

    /// The angle of the shell's own that he sees; nothing if the shell has gone aside by more than its radius.
    pub(crate) fn seen_rad(&self, x_m: f64, facing_rad: f64, radius_m: f64) -> Option<f64> {
        let aside = self.off_at(x_m) * libm::sin(self.at_rad - facing_rad) / radius_m;
        (aside.abs() <= 1.0).then(|| facing_rad - libm::asin(aside))
    }

    /// Where a look meets the shell that would meet the straight one at `straight_m`. The place lies between where the look
    /// is as near as the bend can bring the shell, and as far.
    pub(crate) fn met_m(&self, from: Standpoint, straight_m: f64, facing_rad: f64, radius_m: f64) -> f64 {
        if self.off_m == 0.0 {
            return straight_m;
        }
        let slope = (straight_m - from.beside_m) / from.distance_m;
        let place_m = |depth_m: f64| from.beside_m + depth_m * slope;
        let (mut near_m, mut far_m) = ((from.distance_m - self.off_m).max(0.0), from.distance_m + self.off_m);
        for _ in 0..HALVINGS {
            let depth_m = 0.5 * (near_m + far_m);
            let surface_m = from.distance_m - self.nearer_m(place_m(depth_m), facing_rad, radius_m);
            if depth_m < surface_m {
                near_m = depth_m;
            } else {
                far_m = depth_m;
            }
        }
        place_m(0.5 * (near_m + far_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const RADIUS_M: f64 = 2.0;
    const FROM: Standpoint = Standpoint { beside_m: 30.0, distance_m: 30.0 };

    /// As good as the same all along.
    fn bend() -> Bend {
        Bend { off_m: 0.3, at_m: 45.0, width_m: 1e9, at_rad: 1.0 }
    }

    #[test]
    fn a_straight_shell_is_met_where_it_is_to_the_bit() {
        let straight = Bend::default();
        assert_eq!(straight.met_m(FROM, 47.3, 0.7, RADIUS_M).to_bits(), 47.3_f64.to_bits());
        assert_eq!(straight.seen_rad(47.3, 0.7, RADIUS_M), Some(0.7));
    }

    #[test]
    fn an_axis_that_is_off_alike_all_along_is_met_by_the_closed_form() {
        for turned_deg in (0..360).step_by(15) {
            let facing = f64::from(turned_deg).to_radians();
            let behind = 1.0 - facing;
            let nearer = 0.3 * behind.cos() + (4.0 - (0.3 * behind.sin()).powi(2)).sqrt() - 2.0;
            for straight_m in [0.0, 12.0, 30.0, 48.0, 60.0] {
                let wanted = 30.0 + (30.0 - nearer) * (straight_m - 30.0) / 30.0;
                let met = bend().met_m(FROM, straight_m, facing, RADIUS_M);
                assert!((met - wanted).abs() < 1e-11, "{turned_deg} {straight_m}: {met} {wanted}");
            }
        }
    }

    #[test]
    fn where_the_bend_is_narrow_the_place_solves_its_equation() {
        let narrow = Bend { width_m: 3.0, ..bend() };
        for straight_m in [40.0, 44.0, 45.0, 47.0, 52.0] {
            let met = narrow.met_m(FROM, straight_m, 1.0, RADIUS_M);
            let off = 0.3 * (-0.5 * ((met - 45.0) / 3.0).powi(2)).exp();
            assert!((met - (30.0 + (30.0 - off) * (straight_m - 30.0) / 30.0)).abs() < 1e-11, "{straight_m}: {met}");
        }
    }

    #[test]
    fn a_shell_that_has_gone_aside_shows_another_angle() {
        // a quarter of a turn on, all of the run-out is aside
        let seen = bend().seen_rad(45.0, 1.0 - PI / 2.0, RADIUS_M).expect("within its radius");
        assert!((seen - (1.0 - PI / 2.0 - (0.15_f64).asin())).abs() < 1e-12, "{seen}");
        assert_eq!(bend().seen_rad(45.0, 1.0 - PI / 2.0, 0.29), None);
    }
}
