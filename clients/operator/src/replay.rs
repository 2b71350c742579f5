//! A client that repeats what another once did: outputs recorded turn by turn.

use onescan_server::client::{Client, ClientFault, ClientView, JoinRequest, Parts, Pose, StateError, Wake};
use onescan_server::time::VirtualTime;

/// Gives recorded outputs, whatever it reads.
pub struct Replay {
    request: JoinRequest,
    /// The initial outputs, then those of each turn.
    recorded: Vec<Vec<u8>>,
    /// Where bodies were with the initial outputs, then after each turn; empty if nobody noted it.
    seen: Vec<Vec<Pose>>,
    next: usize,
}

impl Replay {
    /// A client that joins as `request` and gives `recorded`: the initial outputs first, then those
    /// of each turn. After the last it keeps them.
    pub fn new(request: JoinRequest, recorded: Vec<Vec<u8>>) -> Self {
        Self { request, recorded, seen: Vec::new(), next: 0 }
    }

    /// The same that shows where bodies were: with the initial outputs first, then after each turn.
    #[must_use]
    pub fn showing(self, seen: Vec<Vec<Pose>>) -> Self {
        Self { seen, ..self }
    }

    fn give(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        if let Some(recorded) = self.recorded.get(self.next) {
            if recorded.len() != outputs.len() {
                let (got, expected) = (recorded.len(), outputs.len());
                return Err(ClientFault::new(format!(
                    "turn {} was recorded with {got} bytes, not {expected}",
                    self.next
                )));
            }
            outputs.copy_from_slice(recorded);
            self.next += 1;
        }
        Ok(())
    }
}

impl Client for Replay {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.next = 0;
        self.give(outputs)
    }

    fn turn(&mut self, _t_v: VirtualTime, _inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.give(outputs).map(|()| Wake::NextPeriod)
    }

    fn show(&self, parts: Parts, view: &mut ClientView) {
        let seen = self.next.checked_sub(1).and_then(|last| self.seen.get(last));
        if let Some(poses) = seen.filter(|_| parts.poses) {
            view.poses.extend(poses.iter().cloned());
        }
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Ok((self.next as u64).to_le_bytes().to_vec())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let bytes = state.try_into().map_err(|_| StateError::Corrupt("8 bytes are needed".to_owned()))?;
        let next = usize::try_from(u64::from_le_bytes(bytes)).ok().filter(|next| *next <= self.recorded.len());
        self.next = next.ok_or_else(|| StateError::Corrupt("beyond the recording".to_owned()))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_server::signal::{ClientName, Port, SignalName, SignalType};
    use onescan_server::time::TimeSpan;

    fn replay() -> Replay {
        let writes = vec![Port { name: SignalName::new("x").unwrap(), ty: SignalType::USINT }];
        let period = TimeSpan::from_millis(1).unwrap();
        let request = JoinRequest { name: ClientName::new("r").unwrap(), period, reads: vec![], writes };
        Replay::new(request, vec![vec![1], vec![2], vec![3]])
    }

    #[test]
    fn it_repeats_and_then_holds() {
        let mut client = replay();
        let mut outputs = [0];
        client.setup(&mut outputs).unwrap();
        let mut seen = vec![outputs[0]];
        for _ in 0..4 {
            client.turn(VirtualTime::ZERO, &[], &mut outputs).unwrap();
            seen.push(outputs[0]);
        }
        assert_eq!(seen, [1, 2, 3, 3, 3]);
    }

    #[test]
    fn it_goes_on_from_a_saved_state() {
        let mut client = replay();
        let mut outputs = [0];
        client.setup(&mut outputs).unwrap();
        client.turn(VirtualTime::ZERO, &[], &mut outputs).unwrap();
        let state = client.save().unwrap();
        let mut other = replay();
        other.restore(&state).unwrap();
        other.turn(VirtualTime::ZERO, &[], &mut outputs).unwrap();
        assert_eq!(outputs, [3]);
        assert!(other.restore(&9_u64.to_le_bytes()).is_err());
        assert!(other.restore(b"cut").is_err());
    }
}
