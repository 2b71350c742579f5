//! The arguments that calls give to what nobody declares.

use super::collect::{Collector, Scope};
use super::foreign::{self, Signature};
use super::names::Access;
use super::ty::Ty;
use crate::syntax::ast::{Argument, Expr, ExprKind};

impl<'a> Collector<'a> {
    pub(super) fn arguments(&mut self, signature: &mut Signature, path: &str, list: &[Argument], scope: &Scope<'a>) {
        // Names and places may be mixed: what has no name is counted with what has.
        let inputs = list.iter().filter(|argument| !matches!(argument, Argument::Output { .. })).count();
        signature.fewest = Some(signature.fewest.map_or(inputs, |known| known.min(inputs)));
        let mut given = 0;
        let mut nameless = 0;
        for argument in list {
            let position = given;
            given += usize::from(!matches!(argument, Argument::Output { .. }));
            match argument {
                Argument::Positional(value) => {
                    nameless = position + 1;
                    let found = self.infer(value, scope);
                    let is_place = is_place(value);
                    while signature.positional.len() <= position {
                        let slot = self.slots.of(&format!("{path}.p{}", signature.positional.len() + 1));
                        signature.positional.push(foreign::Argument { slot, is_place: true });
                    }
                    if let Some(parameter) = signature.positional.get_mut(position) {
                        parameter.is_place &= is_place;
                        let slot = parameter.slot;
                        self.flow(&found, &Ty::Slot(slot));
                    }
                }
                Argument::Input(name, value) => {
                    let found = self.infer(value, scope);
                    let slot = self.slots.of(&format!("{path}.{}", name.text));
                    let is_place = is_place(value);
                    let known = signature.named.iter_mut().find(|known| known.name.eq_ignore_ascii_case(&name.text));
                    if let Some(known) = known {
                        known.argument.is_place &= is_place;
                        known.behind = known.behind.max(nameless);
                    } else {
                        let argument = foreign::Argument { slot, is_place };
                        let name = name.text.clone();
                        signature.named.push(foreign::Named { name, argument, behind: nameless });
                    }
                    self.flow(&found, &Ty::Slot(slot));
                }
                Argument::Output { name, target, .. } => {
                    let slot = self.slots.of(&format!("{path}.{}", name.text));
                    if !signature.outputs.iter().any(|(known, _)| known.eq_ignore_ascii_case(&name.text)) {
                        signature.outputs.push((name.text.clone(), slot));
                    }
                    if let Some(target) = target {
                        let target = self.place(target, Access::Write, scope);
                        self.flow(&Ty::Slot(slot), &target);
                    }
                }
            }
        }
    }
}

/// True for what has an address.
fn is_place(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Name(_) | ExprKind::Member(..) | ExprKind::Index(..) | ExprKind::Dereference(_) => true,
        ExprKind::Paren(inner) => is_place(inner),
        _ => false,
    }
}
