//! W0702: an instance that nobody calls does nothing. W0704: one that is not called in every scan
//! misses edges and stops counting time.

use super::Unit;
use super::index::Index;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{Call, Expr, ExprKind, Pou, SectionKind};
use crate::syntax::walk::{self, Visitor, root};

pub(super) fn lint(unit: &Unit<'_>, index: &Index<'_>, findings: &mut Vec<Diagnostic>) {
    never_called(unit, index, findings);
    walk::unit(unit.pou, &mut Branches { pou: unit.pou, index, depth: 0, findings });
}

fn never_called(unit: &Unit<'_>, index: &Index<'_>, findings: &mut Vec<Diagnostic>) {
    let own = |kind| matches!(kind, SectionKind::Local | SectionKind::Temp | SectionKind::Output);
    for variable in unit.pou.sections.iter().filter(|section| own(section.kind)).flat_map(|each| &each.variables) {
        let Some(block) = index.block(&variable.spec) else { continue };
        for name in &variable.names {
            let uses = unit.usage.get(&name.key());
            // What has methods may live by them alone.
            let lives_by_methods = !block.object.members.is_empty() && (block.body.is_empty() || uses.is_read);
            if !lives_by_methods && !uses.is_called && !uses.is_passed {
                let message = format!("`{}` of type {} is never called", name.text, block.name.text);
                let found = Diagnostic::warning(Code::InstanceNeverCalled, name.span, message);
                findings.push(found.with_help(format!("call it once in each scan, as in `{}(...);`", name.text)));
            }
        }
    }
}

/// Looks for calls in branches and loops.
struct Branches<'a, 'f> {
    pou: &'a Pou,
    index: &'a Index<'a>,
    depth: u32,
    findings: &'f mut Vec<Diagnostic>,
}

/// A loop over an array of instances calls each of them.
fn is_indexed(callee: &Expr) -> bool {
    match &callee.kind {
        ExprKind::Index(..) => true,
        ExprKind::Member(inner, _) | ExprKind::Paren(inner) => is_indexed(inner),
        _ => false,
    }
}

impl Visitor for Branches<'_, '_> {
    fn enter(&mut self) {
        self.depth += 1;
    }

    fn leave(&mut self) {
        self.depth -= 1;
    }

    fn call(&mut self, call: &Call) {
        if self.depth == 0 || is_indexed(&call.callee) || !matches!(call.callee.kind, ExprKind::Name(_)) {
            return;
        }
        let Some(name) = root(&call.callee) else { return };
        let variable = self.index.declared(self.pou, &name.key()).map(|(_, variable)| variable);
        let Some(variable) = variable.or_else(|| self.index.global(&name.key())) else { return };
        let Some(block) = self.index.block(&variable.spec) else { return };
        if self.index.needs_every_scan(block) {
            let message = format!("`{}` of type {} is not called in every scan", name.text, block.name.text);
            let found = Diagnostic::warning(Code::CallInBranch, name.span, message);
            let help = "call it outside of branches and loops, and put the condition into its inputs";
            self.findings.push(found.with_help(help));
        }
    }
}
