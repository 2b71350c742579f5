//! A pose sensor: where a body is, how it is turned and how fast it moves, as a tracking system or a drive
//! without one of the usual encoders reports.
//!
//! # Equations
//! - `y = q round((x + N(0, σ))/q)` for each coordinate and each angle;
//! - roll about x, then pitch about y, then yaw about z, all axes the world's.
//!
//! # Source
//! closed form; angles as in ISO 9787:2013 (coordinate systems of robots).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::quantised;
use crate::coupling::{Motion, Moving};
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// standard deviation of each coordinate's noise
        noise_m: f64 = 0.0 => 0.0, 10.0;
        /// resolution of the coordinates; 0 for none
        quantum_m: f64 = 0.0 => 0.0, 10.0;
        /// standard deviation of each angle's noise
        noise_deg: f64 = 0.0 => 0.0, 90.0;
        /// resolution of the angles; 0 for none
        quantum_deg: f64 = 0.0 => 0.0, 90.0;
    }
}

signals! {
    /// What it takes.
    Inputs {}
}

signals! {
    /// What it gives.
    Outputs {
        /// where it is along the world's x
        x_m: f64,
        /// where it is along the world's y
        y_m: f64,
        /// where it is along the world's z
        z_m: f64,
        /// turned about x
        roll_deg: f64,
        /// then about y
        pitch_deg: f64,
        /// then about z
        yaw_deg: f64,
        /// velocity along the world's x
        x_m_s: f64,
        /// velocity along the world's y
        y_m_s: f64,
        /// velocity along the world's z
        z_m_s: f64,
        /// magnitude of the velocity
        speed_m_s: f64,
        /// magnitude of the angular velocity
        turning_rad_s: f64,
        /// the body is seen
        valid: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the body is out of sight: all values stand, and are not valid
        Lost = "lost",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    position_m: [f64; 3],
    rpy_deg: [f64; 3],
    velocity_m_s: [f64; 3],
    turning_rad_s: f64,
    random: Random,
}

/// A pose sensor, by its parameters.
pub(crate) struct PoseSensor {
    p: Parameters,
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

impl Component for PoseSensor {
    const NAME: &'static str = "pose_sensor";
    const SUMMARY: &'static str = "pose sensor: position, angles and speed of a body";
    const FORMULA: &'static [&'static str] = &["y = q round((x + N(0, σ))/q)"];
    const SOURCE: &'static str = "closed form; ISO 9787:2013 (angles)";
    own_types!(senses Motion);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Moving>) -> State {
        let zero = [0.0; 3];
        let random = Random::new(start.seed);
        State { position_m: zero, rpy_deg: zero, velocity_m_s: zero, turning_rad_s: 0.0, random }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Moving>) -> Outputs {
        let p = &self.p;
        let valid = !turn.failed.has(Failure::Lost);
        if valid {
            let Moving { position_m, rpy_deg, velocity_m_s, turning_rad_s, .. } = turn.seen;
            let random = &mut state.random;
            state.position_m = position_m.map(|x| quantised(x + p.noise_m * random.normal(), p.quantum_m));
            state.rpy_deg = rpy_deg.map(|x| quantised(x + p.noise_deg * random.normal(), p.quantum_deg));
            state.velocity_m_s = velocity_m_s;
            state.turning_rad_s = length(turning_rad_s);
        }
        let [x_m, y_m, z_m] = state.position_m;
        let [roll_deg, pitch_deg, yaw_deg] = state.rpy_deg;
        let [x_m_s, y_m_s, z_m_s] = state.velocity_m_s;
        let (speed_m_s, turning_rad_s) = (length(state.velocity_m_s), state.turning_rad_s);
        Outputs { x_m, y_m, z_m, roll_deg, pitch_deg, yaw_deg, x_m_s, y_m_s, z_m_s, speed_m_s, turning_rad_s, valid }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const SEEN: Moving = Moving {
        position_m: [1.04, 2.0, -3.0],
        rpy_deg: [10.4, 20.0, -30.0],
        velocity_m_s: [2.0, -3.0, 6.0],
        turning_rad_s: [0.0, 3.0, 4.0],
        felt_m_s2: [0.0; 3],
    };

    fn rig(p: Parameters) -> Rig<PoseSensor> {
        let mut rig = Rig::new(PoseSensor::new(p));
        rig.seen = SEEN;
        rig
    }

    #[test]
    fn it_shows_what_there_is() {
        let out = rig(Parameters::default()).run(Inputs {}, 0.01, 1);
        assert_eq!(
            [out.x_m, out.y_m, out.z_m, out.roll_deg, out.pitch_deg, out.yaw_deg],
            [1.04, 2.0, -3.0, 10.4, 20.0, -30.0]
        );
        assert_eq!([out.x_m_s, out.y_m_s, out.z_m_s, out.speed_m_s, out.turning_rad_s], [2.0, -3.0, 6.0, 7.0, 5.0]);
    }

    #[test]
    fn resolution_and_noise_are_those_of_its_parameters() {
        let coarse = Parameters { quantum_m: 0.1, quantum_deg: 1.0, ..Parameters::default() };
        let out = rig(coarse).run(Inputs {}, 0.01, 1);
        assert!((out.x_m - 1.0).abs() < 1e-12 && out.roll_deg == 10.0, "{out:?}");
        let mut noisy = rig(Parameters { noise_m: 0.01, ..Parameters::default() });
        let seen: Vec<_> = (0..10_000).map(|_| noisy.run(Inputs {}, 0.01, 1).y_m - 2.0).collect();
        let variance = seen.iter().map(|x| x * x).sum::<f64>() / 10_000.0;
        // five standard errors √(2/n) of a variance
        assert!((variance / 1e-4 - 1.0).abs() < 5.0 * 0.014_2, "{variance}");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let out = rig(Parameters::default()).failing(Failure::Lost).run(Inputs {}, 0.01, 1);
        assert!(!out.valid && out.x_m == 0.0);
    }
}
