//! Free-wheeling in computed time: the clocks that differ in reality are drawn by a seed, and what happens next is the event
//! that comes first. So the runs of one seed are equal on every machine, and those of different seeds are not.
//!
//! Time is that of the PC on which plant and link run. The PLC is exact on a grid of its own, which begins somewhere in its
//! cycle and drifts by the skew of the two clocks. What sleeps on the PC wakes at a tick of its timer, and late by a part
//! of N(µ, σ); a plant that is *halted* polls the clock and waits for no tick. Computing takes no time.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};

use onescan_scenario::file::ClockModelFile;
use onescan_server::client::JoinRequest;
use onescan_server::random::{Random, seed_for};
use onescan_server::time::VirtualTime;

use super::link::{Exchange, OpcLink};
use super::synchronizer::Synchronizer;
use super::wheel::{Clock, Cycle, Halt, Wheel};

const NS_PER_US: f64 = 1_000.0;
const PER_MILLION: f64 = 1e-6;

/// The clocks of one run.
#[derive(Clone, Copy, Debug)]
pub struct Clocks {
    pub model: ClockModelFile,
    pub seed: u64,
}

/// What sleeps on the PC, and how it wakes.
struct Sleeper {
    random: Random,
    model: ClockModelFile,
}

impl Sleeper {
    fn new(clocks: Clocks, kind: &str, name: &str) -> Self {
        Self { random: Random::new(seed_for(clocks.seed, kind, name)), model: clocks.model }
    }

    /// A moment within the first `span_ns`.
    fn phase_ns(&mut self, span_ns: u64) -> u64 {
        (self.random.uniform() * span_ns as f64) as u64
    }

    /// How late it is, ns.
    fn late_ns(&mut self) -> u64 {
        let ClockModelFile { late_mean_us, late_sigma_us, .. } = self.model;
        let late_us = f64::from(late_mean_us) + f64::from(late_sigma_us) * self.random.normal();
        // a cast from a negative number is 0
        (late_us * NS_PER_US).round() as u64
    }

    /// When a sleep ends that is to end at `due_ns`.
    fn wakes_ns(&mut self, due_ns: u64) -> u64 {
        let tick_ns = u64::from(self.model.timer_us) * 1_000;
        self.notices_ns(if tick_ns == 0 { due_ns } else { due_ns.div_ceil(tick_ns).saturating_mul(tick_ns) })
    }

    /// When somebody notices `due_ns` who polls the clock.
    fn notices_ns(&mut self, due_ns: u64) -> u64 {
        due_ns.saturating_add(self.late_ns())
    }
}

/// A client between its events.
struct Spinning<'w> {
    wheel: &'w mut Wheel,
    cycle: Cycle,
    synchronizer: Synchronizer,
    sleeper: Sleeper,
    /// When its grid begins.
    begin_ns: u64,
    /// Which point of its grid is next, if it keeps one.
    next: u64,
}

impl<'w> Spinning<'w> {
    fn new(wheel: &'w mut Wheel, request: &JoinRequest, clocks: Clocks) -> Self {
        let mut sleeper = Sleeper::new(clocks, "client", request.name.as_str());
        let begin_ns = match wheel.clock {
            Clock::Grid => sleeper.phase_ns(wheel.period.as_nanos()),
            Clock::Halt | Clock::Pause | Clock::Follow { .. } => 0,
        };
        let (cycle, synchronizer) = (wheel.cycle(), wheel.synchronizer());
        Self { wheel, cycle, synchronizer, sleeper, begin_ns, next: 1 }
    }

    /// When its next event comes after one at `now_ns`.
    fn due_ns(&mut self, now_ns: u64) -> u64 {
        let period_ns = self.wheel.period.as_nanos();
        match self.wheel.clock {
            Clock::Grid => {
                let faster = 1.0 - f64::from(self.sleeper.model.clock_skew_ppm) * PER_MILLION;
                let passed_ns = (self.next as f64 * period_ns as f64 * faster).round() as u64;
                self.next += 1;
                self.begin_ns.saturating_add(passed_ns)
            }
            Clock::Halt => {
                let due_ns = period_ns.saturating_mul(self.next);
                self.next += 1;
                // One that was too late goes on at once.
                self.sleeper.notices_ns(due_ns).max(now_ns)
            }
            Clock::Pause => self.sleeper.wakes_ns(now_ns.saturating_add(period_ns)),
            Clock::Follow { rate, .. } => self.sleeper.wakes_ns(now_ns.saturating_add(rate.as_nanos())),
        }
    }

