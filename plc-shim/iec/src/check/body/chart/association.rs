//! The actions that steps name, with qualifier, time and indicators (2nd ed. 2.6.4, 3rd ed. 6.7.4).

use crate::check::body::Body;
use crate::check::declare::chart::control_key;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{ElementaryType, Expr, Place, PouId};
use crate::syntax::Span;
use crate::syntax::ast::{self, ActionQualifier, Association, Chart, PouKind};

/// An action and the steps that control it.
pub(in crate::check) struct Action {
    pub(super) name: String,
    pub(super) runs: Runs,
    /// The instance of its action control.
    pub(in crate::check::body) control: Place,
    pub(super) uses: Vec<Use>,
}

/// What an action does.
#[derive(Clone)]
pub(super) enum Runs {
    Statements(PouId),
    /// It sets a Boolean variable.
    Variable(Place),
}

pub(super) struct Use {
    pub(in crate::check::body) step: usize,
    pub(in crate::check::body) qualifier: ActionQualifier,
    pub(in crate::check::body) time: Option<Expr>,
    pub(super) span: Span,
}

impl Body<'_, '_> {
    /// All actions in the order in which the steps name them first.
    pub(super) fn controlled_actions(&mut self, chart: &Chart) -> Vec<Action> {
        let mut actions: Vec<Action> = Vec::new();
        let mut unknown: Vec<String> = Vec::new();
        for (step, association) in
            chart.steps.iter().enumerate().flat_map(|(at, step)| step.associations.iter().map(move |each| (at, each)))
        {
            let key = association.action.key();
            let time = self.time(association);
            association.indicators.iter().for_each(|indicator| self.check_indicator(indicator));
            let qualifier = association.effective_qualifier();
            let found = Use { step, qualifier, time, span: association.span };
            if let Some(action) = actions.iter_mut().find(|action| action.name.eq_ignore_ascii_case(&key)) {
                action.uses.push(found);
            } else if !unknown.contains(&key) {
                match self.action(association) {
                    Some((runs, control)) => {
                        let name = association.action.text.clone();
                        actions.push(Action { name, runs, control, uses: vec![found] });
                    }
                    None => unknown.push(key),
                }
            }
        }
        actions
    }

    fn action(&mut self, association: &Association) -> Option<(Runs, Place)> {
        let name = &association.action;
        let class = self.own_class()?;
        let member = self.declarations.methods_named(class, &name.text).first().copied();
        let runs = match member.filter(|id| self.declarations.pou(*id).ast().kind == PouKind::Action) {
            Some(id) => Runs::Statements(id),
            None => Runs::Variable(self.boolean_action(association)?),
        };
        let control = self.chart_place(&control_key(&name.key()), self.quiet()?)?;
        Some((runs, control))
    }

    /// A variable of type BOOL that the chart may write (2nd ed. 2.6.4.1).
    fn boolean_action(&mut self, association: &Association) -> Option<Place> {
        let name = &association.action;
        if !self.scope.declares(&name.key()) && self.declarations.global_key(&name.key()).is_none() {
            let class = self.own_class().filter(|class| !self.declarations.may_inherit(*class))?;
            let members = self.declarations.member_names(class);
            let variables = self.scope.variables().iter().filter(|each| each.ty == ElementaryType::Bool.into());
            let names = variables.filter(|each| !each.of_chart).map(|each| each.name.as_str());
            let help = did_you_mean(&name.text, names.chain(members.iter().map(String::as_str)));
            let message = format!("there is no action and no BOOL variable `{}`", name.text);
            let found = Diagnostic::error(Code::UnknownAction, name.span, message);
            self.report(found.with_optional_help(help));
            return None;
        }
        let expr = ast::Expr { kind: ast::ExprKind::Name(name.clone()), span: name.span, height: 1 };
        let place = self.target(&expr)?;
        if self.elementary(place.ty) == Some(ElementaryType::Bool) {
            return Some(place);
        }
        let message =
            format!("an action is a BOOL variable or an ACTION, `{}` is {}", name.text, self.type_name(place.ty));
        self.report(Diagnostic::error(Code::UnknownAction, name.span, message));
        None
    }

    /// The time, if the qualifier is one that has it (2nd ed. Table 45).
    fn time(&mut self, association: &Association) -> Option<Expr> {
        let qualifier = association.effective_qualifier();
        match (&association.time, qualifier.is_timed()) {
            (Some(time), true) => return self.expression_of(time, ElementaryType::Time),
            (None, true) => {
                let message = format!("`{}` needs a time", qualifier.text());
                let help = format!("write `{}({}, T#1s)`", association.action.text, qualifier.text());
                let found = Diagnostic::error(Code::ActionTime, association.span, message);
                self.report(found.with_help(help));
            }
            (Some(time), false) => {
                let message = format!("`{}` has no time", qualifier.text());
                let found = Diagnostic::error(Code::ActionTime, time.span, message);
                self.report(found.with_help("L, D, SD, DS and SL have one"));
            }
            (None, false) => {}
        }
        None
    }

    /// What an action reports of itself it writes itself; here it must only be a BOOL.
    fn check_indicator(&mut self, indicator: &ast::Expr) {
        if let Some(place) = self.target(indicator)
            && self.elementary(place.ty) != Some(ElementaryType::Bool)
        {
            let found = self.type_name(place.ty);
            self.mismatch::<()>("an indicator of type BOOL", &found, indicator.span);
        }
    }
}
