//! The operator: switches, buttons and set points that neither plant nor PLC writes.
//!
//! By itself an operator does nothing: its signals keep their initial values. What it does in a run
//! comes from outside, as operations on the session's timeline. So it sleeps: a client that had turns would write its
//! initial values in each, and a switch that somebody has turned would turn back by itself.

use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::signal::{ClientName, Port};
use onescan_server::time::{TimeSpan, VirtualTime};

/// A client whose signals keep their initial values.
pub struct Operator {
    request: JoinRequest,
    initial: Vec<u8>,
}

impl Operator {
    /// An operator of these signals, each with its initial value in the bytes of its type.
    pub fn new(name: ClientName, period: TimeSpan, signals: Vec<(Port, Vec<u8>)>) -> Self {
        let (writes, values): (Vec<Port>, Vec<Vec<u8>>) = signals.into_iter().unzip();
        Self { request: JoinRequest { name, period, reads: Vec::new(), writes }, initial: values.concat() }
    }
}

impl Operator {
    /// The last virtual time on the session's grid, which no session reaches.
    fn never(&self) -> VirtualTime {
        let step = self.request.period.as_nanos();
        VirtualTime::from_nanos(u64::MAX - u64::MAX % step)
    }
}

impl Client for Operator {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        if outputs.len() != self.initial.len() {
            let (got, wanted) = (outputs.len(), self.initial.len());
            return Err(ClientFault::new(format!("outputs of {got} bytes where {wanted} are wanted")));
        }
        outputs.copy_from_slice(&self.initial);
        Ok(())
    }

    fn turn(&mut self, _t_v: VirtualTime, _inputs: &[u8], _outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        Ok(Wake::At(self.never()))
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Ok(Vec::new())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        if state.is_empty() { Ok(()) } else { Err(StateError::Corrupt("an operator has no state".to_owned())) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_operator_sleeps_on_the_grid_of_the_session() {
        for step_ns in [1, 3, 10_000_000, u64::MAX] {
            let step = TimeSpan::from_nanos(step_ns).unwrap();
            let mut operator = Operator::new(ClientName::new("hand").unwrap(), step, Vec::new());
            let Ok(Wake::At(at)) = operator.turn(VirtualTime::ZERO + step, &[], &mut []) else { panic!("no sleep") };
            assert!(at.is_multiple_of(step) && at.as_nanos() > u64::MAX / 2, "{step_ns}");
        }
    }
}
