//! Drawings of PLCopen XML as they are laid out: ladders, function blocks and charts for those who look at them.
//!
//! | module | subject |
//! |---|---|
//! | `element` | elements with their texts, sizes and pins |
//! | `wire` | connections from pin to pin |
//!
//! Nothing here is run: what a drawing means, the readers beside this one say. What has no place in the file gets one that
//! suits its kind, and what cannot be read is left out, as it is reported where the file is compiled.

mod element;
mod wire;

use onescan_xml::{Element as Xml, parse};

/// A drawing: the body of a unit, of one of its actions or of one of its transitions.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The unit whose variables it is about.
    pub unit: String,
    /// The action or the transition, if it is not the unit's own body.
    pub part: Option<String>,
    /// What it is drawn in.
    pub language: Language,
    /// What is on it, in the order of the file.
    pub elements: Vec<Element>,
    pub wires: Vec<Wire>,
}

/// A graphical language (IEC 61131-3, 3rd ed., 6.7 and 8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    Ladder,
    Blocks,
    Chart,
}

/// Something that stands on a sheet. Places are those of the file: right and down from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Its number in the file, `localId`.
    pub id: String,
    /// What it is, as the file says: `contact`, `block`, `step`.
    pub kind: String,
    /// What stands on it: a variable, an expression, a type, a name; for actions, a line each.
    pub text: String,
    /// The name of a block's instance.
    pub instance: Option<String>,
    /// The path of the variable that holds its state, within the unit: of a contact, a coil, a variable or a step.
    pub state: Option<String>,
    /// `negated`, `rising`, `falling`, `set`, `reset`, `initial`.
    pub marks: Vec<&'static str>,
    /// Its upper left corner.
    /// Right and down from the upper left corner, in units of the file.
    pub at: [f64; 2],
    /// Its width and height.
    pub size: [f64; 2],
    /// Where wires begin and end, absolute.
    pub pins: Vec<Pin>,
    /// The line of the file where it stands, from 1.
    pub line: u32,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Pin {
    /// Its name at a block.
    pub name: String,
    /// Whether values come out of it.
    pub is_output: bool,
    /// `negated`, `rising`, `falling`, `set`, `reset`.
    pub marks: Vec<&'static str>,
    /// The path of the variable that it gives, within the unit: of a block's instance.
    pub state: Option<String>,
    /// Right and down from the upper left corner, in units of the file.
    pub at: [f64; 2],
}

/// A wire from an output to an input: element and pin, by their places in the lists.
#[derive(Clone, Debug, PartialEq)]
pub struct Wire {
    /// Where its value comes from.
    pub from: [usize; 2],
    pub to: [usize; 2],
    /// Its corners, from its source on; both ends alone if the file has none.
    pub points: Vec<[f64; 2]>,
    /// The line of the file where it stands, from 1.
    pub line: u32,
}

/// All drawings of a file of PLCopen XML; none if it is not such a file.
pub fn sheets(file: &str) -> Vec<Sheet> {
    let Ok(root) = parse(file) else { return Vec::new() };
    let mut units = Vec::new();
    collect(&root, &mut units);
    units.into_iter().flat_map(|unit| of_unit(file, unit)).collect()
}

/// All `<pou>`, also those that stand in data of a vendor.
fn collect<'x>(element: &'x Xml, units: &mut Vec<&'x Xml>) {
    for inner in element.elements() {
        if inner.name == "pou" {
            units.push(inner);
        } else {
            collect(inner, units);
        }
    }
}

fn of_unit(file: &str, unit: &Xml) -> Vec<Sheet> {
    let Some(name) = unit.attribute("name").map(|name| name.value.clone()) else { return Vec::new() };
    let own = unit.elements().filter(|inner| inner.name == "body").map(|body| (None, body));
    let lists = unit.elements().filter(|inner| matches!(inner.name.as_str(), "actions" | "transitions"));
    let parts = lists.flat_map(Xml::elements).filter_map(|part| {
        let name = part.attribute("name")?.value.clone();
        Some((Some(name), part.child("body")?))
    });
    own.chain(parts).flat_map(|(part, body)| of_body(file, &name, part.as_deref(), body)).collect()
}

fn of_body(file: &str, unit: &str, part: Option<&str>, body: &Xml) -> Vec<Sheet> {
    let lines = Lines::of(file);
    let mut sheets = Vec::new();
    for drawing in body.elements() {
        let language = match drawing.name.as_str() {
            "LD" => Language::Ladder,
            "FBD" => Language::Blocks,
            "SFC" => Language::Chart,
            _ => continue,
        };
        let (elements, sources) = element::elements(file, &lines, drawing, language);
        let wires = wire::wires(&lines, &sources, &elements);
        let part_name = part.map(str::to_owned);
        sheets.push(Sheet { unit: unit.to_owned(), part: part_name, language, elements, wires });
        // what is in a macro step is a sheet of its own
        for step in drawing.elements().filter(|inner| inner.name == "macroStep") {
            let name = step.attribute("name").map(|name| name.value.as_str());
            sheets.extend(step.child("body").into_iter().flat_map(|body| of_body(file, unit, name, body)));
        }
    }
    sheets
}

