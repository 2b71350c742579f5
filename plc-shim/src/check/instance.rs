//! The instance that a unit works on: `THIS`, `SUPER`, inherited variables, who sees what
//! (3rd ed. 6.6.5.5 to 6.6.5.10).

use super::Meant;
use std::sync::Arc;

use super::Checker;
use super::class::{Membership, Role};
use super::initial::plain;
use super::place::{Access, Located};
use super::scope::{Body, Scope};
use super::types::Need;
use super::variables::{Interface, POINTER};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{
    EdgeDetection, ElementaryType, Place, PouId, StatementKind, Storage, Type, TypeId, Variable, Visibility,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, Modifier, PouKind, Qualifier, SectionKind};

/// Who sees a variable of a section: what the section says, else as the standard has it.
pub(super) fn visibility(section: SectionKind, qualifiers: &[Qualifier]) -> Visibility {
    let said = qualifiers.iter().find_map(|qualifier| match qualifier {
        Qualifier::Access(Modifier::Public) => Some(Visibility::Public),
        Qualifier::Access(Modifier::Private) => Some(Visibility::Private),
        Qualifier::Access(Modifier::Internal) => Some(Visibility::Internal),
        Qualifier::Access(_) => Some(Visibility::Protected),
        _ => None,
    });
    said.unwrap_or(match section {
        SectionKind::Input | SectionKind::Output => Visibility::Public,
        _ => Visibility::Protected,
    })
}

/// Who sees a method. The standard's default is PROTECTED, that of vendors PUBLIC.
fn method_visibility(modifiers: &[Modifier]) -> Visibility {
    let said = modifiers.iter().find_map(|modifier| match modifier {
        Modifier::Public => Some(Visibility::Public),
        Modifier::Protected => Some(Visibility::Protected),
        Modifier::Private => Some(Visibility::Private),
        Modifier::Internal => Some(Visibility::Internal),
        _ => None,
    });
    said.unwrap_or(Visibility::Public)
}

impl Checker<'_> {
    /// The name of a unit, that of a method with its class.
    pub(super) fn display_name(&self, id: PouId) -> String {
        let name = &self.pou(id).ast.name.text;
        match self.pou(id).membership {
            Some(membership) => format!("{}.{name}", self.pou(membership.owner).ast.name.text),
            None => name.clone(),
        }
    }

    fn sees(&self, from: Option<PouId>, visibility: Visibility, owner: PouId) -> bool {
        let class = from.map(|id| self.owner_of(id));
        match visibility {
            Visibility::Public => true,
            Visibility::Protected => class.is_some_and(|class| self.is_a(class, owner)),
            Visibility::Private => class == Some(owner),
            Visibility::Internal => self.is_inside(&self.pou(owner).home),
        }
    }
}

impl Body<'_, '_> {
    /// The unit whose instance runs; nothing in functions.
    pub(super) fn own_class(&self) -> Option<PouId> {
        let id = self.checker.owner_of(self.pou?);
        (self.checker.pou(id).ast.kind != PouKind::Function).then_some(id)
    }

    pub(super) fn is_this(&self, name: &Ident) -> bool {
        name.key() == "THIS" && !self.scope.declares("THIS")
    }

    pub(super) fn is_super(&self, expr: &ast::Expr) -> bool {
        matches!(&expr.kind, ast::ExprKind::Name(name) if name.key() == "SUPER" && !self.scope.declares("SUPER"))
    }

    /// `THIS`, if the name is that.
    pub(super) fn this_place(&mut self, name: &Ident) -> Meant<Located> {
        if !self.is_this(name) {
            return None;
        }
        let class = self.own_class().filter(|class| self.checker.pou(*class).ast.kind.has_instances());
        let Some(class) = class else {
            return Some(self.no_object("THIS", name.span));
        };
        let place = self.this(class, name.span);
        Some(Some(Located { place, access: Access::ReadWrite }))
    }

    /// The running instance, seen as one of `class`.
    pub(super) fn this(&mut self, class: PouId, span: Span) -> Place {
        let ast = self.checker.pou(class).ast;
        let ty = self.checker.types.block(&ast.name.text, class);
        Place::whole(Storage::Instance(0), ty, span)
    }

