//! Action control and the actions themselves (2nd ed. 2.6.4.5, 3rd ed. 6.7.4.6).

use super::association::{Action, Runs};
use super::pulse::Before;
use crate::check::body::Body;
use crate::check::body::call::argument::Passing;
use crate::check::declare::Role;
use crate::check::types::build::{assign, joined, load, not, operation, when};
use crate::ir::{Binary, Expr, Place, PouId, Statement, StatementKind, Type};
use crate::syntax::Span;
use crate::syntax::ast::{ActionQualifier, Chart};

impl Body<'_, '_> {
    /// All controls, then what they let run.
    pub(super) fn action_control(
        &mut self,
        chart: &Chart,
        actions: &[Action],
        before: Option<&Before>,
    ) -> Vec<Statement> {
        let Some(quiet) = self.quiet() else { return Vec::new() };
        let mut statements = Vec::new();
        for action in actions {
            statements.extend(self.control_of(chart, action, before, quiet).into_iter().flatten());
        }
        for is_flagged in [false, true] {
            for action in actions {
                statements.extend(self.run(action, is_flagged, quiet));
            }
        }
        statements
    }

    /// The inputs of an action's control, its call, and what becomes of a Boolean action.
    fn control_of(
        &mut self,
        chart: &Chart,
        action: &Action,
        before: Option<&Before>,
        quiet: Span,
    ) -> Option<Vec<Statement>> {
        let mut flags = Vec::new();
        for used in &action.uses {
            let step = self.chart_place(&chart.steps.get(used.step)?.name.key(), quiet)?;
            flags.push(self.chart_member(&step, "X")?);
        }
        let mut statements = Vec::new();
        let common = ActionQualifier::ALL.into_iter().filter(|each| before.is_none() || !each.is_pulse());
        for qualifier in common {
            let by = action.uses.iter().zip(&flags).filter(|(used, _)| used.qualifier == qualifier);
            if let Some(any) = joined(Binary::Or, by.map(|(_, flag)| load(flag))) {
                statements.push(assign(&self.chart_member(&action.control, qualifier.text())?, any));
            }
        }
        if let Some(before) = before {
            statements.extend(self.pulse_of_step(action, &flags, before, quiet)?);
        }
        let time = self.chart_member(&action.control, "T")?;
        for (used, flag) in action.uses.iter().zip(&flags) {
            if let Some(value) = used.time.clone() {
                statements.push(when(load(flag), vec![assign(&time, value)], quiet));
            }
        }
        statements.push(self.control_call(&action.control, quiet)?);
        if let Runs::Variable(variable) = &action.runs {
            let flag = load(&self.chart_member(&action.control, "Q")?);
            statements.push(assign(&Place { span: quiet, ..variable.clone() }, flag));
        }
        Some(statements)
    }

    fn control_call(&mut self, control: &Place, quiet: Span) -> Option<Statement> {
        let Type::FunctionBlock { pou, .. } = self.declarations.types().get(control.ty) else { return None };
        let pou: PouId = *pou;
        Some(self.bare_call(control.clone(), pou, quiet))
    }

    /// The action's statements, where its flag is as it should be.
    fn run(&mut self, action: &Action, is_flagged: bool, quiet: Span) -> Option<Statement> {
        let Runs::Statements(member) = action.runs else { return None };
        let call = self.action_call(action, member)?;
        let flag = load(&self.chart_member(&action.control, "Q")?);
        let condition = if is_flagged {
            flag
        } else {
            operation(Binary::And, load(&self.chart_member(&action.control, "A")?), not(flag))
        };
        Some(when(condition, vec![call], quiet))
    }

    /// It stands for the association, where there is one only, else for the action.
    fn action_call(&mut self, action: &Action, member: PouId) -> Option<Statement> {
        let span = match action.uses.as_slice() {
            [only] => only.span,
            _ => self.declarations.pou(member).ast().name.span,
        };
        let class = self.own_class()?;
        let object = self.this_object(class, span);
        let call: Expr = self.on_object(object, Role::Method, member, Vec::new(), Passing::default(), span)?;
        Some(Statement { kind: StatementKind::Evaluate(call), span })
    }
}
