//! One run without lockstep: in real time, or in computed time by a seed, then replayed so that it is digested and recorded like
//! any other.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use onescan_base::threads;
use onescan_scenario::compose::Member;
use onescan_scenario::{Mode, Scenario};
use onescan_server::end::SessionEnd;
use onescan_server::lockstep::{Lockstep, Outcome};
use onescan_server::random::seed_for;

use super::config::RunConfig;
use super::error::RunError;
use super::progress::Progress;
use crate::error::Usage;
use crate::freewheel::model::Clocks;
use crate::freewheel::run::{Clock, Freewheeler, Trace};
use crate::interrupt::Interrupt;

/// Runs the scenario once; `watch` adds observers to the replay. Beside its outcome it gives how far a plant that follows was
/// behind the PLC at each communication, ns.
pub(super) fn run(
    config: &RunConfig,
    scenario: &Scenario,
    number: u32,
    interrupt: &Interrupt,
    watch: impl FnOnce(&mut Lockstep),
) -> Result<(Outcome, Vec<i64>), RunError> {
    let clients = clients(config.mode, scenario)?;
    interrupt.watch();
    let clocks = config.seed.map(|seed| clocks(scenario, seed, number));
    let Trace { mut replay, reached, failed, errors_ns } =
        spin(config, scenario, (number, clocks), interrupt, clients)?;
    replay.set_until(Some(reached));
    watch(&mut replay);
    let outcome = replay.run()?;
    let outcome = match failed {
        Some(end) => Outcome { end, ..outcome },
        None if interrupt.is_raised() => Outcome { end: SessionEnd::Stopped { t_v: outcome.t_v }, ..outcome },
        None => outcome,
    };
    Ok((outcome, errors_ns))
}

/// The clients of a scenario, each with the clock that it keeps.
///
/// # Errors
/// A client that cannot be made, or that can only take part in lockstep.
pub(crate) fn clients(mode: Mode, scenario: &Scenario) -> Result<Vec<Freewheeler>, RunError> {
    let mut clients = Vec::new();
    for name in scenario.plan().clients() {
        if let Some(client) = scenario.free_gateway(name) {
            clients.push(Freewheeler::new(client?, Clock::Grid));
            continue;
        }
        match scenario.member(name)? {
            Member::Plant(client) => clients.push(Freewheeler::new(client, plant_clock(mode, scenario))),
            Member::Plc(client) => clients.push(Freewheeler::new(client, Clock::Grid)),
            Member::Gateway(_) | Member::External(_) | Member::Seated { .. } => {
                return Err(Usage::new(format!("client `{name}` can only take part in lockstep"), None).into());
            }
        }
    }
    Ok(clients)
}

/// The clocks of the run of this number, computed from a seed.
pub(crate) fn clocks(scenario: &Scenario, seed: u64, number: u32) -> Clocks {
    Clocks { model: scenario.file().freewheel.model, seed: seed_for(seed, "run", &number.to_string()) }
}

/// How a plant keeps its cycle.
fn plant_clock(mode: Mode, scenario: &Scenario) -> Clock {
    match mode {
        Mode::Halt => Clock::Halt,
        Mode::Follow => {
            let link = &scenario.file().freewheel;
            Clock::Follow { rate: link.update_rate, gain_pct: link.synchronizer_gain_pct }
        }
        Mode::Lockstep | Mode::Freewheel => Clock::Pause,
    }
}

/// Lets the clients run, with a bar beside them that follows the wall clock.
fn spin(
    config: &RunConfig,
    scenario: &Scenario,
    (number, clocks): (u32, Option<Clocks>),
    interrupt: &Interrupt,
    clients: Vec<Freewheeler>,
) -> Result<Trace, RunError> {
    let end = config.subject.end(scenario);
    let done = AtomicBool::new(false);
    let started = Instant::now();
    std::thread::scope(|scope| {
        if config.reports.progress && clocks.is_none() {
            let (label, done) = (format!("run {number}/{}", config.runs), &done);
            let shown = threads::start_in(scope, "progress", move || {
                let bar = Progress::new(end, label);
                while !done.load(Ordering::Relaxed) {
                    bar.show(started.elapsed());
                    std::thread::sleep(Duration::from_millis(100));
                }
                bar.clear();
            });
            if let Err(error) = shown {
                tracing::warn!("there is no progress bar: {error}");
            }
        }
        let stop = interrupt.flag();
        let trace = crate::freewheel::run::run(
            scenario.plan(),
            clients,
            (&scenario.file().freewheel, scenario.timeline()),
            (end, clocks),
            stop,
        );
        done.store(true, Ordering::Relaxed);
        Ok(trace?)
    })
}
