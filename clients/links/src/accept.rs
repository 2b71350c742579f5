//! Connections that come to servers with a thread for each: how many there are, and how long one may take to show that it is a
//! client's.
//!
//! One that has sent a whole request stays. All others have a time for it, and give way to those who come
//! ([`ConnectionLimit`]). Where the system has no thread or descriptor to give, a connection is closed, and the next one is
//! taken.

use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use onescan_base::repeated::Repeated;
use onescan_base::threads;
use onescan_server::transport::accept::{not_taken, refused};
use onescan_server::transport::connection_limit::{ConnectionLimit, Place};
use onescan_server::transport::listeners::{IDLE_TIMEOUT, ListenerRules};

/// How often a thread that waits looks whether all is over.
pub(crate) const GLANCE: Duration = Duration::from_millis(100);
/// A client that does not take what is sent to it for so long is left.
const WRITE_TIMEOUT: Duration = Duration::from_secs(3);

static NO_THREAD: Repeated = Repeated::new();

/// The other side of a connection.
#[derive(Debug)]
pub(crate) struct Peer {
    stream: Arc<TcpStream>,
    address: SocketAddr,
    /// Nothing for one that this side has connected to.
    place: Option<Place>,
    /// When its time for a first request is over; nothing once it has sent one.
    deadline: Option<Instant>,
    /// How long it may be silent after that; as long as it likes without.
    idle: Option<Duration>,
}

impl Peer {
    /// One that this side has connected to, at `address`.
    pub(crate) fn connected(stream: TcpStream, address: SocketAddr) -> io::Result<Self> {
        prepare(&stream)?;
        Ok(Self { stream: Arc::new(stream), address, place: None, deadline: None, idle: Some(IDLE_TIMEOUT) })
    }

    /// Address and port of the other side.
    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Its connection, for those who only write to it, or close it.
    pub(crate) fn stream(&self) -> Arc<TcpStream> {
        Arc::clone(&self.stream)
    }

    /// It has sent a whole request: it leaves for nobody any more.
    ///
    /// # Errors
    /// It had to leave already, or too many stay.
    pub(crate) fn stay(&mut self) -> io::Result<()> {
        if self.place.as_ref().is_some_and(|place| !place.stay()) {
            return Err(io::Error::other("there are too many clients"));
        }
        if self.deadline.take().is_some() {
            self.stream.set_read_timeout(self.idle)?;
        }
        Ok(())
    }
}

impl Read for Peer {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if let Some(deadline) = self.deadline {
            let rest = deadline.saturating_duration_since(Instant::now());
            // A socket takes no time-out of 0.
            self.stream.set_read_timeout(Some(rest.max(Duration::from_millis(1))))?;
            if rest.is_zero() {
                return Err(io::Error::new(io::ErrorKind::TimedOut, "no request came in time"));
            }
        }
        (&*self.stream).read(into)
    }
}

impl Write for Peer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (&*self.stream).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        (&*self.stream).flush()
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.stream.shutdown(Shutdown::Both);
    }
}

/// Hands each connection to `attend`, until `is_over`.
pub(crate) fn accept(
    listener: &TcpListener,
    rules: ListenerRules,
    is_over: impl Fn() -> bool,
    mut attend: impl FnMut(Peer),
) {
    let limit = ConnectionLimit::new(rules.limits);
    while !is_over() {
        match listener.accept() {
            Ok((stream, address)) => match admitted(stream, address, &limit, rules) {
                Ok(Some(peer)) => attend(peer),
                Ok(None) => refused(rules.what, address),
                Err(error) => tracing::debug!(%address, %error, "a client has gone before it was served"),
            },
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => std::thread::sleep(GLANCE / 10),
            Err(error) => {
                not_taken(rules.what, &error);
                std::thread::sleep(GLANCE);
            }
        }
    }
}

