//! What is asked for.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use onescan_links::opcua::Access;
use onescan_scenario::Mode;
use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;

/// All options of a PLC.
#[derive(Clone, Debug)]
pub struct PlcConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// Which of its soft PLCs.
    pub client: Option<ClientName>,
    /// Driven in lockstep, or on its own clock as without the shim.
    pub mode: Mode,
    /// How often it scans.
    pub cycle: Cycle,
    /// Where its data blocks are served.
    pub tcp: Option<SocketAddr>,
    /// Where a gateway listens to which its data blocks go over raw TCP.
    pub tcp_connect: Option<SocketAddr>,
    /// How often its block is sent over raw TCP, wall clock; when there is reason to if absent.
    pub push: Option<TimeSpan>,
    /// Where its data blocks are served over ISO-on-TCP.
    pub s7: Option<SocketAddr>,
    /// Where its registers are served over Modbus TCP.
    pub modbus: Option<SocketAddr>,
    /// Where its symbols are served over ADS.
    pub ads: Option<SocketAddr>,
    /// Where its variables are served over OPC UA.
    pub opcua: Option<SocketAddr>,
    /// Who is let in there.
    pub access: Access,
}

/// How often a PLC scans, wall clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// On a grid of this.
    Every(TimeSpan),
    /// As soon as the last cycle has ended.
    Continuous,
}

impl Cycle {
    /// The grid, if there is one.
    pub fn interval(self) -> Option<Duration> {
        match self {
            Self::Every(span) => Some(Duration::from_nanos(span.as_nanos())),
            Self::Continuous => None,
        }
    }
}

impl FromStr for Cycle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "max" {
            return Ok(Self::Continuous);
        }
        text.parse().map(Self::Every).map_err(|error| format!("write a time as in `1ms`, or `max`: {error}"))
    }
}
