//! One evolution in a scan (2nd ed. 2.6.5, 3rd ed. 6.7.6).

use super::net::Net;
use super::pulse::Before;
use crate::check::body::Body;
use crate::check::declare::VIRTUAL_TIME_OFFSET;
use crate::check::declare::chart::begun_key;
use crate::check::types::build::{assign, joined, load, operation, truth, when};
use crate::ir::{Binary, ElementaryType, Expr, IfBranch, Place, Statement, StatementKind, Storage, Value};
use crate::syntax::Span;
use crate::syntax::ast::{Pou, Transition, TransitionCondition};

/// The places that a step's state is made of.
struct StepState {
    flag: Place,
    time: Place,
    since: Place,
    /// Whether it was active before the evolution, and no transition has taken it.
    token: Place,
    span: Span,
}

/// A transition while it is tested.
struct Test<'t> {
    ast: &'t Transition,
    cleared: Place,
    from: Vec<usize>,
    to: Vec<usize>,
}

impl Body<'_, '_> {
    pub(super) fn evolution(&mut self, pou: &Pou, net: &Net, before: Option<&Before>) -> Vec<Statement> {
        let chart = &pou.chart;
        let Some(quiet) = self.quiet() else { return Vec::new() };
        let states: Vec<Option<StepState>> = chart.steps.iter().map(|step| self.step_state(step, quiet)).collect();
        let states: Option<Vec<StepState>> = states.into_iter().collect();
        let mut tests = Vec::new();
        for (ast, arcs) in chart.transitions.iter().zip(&net.transitions) {
            let cleared = self.flag_register(quiet);
            tests.push(Test { ast, cleared, from: arcs.from.clone(), to: arcs.to.clone() });
        }
        tests.sort_by_key(|test| test.ast.priority.map_or(u64::from(u32::MAX) + 1, |priority| priority.rank.into()));
        // Conditions are checked even where a step is wrong.
        let conditions: Vec<_> = tests.iter().map(|test| self.tested(test, quiet)).collect();
        let (Some(states), Some(begun)) = (states, self.chart_place(&begun_key(pou), quiet)) else { return Vec::new() };
        let mut evolve = Vec::new();
        for (step, state) in states.iter().enumerate() {
            evolve.extend(before.and_then(|before| before.of(step)).map(|flag| assign(flag, load(&state.flag))));
            evolve.push(assign(&state.token, load(&state.flag)));
            evolve.push(when(load(&state.flag), vec![assign(&state.time, elapsed(state, quiet))], quiet));
        }
        for (test, (network, condition)) in tests.iter().zip(conditions) {
            evolve.extend(clearing(test, network, condition, &states, quiet));
        }
        evolve.extend(tests.iter().map(|test| deactivation(test, &states, quiet)));
        evolve.extend(tests.iter().map(|test| {
            let activated = test.to.iter().filter_map(|step| states.get(*step));
            when(load(&test.cleared), activated.flat_map(|state| activation(state, quiet)).collect(), quiet)
        }));
        for test in &tests {
            let name = test.ast.name.as_ref().and_then(|name| self.chart_place(&name.key(), quiet));
            evolve.extend(name.map(|name| assign(&name, load(&test.cleared))));
        }
        let initial = chart.steps.iter().zip(&states).filter(|(step, _)| step.is_initial);
        let mut first: Vec<Statement> = initial.flat_map(|(_, state)| activation(state, quiet)).collect();
        let initial = chart.steps.iter().enumerate().filter(|(_, step)| step.is_initial);
        let initial = initial.filter_map(|(step, _)| before.and_then(|before| before.of(step)));
        first.extend(initial.map(|flag| assign(flag, truth(true, quiet))));
        first.push(assign(&begun, truth(true, quiet)));
        let branch = IfBranch { condition: load(&begun), body: evolve };
        vec![Statement { kind: StatementKind::If(vec![branch], first), span: quiet }]
    }

    fn step_state(&mut self, step: &crate::syntax::ast::ChartStep, quiet: Span) -> Option<StepState> {
        let whole = self.chart_place(&step.name.key(), quiet)?;
        Some(StepState {
            flag: self.chart_member(&whole, "X")?,
            time: self.chart_member(&whole, "T")?,
            since: self.chart_member(&whole, "since")?,
            token: self.flag_register(quiet),
            span: step.span,
        })
    }

