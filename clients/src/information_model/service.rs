//! The server of a session's information model.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use opcua::server::address_space::AddressSpace;
use opcua::server::node_manager::ServerContext;
use opcua::server::node_manager::memory::InMemoryNodeManagerBuilder;

use super::board::Board;
use super::manager::SessionNodes;
use crate::opcua_server::{self, Access, Running, ServeError};

/// How long clients may take to notice that the session is over, wall clock.
const FAREWELL_TIMEOUT: Duration = Duration::from_secs(1);

/// A server that runs until this is dropped; then clients that take part are let to hear of the end.
pub struct Service {
    board: Arc<Board>,
    running: Running,
}

impl Service {
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.running.address()
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
        self.board.farewell(FAREWELL_TIMEOUT);
    }
}

/// Serves the session on `board` at `address`.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub fn serve(address: SocketAddr, board: &Arc<Board>, access: &Access) -> Result<Service, ServeError> {
    let nodes = Arc::clone(board);
    let build = move |context: ServerContext, space: &mut AddressSpace| SessionNodes::new(nodes, &context, space);
    let running = opcua_server::start(address, "session", access, InMemoryNodeManagerBuilder::new(build), |_| Ok(()))?;
    Ok(Service { board: Arc::clone(board), running })
}
