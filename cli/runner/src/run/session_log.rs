//! The session log: how long each client took for its turns, wall clock, and which of them the session waited for
//! most. It looks on; nothing of it is in a digest.

use std::io::Write;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use hdrhistogram::Histogram;
use onescan_server::client::{
    Client, ClientFault, ClientOperation, ClientView, JoinRequest, OperationRefused, Parts, StateError, Wake,
};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use serde::Serialize;

/// Slowest turns that are named.
const SLOWEST: usize = 3;
/// Longest turn that the histogram can distinguish from a longer one, ns.
const LONGEST_NS: u64 = 3_600_000_000_000;

/// Turns of all watched clients of a run.
#[derive(Clone, Default)]
pub struct SessionLog {
    clients: Arc<Mutex<Vec<Turns>>>,
}

/// Turns of one client.
struct Turns {
    client: ClientName,
    /// Durations in ns, to three digits.
    durations: Histogram<u64>,
    total: Duration,
    slowest: Vec<SlowTurn>,
}

/// A turn that took long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SlowTurn {
    /// Virtual time of its end.
    #[serde(rename = "virtual_time_ns")]
    pub t_v: VirtualTime,
    /// How long it took, wall clock.
    pub took_us: u64,
}

/// What a report says of one client's turns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClientLatency {
    pub client: String,
    /// Turns that it took.
    pub turns: u64,
    /// Half of the turns took no longer.
    pub p50_us: f64,
    /// All but one of a hundred took no longer.
    pub p99_us: f64,
    pub max_us: f64,
    /// Its part of all the time that the session waited for clients, 0 to 1.
    pub share: f64,
    /// The slowest turns, the slowest first.
    pub slowest: Vec<SlowTurn>,
}

impl SessionLog {
    /// The same client, with its turns noted here.
    pub fn watch(&self, client: Box<dyn Client>) -> Box<dyn Client> {
        // Bounds that are constant and right cannot be refused; a client without a histogram is not watched.
        let Ok(durations) = Histogram::new_with_bounds(1, LONGEST_NS, 3) else { return client };
        let name = client.join().name;
        let mut turns = self.lock();
        turns.push(Turns { client: name, durations, total: Duration::ZERO, slowest: Vec::new() });
        let index = turns.len() - 1;
        Box::new(Watched { client, log: self.clone(), index })
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Turns>> {
        self.clients.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn note(&self, index: usize, t_v: VirtualTime, took: Duration) {
        let mut clients = self.lock();
        let Some(turns) = clients.get_mut(index) else { return };
        turns.durations.saturating_record(took.as_nanos() as u64);
        turns.total += took;
        let turn = SlowTurn { t_v, took_us: took.as_micros() as u64 };
        let at = turns.slowest.partition_point(|other| other.took_us >= turn.took_us);
        if at < SLOWEST {
            turns.slowest.insert(at, turn);
            turns.slowest.truncate(SLOWEST);
        }
    }

    /// What there is to say, the client first that the session waited for most.
    pub fn latencies(&self) -> Vec<ClientLatency> {
        let clients = self.lock();
        let all: f64 = clients.iter().map(|turns| turns.total.as_secs_f64()).sum();
        let us = |ns: u64| ns as f64 / 1e3;
        let latency = |turns: &Turns| ClientLatency {
            client: turns.client.to_string(),
            turns: turns.durations.len(),
            p50_us: us(turns.durations.value_at_quantile(0.5)),
            p99_us: us(turns.durations.value_at_quantile(0.99)),
            max_us: us(turns.durations.max()),
            share: if all > 0.0 { turns.total.as_secs_f64() / all } else { 0.0 },
            slowest: turns.slowest.clone(),
        };
        let mut latencies: Vec<ClientLatency> = clients.iter().map(latency).collect();
        latencies.sort_by(|a, b| b.share.total_cmp(&a.share).then_with(|| a.client.cmp(&b.client)));
        latencies
    }

    /// The client that the session waits for most, in a few words for a progress bar.
    pub fn brief(&self) -> Option<String> {
        let first = self.latencies().into_iter().next()?;
        Some(format!("{} {:.0} %, p99 {}", first.client, first.share * 100.0, duration(first.p99_us)))
    }
}

/// Writes the log for people.
///
/// # Errors
/// Those of `out`.
pub fn write(latencies: &[ClientLatency], out: &mut dyn Write) -> std::io::Result<()> {
    for latency in latencies {
        let ClientLatency { client, turns, p50_us, p99_us, max_us, share, slowest } = latency;
        let [p50, p99, max] = [p50_us, p99_us, max_us].map(|us| duration(*us));
        writeln!(
            out,
            "  waited for `{client}` {:.0} % of the time: {turns} turns, p50 {p50}, p99 {p99}, max {max}",
            share * 100.0
        )?;
        if let Some(SlowTurn { t_v, .. }) = slowest.first() {
            writeln!(out, "    slowest at t_v = {t_v}")?;
        }
    }
    Ok(())
}

fn duration(us: f64) -> String {
    if us < 1e3 { format!("{us:.1} us") } else { format!("{:.2} ms", us / 1e3) }
}

/// A client whose turns are noted.
struct Watched {
    client: Box<dyn Client>,
    log: SessionLog,
    index: usize,
}

impl Client for Watched {
    fn join(&self) -> JoinRequest {
        self.client.join()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.client.setup(outputs)
    }

    fn begin(&mut self, operations: &[ClientOperation], outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.client.begin(operations, outputs)
    }

    fn operate(&mut self, operation: &ClientOperation) -> Result<(), OperationRefused> {
        self.client.operate(operation)
    }

    fn can_reset(&self) -> Result<(), OperationRefused> {
        self.client.can_reset()
    }

    fn show(&self, parts: Parts, view: &mut ClientView) {
        self.client.show(parts, view);
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let begun = Instant::now();
        let wake = self.client.turn(t_v, inputs, outputs);
        self.log.note(self.index, t_v, begun.elapsed());
        wake
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        self.client.save()
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        self.client.restore(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_client_that_was_waited_for_comes_first() {
        let log = SessionLog::default();
        for name in ["fast", "slow"] {
            let name = ClientName::new(name).unwrap();
            let durations = Histogram::new_with_bounds(1, LONGEST_NS, 3).unwrap();
            log.lock().push(Turns { client: name, durations, total: Duration::ZERO, slowest: Vec::new() });
        }
        for k in 1..=100_u64 {
            log.note(0, VirtualTime::from_nanos(k), Duration::from_micros(10));
            log.note(1, VirtualTime::from_nanos(k), Duration::from_micros(10 * k));
        }
        let latencies = log.latencies();
        assert_eq!((latencies[0].client.as_str(), latencies[0].turns), ("slow", 100));
        assert!((latencies[0].p50_us - 500.0).abs() < 1.0 && (latencies[0].max_us - 1000.0).abs() < 1.0);
        let slowest: Vec<u64> = latencies[0].slowest.iter().map(|turn| turn.t_v.as_nanos()).collect();
        assert_eq!(slowest, [100, 99, 98]);
        let mut out = Vec::new();
        write(&latencies[..1], &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        insta::assert_snapshot!(text);
    }
}
