//! Random networks in LD and FBD, apart from how they are drawn.

use std::fmt::Write;

use crate::matiec::dice::Dice;
use crate::plcopen::{block, coil, contact, input, output, pou, project, rail, through};

/// Width and height of a cell in pixels.
const CELL: (i64, i64) = (100, 40);
/// Variables of each type.
const POOL: usize = 6;
const FUNCTIONS: [&str; 5] = ["ADD", "SUB", "MUL", "MAX", "MIN"];

#[derive(Debug)]
enum Shape {
    Rail,
    Input(String),
    Output(String),
    Through(String),
    /// Callee, names of its inputs, its output.
    Block(String, &'static [&'static str], &'static str),
    Contact(String, &'static str),
    Coil(String, &'static str),
    Connector(String),
    Continuation(String),
}

#[derive(Debug)]
struct Element {
    shape: Shape,
    /// Its cell: to the right, then down.
    at: (i64, i64),
    /// For each input, where its lines come from.
    sources: Vec<Vec<usize>>,
    number: Option<usize>,
}

/// A body, and the declarations that it needs.
#[derive(Debug)]
pub(crate) struct Sketch {
    ladder: bool,
    elements: Vec<Element>,
    instances: Vec<String>,
    connectors: usize,
    /// What the peer has in common with us only.
    for_peer: bool,
}

/// How a sketch is drawn.
#[derive(Debug)]
pub(crate) struct Drawing {
    /// Place, by element.
    places: Vec<(u32, u32)>,
    /// Id, by element.
    ids: Vec<usize>,
    /// The elements as the file has them.
    order: Vec<usize>,
}

fn shuffled(count: usize, dice: &mut Dice) -> Vec<usize> {
    let mut list: Vec<usize> = (0..count).collect();
    for last in (1..count).rev() {
        list.swap(last, dice.below(last + 1));
    }
    list
}

impl Drawing {
    pub(crate) fn plain(sketch: &Sketch) -> Self {
        let count = sketch.elements.len();
        let place = |element: &Element| ((element.at.0 * CELL.0) as u32 + 10, (element.at.1 * CELL.1) as u32 + 10);
        let places = sketch.elements.iter().map(place).collect();
        Self { places, ids: (1..=count).collect(), order: (0..count).collect() }
    }

    /// Another drawing with the same meaning; if the file has the order, the places mean nothing.
    pub(crate) fn other(sketch: &Sketch, in_file: bool, dice: &mut Dice) -> Self {
        let count = sketch.elements.len();
        let ids = shuffled(count, dice).into_iter().map(|id| 7 + 3 * id).collect();
        if in_file {
            let places = (0..count).map(|_| (dice.below(900) as u32, dice.below(900) as u32)).collect();
            return Self { places, ids, order: (0..count).collect() };
        }
        let (right, down, wide, high) = (dice.below(300), dice.below(300), 1 + dice.below(3), 1 + dice.below(3));
        let mut place = |element: &Element| {
            let x = element.at.0 * CELL.0 * wide as i64 + right as i64 + dice.between(0, 4);
            let y = element.at.1 * CELL.1 * high as i64 + down as i64 + dice.between(0, 4);
            (x as u32, y as u32)
        };
        let places = sketch.elements.iter().map(&mut place).collect();
        Self { places, ids, order: shuffled(count, dice) }
    }

    /// A drawing from right to left and from bottom to top, and its file the other way round.
    pub(crate) fn turned(sketch: &Sketch) -> Self {
        let mut drawing = Self::plain(sketch);
        for (x, y) in &mut drawing.places {
            (*x, *y) = (9_000 - *x, 90_000 - *y);
        }
        drawing.order.reverse();
        drawing
    }
}

/// Makes the elements of one network.
struct Net<'s, 'd> {
    sketch: &'s mut Sketch,
    dice: &'d mut Dice,
    /// Where it begins.
    corner: (i64, i64),
    /// Rows that are taken in each column.
    taken: Vec<i64>,
    /// Elements whose values others may take, in the order in which they have been made.
    values: Vec<usize>,
}

impl Net<'_, '_> {
    fn add(&mut self, shape: Shape, column: usize, sources: Vec<Vec<usize>>) -> usize {
        if self.taken.len() <= column {
            self.taken.resize(column + 1, 0);
        }
        let at = (self.corner.0 + column as i64, self.corner.1 + self.taken[column]);
        self.taken[column] += 1;
        self.sketch.elements.push(Element { shape, at, sources, number: None });
        self.sketch.elements.len() - 1
    }

    fn one_of(&mut self, prefix: &str) -> String {
        format!("{prefix}{}", self.dice.below(POOL))
    }

    /// A value for an input in a column: of the network so far, or of a variable.
    fn number(&mut self, column: usize) -> usize {
        if !self.values.is_empty() && !self.dice.once_in(3) {
            return self.values[self.dice.below(self.values.len())];
        }
        let variable = self.one_of("v");
        self.add(Shape::Input(variable), column, Vec::new())
    }

    fn instance(&mut self, kind: &str) -> String {
        let name = format!("f{}", self.sketch.instances.len());
        self.sketch.instances.push(format!("{name} : {kind}"));
        format!("{kind} {name}")
    }

    fn diagram(&mut self) {
        let columns = 1 + self.dice.below(4);
        for column in (0..columns).map(|column| 3 * column) {
            let mut made = Vec::new();
            for _ in 0..=self.dice.below(2) {
                made.push(self.box_at(column));
            }
            for index in made {
                if self.dice.below(3) > 0 {
                    let variable = self.one_of("v");
                    self.add(Shape::Output(variable), column + 2, vec![vec![index]]);
                }
                let handed = self.handed_on(index, column + 2);
                self.values.push(handed);
            }
        }
    }

    fn box_at(&mut self, column: usize) -> usize {
        if self.dice.once_in(4) {
            let callee = self.instance("acc");
            let source = self.number(column);
            return self.add(Shape::Block(callee, &["x"], "sum"), column + 1, vec![vec![source]]);
        }
        let function = FUNCTIONS[self.dice.below(FUNCTIONS.len())].to_owned();
        let sources = vec![vec![self.number(column)], vec![self.number(column)]];
        self.add(Shape::Block(function, &["IN1", "IN2"], "OUT"), column + 1, sources)
    }

    /// The element at which the others take its value.
    fn handed_on(&mut self, index: usize, column: usize) -> usize {
        match self.dice.below(8) {
            0 => {
                let variable = self.one_of("v");
                self.add(Shape::Through(variable), column, vec![vec![index]])
            }
            1 => {
                self.sketch.connectors += 1;
                let name = format!("far{}", self.sketch.connectors);
                let connector = self.add(Shape::Connector(name.clone()), column, vec![vec![index]]);
                let continuation = self.add(Shape::Continuation(name), column, Vec::new());
                // It is no line, but its source.
                debug_assert!(connector < continuation);
                continuation
            }
            _ => index,
        }
    }

    fn ladder(&mut self, rail: usize) {
        let columns = 2 + self.dice.below(4);
        for column in 0..columns {
            let mut made = Vec::new();
            for _ in 0..=self.dice.below(2) {
                let mut left = vec![if column == 0 { rail } else { self.values[self.dice.below(self.values.len())] }];
                let writes = column + 1 == columns || column > 0 && self.dice.once_in(3);
                let variable = self.one_of("b");
                let joined = column > 0 && self.dice.once_in(4) && !(writes && self.sketch.for_peer);
                if joined {
                    left.push(self.values[self.dice.below(self.values.len())]);
                    left.dedup();
                }
                let modifiers = ["", "", "negated=\"true\"", "storage=\"set\"", "storage=\"reset\"", "edge=\"rising\""];
                let allowed = if self.sketch.for_peer { 5 } else { 6 };
                let index = if !writes && column > 0 && self.dice.once_in(5) {
                    let callee = self.instance("SR");
                    self.add(Shape::Block(callee, &["S1", "R"], "Q1"), column, vec![left, Vec::new()])
                } else if writes {
                    let modifier = modifiers[self.dice.below(allowed)];
                    self.add(Shape::Coil(variable, modifier), column, vec![left])
                } else {
                    let modifier = ["", "", "negated=\"true\"", "edge=\"rising\""][self.dice.below(allowed - 2)];
                    self.add(Shape::Contact(variable, modifier), column, vec![left])
                };
                made.push(index);
            }
            self.values.extend(made);
        }
    }
}

impl Sketch {
    pub(crate) fn random(dice: &mut Dice, for_peer: bool) -> Self {
        let ladder = dice.once_in(2);
        let mut sketch = Self { ladder, elements: Vec::new(), instances: Vec::new(), connectors: 0, for_peer };
        if ladder {
            sketch.elements.push(Element { shape: Shape::Rail, at: (0, 0), sources: Vec::new(), number: None });
        }
        let mut below = 1;
        for _ in 0..=dice.below(3) {
            let mut right = 1;
            let mut deepest = below;
            // Networks stand one below the other, and sometimes side by side.
            for _ in 0..=usize::from(dice.once_in(4)) {
                let corner = (right, below);
                let mut net = Net { sketch: &mut sketch, dice, corner, taken: Vec::new(), values: Vec::new() };
                if ladder {
                    net.ladder(0);
                } else {
                    net.diagram();
                }
                right += net.taken.len() as i64 + 1;
                deepest = deepest.max(below + net.taken.iter().copied().max().unwrap_or(0));
            }
            below = deepest + 1;
        }
        if !ladder && dice.once_in(4) {
            sketch.give_numbers(dice);
        }
        sketch
    }

    /// The peer reads results of functions that a numbered block is the first to ask for a scan late, which nothing
    /// else does: there, blocks are numbered as they need each other.
    fn give_numbers(&mut self, dice: &mut Dice) {
        let numbers = shuffled(self.elements.len(), dice);
        for (index, (element, number)) in self.elements.iter_mut().zip(numbers).enumerate() {
            let number = if self.for_peer { index } else { number };
            element.number = match element.shape {
                Shape::Block(..) if self.for_peer || dice.once_in(3) => Some(number + 1),
                Shape::Output(_) if dice.once_in(3) => Some(number + 1),
                _ => None,
            };
        }
    }

    /// What comes from outside in a scan.
    pub(crate) fn inputs(dice: &mut Dice) -> [(&'static str, i64); 4] {
        let mut number = || dice.between(-9, 9);
        let (v0, v1) = (number(), number());
        [("v0", v0), ("v1", v1), ("b0", dice.between(0, 1)), ("b1", dice.between(0, 1))]
    }

    /// The variables that networks write.
    pub(crate) fn variables() -> Vec<String> {
        ["v", "b"].iter().flat_map(|prefix| (0..POOL).map(move |number| format!("{prefix}{number}"))).collect()
    }

    fn pins(&self, drawing: &Drawing, sources: &[usize]) -> Vec<String> {
        let pin = |source: &usize| match &self.elements[*source].shape {
            Shape::Block(_, _, output) => format!("{}.{output}", drawing.ids[*source]),
            _ => drawing.ids[*source].to_string(),
        };
        sources.iter().map(pin).collect()
    }

    fn drawn(&self, index: usize, drawing: &Drawing) -> String {
        let element = &self.elements[index];
        let (id, at) = (drawing.ids[index] as u32, drawing.places[index]);
        let left = || self.pins(drawing, element.sources.first().map_or(&[], Vec::as_slice)).join(" ");
        let number = element.number.map_or_else(String::new, |number| format!("executionOrderId=\"{number}\""));
        match &element.shape {
            Shape::Rail => rail(id),
            Shape::Input(variable) => input(id, at, variable),
            Shape::Output(variable) => output(id, at, &left(), variable, &number),
            Shape::Through(variable) => through(id, at, &left(), variable),
            Shape::Contact(variable, modifiers) => contact(id, at, &left(), variable, modifiers),
            Shape::Coil(variable, modifiers) => coil(id, at, &left(), variable, modifiers),
            Shape::Block(callee, names, output) => {
                let pins = names.iter().zip(&element.sources);
                let pins: Vec<String> =
                    pins.map(|(name, list)| format!("{name}={}", self.pins(drawing, list).join("|"))).collect();
                block(id, at, callee, &pins.join(" "), output, &number)
            }
            Shape::Connector(name) => {
                let from = crate::plcopen::from(&left());
                let (x, y) = at;
                format!(
                    "<connector name=\"{name}\" localId=\"{id}\"><position x=\"{x}\" y=\"{y}\"/>{from}</connector>\n"
                )
            }
            Shape::Continuation(name) => {
                let (x, y) = at;
                format!(
                    "<continuation name=\"{name}\" localId=\"{id}\"><position x=\"{x}\" y=\"{y}\"/>\
                     <connectionPointOut/></continuation>\n"
                )
            }
        }
    }

    /// The whole project.
    pub(crate) fn project(&self, drawing: &Drawing) -> String {
        let body: String = drawing.order.iter().map(|index| self.drawn(*index, drawing)).collect();
        let mut sections = String::from("local ");
        for number in 0..POOL {
            write!(sections, "v{number} : INT = {}, b{number} : BOOL, ", number + 1).expect("a string");
        }
        let sections = sections + &self.instances.join(", ");
        let sections = sections.trim_end_matches(", ");
        let acc = pou("functionBlock", "acc", "in x : INT; out sum : INT", "ST", "sum := sum + x;");
        let language = if self.ladder { "LD" } else { "FBD" };
        project(&(acc + &pou("program", "P", sections, language, &body)))
    }
}
