//! Integers in registers, as CODESYS and TwinCAT compute them: the examples of their manuals, and random expressions
//! against a model in C that was written apart from the compiler.

use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Code, Dialect, Input, WordSize, inspect};

use crate::matiec::dice::Dice;
use crate::rig::{Rig, findings_in, input_in};

const DIALECTS: [Dialect; 2] = [Dialect::Codesys, Dialect::TwinCat];

/// A program for a target with registers of 32 bits.
fn small(dialect: Dialect, text: &str) -> Input {
    input_in(dialect, text).for_words(WordSize::Bits32)
}

/// What stands in the manuals, and what the review of everyday programs asked for.
const EXAMPLES: &str = "
    PROGRAM P
    VAR
        w1 : WORD := 65535; w2, w3 : WORD; u : USINT; i : INT := 300; a : INT := 30000; b : INT := 20000;
        full : BYTE := 255; d : DINT := 2000000000; ten : UINT := 10; twenty : UINT := 20; least : INT := -32768;
        minus : INT := -1; cells : ARRAY [0..255] OF INT := [256(7)];
        dw : DWORD; first, second, third, fourth, fifth, sixth, seventh : BOOL;
        wide, extreme, quotient, opposite, kept, ordered, selected : DINT; scaled, below : REAL; mean, sum : INT; long : LINT;
        chosen : INT;
    END_VAR
        dw := w1 + 1;
        first := (w1 + 1) = w2;
        second := (w2 - 1) = w1;
        third := u - 1 <> 255;
        w3 := w1 + 1;
        fourth := w3 = w2;
        fifth := TO_WORD(w1 + 1) = w2;
        sixth := TO_WORD(w2 - 1) = w1;
        seventh := TO_USINT(u - 1) <> 255;
        wide := i * 1000;
        scaled := i * 1000;
        sum := full + 10;
        mean := (a + b) / 2;
        long := d * 2;
        extreme := MAX(a + b, 1);
        quotient := least / minus;
        opposite := -least;
        kept := ABS(least - 1);
        ordered := LIMIT(0, a + b, 40000);
        selected := SEL(TRUE, 0, a + b);
        below := ten - twenty;
        CASE full + 1 OF 0: chosen := 1; 256: chosen := 2; END_CASE
    END_PROGRAM";

/// What the examples give in every register, and `d * 2` and `ten - twenty` in those of the rig.
fn examples_hold(dialect: Dialect, mut rig: Rig, long: i64, below: f64) {
    rig.scan().expect("it runs");
    let found =
        ["first", "second", "third", "fourth", "fifth", "sixth", "seventh"].map(|name| rig.bool(&format!("P.{name}")));
    assert_eq!(found, [false, false, true, true, true, true, false], "{dialect}");
    let numbers = [
        ("dw", 65536),
        ("wide", 300_000),
        ("sum", 265),
        ("mean", 25_000),
        ("long", long),
        ("extreme", 50_000),
        ("quotient", 32_768),
        ("opposite", 32_768),
        ("kept", 32_769),
        ("ordered", 40_000),
        ("selected", 50_000),
        ("chosen", 2),
    ];
    for (name, wanted) in numbers {
        assert_eq!(rig.int(&format!("P.{name}")), wanted, "{dialect} {name}");
    }
    assert_eq!(rig.real("P.scaled"), 300_000.0, "{dialect}");
    assert_eq!(rig.real("P.below"), below, "{dialect}");
}

#[test]
fn examples_of_the_manuals() {
    for dialect in DIALECTS {
        // A register without a sign.
        let below = 1.844_674_407_370_955_2e19;
        examples_hold(dialect, Rig::in_dialect(dialect, EXAMPLES), 4_000_000_000, below);
    }
}

/// The same with registers of 32 bits: what has more than 32 is cut, and what comes below 0 has 32 bits.
#[test]
fn examples_of_the_manuals_in_32_bits() {
    for dialect in DIALECTS {
        // 4294967286 as REAL.
        let below = 4_294_967_296.0;
        examples_hold(dialect, Rig::of_input(small(dialect, EXAMPLES)), -294_967_296, below);
        // An operand of 64 bits takes two registers.
        let text =
            "PROGRAM P VAR d : DINT := 2000000000; l : LINT := 2; long : LINT; END_VAR long := d * l; END_PROGRAM";
        let mut rig = Rig::of_input(small(dialect, text));
        rig.scan().expect("it runs");
        assert_eq!(rig.int("P.long"), 4_000_000_000, "{dialect}");
    }
}

