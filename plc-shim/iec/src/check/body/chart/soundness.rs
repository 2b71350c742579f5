//! Charts that are unsafe, unreachable or come to an end (2nd ed. 2.6.5, 3rd ed. 6.7.6).

use std::collections::{BTreeMap, BTreeSet};

use super::association::{Action, Use};
use super::net::{Arcs, Explored, MAX_SITUATIONS, Net};
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{Chart, ChartStep, Transition};

impl Body<'_, '_> {
    pub(super) fn check_soundness(&mut self, chart: &Chart, net: &Net, actions: &[Action]) {
        let networks = net.networks();
        if !self.check_initial_steps(chart, &networks) {
            return;
        }
        let timed = timed_steps(actions);
        let mut together = BTreeSet::new();
        let numbers: BTreeSet<usize> = networks.iter().copied().collect();
        for network in numbers {
            let of = |step: &usize| networks.get(*step) == Some(&network);
            let found = part(net, of).explore(&timed.iter().copied().filter(of).collect());
            self.report_unsound(chart, net, &of, &found);
            together.extend(found.together);
        }
        // Networks go on independently of each other.
        for (at, first) in timed.iter().enumerate() {
            let others = timed.iter().skip(at + 1).filter(|second| networks.get(*first) != networks.get(**second));
            together.extend(others.map(|second| (*first, *second)));
        }
        self.report_time_conflicts(chart, actions, &together);
    }

    /// 2nd ed. B.1.6: each network begins with its initial step, and has no other.
    fn check_initial_steps(&mut self, chart: &Chart, networks: &[usize]) -> bool {
        let mut by_network: BTreeMap<usize, (&ChartStep, Vec<&ChartStep>)> = BTreeMap::new();
        for (step, network) in chart.steps.iter().zip(networks) {
            let entry = by_network.entry(*network).or_insert_with(|| (step, Vec::new()));
            entry.1.extend(step.is_initial.then_some(step));
        }
        let has_any = by_network.values().any(|(_, initial)| !initial.is_empty());
        let mut sound = true;
        for (first, initial) in by_network.values() {
            let found = match initial.as_slice() {
                [_] => continue,
                // A part that hangs on nothing is reported once, as what it is.
                [] if has_any => {
                    let message = format!("step `{}` can never be active: no transition leads to it", first.name.text);
                    let help = "join it to the others by a transition, or begin a network with INITIAL_STEP";
                    Diagnostic::error(Code::UnreachableStep, first.name.span, message).with_help(help)
                }
                [] => {
                    let message = "no step is the initial one";
                    let help = format!("write `INITIAL_STEP {}:`", first.name.text);
                    Diagnostic::error(Code::InitialStep, first.name.span, message).with_help(help)
                }
                [one, second, ..] => {
                    let message = format!("`{}` is a second initial step of this network", second.name.text);
                    let found = Diagnostic::error(Code::InitialStep, second.name.span, message);
                    found.with_label(one.name.span, "the first is this")
                }
            };
            sound = false;
            self.report(found);
        }
        sound
    }

    fn report_unsound(&mut self, chart: &Chart, net: &Net, of: &impl Fn(&usize) -> bool, found: &Explored) {
        // Behind a token too many nothing else is to be trusted.
        if let Some((transition, step)) = found.unsafe_at {
            return self.report_unsafe(chart, transition, step);
        }
        if found.is_cut_off {
            return self.report_cut_off(chart, of);
        }
        if !self.report_unreachable(chart, net, of, found) {
            self.report_dead_end(chart, net, found);
        }
    }

    fn report_unsafe(&mut self, chart: &Chart, transition: usize, step: usize) {
        let (Some(transition), Some(step)) = (chart.transitions.get(transition), chart.steps.get(step)) else { return };
        let message = format!("{} can activate `{}` while it is active", described(transition), step.name.text);
        let found = Diagnostic::error(Code::UnsafeChart, transition.span, message);
        let found = found.with_label(step.name.span, "this step");
        self.report(found.with_help("let all simultaneous sequences end in one transition: FROM (a, b)"));
    }

