//! The temperature on the surface of a shell that turns: bands along it, and spots that turn with it.
//!
//! `T(x, φ) = T_zone(x) + Σ A_i·exp(−(x−x_i)²/2σ_x² − R²(φ−φ_i)²/2σ_a²)`, where `φ` is an angle of the shell's own and
//! `T_zone` goes straight from the middle of one zone to that of the next.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use onescan_server::client::ValueTable;
use onescan_server::signal::ClientName;
use serde::{Deserialize, Serialize};

use crate::bend::{Bend, Standpoint};

/// Zones along a shell.
pub(crate) const ZONES: usize = 24;
/// Spots on a shell.
pub(crate) const SPOTS: usize = 2;
/// Cells of the unrolled surface, along it and around it.
const COLUMNS: usize = 240;
const ROWS: usize = 120;
/// Beyond such an exponent a spot adds less than 10⁻¹⁵ of its middle.
const FAR: f64 = 35.0;

/// A spot that is hotter or colder than what is around it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spot {
    /// By how much its middle differs, K.
    pub(crate) more_k: f64,
    /// Where its middle is along the shell, m.
    pub(crate) at_m: f64,
    /// And around it, an angle of the shell's own.
    pub(crate) at_rad: f64,
    /// Its standard deviation along the shell, m; more than 0 where it differs.
    pub(crate) along_m: f64,
    pub(crate) around_m: f64,
}

impl Spot {
    /// By how much it differs at a place.
    fn at(&self, x_m: f64, angle_rad: f64, radius_m: f64) -> f64 {
        if self.more_k == 0.0 {
            return 0.0;
        }
        let along = (x_m - self.at_m) / self.along_m;
        let turned = libm::fmod(angle_rad - self.at_rad + PI, TAU);
        let between = if turned < 0.0 { turned + PI } else { turned - PI };
        let around = radius_m * between / self.around_m;
        let exponent = 0.5 * (along * along + around * around);
        if exponent > FAR { 0.0 } else { self.more_k * libm::exp(-exponent) }
    }
}

/// The temperature on a shell, and how far it has turned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TemperatureField {
    /// Of the surface without its spots, in the middle of each zone, °C.
    pub(crate) zones_degc: [f64; ZONES],
    pub(crate) spots: [Spot; SPOTS],
    pub(crate) length_m: f64,
    pub(crate) radius_m: f64,
    /// Beside the shell, °C.
    pub(crate) ambient_degc: f64,
    /// The angle of the shell's own that passes who looks at it.
    pub(crate) angle_rad: f64,
    /// How the shell is bent.
    pub(crate) bend: Bend,
}

impl Default for TemperatureField {
    /// A shell as cold as a room.
    fn default() -> Self {
        let ambient_degc = 20.0;
        Self {
            zones_degc: [ambient_degc; ZONES],
            spots: [Spot::default(); SPOTS],
            length_m: 1.0,
            radius_m: 1.0,
            ambient_degc,
            angle_rad: 0.0,
            bend: Bend::default(),
        }
    }
}

impl TemperatureField {
    /// At a place and an angle of the shell's own, °C; beside the shell, what is around it.
    pub(crate) fn at(&self, x_m: f64, angle_rad: f64) -> f64 {
        if !(0.0..=self.length_m).contains(&x_m) {
            return self.ambient_degc;
        }
        let spots: f64 = self.spots.iter().map(|spot| spot.at(x_m, angle_rad, self.radius_m)).sum();
        self.zone_degc(x_m) + spots
    }

    /// Where who looks at the shell straight on sees it now, °C; where the shell has gone aside, what is around it.
    pub(crate) fn seen_at(&self, x_m: f64) -> f64 {
        let seen = self.bend.seen_rad(x_m, self.angle_rad, self.radius_m);
        seen.map_or(self.ambient_degc, |angle_rad| self.at(x_m, angle_rad))
    }

    /// What a look from there sees now that meets the shell at `straight_m` while that is straight, °C.
    pub(crate) fn seen_from(&self, from: Standpoint, straight_m: f64) -> f64 {
        self.seen_at(self.bend.met_m(from, straight_m, self.angle_rad, self.radius_m))
    }

