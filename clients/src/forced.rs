//! A client some of whose outputs are held for a time, as an operator forces a signal.
//!
//! The client inside knows nothing of it: what it reads and what it remembers are its own; only what
//! the others see is changed. A force that begins between two turns of the client is seen from the
//! next turn on.

use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::signal::{PortLayout, SignalName};
use onescan_server::time::VirtualTime;

/// A signal that is held.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Force {
    /// The signal.
    pub signal: SignalName,
    /// From this instant on,
    pub from: VirtualTime,
    /// before this one; for ever if absent.
    pub until: Option<VirtualTime>,
    /// The value in the bytes of its type.
    pub bytes: Vec<u8>,
}

impl Force {
    fn holds_at(&self, t_v: VirtualTime) -> bool {
        self.from <= t_v && self.until.is_none_or(|until| t_v < until)
    }
}

/// A client with forces on its outputs.
pub struct Forced {
    inner: Box<dyn Client>,
    /// Where each force goes; of two on one signal the later one counts.
    forces: Vec<(usize, Force)>,
    /// What the client itself gave last.
    own: Vec<u8>,
}

impl Forced {
    /// The client with the forces that are on its signals; others are left out, and so are those whose bytes
    /// are not as many as the signal has.
    pub fn new(inner: Box<dyn Client>, forces: &[Force]) -> Self {
        let layout = PortLayout::new(inner.join().writes);
        let mut placed = Vec::new();
        for force in forces {
            let found = layout.iter().find(|(port, _)| port.name == force.signal);
            if let Some((_, offset)) = found.filter(|(port, _)| port.ty.size() == force.bytes.len()) {
                placed.push((offset, force.clone()));
            }
        }
        Self { inner, forces: placed, own: vec![0; layout.size()] }
    }

    fn give(&self, t_v: VirtualTime, outputs: &mut [u8]) -> Result<(), ClientFault> {
        if outputs.len() != self.own.len() {
            let (got, wanted) = (outputs.len(), self.own.len());
            return Err(ClientFault::new(format!("outputs of {got} bytes where {wanted} are wanted")));
        }
        outputs.copy_from_slice(&self.own);
        for (offset, force) in self.forces.iter().filter(|(_, force)| force.holds_at(t_v)) {
            outputs[*offset..offset + force.bytes.len()].copy_from_slice(&force.bytes);
        }
        Ok(())
    }
}

impl Client for Forced {
    fn join(&self) -> JoinRequest {
        self.inner.join()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.own.fill(0);
        self.inner.setup(&mut self.own)?;
        self.give(VirtualTime::ZERO, outputs)
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let wake = self.inner.turn(t_v, inputs, &mut self.own)?;
        self.give(t_v, outputs)?;
        Ok(wake)
    }

    /// What the client itself gave, then its state.
    fn save(&self) -> Result<Vec<u8>, StateError> {
        let mut bytes = self.own.clone();
        bytes.extend(self.inner.save()?);
        Ok(bytes)
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let short = || StateError::Corrupt("it is shorter than the client's outputs".to_owned());
        let (own, inner) = state.split_at_checked(self.own.len()).ok_or_else(short)?;
        self.inner.restore(inner)?;
        self.own.copy_from_slice(own);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::Replay;
    use onescan_server::signal::{ClientName, Port, SignalType};
    use onescan_server::time::TimeSpan;

    fn at(ms: u64) -> VirtualTime {
        VirtualTime::from_nanos(ms * 1_000_000)
    }

    fn forced() -> Forced {
        let port = |name: &str| Port { name: SignalName::new(name).unwrap(), ty: SignalType::USINT };
        let period = TimeSpan::from_millis(1).unwrap();
        let name = ClientName::new("r").unwrap();
        let request = JoinRequest { name, period, reads: vec![], writes: vec![port("x"), port("y")] };
        let recorded = (0..6).map(|number| vec![number, 10 + number]).collect();
        let force = |name: &str, from, until: Option<u64>, value| Force {
            signal: SignalName::new(name).unwrap(),
            from: at(from),
            until: until.map(at),
            bytes: vec![value],
        };
        let forces = [force("y", 2, Some(4), 99), force("x", 4, None, 77), force("z", 0, None, 1)];
        Forced::new(Box::new(Replay::new(request, recorded)), &forces)
    }

    #[test]
    fn a_force_holds_for_its_time_and_no_longer() {
        let mut client = forced();
        let mut outputs = [0; 2];
        client.setup(&mut outputs).unwrap();
        let mut seen = vec![outputs];
        for ms in 1..6 {
            client.turn(at(ms), &[], &mut outputs).unwrap();
            seen.push(outputs);
        }
        assert_eq!(seen, [[0, 10], [1, 11], [2, 99], [3, 99], [77, 14], [77, 15]]);
    }

    #[test]
    fn a_forced_client_goes_on_from_its_state() {
        let (mut one, mut other) = (forced(), forced());
        let (mut of_one, mut of_other) = ([0; 2], [0; 2]);
        one.setup(&mut of_one).unwrap();
        other.setup(&mut of_other).unwrap();
        for ms in 1..4 {
            one.turn(at(ms), &[], &mut of_one).unwrap();
        }
        other.restore(&one.save().unwrap()).unwrap();
        for ms in 4..6 {
            one.turn(at(ms), &[], &mut of_one).unwrap();
            other.turn(at(ms), &[], &mut of_other).unwrap();
            assert_eq!(of_one, of_other);
        }
        assert!(other.restore(&[1]).is_err());
    }
}