    fn flag_register(&mut self, span: Span) -> Place {
        let register = self.scope.register(ElementaryType::Bool);
        Place::whole(Storage::Register(register), ElementaryType::Bool.into(), span)
    }

    /// The statements of a transition's network, and its condition.
    fn tested(&mut self, test: &Test<'_>, quiet: Span) -> (Vec<Statement>, Option<Expr>) {
        match &test.ast.condition {
            TransitionCondition::Expression(condition) => (Vec::new(), self.condition(condition)),
            TransitionCondition::Network(network) => {
                let Some(name) = test.ast.name.as_ref() else {
                    self.report_nameless_network(test.ast);
                    self.network(network, None);
                    return (Vec::new(), None);
                };
                let Some(result) = self.chart_place(&name.key(), quiet) else { return (Vec::new(), None) };
                let mut statements = vec![assign(&result, truth(false, quiet))];
                statements.extend(self.network(network, Some(&name.key())));
                (statements, Some(load(&result)))
            }
        }
    }

    /// Statements that may assign to the transition of the name.
    fn network(&mut self, list: &[crate::syntax::ast::Statement], name: Option<&str>) -> Vec<Statement> {
        let before = std::mem::replace(&mut self.network, name.map(str::to_owned));
        let statements = self.statements(list);
        self.network = before;
        statements
    }

    /// True for the transition whose network is being checked.
    pub(in crate::check::body) fn is_own_network(&self, key: &str) -> bool {
        self.network.as_deref() == Some(key)
    }

    fn report_nameless_network(&mut self, transition: &Transition) {
        let message = "a transition whose condition is a network needs a name, which the network assigns to";
        let found =
            crate::diagnostic::Diagnostic::error(crate::diagnostic::Code::UnexpectedToken, transition.span, message);
        self.report(found.with_help("write `TRANSITION t FROM ..`, or an expression behind `:=`"));
    }
}

/// `virtual time - since`
fn elapsed(state: &StepState, quiet: Span) -> Expr {
    operation(Binary::Subtract, load(&virtual_time(quiet)), load(&state.since))
}

fn virtual_time(span: Span) -> Place {
    Place::whole(Storage::Absolute(VIRTUAL_TIME_OFFSET), ElementaryType::Time.into(), span)
}

/// Tests a transition that is enabled; where it is cleared it takes the tokens of its steps.
fn clearing(
    test: &Test<'_>,
    mut network: Vec<Statement>,
    condition: Option<Expr>,
    states: &[StepState],
    quiet: Span,
) -> Vec<Statement> {
    let tokens = || test.from.iter().filter_map(|step| states.get(*step)).map(|state| &state.token);
    let (Some(enabled), Some(condition)) = (joined(Binary::And, tokens().map(load)), condition) else {
        return Vec::new();
    };
    let mut cleared = vec![assign(&test.cleared, truth(true, quiet))];
    cleared.extend(tokens().map(|token| assign(token, truth(false, quiet))));
    network.push(when(condition, cleared, test.ast.span));
    vec![assign(&test.cleared, truth(false, quiet)), when(enabled, network, quiet)]
}

fn deactivation(test: &Test<'_>, states: &[StepState], quiet: Span) -> Statement {
    let flags = test.from.iter().filter_map(|step| states.get(*step)).map(|state| &state.flag);
    when(load(&test.cleared), flags.map(|flag| assign(flag, truth(false, quiet))).collect(), quiet)
}

/// `X := TRUE`, which is what the step's own text stands for, and the beginning of its time.
fn activation(state: &StepState, quiet: Span) -> Vec<Statement> {
    let nothing =
        Expr { kind: crate::ir::ExprKind::Constant(Value::Int(0)), ty: ElementaryType::Time.into(), span: quiet };
    let flag = Place { span: state.span, ..state.flag.clone() };
    vec![
        assign(&flag, truth(true, quiet)),
        assign(&state.time, nothing),
        assign(&state.since, load(&virtual_time(quiet))),
    ]
}
