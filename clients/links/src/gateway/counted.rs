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
    /// counted. Whoever connects in the PLC's place and sends no block is left for the next one, for as long as a lost PLC is
    /// waited for.
    fn step(&mut self, t_v: VirtualTime) -> Result<(), GatewayFault> {
        let mut garbled = 0;
        let strangers_until = Instant::now() + self.patience.grant + self.patience.reconnect;
        loop {
            let fault = match self.exchange_blocks(t_v) {
                Err(GatewayFault::Link(fault)) => fault,
                done => return done,
            };
            if fault.is_garbled() {
                garbled += 1;
            }
            let is_over = self.link.is_a_strangers() && Instant::now() > strangers_until;
            if garbled >= GARBLED_MAX || !(fault.is_transient() || fault.is_garbled()) || is_over {
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
                    if self.link.is_a_strangers() {
                        return Err(self.link.no_block(after).into());
                    }
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::io::{Read as _, Write as _};
    use std::net::{SocketAddr, TcpStream};

    use onescan_server::signal::{ClientName, Port, SignalName, SignalType};
    use onescan_server::time::TimeSpan;

    use super::*;
    use crate::gateway::exchange::{Feed, Words};
    use crate::gateway::tcp::{Declaration, Layouts};

    const SOON: Duration = Duration::from_millis(50);
    const LATER: Duration = Duration::from_mins(1);

    /// A gateway to a PLC with a block of eight bytes each way that connects to `address`.
    fn gateway(address: SocketAddr, patience: Patience) -> CountedGateway {
        let port = |name: &str| Port { name: SignalName::new(name).unwrap(), ty: SignalType::LINT };
        let feed = |name: &str| Feed::whole(&port(name), None);
        let exchange = Exchange::new(&[feed("a")], &[feed("b")], Words::Absent, &BTreeMap::new());
        let layouts = Layouts::new(&Declaration::default(), &exchange).unwrap();
        let (name, period) = (ClientName::new("plc").unwrap(), TimeSpan::from_millis(10).unwrap());
        let request = JoinRequest { name, period, reads: vec![port("a")], writes: vec![port("b")] };
        let link = TcpLink::listening(address, layouts, LATER);
        CountedGateway::new(request, exchange, (link, NonZeroU32::MIN), patience)
    }

    fn free() -> SocketAddr {
        std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
    }

    fn connects(address: SocketAddr) -> TcpStream {
        loop {
            if let Ok(stream) = TcpStream::connect(address) {
                return stream;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// A PLC that waits for the first block cannot be distinguished from somebody else before it answers.
    #[test]
    fn who_connects_first_and_answers_nothing_gives_way_to_the_plc() {
        let address = free();
        let peers = std::thread::spawn(move || {
            let mut stranger = connects(address);
            let mut seen = Vec::new();
            // It may be reset.
            let _ = stranger.read_to_end(&mut seen);
            let (mut plc, mut block) = (connects(address), [0; 8]);
            plc.read_exact(&mut block).unwrap();
            plc.write_all(&[7; 8]).unwrap();
            (seen.len(), plc)
        });
        let mut gateway = gateway(address, Patience { grant: SOON, reconnect: LATER, ..Patience::default() });
        gateway.connect().unwrap();
        let mut outputs = [0; 8];
        gateway.turn(VirtualTime::from_nanos(10_000_000), &[1; 8], &mut outputs).unwrap();
        assert_eq!(outputs, [7; 8]);
        assert_eq!(peers.join().unwrap().0, 8, "the block was taken for the PLC's");
    }

    /// Strangers one after another do not make a session wait for ever.
    #[test]
    fn strangers_that_come_again_and_again_end_the_wait() {
        let address = free();
        let stop = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
        let over = std::sync::Arc::clone(&stop);
        let strangers = std::thread::spawn(move || {
            while !over.load(std::sync::atomic::Ordering::Acquire) {
                if let Ok(mut stranger) = TcpStream::connect(address) {
                    let _ = stranger.read_to_end(&mut Vec::new());
                }
            }
        });
        let mut gateway = gateway(address, Patience { grant: SOON, reconnect: SOON * 20, ..Patience::default() });
        while gateway.connect().is_err() {}
        let fault = gateway.turn(VirtualTime::from_nanos(10_000_000), &[1; 8], &mut [0; 8]).unwrap_err().to_string();
        assert!(fault.contains("there came no block"), "{fault}");
        stop.store(true, std::sync::atomic::Ordering::Release);
        drop(gateway);
        strangers.join().unwrap();
    }
}
