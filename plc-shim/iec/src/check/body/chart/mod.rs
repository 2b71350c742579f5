//! Sequential Function Charts (2nd ed. 2.6, 3rd ed. 6.7): from steps and transitions to statements.
//!
//! | module | subject |
//! |---|---|
//! | [`state`] | what a unit keeps for its steps, transitions and actions |
//! | [`links`] | the steps that transitions name |
//! | [`association`] | the actions that steps name: qualifiers, times, indicators |
//! | [`net`] | the situations that a chart can come to |
//! | [`soundness`] | charts that are unsafe, unreachable or come to an end |
//! | [`evolution`] | which transitions are cleared, and what becomes active |
//! | [`pulse`] | the edges that give actions their pulses, and which are lost |
//! | [`action`] | action control, and when actions run |
//!
//! A scan of a unit with a chart:
//! 1. `T` of each active step becomes the time since its activation.
//! 2. Transitions whose steps before them are all active are tested, those with a priority first, by
//!    their rank, then the others as they are written: one that is cleared takes its steps away from
//!    those behind it. In the first scan nothing is tested, so that the actions of the initial steps run
//!    before anything else (2nd ed. 2.6.5).
//! 3. The steps before all cleared transitions are deactivated, then those behind them activated: one
//!    evolution in a scan. A step that is both restarts.
//! 4. The action control of each action sees the steps that are active now. Actions have the order in
//!    which the steps name them first. A Boolean action takes the value of its flag `Q`.
//! 5. Actions run whose flag is FALSE: those of `P0` and `P1`, and the final scan of those that end. Then
//!    those run whose flag is TRUE.
//!
//! A chart may also be the body of an action (2nd ed. Table 42, feature 4). It goes on whenever that action runs, by
//! its control or called by its name, its final scan included, and stands still in between: its steps keep what they
//! are, and `T` of an active one counts from its activation all the same. An action has one chart that controls it.

pub(super) mod action;
pub(super) mod association;
pub(super) mod evolution;
pub(super) mod links;
pub(super) mod net;
pub(super) mod pulse;
pub(super) mod soundness;

use super::Body;
use crate::check::declare::chart::{STEP_TYPE, keeps_charts};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Place, Statement, Type};
use crate::syntax::Span;
use crate::syntax::ast::{self, PouKind, StatementKind};

impl Body<'_, '_> {
    /// What a unit's chart does in each scan; nothing where it is not a chart.
    pub(in crate::check) fn chart(&mut self, ast: &ast::Pou) -> Vec<Statement> {
        let Some(first) = ast.chart.span() else { return Vec::new() };
        let owner = if ast.kind == PouKind::Action { self.own_class() } else { None };
        if !keeps_charts(owner.map_or(ast.kind, |owner| self.declarations.pou(owner).ast().kind)) {
            let message = "a chart is the body of a PROGRAM or FUNCTION_BLOCK, or of an action of one: nothing else \
                           keeps its steps";
            self.report(Diagnostic::error(Code::MisplacedChart, first, message));
            return Vec::new();
        }
        let stray = ast.body.iter().find(|each| !matches!(each.kind, StatementKind::Empty | StatementKind::Error));
        if let Some(stray) = stray {
            let message = "a unit is a chart as a whole, or not at all";
            let message =
                if ast.kind == PouKind::Action { "an action is a chart as a whole, or not at all" } else { message };
            let found = Diagnostic::error(Code::MixedBody, stray.span, message).with_label(first, "the chart");
            self.report(found.with_help("write the statements as an action of a step that is always active"));
        }
        self.name_parts(ast);
        let links = self.links(&ast.chart);
        let actions = self.controlled_actions(&ast.chart);
        if links.are_whole {
            self.check_soundness(&ast.chart, &links.net, &actions);
        }
        self.report_lost_pulses(&ast.chart, &links.net, &actions);
        let before = self.quiet().and_then(|quiet| self.before(&ast.chart, &actions, quiet));
        let mut statements = self.evolution(ast, &links.net, before.as_ref());
        statements.extend(self.action_control(&ast.chart, &actions, before.as_ref()));
        statements
    }

    /// What a fault says of where it is; an action is a unit with a name of its own.
    fn name_parts(&mut self, ast: &ast::Pou) {
        let steps = ast.chart.steps.iter().map(|step| (step.span, format!("step `{}`", step.name.text)));
        self.declarations.note_chart_parts(steps);
        for transition in &ast.chart.transitions {
            let list =
                |steps: &[ast::Ident]| steps.iter().map(|step| step.text.as_str()).collect::<Vec<_>>().join(", ");
            let named = match &transition.name {
                Some(name) => format!("transition `{}`", name.text),
                None => format!("transition from {} to {}", list(&transition.from), list(&transition.to)),
            };
            self.declarations.note_chart_parts([(transition.span, named)]);
        }
    }

    /// A place in the library, where nothing is covered or reported.
    fn quiet(&self) -> Option<Span> {
        self.declarations.type_span(STEP_TYPE)
    }

    /// A variable of the chart's own.
    fn chart_place(&self, key: &str, span: Span) -> Option<Place> {
        let variable = self.scope.find(key)?;
        variable.of_chart.then(|| Place::whole(variable.storage, variable.ty, span))
    }

    /// A member of a step or an action control.
    fn chart_member(&self, of: &Place, name: &str) -> Option<Place> {
        let (offset, ty) = match self.declarations.types().get(of.ty) {
            Type::Struct { fields, .. } => {
                let field = fields.iter().find(|field| field.name == name)?;
                (field.offset, field.ty)
            }
            Type::FunctionBlock { pou, .. } => {
                let scope = self.declarations.pou(*pou).scope()?;
                let variable = scope.own(&name.to_ascii_uppercase())?;
                let crate::ir::Storage::Instance(offset) = variable.storage else { return None };
                (offset, variable.ty)
            }
            _ => return None,
        };
        Some(of.clone().member(offset, ty))
    }
}
