//! The page under TLS. Handshakes run beside each other, so that one who does not speak keeps nobody out.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::serve::Listener;
use onescan_server::transport::tls::Identity;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, mpsc};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

/// How long a handshake may take.
const HANDSHAKE: Duration = Duration::from_secs(5);
/// Handshakes at a time.
const HANDSHAKES_MAX: usize = 64;
/// How long it is waited after a connection could not be taken, as where there are too many files.
const PAUSE: Duration = Duration::from_millis(100);

/// Somebody who has come, under TLS.
type Connection = (TlsStream<TcpStream>, SocketAddr);

/// A listener of which connections come under TLS.
pub(super) struct TlsDoor {
    address: SocketAddr,
    connections: mpsc::Receiver<Connection>,
}

impl TlsDoor {
    /// Takes the connections of `listener`, on the runtime of whoever calls.
    pub(super) fn new(listener: TcpListener, identity: &Identity) -> io::Result<Self> {
        let address = listener.local_addr()?;
        let (send, connections) = mpsc::channel(1);
        tokio::spawn(take(listener, TlsAcceptor::from(identity.server_config()), send));
        Ok(Self { address, connections })
    }
}

async fn take(listener: TcpListener, acceptor: TlsAcceptor, connections: mpsc::Sender<Connection>) {
    let places = Arc::new(Semaphore::new(HANDSHAKES_MAX));
    while !connections.is_closed() {
        let Ok(place) = Arc::clone(&places).acquire_owned().await else { return };
        let (stream, from) = match listener.accept().await {
            Ok(came) => came,
            Err(error) => {
                tracing::debug!(%error, "a connection to the page was not taken");
                tokio::time::sleep(PAUSE).await;
                continue;
            }
        };
        let (acceptor, connections) = (acceptor.clone(), connections.clone());
        tokio::spawn(async move {
            let _place = place;
            match tokio::time::timeout(HANDSHAKE, acceptor.accept(stream)).await {
                // the page may be over
                Ok(Ok(stream)) => drop(connections.send((stream, from)).await),
                Ok(Err(error)) => tracing::debug!(%error, %from, "no TLS came of a connection to the page"),
                Err(_) => tracing::debug!(%from, "a connection to the page did not speak"),
            }
        });
    }
}

impl Listener for TlsDoor {
    type Io = TlsStream<TcpStream>;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Self::Io, Self::Addr) {
        match self.connections.recv().await {
            Some(connection) => connection,
            // whoever takes connections lives as long as this
            None => std::future::pending().await,
        }
    }

    fn local_addr(&self) -> io::Result<Self::Addr> {
        Ok(self.address)
    }
}
