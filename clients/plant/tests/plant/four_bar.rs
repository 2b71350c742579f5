//! A four-bar linkage that falls, and its own equation of one freedom.

use std::f64::consts::{PI, TAU};

use crate::fidelity::curves::runge_kutta;
use crate::mechanism::{THICK_M, bar, pin};

/// Its crank stands on the origin and its rocker beside it on x, which its coupler joins above.
pub(crate) struct FourBar {
    pub(crate) crank_m: f64,
    pub(crate) coupler_m: f64,
    pub(crate) rocker_m: f64,
    /// Between the pins on the ground.
    pub(crate) apart_m: f64,
    /// Where the crank stands at the start, from x towards z.
    pub(crate) start_rad: f64,
}

/// Masses of crank, coupler and rocker.
const KG: [f64; 3] = [1.0, 2.0, 1.5];

/// Both ends of a bar, x and z, m.
type Ends = [[f64; 2]; 2];

impl FourBar {
    /// The three bars for an angle of the crank.
    fn bars(&self, crank_rad: f64) -> [Ends; 3] {
        let (sine, cosine) = libm::sincos(crank_rad);
        let a = [self.crank_m * cosine, self.crank_m * sine];
        let foot = [self.apart_m, 0.0];
        let (dx, dz) = (foot[0] - a[0], foot[1] - a[1]);
        let apart = dx.hypot(dz);
        let along = (self.coupler_m * self.coupler_m - self.rocker_m * self.rocker_m + apart * apart) / (2.0 * apart);
        let beside = (self.coupler_m * self.coupler_m - along * along).sqrt();
        let b = [a[0] + (along * dx - beside * dz) / apart, a[1] + (along * dz + beside * dx) / apart];
        [[[0.0; 2], a], [a, b], [b, foot]]
    }

    /// The linkage as bodies and joints of a scene: `drive` and `foot` on the ground, `left` and `right` on the coupler.
    pub(crate) fn parts(&self) -> String {
        let [crank, coupler, rocker] = self.bars(self.start_rad);
        let named = [("crank", crank), ("coupler", coupler), ("rocker", rocker)];
        let bars: String = named.iter().zip(KG).map(|((name, [from, to]), kg)| bar(name, *from, *to, kg)).collect();
        let pins = pin("drive", "ground", "crank", crank[0]) + &pin("left", "crank", "coupler", coupler[0]);
        bars + &pins + &pin("right", "coupler", "rocker", coupler[1]) + &pin("foot", "ground", "rocker", rocker[1])
    }

    /// What it resists with for an angle of its crank, and its potential energy: from how its bars move with the angle.
    fn inertia_and_height(&self, crank_rad: f64) -> [f64; 2] {
        const BY: f64 = 1e-5;
        let (before, after, now) = (self.bars(crank_rad - BY), self.bars(crank_rad + BY), self.bars(crank_rad));
        let middle = |[a, b]: Ends| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let heading = |[a, b]: Ends| libm::atan2(b[1] - a[1], b[0] - a[0]);
        let (mut inertia, mut energy) = (0.0, 0.0);
        for (k, kg) in KG.into_iter().enumerate() {
            let [from, to] = now[k];
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            let own = kg * (length * length + THICK_M * THICK_M) / 12.0;
            let (from, to) = (middle(before[k]), middle(after[k]));
            let per = |difference: f64| difference / (2.0 * BY);
            let moved = per(to[0] - from[0]).hypot(per(to[1] - from[1]));
            let turned = per(within_half_a_turn(heading(after[k]) - heading(before[k])));
            inertia += kg * moved * moved + own * turned * turned;
            energy += kg * 9.81 * middle(now[k])[1];
        }
        [inertia, energy]
    }

    /// The crank's angle after a time of fall from rest, by `I φ'' = -½ I' φ'² - V'`.
    pub(crate) fn falls(&self, time_s: f64) -> f64 {
        const BY: f64 = 1e-4;
        let rates = |[rad, rad_s]: [f64; 2]| {
            let ([below, low], [above, high]) = (self.inertia_and_height(rad - BY), self.inertia_and_height(rad + BY));
            let (slope, force) = ((above - below) / (2.0 * BY), (high - low) / (2.0 * BY));
            [rad_s, -(0.5 * slope * rad_s * rad_s + force) / self.inertia_and_height(rad)[0]]
        };
        let steps = (time_s * 1e4).round() as u32;
        let [rad, _] = runge_kutta([self.start_rad, 0.0], time_s, steps, |_, y| rates(*y));
        within_half_a_turn(rad)
    }
}

/// The same angle, from half a turn back to half a turn on.
pub(crate) fn within_half_a_turn(rad: f64) -> f64 {
    (rad + PI).rem_euclid(TAU) - PI
}
