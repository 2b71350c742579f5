//! Elements of a drawing with their texts, sizes and pins (TC6 2.01, `commonObjects`, `fbdObjects`, `ldObjects`, `sfcObjects`).

use onescan_xml::Element as Xml;

use super::{Element, Language, Lines, Pin};

/// How wide a character is where the file does not say how wide an element is.
const CHARACTER: f64 = 8.0;
/// From pin to pin of a block without places.
const PIN_APART: f64 = 20.0;

/// The connections that end at a pin: the element and the pin, by their places, and what stands in the file.
pub(super) struct Source<'x> {
    pub(super) to: [usize; 2],
    pub(super) connection: &'x Xml,
}

/// All elements of a drawing, and the connections between them.
pub(super) fn elements<'x>(
    file: &str,
    lines: &Lines,
    drawing: &'x Xml,
    language: Language,
) -> (Vec<Element>, Vec<Source<'x>>) {
    let (mut elements, mut sources) = (Vec::new(), Vec::new());
    for xml in drawing.elements().filter(|inner| inner.attribute("localId").is_some()) {
        let number = elements.len();
        let (element, points) = element(file, lines, xml, language);
        for (pin, point) in points.into_iter().enumerate() {
            let connections = point.elements().filter(|inner| inner.name == "connection");
            sources.extend(connections.map(|connection| Source { to: [number, pin], connection }));
        }
        elements.push(element);
    }
    (elements, sources)
}

pub(super) fn value<'x>(xml: &'x Xml, name: &str) -> &'x str {
    xml.attribute(name).map_or("", |found| found.value.trim())
}

fn number(xml: &Xml, name: &str) -> Option<f64> {
    value(xml, name).parse().ok().filter(|number: &f64| number.is_finite())
}

/// The place that an element says of itself under this name.
pub(super) fn place(xml: &Xml, name: &str) -> Option<[f64; 2]> {
    let place = xml.child(name)?;
    Some([number(place, "x")?, number(place, "y")?])
}

/// A pin before it has a place: its name, its way, what it is of, and where it stands in the file.
struct Point<'x> {
    xml: &'x Xml,
    name: &'x str,
    is_output: bool,
    marks: Vec<&'static str>,
}

fn element<'x>(file: &str, lines: &Lines, xml: &'x Xml, language: Language) -> (Element, Vec<&'x Xml>) {
    let points = points(xml);
    let text = text(file, xml);
    let instance = Some(value(xml, "instanceName")).filter(|name| !name.is_empty()).map(str::to_owned);
    let at = place(xml, "position").unwrap_or_default();
    let size = size(xml, &points, &text);
    let pins = points.iter().enumerate().map(|(index, point)| Pin {
        name: point.name.to_owned(),
        is_output: point.is_output,
        marks: point.marks.clone(),
        state: instance.as_ref().filter(|_| point.is_output).map(|instance| format!("{instance}.{}", point.name)),
        at: pin_place(point, index, &points, (at, size), language),
    });
    let element = Element {
        id: value(xml, "localId").to_owned(),
        kind: xml.name.clone(),
        state: state(xml, &text),
        instance: instance.clone(),
        marks: marks(xml, ""),
        at,
        size,
        pins: pins.collect(),
        line: lines.at(xml.open.start),
        text,
    };
    (element, points.into_iter().map(|point| point.xml).collect())
}

fn marks(xml: &Xml, suffix: &str) -> Vec<&'static str> {
    let of = |name: &str| value(xml, &format!("{name}{suffix}"));
    let is_true = |name: &str| matches!(of(name), "true" | "1");
    let mut marks = Vec::new();
    marks.extend(is_true("negated").then_some("negated"));
    marks.extend(match of("edge") {
        "rising" => Some("rising"),
        "falling" => Some("falling"),
        _ => None,
    });
    marks.extend(match of("storage") {
        "set" => Some("set"),
        "reset" => Some("reset"),
        _ => None,
    });
    marks.extend(is_true("initialStep").then_some("initial"));
    marks
}

/// Where wires begin and end, inputs first.
fn points(xml: &Xml) -> Vec<Point<'_>> {
    let own = |point: &str| -> Vec<&Xml> { xml.elements().filter(|inner| inner.name == point).collect() };
    let plain = |xml, is_output| Point { xml, name: value(xml, "formalParameter"), is_output, marks: Vec::new() };
    let mut points: Vec<Point<'_>> = Vec::new();
    for (list, is_output) in [("inputVariables", false), ("inOutVariables", false), ("outputVariables", true)] {
        let variables = xml.child(list).into_iter().flat_map(Xml::elements).filter(|inner| inner.name == "variable");
        for variable in variables {
            let side = if is_output { "connectionPointOut" } else { "connectionPointIn" };
            let name = value(variable, "formalParameter");
            // a pin without a connection point is drawn all the same
            let xml = variable.child(side).unwrap_or(variable);
            points.push(Point { xml, name, is_output, marks: marks(variable, "") });
        }
    }
    points.extend(own("connectionPointIn").into_iter().map(|point| plain(point, false)));
    // the condition of a transition comes from elements beside the chart
    let condition = xml.child("condition").and_then(|condition| condition.child("connectionPointIn"));
    let loose = xml.child("condition").filter(|condition| condition.child("connection").is_some());
    points.extend(condition.or(loose).map(|xml| Point { xml, name: "condition", is_output: false, marks: Vec::new() }));
    points.extend(own("connectionPointOut").into_iter().map(|point| plain(point, true)));
    let actions = own("connectionPointOutAction").into_iter();
    points.extend(actions.map(|xml| Point { xml, name: "action", is_output: true, marks: Vec::new() }));
    points
}

