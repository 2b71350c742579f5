//! Names, members and indices to places (2nd ed. 2.4.1.2).

pub(super) mod direct;
mod in_out;
mod later_constant;
pub(super) mod member;
pub(super) mod namespace;
pub(super) mod open_array;
pub(super) mod part;

use super::expression::enumeration_value;
use super::{Body, Meant, wire};
use crate::check::declare::{Numbered, Rank, chart};
use crate::check::types::constant;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::dialect::Feature;
use crate::ir::{
    Dimension, ElementaryType, Expr, ExprKind, Location, Part, Place, Step, Storage, Type, TypeId, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, ReferenceKind, SectionKind};
use crate::syntax::direct_address::Area;

/// Who may write to a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum Access {
    ReadWrite,
    Constant,
    /// It is an input of the unit itself.
    OwnInput,
    /// It is an output of an instance.
    InstanceOutput,
    /// It is a variable that an instance keeps for itself.
    Internal,
    /// It is an input of the machine.
    MachineInput,
    /// It is the state of a chart.
    Chart,
    /// It is what a property or a call gives.
    Value,
}

/// A place and who may write to it.
pub(in crate::check) struct Located {
    pub(in crate::check::body) place: Place,
    pub(in crate::check::body) access: Access,
}

impl Located {
    pub(in crate::check) fn into_place(self) -> Place {
        self.place
    }
}

/// What a name stands for.
enum Meaning {
    Variable,
    Value(Expr),
}

impl Body<'_, '_> {
    /// The value at a place; constants are replaced by their values.
    pub(in crate::check) fn load(&mut self, expr: &ast::Expr) -> Option<Operand> {
        match &expr.kind {
            ast::ExprKind::Name(name) => {
                if let Some(found) = self.own_property(name) {
                    return found;
                }
                if !self.is_this(name)
                    && !wire::is_wire(name)
                    && let Meaning::Value(value) = self.meaning(name)?
                {
                    return Some(Operand::Typed(value));
                }
            }
            ast::ExprKind::Member(base, name) => {
                if let Some(ty) = self.enumeration_named(base) {
                    return self.enumerator_of(ty, &name.text, expr.span);
                }
                if let Some(found) = self.property_of(base, name) {
                    return found;
                }
                if let Some(found) = self.in_out_of_instance(base, name, expr.span) {
                    return found;
                }
                if let Some(found) = self.constant_of_unit(base, name) {
                    return found;
                }
                if let Some(qualified) = self.qualified_name(expr)
                    && let Meaning::Value(value) = self.meaning(&qualified)?
                {
                    return Some(Operand::Typed(value));
                }
            }
            ast::ExprKind::Index(base, indices) => {
                let base = self.base_place(base)?;
                if let (Type::Text(_), [index]) = (self.declarations.types().get(base.place.ty), &indices[..]) {
                    return self.character(base, index, expr.span);
                }
                let located = self.element(base, indices, expr.span)?;
                let place = self.through_reference(located).place;
                let ty = self.declarations.types().of_value(place.ty);
                return Some(Operand::Typed(Expr { kind: ExprKind::Load(place), ty, span: expr.span }));
            }
            // All else is loaded from its place.
            _ => {}
        }
        let place = self.place(expr)?.place;
        let ty = self.declarations.types().of_value(place.ty);
        Some(Operand::Typed(Expr { kind: ExprKind::Load(place), ty, span: expr.span }))
    }

    /// The enumeration that `Colour` in `Colour.Red` names, unless a variable hides it.
    fn enumeration_named(&mut self, base: &ast::Expr) -> Option<TypeId> {
        let qualified = self.qualified_name(base);
        let ((ast::ExprKind::Name(name), _) | (_, Some(name))) = (&base.kind, &qualified) else {
            return None;
        };
        let key = name.key();
        let hidden = self.scope.declares(&key) || self.declarations.global_key(&key).is_some();
        let key = self.declarations.type_key(&key).filter(|_| !hidden)?;
        let ty = self.declarations.named_type(&key, Some(name.span))?.ty;
        matches!(self.declarations.types().get(ty), Type::Enumeration { .. }).then_some(ty)
    }

    /// The place that an expression stands for; of a `REFERENCE TO` what it refers to.
    pub(in crate::check) fn place(&mut self, expr: &ast::Expr) -> Option<Located> {
        let located = self.declared_place(expr)?;
        Some(self.through_reference(located))
    }

