//! Where connections to a page come in: how many there are, how long one may say nothing, and TLS where there is a
//! certificate.
//!
//! A browser's connections come and go with its requests; each has [`PATIENCE`] from one answer to the next. Only a viewer's
//! connection stays. So whoever connects and says nothing, or half a request, or does not read, is gone after a while, and
//! gives way before to one who comes ([`ConnectionLimit`]). Descriptors are left for the session's own files.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, ready};
use std::time::Duration;

use axum::extract::connect_info::Connected;
use axum::serve::{IncomingStream, Listener};
use onescan_server::transport::connection_limit::{ConnectionLimit, Limits, Place};
use onescan_server::transport::tls::Identity;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{mpsc, oneshot};
use tokio::time::{Instant, Sleep};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

/// How long a handshake may take.
const HANDSHAKE: Duration = Duration::from_secs(5);
/// How long a connection may be without an answer, or a part of one: idle, with half a request, or not reading.
const PATIENCE: Duration = Duration::from_secs(30);
/// How long it is waited after a connection could not be taken, as where there are too many files.
const PAUSE: Duration = Duration::from_millis(100);
/// Connections at a time, if there are descriptors enough.
const CONNECTIONS_MAX: usize = 256;
/// Connections that there is always room for, however few descriptors there are.
const CONNECTIONS_MIN: usize = 8;

/// A listener of which connections come into a page.
pub struct LimitedListener {
    address: SocketAddr,
    connections: mpsc::Receiver<(Guarded, SocketAddr)>,
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
        tokio::spawn(take(listener, ConnectionLimit::new(limits()), acceptor, send));
        Ok(Self { address, connections })
    }
}

/// A quarter of the descriptors that this process may have.
fn limits() -> Limits {
    let quarter = descriptors().map_or(CONNECTIONS_MAX, |descriptors| descriptors / 4);
    let all = quarter.clamp(CONNECTIONS_MIN, CONNECTIONS_MAX);
    Limits { all, of_address: all / 2, staying: all / 2 }
}

/// How many this process may have; nothing if that is not limited.
#[cfg(unix)]
fn descriptors() -> Option<usize> {
    let limit = rustix::process::getrlimit(rustix::process::Resource::Nofile).current;
    limit.and_then(|limit| usize::try_from(limit).ok())
}

#[cfg(not(unix))]
fn descriptors() -> Option<usize> {
    None
}

async fn take(
    listener: TcpListener,
    limit: ConnectionLimit,
    acceptor: Option<TlsAcceptor>,
    connections: mpsc::Sender<(Guarded, SocketAddr)>,
) {
    while !connections.is_closed() {
        let (stream, from) = match listener.accept().await {
            Ok(came) => came,
            Err(error) => {
                tracing::debug!(%error, "a connection to the page was not taken");
                tokio::time::sleep(PAUSE).await;
                continue;
            }
        };
        let Some((place, leaving)) = limit.admit_task(from.ip()) else {
            tracing::debug!(%from, "refused a connection to the page: all places are taken by viewers");
            continue;
        };
        let (acceptor, connections) = (acceptor.clone(), connections.clone());
        tokio::spawn(async move {
            if let Some(guarded) = received(stream, from, acceptor, place, leaving).await {
                // the page may be over
                drop(connections.send((guarded, from)).await);
            }
        });
    }
}

/// A connection that has come, if it has not gone or had to leave before its handshake was over.
async fn received(
    stream: TcpStream,
    from: SocketAddr,
    acceptor: Option<TlsAcceptor>,
    place: Place,
    mut leaving: oneshot::Receiver<()>,
) -> Option<Guarded> {
    let io = match acceptor {
        None => Io::Plain(stream),
        Some(acceptor) => tokio::select! {
            _ = &mut leaving => return None,
            shaken = tokio::time::timeout(HANDSHAKE, acceptor.accept(stream)) => match shaken {
                Ok(Ok(stream)) => Io::Tls(Box::new(stream)),
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
    let connection = Arc::new(Connection { place, stays: AtomicBool::new(false) });
    Some(Guarded { io, connection, leaving: Some(leaving), patience: Box::pin(tokio::time::sleep(PATIENCE)) })
}

impl Listener for LimitedListener {
    type Io = Guarded;
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

struct Connection {
    place: Place,
    stays: AtomicBool,
}

/// The connection that a request has come by.
#[derive(Clone)]
pub(super) struct Visitor(Arc<Connection>);

impl Visitor {
    /// From now on the connection is a viewer's, on which little is said for as long as it likes. False if there are
    /// too many of them.
    pub(super) fn stay(&self) -> bool {
        let stays = self.0.place.stay();
        self.0.stays.store(stays, Ordering::Release);
        stays
    }
}

impl Connected<IncomingStream<'_, LimitedListener>> for Visitor {
    fn connect_info(stream: IncomingStream<'_, LimitedListener>) -> Self {
        Self(Arc::clone(&stream.io().connection))
    }
}

enum Io {
    Plain(TcpStream),
    Tls(Box<TlsStream<TcpStream>>),
}

/// A connection with its place and its time.
pub struct Guarded {
    io: Io,
    connection: Arc<Connection>,
    /// Says that it must leave; nothing once it has been said.
    leaving: Option<oneshot::Receiver<()>>,
    patience: Pin<Box<Sleep>>,
}

impl Guarded {
    /// Whether the connection may go on.
    fn check(&mut self, context: &mut Context<'_>) -> io::Result<()> {
        if self.connection.stays.load(Ordering::Acquire) {
            return Ok(());
        }
        let must_leave = match &mut self.leaving {
            Some(leaving) => Pin::new(leaving).poll(context).is_ready(),
            None => true,
        };
        if must_leave {
            self.leaving = None;
            return Err(io::Error::new(io::ErrorKind::ConnectionAborted, "it has left for one who came later"));
        }
        match self.patience.as_mut().poll(context) {
            Poll::Ready(()) => {
                Err(io::Error::new(io::ErrorKind::TimedOut, "it has been without an answer for too long"))
            }
            Poll::Pending => Ok(()),
        }
    }

    fn io(&mut self) -> Pin<&mut (dyn Stream + '_)> {
        match &mut self.io {
            Io::Plain(stream) => Pin::new(stream),
            Io::Tls(stream) => Pin::new(&mut **stream),
        }
    }
}

trait Stream: AsyncRead + AsyncWrite + Unpin {}

impl<T: AsyncRead + AsyncWrite + Unpin> Stream for T {}

impl AsyncRead for Guarded {
    fn poll_read(mut self: Pin<&mut Self>, context: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        self.check(context)?;
        self.io().poll_read(context, into)
    }
}

impl AsyncWrite for Guarded {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.check(context)?;
        let written = ready!(self.io().poll_write(context, bytes))?;
        self.patience.as_mut().reset(Instant::now() + PATIENCE);
        Poll::Ready(Ok(written))
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.check(context)?;
        self.io().poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.io().poll_shutdown(context)
    }
}
