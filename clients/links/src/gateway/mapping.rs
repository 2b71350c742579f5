//! The points of a PLC: which variables each signal has, and the address of each.
//!
//! Every variable that the soft PLC feeds must be reached: a mapping that leaves one out runs to its end with a wrong
//! digest, so it is refused before anything has begun.

use std::collections::BTreeMap;

use onescan_base::did_you_mean;
use onescan_server::signal::{Port, SignalType};

use super::addresses::{ALL, Addresses};
use super::exchange::{Direction, Exchange, Feed, Point, Target, Words, is_word};
use super::fault::MappingFault;
use onescan_soft_plc::bind::{Bound, Place};

/// A signal, and the variables that it is in the PLC.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variables {
    /// The signal as the session has it.
    pub port: Port,
    /// The paths of its variables, each of them a place of its own; empty if nothing is known of the PLC's program.
    pub paths: Vec<String>,
}

impl Variables {
    /// The variables that a signal is bound to; one that is reached by two paths counts once.
    pub fn of(bound: &Bound) -> Self {
        let mut places = Vec::new();
        let is_new = |place: &Place| {
            let is_new = !places.contains(place);
            if is_new {
                places.push(*place);
            }
            is_new
        };
        let seen: Vec<bool> = bound.places.iter().map(is_new).collect();
        let paths = bound.variables.iter().zip(seen).filter(|(_, is_new)| *is_new).map(|(path, _)| path.clone());
        Self { port: bound.port.clone(), paths: paths.collect() }
    }

    /// A signal of which nothing more is known.
    pub fn unknown(port: Port) -> Self {
        Self { port, paths: Vec::new() }
    }
}

/// The points of a PLC that reads `inputs` and writes `outputs`, at the addresses of `map`.
///
/// # Errors
/// A key that is not a signal or word; a variable without an address, or with that of another one.
pub fn exchange(
    inputs: &[Variables],
    outputs: &[Variables],
    words: Words,
    map: &BTreeMap<String, Addresses>,
) -> Result<Exchange, MappingFault> {
    let names = || inputs.iter().chain(outputs).map(|signal| signal.port.name.as_str());
    if let Some(unknown) = map.keys().find(|key| !is_word(key) && !names().any(|name| name == *key)) {
        let message = format!("`map` names `{unknown}`, in which this PLC takes no part");
        return Err(MappingFault::new(unknown, message).with_help(did_you_mean(unknown, names())));
    }
    if let Some(word) = map.keys().find(|key| is_word(key)).filter(|_| words == Words::Absent) {
        let message = format!("`map` names `{word}`, but with `handshake = \"frames\"` no words are exchanged");
        return Err(MappingFault::new(word, message));
    }
    let feeds = |signals: &[Variables]| -> Result<Vec<Feed>, MappingFault> {
        signals.iter().map(|signal| feed(signal, map.get(signal.port.name.as_str()))).collect()
    };
    let addresses = map.iter().filter(|(name, _)| is_word(name)).map(|(name, address)| {
        if let Addresses::One(address) = address {
            return Ok((name.clone(), address.clone()));
        }
        let help = Some(format!("write one address: {name} = \"…\""));
        Err(MappingFault::new(name, format!("`{name}` is one word and has one address")).with_help(help))
    });
    let addresses = addresses.collect::<Result<_, _>>()?;
    let exchange = Exchange::new(&feeds(inputs)?, &feeds(outputs)?, words, &addresses);
    for direction in [Direction::ToPlc, Direction::FromPlc] {
        doubled(exchange.points(direction), direction)?;
    }
    Ok(exchange)
}

/// The first entry of a mapping that is neither an address nor a list nor a table of them.
pub fn malformed(map: &BTreeMap<String, Addresses>) -> Option<MappingFault> {
    map.iter().find_map(|(name, addresses)| match addresses {
        Addresses::Wrong(what) => Some(no_address(name, what)),
        _ => None,
    })
}

fn no_address(name: &str, what: &str) -> MappingFault {
    let help = "write an address, a list of addresses, or a table of addresses by variable, all as text";
    MappingFault::new(name, format!("`{name}` is mapped to {what}, which is not an address"))
        .with_help(Some(help.to_owned()))
}