    /// The same, the reference itself if it is one.
    pub(super) fn declared_place(&mut self, expr: &ast::Expr) -> Option<Located> {
        if let Some(referred) = self.referred_place(expr) {
            return referred;
        }
        match &expr.kind {
            ast::ExprKind::Name(name) => self.named_place(name),
            ast::ExprKind::Member(base, name) => {
                if let Some(qualified) = self.qualified_name(expr) {
                    return self.named_place(&qualified);
                }
                let base = self.base_place(base)?;
                self.member(base, name, expr.span)
            }
            ast::ExprKind::Index(base, indices) => {
                let base = self.base_place(base)?;
                self.element(base, indices, expr.span)
            }
            ast::ExprKind::Dereference(inner) => self.dereferenced(inner, expr.span),
            ast::ExprKind::Paren(inner) => self.declared_place(inner),
            ast::ExprKind::DirectAddress(text) => self.direct_place(text, expr.span),
            ast::ExprKind::Part(base, part) => {
                let base = self.place(base)?;
                self.part(base, part, expr.span)
            }
            ast::ExprKind::Error => None,
            _ => {
                let message = "a variable is wanted here";
                self.report(Diagnostic::error(Code::NotAVariable, expr.span, message));
                None
            }
        }
    }

    /// The place that has the part: a variable, or what a property or a call gives.
    pub(super) fn base_place(&mut self, base: &ast::Expr) -> Option<Located> {
        if let Some(found) = self.super_place(base) {
            return found;
        }
        match self.given_value(base) {
            Some(value) => {
                let value = value?;
                self.place_of_value(value, base.span)
            }
            None => self.place(base),
        }
    }

    /// What a property or a call gives; nothing if `expr` is neither.
    pub(super) fn given_value(&mut self, expr: &ast::Expr) -> Meant<Operand> {
        match &expr.kind {
            ast::ExprKind::Name(name) => self.own_property(name),
            ast::ExprKind::Member(object, name) => self.property_of(object, name),
            ast::ExprKind::Call(call) => Some(self.call_expression(call, expr.span)),
            _ => None,
        }
    }

    fn named_place(&mut self, name: &Ident) -> Option<Located> {
        if let Some(found) = self.this_place(name) {
            return found;
        }
        if let Some(sibling) = self.sibling(name) {
            return Some(sibling);
        }
        if wire::is_wire(name) {
            // One without a value has been reported where it would have got it.
            let place = self.wires.get(&name.text)?.clone();
            return Some(Located { place: Place { span: name.span, ..place }, access: Access::ReadWrite });
        }
        match self.variable_named(name) {
            Some(Ok(variable)) => {
                let open = open_array::access(self.declarations.types(), &variable);
                let access = match variable.section {
                    _ if open.is_some() => Access::Constant,
                    _ if variable.is_constant => Access::Constant,
                    _ if variable.of_chart && !self.is_own_network(&name.key()) => Access::Chart,
                    SectionKind::Input => Access::OwnInput,
                    _ if is_machine_input(variable.storage) => Access::MachineInput,
                    _ => Access::ReadWrite,
                };
                // Inside of its unit an input with an edge is that edge.
                let storage = variable.edge.map_or(variable.storage, |edge| Storage::Register(edge.seen));
                let place = Place::whole(storage, variable.ty, name.span);
                Some(Located { place, access })
            }
            Some(Err(())) => None,
            None => {
                self.meaning(name)?;
                let message = format!("`{}` is not a variable", name.text);
                self.report(Diagnostic::error(Code::NotAVariable, name.span, message));
                None
            }
        }
    }

    /// The variable of this name; an error is one that has been reported.
    pub(in crate::check) fn variable_named(&mut self, name: &Ident) -> Option<Result<Variable, ()>> {
        let key = name.key();
        let local = !name.is_global() || self.is_own_result(name);
        if local && self.scope.is_broken(&key) {
            return Some(Err(()));
        }
        if let Some(found) = self.scope.find(&key).filter(|_| local) {
            return Some(Ok(found.clone()));
        }
        // The flag of an action is that of its control (2nd ed. 2.6.4.5).
        if let Some(control) = self.scope.find(&chart::control_key(&key)).filter(|_| local) {
            return Some(Ok(control.clone()));
        }
        // Vendors make global variables visible everywhere; the standard wants VAR_EXTERNAL.
        if let Some(key) = self.declarations.global_key(&key) {
            self.declarations.note_global_use(self.pou, &key, name.span);
            return Some(self.declarations.global(&key, Some(name.span)).ok_or(()));
        }
        if let Some(found) = self.later_constant(name) {
            return Some(found.ok_or(()));
        }
        self.program_named(name).map(|found| found.ok_or(()))
    }