    /// True if there is something that is never reached.
    fn report_unreachable(&mut self, chart: &Chart, net: &Net, of: &impl Fn(&usize) -> bool, found: &Explored) -> bool {
        let mut unreached = false;
        for (number, step) in chart.steps.iter().enumerate().filter(|(number, _)| of(number)) {
            // What is not reached behind another that is not is not reported.
            let leads_here = |arcs: &&Arcs| arcs.to.contains(&number);
            let mut before = net.transitions.iter().filter(leads_here).flat_map(|arcs| &arcs.from);
            if !found.reached.contains(&number) && !before.any(|from| !found.reached.contains(from)) {
                let message = format!("step `{}` can never be active", step.name.text);
                self.report(Diagnostic::error(Code::UnreachableStep, step.name.span, message));
                unreached = true;
            }
        }
        for (number, (transition, arcs)) in chart.transitions.iter().zip(&net.transitions).enumerate() {
            let here = arcs.from.first().is_some_and(of);
            if here && !found.enabled.contains(&number) && arcs.from.iter().all(|step| found.reached.contains(step)) {
                let message = format!("{} can never be enabled", described(transition));
                let found = Diagnostic::error(Code::UnreachableTransition, transition.span, message);
                self.report(found.with_help("the steps before it are never active together"));
                unreached = true;
            }
        }
        unreached
    }

    fn report_cut_off(&mut self, chart: &Chart, of: &impl Fn(&usize) -> bool) {
        let initial = chart.steps.iter().enumerate().find(|(number, step)| of(number) && step.is_initial);
        if let Some((_, step)) = initial {
            let message = format!("this network has more than {MAX_SITUATIONS} situations: it is not known to be safe");
            let found = Diagnostic::warning(Code::UnsafeChart, step.name.span, message);
            self.report(found.with_help("split it into units of their own"));
        }
    }

    /// A network of one step alone is meant to stand still.
    fn report_dead_end(&mut self, chart: &Chart, net: &Net, found: &Explored) {
        let Some(dead) = found.dead.as_ref().filter(|_| found.reached.len() > 1) else { return };
        let names: Vec<_> = dead.iter().filter_map(|step| chart.steps.get(*step)).map(|step| &step.name).collect();
        let Some(first) = names.first() else { return };
        let last = |step: &usize| !net.transitions.iter().any(|arcs| arcs.from.contains(step));
        let end = dead.iter().find(|step| last(step)).and_then(|step| chart.steps.get(*step));
        let (span, message) = if let Some(step) = end {
            (step.name.span, format!("no transition leads on from `{}`", step.name.text))
        } else {
            let names: Vec<_> = names.iter().map(|name| format!("`{}`", name.text)).collect();
            (first.span, format!("the network comes to a halt while {} are active", names.join(", ")))
        };
        self.report(Diagnostic::warning(Code::DeadEnd, span, message));
    }

    /// 2nd ed. 2.6.4.5: an action has one time only.
    fn report_time_conflicts(&mut self, chart: &Chart, actions: &[Action], together: &BTreeSet<(usize, usize)>) {
        for action in actions {
            let timed: Vec<_> = action.uses.iter().filter(|used| used.qualifier.is_timed()).collect();
            for (at, second) in timed.iter().enumerate() {
                let conflicts = |first: &&&Use| {
                    let pair = (first.step.min(second.step), first.step.max(second.step));
                    pair.0 == pair.1 || together.contains(&pair)
                };
                let Some(first) = timed.iter().take(at).find(conflicts) else { continue };
                let name = |step: usize| chart.steps.get(step).map_or("", |step| step.name.text.as_str());
                let message = if first.step == second.step {
                    format!("step `{}` gives `{}` two times", name(first.step), action.name)
                } else {
                    let (one, other) = (name(first.step), name(second.step));
                    format!("`{one}` and `{other}` can be active together, and both give `{}` a time", action.name)
                };
                let found = Diagnostic::error(Code::TimeConflict, second.span, message);
                self.report(found.with_label(first.span, "the first of them"));
            }
        }
    }
}

/// The steps that give some action a time.
fn timed_steps(actions: &[Action]) -> BTreeSet<usize> {
    let uses = actions.iter().flat_map(|action| &action.uses);
    uses.filter(|used| used.qualifier.is_timed()).map(|used| used.step).collect()
}

/// The net with the initial steps and transitions of one network alone.
fn part(net: &Net, of: impl Fn(&usize) -> bool) -> Net {
    let transitions = net.transitions.iter().map(|arcs| {
        // A transition of another network keeps its number, and is never enabled.
        if arcs.from.first().is_some_and(&of) { arcs.clone() } else { Arcs::default() }
    });
    let initial = net.initial.iter().copied().filter(&of).collect();
    Net { steps: net.steps, initial, transitions: transitions.collect() }
}

fn described(transition: &Transition) -> String {
    match &transition.name {
        Some(name) => format!("transition `{}`", name.text),
        None => "this transition".to_owned(),
    }
}
