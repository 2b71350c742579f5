//! A client that runs on its own clock.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use onescan_server::client::{Client, ClientFault};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::item::Items;

/// How a client keeps its cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// A timer that fires on a grid, as a PLC's: a late cycle does not delay those after it.
    Grid,
    /// A pause after each cycle, as a simulation tool's: a late cycle delays all after it.
    Pause,
}

/// A client, its process images and its clock.
pub(super) struct Wheel {
    pub(super) client: Box<dyn Client>,
    pub(super) period: TimeSpan,
    pub(super) clock: Clock,
    pub(super) inputs: Arc<Items>,
    pub(super) outputs: Arc<Items>,
    /// Outputs after setup and after each cycle.
    pub(super) recorded: Vec<Vec<u8>>,
    /// How far its own clock has come.
    pub(super) reached: VirtualTime,
}

/// Why a free-wheeling client stopped before its time.
pub(super) struct Halt {
    pub(super) t: VirtualTime,
    pub(super) fault: ClientFault,
}

impl Wheel {
    /// Initialises the client and shows its initial outputs.
    pub(super) fn set_up(&mut self, output_bytes: usize) -> Result<(), ClientFault> {
        let mut outputs = vec![0; output_bytes];
        self.client.setup(&mut outputs)?;
        self.outputs.copy_from(&outputs);
        self.recorded = vec![outputs];
        Ok(())
    }

    /// Runs cycles until its own clock has come to `until`, or until one of `stops` is set.
    pub(super) fn run(&mut self, input_bytes: usize, until: VirtualTime, stops: [&AtomicBool; 2]) -> Result<(), Halt> {
        let period = Duration::from_nanos(self.period.as_nanos());
        let mut inputs = vec![0; input_bytes];
        let mut outputs = self.recorded.last().cloned().unwrap_or_default();
        let mut t = VirtualTime::ZERO;
        let mut due = Instant::now() + period;
        while t < until && !stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
            match self.clock {
                Clock::Grid => {
                    std::thread::sleep(due.saturating_duration_since(Instant::now()));
                    due += period;
                }
                Clock::Pause => std::thread::sleep(period),
            }
            t = t + self.period;
            self.inputs.copy_to(&mut inputs);
            self.client.turn(t, &inputs, &mut outputs).map_err(|fault| Halt { t, fault })?;
            self.outputs.copy_from(&outputs);
            self.recorded.push(outputs.clone());
            self.reached = t;
        }
        Ok(())
    }
}
