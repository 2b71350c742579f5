//! Listening, and clients that come one by one, for servers with a thread a client.

use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use super::controller::Controller;

/// How often a thread that waits looks whether all is over.
pub(super) const GLANCE: Duration = Duration::from_millis(100);
/// A client that does not take what is sent to it for so long is left.
const WRITE_TIMEOUT: Duration = Duration::from_secs(3);

/// A client that says nothing for so long is left; one that comes back is let in again.
const IDLE_TIMEOUT: Duration = Duration::from_mins(10);
/// Clients of one server at a time: each has a thread.
const CLIENTS_MAX: usize = 64;

/// Hands each client to `attend`, until all is over.
pub(super) fn accept(listener: &TcpListener, controller: &Controller, mut attend: impl FnMut(TcpStream, SocketAddr)) {
    while !controller.is_over() {
        match listener.accept() {
            Ok((stream, peer)) => match prepare(&stream) {
                Ok(()) => attend(stream, peer),
                Err(error) => tracing::info!(%peer, %error, "a client has gone before it was served"),
            },
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => std::thread::sleep(GLANCE / 10),
            Err(error) => {
                tracing::warn!(%error, "cannot accept a connection");
                std::thread::sleep(GLANCE);
            }
        }
    }
}

/// Serves each client by `attend` in a thread of its own, until all is over. A client of the `protocol` that goes, or
/// says what nobody answers, is let go.
pub(super) fn serve_each<Server: Send + Sync + 'static>(
    listener: &TcpListener,
    (server, controller): (&Arc<Server>, &Controller),
    protocol: &'static str,
    attend: fn(&Server, &TcpStream) -> std::io::Result<()>,
) {
    let present = Arc::new(AtomicUsize::new(0));
    accept(listener, controller, |stream, peer| {
        let Some(seat) = Seat::taken(&present) else {
            tracing::info!(%peer, "refused over {protocol}: {CLIENTS_MAX} clients are connected");
            return;
        };
        let server = Arc::clone(server);
        std::thread::spawn(move || {
            let _seat = seat;
            if let Err(error) = attend(&server, &stream) {
                tracing::info!(%peer, %error, "a client over {protocol} has gone");
            }
            // It may be gone already.
            let _ = stream.shutdown(Shutdown::Both);
        });
    });
}

/// A client's place among those that are served; it is free again when this is dropped.
struct Seat(Arc<AtomicUsize>);

impl Seat {
    /// Nothing if all are taken. Only the thread that accepts clients takes any.
    fn taken(present: &Arc<AtomicUsize>) -> Option<Self> {
        if present.load(Ordering::Acquire) >= CLIENTS_MAX {
            return None;
        }
        present.fetch_add(1, Ordering::AcqRel);
        Some(Self(Arc::clone(present)))
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::AcqRel);
    }
}

/// For requests that are answered one by one, by a thread of their own.
pub(super) fn prepare(stream: &TcpStream) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(IDLE_TIMEOUT))?;
    stream.set_write_timeout(Some(WRITE_TIMEOUT))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seat_is_free_again_when_its_client_has_gone() {
        let present = Arc::new(AtomicUsize::new(0));
        let mut seats: Vec<_> = (0..CLIENTS_MAX).map(|_| Seat::taken(&present).unwrap()).collect();
        assert!(Seat::taken(&present).is_none());
        seats.pop();
        assert!(Seat::taken(&present).is_some());
    }
}
