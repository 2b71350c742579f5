//! What benches share: clients that only carry bytes, and a ledger that sets each figure beside its
//! reference of the same run.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Duration;

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::formation::Formation;
use onescan_server::lockstep::Lockstep;
use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::signal::{ClientName, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_server::timeline::Timeline;

use crate::{client, plan, port, span_ms};

/// A session of a scenario with all of its clients in this process, and what its case does, for so long.
///
/// # Panics
/// The scenario does not compile, or has a client elsewhere.
pub fn session_of(scenario: &Scenario, until_s: u64) -> Lockstep {
    let mut formation = Formation::new(scenario.plan().clone());
    for name in scenario.plan().clients() {
        match scenario.member(name).expect("it compiles") {
            Member::Plc(client) | Member::Plant(client) => formation.join(client).expect("a place"),
            _ => panic!("`{name}` is not a client of this process"),
        };
    }
    let mut lockstep = formation.start().expect("all have joined");
    lockstep.set_until(Some(VirtualTime::from_nanos(until_s * 1_000_000_000)));
    let timeline = Timeline::new(scenario.timeline().to_vec(), lockstep.session());
    lockstep.set_timeline(timeline.expect("inputs of signals that are there"));
    lockstep
}

/// Carries bytes from its inputs to its outputs, as cheaply as can be.
pub struct Carrier {
    request: JoinRequest,
}

impl Client for Carrier {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, _outputs: &mut [u8]) -> Result<(), ClientFault> {
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        outputs.copy_from_slice(inputs);
        if let Some(first) = outputs.first_mut() {
            *first ^= t_v.as_nanos() as u8;
        }
        Ok(Wake::NextPeriod)
    }
}

/// A plan and two carriers that give each other `bytes` bytes a step, a multiple of 4.
pub fn two_carriers(bytes: usize) -> (SessionPlan, [Carrier; 2]) {
    let names = ["plant", "plc"];
    let signals: Vec<Vec<String>> =
        names.iter().map(|name| (0..bytes / 4).map(|i| format!("{name}.{i:04}")).collect()).collect();
    let declared: Vec<_> = names
        .iter()
        .zip(&signals)
        .flat_map(|(name, signals)| signals.iter().map(|s| (s.as_str(), SignalType::DWORD, *name)))
        .collect();
    let ports = |of: usize| signals[of].iter().map(|s| port(s, SignalType::DWORD)).collect::<Vec<_>>();
    let carrier = |own: usize| Carrier {
        request: JoinRequest {
            name: client(names[own]),
            period: span_ms(1),
            reads: ports(1 - own),
            writes: ports(own),
        },
    };
    (plan(span_ms(1), &Coupling::Parallel, &declared, &names), [carrier(0), carrier(1)])
}

/// Times per step, by what was measured.
#[derive(Default)]
pub struct Ledger {
    times: Mutex<BTreeMap<&'static str, Vec<f64>>>,
}

impl Ledger {
    /// Notes one measurement of `steps` steps.
    pub fn note(&self, what: &'static str, time: Duration, steps: u64) {
        let per_step = time.as_secs_f64() / steps as f64;
        self.times.lock().expect("no panic while noting").entry(what).or_default().push(per_step);
    }

    /// The median time of one step in seconds; nothing if it was not measured.
    pub fn median(&self, what: &str) -> Option<f64> {
        let times = self.times.lock().expect("no panic while noting");
        let mut times = times.get(what)?.clone();
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
    }

    /// A line: steps a second, and the ratio to the reference.
    pub fn compare(&self, what: &str, reference: &str) {
        if let (Some(time), Some(bare)) = (self.median(what), self.median(reference)) {
            let (rate, bare_rate) = (1.0 / time, 1.0 / bare);
            let ratio = 100.0 * rate / bare_rate;
            println!("{what:28} {rate:>12.0} steps/s   {reference:28} {bare_rate:>12.0} /s   {ratio:5.1} %");
        }
    }
}

/// Counts its turns on one signal, and sleeps so long between two.
pub struct Sleeper {
    name: &'static str,
    sleep: TimeSpan,
}

impl Client for Sleeper {
    fn join(&self) -> JoinRequest {
        let writes = vec![port(self.name, SignalType::ULINT)];
        JoinRequest { name: client(self.name), period: span_ms(1), reads: vec![], writes }
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        outputs.fill(0);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, _inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let count = outputs.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes)) + 1;
        outputs.copy_from_slice(&count.to_le_bytes());
        Ok(t_v.checked_add(self.sleep).map_or(Wake::NextPeriod, Wake::At))
    }
}

/// A plan of steps of 1 ms, and two clients that each sleep so many of them.
pub fn two_sleepers(coupling: &Coupling<ClientName>, sleeps: [u64; 2]) -> (SessionPlan, [Sleeper; 2]) {
    let names = ["plant", "plc"];
    let declared = names.map(|name| (name, SignalType::ULINT, name));
    let sleeper = |index: usize| Sleeper { name: names[index], sleep: span_ms(sleeps[index]) };
    (plan(span_ms(1), coupling, &declared, &names), [sleeper(0), sleeper(1)])
}
