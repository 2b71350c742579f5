//! Sequential Function Charts (2nd ed. 2.6, 3rd ed. 6.7); the bodies of actions are members of the unit.

use super::{Expr, Ident, Span, Statement};

/// The steps and transitions of a unit, each kind in its order; none where the unit is not a chart.
#[derive(Debug, Clone, Default)]
pub struct Chart {
    /// The steps (2nd ed. 2.6.2).
    pub steps: Vec<ChartStep>,
    /// The transitions (2nd ed. 2.6.3).
    pub transitions: Vec<Transition>,
}

impl Chart {
    /// True if there is neither step nor transition.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty() && self.transitions.is_empty()
    }

    /// Where it begins.
    pub fn span(&self) -> Option<Span> {
        let steps = self.steps.iter().map(|step| step.span);
        steps.chain(self.transitions.iter().map(|transition| transition.span)).min_by_key(|span| span.start)
    }
}

/// `STEP a: Fill(N); END_STEP`
#[derive(Debug, Clone)]
pub struct ChartStep {
    pub is_initial: bool,
    pub name: Ident,
    /// The actions that it controls.
    pub associations: Vec<Association>,
    pub span: Span,
}

/// `Fill(D, T#5s, Full)`: an action block (2nd ed. 2.6.4.2 and 2.6.4.3).
#[derive(Debug, Clone)]
pub struct Association {
    /// An action, or a Boolean variable.
    pub action: Ident,
    /// How it is controlled; without one it is `N`.
    pub qualifier: Option<ActionQualifier>,
    /// The duration of a qualifier that has one.
    pub time: Option<Expr>,
    /// Boolean variables by which the action reports on itself.
    pub indicators: Vec<Expr>,
    pub span: Span,
}

impl Association {
    /// Its qualifier, written or not.
    pub fn effective_qualifier(&self) -> ActionQualifier {
        self.qualifier.unwrap_or(ActionQualifier::N)
    }
}

/// How a step controls an action (2nd ed. Table 45, 3rd ed. Table 57).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ActionQualifier {
    N,
    R,
    S,
    L,
    D,
    P,
    /// Pulse at the falling edge.
    P0,
    /// Pulse at the rising edge.
    P1,
    SD,
    DS,
    SL,
}

impl ActionQualifier {
    pub const ALL: [Self; 11] =
        [Self::N, Self::R, Self::S, Self::L, Self::D, Self::P, Self::P0, Self::P1, Self::SD, Self::DS, Self::SL];

    /// The qualifier that `text` spells in any case.
    pub fn find(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|each| each.text().eq_ignore_ascii_case(text))
    }

    /// Its spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::N => "N",
            Self::R => "R",
            Self::S => "S",
            Self::L => "L",
            Self::D => "D",
            Self::P => "P",
            Self::P0 => "P0",
            Self::P1 => "P1",
            Self::SD => "SD",
            Self::DS => "DS",
            Self::SL => "SL",
        }
    }

    /// True for those that an edge of a step gives, for one scan.
    pub fn is_pulse(self) -> bool {
        matches!(self, Self::P | Self::P0 | Self::P1)
    }

    /// True for those with a duration.
    pub fn is_timed(self) -> bool {
        matches!(self, Self::L | Self::D | Self::SD | Self::DS | Self::SL)
    }
}

/// `TRANSITION t (PRIORITY := 1) FROM a TO (b, c) := x; END_TRANSITION`
#[derive(Debug, Clone)]
pub struct Transition {
    pub name: Option<Ident>,
    /// Its rank among those that leave the same step, 1 the first (2nd ed. Table 46, feature 2b).
    pub priority: Option<Priority>,
    /// The steps that must be active.
    pub from: Vec<Ident>,
    /// The steps that become active.
    pub to: Vec<Ident>,
    /// When it is cleared.
    pub condition: TransitionCondition,
    pub span: Span,
}

#[derive(Debug, Clone, Copy)]
pub struct Priority {
    pub rank: u32,
    pub span: Span,
}

/// The forms of a transition's condition (2nd ed. Table 41).
#[derive(Debug, Clone)]
pub enum TransitionCondition {
    /// `:= x AND y;`
    Expression(Expr),
    /// `: statements`, which assign to the transition's name.
    Network(Vec<Statement>),
}