    /// The surface as a table: position along it from left to right, m, and angle from top to bottom, °, each value in
    /// the middle of its cell.
    pub(crate) fn unrolled(&self, client: &ClientName, name: &Arc<str>) -> ValueTable {
        let x_m = |column: usize| (column as f64 + 0.5) / COLUMNS as f64 * self.length_m;
        let angle_rad = |row: usize| (row as f64 + 0.5) / ROWS as f64 * TAU;
        let cells = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column)));
        ValueTable {
            client: client.clone(),
            name: Arc::clone(name),
            columns: COLUMNS,
            across: [0.0, self.length_m],
            down: [0.0, 360.0],
            values: cells.map(|(row, column)| self.at(x_m(column), angle_rad(row))).collect(),
        }
    }

    fn zone_degc(&self, x_m: f64) -> f64 {
        let place = (x_m / self.length_m * ZONES as f64 - 0.5).clamp(0.0, (ZONES - 1) as f64);
        let left = (place.floor() as usize).min(ZONES - 2);
        let part = place - left as f64;
        self.zones_degc[left] * (1.0 - part) + self.zones_degc[left + 1] * part
    }

    /// The middle of a zone, m.
    #[cfg(test)]
    pub(crate) fn middle_m(&self, zone: usize) -> f64 {
        (zone as f64 + 0.5) / ZONES as f64 * self.length_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> TemperatureField {
        let spot = Spot { more_k: 60.0, at_m: 22.0, at_rad: 130_f64.to_radians(), along_m: 0.8, around_m: 0.8 };
        TemperatureField {
            zones_degc: std::array::from_fn(|zone| 200.0 + 5.0 * zone as f64),
            spots: [spot, Spot::default()],
            length_m: 60.0,
            radius_m: 2.0,
            ..TemperatureField::default()
        }
    }

    #[test]
    fn zones_are_joined_by_straight_lines() {
        let field = field();
        let opposite = 310_f64.to_radians();
        assert!((field.at(field.middle_m(3), opposite) - 215.0).abs() < 1e-9);
        assert!((field.at(10.0, opposite) - (200.0 + 5.0 * 3.5)).abs() < 1e-9);
        assert_eq!([field.at(0.0, opposite), field.at(60.0, opposite)], [200.0, 315.0]);
        assert_eq!([field.at(-0.1, 0.0), field.at(60.1, 0.0)], [20.0, 20.0]);
    }

    #[test]
    fn on_a_bent_shell_a_spot_is_seen_where_the_closed_form_has_it() {
        let mut field = field();
        field.bend = Bend { off_m: 0.3, at_m: 22.0, width_m: 1e9, at_rad: 1.0 };
        let from = Standpoint { beside_m: 30.0, distance_m: 30.0 };
        // the angle at which the middle of the spot is seen: φ - asin(0.3 sin(1 - φ)/2) = 130°
        let mut facing = 130_f64.to_radians();
        for _ in 0..50 {
            facing = 130_f64.to_radians() + (0.3 * (1.0 - facing).sin() / 2.0).asin();
        }
        field.angle_rad = facing;
        let nearer = 0.3 * (1.0 - facing).cos() + (4.0 - (0.3 * (1.0 - facing).sin()).powi(2)).sqrt() - 2.0;
        let straight_m = 30.0 - 8.0 * 30.0 / (30.0 - nearer);
        let seen = field.seen_from(from, straight_m);
        assert!((seen - field.at(22.0, 130_f64.to_radians())).abs() < 1e-6, "{seen}");
        assert!((straight_m - 22.0).abs() > 0.02 && (facing - 130_f64.to_radians()).abs() > 0.1);
    }

    #[test]
    fn a_spot_is_a_gaussian_along_and_around_whatever_turns_came_before() {
        let field = field();
        let (x, angle) = (22.0, 130_f64.to_radians());
        let band = field.at(x, angle + PI);
        let more = |x: f64, angle: f64| field.at(x, angle) - field.at(x, 130_f64.to_radians() + PI);
        assert!((field.at(x, angle) - band - 60.0).abs() < 1e-9);
        // a standard deviation aside, along or around, exp(-1/2) is left
        let aside = 60.0 * libm::exp(-0.5);
        assert!((more(22.8, angle) - aside).abs() < 1e-9 && (more(x, angle + 0.4) - aside).abs() < 1e-9);
        for turns in [-3.0, -1.0, 1.0, 1e6] {
            assert!((more(x, angle + turns * TAU) - 60.0).abs() < 1e-6, "{turns}");
        }
    }
}
