//! Where a PLC connects that is the TCP client: one at a time.

use onescan_base::notice::NOTICE;
use std::collections::BTreeSet;
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::listener::bind;

/// How often the thread that accepts looks whether somebody has come.
const GLANCE: Duration = Duration::from_millis(10);
/// Strangers that are reported, by address: no more, however many come.
const STRANGERS_MAX: usize = 16;

/// A listener, and the connection of the PLC.
pub struct PlcListener {
    address: SocketAddr,
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    came: Condvar,
}

#[derive(Default)]
struct State {
    /// Has connected and is not served yet.
    waiting: Option<TcpStream>,
    inside: Option<SocketAddr>,
    strangers: BTreeSet<IpAddr>,
    is_closed: bool,
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
    /// It cannot be listened on.
    pub fn open(address: SocketAddr) -> std::io::Result<Self> {
        let (listener, address) = bind(address)?;
        let shared = Arc::new(Shared::default());
        let doorkeeper = Arc::clone(&shared);
        std::thread::spawn(move || attend(&listener, address, &doorkeeper));
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
                tracing::warn!(%error, "cannot accept a connection at tcp-listen://{address}");
                std::thread::sleep(GLANCE);
            }
        }
    }
}

fn admit(stream: TcpStream, peer: SocketAddr, address: SocketAddr, shared: &Shared) {
    let mut state = shared.lock();
    if let Some(plc) = state.inside {
        // The connection is closed when it is dropped.
        if state.strangers.len() < STRANGERS_MAX && state.strangers.insert(peer.ip()) {
            tracing::info!(target: NOTICE, "a second connection to tcp-listen://{address}, from {peer}, is closed: the PLC is connected from {plc}");
        }
        return;
    }
    tracing::info!(%peer, "a PLC has connected");
    (state.waiting, state.inside) = (Some(stream), Some(peer));
    shared.came.notify_all();
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
    fn an_address_in_use_is_refused() {
        let plc_listener = PlcListener::open(SocketAddr::from(([127, 0, 0, 1], 0))).unwrap();
        assert_eq!(
            PlcListener::open(plc_listener.address()).err().map(|error| error.kind()),
            Some(std::io::ErrorKind::AddrInUse)
        );
    }
}
