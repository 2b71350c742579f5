//! `REF` (3rd ed. 6.4.4.10.3), and `ADR`, `SIZEOF`, `__ISVALIDREF` of vendors.

use super::as_reference;
use crate::check::body::place::{Access, Located};
use crate::check::body::{Body, Meant};
use crate::check::standard::place::PlaceFunction;
use crate::check::types::operand::{Operand, constant};
use crate::check::types::reference;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, Place, Storage, Type, TypeId, Value};
use crate::syntax::Span;
use crate::syntax::ast::{self, Argument, Call, Ident, PouKind, ReferenceKind, SectionKind};
use crate::syntax::walk::root;

fn positional(argument: &Argument) -> Option<&ast::Expr> {
    match argument {
        Argument::Positional(expr) | Argument::Input(_, expr) => Some(expr),
        Argument::Output { .. } => None,
    }
}

impl Body<'_, '_> {
    pub(in crate::check::body) fn place_call(
        &mut self,
        function: PlaceFunction,
        name: &Ident,
        call: &Call,
        span: Span,
    ) -> Option<Operand> {
        let given: Vec<&ast::Expr> = call.arguments.iter().filter_map(positional).collect();
        if let (PlaceFunction::LowerBound | PlaceFunction::UpperBound, [array, number]) = (function, &given[..]) {
            return self.bound(function, array, number, span);
        }
        let bounds = matches!(function, PlaceFunction::LowerBound | PlaceFunction::UpperBound);
        let wanted = if bounds { 2 } else { 1 };
        let ([argument], false) = (&given[..], bounds) else {
            let missing = call.arguments.len() < wanted;
            let code = if missing { Code::MissingArgument } else { Code::TooManyArguments };
            let what = if bounds { "an array and a dimension" } else { "one variable" };
            let message = format!("{} takes {what}", name.key());
            self.report(Diagnostic::error(code, span, message));
            return None;
        };
        match function {
            PlaceFunction::Ref => self.reference_to(argument, span),
            PlaceFunction::Adr => self.address_of(argument, span),
            PlaceFunction::SizeOf => self.size_of(argument, span),
            PlaceFunction::IsValidRef => self.is_valid_reference(argument, span),
            PlaceFunction::LowerBound | PlaceFunction::UpperBound => None,
        }
    }

    fn reference_to(&mut self, argument: &ast::Expr, span: Span) -> Option<Operand> {
        let place = self.referable(argument)?;
        let ty = self.declarations.types_mut().reference(Some(ReferenceKind::RefTo), place.ty);
        Some(Operand::Typed(Expr { kind: ExprKind::Address(place), ty, span }))
    }

    fn address_of(&mut self, argument: &ast::Expr, span: Span) -> Option<Operand> {
        let mut place = match self.literal_in_memory(argument) {
            Some(literal) => literal?,
            None => self.place(argument)?.place,
        };
        // Of a BIT of a structure or union the tools give the address of its byte (CODESYS with the warning C0355).
        if matches!(argument.kind, ast::ExprKind::Member(..))
            && place.part.is_some_and(|part| part.whole == ElementaryType::Byte)
        {
            place.part = None;
            place.ty = ElementaryType::Byte.into();
        }
        self.require_address(&place, argument.span)?;
        let ty = self.declarations.types_mut().reference(None, place.ty);
        Some(Operand::Typed(Expr { kind: ExprKind::Address(place), ty, span }))
    }

    /// Where a literal string stands, which lies in the constants of the program; nothing if it is none.
    fn literal_in_memory(&mut self, argument: &ast::Expr) -> Meant<Place> {
        let is_text = matches!(argument.kind, ast::ExprKind::Literal(ast::Literal::String(_)));
        if !is_text || !self.declarations.dialect(argument.span).has(Feature::LiteralAddresses) {
            return None;
        }
        let text = self.expression(argument).and_then(|text| self.settle(text));
        Some(text.and_then(|text| match text.kind {
            ExprKind::Load(place) => Some(place),
            _ => None,
        }))
    }

    /// What a reference may refer to: it outlives the call and may be written to.
    fn referable(&mut self, expr: &ast::Expr) -> Option<Place> {
        let located = self.place(expr)?;
        self.reject_constant(&located, expr.span)?;
        if self.is_temporary(expr) {
            let message = "a variable that does not outlive the call is not referred to";
            self.report(Diagnostic::error(Code::NotReferable, expr.span, message));
            return None;
        }
        self.require_address(&located.place, expr.span)?;
        Some(located.place)
    }

    pub(super) fn reject_constant(&mut self, located: &Located, span: Span) -> Option<()> {
        if located.access != Access::Constant {
            return Some(());
        }
        let message = "a constant is not referred to";
        self.report(Diagnostic::error(Code::NotReferable, span, message));
        None
    }

    pub(super) fn require_address(&mut self, place: &Place, span: Span) -> Option<()> {
        if place.has_address() && !matches!(self.declarations.types().get(place.ty), Type::OpenArray { .. }) {
            return Some(());
        }
        let message = "a bit has no address of its own";
        self.report(Diagnostic::error(Code::NotReferable, span, message));
        None
    }

    /// 3rd ed. 6.4.4.10.2: `VAR_TEMP` and the variables of functions.
    fn is_temporary(&self, expr: &ast::Expr) -> bool {
        let Some(variable) = root(expr).and_then(|name| self.scope.find(&name.key())) else { return false };
        let function = self.pou.is_some_and(|id| self.declarations.pou(id).ast().kind == PouKind::Function);
        match variable.section {
            SectionKind::Temp => true,
            SectionKind::External | SectionKind::Global | SectionKind::InOut => false,
            _ => function,
        }
    }