fn admitted(
    stream: TcpStream,
    address: SocketAddr,
    limit: &ConnectionLimit,
    rules: ListenerRules,
) -> io::Result<Option<Peer>> {
    prepare(&stream)?;
    let stream = Arc::new(stream);
    let leaving = Arc::clone(&stream);
    let place = limit.admit(address.ip(), move || {
        // It may be gone already.
        let _ = leaving.shutdown(Shutdown::Both);
    });
    let deadline = Some(Instant::now() + rules.proof);
    Ok(place.map(|place| Peer { stream, address, place: Some(place), deadline, idle: rules.idle }))
}

/// Serves each connection by `serve` in a thread of its own, until `is_over`. One that goes, or says what nobody answers, is
/// let go.
pub(crate) fn serve_each<Server: Send + Sync + 'static>(
    listener: &TcpListener,
    rules: ListenerRules,
    server: &Arc<Server>,
    is_over: impl Fn() -> bool,
    serve: fn(&Server, &mut Peer) -> io::Result<()>,
) {
    accept(listener, rules, is_over, |mut peer| {
        let server = Arc::clone(server);
        let served = threads::start(rules.what, move || {
            if let Err(error) = serve(&server, &mut peer) {
                tracing::debug!(peer = %peer.address, %error, "a client has gone");
            }
        });
        if let Err(error) = served {
            not_served(rules.what, &error);
        }
    });
}

/// Reports, not too often, that there was no thread for a connection, which is closed.
pub(crate) fn not_served(what: &str, error: &io::Error) {
    if let Some(times) = NO_THREAD.again() {
        tracing::warn!("a connection to {what} is closed: {error}{times}");
    }
}

/// For requests that are answered one by one, by a thread of their own.
fn prepare(stream: &TcpStream) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(IDLE_TIMEOUT))?;
    stream.set_write_timeout(Some(WRITE_TIMEOUT))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use onescan_server::transport::connection_limit::Limits;

    use super::*;
    use crate::listener::bind;

    const DOOR: ListenerRules = ListenerRules {
        what: "a test",
        limits: Limits { all: 3, of_address: 3, staying: 2 },
        proof: Duration::from_millis(200),
        idle: None,
    };

    /// A server that gives every byte back, until it is dropped.
    struct Echo {
        address: SocketAddr,
        over: Arc<AtomicBool>,
    }

    impl Echo {
        fn start() -> Self {
            let (listener, address) = bind(SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
            let over = Arc::new(AtomicBool::new(false));
            let seen = Arc::clone(&over);
            threads::start("echo", move || {
                let server = Arc::new(());
                serve_each(
                    &listener,
                    DOOR,
                    &server,
                    || seen.load(Ordering::Acquire),
                    |(), peer| {
                        let mut byte = [0];
                        while peer.read(&mut byte)? == 1 {
                            peer.stay()?;
                            peer.write_all(&byte)?;
                        }
                        Ok(())
                    },
                );
            })
            .unwrap();
            Self { address, over }
        }

        fn connect(&self) -> TcpStream {
            let stream = TcpStream::connect(self.address).unwrap();
            stream.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
            stream
        }
    }

    impl Drop for Echo {
        fn drop(&mut self) {
            self.over.store(true, Ordering::Release);
        }
    }

    /// Whether the server answers.
    fn speaks(mut stream: &TcpStream) -> bool {
        let mut byte = [0];
        stream.write_all(b"x").is_ok() && matches!(stream.read(&mut byte), Ok(1))
    }

    #[test]
    fn who_says_nothing_is_closed_in_time() {
        let echo = Echo::start();
        let speaker = echo.connect();
        assert!(speaks(&speaker));
        assert_eq!(echo.connect().read(&mut [0]).unwrap_or(0), 0);
        assert!(speaks(&speaker), "who has spoken stays beyond that time");
    }

    #[test]
    fn strangers_keep_no_client_out() {
        let echo = Echo::start();
        let speaker = echo.connect();
        assert!(speaks(&speaker));
        let silent: Vec<TcpStream> = (0..20).map(|_| echo.connect()).collect();
        let late = echo.connect();
        assert!(speaks(&late) && speaks(&speaker));
        assert!(!speaks(&echo.connect()), "no more than two may stay");
        drop(silent);
    }
}
