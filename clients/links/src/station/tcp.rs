//! Data blocks over raw TCP: the PLC's side.
//!
//! The PLC sends its block at the end of a cycle in which it has changed, or before which it got one; in STOP
//! it answers at once. With an interval it sends then, and at no other time. Whoever sends a block takes the place of the
//! gateway before; who only connects and listens takes nobody's. The PLC is the TCP server, or the client, and then connects
//! again and again.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use onescan_base::repeated::Repeated;
use onescan_base::threads;
use onescan_server::transport::listeners::RAW_TCP;

use super::controller::Controller;
use crate::accept::{GLANCE, Peer, accept, not_served};
use crate::gateway::exchange::Direction;
use crate::gateway::tcp::{BlockCodec, Layouts};
use crate::listener::bind;

/// How long a gateway may take to accept a connection.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);

static GARBLED: Repeated = Repeated::new();

/// What is sent and taken, and when.
#[derive(Clone, Debug)]
pub struct Blocks {
    pub layouts: Layouts,
    /// The interval at which the PLC sends its block, wall clock; when there is reason to if absent.
    pub push: Option<Duration>,
}

/// The PLC, its blocks, and the gateway that has it.
struct Server {
    controller: Arc<Controller>,
    blocks: Blocks,
    holding: Mutex<Weak<TcpStream>>,
}

impl Server {
    fn new(controller: &Arc<Controller>, blocks: Blocks) -> Arc<Self> {
        Arc::new(Self { controller: Arc::clone(controller), blocks, holding: Mutex::new(Weak::new()) })
    }

    /// Gives the PLC to `peer`, whose first block has come, and closes the connection of the gateway before. Gives the number
    /// by which `peer` may write.
    fn take_hold(&self, peer: &mut Peer) -> std::io::Result<u64> {
        peer.stay()?;
        let stream = peer.stream();
        // A thread that panicked here left a whole value.
        let mut holding = self.holding.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(before) = std::mem::replace(&mut *holding, Arc::downgrade(&stream)).upgrade() {
            // It may be gone already.
            let _ = before.shutdown(Shutdown::Both);
        }
        tracing::info!(peer = %peer.address(), "a gateway has the PLC");
        Ok(self.controller.take_hold())
    }
}

/// Serves the PLC's blocks at `address`; gives the address that it got. The server ends with the controller.
///
/// # Errors
/// The address cannot be listened on, or there is no thread.
pub fn serve(address: SocketAddr, controller: &Arc<Controller>, blocks: Blocks) -> std::io::Result<SocketAddr> {
    let (listener, address) = bind(address)?;
    let server = Server::new(controller, blocks);
    threads::start("raw TCP", move || serve_each(&listener, &server))?;
    Ok(address)
}

/// Connects to a gateway that listens at `address`, again and again, until the controller ends.
///
/// # Errors
/// There is no thread.
pub fn connect(address: SocketAddr, controller: &Arc<Controller>, blocks: Blocks) -> std::io::Result<()> {
    let server = Server::new(controller, blocks);
    let visits = move || {
        while !server.controller.is_over() {
            match visit(address, &server) {
                Ok(()) => tracing::info!(%address, "the gateway has gone"),
                Err(error) => tracing::debug!(%address, %error, "no gateway yet"),
            }
            std::thread::sleep(GLANCE);
        }
    };
    threads::start("raw TCP", visits).map(drop)
}

/// One connection to a gateway, from its beginning to its end.
fn visit(address: SocketAddr, server: &Arc<Server>) -> std::io::Result<()> {
    let peer = Peer::connected(TcpStream::connect_timeout(&address, CONNECT_TIMEOUT)?, address)?;
    tracing::info!(%address, "connected to a gateway");
    for half in attend(peer, server)? {
        half.join().map_err(|_| std::io::Error::other("a thread of the link has panicked"))?;
    }
    Ok(())
}

fn serve_each(listener: &TcpListener, server: &Arc<Server>) {
    accept(
        listener,
        RAW_TCP,
        || server.controller.is_over(),
        |peer| {
            if let Err(error) = attend(peer, server) {
                not_served(RAW_TCP.what, &error);
            }
        },
    );
}

