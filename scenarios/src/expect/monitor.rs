//! A formula as the run goes.
//!
//! Each part of a formula takes blocks of samples and says, sample by sample, what it is worth: as soon as its windows
//! have passed. Parts that stand outermost are asked for the first sample only.

use std::collections::VecDeque;

use super::ahead::Ahead;
use super::back::Back;
use super::formula::{Comparison, Edge, Formula};
use super::sample::{Block, Certain, Demand, Judged, Look, Sample, TraceEnd};
use super::sliding::{All, Any, Pursuit, Since};
use super::term::Number;
use super::truth::{Scale, Worth};

/// A formula, or a part of one.
#[derive(Clone, Debug)]
pub(super) struct Monitor {
    demand: Demand,
    part: Part,
    /// Set where what is said of a sample depends on its values alone, so that equal samples need not all be asked for.
    is_pointwise: bool,
    /// What has been said and not been taken yet.
    said: VecDeque<Judged>,
    /// Set when all has been said that is asked for.
    done: bool,
}

#[derive(Clone, Debug)]
enum Part {
    Constant(bool),
    Signal(usize),
    Compare(Comparison, Number, Number),
    Not(Box<Monitor>),
    Pair(fn(&Judged, &Judged) -> Judged, Box<[Monitor; 2]>),
    Always(Ahead<All>, Box<Monitor>),
    Eventually(Ahead<Any>, Box<Monitor>),
    Until(Ahead<Pursuit>, Box<[Monitor; 2]>),
    Historically(Back<All>, Box<Monitor>),
    Once(Back<Any>, Box<Monitor>),
    Since(Back<Since>, Box<[Monitor; 2]>),
    /// What the operand was before.
    Edge(Edge, Option<Worth>, Box<Monitor>),
}

impl Monitor {
    pub(super) fn new(formula: &Formula<usize>) -> Self {
        Self::asked(formula, Demand::First)
    }

    /// The same, asked for every sample.
    pub(super) fn every(formula: &Formula<usize>) -> Self {
        Self::asked(formula, Demand::Every)
    }

