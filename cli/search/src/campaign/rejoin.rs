//! Where runs with faults come together with the run without: from there on both are the same, so that one is enough.
//!
//! The run without faults leaves its states at some boundaries, and its images from the first of them on. A run with a fault
//! looks at these boundaries whether it is in the same state. Then nothing of the fault is left, and all that is read out of
//! the rest of it, the digest too, is read out of these images.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use onescan_base::regular::{self, Limit};
use onescan_report::file;
use onescan_scenario::apply::departure::Departure;
use onescan_scenario::apply::measure::Over;
use onescan_server::checkpoint::StateHash;
use onescan_server::digest::TrajectoryDigest;
use onescan_server::layout::ImageLayout;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::plan::SessionPlan;
use onescan_server::session::Session;
use onescan_server::time::{TimeSpan, VirtualTime};
use serde::{Deserialize, Serialize};

use super::CampaignError;
use onescan_runner::error::{Unreadable, Usage};

/// States at so many boundaries are left. Each costs what a checkpoint does.
const LOOKS: u64 = 64;
/// Images beyond that are not kept: runs with faults go to their end then.
const IMAGES_MAX_BYTES: u64 = 256 << 20;

/// What the run without faults does from the first of these boundaries on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Ahead {
    /// Its state at boundaries, by virtual time in nanoseconds.
    states: BTreeMap<u64, String>,
    /// Virtual time of the first image.
    from_ns: u64,
    /// Virtual time of the last one.
    end_ns: u64,
    step_ns: u64,
    image_bytes: usize,
    /// Its state at the end.
    state: String,
    #[serde(skip)]
    images: Vec<u8>,
}

/// The boundaries at which runs that depart so may come together with the run without faults, which ends at `until`.
pub(super) fn boundaries(departures: &[Departure], step: TimeSpan, until: VirtualTime) -> Vec<VirtualTime> {
    let earliest = |departure: &Departure| match (departure.from_start, departure.at) {
        (false, Some(at)) if departure.conditions.is_empty() => at,
        _ => VirtualTime::ZERO,
    };
    let Some(first) = departures.iter().map(earliest).min() else { return Vec::new() };
    let steps = (until.as_nanos() - first.as_nanos().min(until.as_nanos())) / step.as_nanos();
    let stride = steps.div_ceil(LOOKS).max(1);
    let at = |number: u64| VirtualTime::from_nanos(first.as_nanos() + number * stride * step.as_nanos());
    (1..=LOOKS).map(at).take_while(|at| *at < until).collect()
}

fn images_file(folder: &Path) -> PathBuf {
    folder.join("ahead.images")
}

fn ahead_file(folder: &Path) -> PathBuf {
    folder.join("ahead.json")
}

/// Keeps the images of the run without faults.
pub(super) struct Images {
    path: PathBuf,
    from: VirtualTime,
    until: VirtualTime,
    /// Nothing before the first image, and where there would be too many.
    out: Option<BufWriter<File>>,
    image_bytes: usize,
}

impl Images {
    /// From `from` on, in `folder`, which is there.
    pub(super) fn new(folder: &Path, from: VirtualTime, until: VirtualTime) -> Self {
        Self { path: images_file(folder), from, until, out: None, image_bytes: 0 }
    }
}

fn wrong(path: &Path) -> impl FnOnce(std::io::Error) -> RecordError {
    |source| RecordError { path: path.display().to_string(), source }
}

impl Observer for Images {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.image_bytes = session.image().len();
        let steps = (self.until.as_nanos() - self.from.as_nanos()) / session.step().as_nanos() + 1;
        let fits = steps.saturating_mul(self.image_bytes as u64) <= IMAGES_MAX_BYTES;
        self.out = if fits { Some(BufWriter::new(File::create(&self.path).map_err(wrong(&self.path))?)) } else { None };
        self.step(session, digest)
    }

    fn step(&mut self, session: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        match &mut self.out {
            Some(out) if session.t_v() >= self.from => out.write_all(session.image()).map_err(wrong(&self.path)),
            _ => Ok(()),
        }
    }

    fn end(&mut self, _: &Session) -> Result<(), RecordError> {
        self.out.as_mut().map_or(Ok(()), |out| out.flush().map_err(wrong(&self.path)))
    }
}

