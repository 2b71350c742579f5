//! Instances that are declared with arguments for their `FB_init`: `fb : FB(a := 1)`,
//! `fbs : ARRAY [1..2] OF FB[(a := 1), (a := 2)]` (CODESYS, TwinCAT).

use super::names::TypedImage;
use super::scope::Body;
use super::start::{StartKind, Starts};
use super::types::Need;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{PouId, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{Argument, Ident, InitArguments, TypeSpec, TypeSpecKind};

impl<'a> Body<'_, 'a> {
    pub(super) fn instance_with_arguments(
        &mut self,
        name: &Ident,
        arguments: &'a InitArguments,
        need: Need,
    ) -> Option<TypedImage<'a>> {
        let resolved = self.type_by_name(name, need)?;
        let pou = self.block_of(resolved.ty, name.span)?;
        match arguments {
            InitArguments::Same(arguments) => {
                self.check_taken(pou, arguments, name.span);
                let start = self.start(0, StartKind::Instance(pou, arguments), name.span);
                Some(TypedImage { starts: [start].into(), ..resolved })
            }
            InitArguments::Listed(_) => {
                let message = "a list of arguments is for the instances of an array";
                let found = Diagnostic::error(Code::InvalidInitialiser, name.span, message);
                self.report(found.with_help(format!("write {}(..)", name.text)));
                None
            }
        }
    }

    /// The type of an array's elements, and the arguments of each.
    pub(super) fn element_type(&mut self, spec: &'a TypeSpec) -> Option<(TypedImage<'a>, Option<&'a [Vec<Argument>]>)> {
        if let TypeSpecKind::Instance(name, InitArguments::Listed(lists)) = &spec.kind {
            let resolved = self.type_by_name(name, Need::Size)?;
            self.block_of(resolved.ty, name.span)?;
            return Some((resolved, Some(lists)));
        }
        Some((self.resolve(spec, Need::Size)?, None))
    }

    /// What a start does to an array of instances with arguments of their own.
    pub(super) fn listed_starts(
        &mut self,
        element: TypeId,
        lists: &'a [Vec<Argument>],
        count: u64,
        span: Span,
    ) -> Option<Starts<'a>> {
        if lists.len() as u64 != count {
            let message = format!("the array has {count} instances, and there are arguments for {}", lists.len());
            self.report(Diagnostic::error(Code::InvalidInitialiser, span, message));
            return None;
        }
        let (pou, size) = (self.block_of(element, span)?, self.checker.types.size(element));
        self.check_taken(pou, lists.first().map_or(&[], Vec::as_slice), span);
        let starts = lists.iter().zip(0_u32..).map(|(arguments, index)| {
            let at = arguments.first().map_or(span, argument_span);
            self.start(index * size, StartKind::Instance(pou, arguments), at)
        });
        Some(starts.collect())
    }

    fn block_of(&mut self, ty: TypeId, span: Span) -> Option<PouId> {
        if let Type::FunctionBlock { pou, .. } = self.checker.types.get(ty) {
            return Some(*pou);
        }
        let message = format!("arguments are for instances of function blocks, this is {}", self.type_name(ty));
        self.report(Diagnostic::error(Code::NotCallable, span, message));
        None
    }
}

fn argument_span(argument: &Argument) -> Span {
    match argument {
        Argument::Positional(value) => value.span,
        Argument::Input(name, _) | Argument::Output { name, .. } => name.span,
    }
}
