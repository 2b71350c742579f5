//! Who calls whom: what is to be checked, what a run decides, and calls that come back to a unit that still runs.

use std::collections::{BTreeMap, BTreeSet};

use super::Declarations;
use super::class::Role;
use crate::ir::{ElementaryType, Guard, Pou, PouId, Row};
use crate::syntax::Span;

/// What calls lead to, as far as bodies have been checked.
#[derive(Debug, Default)]
pub(super) struct Calls {
    /// Units whose bodies are still to be checked, and all that ever were.
    queue: Vec<PouId>,
    queued: BTreeSet<PouId>,
    /// Who calls whom, and where.
    known: BTreeMap<PouId, Vec<(PouId, Span)>>,
    /// Who may be called in ways that only a run decides.
    dynamic: BTreeMap<PouId, BTreeSet<PouId>>,
    rows: Rows,
}

impl Calls {
    pub(super) fn into_rows(self) -> Vec<Row> {
        self.rows.list
    }
}

/// Rows of the table of methods, each for one member of one unit or interface.
#[derive(Debug, Default)]
struct Rows {
    list: Vec<Row>,
    known: BTreeMap<(PouId, Role, String), usize>,
}

impl Declarations<'_> {
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
            Some((number, target)).filter(|_| !self.is_prototype(target) || self.rests_on_stub(variant))
        });
        found.collect()
    }

    /// The row of a member; `method` has its parameters.
    pub(in crate::check) fn row(&mut self, class: PouId, role: Role, name: &str, method: PouId) -> Option<usize> {
        let key = (class, role, name.to_ascii_uppercase());
        if let Some(found) = self.calls.rows.known.get(&key) {
            return Some(*found);
        }
        let span = self.pou(method).ast.name.span;
        let scope = self.interface(method, span)?;
        let targets: BTreeMap<u32, PouId> = self.targets(class, role, name).into_iter().collect();
        let (first, last) = (*targets.keys().next()?, *targets.keys().next_back()?);
        let result = scope.result().map(|place| self.types.elementary(place.ty));
        let row = Row {
            parameters: scope.parameter_types().to_vec(),
            result: result.map(|held| held.unwrap_or(ElementaryType::Udint)),
            first,
            targets: (first..=last).map(|number| targets.get(&number).copied()).collect(),
        };
        self.calls.rows.list.push(row);
        let index = self.calls.rows.list.len() - 1;
        self.calls.rows.known.insert(key, index);
        Some(index)
    }

    /// Guards the units that a call can come back to.
    pub(in crate::check) fn guard_circles(&mut self, checked: &mut BTreeMap<PouId, Pou>) {
        let mut circular = BTreeSet::new();
        let (forward, backward) = self.call_graph();
        for caller in leading_to_circles(&forward, &backward) {
            // What is known to lie on a circle needs no other look.
            if circular.contains(&caller) {
                continue;
            }
            let ahead = reached(caller, &forward);
            if ahead.contains(&caller) {
                circular.extend(reached(caller, &backward).intersection(&ahead).copied());
            }
        }
        let ids: Vec<PouId> = checked.keys().copied().collect();
        for id in ids {
            let span = self.pou(id).ast.name.span;
            let guard = match checked.get(&id).map(|pou| pou.guard) {
                Some(Guard::Once(_)) if circular.contains(&id) => {
                    self.allocate(1, 1, span).map_or(Guard::None, Guard::Once)
                }
                Some(Guard::Depth) if circular.contains(&id) => Guard::Depth,
                _ => Guard::None,
            };
            if let Some(pou) = checked.get_mut(&id) {
                pou.guard = guard;
            }
        }
    }

    /// Who may call whom, and who may be called by whom.
    fn call_graph(&self) -> (Graph, Graph) {
        let (mut forward, mut backward) = (Graph::new(), Graph::new());
        let known =
            self.calls.known.iter().flat_map(|(caller, calls)| calls.iter().map(|(callee, _)| (*caller, *callee)));
        let dynamic =
            self.calls.dynamic.iter().flat_map(|(caller, calls)| calls.iter().map(|callee| (*caller, *callee)));
        for (caller, callee) in known.chain(dynamic) {
            forward.entry(caller).or_default().insert(callee);
            backward.entry(callee).or_default().insert(caller);
        }
        (forward, backward)
    }
}

type Graph = BTreeMap<PouId, BTreeSet<PouId>>;

/// The units from which a circle is reached: what calls none of them is left out, over and over. Of most programs
/// nothing is left.
fn leading_to_circles(forward: &Graph, backward: &Graph) -> BTreeSet<PouId> {
    let mut left: BTreeMap<PouId, usize> = forward.iter().map(|(caller, callees)| (*caller, callees.len())).collect();
    let mut open: Vec<PouId> = backward.keys().filter(|callee| !forward.contains_key(callee)).copied().collect();
    while let Some(done) = open.pop() {
        for caller in backward.get(&done).into_iter().flatten() {
            if let Some(calls) = left.get_mut(caller) {
                *calls -= 1;
                if *calls == 0 {
                    left.remove(caller);
                    open.push(*caller);
                }
            }
        }
    }
    left.into_keys().collect()
}

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

impl Declarations<'_> {
    /// Has the unit's body checked, once.
    pub(in crate::check) fn enqueue(&mut self, id: PouId) {
        if self.calls.queued.insert(id) {
            self.calls.queue.push(id);
        }
    }

    /// The next unit whose body is to be checked.
    pub(in crate::check) fn next_unit(&mut self) -> Option<PouId> {
        self.calls.queue.pop()
    }

    /// Notes a call, and has what is called checked.
    pub(in crate::check) fn note_call(&mut self, caller: Option<PouId>, callee: PouId, span: Span) {
        if let Some(caller) = caller {
            self.calls.known.entry(caller).or_default().push((callee, span));
        }
        self.enqueue(callee);
    }

    /// Notes what a call may run that only a run decides, and has it checked.
    pub(in crate::check) fn note_dynamic_call(&mut self, caller: Option<PouId>, callee: PouId) {
        if let Some(caller) = caller {
            self.calls.dynamic.entry(caller).or_default().insert(callee);
        }
        self.enqueue(callee);
    }

    /// The calls of a unit, in the order in which they have been found.
    pub(super) fn calls_of(&self, caller: PouId) -> &[(PouId, Span)] {
        self.calls.known.get(&caller).map_or(&[], Vec::as_slice)
    }

    /// All units whose bodies have been checked or are to be.
    pub(super) fn queued(&self) -> BTreeSet<PouId> {
        self.calls.queued.clone()
    }

    /// All units that a call names.
    pub(in crate::check) fn called(&self) -> BTreeSet<PouId> {
        self.calls.known.values().flatten().map(|(callee, _)| *callee).collect()
    }

    /// A unit and all that it calls.
    pub(in crate::check) fn reached_from(&self, start: PouId) -> BTreeSet<PouId> {
        let mut seen = BTreeSet::from([start]);
        let mut open = vec![start];
        while let Some(pou) = open.pop() {
            for (callee, _) in self.calls_of(pou) {
                if seen.insert(*callee) {
                    open.push(*callee);
                }
            }
        }
        seen
    }
}
