//! Programs of every elementary type, statement, standard function and standard block that a peer has, too.
//!
//! What [`known`](super::known) lists is not made, and not what else the peer cannot do: operations of literals only that
//! leave the range of their type and arrays of DATE and DT, which it does not compile; PT that changes while a timer runs.
//! Reals, durations and strings are kept within bounds, so that they never leave their range.

mod expressions;
mod types;

use onescan_iec::Dialect;

use std::fmt::Write;

use super::dice::Dice;
use super::peer_program::{PeerProgram, Watched};
use types::{BOOL, INT, Kind, LREAL, OTHERS, Type};

/// Variables of each type that a program assigns.
const VARIABLES: usize = 2;

/// A program in the making.
struct Typed<'d> {
    dice: &'d mut Dice,
    types: Vec<Type>,
    text: String,
    /// Control variables of the loops around, which may be read.
    around: Vec<String>,
    /// How many control variables there are.
    controls: usize,
    rounded: usize,
    /// Of the arrays' elements.
    element: Type,
}

/// Outputs of a block, with their types.
type Parts = &'static [(&'static str, &'static str)];

/// Instances of standard blocks, with what is compared of them.
const INSTANCES: [(&str, &str, Parts); 14] = [
    ("ton0", "TON", &[("Q", "BOOL"), ("ET", "TIME")]),
    ("ton1", "TON", &[("Q", "BOOL"), ("ET", "TIME")]),
    ("tof0", "TOF", &[("Q", "BOOL"), ("ET", "TIME")]),
    ("tp0", "TP", &[("Q", "BOOL"), ("ET", "TIME")]),
    ("ctu0", "CTU", &[("Q", "BOOL"), ("CV", "INT")]),
    ("ctd0", "CTD", &[("Q", "BOOL"), ("CV", "INT")]),
    ("ctud0", "CTUD", &[("QU", "BOOL"), ("QD", "BOOL"), ("CV", "INT")]),
    ("rise0", "R_TRIG", &[("Q", "BOOL")]),
    ("fall0", "F_TRIG", &[("Q", "BOOL")]),
    ("sr0", "SR", &[("Q1", "BOOL")]),
    ("rs0", "RS", &[("Q1", "BOOL")]),
    ("sum0", "Sum", &[("total", "INT")]),
    ("fold0", "Fold", &[("times", "UINT")]),
    ("count0", "Count", &[("total", "DINT"), ("late", "BOOL")]),
];

/// First and last index of the array.
const ENDS: (i64, i64) = (-1, 3);

pub(super) fn program(dice: &mut Dice) -> PeerProgram {
    let mut types = vec![BOOL, INT];
    while types.len() < 7 {
        let one = dice.pick(&OTHERS);
        if types.iter().all(|other| other.name != one.name) {
            types.push(one);
        }
    }
    let arrays: Vec<Type> = types.iter().copied().filter(|one| !matches!(one.kind, Kind::Moment | Kind::Day)).collect();
    let element = dice.pick(&arrays);
    let count = 10 + dice.below(12);
    let around = Vec::new();
    let mut typed = Typed { dice, types, text: String::new(), around, controls: 0, rounded: 0, element };
    typed.statements(count, 2);
    typed.finished()
}