    /// Takes what it has said so far.
    pub(super) fn take_said(&mut self) -> impl Iterator<Item = Judged> + '_ {
        self.said.drain(..)
    }

    fn asked(formula: &Formula<usize>, demand: Demand) -> Self {
        let same = |inner: &Formula<usize>| Box::new(Self::asked(inner, demand));
        let every = |inner: &Formula<usize>| Box::new(Self::asked(inner, Demand::Every));
        let two = |left: &Formula<usize>, right: &Formula<usize>, demand: Demand| {
            Box::new([Self::asked(left, demand), Self::asked(right, demand)])
        };
        let part = match formula {
            Formula::Constant(value) => Part::Constant(*value),
            Formula::Signal(column) => Part::Signal(*column),
            Formula::Compare(comparison, left, right) => {
                Part::Compare(*comparison, Number::of(left), Number::of(right))
            }
            Formula::Not(inner) => Part::Not(same(inner)),
            Formula::And(left, right) => Part::Pair(and, two(left, right, demand)),
            Formula::Or(left, right) => Part::Pair(or, two(left, right, demand)),
            Formula::Implies(left, right) => Part::Pair(implies, two(left, right, demand)),
            Formula::Iff(left, right) => Part::Pair(iff, two(left, right, demand)),
            Formula::Always(window, inner) => Part::Always(Ahead::new(*window, demand), every(inner)),
            Formula::Eventually(window, inner) => Part::Eventually(Ahead::new(*window, demand), every(inner)),
            Formula::Until(window, left, right) => {
                Part::Until(Ahead::new(*window, demand), two(left, right, Demand::Every))
            }
            Formula::Historically(window, inner) => Part::Historically(Back::new(*window), same(inner)),
            Formula::Once(window, inner) => Part::Once(Back::new(*window), same(inner)),
            Formula::Since(window, left, right) => Part::Since(Back::new(*window), two(left, right, demand)),
            Formula::Edge(edge, inner) => Part::Edge(*edge, None, same(inner)),
        };
        let is_pointwise = match &part {
            Part::Constant(_) | Part::Signal(_) => true,
            Part::Compare(_, left, right) => !left.remembers() && !right.remembers(),
            Part::Not(inner) => inner.is_pointwise,
            Part::Pair(_, operands) => operands.iter().all(|operand| operand.is_pointwise),
            Part::Always(..)
            | Part::Eventually(..)
            | Part::Until(..)
            | Part::Historically(..)
            | Part::Once(..)
            | Part::Since(..)
            | Part::Edge(..) => false,
        };
        Self { demand, part, is_pointwise, said: VecDeque::new(), done: false }
    }

    /// Takes the next samples.
    pub(super) fn push(&mut self, block: &Block) {
        self.look(block, Look::Every);
    }

    fn look(&mut self, block: &Block, look: Look) {
        if self.done {
            return;
        }
        match &mut self.part {
            Part::Constant(value) => {
                self.said.extend(block.samples(look).map(|(_, sample)| Judged::here(sample, Worth::of_bool(*value))));
            }
            Part::Signal(column) => self.said.extend(
                block
                    .samples(look)
                    .map(|(place, sample)| Judged::here(sample, Worth::of_bool(block.value(*column, place) != 0.0))),
            ),
            Part::Compare(comparison, left, right) => self.said.extend(block.samples(look).map(|(place, sample)| {
                let (left, right) = (left.at(block, place, sample), right.at(block, place, sample));
                Judged::here(sample, Worth::of_comparison(*comparison, left, right))
            })),
            _ => {
                let look = self.look_of_operands(look, block.first_sample());
                self.operands().iter_mut().for_each(|operand| operand.look(block, look));
                self.take();
            }
        }
        self.end_if_done();
    }

    /// Which samples its operands are asked for: of equal ones only those that its window distinguishes, where that is
    /// enough.
    fn look_of_operands(&self, look: Look, next: Option<Sample>) -> Look {
        let around = |ends: Option<[u64; 2]>| ends.map_or(Look::Every, Look::Around);
        match &self.part {
            Part::Always(ahead, operand) if operand.is_pointwise => around(ahead.ends(next)),
            Part::Eventually(ahead, operand) if operand.is_pointwise => around(ahead.ends(next)),
            Part::Until(ahead, operands) if operands.iter().all(|operand| operand.is_pointwise) => {
                around(ahead.ends(next))
            }
            Part::Always(..) | Part::Eventually(..) | Part::Until(..) => Look::Every,
            // what remembers is never asked for less than all
            _ => look,
        }
    }

    /// Says what is left to say when the run is over.
    pub(super) fn finish(&mut self, end: TraceEnd) {
        if self.done {
            return;
        }
        self.operands().iter_mut().for_each(|operand| operand.finish(end));
        self.take();
        match &mut self.part {
            Part::Always(ahead, _) => ahead.finish(end, &mut self.said),
            Part::Eventually(ahead, _) => ahead.finish(end, &mut self.said),
            Part::Until(ahead, _) => ahead.finish(end, &mut self.said),
            _ => {}
        }
        self.end_if_done();
    }

    /// What it says of the first sample, if it has.
    pub(super) fn first(&self) -> Option<&Judged> {
        self.said.front()
    }

    fn end_if_done(&mut self) {
        if self.demand == Demand::First && !self.said.is_empty() {
            self.said.truncate(1);
            self.said.shrink_to_fit();
            self.done = true;
            // Its operands have been heard: what they still keep is for nobody.
            self.part = Part::Constant(false);
        }
    }

    fn operands(&mut self) -> &mut [Self] {
        match &mut self.part {
            Part::Constant(_) | Part::Signal(_) | Part::Compare(..) => &mut [],
            Part::Pair(_, operands) | Part::Until(_, operands) | Part::Since(_, operands) => operands.as_mut_slice(),
            Part::Not(operand)
            | Part::Always(_, operand)
            | Part::Eventually(_, operand)
            | Part::Historically(_, operand)
            | Part::Once(_, operand)
            | Part::Edge(_, _, operand) => std::slice::from_mut(operand),
        }
    }

    /// Takes what the operands have said.
    fn take(&mut self) {
        let said = &mut self.said;
        match &mut self.part {
            Part::Constant(_) | Part::Signal(_) | Part::Compare(..) => {}
            Part::Not(operand) => said.extend(operand.said.drain(..).map(|of| Judged::here(of.sample, of.worth.not()))),
            Part::Pair(join, operands) => pairs(operands, |left, right| said.push_back(join(left, right))),
            Part::Always(ahead, operand) => {
                operand.said.drain(..).for_each(|of| ahead.push(of.sample, All::of(&of), said));
            }
            Part::Eventually(ahead, operand) => {
                operand.said.drain(..).for_each(|of| ahead.push(of.sample, Any::of(&of), said));
            }
            Part::Until(ahead, operands) => {
                pairs(operands, |left, right| ahead.push(left.sample, Pursuit::of(left, right), said));
            }
            Part::Historically(back, operand) => said.extend(
                operand.said.drain(..).map(|of| Judged::here(of.sample, back.push(of.sample, All::of(&of)).0.worth)),
            ),
            Part::Once(back, operand) => said.extend(
                operand.said.drain(..).map(|of| Judged::here(of.sample, back.push(of.sample, Any::of(&of)).0.worth)),
            ),
            Part::Since(back, operands) => pairs(operands, |left, right| {
                let (seen, tail) = back.push(left.sample, Since { reached: right.worth, held: left.worth });
                said.push_back(Judged::here(left.sample, tail.held.and(seen.reached)));
            }),
            Part::Edge(edge, before, operand) => said.extend(
                operand
                    .said
                    .drain(..)
                    .map(|of| Judged::here(of.sample, differs(*edge, before.replace(of.worth), of.worth))),
            ),
        }
    }

    /// The number of the first sample that it may still report; single ones before that go to `others`.
    pub(super) fn keeps(&self, others: &mut Vec<u64>) -> u64 {
        let own = match &self.part {
            Part::Constant(_) | Part::Signal(_) | Part::Compare(..) => u64::MAX,
            Part::Not(operand)
            | Part::Historically(_, operand)
            | Part::Once(_, operand)
            | Part::Edge(_, _, operand) => operand.keeps(others),
            Part::Always(ahead, operand) => ahead.keeps(others).min(operand.keeps(others)),
            Part::Eventually(ahead, operand) => ahead.keeps(others).min(operand.keeps(others)),
            Part::Until(ahead, operands) => ahead.keeps(others).min(kept_by(operands, others)),
            Part::Pair(_, operands) | Part::Since(_, operands) => kept_by(operands, others),
        };
        let said = match (self.demand, self.said.front()) {
            (_, None) => u64::MAX,
            (Demand::Every, Some(first)) => first.sample.number,
            (Demand::First, Some(first)) => {
                others.push(first.certain.sample);
                u64::MAX
            }
        };
        own.min(said)
    }
}