    /// The instance of the program of this name; nothing inside if it is not to be had.
    fn program_named(&mut self, name: &Ident) -> Meant<Variable> {
        let id = self.declarations.program_of_name(&name.key())?;
        let instance = self.declarations.program_instance(id, name);
        if self.own_class() != Some(id) {
            return Some(instance);
        }
        // A program that names itself means the instance that runs.
        Some(instance.map(|variable| Variable { storage: Storage::Instance(0), ..variable }))
    }

    fn meaning(&mut self, name: &Ident) -> Option<Meaning> {
        if self.sibling(name).is_some() {
            return Some(Meaning::Variable);
        }
        match self.variable_named(name) {
            Some(Err(())) => return None,
            Some(Ok(variable)) => {
                let given = matches!(variable.section, SectionKind::Input | SectionKind::InOut | SectionKind::Output);
                return Some(match variable.constant.filter(|_| !given || !self.is_running) {
                    Some(value) => {
                        let kind = ExprKind::Constant(value);
                        Meaning::Value(Expr {
                            kind,
                            ty: self.declarations.types().of_value(variable.ty),
                            span: name.span,
                        })
                    }
                    None => Meaning::Variable,
                });
            }
            None => {}
        }
        let bare = self.declarations.behind_libraries(name);
        if let Some(value) = self.own_value(&bare) {
            return Some(Meaning::Value(value));
        }
        let found = self.declarations.enumerators(&bare.key());
        if let [first, ..] = found
            && first.rank == Rank::Qualified
            && self.declarations.dialect(name.span).has(Feature::EnumerationsAsIntegers)
        {
            let message = format!("`{}` is known behind the name of its enumeration only", name.text);
            let help = format!("write `{}.{}`", self.type_name(first.ty), name.text);
            self.report(Diagnostic::error(Code::NotQualified, name.span, message).with_help(help));
            return None;
        }
        match found {
            [only] => Some(Meaning::Value(enumeration_value(only.ty, only.value, name.span))),
            [] if name.key() == "NULL" => Some(Meaning::Value(Self::null(name.span))),
            [] => self.report_unknown(name),
            several => {
                if let Some(value) = self.wanted_value(several, name.span) {
                    return Some(Meaning::Value(value));
                }
                let types: Vec<_> = several.iter().map(|each| self.type_name(each.ty)).collect();
                let message = format!("`{}` is a value of {}", name.text, types.join(" and of "));
                let help = format!("write {}#{}", types[0], name.text);
                let found = Diagnostic::error(Code::UnknownName, name.span, message);
                self.report(found.with_help(help));
                None
            }
        }
    }

    fn report_unknown<T>(&mut self, name: &Ident) -> Option<T> {
        if self.may_inherit() {
            return None;
        }
        if let Some(found) = self.type_for_instance(name) {
            self.report(found);
            return None;
        }
        let own = self.scope.variables().iter().map(|variable| variable.name.as_str());
        let globals = self.declarations.global_names();
        let help = did_you_mean(&name.text, own.chain(globals));
        let help = self.declarations.elsewhere(name).or(help);
        let other_branch = || "in a CASE all other values come behind `ELSE`".to_owned();
        let help = help.or_else(|| (name.key() == "DEFAULT").then(other_branch));
        let message = format!("`{}` is not declared", name.text);
        let found = Diagnostic::error(Code::UnknownName, name.span, message);
        self.declarations.report_name(self.pou, name, found.with_optional_help(help));
        None
    }

    /// What is wrong with the name of a type, block or function where a variable is wanted.
    fn type_for_instance(&self, name: &Ident) -> Option<Diagnostic> {
        let (key, text) = (name.key(), &name.text);
        let kind = self.declarations.pou_named(&key).map(|id| self.declarations.pou(id).ast().kind);
        let (message, help) = match kind {
            Some(kind) if kind.has_instances() && kind != PouKind::Program => {
                let instance = format!("{}_1", text.to_ascii_lowercase());
                let what = if kind == PouKind::Class { "class" } else { "function block" };
                let help = format!("declare an instance, `{instance} : {text};`, and write `{instance}` here");
                (format!("`{text}` is a {what}, not an instance"), help)
            }
            Some(PouKind::Function) => {
                (format!("`{text}` is a function, not a variable"), format!("call it as `{text}(..)`"))
            }
            Some(_) => return None,
            None => {
                self.declarations.type_key(&key)?;
                let help = format!("declare a variable of the type, `: {text};`");
                (format!("`{text}` is a type, not a variable"), help)
            }
        };
        Some(Diagnostic::error(Code::NotAVariable, name.span, message).with_help(help))
    }

