//! The random programs of timers and counters, without what is known to differ.

use onescan_iec::Dialect;

use super::peer_program::PeerProgram;
use crate::lockstep::random::program as written;

pub(super) fn program(statements: &[(u32, u32)]) -> PeerProgram {
    // A variable in common needs a declaration outside of the program.
    let statements = statements.iter().filter(|(kind, _)| kind % 10 != 8).copied().map(tamed);
    // The peer wants a statement.
    let statements: Vec<_> = statements.chain([(4, 1)]).collect();
    let mut outputs = vec![("q".to_owned(), "BOOL"), ("x".to_owned(), "DINT"), ("e".to_owned(), "TIME")];
    for (number, (kind, _)) in statements.iter().enumerate() {
        match kind % 10 {
            0 | 6 => timer(&mut outputs, 't', number),
            1 => timer(&mut outputs, 'o', number),
            2 => timer(&mut outputs, 'p', number),
            3 => outputs.extend([(format!("c{number}.Q"), "BOOL"), (format!("c{number}.CV"), "INT")]),
            _ => {}
        }
    }
    let inputs = vec![("i".to_owned(), "BOOL"), ("j".to_owned(), "BOOL")];
    PeerProgram {
        dialect: Dialect::Iec2,
        family: "timers",
        text: written("P", &statements),
        inputs,
        outputs,
        rounded: Vec::new(),
    }
}

fn timer(outputs: &mut Vec<(String, &'static str)>, letter: char, number: usize) {
    outputs.extend([(format!("{letter}{number}.Q"), "BOOL"), (format!("{letter}{number}.ET"), "TIME")]);
}

/// No PT and no PV of 0, no FOR with one turn, and no PT that the peer cuts: 1 ms is 999999 ns to it.
fn tamed((kind, number): (u32, u32)) -> (u32, u32) {
    let known = |number: u32| match kind % 10 {
        0..=2 | 6 => number == 0 || number.is_power_of_two(),
        3 => number.is_multiple_of(5),
        7 => number % 7 == 1,
        _ => false,
    };
    let mut next = number;
    while known(next) {
        next += 1;
    }
    (kind, next)
}
