//! A mapping as a part of a `scenario.toml`: `[clients.NAME.gateway]` and its `map`. Whatever writes a mapping writes it
//! here.

use std::collections::BTreeMap;
use std::fmt;

use onescan_links::gateway::addresses::ALL;
use onescan_links::gateway::exchange::Words;
use onescan_links::gateway::listing::{Listing, Row};
use onescan_scenario::gateway::Agreement;
use onescan_server::signal::ClientName;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fragment {
    /// The client that speaks for the PLC.
    pub client: String,
    /// Where the PLC is.
    pub url: String,
    /// True if the PLC serves words about itself.
    pub system_words: bool,
    /// The signals and words in their order.
    pub entries: Vec<Entry>,
}

/// A line of the mapping.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Entry {
    /// A signal or word and its places.
    Mapped {
        /// The signal or word.
        name: String,
        /// The address of each of its points.
        places: Vec<Place>,
    },
    /// Something that a person must decide, in words.
    Note(String),
}

/// Where a point is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The only one of its name.
    Only(String),
    /// One of several of which nothing more is known.
    Next(String),
    /// A variable by its path, and its address.
    Of(String, String),
}

impl Fragment {
    /// The mapping with every address written out.
    pub fn of(client: &ClientName, agreed: &Agreement, listing: &Listing) -> Self {
        let place = |Row { point, address }: &Row| {
            let is_several = agreed.layout.is_some() && point.variable.is_none() && !point.is_word();
            match (&point.variable, point.ordinal) {
                (Some(path), Some(_)) => Place::Of(path.clone(), address.clone()),
                (None, Some(_)) => Place::Next(address.clone()),
                (None, None) if is_several => Place::Of(ALL.to_owned(), address.clone()),
                (_, None) => Place::Only(address.clone()),
            }
        };
        let rows = listing.to_plc.rows.iter().chain(&listing.from_plc.rows);
        let places = by_name(rows.map(|row| (row.point.name.as_str(), place(row))));
        let entries =
            places.into_iter().map(|(name, places)| Entry::Mapped { name: name.to_owned(), places }).collect();
        Self {
            client: client.to_string(),
            url: agreed.settings.url.clone(),
            system_words: agreed.exchange.words() == Words::WithSystem,
            entries,
        }
    }
}

/// What has the same name together, in the order in which the names come first.
pub(crate) fn by_name<'n, T>(items: impl IntoIterator<Item = (&'n str, T)>) -> Vec<(&'n str, Vec<T>)> {
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut groups: Vec<(&str, Vec<T>)> = Vec::new();
    for (name, item) in items {
        let place = *places.entry(name).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, group)) => group.push(item),
            None => groups.push((name, vec![item])),
        }
    }
    groups
}

impl fmt::Display for Fragment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { client, url, system_words, entries } = self;
        writeln!(f, "[clients.{client}.gateway]\nurl = {}", quoted(url))?;
        if *system_words {
            writeln!(f, "system_words = true")?;
        }
        writeln!(f, "\n[clients.{client}.gateway.map]")?;
        entries.iter().try_for_each(|entry| writeln!(f, "{entry}"))
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, places) = match self {
            Self::Note(text) => return write!(f, "# {}", text.replace('\n', "\n# ")),
            Self::Mapped { name, places } => (name, places),
        };
        write!(f, "{} = ", key(name))?;
        let pair = |place: &Place| match place {
            Place::Of(path, address) => format!("{} = {}", quoted(path), quoted(address)),
            Place::Only(address) | Place::Next(address) => quoted(address),
        };
        let all: Vec<String> = places.iter().map(pair).collect();
        match places.first() {
            Some(Place::Of(..)) => write!(f, "{{ {} }}", all.join(", ")),
            Some(Place::Next(_)) => write!(f, "[{}]", all.join(", ")),
            _ => write!(f, "{}", all.join("")),
        }
    }
}

/// TOML's strings are JSON's, for what a name or an address holds.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A key, in quotes where it needs them.
fn key(name: &str) -> String {
    let is_bare = !name.is_empty() && name.chars().all(|one| one.is_ascii_alphanumeric() || matches!(one, '_' | '-'));
    if is_bare { name.to_owned() } else { quoted(name) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_read_as_it_was_meant() {
        let of = |path: &str, address: &str| Place::Of(path.to_owned(), address.to_owned());
        let mapped = |name: &str, places: Vec<Place>| Entry::Mapped { name: name.to_owned(), places };
        let next = |address: &str| Place::Next(address.to_owned());
        let fragment = Fragment {
            client: "plc".to_owned(),
            url: "modbus://h".to_owned(),
            system_words: true,
            entries: vec![
                mapped("a.b", vec![Place::Only("ns=3;s=\"DB\".\"x\"".to_owned())]),
                mapped("c", vec![of("P.c", "hr:1"), of("Q.c", "hr:2")]),
                mapped("d", vec![of(ALL, "hr:3")]),
                mapped("e", vec![next("hr:4"), next("hr:5")]),
                Entry::Note("f was not found\nat all".to_owned()),
            ],
        };
        let text = fragment.to_string();
        insta::assert_snapshot!(text);
        let read: toml::Table = text.parse().unwrap();
        let map = &read["clients"]["plc"]["gateway"]["map"];
        assert_eq!(map["a.b"].as_str(), Some("ns=3;s=\"DB\".\"x\""));
        assert_eq!(map["c"]["Q.c"].as_str(), Some("hr:2"));
        assert_eq!(map["e"][1].as_str(), Some("hr:5"));
    }
}
