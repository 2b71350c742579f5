//! Instances' own direct addresses: `VAR_CONFIG` completes what is declared `AT %I*`
//! (2nd ed. 2.4.3.1, 2.7.1; 3rd ed. 6.5.5.4).
//!
//! Code is the same for all instances, so such a variable lies in its instance. What the machine gives
//! is copied there before the program runs, what it wants is copied from there afterwards.

use super::Configurer;
use super::connections::{Around, loaded, place};
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Expr, ExprKind, Place, Storage, Target};
use crate::syntax::Span;
use crate::syntax::ast::Ident;
use crate::syntax::direct_address::{Area, DirectAddress};

/// A variable of an instance and its direct address.
pub(super) struct InstanceLocation {
    target: Target,
    area: Area,
    storage: Storage,
    span: Span,
}

impl Configurer<'_, '_> {
    /// Gives a variable of an instance its address.
    pub(super) fn locate(&mut self, target: &Target, address: &Ident) -> Option<()> {
        let Some(open) = target.open else {
            let message = format!("`{}` is not declared with an open address, as in AT %I*", target.path);
            let found = Diagnostic::error(Code::UnsuitableAddress, address.span, message);
            let declared = target.variable.as_ref().map(|variable| variable.span);
            self.declarations
                .report(declared.into_iter().fold(found, |found, span| found.with_label(span, "declared here")));
            return None;
        };
        let storage = Body::outside(self.declarations).direct_place(&address.text, address.span)?.into_place().storage;
        let wanted = DirectAddress::parse(&address.text).ok()?;
        if wanted.area != open {
            let message = format!("`{}` is declared in another area", target.path);
            self.declarations.report(Diagnostic::error(Code::UnsuitableAddress, address.span, message));
            return None;
        }
        self.declarations.require_width(wanted.width, target.ty, address)?;
        let Storage::Located(location) = storage else { return None };
        self.declarations.use_area(location, self.declarations.types().size(target.ty));
        let (target, area, span) = (target.clone(), wanted.area, address.span);
        self.configured.locations.push(InstanceLocation { target, area, storage, span });
        Some(())
    }

    /// Copies between the addresses and the variables of a program's instance.
    pub(super) fn copy_locations(&mut self, program: usize, around: &mut Around) {
        let Some(program) = self.declarations.programs().get(program) else { return };
        let range = program.offset..program.offset + self.declarations.pou(program.pou).instance().0;
        let locations = std::mem::take(&mut self.configured.locations);
        for InstanceLocation { target, area, storage, span } in &locations {
            if !range.contains(&target.inside) {
                continue;
            }
            let there = Place::whole(*storage, target.ty, *span);
            let body = Body::outside(self.declarations);
            if *area != Area::Output {
                let value = Expr { kind: ExprKind::Load(there.clone()), ty: target.ty, span: *span };
                around.before.statements.push(body.assignment(place(target, *span), value, *span));
            }
            if *area != Area::Input {
                around.after.statements.push(body.assignment(there, loaded(target, *span), *span));
            }
        }
        self.configured.locations = locations;
    }
}
