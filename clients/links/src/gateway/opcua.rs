//! Links over OPC UA, by whoever has the protocol.

use std::sync::OnceLock;
use std::time::Duration;

use super::exchange::Exchange;
use super::fault::LinkFault;
use super::link::{Found, Link};
use crate::opcua::{ABSENT, Options};

/// Makes links to OPC UA servers.
pub trait OpcUaLinks: Send + Sync {
    /// A link for the points of `exchange`, not connected yet.
    ///
    /// # Errors
    /// Settings that do not go together, or a point without a place.
    fn link(
        &self,
        url: &str,
        options: &Options,
        exchange: &Exchange,
        timeout: Duration,
    ) -> Result<Box<dyn Link>, LinkFault>;

    /// The variables that the server at `url` has.
    ///
    /// # Errors
    /// The server cannot be reached, or does not let the client in.
    fn browse(&self, url: &str, options: &Options, timeout: Duration) -> Result<Vec<Found>, LinkFault>;
}

static LINKS: OnceLock<&'static dyn OpcUaLinks> = OnceLock::new();

/// Gives the program links over OPC UA. A program has one implementation; later calls change nothing.
pub fn install(links: &'static dyn OpcUaLinks) {
    LINKS.get_or_init(|| links);
}

/// The program's links over OPC UA.
///
/// # Errors
/// The program was built without OPC UA.
pub fn links() -> Result<&'static dyn OpcUaLinks, LinkFault> {
    LINKS.get().copied().ok_or_else(|| LinkFault::Setting(ABSENT.to_owned()))
}
