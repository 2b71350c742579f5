//! The mapping that goes with an instrumented project whose variables lie at addresses, as a part of a `scenario.toml`.

use std::collections::BTreeMap;

use onescan_iec_project::instrument::Located;
use onescan_links::gateway::addresses::Addresses;
use onescan_links::gateway::listing::Listing;
use onescan_links::gateway::settings::Settings;
use onescan_scenario::Scenario;
use onescan_server::signal::ClientName;

use super::error::InstrumentError;
use crate::map::Fragment;
use crate::map::fragment::{Entry, Place};

/// Where a PLC of which nothing is known is looked for.
const SOMEWHERE: &str = "modbus://127.0.0.1:502";

/// A mapping, and its number, which the PLC is to show.
pub struct Mapping {
    /// The part of a `scenario.toml`.
    pub text: String,
    /// Nothing without a scenario.
    pub layout: Option<u32>,
}

/// The mapping of what lies at addresses.
///
/// # Errors
/// The scenario is wrong.
pub fn mapping(plc: Option<(&Scenario, &ClientName)>, located: &[Located]) -> Result<Mapping, InstrumentError> {
    let Some((scenario, client)) = plc else {
        let entry = |each: &Located| {
            let address = each.address.modbus()?;
            Some(Entry::Mapped { name: each.name.clone(), places: vec![Place::Only(address)] })
        };
        let entries = located.iter().filter_map(entry).collect();
        let (client, url) = ("plc".to_owned(), SOMEWHERE.to_owned());
        let fragment = Fragment { client, url, system_words: false, entries };
        return Ok(Mapping { text: fragment.to_string(), layout: None });
    };
    let declared = scenario.declared(client);
    let url = if declared.url.starts_with("modbus://") { declared.url.clone() } else { SOMEWHERE.to_owned() };
    let settings = Settings { url, system_words: None, map: addresses(located), ..declared };
    let agreed = scenario.agreement_over(client, settings)?;
    let listing = Listing::new(&agreed.settings, &agreed.exchange);
    let listing = listing.map_err(|fault| scenario.wrong_settings(client, fault))?;
    Ok(Mapping { text: Fragment::of(client, &agreed, &listing).to_string(), layout: agreed.layout })
}

/// The addresses by signal; of a signal with several variables, by variable.
fn addresses(located: &[Located]) -> BTreeMap<String, Addresses> {
    let mut all: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    for each in located {
        if let Some(address) = each.address.modbus() {
            all.entry(each.name.clone()).or_default().insert(each.variable.clone(), address);
        }
    }
    let one = |(name, places): (String, BTreeMap<String, String>)| {
        let addresses = match places.values().next() {
            Some(only) if places.len() == 1 => Addresses::One(only.clone()),
            _ => Addresses::Table(places),
        };
        (name, addresses)
    };
    all.into_iter().map(one).collect()
}
