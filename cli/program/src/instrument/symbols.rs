//! The mapping that goes with a project whose PLC has symbols, TwinCAT over ADS and CODESYS over OPC UA, as a part of a
//! `scenario.toml`.

use std::collections::BTreeMap;
use std::path::Path;

use onescan_iec_project::instrument::{Project, Target};
use onescan_links::gateway::exchange::Point;
use onescan_links::gateway::listing::Listing;
use onescan_links::gateway::settings::Settings;
use onescan_scenario::gateway::Agreement;
use onescan_xml::Element;

use crate::map::Fragment;

const ADS: &str = "ads://";
const OPC_UA: &str = "opc.tcp://";
/// Where a TwinCAT of which nothing is known is looked for.
const TWINCAT: &str = "ads://127.0.0.1";
/// The same of CODESYS.
const CODESYS: &str = "opc.tcp://127.0.0.1:4840";
/// The variables of a CODESYS, below its device and application.
const VARIABLES: &str = "nsu=CODESYSSPV3/3S/IecVarAccess;s=|var|";
/// The device that a new project of CODESYS has on a PC, and its application.
const APPLICATION: &str = "CODESYS Control Win V3 x64.Application";
/// The list of the shim's own variables.
const WORDS: &str = "SDSP";

/// The link that the target has, if the scenario has none with addresses of another kind: its PLC has no words about itself.
pub(super) fn settings(target: Target, declared: Settings) -> Settings {
    let (scheme, somewhere) = match target {
        Target::TwinCat => (ADS, TWINCAT),
        Target::Codesys => (OPC_UA, CODESYS),
        Target::Iec | Target::Scl | Target::OpenPlc | Target::Beremiz => return declared,
    };
    if declared.url.starts_with(scheme) || !declared.map.is_empty() {
        return declared;
    }
    Settings { url: somewhere.to_owned(), system_words: None, ..declared }
}

/// The mapping; nothing for another target, or another link.
pub(super) fn mapping(target: Target, agreed: &Agreement, project: &Project) -> Option<String> {
    match target {
        Target::TwinCat if agreed.settings.url.starts_with(ADS) => Some(text(agreed, &listing(agreed)?)),
        Target::Codesys if agreed.settings.url.starts_with(OPC_UA) => {
            let lists = global_lists(project);
            let mut listing = listing(agreed)?;
            let rows = listing.to_plc.rows.iter_mut().chain(&mut listing.from_plc.rows);
            rows.filter(|row| row.point.address.is_none()).for_each(|row| row.address = node(&row.point, &lists));
            let map = text(agreed, &listing);
            Some(format!(
                "# Nodes of the device and application `{APPLICATION}`: another one has its name in all of them.\n\
                 # `onescan browse --map` writes them as the PLC has them. The symbol configuration must hold the variables.\n\
                 {map}"
            ))
        }
        _ => None,
    }
}

/// The points over a link with symbols, where each has a place: none only for a URL that names no link, and its scheme has
/// been looked at.
fn listing(agreed: &Agreement) -> Option<Listing> {
    Listing::new(&agreed.settings, &agreed.exchange).ok()
}

fn text(agreed: &Agreement, listing: &Listing) -> String {
    Fragment::of(&agreed.request.name, agreed, listing).to_string()
}

/// The node of a variable in CODESYS: global ones are in lists.
fn node(point: &Point, lists: &BTreeMap<String, String>) -> String {
    let symbol = point.symbol();
    let path = if point.is_word() {
        format!("{WORDS}.{}", point.name)
    } else {
        let root = symbol.split(['.', '[']).next().unwrap_or(symbol).to_ascii_uppercase();
        lists.get(&root).map_or_else(|| symbol.to_owned(), |list| format!("{list}.{symbol}"))
    };
    format!("{VARIABLES}{APPLICATION}.{path}")
}

/// The list of each global variable, by its name in capitals.
fn global_lists(project: &Project) -> BTreeMap<String, String> {
    let mut lists = BTreeMap::new();
    let files = project.files.iter().filter(|file| is_xml(&file.name)).filter_map(|file| file.text.as_deref());
    // What was emitted has been checked already.
    for root in files.filter_map(|text| onescan_xml::parse(text).ok()) {
        for list in root.tree().filter(|element| element.name == "globalVars") {
            let name_of = |element: &Element| element.attribute("name").map(|name| name.value.clone());
            let Some(name) = name_of(list) else { continue };
            let variables = list.elements().filter_map(name_of);
            lists.extend(variables.map(|variable| (variable.to_ascii_uppercase(), name.clone())));
        }
    }
    lists
}

fn is_xml(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xml"))
}
