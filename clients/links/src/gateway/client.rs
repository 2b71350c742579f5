//! Handshake and link as a client of a session.

use onescan_base::notice::NOTICE;
use std::time::{Duration, Instant};

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::time::VirtualTime;

use super::contact;
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

/// A PLC that answers sooner is asked without a pause.
const SOON: Duration = Duration::from_micros(500);

/// The longest pause between two questions: a PLC that has answered must get its next order within its cycle.
const PAUSE_MAX: Duration = Duration::from_millis(1);

/// Answers to one order that cannot be understood before the run ends: one may be garbled on its way, whatever the link.
pub(super) const GARBLED_MAX: u32 = 3;

/// The clocks of one order.
struct Wait {
    /// When its time is over.
    deadline: Instant,
    /// When the order was first given: how long it has taken decides how often the PLC is asked.
    begun: Instant,
    /// When it was written last.
    written: Instant,
    /// Since when there is no connection.
    lost: Option<Instant>,
    /// Answers that could not be understood. What is read in between may be well while every write is not.
    garbled: u32,
}

/// Lets the PLC and the machine work until it is asked again: an eighth of what it has taken so far. Questions without a
/// pause would keep a processor busy that the PLC may share, and a Modbus server from its cycle.
fn pause(taken: Duration) {
    if taken > SOON {
        std::thread::sleep((taken / 8).min(PAUSE_MAX));
    }
}

/// A real PLC as a client of a session.
pub struct Gateway {
    request: JoinRequest,
    exchange: Exchange,
    link: Box<dyn Link>,
    handshake: Handshake,
    patience: Patience,
    to_plc: Vec<u8>,
    from_plc: Vec<u8>,
    /// Whether the PLC has said something over this connection: that is in `from_plc`.
    heard: bool,
}

impl Gateway {
    /// A client that speaks over `link` for the PLC, whose points are those of `exchange`.
    pub fn new(request: JoinRequest, exchange: Exchange, link: Box<dyn Link>, patience: Patience) -> Self {
        let (to_plc, from_plc) = (vec![0; exchange.size(Direction::ToPlc)], vec![0; exchange.size(Direction::FromPlc)]);
        Self { request, exchange, link, handshake: Handshake::new(), patience, to_plc, from_plc, heard: false }
    }

    /// The same for a PLC whose program must have been made for the mapping with this number.
    pub fn expecting(self, layout: Option<u32>) -> Self {
        Self { handshake: self.handshake.expecting(layout), ..self }
    }

    /// Connects and checks the mapping, before any session; a PLC that is not there yet is waited for.
    ///
    /// # Errors
    /// See [`LinkFault`].
    pub fn connect(&mut self) -> Result<(), LinkFault> {
        contact::connect(&mut *self.link, self.request.name.as_str(), self.patience.reconnect)?;
        self.handshake.connected();
        Ok(())
    }

    /// Does what the handshake asks for until it asks for nothing.
    fn drive(&mut self, patience: Duration) -> Result<(), GatewayFault> {
        let now = Instant::now();
        let mut wait = Wait { deadline: now + patience, begun: now, written: now, lost: None, garbled: 0 };
        loop {
            let result = match self.handshake.ask() {
                Ask::Nothing => return Ok(()),
                Ask::Connect => {
                    self.heard = false;
                    self.link.connect().map(|()| self.handshake.connected())
                }
                Ask::Write(order) => {
                    self.exchange.put(&order, &mut self.to_plc);
                    self.link.write(&self.to_plc).map(|()| {
                        self.handshake.written();
                        wait.written = Instant::now();
                    })
                }
                Ask::Read => self.read(&mut wait)?,
            };
            self.notify();
            match result {
                Ok(()) => {}
                Err(fault) if fault.is_transient() => self.be_lost(&fault, &mut wait)?,
                // Where a garbled answer ends is not known, so the client connects again.
                Err(fault) if fault.is_garbled() && wait.garbled + 1 < GARBLED_MAX => {
                    wait.garbled += 1;
                    self.be_lost(&fault, &mut wait)?;
                }
                Err(fault) => return Err(fault.into()),
            }
            // While the connection is lost, `be_lost` and `read` watch the time instead.
            if wait.lost.is_none() && self.handshake.ask() != Ask::Nothing && Instant::now() > wait.deadline {
                return Err(match self.link.broken_off() {
                    Some(partial) => GatewayFault::BrokenOff { what: self.handshake.what(), after: patience, partial },
                    None => self.handshake.late(patience),
                });
            }
        }
    }

