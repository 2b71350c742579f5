//! What is known at the place that has been reached, where ways part and come together.

use super::Emitter;
use crate::compile::analyse::{
    Count, Driven, Effects, Extent, Known, Ranges, assigned, assume, driven, fits, interval,
};
use onescan_iec::ir::{Binary, Expr, Place, Statement};
use onescan_iec::syntax::Span;

/// What is known on a way that is emitted later.
#[derive(Debug)]
pub(crate) struct Way(Known);

/// Ways that come together in the end: what is known on all that have ended so far.
#[derive(Debug)]
pub(crate) struct Ways(Option<Known>);

impl Emitter<'_, '_> {
    /// Several ways begin here, one emitted after the other.
    pub(crate) fn open_ways(&mut self) -> Ways {
        self.held += 1;
        Ways(None)
    }

    /// A way that begins here, for later.
    pub(crate) fn way(&self) -> Way {
        Way(self.known.clone())
    }

    /// The way on which the condition, which has just been evaluated, does not hold, for later; on the way that is
    /// emitted now it does.
    pub(crate) fn part(&mut self, condition: &Expr) -> Way {
        let mut without = self.known.clone();
        assume(&self.scope, without.ranges_mut(), condition, false);
        self.assume(condition);
        Way(without)
    }

    /// The condition, which has just been evaluated, holds from here on.
    pub(crate) fn assume(&mut self, condition: &Expr) {
        assume(&self.scope, self.known.ranges_mut(), condition, true);
    }

    /// One of the ways ends here, and the `next` begins.
    pub(crate) fn end_way(&mut self, ways: &mut Ways, next: Way) {
        let here = std::mem::replace(&mut self.known, next.0);
        match &mut ways.0 {
            Some(known) => known.meet(&here),
            None => ways.0 = Some(here),
        }
    }

    /// The ways that have ended come together with this one, the last.
    pub(crate) fn close_ways(&mut self, ways: Ways) {
        if let Some(known) = ways.0 {
            self.known.meet(&known);
        }
        debug_assert!(self.held > 0, "ways that come together have been opened");
        self.held -= 1;
    }

    /// What `emit` makes is a branch; one that leaves its unit is for the exception.
    pub(crate) fn in_branch(&mut self, body: &[Statement], emit: impl FnOnce(&mut Self)) {
        self.scope.open_branch(body);
        emit(self);
        self.scope.close_branch(body);
    }

    /// Execution may come here from anywhere.
    pub(crate) fn forget(&mut self) {
        self.known = Known::default();
    }

    /// A jump away: what follows is not executed.
    pub(crate) fn leave_here(&mut self) {
        self.known.leave();
    }

    /// Memory there is changed by other means than an elementary store; anywhere if nothing is
    /// known of it.
    pub(crate) fn changed(&mut self, extent: Option<Extent>) {
        self.expect_change(extent);
        match extent {
            Some(extent) => self.known.forget(extent, self.scope.roots()),
            None => self.known.forget_all(),
        }
    }

    /// Memory changes there. The loops around must have been found to change it: what they were not, registers and ranges
    /// are taken to hold through all turns.
    pub(super) fn expect_change(&mut self, extent: Option<Extent>) {
        let roots = self.scope.roots();
        let expected = |effects: &Effects| match extent {
            Some(extent) => effects.changes(extent, roots),
            None => effects.changes_anything(),
        };
        self.unforeseen |= !self.foreseen.iter().all(expected);
    }

    /// Stops the PLC at `span` if the code before does what no analysis has found: wrong results would be worse.
    pub(crate) fn require_foresight(&mut self, span: Span) {
        debug_assert!(!self.unforeseen, "a loop changes what its survey has not found, before {span:?}");
        if std::mem::take(&mut self.unforeseen) {
            self.impossible(span);
        }
    }

    /// An assignment has given its target a number of this range.
    pub(crate) fn assigned(&mut self, target: &Place, range: Option<(i128, i128)>) {
        if !self.known.is_unreachable() {
            assigned(&self.scope, self.known.ranges_mut(), target, range);
        }
    }

    /// Where the value of an integer expression lies here; nothing for other types.
    pub(crate) fn interval(&self, expr: &Expr) -> Option<(i128, i128)> {
        interval(&self.scope, self.known.ranges(), expr)
    }

    /// True if the result of the operation needs not be cut to its short type.
    pub(crate) fn fits(&self, operator: Binary, left: &Expr, right: &Expr) -> bool {
        fits(&self.scope, self.known.ranges(), operator, left, right)
    }

    /// Between what numbers variables lie here.
    pub(crate) fn ranges(&self) -> &Ranges {
        self.known.ranges()
    }

    /// Which variables a loop drives one way that has been entered; `before` is what was known in front of it.
    pub(crate) fn driven(&self, effects: &Effects, before: &Ranges, condition: &Expr) -> Driven {
        driven(&self.scope, effects, before, self.known.ranges(), condition)
    }

    /// In the loop and behind it.
    pub(crate) fn remember(&mut self, driven: &Driven) {
        driven.remember(self.known.ranges_mut());
    }

    /// What `emit` makes is the body of a loop that counts by itself.
    pub(crate) fn counting(&mut self, count: &Count, emit: impl FnOnce(&mut Self)) {
        self.scope.open_counter(count.slot(), count.range());
        emit(self);
        self.scope.close_counter();
    }
}
