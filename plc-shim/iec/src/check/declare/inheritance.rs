//! What a derived unit must and must not do (3rd ed. 6.6.5.6 to 6.6.7).

use super::Declarations;
use super::class::Role;
use super::hook::{INIT, is_hook};
use crate::check::types::generic::Generic;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{PouId, Variable};
use crate::syntax::ast::{Modifier, PouKind, SectionKind};

impl Declarations<'_> {
    pub(in crate::check) fn check_inheritance(&mut self) {
        let ids: Vec<PouId> = self.classes.keys().copied().collect();
        for id in ids {
            self.check_members(id);
            self.check_hooks(id);
            if self.pou(id).ast.kind.has_instances()
                && !self.is_abstract(id)
                && !self.may_inherit(id)
                && !self.rests_on_stub(id)
            {
                self.check_complete(id);
            }
        }
    }

    /// Each member against what it overrides.
    fn check_members(&mut self, id: PouId) {
        let members: Vec<_> = self.class(id).iter().flat_map(|class| class.members.clone()).collect();
        for ((role, name), member) in members {
            let modifiers = &self.pou(member).ast.object.modifiers;
            let (overrides, own_abstract) =
                (modifiers.contains(&Modifier::Override), modifiers.contains(&Modifier::Abstract));
            let span = self.pou(member).ast.name.span;
            if own_abstract && !self.is_abstract(id) && self.pou(id).ast.kind != PouKind::Interface {
                let message =
                    format!("`{}` has an ABSTRACT method and is not ABSTRACT itself", self.pou(id).ast.name.text);
                self.report(Diagnostic::error(Code::AbstractInstance, span, message));
            }
            let of_base = self.base_of(id).and_then(|base| self.find_member(base, role, &name));
            // What is PRIVATE to the base stays beside it.
            let of_base = of_base.filter(|base| !self.is_private(*base));
            if let Some(base) = of_base {
                self.check_finality(member, base);
            } else if overrides && !self.may_inherit(id) {
                self.report_nothing_overridden(id, member);
            }
            let key = (role, name);
            let above = self.ancestors(id).into_iter();
            if is_hook(&key.1) {
                continue;
            }
            let above = above.filter_map(|each| self.class(each)?.members.get(&key).copied());
            let above: Vec<PouId> = above.filter(|each| !self.is_private(*each)).collect();
            for each in above {
                self.check_signature(member, each);
            }
        }
    }

    fn report_nothing_overridden(&mut self, id: PouId, member: PouId) {
        let name = &self.pou(member).ast.name;
        let alike = self.base_of(id).map_or_else(Vec::new, |base| self.methods_named(base, &name.text));
        let parameters = self.shown_parameters(member);
        let message = format!("no base has a method `{}{parameters}` to override", name.text);
        let found = Diagnostic::error(Code::NothingOverridden, name.span, message);
        let labelled = alike.into_iter().fold(found, |found, method| {
            found.with_label(self.pou(method).ast.name.span, "this one has other parameters")
        });
        self.report(labelled);
    }

    fn check_finality(&mut self, member: PouId, base: PouId) {
        if self.pou(base).ast.object.modifiers.contains(&Modifier::Final) {
            let name = &self.pou(member).ast.name;
            let message = format!("`{}` is FINAL in its base", name.text);
            let found = Diagnostic::error(Code::Finality, name.span, message);
            let label = self.pou(base).ast.name.span;
            self.report(found.with_label(label, "FINAL here"));
        }
    }

    /// Name, type and section of each parameter, and the result, must be the same.
    fn check_signature(&mut self, member: PouId, base: PouId) {
        let (Some(own), Some(above)) = (self.pou(member).scope.clone(), self.pou(base).scope.clone()) else {
            return;
        };
        // With a parameter or result whose declaration is wrong nothing can be compared.
        if [(member, &own), (base, &above)].iter().any(|(id, scope)| scope.has_broken() || self.lacks_result(*id)) {
            return;
        }
        let parameter =
            |each: &&Variable| matches!(each.section, SectionKind::Input | SectionKind::InOut | SectionKind::Output);
        let result = |place: Option<&crate::ir::Place>| place.map(|place| place.ty);
        // An input of type ANY is, inside of its unit, what vendors let be written instead.
        let seen = self.type_names.get("__SYSTEM.ANYTYPE").and_then(|entry| Some(entry.resolved.as_ref()?.ty));
        let seen = |ty| seen.filter(|_| self.generic(ty) == Some(Generic::Any)).unwrap_or(ty);
        let shape = |each: &Variable| (each.section, seen(each.ty), each.name.to_ascii_uppercase());
        let same = own.variables().iter().filter(parameter).map(shape).eq(above
            .variables()
            .iter()
            .filter(parameter)
            .map(shape));
        if same && result(own.result()) == result(above.result()) {
            return;
        }
        let name = &self.pou(member).ast.name;
        let message = format!("`{}` has other parameters or another result than what it overrides", name.text);
        let found = Diagnostic::error(Code::WrongOverride, name.span, message);
        let label = self.pou(base).ast.name.span;
        self.report(found.with_label(label, "overridden here"));
    }

    /// Each prototype of a base or interface needs a method (3rd ed. 6.6.6.4, 6.6.5.8).
    fn check_complete(&mut self, id: PouId) {
        let mut missing = Vec::new();
        for above in self.ancestors(id) {
            for ((role, name), prototype) in self.class(above).iter().flat_map(|class| &class.members) {
                let found = self.find_member(id, *role, name);
                // Each block has one, be it declared or not.
                let is_implicit =
                    name.as_str() == INIT.name && self.dialect(self.pou(id).ast.name.span).has(Feature::InitArguments);
                if is_implicit {
                    continue;
                }
                if self.is_prototype(*prototype) && found.is_none_or(|found| self.is_prototype(found)) {
                    missing.push((*role, *prototype));
                }
            }
        }
        missing.sort_by_key(|(role, prototype)| (*prototype, *role));
        for (role, prototype) in missing {
            let (unit, wanted) = (&self.pou(id).ast.name, &self.pou(prototype).ast.name);
            let what = match role {
                Role::Getter => "GET of the property",
                Role::Setter => "SET of the property",
                Role::Body | Role::Method | Role::Start | Role::AfterStart | Role::End => "the method",
            };
            let owner = &self.pou(self.owner_of(prototype)).ast.name.text;
            let parameters = self.shown_parameters(prototype);
            let message = format!("`{}` lacks {what} `{}{parameters}` of `{owner}`", unit.text, wanted.text);
            let found = Diagnostic::error(Code::MissingMethod, unit.span, message);
            let found = found.with_label(wanted.span, "declared here");
            self.report(found);
        }
    }
}
