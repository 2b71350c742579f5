//! Connections that come to a listener whose connections are tasks: the next one, and one with a place.
//!
//! Both never end for want of descriptors or memory: others may leave meanwhile.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, ready};
use std::time::Duration;

use onescan_base::repeated::Repeated;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::time::{Instant, Sleep};

use super::connection_limit::{ConnectionLimit, Place};

/// How long it is waited after a connection could not be taken.
const PAUSE: Duration = Duration::from_millis(100);

static NOT_TAKEN: Repeated = Repeated::new();
static REFUSED: Repeated = Repeated::new();

/// Where connections come from: a socket, or a network on virtual time.
pub trait Incoming {
    type Stream;

    /// The next connection.
    fn accept(&self) -> impl Future<Output = io::Result<(Self::Stream, SocketAddr)>> + Send;
}

impl Incoming for TcpListener {
    type Stream = TcpStream;

    fn accept(&self) -> impl Future<Output = io::Result<(TcpStream, SocketAddr)>> + Send {
        Self::accept(self)
    }
}

/// The next connection.
pub async fn next<From: Incoming>(listener: &From, what: &str) -> (From::Stream, SocketAddr) {
    loop {
        match listener.accept().await {
            Ok(came) => return came,
            Err(error) => {
                not_taken(what, &error);
                tokio::time::sleep(PAUSE).await;
            }
        }
    }
}

/// A connection that has a place.
#[derive(Debug)]
pub struct Admitted<Stream = TcpStream> {
    pub stream: Stream,
    pub from: SocketAddr,
    pub place: Place,
    /// The word that it must leave.
    pub leaving: oneshot::Receiver<()>,
}

/// The next connection for which there is room.
pub async fn admitted<From: Incoming>(listener: &From, limit: &ConnectionLimit, what: &str) -> Admitted<From::Stream> {
    loop {
        let (stream, from) = next(listener, what).await;
        match limit.admit_task(from.ip()) {
            Some((place, leaving)) => return Admitted { stream, from, place, leaving },
            None => refused(what, from),
        }
    }
}

/// Reports, not too often, that a connection could not be taken, as where there are no descriptors. All listeners of the
/// process are counted together: what the system has no more of, none of them has.
pub fn not_taken(what: &str, error: &io::Error) {
    if let Some(times) = NOT_TAKEN.again() {
        tracing::warn!("cannot accept a connection to {what}: {error}{times}");
    }
}

/// Reports, not too often, that there was no room for a connection.
pub fn refused(what: &str, from: SocketAddr) {
    if let Some(times) = REFUSED.again() {
        tracing::warn!("refused a connection to {what} from {from}: all places are taken{times}");
    }
}

/// A connection's right to stay.
#[derive(Clone, Debug)]
pub struct Pass(Arc<(Place, AtomicBool)>);

impl Pass {
    /// From now on the connection leaves for nobody, and may be silent for as long as it likes. False if it had to leave
    /// already, or too many stay.
    #[must_use]
    pub fn stay(&self) -> bool {
        let (place, stays) = &*self.0;
        let may = place.stay();
        stays.store(may, Ordering::Release);
        may
    }
}

/// A connection that leaves when it must, and when nothing has been written to it for too long.
#[derive(Debug)]
pub struct Guarded<S> {
    stream: S,
    pass: Pass,
    /// Says that it must leave; nothing once it has been said.
    leaving: Option<oneshot::Receiver<()>>,
    patience: Duration,
    /// How long one that stays may be without an answer; as long as it likes without.
    idle: Option<Duration>,
    over: Pin<Box<Sleep>>,
}

impl<S> Guarded<S> {
    /// Guards `stream`, which may be without an answer, or a part of one, for `patience`: idle, with half a request, or not
    /// reading.
    pub fn new(stream: S, place: Place, leaving: oneshot::Receiver<()>, patience: Duration) -> Self {
        let pass = Pass(Arc::new((place, AtomicBool::new(false))));
        let over = Box::pin(tokio::time::sleep(patience));
        Self { stream, pass, leaving: Some(leaving), patience, idle: None, over }
    }