impl Ahead {
    /// Leaves in `folder` what others need to come together with a run: its `states`, and how it ended. Its images are
    /// there.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(super) fn leave(
        folder: &Path,
        states: &[(VirtualTime, StateHash)],
        (step, end, state): (TimeSpan, VirtualTime, StateHash),
    ) -> Result<(), CampaignError> {
        let Some((first, _)) = states.first() else { return Ok(()) };
        let steps = (end.as_nanos() - first.as_nanos()) / step.as_nanos() + 1;
        let path = images_file(folder);
        let images = std::fs::metadata(&path).map_err(Unreadable::at(&path))?.len();
        // Nothing was kept of what is too much.
        if images == 0 || images % steps != 0 {
            return Ok(());
        }
        let ahead = Self {
            states: states.iter().map(|(at, state)| (at.as_nanos(), state.to_string())).collect(),
            from_ns: first.as_nanos(),
            end_ns: end.as_nanos(),
            step_ns: step.as_nanos(),
            image_bytes: (images / steps) as usize,
            state: state.to_string(),
            images: Vec::new(),
        };
        let text = serde_json::to_vec(&ahead).map_err(|error| onescan_report::OutputError(error.into()))?;
        Ok(file::write_whole(&ahead_file(folder), &text)?)
    }

    /// What was left in `folder`; nothing if nothing was.
    ///
    /// # Errors
    /// It cannot be read.
    pub(super) fn of(folder: &Path) -> Result<Option<Rc<Self>>, CampaignError> {
        let path = ahead_file(folder);
        if !path.is_file() {
            return Ok(None);
        }
        let damaged = |what: String| Usage::new(format!("{} is damaged: {what}", path.display()), None);
        let bytes = regular::read(&path, Limit::DATA).map_err(Unreadable::at(&path))?;
        let mut ahead: Self = serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
        let images = images_file(folder);
        ahead.images = regular::read(&images, Limit::DATA).map_err(Unreadable::at(&images))?;
        let steps = ahead.end_ns.checked_sub(ahead.from_ns).and_then(|ns| ns.checked_div(ahead.step_ns));
        if steps.and_then(|steps| (steps as usize + 1).checked_mul(ahead.image_bytes)) != Some(ahead.images.len()) {
            return Err(damaged("it does not fit its images".to_owned()).into());
        }
        Ok(Some(Rc::new(ahead)))
    }

    /// True if its images are those of this plan's sessions.
    pub(super) fn is_of(&self, plan: &SessionPlan) -> bool {
        self.image_bytes == ImageLayout::new(plan.signals()).size()
    }

    /// The states at which a run may come together with it whose fault is over then: often at first, then more and more
    /// seldom, because what has not come together soon often never does.
    pub(super) fn states(&self, over: Over) -> BTreeMap<VirtualTime, String> {
        let from = match over {
            Over::Never => return BTreeMap::new(),
            Over::At(at) => at.as_nanos(),
            Over::Unknown => 0,
        };
        let after = self.states.range(from..).enumerate();
        let looked_at = after.filter(|(number, _)| (number + 1).is_power_of_two());
        looked_at.map(|(_, (at, state))| (VirtualTime::from_nanos(*at), state.clone())).collect()
    }

    /// Virtual time and image of each step after the boundary at `t_v`.
    pub(super) fn after(&self, t_v: VirtualTime) -> impl Iterator<Item = (u64, &[u8])> {
        let all = self.images.chunks_exact(self.image_bytes.max(1));
        let times = (0_u64..).map(|number| self.from_ns + number * self.step_ns);
        times.zip(all).filter(move |(at, _)| *at > t_v.as_nanos())
    }

    /// Virtual time at the end, in nanoseconds.
    pub(super) fn end_ns(&self) -> u64 {
        self.end_ns
    }

    /// Its state at the end.
    pub(super) fn state(&self) -> &str {
        &self.state
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boundaries_lie_behind_the_first_departure() {
        let step = TimeSpan::from_nanos(10).expect("a step");
        let at = |ns: u64| VirtualTime::from_nanos(ns);
        let departs = |ns: u64| Departure { at: Some(at(ns)), ..Departure::default() };
        let all = boundaries(&[departs(50), departs(30)], step, at(100));
        assert_eq!(all, [40, 50, 60, 70, 80, 90].map(at));
        let many = boundaries(&[departs(30)], step, at(10_000));
        assert!(many.len() as u64 <= LOOKS && many[0] == at(190) && many[1] == at(350), "{many:?}");
        assert_eq!(boundaries(&[Departure::default()], step, at(30)), [10, 20].map(at), "it may be anywhere");
        assert!(boundaries(&[], step, at(30)).is_empty());
    }
}