/// What stands on an element.
fn text(file: &str, xml: &Xml) -> String {
    let inner = |name: &str| xml.child(name).map(|inner| inner.text(file).trim().to_owned());
    match xml.name.as_str() {
        "block" => value(xml, "typeName").to_owned(),
        "step" | "macroStep" | "connector" | "continuation" => value(xml, "name").to_owned(),
        "jumpStep" => value(xml, "targetName").to_owned(),
        "label" | "jump" => value(xml, "label").to_owned(),
        "transition" => xml.child("condition").map(|condition| said(file, condition)).unwrap_or_default(),
        "actionBlock" => {
            let actions = xml.elements().filter(|inner| inner.name == "action").map(|action| {
                let qualifier = Some(value(action, "qualifier")).filter(|word| !word.is_empty()).unwrap_or("N");
                let parts = [qualifier, value(action, "duration"), &*said(file, action)].map(str::to_owned);
                parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
            });
            actions.collect::<Vec<_>>().join("\n")
        }
        "comment" => xml.child("content").map(|content| deep(file, content)).unwrap_or_default(),
        _ => inner("variable").or_else(|| inner("expression")).unwrap_or_default(),
    }
}

/// What a condition or an action says: a name, or the text that stands in it.
fn said(file: &str, xml: &Xml) -> String {
    match xml.child("reference") {
        Some(reference) => value(reference, "name").to_owned(),
        None => xml.child("inline").map(|inline| deep(file, inline)).unwrap_or_default(),
    }
}

/// All text within an element.
fn deep(file: &str, xml: &Xml) -> String {
    let mut text = xml.text(file).trim().to_owned();
    for inner in xml.elements() {
        text.push_str(&deep(file, inner));
    }
    text
}

/// The variable that holds the state of an element.
fn state(xml: &Xml, text: &str) -> Option<String> {
    match xml.name.as_str() {
        "contact" | "coil" | "inVariable" | "outVariable" | "inOutVariable" | "transition" if is_path(text) => {
            Some(text.to_owned())
        }
        "step" if !text.is_empty() => Some(format!("{text}.X")),
        _ => None,
    }
}

/// True for a variable, and not for a literal or an expression.
fn is_path(text: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | ']' | ',');
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && text.chars().all(is_word)
        && !matches!(text.to_ascii_uppercase().as_str(), "TRUE" | "FALSE")
}

fn size(xml: &Xml, points: &[Point<'_>], text: &str) -> [f64; 2] {
    let longest = text.lines().map(str::len).max().unwrap_or(0) as f64;
    let of_side = |is_output: bool| points.iter().filter(|point| point.is_output == is_output).count();
    let pins = of_side(false).max(of_side(true)).max(1) as f64;
    let [width, height] = match xml.name.as_str() {
        "contact" | "coil" => [30.0, 16.0],
        "leftPowerRail" | "rightPowerRail" => [4.0, PIN_APART * pins],
        "block" => [(longest + 8.0) * CHARACTER, 24.0 + PIN_APART * pins],
        "transition" => [24.0, 4.0],
        "step" | "macroStep" => [(longest + 2.0) * CHARACTER, 30.0],
        "actionBlock" => [(longest + 2.0) * CHARACTER, PIN_APART * text.lines().count().max(1) as f64],
        "selectionDivergence" | "selectionConvergence" | "simultaneousDivergence" | "simultaneousConvergence" => {
            [40.0 * pins, 4.0]
        }
        _ => [(longest + 1.0) * CHARACTER, 20.0],
    };
    let given = |name: &str| number(xml, name).filter(|length| *length > 0.0);
    [given("width").unwrap_or(width), given("height").unwrap_or(height)]
}

/// Where a pin is: as the file says, or where one of its kind has it.
fn pin_place(
    point: &Point<'_>,
    index: usize,
    all: &[Point<'_>],
    (at, size): ([f64; 2], [f64; 2]),
    language: Language,
) -> [f64; 2] {
    // two zeros are what tools write that do not keep the place of a pin
    let given = place(point.xml, "relPosition").filter(|place| all.len() < 2 || place.iter().any(|part| *part != 0.0));
    let [x, y] = given.unwrap_or_else(|| {
        let same = |other: &&Point<'_>| other.is_output == point.is_output && other.name != "action";
        let (count, before) = (all.iter().filter(same).count(), all.iter().take(index).filter(same).count());
        let share = (before as f64 + 0.5) / count.max(1) as f64;
        match (language, point.name, point.is_output) {
            (Language::Chart, "action", _) => [size[0], size[1] / 2.0],
            (Language::Chart, "condition", _) => [0.0, size[1] / 2.0],
            (Language::Chart, _, false) => [size[0] * share, 0.0],
            (Language::Chart, _, true) => [size[0] * share, size[1]],
            (_, _, false) => [0.0, size[1] * share],
            (_, _, true) => [size[0], size[1] * share],
        }
    });
    [at[0] + x, at[1] + y]
}
