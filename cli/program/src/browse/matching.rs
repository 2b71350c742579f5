//! Which variable of the PLC is which point: by the path of the variable, or else by the name of the signal where that
//! is clear. What is not clear is reported and left to a person.

use onescan_links::gateway::addresses::ALL;
use onescan_links::gateway::exchange::{BOOTS, Exchange, Point, RUNNING, START, Words};
use onescan_links::gateway::link::Found;
use onescan_server::signal::nearest;

use crate::map::fragment::{Entry, Fragment, Place, by_name};

/// The points of a scenario, each with its variable; client and URL are the caller's to name.
pub(super) fn mapped(exchange: &Exchange, found: &[Found]) -> Fragment {
    let points = exchange.to_plc().iter().chain(exchange.from_plc());
    let signals = by_name(points.filter(|point| !is_system(&point.name)).map(|point| (point.name.as_str(), point)));
    let mut entries: Vec<Entry> = signals.iter().flat_map(|(_, points)| signal(points, found)).collect();
    let system = [START.0, BOOTS.0, RUNNING.0].map(|word| (word, named(word, found)));
    let is_served = system.iter().all(|(_, hits)| hits.len() == 1);
    for (word, hits) in &system {
        if let (true, [one]) = (is_served, &hits[..]) {
            let places = vec![Place::Only(one.address.clone())];
            entries.push(Entry::Mapped { name: (*word).to_owned(), places });
        } else if exchange.words() == Words::WithSystem {
            entries.push(Entry::Note(missing(word, found)));
        }
    }
    Fragment { client: String::new(), url: String::new(), system_words: is_served, entries }
}

fn is_system(name: &str) -> bool {
    [START.0, BOOTS.0, RUNNING.0].contains(&name)
}

/// The lines of a signal, or of a word, with these points.
fn signal(points: &[&Point], found: &[Found]) -> Vec<Entry> {
    let Some(Point { name, .. }) = points.first() else { return Vec::new() };
    let hits: Vec<Vec<&Found>> = points.iter().map(|point| by_path(point, found)).collect();
    if let Some(places) = points.iter().zip(&hits).map(|(point, hits)| place(point, hits)).collect::<Option<Vec<_>>>() {
        return vec![Entry::Mapped { name: name.clone(), places }];
    }
    let ambiguous = |(point, hits): (&&Point, &Vec<&Found>)| {
        (hits.len() > 1).then(|| Entry::Note(format!("`{}` may be {}", point.label(), either(hits))))
    };
    let notes: Vec<Entry> = points.iter().zip(&hits).filter_map(ambiguous).collect();
    if !notes.is_empty() {
        return notes;
    }
    match (&named(name, found)[..], points) {
        ([one], [_]) => vec![Entry::Mapped { name: name.clone(), places: vec![Place::Only(one.address.clone())] }],
        ([one], several) => {
            let paths: Vec<String> = several.iter().map(|point| format!("`{}`", point.key())).collect();
            let all =
                Entry::Mapped { name: name.clone(), places: vec![Place::Of(ALL.to_owned(), one.address.clone())] };
            let (all_paths, address) = (paths.join(" and "), &one.address);
            vec![Entry::Note(format!(
                "`{name}` goes to {all_paths}, and {address} alone was found; if the PLC has one variable for all:\n{all}"
            ))]
        }
        ([], _) => points
            .iter()
            .zip(&hits)
            .filter(|(_, hits)| hits.is_empty())
            .map(|(point, _)| Entry::Note(missing(&point.key(), found)))
            .collect(),
        (several, _) => vec![Entry::Note(format!("`{name}` may be {}", either(several)))],
    }
}

/// The place of a point for which one variable was found.
fn place(point: &Point, hits: &[&Found]) -> Option<Place> {
    let [one] = hits else { return None };
    let address = one.address.clone();
    Some(match (&point.variable, point.ordinal) {
        (Some(path), Some(_)) => Place::Of(path.clone(), address),
        _ => Place::Only(address),
    })
}

