//! Where connections to a page come in: how many there are, how long one may say nothing, and TLS where there is a
//! certificate.
//!
//! A browser's connections come and go with its requests; each has the time of a [`ListenerRules`] from one answer to the next. Only a viewer's
//! connection stays. So whoever connects and says nothing, or half a request, or does not read, is gone after a while, and
//! gives way before to one who comes ([`ConnectionLimit`]). Descriptors are left for the session's own files.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::extract::connect_info::Connected;
use axum::serve::{IncomingStream, Listener};
use onescan_server::transport::accept::{self, Admitted, Guarded, Pass};
use onescan_server::transport::connection_limit::ConnectionLimit;
use onescan_server::transport::listeners::{self, ListenerRules};
use onescan_server::transport::tls::Identity;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

/// How long a handshake may take.
const HANDSHAKE: Duration = Duration::from_secs(5);

/// A listener of which connections come into a page.
pub struct LimitedListener {
    address: SocketAddr,
    connections: mpsc::Receiver<(Guarded<Stream>, SocketAddr)>,
}

impl LimitedListener {
    /// Takes the connections of `listener`, on the runtime of whoever calls; with `identity` under TLS.
    ///
    /// # Errors
    /// The listener has no address.
    pub fn new(listener: TcpListener, identity: Option<&Identity>) -> io::Result<Self> {
        let address = listener.local_addr()?;
        let (send, connections) = mpsc::channel(1);
        let acceptor = identity.map(|identity| TlsAcceptor::from(identity.server_config()));
        tokio::spawn(take(listener, listeners::page(descriptors()), acceptor, send));
        Ok(Self { address, connections })
    }
}

/// How many descriptors this process may have; nothing if that is not limited.
#[cfg(unix)]
pub(crate) fn descriptors() -> Option<usize> {
    let limit = rustix::process::getrlimit(rustix::process::Resource::Nofile).current;
    limit.and_then(|limit| usize::try_from(limit).ok())
}

#[cfg(not(unix))]
pub(crate) fn descriptors() -> Option<usize> {
    None
}

async fn take(
    listener: TcpListener,
    rules: ListenerRules,
    acceptor: Option<TlsAcceptor>,
    connections: mpsc::Sender<(Guarded<Stream>, SocketAddr)>,
) {
    let limit = ConnectionLimit::new(rules.limits);
    while !connections.is_closed() {
        let admitted = accept::admitted(&listener, &limit, rules.what).await;
        let (acceptor, connections, from) = (acceptor.clone(), connections.clone(), admitted.from);
        tokio::spawn(async move {
            if let Some(guarded) = received(admitted, acceptor, rules.proof).await {
                // the page may be over
                drop(connections.send((guarded, from)).await);
            }
        });
    }
}

/// A connection that has come, if it has not gone or had to leave before its handshake was over.
async fn received(admitted: Admitted, acceptor: Option<TlsAcceptor>, patience: Duration) -> Option<Guarded<Stream>> {
    let Admitted { stream, from, place, mut leaving } = admitted;
    let stream = match acceptor {
        None => Stream::Plain(stream),
        Some(acceptor) => tokio::select! {
            _ = &mut leaving => return None,
            shaken = tokio::time::timeout(HANDSHAKE, acceptor.accept(stream)) => match shaken {
                Ok(Ok(stream)) => Stream::Tls(Box::new(stream)),
                Ok(Err(error)) => {
                    tracing::debug!(%error, %from, "no TLS came of a connection to the page");
                    return None;
                }
                Err(_) => {
                    tracing::debug!(%from, "a connection to the page did not speak");
                    return None;
                }
            },
        },
    };
    Some(Guarded::new(stream, place, leaving, patience))
}

impl Listener for LimitedListener {
    type Io = Guarded<Stream>;
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

/// The connection that a request has come by.
#[derive(Clone)]
pub(super) struct Visitor(Pass);

impl Visitor {
    /// From now on the connection is a viewer's, on which little is said for as long as it likes. False if there are
    /// too many of them.
    pub(super) fn stay(&self) -> bool {
        self.0.stay()
    }
}

impl Connected<IncomingStream<'_, LimitedListener>> for Visitor {
    fn connect_info(stream: IncomingStream<'_, LimitedListener>) -> Self {
        Self(stream.io().pass())
    }
}

/// A connection, in plain text or under TLS.
pub enum Stream {
    Plain(TcpStream),
    Tls(Box<TlsStream<TcpStream>>),
}

impl Stream {
    fn inner(&mut self) -> Pin<&mut (dyn Duplex + '_)> {
        match self {
            Self::Plain(stream) => Pin::new(stream),
            Self::Tls(stream) => Pin::new(&mut **stream),
        }
    }
}

trait Duplex: AsyncRead + AsyncWrite + Unpin {}

impl<T: AsyncRead + AsyncWrite + Unpin> Duplex for T {}

impl AsyncRead for Stream {
    fn poll_read(mut self: Pin<&mut Self>, context: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        self.inner().poll_read(context, into)
    }
}

impl AsyncWrite for Stream {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.inner().poll_write(context, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.inner().poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.inner().poll_shutdown(context)
    }
}
