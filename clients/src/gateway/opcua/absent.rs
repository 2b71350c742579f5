//! The link of a program without OPC UA.

use std::convert::Infallible;
use std::time::Duration;

use super::Options;
use crate::gateway::exchange::Exchange;
use crate::gateway::fault::LinkFault;
use crate::gateway::link::{Found, Link};
use crate::opcua_server::ABSENT;

/// A link to an OPC UA server; there is none.
pub struct OpcUaLink {
    never: Infallible,
}

impl OpcUaLink {
    /// Says that there is none.
    ///
    /// # Errors
    /// Always.
    pub fn new(_url: &str, _options: Options, _exchange: &Exchange, _timeout: Duration) -> Result<Self, LinkFault> {
        Err(LinkFault::Setting(ABSENT.to_owned()))
    }

    /// What the server has.
    ///
    /// # Errors
    /// None: there is no link to ask.
    pub fn browse(&mut self) -> Result<Vec<Found>, LinkFault> {
        match self.never {}
    }
}

impl Link for OpcUaLink {
    fn connect(&mut self) -> Result<(), LinkFault> {
        match self.never {}
    }

    fn write(&mut self, _to_plc: &[u8]) -> Result<(), LinkFault> {
        match self.never {}
    }

    fn read(&mut self, _patience: Duration, _from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        match self.never {}
    }
}
