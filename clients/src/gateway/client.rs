//! Handshake and link as a client of a session.

use std::time::{Duration, Instant};

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::time::VirtualTime;

use super::exchange::{Direction, Exchange};
use super::fault::{GatewayFault, LinkFault};
use super::handshake::{Ask, Handshake, Notice};
use super::link::Link;

/// How long the gateway waits, wall clock. None of it changes what a step computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// For the answer to a grant.
    pub grant: Duration,
    /// For a connection that was lost to come back.
    pub reconnect: Duration,
    /// For a PLC that must be started cold.
    pub start: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self { grant: Duration::from_secs(5), reconnect: Duration::from_secs(10), start: Duration::from_mins(1) }
    }
}

/// An order that is not answered is written again after this; a connection is tried again after this.
const AGAIN: Duration = Duration::from_millis(200);

/// What is said here is for the user, also without `--verbose`.
const NOTICE: &str = "onescan::notice";

/// A real PLC as a client of a session.
pub struct Gateway {
    request: JoinRequest,
    exchange: Exchange,
    link: Box<dyn Link>,
    handshake: Handshake,
    patience: Patience,
    to_plc: Vec<u8>,
    from_plc: Vec<u8>,
}

impl Gateway {
    /// A client that speaks over `link` for the PLC, whose points are those of `exchange`.
    pub fn new(request: JoinRequest, exchange: Exchange, link: Box<dyn Link>, patience: Patience) -> Self {
        let (to_plc, from_plc) = (vec![0; exchange.size(Direction::ToPlc)], vec![0; exchange.size(Direction::FromPlc)]);
        Self { request, exchange, link, handshake: Handshake::new(), patience, to_plc, from_plc }
    }

    /// Connects and checks the mapping, before any session.
    ///
    /// # Errors
    /// See [`LinkFault`].
    pub fn connect(&mut self) -> Result<(), LinkFault> {
        self.link.connect()?;
        self.handshake.connected();
        Ok(())
    }

    /// Does what the handshake asks for until it asks for nothing.
    fn drive(&mut self, patience: Duration) -> Result<(), GatewayFault> {
        let begun = Instant::now();
        let mut deadline = begun + patience;
        let mut lost: Option<Instant> = None;
        let mut written = begun;
        loop {
            let result = match self.handshake.ask() {
                Ask::Nothing => return Ok(()),
                Ask::Connect => self.link.connect().map(|()| {
                    self.handshake.connected();
                    // What the outage took is not the PLC's to answer for.
                    deadline += lost.take().map_or(Duration::ZERO, |since| since.elapsed());
                }),
                Ask::Write(order) => {
                    self.exchange.put(&order, &mut self.to_plc);
                    self.link.write(&self.to_plc).map(|()| {
                        self.handshake.written();
                        written = Instant::now();
                    })
                }
                Ask::Read => self.read(deadline, &mut written)?,
            };
            self.tell();
            match result {
                Ok(()) => {}
                Err(fault) if fault.is_transient() => self.be_lost(&fault, &mut lost)?,
                Err(fault) => return Err(fault.into()),
            }
            if lost.is_none() && self.handshake.ask() != Ask::Nothing && Instant::now() > deadline {
                return Err(self.handshake.late(patience));
            }
        }
    }

    fn read(&mut self, deadline: Instant, written: &mut Instant) -> Result<Result<(), LinkFault>, GatewayFault> {
        let rest = deadline.saturating_duration_since(Instant::now()).clamp(Duration::from_millis(1), AGAIN);
        match self.link.read(rest, &mut self.from_plc) {
            Ok(true) => self.handshake.look(self.exchange.report(&self.from_plc))?,
            Ok(false) => {}
            Err(fault) => return Ok(Err(fault)),
        }
        if written.elapsed() > AGAIN {
            *written = Instant::now();
            self.handshake.quiet();
        }
        Ok(Ok(()))
    }

    /// Notes that the connection is gone; waits a little before it is tried again.
    fn be_lost(&mut self, fault: &LinkFault, lost: &mut Option<Instant>) -> Result<(), GatewayFault> {
        let what = self.handshake.what();
        if lost.is_none() {
            tracing::info!(target: NOTICE, "{fault}, during {what}; connecting again");
        }
        let since = *lost.get_or_insert_with(Instant::now);
        let is_again = self.handshake.ask() == Ask::Connect;
        self.handshake.lost();
        if since.elapsed() > self.patience.reconnect {
            return Err(GatewayFault::NotBack { what, after: self.patience.reconnect, reason: fault.to_string() });
        }
        if is_again {
            std::thread::sleep(AGAIN / 4);
        }
        Ok(())
    }

    fn tell(&mut self) {
        match self.handshake.take_notice() {
            Some(Notice::StartPlc) => {
                tracing::info!(target: NOTICE, "client `{}`: start the PLC cold, for the session to begin", self.request.name);
            }
            Some(Notice::Back) => {
                tracing::info!(target: NOTICE, "connection back, {} is resumed", self.handshake.what());
            }
            None => {}
        }
    }

    fn take_outputs(&self, outputs: &mut [u8]) {
        outputs.copy_from_slice(&self.from_plc[self.exchange.outputs()]);
    }
}

impl Client for Gateway {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.to_plc.fill(0);
        self.handshake.join(VirtualTime::ZERO);
        self.drive(self.patience.start).map_err(|fault| ClientFault::new(fault.to_string()))?;
        self.take_outputs(outputs);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let place = self.exchange.inputs();
        self.to_plc[place].copy_from_slice(inputs);
        let done = self.handshake.grant(t_v).and_then(|()| self.drive(self.patience.grant));
        done.map_err(|fault| ClientFault::new(fault.to_string()))?;
        self.take_outputs(outputs);
        Ok(Wake::NextPeriod)
    }
}
