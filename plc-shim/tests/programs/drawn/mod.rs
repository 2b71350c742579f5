//! The order of drawn networks, which is that of the tool that wrote the file.

mod beremiz;
mod drawings;
mod sketch;

use self::sketch::Sketch;
use crate::matiec::dice::Dice;
use crate::plcopen::{block, coil, contact, input, of_tool, output, program, rail, rig};
use crate::rig::Rig;

/// Headers of files by the tools that write them.
pub(crate) const CODESYS: &str = "codesys";
pub(crate) const BEREMIZ: &str = "beremiz";
pub(crate) const OPENPLC_4: &str = "openplc4";
pub(crate) const OTHER: &str = "";

/// What the variables of a sketch are in so many scans, with inputs drawn by a seed.
fn values(mut rig: Rig, scans: usize, seed: u64) -> Vec<i64> {
    let mut dice = Dice::new(seed);
    let mut found = Vec::new();
    for _ in 0..scans {
        for (name, value) in Sketch::inputs(&mut dice) {
            rig.set(&format!("P.{name}"), value);
        }
        rig.scan().expect("no fault");
        found.extend(Sketch::variables().iter().map(|name| rig.int(&format!("P.{name}"))));
    }
    found
}

fn after_a_scan(tool: &str, text: &str) -> Rig {
    let mut rig = rig(&of_tool(tool, text));
    rig.scan().expect("no fault");
    rig
}

/// openplc-editor #830: a remainder is written to a box, which the next block on the rung reads.
fn remainder(language: &str, below: u32) -> String {
    let power = if language == "LD" { "EN=1 " } else { "" };
    let body = [
        rail(1),
        input(2, (60, 70), "all"),
        input(3, (60, 90), "hour"),
        block(4, (100, 50), "MOD", &format!("{power}IN1=2 IN2=3"), "OUT ENO", ""),
        output(5, (200, 50 + below), "4.OUT", "n", ""),
        input(6, (220, 70), "n"),
        block(7, (260, 50), "ADD", &format!("{}IN1=6 IN2=8", power.replace('1', "4.ENO")), "OUT ENO", ""),
        input(8, (220, 90), "n"),
        output(9, (360, 70), "7.OUT", "twice", ""),
    ];
    let body = if language == "LD" { body.concat() } else { body[1..].concat() };
    program("local all : INT = 7320, hour : INT = 3600, n : INT, twice : INT", language, &body)
}

#[test]
fn what_is_written_with_a_block_is_read_new_by_the_next() {
    for tool in [CODESYS, OPENPLC_4, OTHER] {
        for below in [0, 1, 9, 10, 40, 200] {
            let rig = after_a_scan(tool, &remainder("LD", below));
            assert_eq!((rig.int("P.n"), rig.int("P.twice")), (120, 240), "{tool}, {below} lower");
        }
    }
    // In FBD, the blocks are two networks.
    for (tool, below) in [(OPENPLC_4, 0), (OTHER, 40), (CODESYS, 40), (BEREMIZ, 40)] {
        assert_eq!(after_a_scan(tool, &remainder("FBD", below)).int("P.twice"), 240, "{tool}");
    }
    assert_eq!(after_a_scan(BEREMIZ, &remainder("LD", 40)).int("P.twice"), 240, "the box is first in the file");
}

/// `x` is written by a coil on the rung, and a contact that stands further right reads it.
fn coil_and_contact(lower: u32, coil_first: bool) -> String {
    let (x, y) = (coil(3, (100, 40 + lower), "2", "x", ""), coil(5, (300, 40), "4", "y", ""));
    let contacts = rail(1) + &contact(2, (40, 40), "1", "a", "") + &contact(4, (200, 40), "2", "x", "");
    let coils = if coil_first { x + &y } else { y + &x };
    program("local a : BOOL = TRUE, x : BOOL, y : BOOL", "LD", &(contacts + &coils))
}

#[test]
fn a_coil_that_is_a_little_lower_comes_before_what_is_behind_it() {
    for lower in [0, 1, 2, 5, 9] {
        for tool in [OPENPLC_4, OTHER] {
            for first in [true, false] {
                assert!(after_a_scan(tool, &coil_and_contact(lower, first)).bool("P.y"), "{tool}: {lower} lower");
            }
        }
    }
    assert!(!after_a_scan(OTHER, &coil_and_contact(30, true)).bool("P.y"), "branches from top to bottom");
    // Beremiz and CODESYS: the file has the order.
    for lower in [0, 2, 9, 30] {
        assert!(after_a_scan(BEREMIZ, &coil_and_contact(lower, true)).bool("P.y"));
        assert!(!after_a_scan(BEREMIZ, &coil_and_contact(lower, false)).bool("P.y"));
    }
}

