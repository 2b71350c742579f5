//! A camera above a field: whether something is in it, how many, and where the first of them lies.
//!
//! # Equations
//! - every `frame_s` it takes a picture, which the outputs report `latency_s` later;
//! - a coordinate is `q round((x + N(0, σ))/q)`, along the axes of the field's body; the angle is about its z.
//!
//! # Source
//! closed form; EMVA 1288 (noise of a picture), VDI/VDE/VDMA 2632-2 (frame, latency, presence).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{is_over, quantised};
use crate::coupling::{Field, InField};
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// from one picture to the next
        frame_s: f64 = 0.04 => 0.0, 60.0;
        /// from a picture to its result; at most until the next picture
        latency_s: f64 = 0.02 => 0.0, 60.0;
        /// standard deviation of each coordinate's noise
        noise_m: f64 = 0.0 => 0.0, 10.0;
        /// size of a pixel; 0 for none
        pixel_m: f64 = 0.0 => 0.0, 10.0;
        /// standard deviation of the angle's noise
        noise_deg: f64 = 0.0 => 0.0, 180.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// takes pictures
        enable: bool = true,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// something is in the field
        present: bool,
        /// how many
        count: i32,
        /// where the first is along the field's x
        x_m: f64,
        /// where the first is along the field's y
        y_m: f64,
        /// how far the first is turned about the field's z
        angle_deg: f64,
        /// pictures whose results have come
        pictures: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it sees nothing
        Dark = "dark",
        /// no new picture comes
        Hung = "hung",
    }
}

/// A picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Picture {
    count: i32,
    x_m: f64,
    y_m: f64,
    angle_deg: f64,
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Since the last picture; none before the first.
    since_s: Option<f64>,
    taken: Option<Picture>,
    reported: Picture,
    pictures: i32,
    random: Random,
}

/// A camera, by its parameters.
pub(crate) struct Camera {
    p: Parameters,
}

impl Camera {
    fn picture(&self, seen: InField, random: &mut Random) -> Picture {
        let p = &self.p;
        // noise is drawn for every picture, so that what is seen does not move the stream
        let [x, y, angle] = [(); 3].map(|()| random.normal());
        if seen.targets.count == 0 {
            return Picture::default();
        }
        let [x_m, y_m, _] = seen.position_m;
        Picture {
            count: seen.targets.count as i32,
            x_m: quantised(x_m + p.noise_m * x, p.pixel_m),
            y_m: quantised(y_m + p.noise_m * y, p.pixel_m),
            angle_deg: seen.turned_deg + p.noise_deg * angle,
        }
    }
}

impl Component for Camera {
    const NAME: &'static str = "camera";
    const SUMMARY: &'static str = "camera above a field: presence, count, and where the first body lies";
    const FORMULA: &'static [&'static str] =
        &["a picture every frame_s, its result latency_s later", "x = q round((x + N(0, σ))/q)"];
    const SOURCE: &'static str = "closed form; EMVA 1288 (noise); VDI/VDE/VDMA 2632-2 (frame, latency)";
    own_types!(senses Field);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<InField>) -> State {
        let (reported, random) = (Picture::default(), Random::new(start.seed));
        State { since_s: None, taken: None, reported, pictures: 0, random }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn<InField>) -> Outputs {
        state.since_s = state.since_s.map(|since_s| since_s + turn.dt_s);
        let frame_over = state.since_s.is_none_or(|since_s| is_over(since_s, self.p.frame_s));
        let hung = turn.failed.has(Failure::Hung);
        let show = |state: &mut State| {
            if let Some(picture) = state.taken.take() {
                (state.reported, state.pictures) = (picture, state.pictures.saturating_add(1));
            }
        };
        if frame_over || state.since_s.is_some_and(|since_s| is_over(since_s, self.p.latency_s)) {
            show(state);
        }
        if frame_over && inputs.enable && !hung {
            let dark = turn.failed.has(Failure::Dark);
            let seen = if dark { InField::default() } else { turn.seen };
            (state.since_s, state.taken) = (Some(0.0), Some(self.picture(seen, &mut state.random)));
            if self.p.latency_s <= 0.0 {
                show(state);
            }
        }
        let Picture { count, x_m, y_m, angle_deg } = state.reported;
        Outputs { present: count > 0, count, x_m, y_m, angle_deg, pictures: state.pictures }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, touched};

    const ON: Inputs = Inputs { enable: true };

    fn seen(count: u32, x_m: f64) -> InField {
        InField { targets: touched(count), position_m: [x_m, -0.2, 5.0], turned_deg: 30.0 }
    }

    fn rig(p: Parameters) -> Rig<Camera> {
        let mut rig = Rig::new(Camera::new(p));
        rig.seen = seen(2, 0.1);
        rig
    }

    #[test]
    fn pictures_come_at_their_rate_and_are_reported_later() {
        let mut rig = rig(Parameters::default());
        let counts: Vec<_> = (0..10).map(|_| rig.run(ON, 0.01, 1).pictures).collect();
        // taken in turns 1, 5, 9; their results two turns later
        assert_eq!(counts, [0, 0, 1, 1, 1, 1, 2, 2, 2, 2]);
        rig.seen = seen(0, 0.0);
        assert!(rig.run(ON, 0.01, 1).present && !rig.run(ON, 0.01, 4).present);
        let off = Inputs { enable: false };
        // the result of one that was taken before may still come
        let last = rig.run(off, 0.01, 5).pictures;
        assert_eq!(rig.run(off, 0.01, 100).pictures, last);
    }

    #[test]
    fn it_reports_where_the_first_lies_to_a_pixel() {
        let p = || Parameters { frame_s: 0.0, latency_s: 0.0, ..Parameters::default() };
        let out = rig(p()).run(ON, 0.01, 1);
        assert_eq!((out.count, out.x_m, out.y_m, out.angle_deg), (2, 0.1, -0.2, 30.0));
        let coarse = rig(Parameters { pixel_m: 0.03, ..p() }).run(ON, 0.01, 1);
        assert!((coarse.x_m - 0.09).abs() < 1e-12 && (coarse.y_m + 0.21).abs() < 1e-12, "{coarse:?}");
        let mut noisy = rig(Parameters { noise_m: 0.01, ..p() });
        let seen: Vec<_> = (0..10_000).map(|_| noisy.run(ON, 0.01, 1).x_m - 0.1).collect();
        let variance = seen.iter().map(|x| x * x).sum::<f64>() / 10_000.0;
        // five standard errors √(2/n) of a variance
        assert!((variance / 1e-4 - 1.0).abs() < 5.0 * 0.014_2, "{variance}");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let dark = rig(Parameters::default()).failing(Failure::Dark).run(ON, 0.01, 50);
        assert!(!dark.present && dark.pictures > 5, "{dark:?}");
        assert_eq!(rig(Parameters::default()).failing(Failure::Hung).run(ON, 0.01, 50).pictures, 0);
    }
}
