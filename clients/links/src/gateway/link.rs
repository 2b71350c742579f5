//! The interface of all links.

use std::time::Duration;

use onescan_server::signal::SignalType;

use super::fault::{LinkFault, Partial};

/// A way to write and read the points of an [`super::Exchange`], whatever the protocol.
///
/// A link receives its points when it is made. It carries their packed bytes; what they mean is not its business.
pub trait Link: Send {
    /// Connects, in place of any connection before, and holds every point against the PLC: that it is there,
    /// its type, whether it may be written.
    ///
    /// # Errors
    /// See [`LinkFault`]; one that is not transient stays so.
    fn connect(&mut self) -> Result<(), LinkFault>;

    /// Writes all points to the PLC, in their order.
    ///
    /// # Errors
    /// The connection is gone, or the PLC refuses.
    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault>;

    /// Reads all points from the PLC, in their order. A link that is notified of changes waits for one as long as
    /// `patience`; false if there was none.
    ///
    /// # Errors
    /// The connection is gone, or what came is not a value.
    fn read(&mut self, patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault>;

    /// The block that has begun to come and does not go on, for a link that cuts blocks from a stream.
    fn broken_off(&self) -> Option<Partial> {
        None
    }

    /// True for a link that asks the PLC each time, false for one to which the PLC sends its changes.
    fn is_polled(&self) -> bool {
        true
    }
}

/// A variable that a PLC says it has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Its name, for people.
    pub name: String,
    /// How a map writes it.
    pub address: String,
    /// Its type, if a signal can have it.
    pub ty: Option<SignalType>,
    /// True if a client may write it.
    pub is_writable: bool,
}