/// A signal with the addresses that the scenario gives it.
fn feed(signal: &Variables, addresses: Option<&Addresses>) -> Result<Feed, MappingFault> {
    let Variables { port, paths } = signal;
    if let SignalType::Bytes(_) = port.ty {
        let message = format!("`{}` is {}, a line of bytes, which no link to a real PLC carries", port.name, port.ty);
        let help = "connect the line to the PLC's own port, or let a soft PLC take part".to_owned();
        return Err(MappingFault::new(port.name.as_str(), message).with_help(Some(help)));
    }
    let mut paths = paths.clone();
    paths.sort();
    let variable = |path: &String| Target { variable: Some(path.clone()), address: None };
    let targets = match (addresses, paths.len()) {
        (None, 0) => vec![Target { variable: None, address: None }],
        (None, _) => paths.iter().map(variable).collect(),
        (Some(Addresses::One(address)), 0 | 1) => {
            vec![Target { variable: paths.pop(), address: Some(address.clone()) }]
        }
        (Some(Addresses::One(address)), _) => return Err(one_for_many(port, &paths, address)),
        (Some(Addresses::List(list)), 0) if !list.is_empty() => {
            list.iter().map(|address| Target { variable: None, address: Some(address.clone()) }).collect()
        }
        (Some(Addresses::List(list)), _) => listed(port, &paths, list)?,
        (Some(Addresses::Table(table)), _) => tabled(port, &paths, table)?,
        (Some(Addresses::Wrong(what)), _) => return Err(no_address(port.name.as_str(), what)),
    };
    if targets.is_empty() {
        let help = Some(format!("write at least one: {} = \"…\"", port.name));
        return Err(
            MappingFault::new(port.name.as_str(), format!("`{}` is mapped to no address", port.name)).with_help(help)
        );
    }
    Ok(Feed { port: port.clone(), targets })
}

/// One address cannot be that of several variables, unless the PLC has one for them all.
fn one_for_many(port: &Port, paths: &[String], address: &str) -> MappingFault {
    let (name, count) = (&port.name, paths.len());
    let all = comma_separated(paths);
    let message = format!("`{name}` goes to {count} variables, {all}, and is mapped to one address: {address}");
    MappingFault::new(name.as_str(), message).with_help(Some(suggestion(port, paths, Some(address))))
}

fn listed(port: &Port, paths: &[String], list: &[String]) -> Result<Vec<Target>, MappingFault> {
    let name = &port.name;
    if list.len() != paths.len() {
        let (given, count) = (list.len(), paths.len());
        let all = comma_separated(paths);
        let what = match paths.get(given) {
            Some(left_out) => format!("`{left_out}` is left out"),
            None => format!("there is no variable for `{}`", list[count]),
        };
        let message = format!(
            "`{name}` goes to {count} variable{}, {all}, and is mapped to {given} address{}: {what}",
            plural(count, "s"),
            plural(given, "es")
        );
        return Err(MappingFault::new(name.as_str(), message).with_help(Some(suggestion(port, paths, None))));
    }
    let target =
        |(path, address): (&String, &String)| Target { variable: Some(path.clone()), address: Some(address.clone()) };
    Ok(paths.iter().zip(list).map(target).collect())
}

fn tabled(port: &Port, paths: &[String], table: &BTreeMap<String, String>) -> Result<Vec<Target>, MappingFault> {
    let name = port.name.as_str();
    if let (Some(address), 1) = (table.get(ALL), table.len()) {
        return Ok(vec![Target { variable: None, address: Some(address.clone()) }]);
    }
    if paths.is_empty() && !table.is_empty() {
        let target = |(path, address): (&String, &String)| Target {
            variable: Some(path.clone()),
            address: Some(address.clone()),
        };
        return Ok(table.iter().map(target).collect());
    }
    let unknown = |path: &&String| !paths.iter().any(|known| known.eq_ignore_ascii_case(path));
    if let Some(unknown) = table.keys().find(unknown) {
        let near = did_you_mean(unknown, paths.iter().map(String::as_str));
        let message = format!("`{name}` is not `{unknown}` in the PLC; it goes to {}", comma_separated(paths));
        return Err(MappingFault::new(name, message).with_help(near.or_else(|| Some(suggestion(port, paths, None)))));
    }
    let target = |path: &String| {
        let found = table.iter().find(|(key, _)| key.eq_ignore_ascii_case(path));
        let (_, address) = found.ok_or_else(|| {
            let message = format!("`{name}` goes to `{path}`, too, which has no address");
            MappingFault::new(name, message).with_help(Some(suggestion(port, paths, None)))
        })?;
        Ok(Target { variable: Some(path.clone()), address: Some(address.clone()) })
    };
    paths.iter().map(target).collect()
}

/// Two points in one place, as they are written.
fn doubled(points: &[Point], direction: Direction) -> Result<(), MappingFault> {
    let mut seen: BTreeMap<&str, &Point> = BTreeMap::new();
    for point in points {
        let Some(address) = point.address.as_deref().map(str::trim) else { continue };
        let Some(other) = seen.insert(address, point) else { continue };
        // One variable may be read for two signals; nothing is written twice.
        let is_read_twice =
            direction == Direction::FromPlc && point.variable.is_some() && point.variable == other.variable;
        if is_read_twice {
            continue;
        }
        let message = format!("`{}` and `{}` are both mapped to {address}", other.label(), point.label());
        let shared = format!(
            "each has a place of its own; if the PLC has one variable for all: {} = {{ \"{ALL}\" = \"{address}\" }}",
            point.name
        );
        let help = (other.name == point.name).then_some(shared);
        return Err(MappingFault::new(&point.name, message).with_help(help));
    }
    Ok(())
}

