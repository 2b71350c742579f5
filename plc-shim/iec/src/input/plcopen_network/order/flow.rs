//! By the flow of data.
//!
//! 1. Labels divide a body into parts; in a part, networks come by their numbers, then as they stand.
//! 2. In a network, what has an `executionOrderId` other than 0 comes first, each behind what it needs.
//! 3. Of those that have all their inputs, the first is evaluated next.
//! 4. A variable is read once, where its value is first wanted.
//! 5. What is written with an output of a block comes directly behind the block.
//! 6. Jumps and returns come last in their network.

use std::collections::{BTreeMap, BTreeSet};

use super::finished::finished;
use super::rank::{Number, Place, Rank};
use crate::input::plcopen_network::element::{Kind, Node};

pub(super) fn order(
    nodes: &[Node<'_>],
    sources: &[Vec<usize>],
    ranks: &[Rank],
    places: Vec<Place>,
    as_in_file: bool,
) -> Vec<usize> {
    let mut flow = Flow::new(nodes, sources, ranks);
    for place in places {
        match place {
            Place::Label(index) => flow.order.push(index),
            Place::Network(members) => flow.network(&members, as_in_file),
        }
    }
    flow.order
}

struct Flow<'f, 'e> {
    nodes: &'f [Node<'e>],
    sources: &'f [Vec<usize>],
    ranks: &'f [Rank],
    /// Which elements get values from each, once for each connection.
    users: Vec<Vec<usize>>,
    /// How many of an element's inputs have not been evaluated, without variables, which are read when wanted.
    missing: Vec<usize>,
    done: Vec<bool>,
    ready: BTreeSet<Rank>,
    order: Vec<usize>,
}

impl<'f, 'e> Flow<'f, 'e> {
    fn new(nodes: &'f [Node<'e>], sources: &'f [Vec<usize>], ranks: &'f [Rank]) -> Self {
        let mut flow = Self {
            nodes,
            sources,
            ranks,
            users: vec![Vec::new(); nodes.len()],
            missing: vec![0; nodes.len()],
            done: vec![false; nodes.len()],
            ready: BTreeSet::new(),
            order: Vec::with_capacity(nodes.len()),
        };
        for (index, list) in sources.iter().enumerate() {
            for source in list.iter().filter(|source| flow.waits_for(**source)).copied().collect::<Vec<_>>() {
                if let (Some(users), Some(missing)) = (flow.users.get_mut(source), flow.missing.get_mut(index)) {
                    users.push(index);
                    *missing += 1;
                }
            }
        }
        flow
    }

    fn kind(&self, index: usize) -> Option<Kind> {
        self.nodes.get(index).map(|node| node.kind)
    }

    /// True for what others wait for.
    fn waits_for(&self, index: usize) -> bool {
        self.kind(index).is_some_and(|kind| !kind.is_rail() && kind != Kind::InVariable)
    }

    fn is_control(&self, index: usize) -> bool {
        self.kind(index).is_some_and(Kind::is_control)
    }

    fn rank(&self, index: usize) -> Rank {
        self.ranks.get(index).copied().unwrap_or((Number::Missing, (0, 0), index))
    }

    fn is_done(&self, index: usize) -> bool {
        self.done.get(index).is_none_or(|done| *done)
    }

    fn network(&mut self, members: &[usize], as_in_file: bool) {
        let (control, mut elements): (Vec<usize>, Vec<usize>) = members.iter().partition(|one| self.is_control(**one));
        elements.retain(|index| self.waits_for(*index));
        elements.sort_by_key(|index| self.rank(*index));
        let numbered = |index: &&usize| as_in_file || self.rank(**index).0 != Number::Missing;
        let starts: Vec<usize> = elements.iter().filter(numbered).copied().collect();
        for index in
            finished(starts, self.sources).into_iter().filter(|index| self.waits_for(*index)).collect::<Vec<_>>()
        {
            self.evaluate(index);
        }
        for index in elements {
            self.offer(index);
        }
        while let Some((_, _, index)) = self.ready.pop_first() {
            self.evaluate(index);
        }
        let mut rest = control;
        rest.sort_by_key(|index| self.rank(*index));
        rest.extend(members.iter().filter(|index| self.kind(**index) == Some(Kind::InVariable)));
        for index in rest {
            self.evaluate(index);
        }
    }

    /// The element may be evaluated if it has all its inputs.
    fn offer(&mut self, index: usize) {
        let complete = self.missing.get(index) == Some(&0);
        if complete && !self.is_done(index) && !self.is_control(index) {
            self.ready.insert(self.rank(index));
        }
    }

    fn evaluate(&mut self, index: usize) {
        if self.is_done(index) {
            return;
        }
        for one in self.sources.get(index).into_iter().flatten().copied().chain([index]) {
            let wanted = one == index || self.kind(one) == Some(Kind::InVariable);
            if wanted && self.done.get_mut(one).is_some_and(|done| !std::mem::replace(done, true)) {
                self.order.push(one);
            }
        }
        let users = self.users.get_mut(index).map(std::mem::take).unwrap_or_default();
        for user in &users {
            if let Some(missing) = self.missing.get_mut(*user) {
                *missing = missing.saturating_sub(1);
            }
            self.offer(*user);
        }
        if self.kind(index) == Some(Kind::Block) {
            for written in self.written_with(index, &users) {
                self.evaluate(written);
            }
        }
    }

    /// What is written with the outputs of a block, by the order of these: variables, and the only coil at an output.
    fn written_with(&self, block: usize, users: &[usize]) -> Vec<usize> {
        let pins_of = |user: usize| {
            let inputs = self.nodes.get(user).into_iter().flat_map(|node| &node.inputs);
            inputs.flat_map(|input| &input.links).filter(|link| link.source == Some(block)).map(|link| link.pin)
        };
        let users: BTreeSet<usize> = users.iter().copied().collect();
        let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
        for pin in users.iter().flat_map(|user| pins_of(*user)) {
            *uses.entry(pin).or_default() += 1;
        }
        let outputs = self.nodes.get(block).map_or(&[][..], |node| node.outputs.as_slice());
        let position = |pin: &str| outputs.iter().position(|output| output.name.eq_ignore_ascii_case(pin)).unwrap_or(0);
        let mut found: Vec<(usize, Rank)> = Vec::new();
        for user in users {
            let first = pins_of(user).map(position).min().unwrap_or(0);
            let is_written = match self.kind(user) {
                Some(Kind::OutVariable | Kind::InOutVariable) => true,
                Some(Kind::Coil) => pins_of(user).all(|pin| uses.get(pin) == Some(&1)),
                _ => false,
            };
            let is_free = self.rank(user).0 == Number::Missing;
            if is_written && is_free && self.missing.get(user) == Some(&0) {
                found.push((first, self.rank(user)));
            }
        }
        found.sort_unstable();
        found.into_iter().map(|(_, (_, _, index))| index).collect()
    }
}
