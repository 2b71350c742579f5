//! What a start adds to a variable's bytes, as its declaration says it.

use super::Written;
use crate::check::declare::{Start, StartKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::Span;

/// Why a constant may begin with nothing else.
pub(super) const OF_CONSTANTS: &str = "a CONSTANT is one before the program runs";
/// Why a variable with a direct address may not.
pub(super) const OF_LOCATED: &str = "a variable with a direct address begins with its bytes";

impl<'a> Written<'_, 'a> {
    /// What is done in one of the unit's own variables belongs to its text; all else to where it stands.
    pub(in crate::check) fn start(&self, offset: u32, kind: StartKind<'a>, span: Span) -> Start<'a> {
        let home = self.body.unit().is_none().then(|| self.declarations().home().clone());
        Start { offset, kind, span, home, within: None }
    }

    /// Reports a variable that may begin with a constant only.
    pub(super) fn require_constant(&mut self, starts: &[Start<'a>], why: &str) {
        let is_computed = |start: &&Start<'a>| matches!(start.kind, StartKind::Value(..) | StartKind::Later(..));
        if let Some(start) = starts.iter().find(is_computed) {
            let message = format!("a constant is wanted here: {why}");
            self.report(Diagnostic::error(Code::NotConstant, start.span, message));
        }
    }
}
