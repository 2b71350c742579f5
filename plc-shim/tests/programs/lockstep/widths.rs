//! Programs of tools that compute integers in registers for targets that compute them in the operands' types, and the
//! other way round: a port carries the conversions that make both agree.

use std::fmt::Write as _;
use std::path::Path;

use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::{Dialect, Input, TaskPlan, TimeSpan, WordSize};
use onescan_iec_project::instrument::{Options, Project, Target, instrument};
use onescan_iec_run::{Application, SoftPlc};

use crate::matiec::dice::Dice;
use crate::rig::{Rig, task};

/// From the dialect to the target, and how that reads what is written for it.
const WAYS: [(Dialect, Target, Dialect); 7] = [
    (Dialect::Codesys, Target::Scl, Dialect::SiemensScl),
    (Dialect::TwinCat, Target::Scl, Dialect::SiemensScl),
    (Dialect::Codesys, Target::Beremiz, Dialect::Matiec),
    (Dialect::TwinCat, Target::OpenPlc, Dialect::Matiec),
    (Dialect::Iec3, Target::Codesys, Dialect::Codesys),
    (Dialect::Matiec, Target::Codesys, Dialect::Codesys),
    (Dialect::TwinCat, Target::Codesys, Dialect::Codesys),
];

fn input(dialect: Dialect, text: &str) -> Input {
    Input::from_text("plc/line.st", SourceKind::Text, text).in_dialect(dialect)
}

fn ported(input: Input, target: Target) -> Result<Project, String> {
    let tasks = Some(vec![task("main", 10, 0, &["P"])]);
    instrument(&[input], &Options { target, tasks, ..Options::default() }).map_err(|refused| refused.to_string())
}

fn text_of(project: &Project) -> String {
    project.program().next().and_then(|file| file.text.as_deref()).unwrap_or("").to_owned()
}

/// The port after a scan, not simulated.
fn run(project: &Project, dialect: Dialect, size: WordSize) -> SoftPlc {
    let read = |file: &onescan_iec_project::instrument::File| {
        let Some(FileKind::Source(kind)) = FileKind::of(Path::new(&file.name)) else { panic!("{}", file.name) };
        Input::from_text(&file.name, kind, file.text.clone().expect("a text")).in_dialect(dialect).for_words(size)
    };
    let application = Application::from_inputs(project.program().map(read))
        .unwrap_or_else(|found| panic!("{found}\n{}", text_of(project)));
    let plan = match (application.configured_tasks(), &project.tasks) {
        (Some(plan), _) => plan,
        (None, Some(own)) => TaskPlan::new([vec![task("sdsp", 10, 0, &["SDSP_Scheduler"])], own.clone()].concat()),
        (None, None) => application.single_task(TimeSpan::millis::<10>()),
    };
    let mut plc = SoftPlc::new(&application, &plan).expect("the plan suits");
    let simulated = if dialect == Dialect::SiemensScl { "SDSP.SDSP_Simulated" } else { "SDSP_Simulated" };
    for step in 1..=3 {
        super::driver::write(&mut plc, simulated, 0);
        super::driver::scan(&mut plc, step * 10 * crate::rig::MS);
    }
    plc
}

/// A variable of program `P`, which MatIEC's configuration calls by another name.
fn bytes(plc: &SoftPlc, name: &str) -> Vec<u8> {
    let found = ["P", "Res0.Run_P"].iter().find_map(|program| plc.variable(&format!("{program}.{name}")).ok());
    found.unwrap_or_else(|| panic!("no `{name}`")).bytes(plc.memory())
}

const EXAMPLES: &str = "
PROGRAM P
VAR
    i : INT := 300; a : INT := 30000; b : INT := 20000; u : UINT := 10; v : UINT := 20; s : SINT := 100; d : DINT := 2000000000;
    cells : ARRAY [0..3] OF INT := [1, 2, 3, 4]; k : INT := INT#1; long : LINT; wide, greater, kept, sum, chosen, called : DINT;
    scaled : REAL; mean, low, next, mixed : INT; below, same : BOOL; t : TIME;
