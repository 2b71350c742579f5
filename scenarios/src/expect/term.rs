//! Terms, sample by sample.

use super::formula::{Term, TermKind};
use super::sample::{Block, Sample};

/// A term that remembers what `rate` needs.
#[derive(Clone, Debug)]
pub(super) enum Number {
    Constant(f64),
    Signal(usize),
    Changed(fn(f64) -> f64, Box<Self>),
    /// The sample before, and the value then.
    Rate(Option<(Sample, f64)>, Box<Self>),
    Joined(fn(f64, f64) -> f64, Box<Self>, Box<Self>),
    /// Times the first, by the second.
    Scaled(Box<Self>, f64, f64),
}

impl Number {
    pub(super) fn of(term: &Term<usize>) -> Self {
        let boxed = |term: &Term<usize>| Box::new(Self::of(term));
        match &term.kind {
            TermKind::Number(value, _) => Self::Constant(*value),
            TermKind::Signal(column) => Self::Signal(*column),
            TermKind::Negate(inner) => Self::Changed(|value| -value, boxed(inner)),
            TermKind::Abs(inner) => Self::Changed(f64::abs, boxed(inner)),
            TermKind::Rate(inner) => Self::Rate(None, boxed(inner)),
            TermKind::Scaled(inner, times, by) => Self::Scaled(boxed(inner), *times, *by),
            TermKind::Binary(operator, left, right) => Self::Joined(operator.operation(), boxed(left), boxed(right)),
        }
    }

    /// Whether it depends on the sample before.
    pub(super) fn remembers(&self) -> bool {
        match self {
            Self::Constant(_) | Self::Signal(_) => false,
            Self::Changed(_, inner) | Self::Scaled(inner, ..) => inner.remembers(),
            Self::Joined(_, left, right) => left.remembers() || right.remembers(),
            Self::Rate(..) => true,
        }
    }

    /// What it is at a sample; samples come in their order.
    pub(super) fn at(&mut self, block: &Block, place: usize, sample: Sample) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Signal(column) => block.value(*column, place),
            Self::Changed(change, inner) => change(inner.at(block, place, sample)),
            Self::Joined(join, left, right) => join(left.at(block, place, sample), right.at(block, place, sample)),
            Self::Scaled(inner, times, by) => inner.at(block, place, sample) * *times / *by,
            Self::Rate(before, inner) => {
                let now = inner.at(block, place, sample);
                match before.replace((sample, now)) {
                    Some((earlier, value)) => (now - value) * 1e9 / (sample.t_ns - earlier.t_ns) as f64,
                    None => 0.0,
                }
            }
        }
    }
}
