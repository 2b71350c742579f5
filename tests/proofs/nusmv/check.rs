//! All states that a model can reach, and branching time over them.

use std::collections::HashMap;

use super::syntax::{Binary, Branching};
use super::system::{System, Term, Value, holds};

/// A model with all states that it can reach.
pub(super) struct Reached {
    system: System,
    states: Vec<Vec<Value>>,
    /// Which states each may follow.
    before: Vec<Vec<usize>>,
    firsts: usize,
}

impl Reached {
    /// Explores a model. A state that nothing follows is a mistake in the model.
    pub(super) fn of(system: System) -> Self {
        let mut states = system.first();
        let firsts = states.len();
        let mut known: HashMap<Vec<Value>, usize> = states.iter().cloned().zip(0..).collect();
        let mut before = vec![Vec::new(); firsts];
        let mut at = 0;
        while at < states.len() {
            let after = system.after(&states[at]);
            assert!(!after.is_empty(), "a deadlock: {:?}", states[at]);
            for state in after {
                let index = *known.entry(state).or_insert_with_key(|state| {
                    states.push(state.clone());
                    before.push(Vec::new());
                    states.len() - 1
                });
                before[index].push(at);
            }
            at += 1;
        }
        Self { system, states, before, firsts }
    }

    pub(super) fn system(&self) -> &System {
        &self.system
    }

    pub(super) fn states(&self) -> &[Vec<Value>] {
        &self.states
    }

    /// Each specification, and whether it holds where the model begins.
    pub(super) fn specifications(&self) -> Vec<(&str, bool)> {
        let verdict = |term: &Term| self.where_true(term)[..self.firsts].iter().all(|holds| *holds);
        self.system.specifications.iter().map(|(text, term)| (text.as_str(), verdict(term))).collect()
    }

    /// In which states a term holds.
    fn where_true(&self, term: &Term) -> Vec<bool> {
        match term {
            Term::Branching(Branching::EF, of) => self.until(&vec![true; self.states.len()], self.where_true(of)),
            Term::Branching(Branching::AG, of) => {
                let never: Vec<bool> = self.where_true(of).into_iter().map(|holds| !holds).collect();
                let reaches = self.until(&vec![true; self.states.len()], never);
                reaches.into_iter().map(|reaches| !reaches).collect()
            }
            Term::ExistsUntil(hold, until) => self.until(&self.where_true(hold), self.where_true(until)),
            Term::Not(of) => self.where_true(of).into_iter().map(|holds| !holds).collect(),
            Term::Binary(binary @ (Binary::And | Binary::Or | Binary::Implies), left, right) => {
                let pairs = self.where_true(left).into_iter().zip(self.where_true(right));
                let together = |(left, right): (bool, bool)| match binary {
                    Binary::And => left && right,
                    Binary::Or => left || right,
                    _ => !left || right,
                };
                pairs.map(together).collect()
            }
            _ => self.states.iter().map(|state| holds(term, state)).collect(),
        }
    }

    /// `E [hold U until]`: backwards from where `until` holds.
    fn until(&self, hold: &[bool], until: Vec<bool>) -> Vec<bool> {
        let mut todo: Vec<usize> = (0..until.len()).filter(|at| until[*at]).collect();
        let mut reaches = until;
        while let Some(at) = todo.pop() {
            for from in &self.before[at] {
                if hold[*from] && !std::mem::replace(&mut reaches[*from], true) {
                    todo.push(*from);
                }
            }
        }
        reaches
    }
}
