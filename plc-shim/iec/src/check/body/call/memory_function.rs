//! Vendors' functions on bytes at addresses: of TwinCAT's `Tc2_System` and CODESYS' `SysMem`.

use crate::check::body::Body;
use crate::check::standard::memory::FUNCTIONS;
use crate::check::types::operand::{self, Operand};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Expr, ExprKind, Intrinsic, MemoryFunction, Rounding, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{Argument, Call, Ident};

impl Body<'_, '_> {
    pub(super) fn memory_call(&mut self, name: &Ident, call: &Call, span: Span) -> Option<Operand> {
        let key = name.key();
        let (_, function, parameters) = FUNCTIONS.iter().find(|(known, ..)| *known == key)?;
        let mut operands: [Option<Expr>; 3] = [None, None, None];
        for (index, argument) in call.arguments.iter().enumerate() {
            let (position, expr) = match argument {
                Argument::Positional(expr) => (Some(index), expr),
                Argument::Input(formal, expr) => (parameters.iter().position(|known| *known == formal.key()), expr),
                Argument::Output { name: formal, .. } => return self.no_parameter(name, formal.span),
            };
            let Some(slot) = position.and_then(|position| operands.get_mut(position)).filter(|slot| slot.is_none())
            else {
                return self.no_parameter(name, expr.span);
            };
            *slot = Some(self.memory_operand(expr)?);
        }
        let [Some(first), Some(second), Some(count)] = operands else {
            let message = format!("{key} takes 3 arguments, not {}", call.arguments.len());
            self.report(Diagnostic::error(Code::MissingArgument, span, message));
            return None;
        };
        let compares = *function == MemoryFunction::Compare;
        let ty: TypeId = if compares { ElementaryType::Dint } else { ElementaryType::Udint }.into();
        let kind = ExprKind::Intrinsic(Intrinsic::Memory(*function), vec![first, second, count]);
        Some(Operand::Typed(Expr { kind, ty, span }))
    }

    fn no_parameter<T>(&mut self, name: &Ident, span: Span) -> Option<T> {
        let message = format!("{} has no such parameter here", name.key());
        self.report(Diagnostic::error(Code::UnknownArgument, span, message));
        None
    }

    /// An address, a byte or a count: any of them as UDINT.
    fn memory_operand(&mut self, expr: &crate::syntax::ast::Expr) -> Option<Expr> {
        let udint = ElementaryType::Udint;
        let operand = self.within(Some(udint), |body| body.expression(expr))?;
        match operand {
            Operand::Typed(typed) => match *self.declarations.types().get(typed.ty) {
                Type::Elementary(ty) if ty.is_integer() || ty.is_bits() && ty != ElementaryType::Bool => {
                    Some(operand::converted(typed, udint, Rounding::NearestEven))
                }
                _ => self.coerce(Operand::Typed(typed), udint.into()),
            },
            other => self.coerce(other, udint.into()),
        }
    }
}