/// The pragma says so of one text, and what reads it for another target takes precedence.
#[test]
fn a_text_names_its_word_size() {
    let text =
        "{dialect 'codesys' 32}\nPROGRAM P VAR d : DINT := 2000000000; long : LINT; END_VAR long := d * 2; END_PROGRAM";
    let input = || Input::from_text("a.st", SourceKind::Text, text);
    for (input, wanted) in [
        (input(), -294_967_296),
        (input().read_as(None, None), -294_967_296),
        (input().read_as(Some(Dialect::TwinCat), Some(WordSize::Bits64)), 4_000_000_000),
    ] {
        let mut rig = Rig::of_input(input);
        rig.scan().expect("it runs");
        assert_eq!(rig.int("P.long"), wanted);
    }
    let wrong = Input::from_text("a.st", SourceKind::Text, "{dialect 'codesys' 16}\nPROGRAM P END_PROGRAM");
    insta::assert_snapshot!(inspect([wrong], None), @"a.st:1:20: error[S0110]: `16` is not a word size: 32 or 64 bits");
}

/// A state of one target is not one of the other.
#[test]
fn word_sizes_are_part_of_the_code() {
    let text = "PROGRAM P VAR d : DINT; END_VAR d := d + 1; END_PROGRAM";
    let mut wide = Rig::in_dialect(Dialect::Codesys, text);
    wide.scan().expect("it runs");
    let state = wide.plc.save();
    let mut narrow = Rig::of_input(small(Dialect::Codesys, text));
    assert!(narrow.plc.restore(&state).is_err(), "compiled for other registers");
}

/// The other dialects compute in the operands' type.
#[test]
fn others_wrap_in_their_type() {
    let text = "PROGRAM P VAR i : INT := 300; a : INT := 30000; b : INT := 20000; wide : DINT; mean : INT; same : BOOL;
        w : UINT := 65535; zero : UINT; END_VAR
        wide := i * 1000; mean := (a + b) / 2; same := (w + 1) = zero; END_PROGRAM";
    for dialect in [Dialect::Iec2, Dialect::Iec3, Dialect::SiemensScl, Dialect::Matiec] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("it runs");
        assert_eq!((rig.int("P.wide"), rig.int("P.mean"), rig.bool("P.same")), (-27_680, -7_768, true), "{dialect}");
    }
}

/// An index beyond an array is one, although its own type would wrap into it.
#[test]
fn an_index_is_not_cut_into_its_array() {
    let text = "PROGRAM P VAR b : BYTE := 255; cells : ARRAY [0..255] OF INT; END_VAR cells[b + 1] := 1; END_PROGRAM";
    for dialect in DIALECTS {
        let fault = Rig::in_dialect(dialect, text).scan().expect_err("there is no element 256");
        assert!(fault.to_string().contains("array index out of range"), "{dialect}: {fault}");
    }
}

#[test]
fn where_widths_differ_is_reported() {
    let difference = "PROGRAM P VAR now, last : UINT; due : BOOL; END_VAR due := now - last >= 10; END_PROGRAM";
    let product = "PROGRAM P VAR a : INT; b : DINT; END_VAR b := a * 1000; END_PROGRAM";
    let codes = |dialect, text| findings_in(dialect, text).iter().map(|found| found.code).collect::<Vec<_>>();
    for dialect in DIALECTS {
        assert!(codes(dialect, difference).contains(&Code::UncutDifference), "{dialect}");
        assert!(!codes(dialect, product).contains(&Code::CutProduct), "{dialect}");
        // With 32 bits, a UDINT and a DINT fill a register.
        let codes = |text| inspect([small(dialect, text)], None).iter().map(|found| found.code).collect::<Vec<_>>();
        assert!(codes(difference).contains(&Code::UncutDifference), "{dialect}");
        let (filling, long) = (
            "PROGRAM P VAR now, last : UDINT; due : BOOL; END_VAR due := now - last >= 10; END_PROGRAM",
            "PROGRAM P VAR a : DINT; b : LINT; END_VAR b := a * 1000; END_PROGRAM",
        );
        assert!(!codes(filling).contains(&Code::UncutDifference), "{dialect}");
        assert!(!codes(product).contains(&Code::CutProduct), "{dialect}");
        assert!(codes(long).contains(&Code::CutProduct), "{dialect}");
    }
    for dialect in [Dialect::Iec2, Dialect::Iec3, Dialect::SiemensScl, Dialect::Matiec] {
        assert!(!codes(dialect, difference).contains(&Code::UncutDifference), "{dialect}");
        assert!(codes(dialect, product).contains(&Code::CutProduct), "{dialect}");
    }
}

/// A type: what the model calls it, and the language.
const TYPES: [(&str, u32, &str); 12] = [
    ("i8", 8, "SINT"),
    ("i16", 16, "INT"),
    ("i32", 32, "DINT"),
    ("i64", 64, "LINT"),
    ("u8", 8, "USINT"),
    ("u16", 16, "UINT"),
    ("u32", 32, "UDINT"),
    ("u64", 64, "ULINT"),
    ("b8", 8, "BYTE"),
    ("b16", 16, "WORD"),
    ("b32", 32, "DWORD"),
    ("b64", 64, "LWORD"),
];

