//! The server of a session's information model.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use opcua::server::address_space::AddressSpace;
use opcua::server::node_manager::ServerContext;
use opcua::server::node_manager::memory::InMemoryNodeManagerBuilder;

use super::board::Board;
use super::manager::SessionNodes;
use crate::server::{self, Admitted, Channels, Running};
use onescan_links::opcua::{Access, Refusals, ServeError};

/// How long clients may take to notice that the session is over, wall clock.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// A server that runs until this is dropped; then clients that take part are let to hear of the end.
pub struct Service {
    board: Arc<Board>,
    refusals: Refusals,
    running: Running,
}

impl Service {
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.running.address()
    }

    /// Why somebody was not let in last.
    pub fn refused(&self) -> Option<String> {
        self.refusals.last()
    }

    /// Its endpoint, as an OPC UA client takes it.
    pub fn url(&self) -> String {
        format!("opc.tcp://{}/", self.address())
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        // A session that came to no end of its own is over for its clients all the same.
        self.board.end("stopped");
        self.board.close(CLOSE_TIMEOUT);
    }
}

/// Serves the session on `board` at `address`.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub fn serve(address: SocketAddr, board: &Arc<Board>, access: &Access) -> Result<Service, ServeError> {
    let nodes = Arc::clone(board);
    let refusals = Refusals::default();
    let sent_away = (!access.foreign_uris).then(|| refusals.clone());
    let channels = Channels::default();
    let open = channels.clone();
    let register = access.register.clone();
    let build = move |context: ServerContext, space: &mut AddressSpace| {
        Admitted::new(SessionNodes::new(nodes, open, &context, space), sent_away, register)
    };
    let manager = InMemoryNodeManagerBuilder::new(build);
    let running = server::start(address, "session", access, &refusals, &channels, manager, |_| Ok(()))?;
    Ok(Service { board: Arc::clone(board), refusals, running })
}
