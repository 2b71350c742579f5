//! Where a PLC connects that is the TCP client: one at a time. Until it has sent a block it may be anybody, and gives way to
//! one who comes.

use onescan_base::notice::NOTICE;
use onescan_base::repeated::Repeated;
use onescan_base::threads;
use onescan_server::transport::accept::not_taken;
use onescan_server::transport::connection_limit::{ConnectionLimit, Place};
use onescan_server::transport::listeners;
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::listener::bind;

/// How often the thread that accepts looks whether somebody has come.
const GLANCE: Duration = Duration::from_millis(10);

/// A listener, and the connection of the PLC.
pub struct PlcListener {
    address: SocketAddr,
    shared: Arc<Shared>,
}

struct Shared {
    limit: ConnectionLimit,
    state: Mutex<State>,
    came: Condvar,
}

#[derive(Default)]
struct State {
    /// Has connected and is not served yet.
    waiting: Option<TcpStream>,
    inside: Option<Inside>,
    strangers: Repeated,
    is_closed: bool,
}

/// Whose connection is served, or waits for it.
struct Inside {
    peer: SocketAddr,
    /// It stays once it has sent a block.
    place: Place,
}

impl Shared {
    /// A thread that panicked here left whole values.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl PlcListener {
    /// Listens at `address`.
    ///
    /// # Errors
    /// It cannot be listened on, or there is no thread.
    pub fn open(address: SocketAddr) -> std::io::Result<Self> {
        let (listener, address) = bind(address)?;
        let limit = ConnectionLimit::new(listeners::PLC);
        let shared = Arc::new(Shared { limit, state: Mutex::default(), came: Condvar::new() });
        let doorkeeper = Arc::clone(&shared);
        threads::start("tcp-listen", move || attend(&listener, address, &doorkeeper))?;
        tracing::info!(target: NOTICE, "listening on tcp-listen://{address} for the PLC");
        Ok(Self { address, shared })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The connection of the PLC, waited for as long as `patience`. Until [`PlcListener::leave`] nobody else is let in.
    pub fn enter(&self, patience: Duration) -> Option<TcpStream> {
        let state = self.shared.lock();
        let waited = self.shared.came.wait_timeout_while(state, patience, |state| state.waiting.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.waiting.take()
    }

    /// A block has come over the connection that [`PlcListener::enter`] gave: it keeps its place until it is over.
    pub fn heard(&self) {
        if let Some(inside) = &self.shared.lock().inside
            && !inside.place.stay()
        {
            tracing::debug!(peer = %inside.peer, "a block came from somebody who had given way already");
        }
    }

    /// The connection that [`PlcListener::enter`] gave is over: the next one is let in.
    pub fn leave(&self) {
        let mut state = self.shared.lock();
        // One that has connected since is not the one that is over.
        if state.waiting.is_none() {
            state.inside = None;
        }
    }
}

impl Drop for PlcListener {
    fn drop(&mut self) {
        self.shared.lock().is_closed = true;
    }
}

/// Lets one in, and closes the connections of others, until all is over.
fn attend(listener: &TcpListener, address: SocketAddr, shared: &Shared) {
    while !shared.lock().is_closed {
        match listener.accept() {
            Ok((stream, peer)) => admit(stream, peer, address, shared),
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => std::thread::sleep(GLANCE),
            Err(error) => {
                not_taken(&format!("tcp-listen://{address}"), &error);
                std::thread::sleep(GLANCE);
            }
        }
    }
}

fn admit(stream: TcpStream, peer: SocketAddr, address: SocketAddr, shared: &Shared) {
    let Ok(silent) = stream.try_clone() else {
        tracing::debug!(%peer, "a connection at tcp-listen://{address} is closed: there is no descriptor for it");
        return;
    };
    let mut state = shared.lock();
    let place = shared.limit.admit(peer.ip(), move || {
        // It may be gone already.
        let _ = silent.shutdown(Shutdown::Both);
    });
    if let Some(place) = place {
        tracing::info!(%peer, "a PLC has connected");
        (state.waiting, state.inside) = (Some(stream), Some(Inside { peer, place }));
        shared.came.notify_all();
        return;
    }
    // The connection is closed when it is dropped.
    let plc = state.inside.as_ref().map(|inside| inside.peer);
    if let Some(plc) = plc
        && let Some(times) = state.strangers.again()
    {
        tracing::info!(target: NOTICE, "a second connection to tcp-listen://{address}, from {peer}, is closed: the PLC is connected from {plc}{times}");
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn one_at_a_time_is_let_in() {
        let plc_listener = PlcListener::open(SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
        assert!(plc_listener.enter(Duration::ZERO).is_none());
        let plc = TcpStream::connect(plc_listener.address()).unwrap();
        let inside = plc_listener.enter(Duration::from_mins(1)).unwrap();
        assert_eq!(inside.peer_addr().unwrap(), plc.local_addr().unwrap());
        plc_listener.heard();
        let mut second = TcpStream::connect(plc_listener.address()).unwrap();
        assert_eq!(second.read(&mut [0]).unwrap_or(0), 0, "it is closed");
        plc_listener.leave();
        let back = TcpStream::connect(plc_listener.address()).unwrap();
        assert_eq!(
            plc_listener.enter(Duration::from_mins(1)).unwrap().peer_addr().unwrap(),
            back.local_addr().unwrap()
        );
    }

    #[test]
    fn who_has_said_nothing_gives_way() {
        let plc_listener = PlcListener::open(SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
        let mut stranger = TcpStream::connect(plc_listener.address()).unwrap();
        let _silent = plc_listener.enter(Duration::from_mins(1)).unwrap();
        let plc = TcpStream::connect(plc_listener.address()).unwrap();
        let inside = plc_listener.enter(Duration::from_mins(1)).unwrap();
        assert_eq!(inside.peer_addr().unwrap(), plc.local_addr().unwrap());
        assert_eq!(stranger.read(&mut [0]).unwrap_or(0), 0, "it is closed");
    }

    #[test]
    fn an_address_in_use_is_refused() {
        let plc_listener = PlcListener::open(SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
        assert_eq!(
            PlcListener::open(plc_listener.address()).err().map(|error| error.kind()),
            Some(std::io::ErrorKind::AddrInUse)
        );
    }
}
