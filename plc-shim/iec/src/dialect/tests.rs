use std::fmt::Write;

use super::table::{BEHAVIOURS, FEATURES};
use super::*;
use crate::dialect::AddressUnit;

#[test]
fn every_feature_and_dialect_has_one_row() {
    let features: Vec<_> = FEATURES.iter().map(|row| row.feature).collect();
    assert_eq!(features, Feature::ALL);
    let dialects: Vec<_> = BEHAVIOURS.iter().map(|row| row.dialect).collect();
    assert_eq!(dialects, Dialect::ALL);
    for row in FEATURES {
        let count = row.dialects.len();
        assert!(count > 0 && count < Dialect::ALL.len(), "{:?} distinguishes no dialects", row.feature);
        assert!(!row.source.is_empty());
    }
}

#[test]
fn dialects_have_names_and_files() {
    for dialect in Dialect::ALL {
        assert_eq!(Dialect::find(dialect.name()), Some(dialect));
    }
    assert_eq!(Dialect::of_file("a/Motor.SCL"), Dialect::SiemensScl);
    assert_eq!(Dialect::of_file("old.exp"), Dialect::Codesys);
    assert_eq!(Dialect::of_file("MAIN.TcPOU"), Dialect::TwinCat);
    assert_eq!(Dialect::of_file("shear.st"), Dialect::Iec3);
    assert_eq!(Feature::ChainedAssignment.homes(), "codesys, twincat and siemens-scl");
}

fn behaviour_cells(behaviour: Behaviour) -> [String; 15] {
    let time = match behaviour.time {
        TimeRange::Nanoseconds64 => "signed 64 bit nanoseconds",
        TimeRange::Unsigned32 => "unsigned 32 bit milliseconds, wrapping",
        TimeRange::Signed32 => "signed 32 bit milliseconds, wrapping",
    };
    let ties = match behaviour.ties {
        Ties::Even => "to the even one",
        Ties::Away => "away from zero",
    };
    let division = match behaviour.division_by_zero {
        DivisionByZero::Fault => "stops the PLC",
        DivisionByZero::Continue => "0; reals: infinity or NaN",
    };
    let unit = match behaviour.address_unit {
        AddressUnit::Element => "units of its own width",
        AddressUnit::Byte => "bytes",
    };
    let power = if behaviour.negates_powers { "-(a ** b)" } else { "(-a) ** b" };
    let truth = match behaviour.truth {
        Truth::LowestBit => "its lowest bit",
        Truth::NotZero => "TRUE unless it is 0",
    };
    let number = if behaviour.time_number_ns == 1_000_000 { "milliseconds" } else { "seconds" };
    let strings = match behaviour.strings {
        StringMemory::Counted => "a count of 16 bits, the characters",
        StringMemory::ZeroTerminated => "the characters, a 0",
    };
    let length = behaviour.string_length.to_string();
    let subrange = match behaviour.beyond_subrange {
        BeyondSubrange::Fault => "stops the PLC",
        BeyondSubrange::Assign => "it is assigned",
    };
    let long = match behaviour.long_time {
        LongTime::Signed64 => "signed 64 bit nanoseconds",
        LongTime::Unsigned64 => "unsigned 64 bit nanoseconds",
    };
    let selection = match behaviour.selection {
        Selection::All => "all are evaluated",
        Selection::Selected => "only the selected one is evaluated",
    };
    let integers = match behaviour.integers {
        IntegerWidth::Own => "in the bits of their type",
        IntegerWidth::Register => {
            "in the target's registers, 64 bits if you do not set 32; cut where assigned, handed over or converted"
        }
    };
    let pulses = match behaviour.action_pulses {
        ActionPulses::OfAction => "from one detector of edges for all steps that name the action",
        ActionPulses::OfStep => {
            "from edges of the last step alone that names the action, which set a BOOL, too; none at the start"
        }
    };
    let texts = match behaviour.text_functions {
        None => "as long as their types".to_owned(),
        Some(most) => format!("of {most} characters; what is behind them is cut off, with a warning"),
    };
    let all = [
        &length, time, ties, division, unit, power, truth, number, strings, subrange, long, selection, integers,
        pulses, &texts,
    ];
    all.map(ToOwned::to_owned)
}

/// The tables of `docs/dialects.md`.
fn tables() -> String {
    let mut text = "| construct | dialects | source |\n|---|---|---|\n".to_owned();
    for row in FEATURES {
        let having = Dialect::ALL.into_iter().filter(|dialect| dialect.has(row.feature));
        let names: Vec<_> = having.map(Dialect::name).collect();
        writeln!(text, "| {} | {} | {} |", row.feature.about(), names.join(", "), row.source).expect("a string");
    }
    let subjects = [
        "STRING without a length",
        "TIME",
        "real halfway between two integers",
        "division by zero",
        "what the number of `%MW3` counts",
        "`-a ** b`",
        "a bit string as BOOL, by `DWORD_TO_BOOL`",
        "what the number of a TIME or TOD counts, by `TIME_TO_REAL`",
        "STRING in memory",
        "a value that a subrange does not have",
        "LTIME",
        "inputs of `SEL`",
        "`+`, `-`, `*`, `/`, `MOD` of integers",
        "pulses of actions in charts: `P`, `P1`, `P0`",
        "strings that CONCAT, LEN and the like take and give",
    ];
    text += "\n## Behaviour\n\n| behaviour | dialects | what they do | source |\n|---|---|---|---|\n";
    for (index, subject) in subjects.iter().enumerate() {
        // Dialects that behave alike share a row.
        let mut groups: Vec<(String, Vec<&str>, Vec<&str>)> = Vec::new();
        for row in BEHAVIOURS {
            let cell = behaviour_cells(row.behaviour)[index].clone();
            let position = groups.iter().position(|(known, ..)| *known == cell).unwrap_or(groups.len());
            if position == groups.len() {
                groups.push((cell, Vec::new(), Vec::new()));
            }
            let (_, names, sources) = &mut groups[position];
            names.push(row.dialect.name());
            if !sources.contains(&row.sources[index]) {
                sources.push(row.sources[index]);
            }
        }
        for (cell, names, sources) in groups {
            let (names, sources) = (names.join(", "), sources.join("; "));
            writeln!(text, "| {subject} | {names} | {cell} | {sources} |").expect("a string");
        }
    }
    text
}

#[test]
fn the_page_shows_the_table() {
    let page = include_str!("../../../docs/dialects.md");
    let tables = tables();
    assert!(page.contains(&tables), "docs/dialects.md wants these tables:\n{tables}");
}
