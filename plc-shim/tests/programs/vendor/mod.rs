//! Vendors' libraries: values as their makers document them.

mod codesys;
mod matiec;
mod siemens;
mod tc2_communication;
mod tc2_mc2;
mod tc2_standard;
mod tc2_system;
mod tc2_utilities;

use onescan_iec::Dialect;

use crate::rig::Rig;

/// A program with these declarations and statements after one scan, and then the conditions that do not hold.
fn wrong(dialect: Dialect, declarations: &str, statements: &str, conditions: &[&str]) -> Vec<String> {
    let count = conditions.len();
    let checks: String =
        conditions.iter().enumerate().map(|(index, one)| format!("    holds[{index}] := {one};\n")).collect();
    let text = format!(
        "PROGRAM P VAR {declarations}\n holds : ARRAY [0..{count}] OF BOOL; END_VAR\n{statements}\n{checks}END_PROGRAM"
    );
    let mut rig = Rig::in_dialect(dialect, &text);
    rig.scan().expect("no fault");
    let holds = |index: &usize| rig.bool(&format!("P.holds[{index}]"));
    (0..count).filter(|index| !holds(index)).map(|index| conditions[index].to_owned()).collect()
}

/// All of the conditions hold.
fn hold(dialect: Dialect, declarations: &str, statements: &str, conditions: &[&str]) {
    assert_eq!(wrong(dialect, declarations, statements, conditions), [""; 0]);
}
