//! Where the points of a line lie on a surface that runs along it, and a temperature as a byte.
//!
//! The mirror sweeps 90° in equal angles, so points lie closer together below the scanner than at the ends: with
//! `α_i = −45° + 90°·(i + ½)/n`, point `i` of `n` is at `x_0 + d·tan α_i` and its spot is `d·Δα/cos² α_i` wide.

use std::f64::consts::PI;

/// The field of the mirror, °.
const FIELD_DEG: f64 = 90.0;
/// Bytes of a point are 0 to 255.
const GREATEST: f64 = 255.0;
/// 0 °C in K.
const ZERO_K: f64 = 273.15;
/// Wavelength of the detector times Planck's constants: λ/c₂ at 3.9 µm, 1/K.
const WIEN_1_K: f64 = 3.9e-6 / 1.438_776_877e-2;

/// How a scanner is mounted: over a line, at a distance from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics {
    /// The point of the line that a scanner mounted square looks at with the middle of its field, m.
    pub middle_m: f64,
    /// From the scanner to the line, m.
    pub distance_m: f64,
    /// By how much it is turned out of the square, °; positive towards the end of the line.
    pub off_square_deg: f64,
}

impl Optics {
    /// Where point `index` of `points` lies on the line, m; nothing if it looks past it.
    pub fn place_m(&self, index: usize, points: usize) -> Option<f64> {
        let angle = self.angle_rad(index, points);
        (angle.abs() < PI / 2.0).then(|| self.middle_m + self.distance_m * libm::tan(angle))
    }

    /// Where spot `index` of `points` begins on the line, and the one before it ends, m; nothing if that is past the line.
    pub fn edge_m(&self, index: usize, points: usize) -> Option<f64> {
        let angle = (self.off_square_deg + FIELD_DEG * (index as f64 / points as f64 - 0.5)).to_radians();
        (angle.abs() < PI / 2.0).then(|| self.middle_m + self.distance_m * libm::tan(angle))
    }

    /// How wide the spot of point `index` of `points` is on the line, m.
    pub fn spot_m(&self, index: usize, points: usize) -> f64 {
        let cos = libm::cos(self.angle_rad(index, points));
        self.distance_m * (FIELD_DEG / points as f64).to_radians() / (cos * cos)
    }

    fn angle_rad(&self, index: usize, points: usize) -> f64 {
        let part = (index as f64 + 0.5) / points as f64;
        (self.off_square_deg + FIELD_DEG * (part - 0.5)).to_radians()
    }
}

/// What a scanner that is set to one emissivity shows of a surface of another, °C: by Wien's law at its wavelength.
pub fn shown_degc(surface_degc: f64, emissivity: f64, set: f64) -> f64 {
    let inverse_1_k = 1.0 / (surface_degc + ZERO_K) - WIEN_1_K * libm::log(emissivity / set);
    1.0 / inverse_1_k - ZERO_K
}

/// The byte of a temperature between the limits that are set, by the nearest of 256 values.
pub fn quantised(degc: f64, lower_degc: u16, upper_degc: u16) -> u8 {
    let range = f64::from(upper_degc) - f64::from(lower_degc);
    let value = libm::round((degc - f64::from(lower_degc)) / range * GREATEST);
    // NaN, which no surface has, is 0
    value.clamp(0.0, GREATEST) as u8
}

/// The temperature of a byte between the limits that are set: `T = D·(T_max − T_min)/255 + T_min`.
pub fn temperature_degc(byte: u8, lower_degc: u16, upper_degc: u16) -> f64 {
    let range = f64::from(upper_degc) - f64::from(lower_degc);
    f64::from(byte) * range / GREATEST + f64::from(lower_degc)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOUNTED: Optics = Optics { middle_m: 30.0, distance_m: 30.0, off_square_deg: 0.0 };

    #[test]
    fn the_field_is_as_long_as_twice_the_distance_and_its_spots_touch() {
        for points in [64, 256, 1024] {
            let place = |index| MOUNTED.place_m(index, points).unwrap();
            let spots: f64 = (0..points).map(|index| MOUNTED.spot_m(index, points)).sum();
            assert!((spots - 60.0).abs() < 0.01, "{spots}");
            let ends = place(points - 1) + place(0) - 60.0;
            assert!(ends.abs() < 1e-9, "symmetric about the middle: {ends}");
        }
    }

    #[test]
    fn spots_are_as_wide_as_computed_by_hand() {
        let wide = |index, points| (1e3 * MOUNTED.spot_m(index, points)).round();
        assert_eq!([wide(512, 1024), wide(1023, 1024)], [46.0, 92.0]);
        assert_eq!([wide(128, 256), wide(255, 256)], [184.0, 366.0]);
    }

    #[test]
    fn a_degree_out_of_the_square_moves_the_ends_more_than_the_middle() {
        let off = Optics { off_square_deg: 1.0, ..MOUNTED };
        let moved = |index| off.place_m(index, 1024).unwrap() - MOUNTED.place_m(index, 1024).unwrap();
        assert!((moved(512) - 0.5237).abs() < 1e-3, "{}", moved(512));
        assert!((moved(1023) - 1.0642).abs() < 1e-3, "{}", moved(1023));
        assert_eq!(Optics { off_square_deg: 60.0, ..MOUNTED }.place_m(1023, 1024), None, "past the line");
    }

    #[test]
    fn a_byte_and_back_is_within_half_a_quantum() {
        for tenths in 1000..=5000 {
            let degc = f64::from(tenths) / 10.0;
            let back = temperature_degc(quantised(degc, 100, 500), 100, 500);
            assert!((back - degc).abs() <= 400.0 / 255.0 / 2.0 + 1e-9, "{degc} {back}");
        }
        assert_eq!([quantised(20.0, 100, 500), quantised(900.0, 100, 500), quantised(f64::NAN, 0, 500)], [0, 255, 0]);
    }

    #[test]
    fn a_wrong_emissivity_shows_another_temperature() {
        assert!((shown_degc(300.0, 0.85, 0.85) - 300.0).abs() < 1e-9);
        // by hand: 1/(1/573.15 - 3.9e-6/0.0143878·ln(0.85/0.95))
        assert!((shown_degc(300.0, 0.85, 0.95) - 290.26).abs() < 0.05, "{}", shown_degc(300.0, 0.85, 0.95));
    }
}
