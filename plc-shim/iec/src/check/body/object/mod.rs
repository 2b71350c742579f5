//! The instance that a unit works on: `THIS`, `SUPER`, inherited variables, who sees what
//! (3rd ed. 6.6.5.5 to 6.6.5.10).

pub(super) mod copy;
mod init_call;
pub(super) mod interface_value;
pub(super) mod method_call;
pub(super) mod property;
pub(super) mod query;

use super::place::{Access, Located};
use super::{Body, Meant};
use crate::check::declare::{Membership, Role, method_visibility};
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{Expr, ExprKind, Place, PouId, StatementKind, Storage, Type, TypeId, Variable, Visibility};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, ReferenceKind};

impl Body<'_, '_> {
    /// The unit whose instance runs; nothing in functions.
    pub(super) fn own_class(&self) -> Option<PouId> {
        let id = self.declarations.owner_of(self.pou?);
        (self.declarations.pou(id).ast().kind != PouKind::Function).then_some(id)
    }

    /// True where a name may be that of an unknown base.
    pub(super) fn may_inherit(&self) -> bool {
        self.own_class().is_some_and(|class| self.declarations.may_inherit(class))
    }

    pub(in crate::check::body) fn is_this(&self, name: &Ident) -> bool {
        name.key() == "THIS" && !self.scope.declares("THIS")
    }

    fn is_super(&self, expr: &ast::Expr) -> bool {
        matches!(&expr.kind, ast::ExprKind::Name(name) if name.key() == "SUPER" && !self.scope.declares("SUPER"))
    }

    /// `THIS`, if the name is that.
    pub(super) fn this_place(&mut self, name: &Ident) -> Meant<Located> {
        if !self.is_this(name) {
            return None;
        }
        if let Some(structure) = self.this_structure(name) {
            return Some(structure);
        }
        let class = self.own_class().filter(|class| self.declarations.pou(*class).ast().kind.has_instances());
        let Some(class) = class else {
            return Some(self.no_object("THIS", name.span));
        };
        let place = self.this(class, name.span);
        Some(Some(Located { place, access: Access::ReadWrite }))
    }

    /// `THIS` as a value, where it is a pointer to the running instance.
    pub(in crate::check::body) fn this_pointer(&mut self, name: &Ident) -> Option<Operand> {
        let is_pointer = self.declarations.dialect(name.span).has(Feature::ThisPointer);
        if !is_pointer || self.this_structure(name).is_some() {
            return None;
        }
        let class = self.own_class().filter(|class| self.declarations.pou(*class).ast().kind.has_instances())?;
        let place = self.this(class, name.span);
        let ty = self.declarations.types_mut().reference(Some(ReferenceKind::Pointer), place.ty);
        Some(Operand::Typed(Expr { kind: ExprKind::Address(place), ty, span: name.span }))
    }

    /// The running instance as one of its base, for `SUPER^.x`; nothing if the expression is not `SUPER`.
    pub(super) fn super_place(&mut self, expr: &ast::Expr) -> Meant<Located> {
        if !self.is_super(expr) {
            return None;
        }
        let base = self.own_class().and_then(|class| self.declarations.base_of(class));
        let Some(base) = base else {
            return Some(self.no_object("SUPER", expr.span));
        };
        let place = self.this(base, expr.span);
        Some(Some(Located { place, access: Access::ReadWrite }))
    }

    /// True for the running instance, seen as one of `class`, which is its own type or a base of that.
    pub(super) fn is_running_instance(&self, place: &Place, class: PouId) -> bool {
        let is_this = place.storage == Storage::Instance(0) && place.steps.is_empty();
        is_this && self.own_class().is_some_and(|own| self.declarations.is_a(own, class))
    }

    /// The running instance, seen as one of `class`.
    pub(in crate::check) fn this(&mut self, class: PouId, span: Span) -> Place {
        let ast = self.declarations.pou(class).ast();
        let ty = self.declarations.types_mut().block(&ast.name.text, class);
        Place::whole(Storage::Instance(0), ty, span)
    }

    fn no_object<T>(&mut self, word: &str, span: Span) -> Option<T> {
        if self.may_inherit() {
            return None;
        }
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
        let base = self.own_class().and_then(|class| self.declarations.base_of(class));
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
        variable.owner.is_some_and(|owner| self.declarations.sees(self.pou, variable.visibility, owner))
    }

    /// Reports a method that may not be called from here.
    fn check_method_access(&mut self, method: PouId, span: Span) -> Option<()> {
        let entry = self.declarations.pou(method);
        let Some(Membership { owner, .. }) = entry.membership() else { return Some(()) };
        let visibility = method_visibility(&entry.ast().object.modifiers);
        if self.declarations.sees(self.pou, visibility, owner) {
            return Some(());
        }
        let word = match visibility {
            Visibility::Private => "PRIVATE",
            Visibility::Protected => "PROTECTED",
            Visibility::Internal | Visibility::Public => "INTERNAL",
        };
        let declared = entry.ast().name.span;
        let message = format!("`{}` is {word}", self.declarations.display_name(method));
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
        let role = roles.into_iter().find(|role| self.declarations.has_member(class, *role, &name.text))?;
        let (code, message) = match role {
            Role::Method | Role::Body | Role::Start | Role::AfterStart | Role::End => {
                (Code::NotAVariable, format!("`{0}` is a method: call it as `{0}()`", name.text))
            }
            Role::Getter => (Code::WrongProperty, format!("`{}` is a property, which is not a variable", name.text)),
            Role::Setter => (Code::WrongProperty, format!("the property `{}` has no GET", name.text)),
        };
        self.report(Diagnostic::error(code, name.span, message));
        Some(None)
    }

    /// True if an instance of one type can stand for one of the other.
    pub(super) fn derives(&self, found: TypeId, wanted: TypeId) -> bool {
        match (self.declarations.types().get(found), self.declarations.types().get(wanted)) {
            (Type::FunctionBlock { pou: found, .. }, Type::FunctionBlock { pou: wanted, .. }) => {
                self.declarations.is_a(*found, *wanted)
            }
            _ => false,
        }
    }
}
