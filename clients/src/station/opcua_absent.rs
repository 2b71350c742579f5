//! The OPC UA server of a program without OPC UA.

use std::net::SocketAddr;
use std::sync::Arc;

use super::controller::Controller;
use crate::opcua_server::{ABSENT, Access, Running, ServeError};

/// Says that there is none.
///
/// # Errors
/// Always.
pub fn serve(_address: SocketAddr, _controller: &Arc<Controller>, _access: &Access) -> Result<Running, ServeError> {
    Err(ServeError::Absent(ABSENT))
}
