//! Variables of an OPC UA server, the PLC's side, by whoever has the protocol.

use std::net::SocketAddr;
use std::sync::{Arc, OnceLock};

use super::controller::Controller;
use crate::opcua::{ABSENT, Access, ServeError};

/// Serves a PLC's variables.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub type ServePlc = fn(SocketAddr, &Arc<Controller>, &Access) -> Result<Box<dyn ServedPlc>, ServeError>;

/// A PLC whose variables are served until this is dropped.
pub trait ServedPlc {
    /// Where the server listens.
    fn address(&self) -> SocketAddr;
}

static SERVE: OnceLock<ServePlc> = OnceLock::new();

/// Gives the program a way to serve PLCs. A program has one; later calls change nothing.
pub fn install(serve: ServePlc) {
    SERVE.get_or_init(|| serve);
}

/// Serves the PLC's variables at `address`, until what is returned is dropped.
///
/// # Errors
/// The address cannot be listened on, the server cannot be set up, or the program was built without OPC UA.
pub fn serve(
    address: SocketAddr,
    controller: &Arc<Controller>,
    access: &Access,
) -> Result<Box<dyn ServedPlc>, ServeError> {
    let serve = SERVE.get().ok_or(ServeError::Absent(ABSENT))?;
    serve(address, controller, access)
}
