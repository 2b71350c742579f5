//! What a picture is to be of.

use std::path::PathBuf;
use std::str::FromStr;

use onescan_server::signal::ClientName;
use onescan_server::time::{TimeSpan, VirtualTime};
use thiserror::Error;

/// Most pixels along a side.
const PIXELS_MAX: u32 = 8192;

/// A picture that is asked for.
#[derive(Clone, Debug)]
pub struct ShotConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// A case of it.
    pub case: Option<String>,
    /// Clients that people stand in for.
    pub operated: Vec<ClientName>,
    /// The time that is drawn.
    pub at: VirtualTime,
    /// The view of the scenario that it is drawn from; all of the machine without one.
    pub view: Option<String>,
    /// The picture, a PNG.
    pub out: PathBuf,
    pub size: Size,
    pub theme: Theme,
    /// A film from that time on, an animated WebP, in place of a picture.
    pub film: Option<Film>,
    /// Without lockstep, on clocks that are computed from this seed.
    pub freewheel: Option<u64>,
}

/// Pictures of a film, at most.
pub(super) const PICTURES_MAX: u64 = 2_000;

/// How a film goes on from its first picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// The virtual time of its last picture, at most.
    pub until: VirtualTime,
    /// Pictures a second.
    pub rate: u8,
    /// Seconds of virtual time in one of the film.
    pub speed: f64,
    /// How well pictures are kept, from 0 to 100.
    pub quality: u8,
}

impl Film {
    /// How much virtual time lies between two pictures: whole steps, at least one.
    pub(super) fn every(&self, step: TimeSpan) -> TimeSpan {
        let wanted_ns = self.speed * NS_PER_S / f64::from(self.rate);
        let steps = (wanted_ns / step.as_nanos() as f64).round().max(1.0);
        step.times(steps as u64).unwrap_or(step)
    }

    /// The virtual times of its pictures, the first at `at`.
    pub(super) fn times(&self, at: VirtualTime, step: TimeSpan) -> Vec<VirtualTime> {
        let every = self.every(step);
        let next = |t_v: &VirtualTime| t_v.checked_add(every);
        let all = std::iter::successors(Some(at), next).take_while(|t_v| *t_v <= self.until);
        all.take(PICTURES_MAX as usize).collect()
    }

    /// How long each picture is shown, ms.
    pub(super) fn shown_ms(&self) -> u32 {
        1_000 / u32::from(self.rate.max(1))
    }
}

const NS_PER_S: f64 = 1e9;

/// A size in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// Why a text is no [`Size`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("a size is written as `1280x720`, with 1 to {PIXELS_MAX} pixels along a side")]
pub struct NoSize;

impl FromStr for Size {
    type Err = NoSize;

    fn from_str(text: &str) -> Result<Self, NoSize> {
        let (width, height) = text.split_once('x').ok_or(NoSize)?;
        let side = |text: &str| text.parse().ok().filter(|side| (1..=PIXELS_MAX).contains(side)).ok_or(NoSize);
        Ok(Self { width: side(width)?, height: side(height)? })
    }
}

/// The colours of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    #[default]
    Light,
    /// As a control room at night.
    Dark,
}

impl Theme {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_a_film_are_whole_steps_apart() {
        let film = Film { until: VirtualTime::from_nanos(1_000_000_000), rate: 12, speed: 1.0, quality: 70 };
        let step = TimeSpan::from_millis(10).expect("not zero");
        let times = film.times(VirtualTime::ZERO, step);
        assert_eq!((film.every(step).as_nanos(), film.shown_ms()), (80_000_000, 83));
        assert_eq!((times.len(), times[12].as_nanos()), (13, 960_000_000));
        let slow = Film { speed: 0.001, ..film };
        assert_eq!(slow.every(step), step, "never less than a step");
    }

    #[test]
    fn sizes_are_two_numbers() {
        assert_eq!("1280x720".parse(), Ok(Size { width: 1280, height: 720 }));
        for text in ["1280", "0x10", "10x0", "9000x10", "-1x1", "1x", "x", "1x1x1", ""] {
            assert_eq!(text.parse::<Size>(), Err(NoSize), "{text}");
        }
    }
}
