//! The whole graph of a model, for questions that look at more than one state.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use stateright::Model;

/// All states that `model` can reach, and which follow which.
pub(crate) struct Graph<M: Model> {
    pub(crate) states: Vec<M::State>,
    edges: Vec<Vec<usize>>,
}

pub(crate) fn explore<M: Model>(model: &M) -> Graph<M>
where
    M::State: Clone + Hash,
{
    let key = |state: &M::State| {
        let mut hasher = DefaultHasher::new();
        state.hash(&mut hasher);
        hasher.finish()
    };
    let (mut graph, mut known) = (Graph::<M> { states: Vec::new(), edges: Vec::new() }, HashMap::new());
    for state in model.init_states() {
        known.insert(key(&state), graph.states.len());
        graph.states.push(state);
    }
    let mut next = 0;
    let mut actions = Vec::new();
    while next < graph.states.len() {
        actions.clear();
        model.actions(&graph.states[next], &mut actions);
        let mut follows = Vec::with_capacity(actions.len());
        for action in actions.drain(..) {
            let Some(state) = model.next_state(&graph.states[next], action) else { continue };
            let index = *known.entry(key(&state)).or_insert_with(|| {
                graph.states.push(state);
                graph.states.len() - 1
            });
            follows.push(index);
        }
        graph.edges.push(follows);
        next += 1;
    }
    graph
}

impl<M: Model> Graph<M> {
    /// `AG EF goal`: from every state a state with `goal` can be reached. The states from which none can.
    pub(crate) fn cannot_reach(&self, goal: impl Fn(&M::State) -> bool) -> usize {
        let mut before = vec![Vec::new(); self.states.len()];
        for (from, follows) in self.edges.iter().enumerate() {
            for to in follows {
                before[*to].push(from);
            }
        }
        let mut reaches: Vec<bool> = self.states.iter().map(goal).collect();
        let mut todo: Vec<usize> = (0..self.states.len()).filter(|i| reaches[*i]).collect();
        while let Some(state) = todo.pop() {
            for from in &before[state] {
                if !std::mem::replace(&mut reaches[*from], true) {
                    todo.push(*from);
                }
            }
        }
        reaches.iter().filter(|reaches| !**reaches).count()
    }

    /// Every pair of a state and one that follows it.
    pub(crate) fn transitions(&self) -> impl Iterator<Item = (&M::State, &M::State)> {
        self.edges
            .iter()
            .enumerate()
            .flat_map(move |(from, follows)| follows.iter().map(move |to| (&self.states[from], &self.states[*to])))
    }
}