    /// Reads once. A connection is back when something has been read over it, not before.
    fn read(&mut self, wait: &mut Wait) -> Result<Result<(), LinkFault>, GatewayFault> {
        // A socket takes no time-out of 0; and the order must be written again in time.
        let rest = wait.deadline.saturating_duration_since(Instant::now()).clamp(Duration::from_millis(1), AGAIN);
        match self.link.read(rest, &mut self.from_plc) {
            Ok(true) => {
                // What the outage took is not the PLC's to answer for.
                wait.deadline += wait.lost.take().map_or(Duration::ZERO, |since| since.elapsed());
                self.heard = true;
                self.handshake.look(self.exchange.report(&self.from_plc))?;
            }
            Ok(false) if wait.lost.is_some_and(|since| since.elapsed() > self.patience.reconnect) => {
                return Ok(Err(LinkFault::Lost("connected again, but the PLC says nothing".to_owned())));
            }
            Ok(false) => {}
            Err(fault) => return Ok(Err(fault)),
        }
        if wait.written.elapsed() > AGAIN {
            wait.written = Instant::now();
            // A PLC that sends its block when that has changed says nothing while it stands: what it said last is so.
            if self.heard && !self.link.is_polled() {
                self.handshake.look(self.exchange.report(&self.from_plc))?;
            }
            self.handshake.quiet()?;
        }
        if self.link.is_polled() && self.handshake.ask() == Ask::Read {
            pause(wait.begun.elapsed());
        }
        Ok(Ok(()))
    }

    /// Notes that the connection is gone; waits a little before it is tried once more.
    fn be_lost(&mut self, fault: &LinkFault, wait: &mut Wait) -> Result<(), GatewayFault> {
        let what = self.handshake.what();
        self.handshake.lost();
        let Some(since) = wait.lost else {
            tracing::info!(target: NOTICE, "{fault}, during {what}; connecting again");
            wait.lost = Some(Instant::now());
            return Ok(());
        };
        if since.elapsed() > self.patience.reconnect {
            return Err(GatewayFault::NotBack { what, after: self.patience.reconnect, reason: fault.to_string() });
        }
        std::thread::sleep(AGAIN / 4);
        Ok(())
    }

    fn notify(&mut self) {
        match self.handshake.take_notice() {
            Some(Notice::StartPlc) => {
                tracing::info!(target: NOTICE, "client `{}`: start the PLC cold, for the session to begin", self.request.name);
            }
            Some(Notice::Back) => {
                tracing::info!(target: NOTICE, "connection back, {} is resumed", self.handshake.what());
            }
            Some(Notice::NoLayout) => {
                let name = &self.request.name;
                tracing::info!(target: NOTICE, "client `{name}`: SDSP_Layout is 0: the PLC's program was instrumented without a scenario, so that its mapping cannot be compared");
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
        // After a reset the PLC must not start on inputs of the trajectory before.
        self.to_plc.fill(0);
        self.handshake.join(VirtualTime::ZERO);
        self.drive(self.patience.start).map_err(|fault| ClientFault::new(fault.to_string()))?;
        self.take_outputs(outputs);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.exchange.put_inputs(inputs, &mut self.to_plc);
        let done = self.handshake.grant(t_v).and_then(|()| self.drive(self.patience.grant));
        done.map_err(|fault| ClientFault::new(fault.to_string()))?;
        self.take_outputs(outputs);
        Ok(Wake::NextPeriod)
    }
}
