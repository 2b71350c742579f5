//! `__VARINFO(x)` of CODESYS and TwinCAT: what is known of a variable before the program runs, as a structure.

use crate::check::body::Body;
use crate::check::types::generic::NO_CLASS;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Place, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Call, Ident, Literal};

/// It puts the structure together (`system_var_info.st`).
const MAKER: &str = "__SYSTEM.OnescanVarInfo";
/// Lengths of the texts in the structure.
const TYPE_NAME_MAX: usize = 79;
const SYMBOL_MAX: usize = 39;
/// The number of the bit of what is not a bit.
const NO_BIT: i128 = -1;

impl Body<'_, '_> {
    pub(super) fn var_info(&mut self, call: &Call, span: Span) -> Option<Operand> {
        let [ast::Argument::Positional(argument)] = &call.arguments[..] else {
            let message = "__VARINFO takes one variable";
            self.report(Diagnostic::error(Code::MissingArgument, span, message));
            return None;
        };
        let place = self.place(argument)?.place;
        let arguments = self.var_info_arguments(&place, argument, span);
        let name = Ident { text: MAKER.to_owned(), span };
        let callee = Box::new(ast::Expr { kind: ast::ExprKind::Name(name.clone()), span, height: 1 });
        let id = self.function_named(&name)?;
        self.function_call(id, &name, &Call { callee, arguments }, true, span).map(Operand::Typed)
    }

    fn var_info_arguments(&self, place: &Place, argument: &ast::Expr, span: Span) -> Vec<ast::Argument> {
        let bits = |ty: TypeId| i128::from(self.declarations.types().size(ty)) * 8;
        let elements = self.declarations.types().get(place.ty).elements();
        let element = elements.map(|(element, _)| element);
        let bit = place.part.filter(|_| bits(place.ty) == 8).map(|part| i128::from(part.shift));
        let number = |name: &str, value: i128| (name.to_owned(), Literal::Integer(value));
        let text = |name: &str, value: &str, most: usize| {
            let cut: String = value.chars().filter(|each| !matches!(each, '$' | '\'')).take(most).collect();
            (name.to_owned(), Literal::String(format!("'{cut}'")))
        };
        let given = [
            number("bitNr", bit.unwrap_or(NO_BIT)),
            number("bitSize", if bit.is_some() { 1 } else { bits(place.ty) }),
            number("class", self.var_class(place.ty)),
            text("typeName", &self.type_name(place.ty), TYPE_NAME_MAX),
            number("elements", elements.map_or(0, |(_, count)| i128::from(count))),
            number("baseClass", element.map_or(NO_CLASS, |element| self.var_class(element))),
            number("elementBits", element.map_or(0, bits)),
            text("symbol", &written(argument), SYMBOL_MAX),
        ];
        let argument = |(name, literal): (String, Literal)| {
            let value = ast::Expr { kind: ast::ExprKind::Literal(literal), span, height: 1 };
            ast::Argument::Input(Ident { text: name, span }, value)
        };
        given.into_iter().map(argument).collect()
    }

    fn var_class(&self, ty: TypeId) -> i128 {
        self.class_and_kind(ty).map_or(NO_CLASS, |(class, _)| class)
    }
}

/// A variable's name as it is written, without indices.
fn written(expr: &ast::Expr) -> String {
    match &expr.kind {
        ast::ExprKind::Name(name) => name.text.clone(),
        ast::ExprKind::Member(base, name) | ast::ExprKind::Part(base, name) => {
            format!("{}.{}", written(base), name.text)
        }
        ast::ExprKind::Index(base, _) | ast::ExprKind::Dereference(base) | ast::ExprKind::Paren(base) => written(base),
        _ => String::new(),
    }
}
