//! A PLC that is not driven: its inputs written and its outputs read at a rate of the client's own, as an OPC client
//! does (`[SDSP]` secs. II-C and III). It exists to show what the handshake removes.

use std::time::{Duration, Instant};

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::time::VirtualTime;

use super::answer::Answer;
use super::contact;
use super::exchange::{Direction, Exchange, Words};
use super::fault::GatewayFault;
use super::handshake::Report;
use super::link::Link;

/// How long a turn waits for changes on a link that is notified of them.
const GLANCE: Duration = Duration::from_millis(1);
/// How long a PLC may take for its first cycle, in which its scheduler says whether it is simulated.
const FIRST_CYCLE: Duration = Duration::from_secs(1);

/// A PLC on its own clock, whose program is not simulated (`SDSP_Simulated` is FALSE).
pub struct FreeGateway {
    request: JoinRequest,
    exchange: Exchange,
    link: Box<dyn Link>,
    /// How long the PLC is waited for at first.
    patience: Duration,
    to_plc: Vec<u8>,
    from_plc: Vec<u8>,
}

impl FreeGateway {
    /// A client that speaks over `link`, and waits for the PLC as long as `patience` at first. The words of the handshake stay 0.
    pub fn new(request: JoinRequest, exchange: Exchange, link: Box<dyn Link>, patience: Duration) -> Self {
        let (to_plc, from_plc) = (vec![0; exchange.size(Direction::ToPlc)], vec![0; exchange.size(Direction::FromPlc)]);
        Self { request, exchange, link, patience, to_plc, from_plc }
    }

    /// A PLC in lockstep would stand still for the whole run, and every run be equal to every other.
    fn must_be_free(&mut self) -> Result<(), GatewayFault> {
        // A program that is not instrumented cannot be in lockstep.
        if self.exchange.words() == Words::Absent {
            return Ok(());
        }
        let deadline = Instant::now() + FIRST_CYCLE;
        let mut last = Report::default();
        while Instant::now() < deadline {
            if self.link.read(GLANCE, &mut self.from_plc)? {
                last = self.exchange.report(&self.from_plc);
            }
            match last.answer {
                Answer::NotSimulated => return Ok(()),
                // What it says before its scheduler has run for the first time, or in no session.
                Answer::Ready if last.joined == 0 => {}
                _ => break,
            }
        }
        Err(GatewayFault::InLockstep { answer: last.answer.word() })
    }

    fn exchange(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        let fault = |fault: super::fault::LinkFault| ClientFault::new(fault.to_string());
        self.link.write(&self.to_plc).map_err(fault)?;
        // A PLC that says nothing has changed nothing.
        self.link.read(GLANCE, &mut self.from_plc).map_err(fault)?;
        outputs.copy_from_slice(&self.from_plc[self.exchange.outputs()]);
        Ok(())
    }
}

impl Client for FreeGateway {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        // What the PLC shows already comes as a change, in the first turn.
        outputs.fill(0);
        let contact = contact::connect(&mut *self.link, self.request.name.as_str(), self.patience);
        contact.map_err(|fault| ClientFault::new(fault.to_string()))?;
        self.must_be_free().map_err(|fault| ClientFault::new(fault.to_string()))
    }

    fn turn(&mut self, _t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.exchange.put_inputs(inputs, &mut self.to_plc);
        self.exchange(outputs)?;
        Ok(Wake::NextPeriod)
    }
}
