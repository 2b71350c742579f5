//! Two clients in lockstep: a counter, and one that doubles what it reads. Run it by
//! `cargo run -p onescan-server --example two_clients`.

#![expect(clippy::print_stdout, reason = "an example is for the terminal")]

use std::error::Error;

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::formation::Formation;
use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::signal::{ClientName, Port, SignalDecl, SignalName, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};

/// A client is a function from inputs and virtual time to outputs. Ports are packed little-endian bytes, in the
/// order of `reads` and `writes`.
struct Arithmetic {
    request: JoinRequest,
    next: fn(i16, read: i16) -> i16,
    value: i16,
}

impl Client for Arithmetic {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        outputs.copy_from_slice(&self.value.to_le_bytes());
        Ok(())
    }

    fn turn(&mut self, _t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let read = inputs.first_chunk().map_or(0, |bytes| i16::from_le_bytes(*bytes));
        self.value = (self.next)(self.value, read);
        outputs.copy_from_slice(&self.value.to_le_bytes());
        Ok(Wake::NextPeriod)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let step: TimeSpan = "10ms".parse()?;
    let (counter, doubler) = (ClientName::new("counter")?, ClientName::new("doubler")?);
    let (count, double) = (SignalName::new("count")?, SignalName::new("double")?);
    let ty = SignalType::INT;
    let signal = |name: &SignalName, writer: &ClientName| SignalDecl {
        name: name.clone(),
        ty,
        writer: Some(writer.clone()),
        unit: None,
    };
    let signals = vec![signal(&count, &counter), signal(&double, &doubler)];
    let plan = SessionPlan::new(step, &Coupling::Parallel, signals, vec![counter.clone(), doubler.clone()])?;

    let port = |name: &SignalName| Port { name: name.clone(), ty };
    let client = |name: ClientName, reads, writes, next| {
        Box::new(Arithmetic { request: JoinRequest { name, period: step, reads, writes }, next, value: 0 })
    };
    let mut formation = Formation::new(plan);
    formation.join(client(counter, vec![], vec![port(&count)], |own, _| own.wrapping_add(1)))?;
    formation.join(client(doubler, vec![port(&count)], vec![port(&double)], |_, read| read.wrapping_mul(2)))?;
    let mut lockstep = formation.start()?;
    lockstep.set_until(Some(VirtualTime::ZERO + "1s".parse()?));
    let outcome = lockstep.run()?;

    // Both read what was committed before the step, so `double` is one step behind.
    let session = lockstep.session();
    println!("{} steps, image {:?}", outcome.steps.0, session.image());
    if let Some(digest) = outcome.digest {
        println!("{digest}");
    }
    Ok(())
}
