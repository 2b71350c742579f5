//! Data blocks over raw TCP: the PLC's side.
//!
//! The PLC sends its block at the end of a cycle in which it has changed, or before which it got one; in STOP
//! it answers at once. A new connection takes the place of the one before.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bytes::BytesMut;
use tokio_util::codec::Decoder;

use super::controller::Controller;
use super::listen::{GLANCE, accept};
use crate::gateway::exchange::Direction;
use crate::gateway::tcp::{BlockCodec, Layouts};
use crate::listener::bind;

/// Serves the PLC's blocks at `address`; gives the address that it got. The server ends with the controller.
///
/// # Errors
/// The address cannot be listened on.
pub fn serve(address: SocketAddr, controller: &Arc<Controller>, layouts: Layouts) -> std::io::Result<SocketAddr> {
    let (listener, address) = bind(address)?;
    let controller = Arc::clone(controller);
    std::thread::spawn(move || serve_one_by_one(&listener, &controller, &Arc::new(layouts)));
    Ok(address)
}

fn serve_one_by_one(listener: &TcpListener, controller: &Arc<Controller>, layouts: &Arc<Layouts>) {
    let mut last: Option<TcpStream> = None;
    accept(listener, controller, |stream, peer| {
        if let Some(last) = last.take() {
            // It may be gone already.
            let _ = last.shutdown(Shutdown::Both);
        }
        let holder = controller.take_hold();
        tracing::info!(%peer, "a gateway has connected");
        last = stream.try_clone().ok();
        if let Err(error) = attend(stream, holder, controller, layouts) {
            tracing::info!(%peer, %error, "a gateway has gone before it was served");
        }
    });
}

/// Two threads for one gateway: one that takes its blocks, one that sends the PLC's.
fn attend(stream: TcpStream, holder: u64, controller: &Arc<Controller>, layouts: &Arc<Layouts>) -> std::io::Result<()> {
    let taken = Arc::new(AtomicU64::new(0));
    let incoming = stream.try_clone()?;
    let (a, b) = (Arc::clone(controller), Arc::clone(controller));
    let (ours, theirs) = (Arc::clone(layouts), Arc::clone(layouts));
    let counted = Arc::clone(&taken);
    std::thread::spawn(move || {
        if let Err(error) = take(&incoming, holder, &a, &ours, &counted) {
            tracing::info!(%error, "a gateway has gone");
        }
        // Its other half sees that.
        let _ = incoming.shutdown(Shutdown::Both);
    });
    std::thread::spawn(move || {
        // The half that reads has reported a gateway that is gone.
        let _ = send(&stream, &b, &theirs, &taken);
        let _ = stream.shutdown(Shutdown::Both);
    });
    Ok(())
}

fn take(
    mut stream: &TcpStream,
    holder: u64,
    controller: &Controller,
    layouts: &Layouts,
    taken: &AtomicU64,
) -> std::io::Result<()> {
    let mut codec = BlockCodec::new(layouts.to_plc.size());
    let mut packed = vec![0; controller.wires().exchange().size(Direction::ToPlc)];
    let mut buffer = vec![0; 16 * 1024];
    let mut incoming = BytesMut::new();
    loop {
        match stream.read(&mut buffer)? {
            0 => return codec.decode_eof(&mut incoming).map(|_| ()),
            count => incoming.extend_from_slice(&buffer[..count]),
        }
        if let Some(block) = codec.decode(&mut incoming)? {
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

/// The half that reads has shut the connection down.
fn is_gone(stream: &TcpStream) -> bool {
    stream.peer_addr().is_err()
}
