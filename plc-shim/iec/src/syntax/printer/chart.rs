//! Steps and transitions to text.

use super::Printer;
use crate::syntax::ast::{Association, Chart, ChartStep, Ident, Transition, TransitionCondition};

impl Printer {
    pub(super) fn chart(&mut self, chart: &Chart) {
        for step in &chart.steps {
            self.step(step);
        }
        for transition in &chart.transitions {
            self.transition(transition);
        }
    }

    fn step(&mut self, step: &ChartStep) {
        self.begin_line();
        self.word(if step.is_initial { "INITIAL_STEP " } else { "STEP " });
        self.name(&step.name);
        self.word(":");
        self.end_line();
        self.indented(|printer| step.associations.iter().for_each(|each| printer.association(each)));
        self.line("END_STEP");
    }

    fn association(&mut self, association: &Association) {
        self.begin_line();
        self.name(&association.action);
        self.word("(");
        self.word(association.qualifier.map_or("", |qualifier| qualifier.text()));
        for value in association.time.iter().chain(&association.indicators) {
            self.word(", ");
            self.expression(value);
        }
        self.word(");");
        self.end_line();
    }

    fn transition(&mut self, transition: &Transition) {
        self.begin_line();
        self.word("TRANSITION ");
        if let Some(name) = &transition.name {
            self.name(name);
            self.word(" ");
        }
        if let Some(priority) = transition.priority {
            self.word(&format!("(PRIORITY := {}) ", priority.rank));
        }
        self.word("FROM ");
        self.step_names(&transition.from);
        self.word(" TO ");
        self.step_names(&transition.to);
        match &transition.condition {
            TransitionCondition::Expression(condition) => {
                self.word(" := ");
                self.expression(condition);
                self.word(";");
                self.end_line();
            }
            TransitionCondition::Network(statements) => {
                self.word(" :");
                self.end_line();
                self.statements(statements);
            }
        }
        self.line("END_TRANSITION");
    }

    fn step_names(&mut self, names: &[Ident]) {
        match names {
            [only] => self.name(only),
            several => {
                self.word("(");
                self.separated(several, Self::name);
                self.word(")");
            }
        }
    }
}
