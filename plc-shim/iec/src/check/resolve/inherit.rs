//! What a unit has from its base, and a method from its instance (3rd ed. 6.6.5.6).

use std::sync::Arc;

use super::interface::{Interface, POINTER};
use crate::check::declare::{Membership, Need, Role, Scope, TypedImage};
use crate::ir::{EdgeDetection, ElementaryType, PouId, Storage, Variable, Visibility};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, SectionKind};

impl<'a> Interface<'_, 'a> {
    /// Takes over the variables of the base, or of the instance that a method works on.
    pub(super) fn inherit(&mut self) {
        let Some(id) = self.unit() else { return };
        if let Some(Membership { owner, .. }) = self.declarations().pou(id).membership() {
            let span = self.declarations().pou(id).ast().name.span;
            let scope = self.declarations_mut().interface(owner, span);
            let seen = scope.map(|scope| Arc::new(seen_by_methods(&scope, owner)));
            self.scope_mut().set_outer(seen);
            return;
        }
        if self.declarations().may_inherit(id) {
            self.scope_mut().lack_names();
        }
        let type_id = self.declarations().class(id).and_then(|class| class.type_id);
        match self.declarations().base_of(id) {
            Some(base) => self.inherit_from(base),
            None => self.image = type_id.map_or(Vec::new(), |_| vec![0; POINTER.size() as usize]),
        }
        if let Some(number) = type_id {
            self.align = self.align.max(POINTER.size());
            self.image.iter_mut().zip(number.to_le_bytes()).for_each(|(target, byte)| *target = byte);
        }
    }

    fn inherit_from(&mut self, base: PouId) {
        let span = self
            .unit()
            .map_or(self.declarations().pou(base).ast().name.span, |id| self.declarations().pou(id).ast().name.span);
        let Some(scope) = self.declarations_mut().interface(base, span) else { return };
        let (_, align, image) = self.declarations().pou(base).instance();
        if self.declarations_mut().charge_image(image.len() as u64, span).is_none() {
            return;
        }
        (self.align, self.image) = (align, image.to_vec());
        let keys = scope.keys();
        for (index, variable) in scope.variables().iter().enumerate() {
            if !matches!(variable.storage, Storage::Instance(_) | Storage::InstancePointer(_)) {
                continue;
            }
            let mut variable = variable.clone();
            // Each level has its own trigger, so that `SUPER()` sees the edge too.
            if let Some(edge) = variable.edge {
                let image = Arc::from([0]);
                let memory = TypedImage::plain(ElementaryType::Bool.into(), image);
                let seen = self.scope_mut().register(ElementaryType::Bool);
                let memory = self.in_instance(&memory, span).map_or(edge.memory, Storage::Instance);
                variable.edge = Some(EdgeDetection { edge: edge.edge, memory, seen });
            }
            // What is PRIVATE to the base is there, and its name is free.
            if variable.visibility == Visibility::Private {
                self.scope_mut().add_hidden(variable);
            } else {
                let key = keys.get(&index).map_or_else(|| variable.name.to_ascii_uppercase(), |key| (*key).to_owned());
                self.scope_mut().add(key, variable);
            }
        }
        // Names whose declaration is wrong stay known.
        for key in scope.broken() {
            self.scope_mut().add_broken(key.to_owned());
        }
    }

    /// The first parameter of a method is the address of its instance.
    pub(super) fn declare_this(&mut self) {
        if self.kind != PouKind::Function {
            self.scope_mut().register(POINTER);
        }
    }

    fn role(&self) -> Option<Role> {
        Some(self.declarations().pou(self.unit()?).membership()?.role)
    }

    pub(super) fn is_setter(&self) -> bool {
        self.role() == Some(Role::Setter)
    }

    /// The value that is given to a property, under the property's name.
    pub(super) fn declare_new_value(&mut self, ast: &'a ast::Pou) {
        let Some(spec) = ast.result.as_ref().filter(|_| self.is_setter()) else { return };
        let declared = self.written().resolve(spec, Need::Size);
        let placed = declared.and_then(|declared| Some((self.parameter(&declared, &ast.name)?, declared)));
        let Some((storage, declared)) = placed else { return self.declare_broken(&ast.name) };
        let shape = ast::Variable { names: Vec::new(), address: None, spec: spec.clone(), edge: None, initial: None };
        let kind = SectionKind::Input;
        let variable = self.declarations().variable(&ast.name, &shape, kind, &[], &declared, storage);
        self.add(&ast.name, variable);
    }

    /// Where a variable of the name is declared in this unit.
    pub(super) fn declared_before(&self, name: &Ident) -> Option<Span> {
        self.scope().own(&name.key()).map(|first| first.span)
    }
}

/// The variables of an instance; what lasts for one call of its statements is left out.
fn seen_by_methods(scope: &Scope, owner: PouId) -> Scope {
    let mut seen = Scope::default();
    let keys = scope.keys();
    for (index, variable) in scope.variables().iter().enumerate() {
        let lasting = match variable.storage {
            Storage::Instance(_) | Storage::InstancePointer(_) | Storage::Located(_) => true,
            Storage::Register(_) | Storage::RegisterPointer(_) => false,
            // A hierarchical address, as `%IW0.1`, has a fixed place.
            Storage::Absolute(_) if variable.section == SectionKind::Local => true,
            _ => matches!(variable.section, SectionKind::External | SectionKind::Static),
        };
        let hidden = variable.visibility == Visibility::Private && variable.owner != Some(owner);
        if lasting && !hidden {
            let key = keys.get(&index).map_or_else(|| variable.name.to_ascii_uppercase(), |key| (*key).to_owned());
            seen.add(key, Variable { edge: None, ..variable.clone() });
        }
    }
    // Names whose declaration is wrong stay known.
    for key in scope.broken() {
        seen.add_broken(key.to_owned());
    }
    seen
}
