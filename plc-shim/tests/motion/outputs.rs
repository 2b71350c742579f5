//! The outputs of blocks over time (2.4.1): one column per scan.

use std::fmt::Write;

use crate::bench::{Bench, State};

const OUTPUTS: [&str; 5] = ["Busy", "Active", "Done", "CommandAborted", "Error"];

/// Draws `Execute` of each block as given, and its outputs.
fn diagram(bench: &mut Bench, blocks: &[(&str, &str)]) -> String {
    let length = blocks.iter().map(|(_, levels)| levels.len()).max().unwrap_or(0);
    let paths_of = |block: &str| {
        let outputs = outputs(block).into_iter().map(|name| format!("{block}.{name}"));
        std::iter::once(format!("{block}.Execute")).chain(outputs).collect()
    };
    let paths: Vec<Vec<String>> = blocks.iter().map(|(block, _)| paths_of(block)).collect();
    let mut drawn: Vec<Vec<String>> = paths.iter().map(|paths| vec![String::new(); paths.len()]).collect();
    let (mut state, mut velocity) = (String::new(), String::new());
    for column in 0..length {
        for (block, levels) in blocks {
            let level = levels.as_bytes().get(column).is_some_and(|level| *level == b'#');
            bench.set(&format!("{block}.Execute"), level);
        }
        bench.scan();
        for (paths, drawn) in paths.iter().zip(&mut drawn) {
            let values: Vec<bool> = paths.iter().map(|path| bench.get(path)).collect();
            one_at_most(&values[1..], paths);
            for (value, line) in values.iter().zip(drawn) {
                line.push(if *value { '#' } else { '.' });
            }
        }
        state.push(letter(bench.state()));
        write!(velocity, "{:>5.1}", bench.velocity()).expect("a string takes all");
    }
    let mut text = String::new();
    for (paths, drawn) in paths.iter().zip(&drawn) {
        for (path, line) in paths.iter().zip(drawn) {
            writeln!(text, "{path:26}{line}").expect("a string takes all");
        }
    }
    text + &format!("{:26}{state}\nvelocity {velocity}", "state")
}

fn letter(state: State) -> char {
    match state {
        State::Disabled => '-',
        State::Standstill => 'S',
        State::Homing => 'H',
        State::DiscreteMotion => 'D',
        State::ContinuousMotion => 'C',
        State::SynchronizedMotion => 'Y',
        State::Stopping => '!',
        State::ErrorStop => 'E',
    }
}

/// The outputs that this block has.
fn outputs(block: &str) -> Vec<&'static str> {
    let own = if block == "Velocity" { "InVelocity" } else { "Done" };
    let all = OUTPUTS.into_iter().filter(|name| *name != "Active" || block != "Stop");
    all.map(|name| if name == "Done" { own } else { name }).collect()
}

/// Of Busy, Done, `CommandAborted` and Error one is TRUE at most; Active only with Busy.
fn one_at_most(values: &[bool], paths: &[String]) {
    let named = |wanted: &str| {
        let at = paths[1..].iter().position(|path| path.ends_with(wanted));
        at.is_some_and(|at| values[at])
    };
    let shown = [".Busy", ".Done", ".CommandAborted", ".Error"].map(named);
    assert!(shown.iter().filter(|shown| **shown).count() <= 1, "{paths:?} {values:?}");
    assert!(!named(".Active") || named(".Busy"), "{paths:?} {values:?}");
    assert!(!named(".InVelocity") || named(".Busy"), "{paths:?} {values:?}");
}

/// A bench with values for what the diagrams start; steps of 100 ms.
fn set_up() -> Bench {
    let mut bench = Bench::new();
    for (path, value) in [
        ("Absolute.Position", 2.0),
        ("Absolute.Velocity", 10.0),
        ("Absolute.Acceleration", 10.0),
        ("Absolute.Deceleration", 10.0),
        ("Absolute2.Position", 3.0),
        ("Absolute2.Velocity", 10.0),
        ("Absolute2.Acceleration", 10.0),
        ("Absolute2.Deceleration", 10.0),
        ("Velocity.Velocity", 2.0),
        ("Velocity.Acceleration", 10.0),
        ("Velocity.Deceleration", 10.0),
        ("Halt.Deceleration", 10.0),
        ("Stop.Deceleration", 10.0),
    ] {
        bench.set_real(path, value);
    }
    bench.step_ns = 100_000_000;
    bench
}

#[test]
fn done_lasts_as_long_as_execute_and_one_call_at_least() {
    insta::assert_snapshot!("done_held", diagram(&mut set_up(), &[("Absolute", ".##############...")]));
    insta::assert_snapshot!("done_once", diagram(&mut set_up(), &[("Absolute", ".##...............")]));
}

#[test]
fn an_aborting_command_takes_over() {
    let blocks = [("Absolute", ".####.............."), ("Absolute2", ".....##############")];
    insta::assert_snapshot!("aborting", diagram(&mut set_up(), &blocks));
}

#[test]
fn a_buffered_command_waits() {
    let mut bench = set_up();
    bench.set_int("Absolute2.BufferMode", 1);
    let blocks = [("Absolute", ".###############........"), ("Absolute2", "...#####################")];
    insta::assert_snapshot!("buffered", diagram(&mut bench, &blocks));
}

#[test]
fn the_same_block_again_restarts() {
    insta::assert_snapshot!("again", diagram(&mut set_up(), &[("Absolute", ".##.###...........")]));
}

#[test]
fn a_velocity_goes_on_until_it_is_aborted() {
    let blocks = [("Velocity", ".########....."), ("Halt", "......########")];
    insta::assert_snapshot!("velocity", diagram(&mut set_up(), &blocks));
}

#[test]
fn a_stop_locks_and_errors_last_as_long_as_execute() {
    let blocks = [("Velocity", ".#####........."), ("Stop", ".....########..."), ("Absolute", "........###...##")];
    insta::assert_snapshot!("stop", diagram(&mut set_up(), &blocks));
}

#[test]
fn an_error_whose_execute_falls_is_shown_once() {
    let mut bench = set_up();
    bench.set_real("Absolute.Velocity", -1.0);
    insta::assert_snapshot!("error", diagram(&mut bench, &[("Absolute", ".#...####..")]));
    assert_eq!(bench.int("Absolute.ErrorID"), 0);
}
