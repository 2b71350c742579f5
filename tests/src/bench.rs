//! What benches share: clients that only carry bytes, and a ledger that sets each figure beside its
//! reference of the same run.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Duration;

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::signal::SignalType;
use onescan_server::time::VirtualTime;

use crate::{client, plan, port, span_ms};

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

    /// The median time of one step in seconds.
    fn median(&self, what: &str) -> Option<f64> {
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