    /// A member of a structure, which may have thousands: none of them is copied.
    fn field(&mut self, base: Located, name: &Ident, span: Span) -> Option<Located> {
        if self.declarations.is_unmade(base.place.ty) {
            return None;
        }
        if let Some(field) = self.declarations.types().field(base.place.ty, &name.text) {
            let place = base.place.member(field.offset, field.ty);
            let place = Place { span, part: field.bit.map(Part::bit), ..place };
            return Some(Located { place, access: base.access });
        }
        let known: Vec<String> = match self.declarations.types().get(base.place.ty) {
            Type::Struct { fields, .. } => fields.iter().map(|field| field.name.clone()).collect(),
            _ => Vec::new(),
        };
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        self.report_unknown_member(base.place.ty, name, &known)
    }

    fn member(&mut self, base: Located, name: &Ident, span: Span) -> Option<Located> {
        if matches!(self.declarations.types().get(base.place.ty), Type::Struct { .. }) {
            return self.field(base, name, span);
        }
        match self.declarations.types().get(base.place.ty).clone() {
            Type::FunctionBlock { pou, .. } => self.instance_member(base, pou, name, span),
            Type::Elementary(_) if self.is_constant(name) => self.named_bit(base, name, span),
            Type::Interface { pou, .. } if self.declarations.may_inherit(pou) => None,
            Type::Interface { name: interface, pou } => {
                let message = format!("{interface} has no method or property `{}`", name.text);
                let known = self.declarations.member_names(pou);
                let help = did_you_mean(&name.text, known.iter().map(String::as_str));
                let found = Diagnostic::error(Code::UnknownMember, name.span, message);
                self.report(found.with_optional_help(help));
                None
            }
            _ => {
                let message = format!("{} has no members", self.type_name(base.place.ty));
                let has_bits = self.elementary(base.place.ty).is_some_and(|ty| ty.is_bits() && ty.size() > 0);
                let help = has_bits.then(|| "a bit has its number for a name, as in `a.3`".to_owned());
                self.report(Diagnostic::error(Code::NotAStructure, span, message).with_optional_help(help));
                None
            }
        }
    }

    fn report_unknown_member<T>(&mut self, ty: TypeId, name: &Ident, known: &[&str]) -> Option<T> {
        let message = format!("{} has no member `{}`", self.type_name(ty), name.text);
        let help = did_you_mean(&name.text, known.iter().copied());
        let found = Diagnostic::error(Code::UnknownMember, name.span, message);
        self.report(found.with_optional_help(help));
        None
    }

    /// Inputs and outputs of an instance can be reached from outside (2nd ed. 2.5.2.1).
    fn instance_member(&mut self, base: Located, pou: crate::ir::PouId, name: &Ident, span: Span) -> Option<Located> {
        let scope = self.declarations.interface(pou, span)?;
        if scope.is_broken(&name.key()) {
            return None;
        }
        let numbered = Numbered::of(&name.text);
        let found = match numbered {
            Some(wanted) => scope.numbered(wanted),
            None => scope.find(&name.key()).filter(|variable| self.declarations.is_called_so(variable, name)),
        };
        let Some(variable) = found else {
            if let Some(wanted) = numbered {
                let message = wanted.lost(&self.type_name(base.place.ty));
                self.report(Diagnostic::error(Code::UnknownMember, name.span, message));
                return None;
            }
            if let Some(found) = self.not_a_variable(pou, name) {
                return found;
            }
            if self.declarations.may_inherit(pou) {
                return None;
            }
            let open = |variable: &&Variable| matches!(variable.section, SectionKind::Input | SectionKind::Output);
            let names = scope.variables().iter().filter(open).map(|variable| variable.name.as_str());
            let members = self.declarations.member_names(pou);
            let names: Vec<_> = names.chain(members.iter().map(String::as_str)).collect();
            return self.report_unknown_member(base.place.ty, name, &names);
        };
        let access = match variable.section {
            SectionKind::Input if variable.is_constant && !self.is_own_instance(pou) => Access::ReadWrite,
            _ if variable.is_constant && self.may_see(variable) => Access::Constant,
            _ if base.access == Access::Chart => Access::Chart,
            _ if self.is_own_instance(pou) || self.is_running_instance(&base.place, pou) => Access::ReadWrite,
            SectionKind::Input => Access::ReadWrite,
            SectionKind::Output => Access::InstanceOutput,
            SectionKind::Local if self.may_see(variable) => Access::ReadWrite,
            SectionKind::Local if self.declarations.dialect(span).has(Feature::InstanceInternals) => Access::ReadWrite,
            SectionKind::Local if self.declarations.dialect(span).has(Feature::ReadableInternals) => {
                // An instance inside of another one is called and written to as if it were one's own.
                if self.is_instance_type(variable.ty) { Access::ReadWrite } else { Access::Internal }
            }
            _ => {
                let ty = self.type_name(base.place.ty);
                let message = format!("`{}` is internal to {ty}", name.text);
                let found = Diagnostic::error(Code::UnknownMember, name.span, message);
                self.report(found.with_label(variable.span, "declared here"));
                return None;
            }
        };
        if let Storage::Absolute(_) | Storage::Located(_) = variable.storage {
            // It lies in one place for all instances.
            return Some(Located { place: Place::whole(variable.storage, variable.ty, span), access });
        }
        let Storage::Instance(offset) = variable.storage else {
            return self.reference_in_this(&base, variable, span);
        };
        let place = Place { span, ..base.place.member(offset, variable.ty) };
        Some(Located { place, access })
    }

