//! Listening, and clients that come one by one, for servers with a thread a client.

use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::Duration;

use super::controller::Controller;

/// How often a thread that waits looks whether all is over.
pub(super) const GLANCE: Duration = Duration::from_millis(100);
/// A client that does not take what is sent to it for so long is left.
const WRITE_TIMEOUT: Duration = Duration::from_secs(3);

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
    accept(listener, controller, |stream, peer| {
        let server = Arc::clone(server);
        std::thread::spawn(move || {
            if let Err(error) = attend(&server, &stream) {
                tracing::info!(%peer, %error, "a client over {protocol} has gone");
            }
            // It may be gone already.
            let _ = stream.shutdown(Shutdown::Both);
        });
    });
}

/// For requests that are answered one by one, by a thread of their own.
fn prepare(stream: &TcpStream) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_TIMEOUT))
}
