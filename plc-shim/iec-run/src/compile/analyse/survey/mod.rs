//! What the turns of a loop do, found by a walk through its body before anything is made of it.
//!
//! | module | subject |
//! |---|---|
//! | [`statement`], [`call`], [`expression`] | the walk, form by form |
//! | [`access`] | what is noted where memory and registers are read and changed |
//!
//! The walk goes where the code will go: into units that are put in the place of calls, and past those that
//! are called. It need not be exact in what it counts, as that only decides what pays; but whatever the code
//! changes, the walk must have found.

mod access;
mod call;
mod expression;
mod statement;

use super::effect::Effects;
use super::price;
use super::program::Program;
use super::scope::Scope;
use onescan_iec::ir::{Expr, ForStatement, Labelled, Statement};

/// Registers of units that only the walk enters are numbered from here on, where no function has any: WebAssembly
/// allows 50,000.
const FIRST_OWN_REGISTER: u32 = 1 << 31;

/// What a loop does.
#[derive(Debug)]
pub(crate) struct Survey {
    effects: Effects,
    cost: u64,
    leaves: bool,
    metered: bool,
}

impl Survey {
    /// Of the body of a FOR loop.
    pub(crate) fn of_body(program: &Program<'_>, scope: &Scope<'_>, body: &[Statement]) -> Self {
        Walk::new(program, scope).survey(|walk| {
            walk.charge(price::LOOP);
            walk.turn(body);
        })
    }

    /// Of a FOR loop that sets its variable in every turn, and asks for it four times.
    pub(crate) fn of_for(program: &Program<'_>, scope: &Scope<'_>, inner: &ForStatement) -> Self {
        Walk::new(program, scope).survey(|walk| walk.turns(inner))
    }

    /// Of the turns of a WHILE loop.
    pub(crate) fn of_while(program: &Program<'_>, scope: &Scope<'_>, condition: &Expr, body: &[Statement]) -> Self {
        Walk::new(program, scope).survey(|walk| {
            walk.expression(condition);
            walk.turn(body);
        })
    }

    /// Of the turns of a REPEAT loop.
    pub(crate) fn of_repeat(program: &Program<'_>, scope: &Scope<'_>, body: &[Statement], until: &Expr) -> Self {
        Walk::new(program, scope).survey(|walk| {
            walk.turn(body);
            walk.expression(until);
        })
    }

    /// Of statements that jumps lead back into.
    pub(crate) fn of_labelled(program: &Program<'_>, scope: &Scope<'_>, inner: &Labelled) -> Self {
        Walk::new(program, scope).survey(|walk| walk.parts(inner))
    }

    /// What the turns read and change.
    pub(crate) fn effects(&self) -> &Effects {
        &self.effects
    }

    pub(crate) fn effects_mut(&mut self) -> &mut Effects {
        &mut self.effects
    }

    /// What one turn costs, about.
    pub(crate) fn cost(&self) -> u64 {
        self.cost
    }

    /// True if nothing ends a turn early, and nothing inside pays for itself.
    pub(crate) fn is_plain(&self) -> bool {
        !self.leaves && !self.metered
    }
}

struct Walk<'w, 'p> {
    program: &'w Program<'p>,
    scope: Scope<'p>,
    next_register: u32,
    effects: Effects,
    cost: u64,
    leaves: bool,
    metered: bool,
}

impl<'w, 'p> Walk<'w, 'p> {
    fn new(program: &'w Program<'p>, scope: &Scope<'p>) -> Self {
        Self {
            program,
            scope: scope.clone(),
            next_register: FIRST_OWN_REGISTER,
            effects: Effects::default(),
            cost: 0,
            leaves: false,
            metered: false,
        }
    }

    fn survey(mut self, walk: impl FnOnce(&mut Self)) -> Survey {
        let around = self.scope.units().count();
        walk(&mut self);
        debug_assert_eq!(self.scope.units().count(), around, "the walk leaves every unit that it enters");
        let Self { effects, cost, leaves, metered, .. } = self;
        Survey { effects, cost, leaves, metered }
    }

    fn charge(&mut self, instructions: u64) {
        self.cost = self.cost.saturating_add(instructions);
    }
}
