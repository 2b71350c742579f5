//! Data blocks over raw TCP: the PLC's side.
//!
//! The PLC sends its block at the end of a cycle in which it has changed, or before which it got one; in STOP
//! it answers at once. With an interval it sends then, and at no other time. A new connection takes the place of the one
//! before. The PLC is the TCP server, or the client, and then connects again and again.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::controller::Controller;
use super::listen::{GLANCE, accept, prepare};
use crate::gateway::exchange::Direction;
use crate::gateway::tcp::{BlockCodec, Layouts};
use crate::listener::bind;

/// How long a gateway may take to accept a connection.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);

/// What is sent and taken, and when.
#[derive(Clone, Debug)]
pub struct Blocks {
    pub layouts: Layouts,
    /// The interval at which the PLC sends its block, wall clock; when there is reason to if absent.
    pub push: Option<Duration>,
}

/// Serves the PLC's blocks at `address`; gives the address that it got. The server ends with the controller.
///
/// # Errors
/// The address cannot be listened on.
pub fn serve(address: SocketAddr, controller: &Arc<Controller>, blocks: Blocks) -> std::io::Result<SocketAddr> {
    let (listener, address) = bind(address)?;
    let controller = Arc::clone(controller);
    std::thread::spawn(move || serve_one_by_one(&listener, &controller, &Arc::new(blocks)));
    Ok(address)
}

/// Connects to a gateway that listens at `address`, again and again, until the controller ends.
pub fn connect(address: SocketAddr, controller: &Arc<Controller>, blocks: Blocks) {
    let (controller, blocks) = (Arc::clone(controller), Arc::new(blocks));
    std::thread::spawn(move || {
        while !controller.is_over() {
            match visit(address, &controller, &blocks) {
                Ok(()) => tracing::info!(%address, "the gateway has gone"),
                Err(error) => tracing::debug!(%address, %error, "no gateway yet"),
            }
            std::thread::sleep(GLANCE);
        }
    });
}

/// One connection to a gateway, from its beginning to its end.
fn visit(address: SocketAddr, controller: &Arc<Controller>, blocks: &Arc<Blocks>) -> std::io::Result<()> {
    let stream = TcpStream::connect_timeout(&address, CONNECT_TIMEOUT)?;
    prepare(&stream)?;
    tracing::info!(%address, "connected to a gateway");
    for half in attend(stream, controller.take_hold(), controller, blocks)? {
        half.join().map_err(|_| std::io::Error::other("a thread of the link has panicked"))?;
    }
    Ok(())
}

fn serve_one_by_one(listener: &TcpListener, controller: &Arc<Controller>, blocks: &Arc<Blocks>) {
    let mut last: Option<TcpStream> = None;
    accept(listener, controller, |stream, peer| {
        if let Some(last) = last.take() {
            // It may be gone already.
            let _ = last.shutdown(Shutdown::Both);
        }
        let holder = controller.take_hold();
        tracing::info!(%peer, "a gateway has connected");
        last = stream.try_clone().ok();
        if let Err(error) = attend(stream, holder, controller, blocks) {
            tracing::info!(%peer, %error, "a gateway has gone before it was served");
        }
    });
}

/// Two threads for one gateway: one that takes its blocks, one that sends the PLC's.
fn attend(
    stream: TcpStream,
    holder: u64,
    controller: &Arc<Controller>,
    blocks: &Arc<Blocks>,
) -> std::io::Result<[JoinHandle<()>; 2]> {
    let taken = Arc::new(AtomicU64::new(0));
    let incoming = stream.try_clone()?;
    let (a, b) = (Arc::clone(controller), Arc::clone(controller));
    let (ours, theirs) = (Arc::clone(blocks), Arc::clone(blocks));
    let counted = Arc::clone(&taken);
    let taking = std::thread::spawn(move || {
        if let Err(error) = take(&incoming, holder, &a, &ours.layouts, &counted) {
            tracing::info!(%error, "a gateway has gone");
        }
        // Its other half sees that.
        let _ = incoming.shutdown(Shutdown::Both);
    });
    let sending = std::thread::spawn(move || {
        // The half that reads has reported a gateway that is gone.
        let _ = match theirs.push {
            Some(interval) => push(&stream, &b, &theirs.layouts, interval),
            None => send(&stream, &b, &theirs.layouts, &taken),
        };
        let _ = stream.shutdown(Shutdown::Both);
    });
    Ok([taking, sending])
}

fn take(
    mut stream: &TcpStream,
    holder: u64,
    controller: &Controller,
    layouts: &Layouts,
    taken: &AtomicU64,
) -> std::io::Result<()> {
    let cut = |fault| {
        tracing::warn!("what the gateway sends cannot be understood: {fault}");
        std::io::Error::new(std::io::ErrorKind::InvalidData, fault)
    };
    let mut codec = BlockCodec::new(&layouts.to_plc);
    let mut packed = vec![0; controller.wires().exchange().size(Direction::ToPlc)];
    let mut buffer = vec![0; 16 * 1024];
    loop {
        match stream.read(&mut buffer)? {
            0 => return codec.end().map_err(cut),
            count => codec.take(&buffer[..count]),
        }
        if let Some(block) = codec.newest().map_err(cut)? {
            layouts.to_plc.decode(&block, &mut packed);
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