/// What would map all variables.
fn suggestion(port: &Port, paths: &[String], address: Option<&str>) -> String {
    let first = address.unwrap_or("…");
    let entry = |(index, path): (usize, &String)| format!("\"{path}\" = \"{}\"", if index == 0 { first } else { "…" });
    let entries: Vec<String> = paths.iter().enumerate().map(entry).collect();
    let each = format!("{} = {{ {} }}", port.name, entries.join(", "));
    match address {
        Some(address) if paths.len() > 1 => {
            format!(
                "give each its own: {each}\nif the PLC has one variable for all: {} = {{ \"{ALL}\" = \"{address}\" }}",
                port.name
            )
        }
        _ => format!("write {each}"),
    }
}

/// Paths in words.
fn comma_separated(paths: &[String]) -> String {
    let quoted: Vec<String> = paths.iter().map(|path| format!("`{path}`")).collect();
    match &quoted[..] {
        [] => "no variable that is known".to_owned(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

fn plural(count: usize, ending: &str) -> &str {
    if count == 1 { "" } else { ending }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::{SignalName, SignalType};

    use super::*;

    fn signal(name: &str, paths: &[&str]) -> Variables {
        let port = Port { name: SignalName::new(name).unwrap(), ty: SignalType::BOOL };
        Variables { port, paths: paths.iter().map(|path| (*path).to_owned()).collect() }
    }

    fn mapped(map: &str) -> Result<Exchange, MappingFault> {
        let inputs = [signal("go", &["Q.go", "P.go"]), signal("level", &["P.level"]), signal("free", &[])];
        exchange(&inputs, &[signal("out", &["P.out"])], Words::Handshake, &toml::from_str(map).unwrap())
    }

    /// The points of the signals with their addresses.
    fn points(map: &str) -> Vec<String> {
        let exchange = mapped(map).unwrap();
        let listed = |point: &Point| {
            let address = point.address.as_deref().unwrap_or("-");
            format!("{} {} {address}", point.key(), point.variable.as_deref().unwrap_or("-"))
        };
        exchange.to_plc().iter().filter(|point| !point.is_word()).map(listed).collect()
    }

    #[test]
    fn a_point_is_a_variable_of_a_signal() {
        assert_eq!(points(""), ["P.go P.go -", "Q.go Q.go -", "level P.level -", "free - -"]);
        let list = points("go = [\"a\", \"b\"]\nlevel = \"c\"\nfree = [\"d\", \"e\"]");
        assert_eq!(list, ["P.go P.go a", "Q.go Q.go b", "level P.level c", "free[1] - d", "free[2] - e"]);
        let table = points("go = { \"Q.GO\" = \"a\", \"P.go\" = \"b\" }\nlevel = [\"c\"]\nfree = { X = \"d\" }");
        assert_eq!(table, ["P.go P.go b", "Q.go Q.go a", "level P.level c", "free X d"]);
        assert_eq!(points("go = { \"*\" = \"a\" }")[0], "go - a");
    }

    #[test]
    fn a_variable_with_two_names_is_one_point() {
        let place = |offset, bit| Place { offset, bit, text: None };
        let bound = Bound {
            port: Port { name: SignalName::new("go").unwrap(), ty: SignalType::BOOL },
            places: vec![place(4, Some(1)), place(4, Some(2)), place(4, Some(1))],
            variables: ["P.go", "Q.go", "%QX4.1"].map(str::to_owned).to_vec(),
        };
        assert_eq!(Variables::of(&bound).paths, ["P.go", "Q.go"]);
    }

    #[test]
    fn a_variable_that_is_not_reached_is_reported() {
        let all = [
            "go = \"hr:0\"",
            "go = [\"hr:0\"]",
            "go = []",
            "go = [\"hr:0\", \"hr:1\", \"hr:2\"]",
            "go = [\"hr:0\", \"hr:0\"]",
            "go = [\"hr:0\", \"hr:1\"]\nlevel = \"hr:1\"",
            "go = { \"P.go\" = \"hr:0\" }",
            "go = { \"P.go\" = \"hr:0\", \"Q.og\" = \"hr:1\" }",
            "go = { \"*\" = \"hr:0\", \"P.go\" = \"hr:1\" }",
            "go = 7",
            "level = [\"hr:0\", \"hr:1\"]",
            "free = []",
            "out = [\"hr:0\", \"hr:1\"]",
            "SDSP_Grant = [\"hr:0\"]",
            "og = \"hr:0\"",
        ];
        let reported = all.map(|map| {
            let fault = mapped(map).unwrap_err();
            format!(
                "{map}\n  {}: {fault}\n  {}",
                fault.point,
                fault.help.clone().unwrap_or_default().replace('\n', "\n  ")
            )
        });
        insta::assert_snapshot!(reported.join("\n"));
    }
}