    /// What it does at its event.
    fn act(&mut self, until: VirtualTime) -> Result<(), Halt> {
        let Clock::Follow { .. } = self.wheel.clock else { return self.wheel.turn(&mut self.cycle) };
        self.wheel.communicate(&mut self.synchronizer, self.cycle.t);
        while self.cycle.t < until && self.synchronizer.may_step(self.cycle.t.as_nanos()) {
            self.wheel.turn(&mut self.cycle)?;
        }
        Ok(())
    }
}

/// A link between its events.
struct Carrying<'l> {
    link: &'l OpcLink,
    exchange: Exchange,
    next_update_ns: u64,
    sleeper: Sleeper,
}

impl<'l> Carrying<'l> {
    fn new(link: &'l OpcLink, request: &JoinRequest, clocks: Clocks) -> Self {
        let mut sleeper = Sleeper::new(clocks, "link", request.name.as_str());
        let next_update_ns = sleeper.phase_ns(nanos(link.update_rate));
        Self { exchange: Exchange::begin(link), link, next_update_ns, sleeper }
    }

    /// What it does at its event; gives when the next one comes.
    fn act(&mut self, now_ns: u64) -> u64 {
        self.exchange.deliver(self.link);
        if now_ns >= self.next_update_ns {
            self.exchange.look(self.link);
            self.next_update_ns = now_ns.saturating_add(nanos(self.link.update_rate));
        }
        let due_ns = if self.exchange.carry() {
            now_ns.saturating_add(nanos(self.link.item_transfer))
        } else {
            self.next_update_ns
        };
        self.sleeper.wakes_ns(due_ns)
    }
}

fn nanos(span: std::time::Duration) -> u64 {
    u64::try_from(span.as_nanos()).unwrap_or(u64::MAX)
}

/// A client that stopped before its time.
pub(super) struct Halted {
    /// Its number among the clients.
    pub(super) client: usize,
    pub(super) halt: Halt,
}

/// Lets all clients and links run until each client's own clock has come to `until`, or until `stop`.
pub(super) fn spin(
    wheels: &mut [Wheel],
    links: &[OpcLink],
    requests: &[JoinRequest],
    (until, clocks): (VirtualTime, Clocks),
    stop: &AtomicBool,
) -> Option<Halted> {
    let clients = wheels.iter_mut().zip(requests);
    let mut spinning: Vec<Spinning<'_>> =
        clients.map(|(wheel, request)| Spinning::new(wheel, request, clocks)).collect();
    let mut carrying: Vec<Carrying<'_>> =
        links.iter().zip(requests).map(|(link, request)| Carrying::new(link, request, clocks)).collect();
    // By time, and what comes at one time by number, clients before links.
    let mut events: BTreeSet<(u64, usize)> = BTreeSet::new();
    for (number, client) in spinning.iter_mut().enumerate() {
        events.insert((client.due_ns(0), number));
    }
    for (number, link) in carrying.iter().enumerate() {
        events.insert((link.next_update_ns, spinning.len() + number));
    }
    let mut turning = spinning.iter().filter(|client| client.cycle.t < until).count();
    while let Some((now_ns, number)) = events.pop_first().filter(|_| turning > 0 && !stop.load(Ordering::Relaxed)) {
        let Some(client) = spinning.get_mut(number) else {
            let Some(link) = carrying.get_mut(number - spinning.len()) else { continue };
            events.insert((link.act(now_ns), number));
            continue;
        };
        if let Err(halt) = client.act(until) {
            return Some(Halted { client: number, halt });
        }
        if client.cycle.t < until {
            events.insert((client.due_ns(now_ns), number));
        } else {
            turning -= 1;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sleeper(timer_us: u32, late_mean_us: u32, late_sigma_us: u32) -> Sleeper {
        let model = ClockModelFile { clock_skew_ppm: 0, timer_us, late_mean_us, late_sigma_us };
        Sleeper::new(Clocks { model, seed: 1 }, "client", "plant")
    }

    #[test]
    fn a_sleep_ends_at_a_tick_and_never_early() {
        let mut coarse = sleeper(15_600, 0, 0);
        assert_eq!([1, 15_600_000, 15_600_001].map(|due| coarse.wakes_ns(due)), [15_600_000, 15_600_000, 31_200_000]);
        assert_eq!(sleeper(0, 0, 0).wakes_ns(7), 7);
        let mut late = sleeper(0, 200, 300);
        let waits: Vec<u64> = (0..10_000).map(|_| late.wakes_ns(0)).collect();
        // N(200, 300) µs without its tail below 0, which has a quarter of it.
        let mean = waits.iter().sum::<u64>() as f64 / 1e7;
        assert!((mean - 245.0).abs() < 10.0, "{mean} us");
        assert!(waits.iter().filter(|wait| **wait == 0).count() > 2_000);
    }
}