END_VAR
    wide := i * 1000;
    scaled := i * 1000;
    mean := (a + b) / 2;
    low := a + b;
    below := u - v > 5;
    same := a + b = 50000;
    greater := MAX(a + b, 1);
    kept := ABS(-a - b);
    long := d * 2;
    sum := s + s + a;
    chosen := INT_TO_DINT(a + b);
    next := cells[(k + k) / 2] + 1;
    called := TO_DINT(i * INT#1000);
    mixed := (i + 5) MOD 7;
    t := DINT_TO_TIME(i * 1000);
END_PROGRAM
";

fn body(text: &str) -> String {
    let from = text.find("wide :=").or_else(|| text.find("#wide :=")).expect("the first statement");
    let end = ["END_PROGRAM", "</"].iter().filter_map(|end| text[from..].find(end)).min().expect("its end");
    text[from..from + end].lines().map(str::trim).collect::<Vec<_>>().join("\n")
}

#[test]
fn conversions_are_written() {
    let registers =
        ported(input(Dialect::Codesys, EXAMPLES), Target::Beremiz).unwrap_or_else(|refused| panic!("{refused}"));
    insta::assert_snapshot!("widths_to_operands", body(&text_of(&registers)));
    let operands =
        ported(input(Dialect::Iec3, EXAMPLES), Target::Codesys).unwrap_or_else(|refused| panic!("{refused}"));
    insta::assert_snapshot!("widths_to_registers", body(&text_of(&operands)));
}

/// What makes no difference stays as it is, and the files of the project do in any case.
#[test]
fn what_makes_no_difference_stays() {
    let text = "PROGRAM P VAR i, j : INT; k : SINT; d : DINT; l : LINT; b : BOOL; END_VAR
        i := i + 1; i := i * j - 5; d := i; d := d + i; l := l * d; b := i < j; i := i / 2; i := i + k; i := 0 - i;
        END_PROGRAM";
    for (from, target, _) in WAYS {
        let project = ported(input(from, text), target).unwrap_or_else(|refused| panic!("{from}: {refused}"));
        let written = text_of(&project);
        // The shim stands before the program or behind it.
        let own =
            written.find("* ").map(|_| written.lines().filter(|line| line.contains("_TO_") && line.contains("i ")));
        assert_eq!(own.into_iter().flatten().collect::<Vec<_>>(), [""; 0], "{from} to {target:?}");
        assert_eq!(project.files[0].text.as_deref(), Some(text), "{from} to {target:?}");
    }
}

/// Initial values are computed as well.
#[test]
fn computed_initial_values_are_numbers() {
    let text = "VAR_GLOBAL CONSTANT K : INT := 300; END_VAR
        PROGRAM P VAR a : DINT := K * 1000; b : DINT := K + 1; c : LREAL := K * 1000; d : INT := (K * 200) / 2; END_VAR
        b := b + 1; END_PROGRAM";
    for (from, target, reader) in WAYS {
        let mut rig = Rig::of_input(input(from, text));
        rig.scan().expect("it runs");
        let project = ported(input(from, text), target).unwrap_or_else(|refused| panic!("{from}: {refused}"));
        let plc = run(&project, reader, WordSize::Bits64);
        for name in ["a", "c", "d"] {
            assert_eq!(bytes(&plc, name), bytes(&rig.plc, name), "{from} to {target:?}: {name}\n{}", text_of(&project));
        }
    }
}

/// A list has no place for a conversion of what is computed so far.
#[test]
fn instruction_lists_that_differ_are_refused() {
    let list =
        |behind: &str| format!("PROGRAM P\nVAR a, b : INT; c : INT; END_VAR\nLD a\nADD b\n{behind}ST c\nEND_PROGRAM\n");
    assert!(ported(input(Dialect::Iec3, &list("")), Target::Codesys).is_ok());
    let refused = ported(input(Dialect::Iec3, &list("DIV 2\n")), Target::Codesys).expect_err("it differs");
    assert!(refused.contains("an instruction list that goes beyond"), "{refused}");
}

/// The targets iec and twincat leave the author's files to the tool that they are of.
#[test]
fn files_that_stay_carry_none() {
    for target in [Target::Iec, Target::TwinCat] {
        let project = ported(input(Dialect::TwinCat, EXAMPLES), target).unwrap_or_else(|refused| panic!("{refused}"));
        let own = project.files.iter().find(|file| file.name == "plc/line.st").and_then(|file| file.text.clone());
        assert!(own.is_some_and(|text| text.contains("wide := i * 1000;")), "{target:?}");
    }
}

/// Integers of one sign: each with its least and greatest value.
const SIGNED: [(&str, i128, i128); 4] = [
    ("SINT", -128, 127),
    ("INT", -32_768, 32_767),
    ("DINT", -2_147_483_648, 2_147_483_647),
    ("LINT", -9_223_372_036_854_775_808, 9_223_372_036_854_775_807),
];
const UNSIGNED: [(&str, i128, i128); 4] =
    [("USINT", 0, 255), ("UINT", 0, 65_535), ("UDINT", 0, 4_294_967_295), ("ULINT", 0, 9_223_372_036_854_775_807)];

struct Writer<'d> {
    dice: &'d mut Dice,
    types: [(&'static str, i128, i128); 4],
    declared: String,
    variables: usize,
}

impl Writer<'_> {
    /// A variable; never 0, so that it may stand behind a division.
    fn variable(&mut self) -> String {
        let (name, least, most) = self.dice.pick(&self.types);
        let edges = [least.max(1), least + 1, most, most - 1, most / 2, most / 3, 100.min(most)];
        let value = self.dice.pick(&edges);
        let variable = format!("v{}", self.variables);
        self.variables += 1;
        writeln!(self.declared, "{variable} : {name} := {value};").expect("a string");
        variable
    }

    fn number(&mut self, depth: u32) -> String {
        if depth == 0 || self.dice.once_in(6) {
            return self.variable();
        }
        let left = self.number(depth - 1);
        match self.dice.below(12) {
            0 if self.types[0].1 < 0 => format!("-({left})"),
            1 => format!("TO_{}({left})", self.dice.pick(&self.types).0),
            2 => format!("MAX({left}, {})", self.number(depth - 1)),
            3 => format!("MIN({left}, {})", self.number(depth - 1)),
            4 | 5 => format!("({left} / {})", self.dice.pick(&["2", "3", "100"])),
            6 => format!("({left} MOD {})", self.variable()),
            7 => format!("({left} * {})", self.dice.pick(&["2", "10", "100"])),
            8 | 9 => format!("({left} * {})", self.number(depth - 1)),
            10 => format!("({left} - {})", self.number(depth - 1)),
            _ => format!("({left} + {})", self.number(depth - 1)),
        }
    }
}

/// A program with statements that look at all bits and at low ones: its text and its results.
fn program(dice: &mut Dice) -> (String, Vec<String>) {
    let types = dice.pick(&[SIGNED, UNSIGNED]);
    let mut writer = Writer { dice, types, declared: String::new(), variables: 0 };
    let (mut body, mut results) = (String::new(), Vec::new());
    for index in 0..10 {
        let value = writer.number(3);
        let (ty, value) = match writer.dice.below(5) {
            0 => ("BOOL", format!("{value} {} {}", writer.dice.pick(&["<", ">", "=", "<>"]), writer.number(2))),
            1 => ("LREAL", format!("TO_LREAL({value})")),
            2 => {
                let narrow = writer.dice.pick(&types[..3]).0;
                (narrow, format!("TO_{narrow}({value})"))
            }
            _ => (types[3].0, value),
        };
        writeln!(writer.declared, "out{index} : {ty};").expect("a string");
        writeln!(body, "out{index} := {value};").expect("a string");
        results.push(format!("out{index}"));
    }
    (format!("PROGRAM P\nVAR\n{}END_VAR\n{body}END_PROGRAM\n", writer.declared), results)
}

/// `ONESCAN_WIDTHS=1000` tries more programs.
#[test]
fn random_programs_and_their_ports_agree() {
    let count = std::env::var("ONESCAN_WIDTHS").ok().and_then(|text| text.parse().ok()).unwrap_or(4);
    let mut dice = Dice::new(11);
    for _ in 0..count {
        let (text, results) = program(&mut dice);
        for (from, target, reader) in WAYS {
            for size in [WordSize::Bits64, WordSize::Bits32] {
                let given = input(from, &text).for_words(size);
                let mut rig = Rig::of_input(given.clone());
                rig.scan().expect("it runs");
                let project = ported(given, target).unwrap_or_else(|refused| panic!("{from}: {refused}\n{text}"));
                let plc = run(&project, reader, size);
                for result in &results {
                    let (found, wanted) = (bytes(&plc, result), bytes(&rig.plc, result));
                    assert_eq!(found, wanted, "{from} {size} to {target:?}: {result}\n{text}\n{}", text_of(&project));
                }
            }
        }
    }
}

/// Statements that convert by themselves in CODESYS and TwinCAT, each with what it is about.
const EVERYDAY: [&str; 44] = [
    "w := w + 1;",
    "w := w - i;",
    "w := w / 2;",
    "w := w * 2 / 3;",
    "lw := lw + 1;",
    "y := y + 1;",
    "w := -1;",
    "w := MANY;",
    "i := w;",
    "w := i;",
    "i := w + 1;",
    "d := w;",
    "dw := i;",
    "dw := d + w;",
    "u := w;",
    "l := lw;",
    "u := u + w;",
    "d := i + w;",
    "i := NOT i;",
    "i := NOT (i * 1000);",
    "w := NOT i;",
    "w := NOT (w + 1);",
    "i := i AND 7;",
    "i := i AND -2;",
    "d := (i * 1000) AND 16#FFFF;",
    "w := (w + 1) AND 255;",
    "d := w OR i;",
    "w := i XOR w;",
    "b := (w AND 4) <> 0;",
    "b := (i AND 4) = 4;",
    "b := w > i;",
    "b := w + 1 = 0;",
    "i := SHL(i, 2);",
    "w := SHR(w + 1, 2);",
    "i := SHL(i, w);",
    "u := SHR(u, 1);",
    "w := SHL(1, 3);",
    "w := ROL(w, i);",
    "r := lr;",
    "r := l;",
    "t := DINT_TO_TIME(i AND 7);",
    "i := cells[k];",
    "cells[(k + 1) / 2] := 5;",
    "i := cells[w2];",
];

#[test]
fn what_vendors_convert_is_converted() {
    let mut wrong = Vec::new();
    for statement in EVERYDAY {
        let text = format!(
            "VAR_GLOBAL CONSTANT MANY : INT := 300; END_VAR
            PROGRAM P VAR w : WORD := 16#FFFE; w2 : WORD := 2; dw : DWORD := 16#FFFF_FFF0; y : BYTE := 255; lw : LWORD := 77;
            i : INT := -300; u : UINT := 60000; d : DINT := 70000; l : LINT := 123456789; k : LINT := 2; r : REAL; lr : LREAL := 0.1; t : TIME;
            b : BOOL; cells : ARRAY [0..3] OF INT := [1, 2, 3, 4]; END_VAR\n{statement}\nEND_PROGRAM\n"
        );
        if let Err(found) = Application::from_inputs([input(Dialect::Codesys, &text)]) {
            wrong.push(format!("{statement}\n{found}"));
            continue;
        }
        for (from, target, reader) in WAYS.into_iter().filter(|(_, target, _)| *target != Target::Codesys) {
            let mut rig = Rig::of_input(input(from, &text));
            for _ in 0..3 {
                rig.scan().expect("it runs");
            }
            let project = match ported(input(from, &text), target) {
                Ok(project) => project,
                Err(refused) => {
                    wrong.push(format!("{from} to {target:?}: {statement}\n{refused}"));
                    continue;
                }
            };
            let plc = run(&project, reader, WordSize::Bits64);
            for result in ["w", "dw", "y", "lw", "i", "u", "d", "l", "r", "b", "cells[1]"] {
                if bytes(&plc, result) != bytes(&rig.plc, result) {
                    wrong.push(format!(
                        "{from} to {target:?}: {statement} gives another {result}\n{}",
                        text_of(&project)
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
