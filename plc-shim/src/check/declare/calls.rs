//! Who calls whom: what is to be checked, what a run decides, and calls that come back to a unit that still runs.

use std::collections::{BTreeMap, BTreeSet};

use super::class::Role;
use super::declarations::Checker;
use crate::ir::{ElementaryType, Guard, PouId, Row};

/// Rows of the table of methods, each for one member of one unit or interface.
#[derive(Debug, Default)]
pub(in crate::check) struct Rows {
    list: Vec<Row>,
    known: BTreeMap<(PouId, Role, String), usize>,
}

impl Rows {
    pub(in crate::check) fn into_list(self) -> Vec<Row> {
        self.list
    }
}

impl Checker<'_> {
    /// True if any unit has a method or action of the name.
    pub(in crate::check) fn has_method_named(&self, key: &str) -> bool {
        self.method_names.contains(key)
    }

    /// What each type that can stand for `class` runs for a member, by the type's number.
    pub(in crate::check) fn targets(&self, class: PouId, role: Role, name: &str) -> Vec<(u32, PouId)> {
        let variants = self.variants(class).into_iter().filter(|variant| !self.is_abstract(*variant));
        let found = variants.filter_map(|variant| {
            let target = self.find_member(variant, role, name)?;
            let number = self.class(variant)?.type_id.unwrap_or(0);
            Some((number, target)).filter(|_| !self.is_prototype(target))
        });
        found.collect()
    }

    /// The row of a member; `method` has its parameters.
    pub(in crate::check) fn row(&mut self, class: PouId, role: Role, name: &str, method: PouId) -> Option<usize> {
        let key = (class, role, name.to_ascii_uppercase());
        if let Some(found) = self.rows.known.get(&key) {
            return Some(*found);
        }
        let span = self.pou(method).ast.name.span;
        let scope = self.interface(method, span)?;
        let targets: BTreeMap<u32, PouId> = self.targets(class, role, name).into_iter().collect();
        let (first, last) = (*targets.keys().next()?, *targets.keys().next_back()?);
        let result = scope.result.as_ref().map(|place| self.types.elementary(place.ty));
        let row = Row {
            parameters: scope.registers.iter().take(scope.parameters as usize).copied().collect(),
            result: result.map(|held| held.unwrap_or(ElementaryType::Udint)),
            first,
            targets: (first..=last).map(|number| targets.get(&number).copied()).collect(),
        };
        self.rows.list.push(row);
        let index = self.rows.list.len() - 1;
        self.rows.known.insert(key, index);
        Some(index)
    }

    /// Guards the units that a call which only a run decides can come back to.
    pub(in crate::check) fn guard_circles(&mut self) {
        let mut circular = BTreeSet::new();
        let (forward, backward) = self.call_graph();
        for caller in self.dynamic_calls.keys() {
            let ahead = reached(*caller, &forward);
            if ahead.contains(caller) {
                circular.extend(reached(*caller, &backward).intersection(&ahead).copied());
            }
        }
        let ids: Vec<PouId> = self.checked.keys().copied().collect();
        for id in ids {
            let span = self.pou(id).ast.name.span;
            let guard = match self.checked.get(&id).map(|pou| pou.guard) {
                Some(Guard::Once(_)) if circular.contains(&id) => {
                    self.allocate(1, 1, span).map_or(Guard::None, Guard::Once)
                }
                Some(Guard::Depth) if circular.contains(&id) => Guard::Depth,
                _ => Guard::None,
            };
            if let Some(pou) = self.checked.get_mut(&id) {
                pou.guard = guard;
            }
        }
    }

    /// Who may call whom, and who may be called by whom.
    fn call_graph(&self) -> (Graph, Graph) {
        let (mut forward, mut backward) = (Graph::new(), Graph::new());
        let known = self.calls.iter().flat_map(|(caller, calls)| calls.iter().map(|(callee, _)| (*caller, *callee)));
        let dynamic =
            self.dynamic_calls.iter().flat_map(|(caller, calls)| calls.iter().map(|callee| (*caller, *callee)));
        for (caller, callee) in known.chain(dynamic) {
            forward.entry(caller).or_default().insert(callee);
            backward.entry(callee).or_default().insert(caller);
        }
        (forward, backward)
    }
}

type Graph = BTreeMap<PouId, BTreeSet<PouId>>;

/// All that can be reached from `start` in one step or more.
fn reached(start: PouId, graph: &Graph) -> BTreeSet<PouId> {
    let mut found = BTreeSet::new();
    let mut open = vec![start];
    while let Some(next) = open.pop() {
        for each in graph.get(&next).into_iter().flatten() {
            if found.insert(*each) {
                open.push(*each);
            }
        }
    }
    found
}

impl<'a> Checker<'a> {
    /// Has the unit's body checked, once.
    pub(in crate::check) fn enqueue(&mut self, id: PouId) {
        if self.queued.insert(id) {
            self.queue.push(id);
        }
    }
}