#[cfg(test)]
impl Monitor {
    /// How many samples' worth it holds.
    pub(super) fn held(&self) -> usize {
        let own = match &self.part {
            Part::Always(ahead, _) => ahead.held(),
            Part::Eventually(ahead, _) => ahead.held(),
            Part::Until(ahead, _) => ahead.held(),
            Part::Historically(back, _) => back.held(),
            Part::Once(back, _) => back.held(),
            Part::Since(back, _) => back.held(),
            _ => 0,
        };
        let operands = self.clone().operands().iter().map(Self::held).sum::<usize>();
        self.said.len() + own + operands
    }
}

fn kept_by(operands: &[Monitor; 2], others: &mut Vec<u64>) -> u64 {
    operands.iter().map(|operand| operand.keeps(others)).min().unwrap_or(u64::MAX)
}

/// Takes what both have said of the same samples.
fn pairs(operands: &mut [Monitor; 2], mut each: impl FnMut(&Judged, &Judged)) {
    let [left, right] = operands;
    let both = left.said.len().min(right.said.len());
    left.said.drain(..both).zip(right.said.drain(..both)).for_each(|(left, right)| each(&left, &right));
}

fn and(left: &Judged, right: &Judged) -> Judged {
    let certain = [left, right].into_iter().filter_map(Judged::if_false).min();
    let certain = certain.unwrap_or(Certain::at(left.sample));
    Judged { sample: left.sample, worth: left.worth.and(right.worth), certain }
}

fn or(left: &Judged, right: &Judged) -> Judged {
    Judged { sample: left.sample, worth: left.worth.or(right.worth), certain: left.certain.max(right.certain) }
}

/// What follows from an implication is reported at the time of its cause.
fn implies(left: &Judged, right: &Judged) -> Judged {
    Judged::here(left.sample, left.worth.not().or(right.worth))
}

fn iff(left: &Judged, right: &Judged) -> Judged {
    let (a, b) = (left.worth, right.worth);
    Judged::here(left.sample, a.and(b).or(a.not().and(b.not())))
}

/// The first sample differs from nothing.
fn differs(edge: Edge, before: Option<Worth>, now: Worth) -> Worth {
    before.map_or(Worth::BOTTOM, |before| {
        let (rose, fell) = (before.not().and(now), before.and(now.not()));
        match edge {
            Edge::Rose => rose,
            Edge::Fell => fell,
            Edge::Changed => rose.or(fell),
        }
    })
}