impl Typed<'_> {
    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn finished(self) -> PeerProgram {
        let named = |name: &str, all: &dyn Fn(Type) -> String| {
            let each = self.types.iter().map(|one| format!("    {} : {}{};\n", all(*one), one.name, one.start()));
            format!("{name}\n{}END_VAR\n", each.collect::<String>())
        };
        let inputs = self.types.iter().map(|one| (one.input(), one.name)).collect();
        let mut outputs: Vec<Watched> = Vec::new();
        let mut text = "PROGRAM P\n".to_owned() + &named("VAR_INPUT", &|one| one.input());
        for number in 0..VARIABLES {
            text += &named("VAR", &|one| one.variable(number));
            outputs.extend(self.types.iter().map(|one| (one.variable(number), one.name)));
        }
        let controls: String = (0..self.controls).map(|number| format!("k{number} : INT; ")).collect();
        let rounded: Vec<Watched> = (0..self.rounded).map(|number| (format!("f{number}"), "LREAL")).collect();
        let functions: String = rounded.iter().map(|(path, ty)| format!("{path} : {ty}; ")).collect();
        let used = |name: &str| self.text.contains(&format!("{name}(")) || self.text.contains(&format!("{name}."));
        let instances = INSTANCES.iter().filter(|(name, ..)| used(name));
        let (first, last) = ENDS;
        write!(text, "VAR\n    {controls}{functions}row : ARRAY [{first}..{last}] OF {};\n", self.element.name)
            .expect("a string takes all");
        text += "    grid : ARRAY [0..1, 2..4] OF INT; sp : Spot;\n";
        let cells = (0..2).flat_map(|line| (2..5).map(move |place| format!("grid[{line},{place}]")));
        outputs.extend(cells.map(|path| (path, "INT")));
        outputs.extend((first..=last).map(|index| (format!("row[{index}]"), self.element.name)));
        outputs.extend([("n", "INT"), ("l", "LREAL"), ("b", "BOOL")].map(|(part, ty)| (format!("sp.{part}"), ty)));
        for (name, block, parts) in instances {
            writeln!(text, "    {name} : {block};").expect("a string takes all");
            outputs.extend(parts.iter().map(|(part, ty)| (format!("{name}.{part}"), *ty)));
        }
        text = text + "END_VAR\n" + &self.text + "END_PROGRAM\n";
        PeerProgram { dialect: Dialect::Iec2, family: "typed", text, inputs, outputs, rounded }
    }

    fn statements(&mut self, count: usize, depth: usize) {
        for _ in 0..count {
            self.statement(depth);
        }
    }

    fn block(&mut self, depth: usize) {
        let count = 1 + self.dice.below(3);
        self.statements(count, depth);
    }

    fn statement(&mut self, depth: usize) {
        let kinds = if depth == 0 { 9 } else { 15 };
        match self.dice.below(kinds) {
            0..=3 => self.assignment(),
            4 => {
                let index = self.index();
                let value = self.bounded(self.element, 2);
                self.line(&format!("row[{index}] := {value};"));
            }
            5 if self.dice.once_in(2) => {
                let (target, value) = (self.cell(), self.expression(INT, 2));
                self.line(&format!("{target} := {value};"));
            }
            5 => {
                let part = self.dice.pick(&[("n", INT), ("l", LREAL), ("b", BOOL)]);
                let value = self.bounded(part.1, 2);
                self.line(&format!("sp.{} := {value};", part.0));
            }
            6 | 7 => self.call(),
            8 => self.function(),
            9 | 10 => self.branch(depth - 1),
            11 => self.case(depth - 1),
            12 => self.for_loop(depth - 1),
            13 => self.while_loop(depth - 1),
            _ => self.repeat_loop(depth - 1),
        }
    }

    fn assignment(&mut self) {
        let types = self.types.clone();
        let one = self.dice.pick(&types);
        let target = one.variable(self.dice.below(VARIABLES));
        let value = self.bounded(one, 3);
        self.line(&format!("{target} := {value};"));
    }

    /// An expression whose value may be kept: reals, durations and strings grow no further.
    fn bounded(&mut self, one: Type, depth: usize) -> String {
        match one.kind {
            Kind::Real => {
                let (name, value) = (one.name, self.expression(one, depth));
                format!("LIMIT({name}#-1000.0, {value}, {name}#1000.0)")
            }
            Kind::Time => format!("LIMIT(T#-20s, {}, T#20s)", self.expression(one, depth)),
            Kind::Text => format!("LEFT({}, INT#20)", self.expression(one, depth.min(2))),
            _ => self.expression(one, depth),
        }
    }

    fn index(&mut self) -> String {
        let (first, last) = ENDS;
        if self.dice.once_in(2) {
            return self.dice.between(first, last).to_string();
        }
        let inner = self.expression(INT, 1);
        format!("LIMIT(INT#{first}, {inner}, INT#{last})")
    }

    /// An element of the array of arrays.
    fn cell(&mut self) -> String {
        let (line, place) = (self.dice.below(2), self.expression(INT, 1));
        format!("grid[{line}, LIMIT(INT#2, {place}, INT#4)]")
    }

    /// A function that the standard does not round; nothing reads the result.
    fn function(&mut self) {
        let value = self.expression(LREAL, 1);
        let near = format!("LIMIT(LREAL#-30.0, {value}, LREAL#30.0)");
        let (low, high) = (format!("LIMIT(LREAL#-1.0, {value}, LREAL#1.0)"), format!("(ABS({value}) + LREAL#0.125)"));
        let text = match self.dice.below(10) {
            0 => format!("SIN({near})"),
            1 => format!("COS({near})"),
            2 => format!("TAN({near})"),
            3 => format!("EXP({near})"),
            4 => format!("ASIN({low})"),
            5 => format!("ACOS({low})"),
            6 => format!("ATAN({near})"),
            7 => format!("LN({high})"),
            8 => format!("LOG({high})"),
            _ => format!("EXPT({high}, LREAL#{}.5)", self.dice.between(-3, 3)),
        };
        let number = self.rounded;
        self.rounded += 1;
        self.line(&format!("f{number} := {text};"));
    }

    fn branch(&mut self, depth: usize) {
        let condition = self.truth(2);
        self.line(&format!("IF {condition} THEN"));
        self.block(depth);
        if self.dice.once_in(2) {
            let condition = self.truth(2);
            self.line(&format!("ELSIF {condition} THEN"));
            self.block(depth);
        }
        if self.dice.once_in(2) {
            self.line("ELSE");
            self.block(depth);
        }
        if !self.around.is_empty() && self.dice.once_in(3) {
            self.line("EXIT;");
        } else if self.dice.once_in(12) {
            self.line("RETURN;");
        }
        self.line("END_IF;");
    }

    fn case(&mut self, depth: usize) {
        let selector = self.expression(INT, 2);
        self.line(&format!("CASE {selector} OF"));
        let mut next = self.dice.between(-6, 0);
        for _ in 0..=self.dice.below(3) {
            let last = next + self.dice.between(1, 5);
            let other = last + 1 + self.dice.between(0, 2);
            self.line(&format!("{next}..{last}, {other}:"));
            next = other + 1 + self.dice.between(0, 2);
            self.block(depth);
        }
        if self.dice.once_in(2) {
            self.line("ELSE");
            self.block(depth);
        }
        self.line("END_CASE;");
    }

    fn control(&mut self) -> String {
        self.controls += 1;
        format!("k{}", self.controls - 1)
    }

    fn inside(&mut self, control: String, depth: usize) {
        self.around.push(control);
        self.block(depth);
        self.around.pop();
    }

    fn for_loop(&mut self, depth: usize) {
        let control = self.control();
        let (first, step) = (self.dice.between(-5, 5), self.dice.pick(&[-7_i64, -2, -1, 1, 1, 1, 2, 3]));
        let turns = self.dice.pick(&[0_i64, 2, 3, 4, 5]);
        let last = first + step * (turns - 1) + step.signum() * self.dice.between(0, step.abs() - 1);
        // Without turns it is surely beyond.
        let last = if turns == 0 { first - 2 * step } else { last };
        let by = if step == 1 && self.dice.once_in(2) { String::new() } else { format!(" BY {step}") };
        if step == 1 && turns > 0 && self.dice.once_in(3) {
            // The program never writes its inputs.
            let (low, high) = (first + 1, first + 6);
            self.line(&format!("FOR {control} := {first} TO LIMIT(INT#{low}, in_int, INT#{high}){by} DO"));
        } else {
            self.line(&format!("FOR {control} := {first} TO {last}{by} DO"));
        }
        self.inside(control, depth);
        self.line("END_FOR;");
    }

    fn while_loop(&mut self, depth: usize) {
        let (control, turns, condition) = (self.control(), self.dice.between(1, 5), self.truth(2));
        self.line(&format!("{control} := 0;\nWHILE {control} < {turns} AND {condition} DO"));
        self.line(&format!("{control} := {control} + 1;"));
        self.inside(control, depth);
        self.line("END_WHILE;");
    }

    fn repeat_loop(&mut self, depth: usize) {
        let control = self.control();
        self.line(&format!("{control} := 0;\nREPEAT {control} := {control} + 1;"));
        self.inside(control.clone(), depth);
        let (turns, condition) = (self.dice.between(1, 5), self.truth(2));
        self.line(&format!("UNTIL {control} >= {turns} OR {condition} END_REPEAT;"));
    }

    /// A call of an instance: each has one time or limit for all its calls.
    fn call(&mut self) {
        let (a, b) = (self.truth(1), self.truth(1));
        let number = self.dice.below(INSTANCES.len());
        let text = match INSTANCES[number].0 {
            "ton0" => format!("ton0(IN := {a}, PT := T#30ms)"),
            "ton1" => format!("ton1(IN := {a}, PT := T#7ms)"),
            "tof0" => format!("tof0(IN := {a}, PT := T#45ms)"),
            "tp0" => format!("tp0(IN := {a}, PT := T#52ms)"),
            "ctu0" => format!("ctu0(CU := {a}, R := {b} OR ctu0.CV >= 3, PV := 3)"),
            "ctd0" => format!("ctd0(CD := {a}, LD := {b} OR ctd0.CV <= 0, PV := 5)"),
            "ctud0" => {
                let c = self.truth(0);
                format!("ctud0(CU := {a}, CD := {b}, R := {c} OR ctud0.CV >= 4, LD := ctud0.CV <= 0, PV := 4)")
            }
            "rise0" => format!("rise0(CLK := {a})"),
            "fall0" => format!("fall0(CLK := {a})"),
            "sr0" => format!("sr0(S1 := {a}, R := {b})"),
            "rs0" => format!("rs0(S := {a}, R1 := {b})"),
            "sum0" => {
                let value = self.expression(INT, 1);
                format!("sum0(x := {value})")
            }
            "fold0" => {
                let target = self.dice.pick(&["int0", "int1", "sp.n"]);
                let value = self.expression(INT, 1);
                format!("fold0(x := {target}, by_how_much := {value})")
            }
            _ => {
                let value = self.expression(INT, 1);
                format!("count0(runs := {a}, by_how_much := INT_TO_DINT({value}))")
            }
        };
        self.line(&format!("{text};"));
    }
}
