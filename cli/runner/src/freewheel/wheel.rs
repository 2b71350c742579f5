//! A client that runs on its own clock.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use onescan_server::client::{Client, ClientFault, ClientView, Parts, Pose};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::item::Items;
use super::sleep;
use super::synchronizer::Synchronizer;
use super::timeline::OwnTimeline;

/// How a client keeps its cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// A timer that fires on a grid, as a PLC's: a late cycle does not delay those after it.
    Grid,
    /// A pause after each cycle, as a simulation tool's: a late cycle delays all after it.
    Pause,
    /// Held to a PLC's cycle time by a timer of high resolution (`[SDSP]` sec. III-B).
    Halt,
    /// Following the PLC's clock (`[Vergnano]` Fig. 5).
    Follow {
        /// How often it is looked at.
        rate: TimeSpan,
        /// How much of the error is corrected, %.
        gain_pct: u8,
    },
}

/// A client, its process images and its clock.
pub(super) struct Wheel {
    pub(super) client: Box<dyn Client>,
    /// What the case does to it.
    pub(super) timeline: OwnTimeline,
    pub(super) period: TimeSpan,
    pub(super) clock: Clock,
    pub(super) inputs: Arc<Items>,
    pub(super) outputs: Arc<Items>,
    /// Its own outputs, whatever the case holds.
    pub(super) own: Vec<u8>,
    /// Outputs after setup and after each cycle, as others see them.
    pub(super) recorded: Vec<Vec<u8>>,
    /// Whether it is noted where its bodies are.
    pub(super) is_seen: bool,
    /// Where they are after setup and after each cycle, if that is noted.
    pub(super) seen: Vec<Vec<Pose>>,
    /// How far its own clock has come.
    pub(super) reached: VirtualTime,
    /// How far it was behind the PLC at each communication, ns, if it follows one.
    pub(super) errors_ns: Vec<i64>,
    /// The clock of the PLC, in ns, which the PLC's wheel writes and who follows it reads.
    pub(super) plc_clock: Arc<AtomicU64>,
}

/// What goes in and comes out of a client's cycles, and how far its clock has come.
pub(super) struct Cycle {
    pub(super) t: VirtualTime,
    inputs: Vec<u8>,
    outputs: Vec<u8>,
}

/// Why a free-wheeling client stopped before its time.
pub(super) struct Halt {
    pub(super) t: VirtualTime,
    pub(super) fault: ClientFault,
}

impl Wheel {
    /// Initialises the client and shows its initial outputs.
    pub(super) fn set_up(&mut self) -> Result<(), ClientFault> {
        let mut outputs = self.outputs.all();
        self.timeline.set_up(self.client.as_mut(), &mut outputs)?;
        let seen = self.timeline.seen(&outputs);
        self.outputs.copy_from(&seen);
        (self.own, self.recorded) = (outputs, vec![seen]);
        self.look();
        Ok(())
    }

    /// Notes where its bodies are, if that is asked for.
    fn look(&mut self) {
        if !self.is_seen {
            return;
        }
        let mut view = ClientView::default();
        self.client.show(Parts::POSES, &mut view);
        self.seen.push(view.poses);
    }

    /// A cycle that has not begun: what goes in and comes out.
    pub(super) fn cycle(&self) -> Cycle {
        Cycle { t: VirtualTime::ZERO, inputs: self.inputs.all(), outputs: self.own.clone() }
    }

    /// Runs the next cycle.
    pub(super) fn turn(&mut self, cycle: &mut Cycle) -> Result<(), Halt> {
        let Cycle { t, inputs, outputs } = cycle;
        *t = *t + self.period;
        self.inputs.copy_to(inputs);
        let asked = self.timeline.before(*t, self.client.as_mut());
        let turned = asked.and_then(|()| self.client.turn(*t, inputs, outputs));
        turned.map_err(|fault| Halt { t: *t, fault })?;
        let seen = self.timeline.seen(outputs);
        self.outputs.copy_from(&seen);
        self.recorded.push(seen);
        self.look();
        self.reached = *t;
        if self.clock == Clock::Grid {
            self.plc_clock.store(t.as_nanos(), Ordering::Relaxed);
        }
        Ok(())
    }

    /// Who follows a PLC, if this client does.
    pub(super) fn synchronizer(&self) -> Synchronizer {
        match self.clock {
            Clock::Follow { gain_pct, .. } => Synchronizer::new(gain_pct),
            Clock::Grid | Clock::Halt | Clock::Pause => Synchronizer::default(),
        }
    }

    /// A communication of the plant, at `t`, with the PLC that it follows.
    pub(super) fn communicate(&mut self, synchronizer: &mut Synchronizer, t: VirtualTime) {
        let plc_ns = self.plc_clock.load(Ordering::Relaxed);
        self.errors_ns.push(plc_ns.cast_signed() - t.as_nanos().cast_signed());
        synchronizer.observe(plc_ns, t.as_nanos());
    }

    /// Runs cycles until its own clock has come to `until`, or until one of `stops` is set.
    pub(super) fn run(&mut self, until: VirtualTime, stops: [&AtomicBool; 2]) -> Result<(), Halt> {
        let period = Duration::from_nanos(self.period.as_nanos());
        let mut cycle = self.cycle();
        let mut synchronizer = self.synchronizer();
        let mut due = sleep::after(Instant::now(), period);
        while cycle.t < until && !stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
            match self.clock {
                Clock::Grid => {
                    sleep::until(due, stops);
                    due = sleep::after(due, period);
                }
                Clock::Halt => {
                    sleep::precisely_until(due, stops);
                    due = sleep::after(due, period);
                }
                Clock::Pause => sleep::until(sleep::after(Instant::now(), period), stops),
                Clock::Follow { rate, .. } => {
                    if !self.wait_for_plc(&mut synchronizer, cycle.t, rate, stops) {
                        break;
                    }
                }
            }
            if stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
                break;
            }
            self.turn(&mut cycle)?;
        }
        Ok(())
    }

    /// Waits until the plant, at `t`, may step; false if it is to stop.
    fn wait_for_plc(
        &mut self,
        synchronizer: &mut Synchronizer,
        t: VirtualTime,
        rate: TimeSpan,
        stops: [&AtomicBool; 2],
    ) -> bool {
        while !synchronizer.may_step(t.as_nanos()) {
            if stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
                return false;
            }
            sleep::until(sleep::after(Instant::now(), Duration::from_nanos(rate.as_nanos())), stops);
            self.communicate(synchronizer, t);
        }
        true
    }
}