    /// Bytes of a variable or type, as a constant that suits any integer.
    fn size_of(&mut self, argument: &ast::Expr, span: Span) -> Option<Operand> {
        let ty = match self.type_written(argument) {
            Some(ty) => ty?,
            None => self.place(argument)?.place.ty,
        };
        if matches!(self.declarations.types().get(ty), Type::OpenArray { .. }) {
            let message = "SIZEOF of ARRAY [*] is not supported yet";
            self.report(Diagnostic::error(Code::UnsupportedFeature, span, message));
            return None;
        }
        Some(Operand::Integer { value: i128::from(self.declarations.types().size(ty)), span })
    }

    /// The type that an expression names; nothing if it is not a type's name.
    pub(in crate::check::body) fn type_written(&mut self, expr: &ast::Expr) -> Meant<TypeId> {
        match &expr.kind {
            ast::ExprKind::Name(name) if self.variable_named(name).is_none() && self.names_type(name) => {
                Some(self.declarations.type_meant(name))
            }
            ast::ExprKind::Member(..) => {
                let name = self.qualified_name(expr)?;
                self.names_type(&name).then(|| self.declarations.type_meant(&name))
            }
            ast::ExprKind::Type(spec) => Some(self.type_specified(spec)),
            _ => self.text_type_written(expr),
        }
    }

    /// `STRING`, `STRING(n)` and `WSTRING[n]` where a type may stand.
    pub(in crate::check::body) fn text_type_written(&mut self, expr: &ast::Expr) -> Meant<TypeId> {
        let (named, length) = match &expr.kind {
            ast::ExprKind::Call(inner) => (&*inner.callee, inner.arguments.first().and_then(positional)),
            ast::ExprKind::Index(named, indices) => (&**named, indices.first()),
            _ => (expr, None),
        };
        let ast::ExprKind::Name(name) = &named.kind else { return None };
        let wide = match name.key().as_str() {
            "STRING" => false,
            "WSTRING" => true,
            _ => return None,
        };
        Some(self.text_type(wide, length, expr.span))
    }

    /// The same where nothing but a type may stand: a variable of the name is not meant.
    pub(in crate::check::body) fn type_named(&mut self, expr: &ast::Expr) -> Meant<TypeId> {
        match &expr.kind {
            ast::ExprKind::Name(name) if self.names_type(name) => Some(self.declarations.type_meant(name)),
            ast::ExprKind::Member(..) => {
                let path = self.qualified_name(expr)?;
                let bare = self.declarations.behind_libraries(&path);
                [path, bare]
                    .into_iter()
                    .find(|name| self.names_type(name))
                    .map(|name| self.declarations.type_meant(&name))
            }
            _ => self.type_written(expr),
        }
    }

    fn type_specified(&mut self, spec: &ast::TypeSpec) -> Option<TypeId> {
        match &spec.kind {
            ast::TypeSpecKind::Name(name) => self.declarations.type_meant(name),
            ast::TypeSpecKind::Reference(kind, inner) => {
                let target = self.type_specified(inner)?;
                Some(self.declarations.types_mut().reference(Some(*kind), target))
            }
            ast::TypeSpecKind::String(name, length) => {
                self.text_type(name.key() == "WSTRING", length.as_deref(), spec.span)
            }
            _ => {
                let message = "the name of a type is wanted here";
                let found = Diagnostic::error(Code::NotAVariable, spec.span, message);
                self.report(found.with_help("declare the type in a TYPE block, and name it"));
                None
            }
        }
    }

    fn names_type(&self, name: &Ident) -> bool {
        let key = name.key();
        ElementaryType::find(&key).is_some()
            || self.declarations.type_key(&key).is_some()
            || self
                .declarations
                .pou_named(&key)
                .is_some_and(|id| self.declarations.pou(id).ast().kind == PouKind::FunctionBlock)
    }

    fn is_valid_reference(&mut self, argument: &ast::Expr, span: Span) -> Option<Operand> {
        let udint = ElementaryType::Udint.into();
        let address = if let Some(given) = self.given_reference(argument) {
            self.referring_value(as_reference(given?), argument.span)?
        } else {
            self.declared_reference(argument, span)?
        };
        let null = constant(Value::Int(0), ElementaryType::Udint, span);
        let address = Expr { ty: udint, ..address };
        let kind = ExprKind::Binary(Binary::NotEqual, Box::new(address), Box::new(null));
        Some(Operand::Typed(Expr { kind, ty: ElementaryType::Bool.into(), span }))
    }

    /// What a variable refers to something by: its value, or what comes by `VAR_IN_OUT` itself.
    fn declared_reference(&mut self, argument: &ast::Expr, span: Span) -> Option<Expr> {
        let place = self.declared_place(argument)?.place;
        let ty = place.ty;
        let is_in_out = matches!(place.storage, Storage::InstancePointer(_) | Storage::RegisterPointer(_));
        let is_reference = reference::target_of(self.declarations.types(), ty).is_some();
        if is_in_out && place.steps.is_empty() && !is_reference {
            return Some(Expr { kind: ExprKind::Address(place), ty: ElementaryType::Udint.into(), span });
        }
        let value = Operand::Typed(Expr { kind: ExprKind::Load(place), ty, span });
        self.referring_value(value, argument.span)
    }

    /// What refers to something, be it a reference, a pointer or an interface.
    fn referring_value(&mut self, value: Operand, span: Span) -> Option<Expr> {
        let value = self.settle(value)?;
        let types = self.declarations.types();
        if reference::target_of(types, value.ty).is_some() || matches!(types.get(value.ty), Type::Interface { .. }) {
            return Some(value);
        }
        let message = format!("a reference is wanted, this is {}", self.type_name(value.ty));
        self.report(Diagnostic::error(Code::NotAReference, span, message));
        None
    }
}