    pub(super) fn no_object<T>(&mut self, word: &str, span: Span) -> Option<T> {
        let message = match word {
            "THIS" => "THIS is used where no instance runs".to_owned(),
            _ => format!("{word} is used in what extends nothing"),
        };
        self.report(Diagnostic::error(Code::NoObject, span, message));
        None
    }

    /// `SUPER()`, the statements of the base on the running instance.
    pub(super) fn super_call(&mut self, call: &ast::Call, span: Span) -> Meant<StatementKind> {
        if !self.is_super(&call.callee) {
            return None;
        }
        let base = self.own_class().and_then(|class| self.checker.base_of(class));
        let Some(base) = base else {
            return Some(self.no_object("SUPER", call.callee.span));
        };
        let place = self.this(base, call.callee.span);
        Some(self.instance_call_at(place, call, span))
    }

    /// True where the variables of `pou` are one's own, whatever instance they are of.
    pub(super) fn is_own_instance(&self, pou: PouId) -> bool {
        self.own_class() == Some(pou)
    }

    pub(super) fn may_see(&self, variable: &Variable) -> bool {
        variable.owner.is_some_and(|owner| self.checker.sees(self.pou, variable.visibility, owner))
    }

    /// Reports a method that may not be called from here.
    pub(super) fn check_method_access(&mut self, method: PouId, span: Span) -> Option<()> {
        let entry = self.checker.pou(method);
        let Some(Membership { owner, .. }) = entry.membership else { return Some(()) };
        let visibility = method_visibility(&entry.ast.object.modifiers);
        if self.checker.sees(self.pou, visibility, owner) {
            return Some(());
        }
        let word = match visibility {
            Visibility::Private => "PRIVATE",
            Visibility::Protected => "PROTECTED",
            Visibility::Internal | Visibility::Public => "INTERNAL",
        };
        let declared = entry.ast.name.span;
        let message = format!("`{}` is {word}", self.checker.display_name(method));
        let found = Diagnostic::error(Code::AccessDenied, span, message);
        self.report(found.with_label(declared, "declared here"));
        None
    }

    /// A `VAR_IN_OUT` of the running instance, as in `THIS.x`.
    pub(super) fn reference_in_this(&mut self, base: &Located, variable: &Variable, span: Span) -> Option<Located> {
        let is_this = base.place.storage == Storage::Instance(0) && base.place.steps.is_empty();
        if is_this && matches!(variable.storage, Storage::InstancePointer(_)) {
            let place = Place::whole(variable.storage, variable.ty, span);
            return Some(Located { place, access: base.access });
        }
        let message = format!("`{}` is seen in the statements of its own unit only", variable.name);
        self.report(Diagnostic::error(Code::UnknownMember, span, message));
        None
    }

    /// What is wrong with naming a method or property like a variable.
    pub(super) fn not_a_variable<T>(&mut self, class: PouId, name: &Ident) -> Meant<T> {
        let roles = [Role::Method, Role::Getter, Role::Setter];
        let role = roles.into_iter().find(|role| self.checker.find_member(class, *role, &name.text).is_some())?;
        let (code, message) = match role {
            Role::Method | Role::Body | Role::Start | Role::End => {
                (Code::NotAVariable, format!("`{0}` is a method: call it as `{0}()`", name.text))
            }
            Role::Getter => (Code::WrongProperty, format!("`{}` is a property, which is no variable", name.text)),
            Role::Setter => (Code::WrongProperty, format!("the property `{}` has no GET", name.text)),
        };
        self.report(Diagnostic::error(code, name.span, message));
        Some(None)
    }

    /// True if an instance of one type can stand for one of the other.
    pub(super) fn derives(&self, found: TypeId, wanted: TypeId) -> bool {
        match (self.checker.types.get(found), self.checker.types.get(wanted)) {
            (Type::FunctionBlock { pou: found, .. }, Type::FunctionBlock { pou: wanted, .. }) => {
                self.checker.is_a(*found, *wanted)
            }
            _ => false,
        }
    }
}