/// A contact in front of two coils, of which the first writes its variable.
#[test]
fn beremiz_reads_a_contact_again_for_each_coil() {
    let body = [
        rail(1),
        contact(2, (40, 40), "1", "first", ""),
        coil(3, (100, 40), "2", "first", "storage=\"reset\""),
        coil(4, (100, 80), "2", "seen", "storage=\"set\""),
    ];
    let text = program("local first : BOOL = TRUE, seen : BOOL", "LD", &body.concat());
    for (tool, seen) in [(OTHER, true), (CODESYS, true), (OPENPLC_4, true), (BEREMIZ, false)] {
        assert_eq!(after_a_scan(tool, &text).bool("P.seen"), seen, "{tool}");
    }
}

/// A variable box in front of two blocks, of which the first writes it.
#[test]
fn beremiz_reads_a_variable_again_for_each_use() {
    let body = [
        input(1, (0, 10), "n"),
        input(2, (0, 30), "1"),
        block(3, (100, 10), "ADD", "IN1=1 IN2=2", "OUT", ""),
        output(4, (200, 10), "3.OUT", "n", ""),
        output(5, (200, 50), "1", "copy", ""),
    ];
    let text = program("local n : INT, copy : INT = 7", "FBD", &body.concat());
    for (tool, copy) in [(OTHER, 0), (CODESYS, 0), (OPENPLC_4, 0), (BEREMIZ, 1)] {
        assert_eq!(after_a_scan(tool, &text).int("P.copy"), copy, "{tool}");
    }
}

/// Two copies, the lower one first in the file.
#[test]
fn networks_come_as_the_tool_has_them() {
    let copy = |id, y, from, to| input(id, (0, y), from) + &output(id + 1, (100, y), &id.to_string(), to, "");
    let text =
        |y| program("local a : INT = 1, b : INT, c : INT", "FBD", &(copy(1, y, "b", "c") + &copy(11, 50, "a", "b")));
    for (tool, y, c) in [(OTHER, 90, 1), (OTHER, 10, 0), (OPENPLC_4, 90, 1), (CODESYS, 90, 0), (BEREMIZ, 90, 0)] {
        assert_eq!(after_a_scan(tool, &text(y)).int("P.c"), c, "{tool} {y}");
    }
}

/// An instance whose output nobody wants is called behind all outputs.
#[test]
fn beremiz_calls_the_other_blocks_last() {
    let body = [
        input(1, (0, 10), "a"),
        block(2, (50, 10), "SR s", "S1=1 R=", "Q1", ""),
        input(3, (0, 60), "s.Q1"),
        output(4, (100, 60), "3", "q", ""),
    ];
    let text = program("local a : BOOL = TRUE, s : SR, q : BOOL", "FBD", &body.concat());
    for (tool, q) in [(OTHER, true), (CODESYS, true), (BEREMIZ, false)] {
        assert_eq!(after_a_scan(tool, &text).bool("P.q"), q, "{tool}");
    }
}

/// Each takes what the other gives: the one that is asked first is called last.
#[test]
fn beremiz_cuts_a_loop_where_it_is_met() {
    let ring = |wanted: u32| {
        let body = [
            input(1, (0, 0), "a"),
            block(2, (100, 0), "SR x", "S1=1 R=3.Q1", "Q1", ""),
            block(3, (200, 0), "SR y", "S1=2.Q1 R=", "Q1", ""),
            output(4, (300, 0), &format!("{wanted}.Q1"), "q", ""),
        ];
        let text = program("local a : BOOL = TRUE, x : SR, y : SR, q : BOOL", "FBD", &body.concat());
        let rig = after_a_scan(BEREMIZ, &text);
        ["x", "y"].map(|name| rig.bool(&format!("P.{name}.Q1")))
    };
    assert_eq!(ring(2), [true, false], "y is called for x, with the old x");
    assert_eq!(ring(3), [true, true], "x is called for y, with the old y");
}

#[test]
fn a_block_with_a_number_takes_outputs_of_instances_as_they_are() {
    let body = |number: &str| {
        [
            input(1, (0, 0), "a"),
            block(2, (100, 0), "SR x", "S1=1 R=", "Q1", ""),
            block(3, (200, 0), "SR y", "S1=2.Q1 R=", "Q1", number),
        ]
        .concat()
    };
    let text = |number| program("local a : BOOL = TRUE, x : SR, y : SR", "FBD", &body(number));
    let y = |tool, number| after_a_scan(tool, &text(number)).bool("P.y.Q1");
    assert!(y(BEREMIZ, ""));
    assert!(!y(BEREMIZ, "executionOrderId=\"1\""));
    assert!(y(OTHER, "executionOrderId=\"1\""));
}