/// The variables at whose end the point's path stands.
fn by_path<'f>(point: &Point, found: &'f [Found]) -> Vec<&'f Found> {
    let wanted = segments(point.symbol());
    found.iter().filter(|found| path_of(found).ends_with(&wanted)).collect()
}

/// The variables with the last name of `name`.
fn named<'f>(name: &str, found: &'f [Found]) -> Vec<&'f Found> {
    let wanted = segments(name).pop();
    found.iter().filter(|found| path_of(found).pop() == wanted || segments(&found.name).pop() == wanted).collect()
}

/// The path of a variable: that of its identifier where it is text, or else its name.
fn path_of(found: &Found) -> Vec<String> {
    let identifier = found.address.strip_prefix("s=").or_else(|| Some(found.address.split_once(";s=")?.1));
    segments(identifier.unwrap_or(&found.name))
}

/// The names of a path, without case and quotes.
fn segments(path: &str) -> Vec<String> {
    path.split('.').map(|name| name.trim_matches('"').to_ascii_lowercase()).collect()
}

fn either(hits: &[&Found]) -> String {
    let addresses: Vec<&str> = hits.iter().map(|found| found.address.as_str()).collect();
    addresses.join(" or ")
}

fn missing(name: &str, found: &[Found]) -> String {
    let near = nearest(name, found.iter().map(|found| found.name.as_str()));
    let near = near.and_then(|near| found.iter().find(|found| found.name == near));
    let near = near.map(|near| format!("; perhaps {}", near.address)).unwrap_or_default();
    format!("{name} was not found{near}")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use onescan_links::gateway::exchange::{Feed, Target};
    use onescan_server::signal::{Port, SignalName, SignalType};

    use super::*;

    fn found(address: &str) -> Found {
        // Over ADS a variable's name is its path, over OPC UA it is the last of it.
        let is_node = address.contains("s=");
        let name = if is_node { address.rsplit('.').next().unwrap_or(address) } else { address }.to_owned();
        Found { name, address: address.to_owned(), ty: Some(SignalType::BOOL), is_writable: true }
    }

    fn mapped_to(addresses: &[&str]) -> String {
        let port = Port { name: SignalName::new("go").unwrap(), ty: SignalType::BOOL };
        let target = |path: &str| Target { variable: Some(path.to_owned()), address: None };
        let inputs = [Feed { port: port.clone(), targets: vec![target("P.go"), target("Q.go")] }];
        let done = Port { name: SignalName::new("Done").unwrap(), ..port };
        let outputs = [Feed { port: done, targets: vec![target("P.Done")] }];
        let exchange = Exchange::new(&inputs, &outputs, Words::WithSystem, &BTreeMap::new());
        let all: Vec<Found> = addresses.iter().map(|address| found(address)).collect();
        let Fragment { entries, system_words, .. } = mapped(&exchange, &all);
        let lines = entries.iter().map(Entry::to_string).filter(|line| !line.contains("SDSP"));
        lines.chain([format!("system words: {system_words}")]).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn every_variable_is_found_by_its_path_and_doubt_is_reported() {
        let codesys = |path: &str| format!("ns=4;s=|var|CODESYS Control.Application.{path}");
        let all = [codesys("P.go"), codesys("Q.go"), codesys("P.Done")];
        let all: Vec<&str> = all.iter().map(String::as_str).collect();
        let reported = [
            mapped_to(&all),
            mapped_to(&["P.GO", "Q.go", "P.done", "PLC_Start", "PLC_Boots", "PLC_Running"]),
            mapped_to(&["ns=3;s=\"P\".\"go\"", "ns=3;s=\"Q\".\"go\"", "ns=3;s=\"R\".\"Done\""]),
            mapped_to(&["IO.go", "A.Done", "B.Done"]),
            mapped_to(&["A.P.go", "B.P.go", "A.Q.go", "Don"]),
            mapped_to(&["P.go", "PLC_Boots"]),
        ];
        insta::assert_snapshot!(reported.join("\n----\n"));
    }
}
