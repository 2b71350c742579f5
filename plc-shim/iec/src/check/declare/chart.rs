//! The variables that a unit keeps for its charts: who keeps them, and under which keys.

use crate::syntax::ast::{self, PouKind};

/// The library's type of a step's state; its text stands for what no text of the user's does.
pub(in crate::check) const STEP_TYPE: &str = "ONESCAN_SFC_STEP";

/// The library's function block of action control.
pub(in crate::check) const CONTROL_TYPE: &str = "ONESCAN_SFC_CONTROL";

/// True for units whose instances keep the state of charts.
pub(in crate::check) fn keeps_charts(kind: PouKind) -> bool {
    matches!(kind, PouKind::Program | PouKind::FunctionBlock)
}

/// Key of the flag that the initial situation of the chart in `pou` has been.
pub(in crate::check) fn begun_key(pou: &ast::Pou) -> String {
    if pou.kind == PouKind::Action { format!("CHART BEGUN {}", pou.name.key()) } else { "CHART BEGUN".to_owned() }
}

/// Key of the variable that controls an action.
pub(in crate::check) fn control_key(action: &str) -> String {
    format!("ACTION {action}")
}
