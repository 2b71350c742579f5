//! Steps in which nobody is due: the delays of `[SDSP]` sec. IV at their longest.
//!
//! Every client sleeps, so nobody is waited for and no value changes. The driver goes over such steps without entering
//! their states: what is left of a step is its image in the digest. Timeline, replays, wishes and the end are looked at
//! where they may have something to say, so a session that rests is the same session, to the bit.

use super::Lockstep;
use crate::cycle::whole_steps_before;
use crate::observer::RecordError;
use crate::time::VirtualTime;

/// Steps between two looks at the mailbox and at observers that need not see every step; a power of two, at whose
/// multiples the looks are.
const STRIDE: u64 = 4096;
const _: () = assert!(STRIDE.is_power_of_two(), "looks lie at the multiples of a power of two");

impl Lockstep {
    /// At a boundary: goes over the steps in which nothing can happen, up to the first boundary at or after `t_v` and
    /// to the next look. True if there were any.
    pub(super) fn rest(&mut self, t_v: VirtualTime) -> Result<bool, RecordError> {
        let steps = self.restful_steps(t_v);
        if steps == 0 {
            return Ok(false);
        }
        let one_by_one = self.shown.is_watched() || self.observers.iter().any(|one| one.wants_idle_steps());
        let passed = self.session.pass_over(if one_by_one { 1 } else { steps });
        debug_assert!((1..=steps).contains(&passed), "steps in which nothing can happen are passed over, and no others");
        if let Some(digest) = &mut self.digest {
            digest.steps(self.session.image(), passed);
        }
        self.notify_step()?;
        Ok(passed > 0)
    }

    /// How many steps follow in which nobody is due, nobody has asked for anything and nothing was planned.
    fn restful_steps(&self, t_v: VirtualTime) -> u64 {
        let idle = if self.digest.is_some() && self.pacer.is_free() { self.session.idle_steps() } else { 0 };
        if idle == 0 {
            return 0;
        }
        let Some(planned) = self.timeline.rests_until() else { return 0 };
        let (now, step) = (self.session.t_v(), self.session.step());
        let here = self.session.cycle().steps().0;
        let replayed = self.replayed.front().filter(|next| next.resets == self.resets);
        let to_replay = replayed.map_or(u64::MAX, |next| next.step.0.saturating_sub(here));
        let to_goal = whole_steps_before(now, t_v, step).saturating_add(1);
        let to_look = STRIDE - here % STRIDE;
        [idle, whole_steps_before(now, planned, step), to_replay, to_goal, to_look].into_iter().fold(u64::MAX, u64::min)
    }
}