/// An expression twice over: for the model and in the language, whose variables `declared` declares.
struct Twin<'d> {
    dice: &'d mut Dice,
    model: String,
    declared: String,
    variables: usize,
}

impl Twin<'_> {
    fn variable(&mut self) -> String {
        let (short, bits, long) = self.dice.pick(&TYPES);
        let signed = short.starts_with('i');
        let (least, most) = match (signed, bits) {
            (true, bits) => (-(1_i128 << (bits - 1)), (1_i128 << (bits - 1)) - 1),
            // The model reads signed numbers of 64 bits.
            (false, bits) => (0, (1_i128 << bits.min(63)) - 1),
        };
        let edges = [least, least + 1, most, most - 1, 0, 1, 2, most / 2, 100.min(most), most / 3];
        let value = self.dice.pick(&edges);
        let name = format!("v{}", self.variables);
        self.variables += 1;
        write!(self.model, "{short}:{value} ").expect("a string");
        write!(self.declared, "{name} : {long} := {long}#{value}; ").expect("a string");
        name
    }

    fn number(&mut self, depth: u32) -> String {
        if depth == 0 || self.dice.once_in(6) {
            return self.variable();
        }
        match self.dice.below(10) {
            0 => {
                self.model += "~ ";
                format!("-({})", self.number(depth - 1))
            }
            1 => {
                let (short, _, long) = self.dice.pick(&TYPES);
                write!(self.model, "!{short} ").expect("a string");
                format!("TO_{long}({})", self.number(depth - 1))
            }
            2 => {
                let name = self.dice.pick(&["min", "max"]);
                write!(self.model, "{name} ").expect("a string");
                let left = self.number(depth - 1);
                format!("{}({left}, {})", name.to_uppercase(), self.number(depth - 1))
            }
            _ => {
                let (sign, operator) = self.dice.pick(&[("+", "+"), ("-", "-"), ("*", "*"), ("/", "/"), ("%", "MOD")]);
                write!(self.model, "{sign} ").expect("a string");
                let left = self.number(depth - 1);
                format!("({left} {operator} {})", self.number(depth - 1))
            }
        }
    }

    /// A number, or the truth of a comparison as one.
    fn whole(&mut self) -> String {
        if self.dice.once_in(3) {
            let operator = self.dice.pick(&["<", ">", "="]);
            write!(self.model, "{operator} ").expect("a string");
            let left = self.number(3);
            return format!("BOOL_TO_LINT({left} {operator} {})", self.number(3));
        }
        format!("TO_LINT({})", self.number(4))
    }
}

/// What the model makes of the expressions, one for each line.
fn modelled(lines: &str) -> Option<Vec<String>> {
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("model");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/programs/registers/model.c");
    let compiled = Command::new("gcc").args(["-O1", "-fwrapv", "-o"]).arg(&program).arg(source).status().ok()?;
    assert!(compiled.success(), "the model is C");
    let mut child = Command::new(&program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
    let mut input = child.stdin.take().expect("piped");
    let text = lines.to_owned();
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output().expect("it ends");
    writer.join().expect("no panic").expect("it reads all");
    assert!(output.status.success(), "the model reads what is written for it");
    Some(String::from_utf8(output.stdout).expect("text").lines().map(str::to_owned).collect())
}

/// `ONESCAN_REGISTERS=20000` tries more of them.
#[test]
#[expect(clippy::print_stdout, reason = "why nothing is compared")]
fn random_expressions_are_those_of_the_model() {
    let count = std::env::var("ONESCAN_REGISTERS").ok().and_then(|text| text.parse().ok()).unwrap_or(200);
    let mut dice = Dice::new(7);
    let (mut models, mut programs) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let mut twin = Twin { dice: &mut dice, model: String::new(), declared: String::new(), variables: 0 };
        let expression = twin.whole();
        models.push(twin.model);
        programs.push(format!("PROGRAM P VAR {}out : LINT; END_VAR out := {expression}; END_PROGRAM", twin.declared));
    }
    for size in [WordSize::Bits64, WordSize::Bits32] {
        let lines: String = models.iter().map(|model| format!("{size} {model}\n")).collect();
        let Some(wanted) = modelled(&lines) else {
            println!("skipped: `gcc` is not on the PATH");
            return;
        };
        assert_eq!(wanted.len(), programs.len());
        let faults = wanted.iter().filter(|value| *value == "fault").count();
        assert!(faults * 3 < count, "most of them have a value: {faults} faults of {count}");
        for dialect in DIALECTS {
            for (program, wanted) in programs.iter().zip(&wanted) {
                let mut rig = Rig::of_input(input_in(dialect, program).for_words(size));
                let found = rig.scan().map_or_else(|_| "fault".to_owned(), |()| rig.int("P.out").to_string());
                assert_eq!(found, *wanted, "{dialect}, {size} bits: {program}");
            }
        }
    }
}
