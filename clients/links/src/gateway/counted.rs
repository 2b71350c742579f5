//! A PLC whose program cannot be instrumented: its blocks are counted, one out and some in for each step.
//!
//! The PLC's scans and timers go by its own clock, and nothing says which scan has seen which block. What holds is
//! the order: each block out belongs to one step, and a step uses only blocks that came after its own went out.

use onescan_base::notice::NOTICE;
use std::num::NonZeroU32;
use std::time::{Duration, Instant};

use onescan_server::client::{Client, ClientFault, JoinRequest, OperationRefused, Wake};
use onescan_server::time::VirtualTime;

use super::client::{GARBLED_MAX, Patience};
use super::contact;
use super::exchange::{Direction, Exchange};
use super::fault::{GatewayFault, LinkFault};
use super::link::Link;
use super::tcp::TcpLink;

/// How long the socket is listened to at a time.
const GLANCE: Duration = Duration::from_millis(200);

/// What became of the blocks of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Steps that are done.
    pub steps: u64,
    /// Blocks that a step has waited for.
    pub used: u64,
    /// Blocks that came before the next one went out, so that newer ones took their place.
    pub replaced: u64,
    /// Connections that were lost and are back.
    pub reconnected: u64,
}

/// A PLC on its own clock, whose blocks set the pace of the session.
pub struct CountedGateway {
    request: JoinRequest,
    exchange: Exchange,
    link: TcpLink,
    /// Blocks of the PLC that make up a step.
    per_step: NonZeroU32,
    patience: Patience,
    tally: Tally,
    to_plc: Vec<u8>,
    from_plc: Vec<u8>,
}

impl CountedGateway {
    /// A client that speaks over `link`, a step for each `per_step` blocks of the PLC.
    pub fn new(
        request: JoinRequest,
        exchange: Exchange,
        (link, per_step): (TcpLink, NonZeroU32),
        patience: Patience,
    ) -> Self {
        let (to_plc, from_plc) = (vec![0; exchange.size(Direction::ToPlc)], vec![0; exchange.size(Direction::FromPlc)]);
        Self { request, exchange, link, per_step, patience, tally: Tally::default(), to_plc, from_plc }
    }

    /// Connects, before any session; a PLC that is not there yet is waited for.
    ///
    /// # Errors
    /// See [`LinkFault`].
    pub fn connect(&mut self) -> Result<(), LinkFault> {
        contact::connect(&mut self.link, self.request.name.as_str(), self.patience.reconnect)
    }

    /// One block out and some in. After a lost connection the block goes out again, and those that came before are not
    /// counted.
    fn step(&mut self, t_v: VirtualTime) -> Result<(), GatewayFault> {
        let mut garbled = 0;
        loop {
            let fault = match self.exchange_blocks(t_v) {
                Err(GatewayFault::Link(fault)) => fault,
                done => return done,
            };
            if fault.is_garbled() {
                garbled += 1;
            }
            if garbled >= GARBLED_MAX || !(fault.is_transient() || fault.is_garbled()) {
                return Err(fault.into());
            }
            tracing::info!(target: NOTICE, "{fault}, during {}; connecting again", what(t_v));
            self.connect()?;
            self.tally.reconnected += 1;
            tracing::info!(target: NOTICE, "connection back, {} is resumed", what(t_v));
        }
    }

    fn exchange_blocks(&mut self, t_v: VirtualTime) -> Result<(), GatewayFault> {
        // First, so that no block counts which the PLC sent before this step's own went out.
        self.tally.replaced += self.link.discard()?;
        self.link.write(&self.to_plc)?;
        let after = self.patience.grant;
        let deadline = Instant::now() + after;
        for _ in 0..self.per_step.get() {
            while !self.link.next_block(GLANCE, &mut self.from_plc)? {
                if Instant::now() > deadline {
                    let what = what(t_v);
                    return Err(match self.link.broken_off() {
                        Some(partial) => GatewayFault::BrokenOff { what, after, partial },
                        None => GatewayFault::NoBlock { what, after },
                    });
                }
            }
        }
        self.tally.used += u64::from(self.per_step.get());
        self.tally.steps += 1;
        Ok(())
    }
}

fn what(t_v: VirtualTime) -> String {
    format!("the step to t_v = {t_v}")
}

impl Client for CountedGateway {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        // What the PLC shows already comes in the first turn.
        outputs.fill(0);
        self.to_plc.fill(0);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.exchange.put_inputs(inputs, &mut self.to_plc);
        self.step(t_v).map_err(|fault| ClientFault::new(fault.to_string()))?;
        outputs.copy_from_slice(&self.from_plc[self.exchange.outputs()]);
        Ok(Wake::NextPeriod)
    }

    fn can_reset(&self) -> Result<(), OperationRefused> {
        Err(OperationRefused::Because(
            "its blocks are counted (`handshake = \"frames\"`), so that nobody here can start its program again, and the machine \
             would begin again alone; end the session, start the PLC cold, and run it again"
                .to_owned(),
        ))
    }
}

impl Drop for CountedGateway {
    fn drop(&mut self) {
        let Tally { steps, used, replaced, reconnected } = self.tally;
        let name = &self.request.name;
        if steps > 0 {
            tracing::info!(target: NOTICE, "client `{name}`, blocks counted: {steps} steps, {used} blocks used, {replaced} replaced by newer ones, {reconnected} connections lost; no lockstep");
        }
    }
}