    /// The same for a connection that is left, too, once it stays and has been without an answer for `idle`.
    #[must_use]
    pub fn idle_for(mut self, idle: Option<Duration>) -> Self {
        self.idle = idle;
        self
    }

    /// Its right to stay.
    pub fn pass(&self) -> Pass {
        self.pass.clone()
    }

    fn stays(&self) -> bool {
        self.pass.0.1.load(Ordering::Acquire)
    }

    /// Whether the connection may go on.
    fn check(&mut self, context: &mut Context<'_>) -> io::Result<()> {
        let stays = self.stays();
        if stays && self.idle.is_none() {
            return Ok(());
        }
        let must_leave = match &mut self.leaving {
            _ if stays => false,
            Some(leaving) => Pin::new(leaving).poll(context).is_ready(),
            None => true,
        };
        if must_leave {
            self.leaving = None;
            return Err(io::Error::new(io::ErrorKind::ConnectionAborted, "it has left for one who came later"));
        }
        match self.over.as_mut().poll(context) {
            Poll::Ready(()) => {
                Err(io::Error::new(io::ErrorKind::TimedOut, "it has been without an answer for too long"))
            }
            Poll::Pending => Ok(()),
        }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Guarded<S> {
    fn poll_read(mut self: Pin<&mut Self>, context: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        self.check(context)?;
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Guarded<S> {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.check(context)?;
        let written = ready!(Pin::new(&mut self.stream).poll_write(context, bytes))?;
        let patience = self.idle.filter(|_| self.stays()).unwrap_or(self.patience);
        let until = Instant::now() + patience;
        self.over.as_mut().reset(until);
        Poll::Ready(Ok(written))
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    use super::super::connection_limit::Limits;
    use super::*;

    const LIMITS: Limits = Limits { all: 1, of_address: 1, staying: 1 };

    async fn listener() -> (TcpListener, SocketAddr) {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.unwrap();
        let address = listener.local_addr().unwrap();
        (listener, address)
    }

    fn run(test: impl Future<Output = ()>) {
        tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(test);
    }

    /// Reads until the guard ends the connection, and gives why it did.
    async fn ended(mut guarded: Guarded<TcpStream>) -> io::ErrorKind {
        guarded.read(&mut [0]).await.unwrap_err().kind()
    }

    #[test]
    fn who_says_nothing_leaves_in_time_and_for_others() {
        run(async {
            let ((listener, address), limit) = (listener().await, ConnectionLimit::new(LIMITS));
            let _silent = TcpStream::connect(address).await.unwrap();
            let Admitted { stream, place, leaving, .. } = admitted(&listener, &limit, "a test").await;
            assert_eq!(ended(Guarded::new(stream, place, leaving, PAUSE)).await, io::ErrorKind::TimedOut);
            let _first = TcpStream::connect(address).await.unwrap();
            let first = admitted(&listener, &limit, "a test").await;
            let first = Guarded::new(first.stream, first.place, first.leaving, Duration::from_mins(1));
            let _second = TcpStream::connect(address).await.unwrap();
            let _place = admitted(&listener, &limit, "a test").await;
            assert_eq!(ended(first).await, io::ErrorKind::ConnectionAborted);
        });
    }

    #[test]
    fn who_stays_may_be_silent_and_leaves_for_nobody() {
        run(async {
            let ((listener, address), limit) = (listener().await, ConnectionLimit::new(LIMITS));
            let mut client = TcpStream::connect(address).await.unwrap();
            let Admitted { stream, place, leaving, .. } = admitted(&listener, &limit, "a test").await;
            let mut guarded = Guarded::new(stream, place, leaving, Duration::ZERO);
            assert!(guarded.pass().stay());
            let mut refused = TcpStream::connect(address).await.unwrap();
            let waiting = tokio::time::timeout(PAUSE, admitted(&listener, &limit, "a test"));
            assert!(waiting.await.is_err(), "there is no room");
            assert_eq!(refused.read(&mut [0]).await.unwrap_or(0), 0, "it is closed");
            client.write_all(b"x").await.unwrap();
            assert_eq!(guarded.read(&mut [0]).await.unwrap(), 1);
        });
    }
}
