//! What a scenario says of an ADS link.

use schemars::JsonSchema;
use serde::Deserialize;

use super::frame::NetId;
use crate::gateway::exchange::Point;

/// The keys of `[clients.NAME.gateway.ads]`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// AMS `NetId` of the PLC; without it its IP address and `.1.1`.
    #[schemars(with = "Option<String>")]
    pub net_id: Option<NetId>,
    /// AMS port of the PLC: 851 is the first of TwinCAT 3, 801 that of TwinCAT 2.
    pub port: u16,
    /// AMS `NetId` of this gateway, as the PLC's route to it has it; without it its IP address and `.1.1`.
    #[schemars(with = "Option<String>")]
    pub source_net_id: Option<NetId>,
    /// AMS port of this gateway.
    pub source_port: u16,
    /// Global variable list with the synchronisation words; empty if they have no list in front.
    pub words: String,
}

impl Default for Options {
    fn default() -> Self {
        Self { net_id: None, port: 851, source_net_id: None, source_port: 49_874, words: "SDSP".to_owned() }
    }
}

impl Options {
    /// The symbol of a point without an address.
    pub fn symbol(&self, point: &Point) -> String {
        let has_list = point.is_word() && !self.words.is_empty();
        if has_list { format!("{}.{}", self.words, point.name) } else { point.symbol().to_owned() }
    }
}
