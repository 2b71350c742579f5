//! The random charts, without what is known to differ.
//!
//! What [`known`](super::known) lists is not made: conditions exclude each other and wait for the second scan, each action
//! has one use without a stored time or several pulses, and nothing is counted in a final scan. Nor has a transition a PRIORITY, for which
//! the peer takes the flag of a step away before it looks at the next condition.

use onescan_iec::Dialect;

use std::fmt::Write;

use super::peer_program::{GO, PeerProgram, Watched};
use crate::sfc::chart::{ACTIONS, BOOLEAN, Chart, Condition, INPUTS, Link, Use};

pub(super) fn program(chart: &Chart) -> PeerProgram {
    let uses = alone(&chart.uses);
    let mut text = String::from("PROGRAM P\nVAR go, c0, c1, c2, c3, b0, b1, b2 : BOOL; story : UDINT; END_VAR\n");
    for step in 0..chart.steps {
        let word = if step == 0 { "INITIAL_STEP" } else { "STEP" };
        writeln!(text, "{word} s{step}:").expect("a string takes all");
        for used in uses.iter().filter(|used| used.step == step) {
            let (name, time) = (format!("b{}", used.action), used.time());
            let time = if time.is_empty() { time } else { format!(", {time}") };
            writeln!(text, "    {name}({}{time});", used.qualifier).expect("a string takes all");
        }
        text.push_str("END_STEP\n");
    }
    for (at, link) in chart.links.iter().enumerate() {
        let rivals = chart.links[..at].iter().filter(|other| other.from.iter().any(|step| link.from.contains(step)));
        let others: String = rivals.map(|other| format!(" AND NOT ({})", cleared(other))).collect();
        let (from, to) = (list(&link.from), list(&link.to));
        let own = condition(link);
        writeln!(text, "TRANSITION FROM {from} TO {to} := go AND {own}{others}; END_TRANSITION")
            .expect("a string takes all");
    }
    for action in BOOLEAN..ACTIONS {
        let Some(used) = uses.iter().find(|used| used.action == action) else { continue };
        // In which order actions run in a scan is left to the implementation.
        let count = 1_000_u32.pow((action - BOOLEAN) as u32);
        // A pulse has no final scan, and P0 runs when its step is no longer active.
        let counts = format!("story := story + {count};");
        let statement = if is_pulse(used) { counts } else { format!("IF s{}.X THEN {counts} END_IF;", used.step) };
        writeln!(text, "ACTION b{action}:\n    {statement}\nEND_ACTION").expect("a string takes all");
    }
    text.push_str("END_PROGRAM\n");
    let mut inputs: Vec<Watched> = vec![(GO.to_owned(), "BOOL")];
    inputs.extend((0..INPUTS).map(|number| (format!("c{number}"), "BOOL")));
    let mut outputs: Vec<Watched> = (0..chart.steps).map(|step| (format!("s{step}.X"), "BOOL")).collect();
    outputs.extend((0..chart.steps).map(|step| (format!("s{step}.T"), "TIME")));
    outputs.extend((0..BOOLEAN).map(|action| (format!("b{action}"), "BOOL")));
    outputs.push(("story".to_owned(), "UDINT"));
    PeerProgram { dialect: Dialect::Matiec, family: "charts", text, inputs, outputs, rounded: Vec::new() }
}

/// One use of each action; one that a step sets may be reset by another.
fn alone(uses: &[Use]) -> Vec<Use> {
    let mut kept: Vec<Use> = Vec::new();
    for used in uses {
        let statements = used.action >= BOOLEAN;
        // Statements that follow a pulse or a limit run once more behind it, while the step still is active.
        let final_scan = statements && !["N", "P1", "D"].contains(&used.qualifier);
        let stored = ["SD", "DS", "SL"].contains(&used.qualifier);
        let known = final_scan || stored;
        let taken = kept.iter().any(|other| other.action == used.action && !(is_pulse(other) && is_pulse(used)));
        if !known && !taken && used.action < ACTIONS {
            kept.push(used.clone());
        }
    }
    kept
}

fn is_pulse(used: &Use) -> bool {
    ["P", "P0", "P1"].contains(&used.qualifier)
}

fn list(steps: &[usize]) -> String {
    let names: Vec<_> = steps.iter().map(|step| format!("s{step}")).collect();
    if let [only] = names.as_slice() { only.clone() } else { format!("({})", names.join(", ")) }
}

fn condition(link: &Link) -> String {
    match link.condition {
        Condition::Input(number) => format!("c{number}"),
        Condition::Elapsed(step, ms) => format!("s{step}.T >= T#{ms}ms"),
        Condition::Active(step) => format!("s{step}.X"),
        Condition::Always => "TRUE".to_owned(),
    }
}

/// What a transition waits for, with its steps.
fn cleared(link: &Link) -> String {
    let flags: String = link.from.iter().map(|step| format!("s{step}.X AND ")).collect();
    flags + &condition(link)
}
