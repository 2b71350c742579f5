//! The random programs of every statement, without what is known to differ.

use onescan_iec::Dialect;

use super::peer_program::PeerProgram;
use crate::random_programs::program::{DEPTH, Number, Statement, Truth, Wording, control};

/// C computes an INT as `int`; an empty statement is not a statement to the peer.
const WORDING: Wording = Wording { narrow: "W_INT", nothing: "v0 := v0;\n" };

pub(super) fn program(mut body: Vec<Statement>) -> PeerProgram {
    Tame { running: Vec::new() }.block(&mut body, 0);
    let named =
        |names: &[&str], ty: &'static str| names.iter().map(|name| ((*name).to_owned(), ty)).collect::<Vec<_>>();
    // The loops of FOR leave their variables to the implementation.
    let controls = (DEPTH..DEPTH * 3).map(|index| (format!("i{index}"), "INT"));
    let mut outputs = named(&["v0", "v1", "v2", "b0", "b1", "c0.total", "c1.total"], "INT");
    outputs.iter_mut().filter(|(name, _)| name.starts_with('b')).for_each(|(_, ty)| *ty = "BOOL");
    outputs.extend(named(&["a[0]", "a[1]", "a[2]", "a[3]"], "DINT"));
    outputs.extend(controls);
    // The program may write them, too, until the next scan.
    let mut inputs = named(&["v1", "v2", "v3"], "INT");
    inputs.extend(named(&["b1", "b2"], "BOOL"));
    PeerProgram {
        dialect: Dialect::Iec2,
        family: "statements",
        text: WORDING.program(&body),
        inputs,
        outputs,
        rounded: Vec::new(),
    }
}

/// Takes out of a program what the standard leaves open, what it calls an error, and what is known to differ.
struct Tame {
    /// The variables of the FOR loops around.
    running: Vec<usize>,
}

impl Tame {
    fn block(&mut self, block: &mut [Statement], loops: usize) {
        for statement in block {
            self.statement(statement, loops);
        }
    }

    fn statement(&mut self, statement: &mut Statement, loops: usize) {
        match statement {
            Statement::Assign(_, value) | Statement::CallInstance(_, value) => self.number(value),
            Statement::AssignTruth(_, value) | Statement::Return(value) | Statement::Exit(value) => self.truth(value),
            Statement::AssignElement(index, value) => {
                if let Number::Variable(at) = index {
                    *index = Number::Literal(*at as i16);
                }
                self.number(value);
            }
            // The 2nd edition has none.
            Statement::Continue(condition) => {
                self.truth(condition);
                *statement = Statement::Exit(condition.clone());
            }
            Statement::If(branches, otherwise) => {
                for (condition, body) in branches {
                    self.truth(condition);
                    self.block(body, loops);
                }
                self.block(otherwise, loops);
            }
            Statement::Case(value, arms, otherwise) => {
                self.number(value);
                for (_, body) in arms {
                    self.block(body, loops);
                }
                self.block(otherwise, loops);
            }
            Statement::For { from, to, by, body } => {
                let first = near(from);
                *by = if *by == 0 { 1 } else { (*by).clamp(-3, 3) };
                // The peer makes no turn where there is one.
                let turns = [0, 2, 3, 4][near(to).unsigned_abs() as usize % 4];
                (*from, *to) = (Number::Literal(first), Number::Literal(first + *by * (turns - 1)));
                self.running.push(control(0, loops));
                self.block(body, loops + 1);
                self.running.pop();
            }
            Statement::While(_, condition, body) | Statement::Repeat(_, condition, body) => {
                self.truth(condition);
                self.block(body, loops + 1);
            }
            // Vendors' programs alone have it; its statements are for the peer what they are without it.
            Statement::Try { body, handler, finally } => {
                for part in [body, handler, finally] {
                    self.block(part, loops);
                }
            }
        }
    }

    fn number(&self, number: &mut Number) {
        match number {
            Number::Literal(_) | Number::Variable(_) => {}
            Number::Control(index) if *index >= DEPTH || self.running.contains(index) => {}
            Number::Control(index) => *number = Number::Variable(*index % 4),
            Number::Element(value) | Number::Negate(value) | Number::Call(value) => self.number(value),
            Number::Binary(operator, a, b) => {
                self.number(a);
                self.number(b);
                if *operator == "/" && !matches!(**b, Number::Literal(value) if value != 0) {
                    **b = Number::Literal(7);
                }
                // The peer computes what has no variable, and refuses what is too great.
                if is_constant(a) && is_constant(b) {
                    **a = Number::Variable(1);
                }
            }
            Number::Select(condition, a, b) => {
                self.truth(condition);
                self.number(a);
                self.number(b);
            }
        }
    }

    fn truth(&self, truth: &mut Truth) {
        match truth {
            Truth::Literal(_) | Truth::Variable(_) => {}
            Truth::Not(value) => self.truth(value),
            Truth::Join(_, a, b) => {
                self.truth(a);
                self.truth(b);
            }
            Truth::Compare(_, a, b) => {
                self.number(a);
                self.number(b);
            }
        }
    }
}

fn is_constant(number: &Number) -> bool {
    match number {
        Number::Literal(_) => true,
        Number::Negate(value) => is_constant(value),
        _ => false,
    }
}

/// A small number in place of any.
fn near(number: &Number) -> i16 {
    if let Number::Literal(value) = number { value % 50 } else { 2 }
}
