//! As the generator of Beremiz has it (`PLCGenerator.py`, `ComputeProgram`): what has an `executionOrderId` by these,
//! then the other variables and coils, then blocks, then connectors, all in the order of the file.
//!
//! 1. Each of them first calls the blocks that it needs and that have not been called in this scan.
//! 2. A block with an `executionOrderId` calls no instances: it takes their outputs as they are.
//! 3. A variable, contact or coil on the way is read again by each that needs it, behind the calls.
//! 4. What comes back to a block that is being called is its output of the scan before.

use std::collections::BTreeSet;

use super::step::Step;
use crate::input::plcopen_network::element::{Kind, Node, attribute};

/// Most values that are taken in a body: without a limit, they grow with the square of its elements.
const MAX_TAKEN: usize = 200_000;

/// What is wrong, and with which element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::input::plcopen_network) enum Problem {
    /// A loop in which nothing keeps a value.
    Loop(usize),
    /// Too many values are taken again.
    TooLarge(usize),
}

pub(super) fn order(nodes: &[Node<'_>], sources: &[Vec<usize>], end: Option<usize>) -> (Vec<Step>, Vec<Problem>) {
    let mut calls = Calls {
        nodes,
        sources,
        blocks: vec![Call::Wanted; nodes.len()],
        touched: vec![false; nodes.len()],
        steps: Vec::new(),
        taken: 0,
        problems: BTreeSet::new(),
    };
    for root in end.map_or_else(|| roots(nodes), |end| vec![end]) {
        calls.root(root);
    }
    if end.is_none() {
        let untouched = |(index, node): (usize, &Node<'_>)| {
            let touched = calls.touched.get(index).is_none_or(|touched| *touched);
            (!touched && !node.kind.is_rail()).then_some(Step::Take(index))
        };
        let rest: Vec<Step> = nodes.iter().enumerate().filter_map(untouched).collect();
        calls.steps.extend(rest);
    }
    calls.steps.retain(|step| Some(step.index()) != end);
    let problems = calls.problems.into_iter().map(
        |(index, large)| {
            if large { Problem::TooLarge(index) } else { Problem::Loop(index) }
        },
    );
    (calls.steps, problems.collect())
}

/// What is evaluated for its own sake.
fn roots(nodes: &[Node<'_>]) -> Vec<usize> {
    let of = |wanted: fn(&Node<'_>) -> bool| {
        nodes.iter().enumerate().filter(move |(_, node)| wanted(node)).map(|(index, _)| index)
    };
    let number = |index: &usize| nodes.get(*index).and_then(|node| node.order);
    let mut numbered: Vec<usize> =
        of(|node| matches!(node.kind, Kind::OutVariable | Kind::InOutVariable | Kind::Block) && node.order.is_some())
            .collect();
    numbered.sort_by_key(number);
    let written = of(|node| {
        node.kind == Kind::Coil || matches!(node.kind, Kind::OutVariable | Kind::InOutVariable) && node.order.is_none()
    });
    let blocks = of(|node| node.kind == Kind::Block && node.order.is_none());
    let connectors = of(|node| node.kind == Kind::Connector);
    numbered.into_iter().chain(written).chain(blocks).chain(connectors).collect()
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Call {
    Wanted,
    Begun,
    Done,
}

/// An element, and what it needs.
struct Frame {
    index: usize,
    /// Blocks, in the order in which they are met.
    blocks: std::vec::IntoIter<usize>,
    /// Elements between those and this one, each behind what it needs.
    between: Vec<usize>,
}

struct Calls<'c, 'e> {
    nodes: &'c [Node<'e>],
    sources: &'c [Vec<usize>],
    blocks: Vec<Call>,
    /// Elements that have a step.
    touched: Vec<bool>,
    steps: Vec<Step>,
    taken: usize,
    /// Elements with a loop (`false`) or with too much behind them (`true`).
    problems: BTreeSet<(usize, bool)>,
}

impl Calls<'_, '_> {
    fn kind(&self, index: usize) -> Option<Kind> {
        self.nodes.get(index).map(|node| node.kind)
    }

    fn is_instance(&self, index: usize) -> bool {
        self.nodes.get(index).is_some_and(|node| !attribute(node.element, "instanceName").is_empty())
    }

    fn begin(&mut self, index: usize) -> Option<Frame> {
        if self.kind(index) == Some(Kind::Block) {
            match self.blocks.get(index) {
                Some(Call::Begun) if !self.is_instance(index) => {
                    self.problems.insert((index, false));
                    return None;
                }
                Some(Call::Wanted) => {}
                _ => return None,
            }
            if let Some(call) = self.blocks.get_mut(index) {
                *call = Call::Begun;
            }
        }
        let (blocks, between) = self.needed(index);
        Some(Frame { index, blocks: blocks.into_iter(), between })
    }

    fn root(&mut self, root: usize) {
        if self.taken > MAX_TAKEN {
            return;
        }
        let mut open: Vec<Frame> = self.begin(root).into_iter().collect();
        while let Some(frame) = open.last_mut() {
            if let Some(block) = frame.blocks.next() {
                let asks =
                    self.nodes.get(frame.index).is_some_and(|node| node.kind == Kind::Block && node.order.is_some());
                if !(asks && self.is_instance(block)) {
                    open.extend(self.begin(block));
                }
                continue;
            }
            let Some(Frame { index, between, .. }) = open.pop() else { break };
            self.finish(index, between);
        }
    }

    fn finish(&mut self, index: usize, between: Vec<usize>) {
        self.taken = self.taken.saturating_add(between.len());
        if self.taken > MAX_TAKEN {
            self.problems.insert((index, true));
        } else {
            self.steps.extend(between.iter().map(|one| Step::Take(*one)));
        }
        self.steps.push(Step::Evaluate(index));
        for one in between.into_iter().chain([index]) {
            if let Some(touched) = self.touched.get_mut(one) {
                *touched = true;
            }
        }
        if let Some(call) = self.blocks.get_mut(index) {
            *call = Call::Done;
        }
    }

    /// The blocks that an element needs, and the elements between.
    fn needed(&mut self, start: usize) -> (Vec<usize>, Vec<usize>) {
        let (mut blocks, mut between) = (Vec::new(), Vec::new());
        let mut seen = BTreeSet::from([start]);
        let mut ready: BTreeSet<usize> = BTreeSet::new();
        let mut open = vec![(start, 0)];
        while let Some(&mut (index, ref mut next)) = open.last_mut() {
            // A variable in the line is read: what it gets is not asked for.
            let ends = index != start && self.kind(index) == Some(Kind::InOutVariable);
            let list = self.sources.get(index).filter(|_| !ends);
            let source = list.and_then(|list| list.get(*next)).copied();
            *next += 1;
            let Some(source) = source else {
                open.pop();
                ready.insert(index);
                if index != start {
                    between.push(index);
                }
                continue;
            };
            match self.kind(source) {
                None | Some(Kind::LeftRail | Kind::RightRail) => {}
                Some(Kind::Block) => {
                    if seen.insert(source) {
                        blocks.push(source);
                    }
                }
                Some(kind) => {
                    if seen.insert(source) {
                        open.push((source, 0));
                    } else if kind != Kind::InOutVariable && !ready.contains(&source) {
                        self.problems.insert((source, false));
                    }
                }
            }
        }
        (blocks, between)
    }
}
