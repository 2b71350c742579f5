//! The mapping that goes with a project for TIA Portal: its data blocks over S7 communication, as a part of a
//! `scenario.toml`.

use std::collections::BTreeMap;

use onescan_iec_project::instrument::{DB_FROM_PLC, DB_TO_PLC, goes_in_blocks};
use onescan_links::gateway::listing::Listing;
use onescan_links::gateway::s7::Options;
use onescan_links::gateway::settings::Settings;
use onescan_links::gateway::tcp::Declaration;
use onescan_scenario::gateway::Agreement;

use crate::map::Fragment;

/// Where a PLC of which nothing is known is looked for.
const SOMEWHERE: &str = "s7://192.168.0.1";

/// The link to the blocks that the shim declares: they have its layout and its numbers, and hold no words about the PLC
/// itself.
pub fn settings(declared: Settings) -> Settings {
    let url = if declared.url.starts_with("s7://") { declared.url.clone() } else { SOMEWHERE.to_owned() };
    let s7 = Options { db_to_plc: DB_TO_PLC, db_from_plc: DB_FROM_PLC, ..declared.s7 };
    let (map, layout) = (BTreeMap::new(), Declaration::default());
    Settings { url, system_words: None, map, layout, s7, ..declared }
}

/// The mapping; nothing if the shim declares no blocks.
pub fn mapping(agreed: &Agreement) -> Option<String> {
    if !goes_in_blocks(&agreed.exchanged()) {
        return None;
    }
    let listing = Listing::new(&agreed.settings, &agreed.exchange).ok()?;
    let client = &agreed.request.name;
    let Options { rack, slot, db_to_plc, db_from_plc } = agreed.settings.s7;
    let map = Fragment::of(client, agreed, &listing);
    Some(format!(
        "{map}\n[clients.{client}.gateway.s7]\nrack = {rack}\nslot = {slot}\ndb_to_plc = {db_to_plc}\ndb_from_plc = \
         {db_from_plc}\n"
    ))
}
