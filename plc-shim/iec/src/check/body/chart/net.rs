//! The situations that a chart can come to: its reachable markings, conditions left aside.
//!
//! A chart is a Petri net whose places are steps. It is safe if no transition activates a step that is
//! active already (2nd ed. 2.6.5, Figure 16 a), and nothing is unreachable if every transition is enabled
//! in some situation (Figure 16 b).

use std::collections::{BTreeSet, VecDeque};

/// Most situations of one network that are looked at.
pub(super) const MAX_SITUATIONS: usize = 100_000;

/// Steps and transitions by number.
#[derive(Debug, Default)]
pub(super) struct Net {
    pub(in crate::check::body) steps: usize,
    pub(in crate::check::body) initial: Vec<usize>,
    pub(in crate::check::body) transitions: Vec<Arcs>,
}

/// The steps before and behind a transition.
#[derive(Debug, Default, Clone)]
pub(super) struct Arcs {
    pub(in crate::check::body) from: Vec<usize>,
    pub(in crate::check::body) to: Vec<usize>,
}

/// The active steps, a bit each.
type Marking = Vec<u64>;

/// What was found in all situations.
#[derive(Debug, Default)]
pub(super) struct Explored {
    /// Steps that are active in some situation.
    pub(in crate::check::body) reached: BTreeSet<usize>,
    /// Transitions that are enabled in some situation.
    pub(super) enabled: BTreeSet<usize>,
    /// The first transition that activates a step that is active, and that step.
    pub(super) unsafe_at: Option<(usize, usize)>,
    /// The first situation from which no transition leads on.
    pub(super) dead: Option<Vec<usize>>,
    /// Pairs of `watched` steps that are active together.
    pub(super) together: BTreeSet<(usize, usize)>,
    /// There are more situations than are looked at.
    pub(super) is_cut_off: bool,
}

fn holds(marking: &Marking, step: usize) -> bool {
    marking.get(step / 64).is_some_and(|word| word >> (step % 64) & 1 == 1)
}

fn set(marking: &mut Marking, step: usize, active: bool) {
    if let Some(word) = marking.get_mut(step / 64) {
        let bit = 1 << (step % 64);
        if active { *word |= bit } else { *word &= !bit }
    }
}

fn active(marking: &Marking) -> impl Iterator<Item = usize> + '_ {
    (0..marking.len() * 64).filter(|step| holds(marking, *step))
}

impl Net {
    /// The number of the network that each step belongs to: what is joined by transitions is one.
    pub(super) fn networks(&self) -> Vec<usize> {
        let mut of: Vec<usize> = (0..self.steps).collect();
        let mut changed = true;
        while changed {
            changed = false;
            for arcs in &self.transitions {
                let all = || arcs.from.iter().chain(&arcs.to);
                let Some(least) = all().filter_map(|step| of.get(*step)).min().copied() else { continue };
                for step in all() {
                    if let Some(number) = of.get_mut(*step).filter(|number| **number != least) {
                        *number = least;
                        changed = true;
                    }
                }
            }
        }
        of
    }

    /// Every situation that follows from the initial one. `watched` steps are looked at in pairs.
    pub(super) fn explore(&self, watched: &BTreeSet<usize>) -> Explored {
        let mut found = Explored::default();
        let mut start = vec![0; self.steps.div_ceil(64)];
        self.initial.iter().for_each(|step| set(&mut start, *step, true));
        let mut known = BTreeSet::from([start.clone()]);
        let mut open = VecDeque::from([start]);
        while let Some(marking) = open.pop_front() {
            found.look_at(&marking, watched);
            let mut leads_on = false;
            for (number, arcs) in self.transitions.iter().enumerate() {
                if arcs.from.is_empty() || !arcs.from.iter().all(|step| holds(&marking, *step)) {
                    continue;
                }
                leads_on = true;
                found.enabled.insert(number);
                match arcs.cleared(&marking) {
                    Err(step) => {
                        found.unsafe_at.get_or_insert((number, step));
                    }
                    Ok(next) if known.len() < MAX_SITUATIONS => {
                        if known.insert(next.clone()) {
                            open.push_back(next);
                        }
                    }
                    Ok(next) => found.is_cut_off |= !known.contains(&next),
                }
            }
            if !leads_on && found.dead.is_none() {
                found.dead = Some(active(&marking).collect());
            }
        }
        found
    }
}

impl Arcs {
    /// The situation behind the transition, or the step that would be activated twice.
    fn cleared(&self, marking: &Marking) -> Result<Marking, usize> {
        let mut next = marking.clone();
        self.from.iter().for_each(|step| set(&mut next, *step, false));
        for step in &self.to {
            if holds(&next, *step) {
                return Err(*step);
            }
            set(&mut next, *step, true);
        }
        Ok(next)
    }
}

impl Explored {
    fn look_at(&mut self, marking: &Marking, watched: &BTreeSet<usize>) {
        self.reached.extend(active(marking));
        let here: Vec<usize> = watched.iter().copied().filter(|step| holds(marking, *step)).collect();
        for (at, first) in here.iter().enumerate() {
            self.together.extend(here.iter().skip(at + 1).map(|second| (*first, *second)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn net(steps: usize, transitions: &[(&[usize], &[usize])]) -> Net {
        let transitions = transitions.iter().map(|(from, to)| Arcs { from: from.to_vec(), to: to.to_vec() });
        Net { steps, initial: vec![0], transitions: transitions.collect() }
    }

    #[test]
    fn simultaneous_sequences_are_safe() {
        let fork = net(5, &[(&[0], &[1, 2]), (&[1], &[3]), (&[2, 3], &[4]), (&[4], &[0])]);
        let found = fork.explore(&BTreeSet::from([1, 2, 3]));
        assert_eq!(found.reached.len(), 5);
        assert_eq!(found.enabled.len(), 4);
        assert_eq!((found.unsafe_at, found.dead, found.is_cut_off), (None, None, false));
        assert_eq!(found.together, BTreeSet::from([(1, 2), (2, 3)]));
    }

    #[test]
    fn iec2_2_6_5_figure_16a_a_token_too_many_is_seen() {
        let leak = net(3, &[(&[0], &[1, 2]), (&[1], &[0])]);
        assert_eq!(leak.explore(&BTreeSet::new()).unsafe_at, Some((0, 2)));
    }

    #[test]
    fn iec2_2_6_5_figure_16b_what_waits_for_both_of_two_choices_waits_for_ever() {
        let choice = net(4, &[(&[0], &[1]), (&[0], &[2]), (&[1, 2], &[3])]);
        let found = choice.explore(&BTreeSet::new());
        assert_eq!((found.enabled.len(), found.reached.len(), found.dead), (2, 3, Some(vec![1])));
    }

    #[test]
    fn what_is_too_large_is_cut_off() {
        let branches = 20;
        let mut transitions = vec![Arcs { from: vec![0], to: (1..=branches).collect() }];
        transitions.extend((1..=branches).map(|step| Arcs { from: vec![step], to: vec![step + branches] }));
        let wide = Net { steps: 2 * branches + 1, initial: vec![0], transitions };
        assert!(wide.explore(&BTreeSet::new()).is_cut_off);
    }

    #[test]
    fn networks_are_what_transitions_join() {
        assert_eq!(net(5, &[(&[0], &[2]), (&[3], &[2])]).networks(), [0, 1, 0, 0, 4]);
    }
}