/// Lines by the bytes where they begin.
struct Lines(Vec<u32>);

impl Lines {
    fn of(file: &str) -> Self {
        let breaks = file.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        Self(breaks.map(|(at, _)| at as u32).collect())
    }

    /// The line of a place, from 1.
    fn at(&self, place: u32) -> u32 {
        self.0.partition_point(|end| *end < place) as u32 + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(name: &str) -> String {
        let path = format!("{}/../{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
    }

    fn by_id<'s>(sheet: &'s Sheet, id: &str) -> &'s Element {
        sheet.elements.iter().find(|element| element.id == id).unwrap_or_else(|| panic!("no element {id}"))
    }

    /// The wires that end at an element: from which element, and its corners.
    fn into<'s>(sheet: &'s Sheet, id: &str) -> Vec<(&'s str, &'s [[f64; 2]])> {
        let ends = sheet.wires.iter().filter(|wire| sheet.elements[wire.to[0]].id == id);
        ends.map(|wire| (sheet.elements[wire.from[0]].id.as_str(), wire.points.as_slice())).collect()
    }

    #[test]
    fn a_ladder_is_as_it_is_laid_out() {
        let sheets = sheets(&input("../scenarios/shear/plc-ld/shear.xml"));
        let ladder = sheets.iter().find(|sheet| sheet.language == Language::Ladder).expect("a ladder");
        assert_eq!((&*ladder.unit, &ladder.part), ("LowLevel", &None));
        let contact = by_id(ladder, "11");
        assert_eq!(
            (&*contact.kind, &*contact.text, contact.state.as_deref()),
            ("contact", "Sensor_1", Some("Sensor_1"))
        );
        assert_eq!((&contact.marks[..], contact.at, contact.size), (&["negated"][..], [260.0, 40.0], [30.0, 15.0]));
        assert_eq!(into(ladder, "11"), [("10", &[[90.0, 48.0], [260.0, 48.0]][..])]);
        // the rail has an output for each rung
        assert_eq!(into(ladder, "10"), [("1", &[[23.0, 48.0], [60.0, 48.0]][..])]);
        let block = by_id(ladder, "22");
        let pins: Vec<&str> = block.pins.iter().filter(|pin| !pin.is_output).map(|pin| pin.name.as_str()).collect();
        assert_eq!((&*block.text, &pins[..]), ("GT", &["EN", "IN1", "IN2"][..]));
        assert!(contact.line > 40, "{}", contact.line);
    }

    #[test]
    fn a_chart_is_as_it_is_laid_out() {
        let sheets = sheets(&input("tests/inputs/mixer.xml"));
        let chart = sheets.iter().find(|sheet| sheet.language == Language::Chart).expect("a chart");
        let idle = by_id(chart, "1");
        assert_eq!((&*idle.text, idle.state.as_deref(), &idle.marks[..]), ("Idle", Some("Idle.X"), &["initial"][..]));
        let start = by_id(chart, "2");
        assert_eq!((&*start.kind, &*start.text, start.state.as_deref()), ("transition", "start", Some("start")));
        assert_eq!(by_id(chart, "4").text, "N valve\nD T#20ms motor");
        let sources = |id: &str| -> Vec<&str> { into(chart, id).into_iter().map(|(source, _)| source).collect() };
        assert_eq!((sources("2"), sources("3"), sources("4")), (vec!["1"], vec!["2"], vec!["3"]));
    }

    #[test]
    fn every_element_and_every_connection_of_the_inputs_is_drawn() {
        for name in
            ["tests/inputs/languages.xml", "tests/inputs/mixer.xml", "tests/inputs/pump.xml", "tests/inputs/ramp.xml"]
        {
            let file = input(name);
            let root = parse(&file).expect("XML");
            let (mut numbered, mut connections) = (0, 0);
            count(&root, &mut numbered, &mut connections);
            let sheets = sheets(&file);
            let drawn: usize = sheets.iter().map(|sheet| sheet.elements.len()).sum();
            let wired: usize = sheets.iter().map(|sheet| sheet.wires.len()).sum();
            assert_eq!((drawn, wired), (numbered, connections), "{name}");
        }
    }

    /// Elements that stand in a drawing themselves, and connections.
    fn count(element: &Xml, numbered: &mut usize, connections: &mut usize) {
        for inner in element.elements() {
            if matches!(element.name.as_str(), "LD" | "FBD" | "SFC") && inner.attribute("localId").is_some() {
                *numbered += 1;
            }
            *connections += usize::from(inner.name == "connection");
            count(inner, numbered, connections);
        }
    }

    #[test]
    fn what_is_no_drawing_has_none() {
        for text in ["", "<a/>", "<project><types><pous><pou/></pous></types></project>", "PROGRAM P END_PROGRAM"] {
            assert_eq!(sheets(text), [], "{text}");
        }
    }
}
