//! The operator: switches, buttons and set points that neither plant nor PLC writes.
//!
//! By itself an operator does nothing: its signals keep their initial values. What it does in a run
//! comes from outside, as operations on the session's timeline.

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
        Ok(Wake::NextPeriod)
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Ok(Vec::new())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        if state.is_empty() { Ok(()) } else { Err(StateError::Corrupt("an operator has no state".to_owned())) }
    }
}