    fn element(&mut self, base: Located, indices: &[ast::Expr], span: Span) -> Option<Located> {
        if let (Type::Reference { kind: ReferenceKind::Pointer, target }, [index]) =
            (self.declarations.types().get(base.place.ty), indices)
        {
            let target = *target;
            return self.pointed_element(base, target, index, span);
        }
        if matches!(self.declarations.types().get(base.place.ty), Type::OpenArray { .. }) {
            return self.open_element(base, indices, span);
        }
        if let (Type::Text(_), [index]) = (self.declarations.types().get(base.place.ty), indices) {
            return self.character_place(base, index, span)?;
        }
        let Type::Array { dimensions, element } = self.declarations.types().get(base.place.ty).clone() else {
            let message = format!("{} is not an array", self.type_name(base.place.ty));
            let bits = matches!(self.declarations.types().get(base.place.ty), Type::Elementary(ty) if ty.is_bits() || ty.is_integer());
            let help = match indices {
                [ast::Expr { kind: ast::ExprKind::Literal(ast::Literal::Integer(bit)), .. }] if bits => {
                    Some(format!("a bit is written with a point, as in `x.{bit}`"))
                }
                _ => None,
            };
            self.report(Diagnostic::error(Code::NotIndexable, span, message).with_optional_help(help));
            return None;
        };
        if dimensions.len() != indices.len() {
            let (wanted, found) = (dimensions.len(), indices.len());
            let message = format!("the array has {wanted} dimensions, there are {found} indices");
            self.report(Diagnostic::error(Code::WrongDimensions, span, message));
            return None;
        }
        let mut place = base.place;
        let mut stride = self.declarations.types().size(element);
        let mut steps = Vec::new();
        // The last index runs fastest, as in the standard's own initial values (2.4.3.2).
        for (dimension, index) in dimensions.iter().zip(indices).rev() {
            let step = self.index_step(*dimension, index, stride);
            stride = stride.saturating_mul(dimension.count() as u32);
            steps.push(step);
        }
        let steps: Vec<Step> = steps.into_iter().rev().collect::<Option<_>>()?;
        place.steps.extend(steps);
        place.ty = element;
        place.span = span;
        Some(Located { place, access: base.access })
    }

    pub(super) fn index_step(&mut self, bounds: Dimension, index: &ast::Expr, stride: u32) -> Option<Step> {
        let operand = self.within(None, |body| body.expression(index))?;
        let index = self.settle(operand)?;
        let index = self.as_index(index);
        if !self.plain_elementary(&index).is_some_and(ElementaryType::is_integer) {
            let found = self.type_name(index.ty);
            return self.mismatch("an integer", &found, index.span);
        }
        let Dimension { low, high } = bounds;
        if let Ok(value) = constant::fold(self.declarations.types(), &index) {
            let value = value.as_int().unwrap_or(0);
            if !(i128::from(low)..=i128::from(high)).contains(&value) {
                let message = format!("index {value} is outside of {low}..{high}");
                self.report(Diagnostic::error(Code::IndexOutOfRange, index.span, message));
                return None;
            }
            return Some(Step::Offset((value - i128::from(low)) as u32 * stride));
        }
        Some(Step::Index { index: Box::new(index), low, count: bounds.count() as u32, stride })
    }
}

/// True for what the machine writes before a scan.
fn is_machine_input(storage: Storage) -> bool {
    matches!(storage, Storage::Located(Location { area: Area::Input, .. }))
}
