//! The number of a mapping, `SDSP_Layout`: the program in the PLC and the gateway show that they mean the same points.
//!
//! It is a CRC-32 over the points in their order, a line each: direction, signal, variable, type, and the place where
//! that is a number and not the one that the point has without an address. Symbols and words about the PLC itself are
//! no part of it: a PLC that has no such symbol says so itself, and those words are not the program's.

use std::fmt::Write;

use super::exchange::{Direction, Exchange, Point};
use super::modbus::RegisterMap;
use super::settings::Settings;
use super::tcp::{Declaration, Layouts};

/// The number of the mapping of `exchange`; never 0, which is that of no mapping.
pub fn layout_number(settings: &Settings, exchange: &Exchange) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(canonical(settings, exchange).as_bytes());
    hasher.finalize().max(1)
}

/// The text that the number is made of.
fn canonical(settings: &Settings, exchange: &Exchange) -> String {
    let plain = exchange.without_addresses();
    let registers = |exchange| RegisterMap::new(&settings.modbus, exchange).ok().map(|map| map.places());
    let blocks = |declared: &Declaration, exchange| Layouts::new(declared, exchange).ok().map(|blocks| blocks.places());
    // A mapping for another link has addresses that these do not know, and no places there.
    let registers = registers(exchange).zip(registers(&plain));
    let blocks = blocks(&settings.layout, exchange).zip(blocks(&Declaration::default(), &plain));
    let mut text = String::new();
    for (direction, way) in [(Direction::ToPlc, "to"), (Direction::FromPlc, "from")] {
        for (index, point) in exchange.points(direction).iter().enumerate().filter(|(_, point)| is_counted(point)) {
            let Point { name, variable, ty, .. } = point;
            let variable = variable.as_deref().unwrap_or("-");
            let mut line = format!("{way} {name} {variable} {ty}");
            for (places, defaults) in registers.iter().chain(&blocks) {
                let place = |places: &[Vec<String>; 2]| places[direction as usize].get(index).cloned();
                if let Some(moved) = place(places).filter(|_| place(places) != place(defaults)) {
                    line = line + " " + &moved;
                }
            }
            // Writing into a text cannot fail.
            let _ = writeln!(text, "{line}");
        }
    }
    text
}

fn is_counted(point: &Point) -> bool {
    !point.name.starts_with("PLC_") || !point.is_word()
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::{Port, SignalName, SignalType};

    use super::*;
    use crate::gateway::exchange::Words;
    use crate::gateway::mapping::{self, Variables};

    fn number(inputs: &[(&str, &str, SignalType)], settings: &str) -> u32 {
        let signal = |(name, path, ty): &(&str, &str, SignalType)| Variables {
            port: Port { name: SignalName::new(*name).unwrap(), ty: *ty },
            paths: path.split(' ').map(str::to_owned).collect(),
        };
        let inputs: Vec<_> = inputs.iter().map(signal).collect();
        let settings: Settings = toml::from_str(settings).unwrap();
        let exchange = mapping::exchange(&inputs, &[], settings.words(), &settings.map).unwrap();
        layout_number(&settings, &exchange)
    }

    const TWO: [(&str, &str, SignalType); 2] = [("a", "P.a Q.a", SignalType::BOOL), ("b", "P.b", SignalType::BOOL)];

    #[test]
    fn it_says_which_points_lie_where() {
        let plain = number(&TWO, "");
        assert_ne!(plain, 0);
        let others = [
            number(&[TWO[1], TWO[0]], ""),
            number(&[("a", "P.a", SignalType::BOOL), TWO[1]], ""),
            number(&[TWO[0], ("b", "P.b", SignalType::BYTE)], ""),
            number(&[TWO[0], ("c", "P.b", SignalType::BOOL)], ""),
            number(&TWO, "map = { b = \"hr:100\" }"),
            number(&TWO, "map = { b = \"hr:101\" }"),
            number(&TWO, "map = { a = [\"0.1\", \"0.0\"] }"),
            number(
                &TWO,
                "layout = { to_plc = [\"b: BOOL\", \"P.a: BOOL\", \"Q.a: BOOL\", \"SDSP_Session: UDINT\", \"SDSP_Limit: UDINT\", \"SDSP_TV: LINT\", \"SDSP_Grant: UDINT\"] }",
            ),
        ];
        for (index, other) in others.iter().enumerate() {
            assert_ne!(plain, *other, "{index}");
            assert!(!others[..index].contains(other), "{index}");
        }
    }

    #[test]
    fn it_does_not_change_with_what_says_the_same() {
        let plain = number(&TWO, "");
        let equal = [
            "system_words = true",
            "url = \"modbus://h\"",
            "map = { b = \"hr:2\", a = [\"hr:0\", \"hr:1\"] }",
            "map = { SDSP_Grant = \"hr:11\", b = \"hr:2\", a = [\"hr:0\", \"hr:1\"], SDSP_Session = \"hr:3\", SDSP_Limit = \"hr:5\", SDSP_TV = \"hr:7\" }",
            "map = { a = [\"0.0\", \"0.1\"] }",
            "map = { a = [\"ns=4;s=P.a\", \"ns=4;s=Q.a\"] }",
        ];
        for settings in equal {
            assert_eq!(number(&TWO, settings), plain, "{settings}");
        }
    }

    #[test]
    fn it_is_that_of_the_text() {
        let settings = Settings::default();
        let exchange = Exchange::new(&[], &[], Words::WithSystem, &std::collections::BTreeMap::new());
        insta::assert_snapshot!(canonical(&settings, &exchange));
        assert_eq!(layout_number(&settings, &exchange), crc32fast::hash(canonical(&settings, &exchange).as_bytes()));
    }
}
