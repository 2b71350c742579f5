//! How far around a sample a formula looks, so that it is known which part of a run may still matter to its verdict.

use super::formula::{Formula, Term, TermKind, Window};

/// A formula at a time looks at samples from so long before to so long after it, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Reach {
    back_ns: u64,
    ahead_ns: u64,
}

impl Reach {
    fn or(self, other: Self) -> Self {
        Self { back_ns: self.back_ns.max(other.back_ns), ahead_ns: self.ahead_ns.max(other.ahead_ns) }
    }

    fn back(self, by_ns: u64) -> Self {
        Self { back_ns: self.back_ns.saturating_add(by_ns), ..self }
    }

    fn ahead(self, by_ns: u64) -> Self {
        Self { ahead_ns: self.ahead_ns.saturating_add(by_ns), ..self }
    }

    fn whole_ns(self) -> u64 {
        self.back_ns.saturating_add(self.ahead_ns)
    }
}

/// How long a run may matter to what is open of a formula; nothing if all of it may.
pub(super) fn memory_ns(formula: &Formula<usize>, step_ns: u64) -> Option<u64> {
    match formula {
        // Once the part within is settled at a time, that time matters only for what is settled of the whole.
        Formula::Always(_, inner) | Formula::Eventually(_, inner) => Some(reach(inner, step_ns)?.whole_ns()),
        // What is open of several that must always hold is open of each.
        Formula::And(one, other) if is_always(one) && is_always(other) => {
            Some(memory_ns(one, step_ns)?.max(memory_ns(other, step_ns)?))
        }
        Formula::Constant(_) => Some(0),
        _ => None,
    }
}

fn is_always(formula: &Formula<usize>) -> bool {
    match formula {
        Formula::Always(..) => true,
        Formula::And(one, other) => is_always(one) && is_always(other),
        _ => false,
    }
}

/// Nothing for what looks as far as the run goes.
fn reach(formula: &Formula<usize>, step_ns: u64) -> Option<Reach> {
    let of = |formula: &Formula<usize>| reach(formula, step_ns);
    // The sample that holds where a window begins may be a step before it.
    let end_ns = |window: &Window| Some(window.to_ns?.saturating_add(step_ns));
    Some(match formula {
        Formula::Constant(_) | Formula::Signal(_) => Reach::default(),
        Formula::Compare(_, left, right) => {
            Reach::default().back(rates(left).max(rates(right)).saturating_mul(step_ns))
        }
        Formula::Not(inner) => of(inner)?,
        Formula::And(one, other)
        | Formula::Or(one, other)
        | Formula::Implies(one, other)
        | Formula::Iff(one, other) => of(one)?.or(of(other)?),
        Formula::Always(window, inner) | Formula::Eventually(window, inner) => of(inner)?.ahead(end_ns(window)?),
        Formula::Until(window, one, other) => of(one)?.or(of(other)?).ahead(end_ns(window)?),
        Formula::Historically(window, inner) | Formula::Once(window, inner) => of(inner)?.back(end_ns(window)?),
        Formula::Since(window, one, other) => of(one)?.or(of(other)?).back(end_ns(window)?),
        Formula::Edge(_, inner) => of(inner)?.back(step_ns),
    })
}

/// How many samples before a term looks at: `rate` looks at the one before.
fn rates(term: &Term<usize>) -> u64 {
    match &term.kind {
        TermKind::Number(..) | TermKind::Signal(_) => 0,
        TermKind::Negate(inner) | TermKind::Abs(inner) | TermKind::Scaled(inner, ..) => rates(inner),
        TermKind::Rate(inner) => rates(inner).saturating_add(1),
        TermKind::Binary(_, one, other) => rates(one).max(rates(other)),
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalType;

    use crate::expect::{Expectation, KnownSignal};

    #[test]
    fn windows_say_how_long_a_run_matters() {
        let signal = |name: &str, ty| KnownSignal { name: name.to_owned(), ty, unit: None };
        let known = [signal("a", SignalType::BOOL), signal("x", SignalType::LREAL)];
        let memory = |text: &str| Expectation::parse(text, &known, &mut Vec::new()).unwrap().memory_ns(10);
        assert_eq!(memory("always (a implies x > 3)"), Some(0));
        assert_eq!(memory("always (rose(a) implies eventually[0,50ns] x > 3)"), Some(70));
        assert_eq!(memory("always (a implies once[0,20ns] eventually[0,50ns] rate(rate(x)) > 3)"), Some(110));
        assert_eq!(memory("always[0,90ns] a and always x < 3"), Some(0));
        assert_eq!(memory("eventually (not a)"), Some(0));
        for whole in ["always (a implies eventually x > 3)", "always (a since x > 3)", "a", "eventually a and always a"]
        {
            assert_eq!(memory(whole), None, "{whole}");
        }
    }
}
