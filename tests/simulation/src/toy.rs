//! A client whose every turn depends on all it ever saw: any difference between two runs shows.

use onescan_base::signal_type::STRING_CAPACITY_MAX;
use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::signal::{ClientName, PortLayout, SignalType, Slot};
use onescan_server::time::{TimeSpan, VirtualTime};

use crate::{client, plan, port};

/// Mixes its inputs and `t_v` into one number and writes it.
pub struct Mixer {
    request: JoinRequest,
    state: u64,
    inputs: Vec<Slot<u64>>,
    output: Slot<u64>,
    /// Turn at which it fails, if it is to fail.
    pub fails_at: Option<VirtualTime>,
}

impl Mixer {
    /// A client `name` that reads the outputs of `reads` and writes its own, `<name>.out`.
    pub fn new(name: &str, period: TimeSpan, reads: &[&str]) -> Self {
        let reads = reads.iter().map(|other| port(&format!("{other}.out"), SignalType::ULINT)).collect();
        let writes = vec![port(&format!("{name}.out"), SignalType::ULINT)];
        let request = JoinRequest { name: client(name), period, reads, writes };
        let layout = PortLayout::new(request.reads.clone());
        let inputs = request.reads.iter().map(|port| layout.slot(port.name.as_str()).expect("own port")).collect();
        let output = PortLayout::new(request.writes.clone()).slot(&format!("{name}.out")).expect("own port");
        Self { request, state: 0, inputs, output, fails_at: None }
    }
}

fn mix(state: u64, value: u64) -> u64 {
    (state ^ value).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
}

impl Client for Mixer {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.state = self.request.name.as_str().bytes().fold(1, |state, byte| mix(state, u64::from(byte)));
        self.output.set(outputs, self.state);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        if self.fails_at.is_some_and(|at| t_v >= at) {
            return Err(ClientFault::new("asked to fail"));
        }
        let seen = self.inputs.iter().map(|slot| slot.get(inputs));
        self.state = seen.fold(mix(self.state, t_v.as_nanos()), mix);
        self.output.set(outputs, self.state);
        Ok(Wake::NextPeriod)
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Ok(self.state.to_le_bytes().to_vec())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let bytes = state.try_into().map_err(|_| StateError::Corrupt("8 bytes are needed".to_owned()))?;
        self.state = u64::from_le_bytes(bytes);
        Ok(())
    }
}

/// Three mixers in a ring, with periods of 1, 2 and 3 steps of 10 ms, in this order of names.
pub const RING: [(&str, u64); 3] = [("alpha", 10), ("beta", 20), ("gamma", 30)];

/// The plan of the ring.
pub fn ring_plan(coupling: &Coupling<ClientName>) -> SessionPlan {
    let names: Vec<String> = RING.iter().map(|(name, _)| format!("{name}.out")).collect();
    let signals: Vec<_> =
        RING.iter().zip(&names).map(|((writer, _), name)| (name.as_str(), SignalType::ULINT, *writer)).collect();
    plan(crate::span_ms(10), coupling, &signals, &RING.map(|(name, _)| name))
}

/// The ring's clients; each reads the two others.
pub fn ring() -> Vec<Mixer> {
    let others = |own: &str| RING.map(|(name, _)| name).into_iter().filter(|name| *name != own).collect::<Vec<_>>();
    RING.iter().map(|(name, ms)| Mixer::new(name, crate::span_ms(*ms), &others(name))).collect()
}

/// A client that writes long texts, which change with every step.
pub struct Wide {
    request: JoinRequest,
}

impl Wide {
    /// One that writes so many signals of the longest texts, and takes a turn every `step_ms`.
    pub fn new(signals: usize, step_ms: u64) -> Self {
        let ty = SignalType::string(STRING_CAPACITY_MAX).expect("the longest");
        let writes = (0..signals).map(|number| port(&format!("wide.text{number:02}"), ty)).collect();
        Self {
            request: JoinRequest { name: client("wide"), period: crate::span_ms(step_ms), reads: Vec::new(), writes },
        }
    }

    /// The plan of a session of it alone.
    pub fn plan(&self) -> SessionPlan {
        let signals: Vec<_> = self.request.writes.iter().map(|port| (port.name.as_str(), port.ty, "wide")).collect();
        plan(self.request.period, &Coupling::Parallel, &signals, &["wide"])
    }

    fn write(&self, t_v: VirtualTime, outputs: &mut [u8]) {
        let stamp = t_v.as_nanos().to_string();
        let length = outputs.len() / self.request.writes.len();
        for text in outputs.chunks_exact_mut(length) {
            text[..stamp.len()].copy_from_slice(stamp.as_bytes());
        }
    }
}

impl Client for Wide {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        outputs.fill(0);
        self.write(VirtualTime::ZERO, outputs);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, _inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.write(t_v, outputs);
        Ok(Wake::NextPeriod)
    }
}
