//! W0705: statements behind RETURN, EXIT or CONTINUE.

use super::Unit;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{Instruction, Statement, StatementKind, When};

pub(super) fn lint(unit: &Unit<'_>, findings: &mut Vec<Diagnostic>) {
    list_ends(&unit.pou.body, findings);
}

/// True if nothing behind the list is reached; reports what is not reached inside of it.
fn list_ends(list: &[Statement], findings: &mut Vec<Diagnostic>) -> bool {
    let mut ended = false;
    for statement in list.iter().filter(|each| !matches!(each.kind, StatementKind::Empty)) {
        if ended && !matches!(statement.kind, StatementKind::Label(_)) {
            let message = "this is never reached";
            findings.push(Diagnostic::warning(Code::UnreachableCode, statement.span, message));
            return true;
        }
        // A jump may lead to a label; where there are some, the lists before them are not judged.
        ended = ends(&statement.kind, findings);
    }
    ended
}

fn ends(kind: &StatementKind, findings: &mut Vec<Diagnostic>) -> bool {
    match kind {
        StatementKind::Instruction(inner) => {
            matches!(**inner, Instruction::Jump(When::Always, _) | Instruction::Return(When::Always))
        }
        StatementKind::Exit | StatementKind::Continue | StatementKind::Return | StatementKind::Jump(_) => true,
        StatementKind::If(inner) => {
            let mut all = true;
            for branch in &inner.branches {
                all &= list_ends(&branch.body, findings);
            }
            list_ends(&inner.otherwise, findings) && all
        }
        StatementKind::Case(inner) => {
            let mut all = true;
            for branch in &inner.branches {
                all &= list_ends(&branch.body, findings);
            }
            list_ends(&inner.otherwise, findings) && all
        }
        // A loop may be left by EXIT or not be entered: what is behind it is reached.
        StatementKind::For(inner) => {
            list_ends(&inner.body, findings);
            false
        }
        StatementKind::While(inner) => {
            list_ends(&inner.body, findings);
            false
        }
        StatementKind::Repeat(inner) => {
            list_ends(&inner.body, findings);
            false
        }
        StatementKind::Try(inner) => {
            let ends = list_ends(&inner.body, findings);
            list_ends(&inner.handler, findings);
            list_ends(&inner.finally, findings);
            // What is done in any case is done behind a RETURN as well.
            ends && inner.finally.is_empty()
        }
        _ => false,
    }
}