/// Two threads for one gateway: one that takes its blocks, one that sends the PLC's.
fn attend(mut peer: Peer, server: &Arc<Server>) -> std::io::Result<[JoinHandle<()>; 2]> {
    let taken = Arc::new(AtomicU64::new(0));
    let (stream, counted) = (peer.stream(), Arc::clone(&taken));
    let (a, b) = (Arc::clone(server), Arc::clone(server));
    let taking = threads::start("blocks in", move || {
        if let Err(error) = take(&mut peer, &a, &counted) {
            tracing::info!(%error, "a gateway has gone");
        }
        // With `peer` the connection is closed; its other half sees that.
    })?;
    let closing = Arc::clone(&stream);
    let sending = threads::start("blocks out", move || {
        // The half that reads has reported a gateway that is gone.
        let _ = match b.blocks.push {
            Some(interval) => push(&stream, &b.controller, &b.blocks.layouts, interval),
            None => send(&stream, &b.controller, &b.blocks.layouts, &taken),
        };
        let _ = stream.shutdown(Shutdown::Both);
    });
    if sending.is_err() {
        // The half that reads ends with it.
        let _ = closing.shutdown(Shutdown::Both);
    }
    Ok([taking, sending?])
}

fn take(peer: &mut Peer, server: &Server, taken: &AtomicU64) -> std::io::Result<()> {
    let cut = |fault| {
        if let Some(times) = GARBLED.again() {
            tracing::warn!("what the gateway sends cannot be understood: {fault}{times}");
        }
        std::io::Error::new(std::io::ErrorKind::InvalidData, fault)
    };
    let (controller, to_plc) = (&server.controller, &server.blocks.layouts.to_plc);
    let mut codec = BlockCodec::new(to_plc);
    let mut packed = vec![0; controller.wires().exchange().size(Direction::ToPlc)];
    let mut buffer = vec![0; 16 * 1024];
    let mut holder = None;
    loop {
        match peer.read(&mut buffer)? {
            0 => return codec.end().map_err(cut),
            count => codec.take(&buffer[..count]),
        }
        if let Some(block) = codec.newest().map_err(cut)? {
            let holder = match holder {
                Some(holder) => holder,
                None => *holder.insert(server.take_hold(peer)?),
            };
            to_plc.decode(&block, &mut packed);
            taken.fetch_add(1, Ordering::SeqCst);
            if !controller.write_held(holder, &packed) {
                return Ok(());
            }
        }
    }
}

fn send(mut stream: &TcpStream, controller: &Controller, layouts: &Layouts, taken: &AtomicU64) -> std::io::Result<()> {
    let mut packed = vec![0; controller.wires().exchange().size(Direction::FromPlc)];
    let mut block = vec![0; layouts.from_plc.size()];
    let (mut sent, mut answered, mut seen) = (None, 0, 0);
    while let Some(version) = controller.wait(seen, GLANCE) {
        let is_new = version != seen;
        seen = version;
        let got = taken.load(Ordering::SeqCst);
        controller.read(Direction::FromPlc, &mut packed);
        layouts.from_plc.encode(&packed, &mut block);
        if sent.as_ref() != Some(&block) || is_new && got != answered {
            stream.write_all(&block)?;
            sent = Some(block.clone());
            answered = got;
        } else if is_gone(stream) {
            return Ok(());
        }
    }
    Ok(())
}

/// A block every `interval`. A late one does not delay those after it; what was missed is left out.
fn push(mut stream: &TcpStream, controller: &Controller, layouts: &Layouts, interval: Duration) -> std::io::Result<()> {
    let mut packed = vec![0; controller.wires().exchange().size(Direction::FromPlc)];
    let mut block = vec![0; layouts.from_plc.size()];
    let mut due = Instant::now();
    while !controller.is_over() && !is_gone(stream) {
        controller.read(Direction::FromPlc, &mut packed);
        layouts.from_plc.encode(&packed, &mut block);
        stream.write_all(&block)?;
        due += interval;
        let now = Instant::now();
        match due.checked_duration_since(now) {
            Some(rest) => std::thread::sleep(rest),
            None => due = now,
        }
    }
    Ok(())
}

/// The half that reads has shut the connection down.
fn is_gone(stream: &TcpStream) -> bool {
    stream.peer_addr().is_err()
}
