//! Connections of a drawing, from pin to pin.

use std::collections::BTreeMap;

use super::element::{Source, value};
use super::{Element, Lines, Wire};

/// All wires; a connection that leads to nothing is left out, as it is reported where the file is compiled.
pub(super) fn wires(lines: &Lines, sources: &[Source<'_>], elements: &[Element]) -> Vec<Wire> {
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    for (number, element) in elements.iter().enumerate() {
        numbers.entry(&element.id).or_insert(number);
    }
    let wire = |source: &Source<'_>| {
        let from = *numbers.get(value(source.connection, "refLocalId"))?;
        let [to, pin] = source.to;
        let (of, target) = (elements.get(from)?, elements.get(to)?);
        let end = target.pins.get(pin)?.at;
        let output = output(of, value(source.connection, "formalParameter"), target, end)?;
        let corners: Vec<[f64; 2]> =
            source.connection.elements().filter(|inner| inner.name == "position").filter_map(corner).collect();
        // the file goes from the end to the source
        let points = match corners.len() {
            0 | 1 => vec![of.pins.get(output)?.at, end],
            _ => corners.into_iter().rev().collect(),
        };
        Some(Wire { from: [from, output], to: [to, pin], points, line: lines.at(source.connection.open.start) })
    };
    sources.iter().filter_map(wire).collect()
}

fn corner(position: &onescan_xml::Element) -> Option<[f64; 2]> {
    let part = |name: &str| value(position, name).parse().ok().filter(|number: &f64| number.is_finite());
    Some([part("x")?, part("y")?])
}

/// The output that a connection comes from: the one of this name, that of actions for actions, or the nearest.
fn output(of: &Element, name: &str, target: &Element, end: [f64; 2]) -> Option<usize> {
    let outputs = || of.pins.iter().enumerate().filter(|(_, pin)| pin.is_output);
    let named = outputs().find(|(_, pin)| !name.is_empty() && pin.name == name);
    let for_actions = outputs().find(|(_, pin)| pin.name == "action" && target.kind == "actionBlock");
    let away = |at: [f64; 2]| (at[0] - end[0]).abs() + (at[1] - end[1]).abs();
    let nearest = || {
        let plain = outputs().filter(|(_, pin)| pin.name != "action" || target.kind == "actionBlock");
        plain.min_by(|(_, one), (_, other)| away(one.at).total_cmp(&away(other.at)))
    };
    // what gives values without a pin of its own, as `VAR_IN_OUT`, gives them at the pin of its name
    let any = || of.pins.iter().enumerate().find(|(_, pin)| pin.name == name);
    named.or(for_actions).or_else(nearest).or_else(any).map(|(number, _)| number)
}

#[cfg(test)]
mod tests {
    use super::super::{Language, sheets};

    #[test]
    fn corners_go_from_the_source_to_the_end() {
        let file = r#"<project><types><pous><pou name="P"><body><FBD>
<inVariable localId="1"><position x="0" y="0"/><connectionPointOut><relPosition x="40" y="10"/></connectionPointOut>
<expression>a</expression></inVariable>
<outVariable localId="2"><position x="100" y="50"/><connectionPointIn><relPosition x="0" y="10"/>
<connection refLocalId="1"><position x="100" y="60"/><position x="70" y="60"/><position x="70" y="10"/><position x="40" y="10"/>
</connection><connection refLocalId="9"/></connectionPointIn><expression>b</expression></outVariable>
</FBD></body></pou></pous></types></project>"#;
        let [sheet] = &sheets(file)[..] else { panic!("one sheet") };
        assert_eq!(sheet.language, Language::Blocks);
        let [wire] = &sheet.wires[..] else { panic!("one wire") };
        assert_eq!(wire.points, [[40.0, 10.0], [70.0, 10.0], [70.0, 60.0], [100.0, 60.0]]);
        assert_eq!((wire.from, wire.to, wire.line), ([0, 0], [1, 0], 5));
    }
}
