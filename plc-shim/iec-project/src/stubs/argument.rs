//! The arguments that calls give to what nobody declares.

use super::collect::{Collector, Scope};
use super::foreign::{self, Signature};
use super::names::Access;
use super::ty::Ty;
use onescan_iec::syntax::ast::{Argument, Expr, ExprKind};

impl<'a> Collector<'a> {
    /// The types of arguments, before what they say of the signature is noted: one of them may be a call of the same
    /// function.
    pub(super) fn given(&mut self, list: &[Argument], scope: &Scope<'a>) -> Vec<Ty> {
        let types = list.iter().map(|argument| match argument {
            Argument::Positional(value) | Argument::Input(_, value) => self.infer(value, scope),
            Argument::Output { target: Some(target), .. } => self.place(target, Access::Write, scope),
            Argument::Output { target: None, .. } => Ty::Unknown,
        });
        types.collect()
    }

    /// Notes what arguments of these types say of a signature.
    pub(super) fn arguments(&mut self, signature: &mut Signature, path: &str, list: &[Argument], types: &[Ty]) {
        let inputs = list.iter().filter(|argument| !matches!(argument, Argument::Output { .. })).count();
        signature.fewest = Some(signature.fewest.map_or(inputs, |known| known.min(inputs)));
        // Names and places may be mixed: what has no name is counted with what has.
        let mut given = 0;
        let mut nameless = 0;
        for (argument, found) in list.iter().zip(types) {
            let position = given;
            given += usize::from(!matches!(argument, Argument::Output { .. }));
            match argument {
                Argument::Positional(value) => {
                    nameless = position + 1;
                    self.nameless(signature, path, position, is_place(value), found);
                }
                Argument::Input(name, value) => {
                    let slot = self.slots.of(&format!("{path}.{}", name.text));
                    let argument = foreign::Argument { slot, is_place: is_place(value) };
                    signature.name(&name.text, argument, nameless);
                    self.flow(found, &Ty::Slot(slot));
                }
                Argument::Output { name, target, .. } => {
                    let slot = self.slots.of(&format!("{path}.{}", name.text));
                    if !signature.outputs.iter().any(|(known, _)| known.eq_ignore_ascii_case(&name.text)) {
                        signature.outputs.push((name.text.clone(), slot));
                    }
                    if target.is_some() {
                        self.flow(&Ty::Slot(slot), found);
                    }
                }
            }
        }
        self.alike(signature);
    }

    /// A parameter is one, be it given with its name or without; what a test expects is what it finds.
    fn alike(&mut self, signature: &Signature) {
        let places = signature.positional.iter().map(|argument| argument.slot);
        let pairs: Vec<_> = signature
            .in_order()
            .iter()
            .map(|(_, argument)| argument.slot)
            .zip(places)
            .filter(|(a, b)| a != b)
            .collect();
        for (named, nameless) in pairs {
            self.beside(&Ty::Slot(named), &Ty::Slot(nameless));
        }
        let slot = |name: &str| {
            let found = signature.named.iter().find(|named| named.name.eq_ignore_ascii_case(name));
            found.map(|named| Ty::Slot(named.argument.slot))
        };
        if let (Some(expected), Some(actual)) = (slot("Expected"), slot("Actual")) {
            self.beside(&expected, &actual);
        }
    }

    fn nameless(&mut self, signature: &mut Signature, path: &str, position: usize, is_place: bool, found: &Ty) {
        while signature.positional.len() <= position {
            let slot = self.slots.of(&format!("{path}.p{}", signature.positional.len() + 1));
            signature.positional.push(foreign::Argument { slot, is_place: true });
        }
        if let Some(parameter) = signature.positional.get_mut(position) {
            parameter.is_place &= is_place;
            let slot = parameter.slot;
            self.flow(found, &Ty::Slot(slot));
        }
    }
}

impl Signature {
    /// Notes an argument with a name, behind so many without.
    fn name(&mut self, name: &str, argument: foreign::Argument, behind: usize) {
        match self.named.iter_mut().find(|known| known.name.eq_ignore_ascii_case(name)) {
            Some(known) => {
                known.argument.is_place &= argument.is_place;
                known.behind = known.behind.max(behind);
            }
            None => self.named.push(foreign::Named { name: name.to_owned(), argument, behind }),
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