impl<'a> Interface<'_, 'a> {
    /// Takes over the variables of the base, or of the instance that a method works on.
    pub(super) fn inherit(&mut self) {
        let Some(id) = self.body.pou else { return };
        if let Some(Membership { owner, .. }) = self.body.checker.pou(id).membership {
            let span = self.body.checker.pou(id).ast.name.span;
            let scope = self.body.checker.interface(owner, span);
            self.body.scope.outer = scope.map(|scope| Arc::new(seen_by_methods(&scope, owner)));
            return;
        }
        let type_id = self.body.checker.class(id).and_then(|class| class.type_id);
        match self.body.checker.base_of(id) {
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
            .body
            .pou
            .map_or(self.body.checker.pou(base).ast.name.span, |id| self.body.checker.pou(id).ast.name.span);
        let Some(scope) = self.body.checker.interface(base, span) else { return };
        let (_, align, image) = self.body.checker.pou(base).instance();
        if self.body.checker.charge_image(image.len() as u64, span).is_none() {
            return;
        }
        (self.align, self.image) = (align, image.to_vec());
        let keys = scope.keys();
        for (index, variable) in scope.variables.iter().enumerate() {
            if !matches!(variable.storage, Storage::Instance(_) | Storage::InstancePointer(_)) {
                continue;
            }
            let mut variable = variable.clone();
            // Each level has its own trigger, so that `SUPER()` sees the edge too.
            if let Some(edge) = variable.edge {
                let image = Arc::from([0]);
                let memory = plain(ElementaryType::Bool.into(), image);
                let seen = self.body.scope.register(ElementaryType::Bool);
                let memory = self.in_instance(&memory, span).map_or(edge.memory, Storage::Instance);
                variable.edge = Some(EdgeDetection { edge: edge.edge, memory, seen });
            }
            // What is PRIVATE to the base is there, and its name is free.
            if variable.visibility != Visibility::Private {
                let key = keys.get(&index).map_or_else(|| variable.name.to_ascii_uppercase(), |key| (*key).to_owned());
                self.body.scope.by_name.insert(key, self.body.scope.variables.len());
            }
            self.body.scope.variables.push(variable);
        }
    }

    /// The first parameter of a method is the address of its instance.
    pub(super) fn declare_this(&mut self) {
        if self.kind != PouKind::Function {
            self.body.scope.register(POINTER);
        }
    }

    fn role(&self) -> Option<Role> {
        Some(self.body.checker.pou(self.body.pou?).membership?.role)
    }

    pub(super) fn is_setter(&self) -> bool {
        self.role() == Some(Role::Setter)
    }

    /// The value that is given to a property, under the property's name.
    pub(super) fn declare_new_value(&mut self, ast: &'a ast::Pou) {
        let Some(spec) = ast.result.as_ref().filter(|_| self.is_setter()) else { return };
        let Some(declared) = self.body.resolve(spec, Need::Size) else { return };
        let Some(storage) = self.parameter(&declared, &ast.name) else { return };
        let shape = ast::Variable { names: Vec::new(), address: None, spec: spec.clone(), edge: None, initial: None };
        let kind = SectionKind::Input;
        let variable = self.body.checker.variable(&ast.name, &shape, kind, &[], &declared, storage);
        self.add(&ast.name, variable);
    }

    /// Where a variable of the name is declared in this unit.
    pub(super) fn declared_before(&self, name: &Ident) -> Option<Span> {
        self.body.scope.own(&name.key()).map(|first| first.span)
    }
}

/// The variables of an instance; what lasts for one call of its statements is left out.
fn seen_by_methods(scope: &Scope, owner: PouId) -> Scope {
    let mut seen = Scope::default();
    let keys = scope.keys();
    for (index, variable) in scope.variables.iter().enumerate() {
        let lasting = match variable.storage {
            Storage::Instance(_) | Storage::InstancePointer(_) => true,
            Storage::Register(_) | Storage::RegisterPointer(_) => false,
            _ => variable.section == SectionKind::External,
        };
        let hidden = variable.visibility == Visibility::Private && variable.owner != Some(owner);
        if lasting && !hidden {
            let key = keys.get(&index).map_or_else(|| variable.name.to_ascii_uppercase(), |key| (*key).to_owned());
            seen.by_name.insert(key, seen.variables.len());
            seen.variables.push(Variable { edge: None, ..variable.clone() });
        }
    }
    // Names whose declaration is wrong stay known.
    for key in scope.by_name.keys().filter(|key| scope.is_broken(key)) {
        seen.by_name.insert(key.clone(), usize::MAX);
    }
    seen
}
