//! One step as bytes: the values that a viewer wants and the bodies that have moved since it last looked.

use std::collections::BTreeMap;

use onescan_plant::Frame;
use onescan_server::layout::ImageLayout;
use onescan_server::published::SessionView;
use onescan_server::signal::SignalId;

/// The bit of a picture's flags that says that it is of the past.
pub(super) const PAST: u8 = 2;
/// The place of the flags.
pub(super) const FLAGS: usize = 1;
/// The kind of message that a picture is.
const KIND: u8 = 1;
const HEAD_BYTES: usize = 24;
const VALUE_BYTES: usize = 16;
const POSE_BYTES: usize = 32;

/// Bodies as the page counts them: which of them follow which body of a plant, and where.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Stage {
    /// By the name of the plant's body: the page's bodies that move with it, each with its place in that body's frame.
    followers: BTreeMap<String, Vec<(u32, Frame)>>,
}

impl Stage {
    /// The page's body `number` moves with body `name` of a plant.
    pub(super) fn follow(&mut self, name: &str, number: u32, within: Frame) {
        self.followers.entry(name.to_owned()).or_default().push((number, within));
    }
}

/// What one viewer has been shown.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    wanted: Vec<SignalId>,
    values: BTreeMap<SignalId, u64>,
    poses: BTreeMap<u32, [u32; 7]>,
}

impl Shown {
    /// From now on these signals; the next picture has all of them.
    pub(super) fn want(&mut self, signals: Vec<SignalId>) {
        self.wanted = signals;
        self.values.clear();
    }

    /// Nothing of what was shown counts any more: the next picture has everything.
    pub(super) fn forget(&mut self) {
        self.values.clear();
        self.poses.clear();
    }

    /// The picture of a step.
    pub(super) fn picture(&mut self, view: &SessionView, layout: &ImageLayout, stage: &Stage) -> Vec<u8> {
        let values = self.values(view, layout);
        let poses = self.poses(view, stage);
        let mut bytes = Vec::with_capacity(HEAD_BYTES + values.len() * VALUE_BYTES + poses.len() * POSE_BYTES);
        bytes.extend([KIND, u8::from(view.is_held)]);
        // a scenario has fewer signals than that, or the rest comes with the next picture
        let count = u16::try_from(values.len()).unwrap_or(u16::MAX);
        bytes.extend(count.to_le_bytes());
        bytes.extend(u32::try_from(poses.len()).unwrap_or(u32::MAX).to_le_bytes());
        bytes.extend(view.steps.0.to_le_bytes());
        bytes.extend(view.t_v.as_nanos().to_le_bytes());
        for (signal, value) in values.into_iter().take(usize::from(count)) {
            bytes.extend(u32::try_from(signal.index()).unwrap_or(u32::MAX).to_le_bytes());
            bytes.extend([0; 4]);
            bytes.extend(value.to_le_bytes());
            self.values.insert(signal, value);
        }
        for (body, pose) in poses {
            bytes.extend(body.to_le_bytes());
            bytes.extend(pose.iter().flat_map(|part| part.to_le_bytes()));
            self.poses.insert(body, pose);
        }
        bytes
    }

    /// The values that are wanted and were not shown yet, as the bits of their numbers.
    fn values(&self, view: &SessionView, layout: &ImageLayout) -> Vec<(SignalId, u64)> {
        let changed = |signal: &SignalId| {
            let number = layout.ty(*signal).as_f64(layout.bytes(*signal, &view.image)).unwrap_or(f64::NAN).to_bits();
            (self.values.get(signal) != Some(&number)).then_some((*signal, number))
        };
        self.wanted.iter().filter_map(changed).collect()
    }

    /// The bodies that have moved, as the bits of their numbers.
    fn poses(&self, view: &SessionView, stage: &Stage) -> Vec<(u32, [u32; 7])> {
        let mut moved = Vec::new();
        for pose in &view.clients.poses {
            let frame = Frame { position_m: pose.position_m, rotation_xyzw: pose.rotation_xyzw };
            for (body, within) in stage.followers.get(&*pose.body).into_iter().flatten() {
                let place = within.seen_from(frame);
                let mut bits = [0; 7];
                for (bits, part) in bits.iter_mut().zip(place.position_m.into_iter().chain(place.rotation_xyzw)) {
                    #[expect(clippy::cast_possible_truncation, reason = "for the eye")]
                    let part = part as f32;
                    *bits = part.to_bits();
                }
                if self.poses.get(body) != Some(&bits) {
                    moved.push((*body, bits));
                }
            }
        }
        moved
    }
}
