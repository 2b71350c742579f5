//! Calls by a name that means something else as well: a method's own in SIMATIC AX, a function of the standard's name.

use super::collect::{Collector, Scope};
use super::ty::Ty;
use super::world::World;
use onescan_iec::Dialect;
use onescan_iec::syntax::ast::{Call, Ident};

impl<'a> Collector<'a> {
    /// In SIMATIC AX a method's bare name is a function's, and a function of a library may be called as the standard's
    /// is and take its parameters in another order.
    pub(super) fn call_of_namesake(
        &mut self,
        name: &Ident,
        own: bool,
        call: &Call,
        is_used: bool,
        scope: &Scope<'a>,
    ) -> Option<Ty> {
        let key = name.key();
        if self.world.dialect(name.span) != Dialect::Iec3 || own && scope.class.is_none() {
            return None;
        }
        let declared = self.world.function(&scope.home, &key).map(|unit| (unit.pou, unit.home.clone()));
        if let Some((pou, home)) = declared.filter(|_| own) {
            return Some(self.declared_call(pou, &home, call, scope));
        }
        if !World::has_function(&key) {
            return own.then(|| self.function_call(&name.text, call, is_used, scope));
        }
        let types = self.given(&call.arguments, scope);
        let types: Vec<Ty> = types.iter().map(|ty| self.slots.resolved(ty)).collect();
        if !has_another_order(&key, &types) {
            return own.then(|| self.standard_call(&key, call, scope));
        }
        let library = scope.home.using.iter().find(|key| key.ends_with("STRINGS"))?;
        let shown = self.world.shown_namespace(library)?.to_owned();
        Some(self.function_call(&format!("{shown}.{}", name.text), call, is_used, scope))
    }
}

/// True if a string stands where the standard's function takes a number, or a number where it takes a string.
fn has_another_order(key: &str, given: &[Ty]) -> bool {
    let texts = match key {
        "INSERT" | "REPLACE" => 2,
        "LEFT" | "RIGHT" | "MID" | "DELETE" => 1,
        _ => return false,
    };
    given.iter().enumerate().any(|(at, ty)| match ty {
        Ty::Text(_) => at >= texts,
        Ty::Elementary(found) => at < texts && found.is_integer(),
        _ => false,
    })
}
