//! Instances that are declared with arguments for their `FB_init`: `fb : FB(a := 1)`,
//! `fbs : ARRAY [1..2] OF FB[(a := 1), (a := 2)]` (CODESYS, TwinCAT).

use super::Written;
use crate::check::declare::{Given, Need, Occasion, StartKind, Starts, TypedImage};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{PouId, Type, TypeId};
use crate::syntax::Span;
use crate::syntax::ast::{Argument, Ident, InitArguments, TypeSpec, TypeSpecKind};

impl<'a> Written<'_, 'a> {
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
        let (pou, size) = (self.block_of(element, span)?, self.declarations().types().size(element));
        self.check_taken(pou, lists.first().map_or(&[], Vec::as_slice), span);
        let starts = lists.iter().zip(0_u32..).map(|(arguments, index)| {
            let at = arguments.first().map_or(span, argument_span);
            self.start(index * size, StartKind::Instance(pou, arguments), at)
        });
        Some(starts.collect())
    }

    fn block_of(&mut self, ty: TypeId, span: Span) -> Option<PouId> {
        if let Type::FunctionBlock { pou, .. } = self.declarations().types().get(ty) {
            return Some(*pou);
        }
        let message = format!("arguments are for instances of function blocks, this is {}", self.body.type_name(ty));
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

impl<'a> Written<'_, 'a> {
    /// Reports arguments of an instance whose block has no `FB_init`.
    fn check_taken(&mut self, pou: PouId, given: Given<'a>, span: Span) {
        let known = !self.declarations().may_inherit(pou);
        if !given.is_empty() && known && !self.declarations().has_hook(pou, Occasion::Start) {
            let name = &self.declarations().pou(pou).ast().name.text;
            let message = format!("`{name}` has no FB_init that takes arguments");
            let help = format!("inputs begin with values as in `: {name} := (..)`");
            self.report(Diagnostic::error(Code::TooManyArguments, span, message).with_help(help));
        }
    }
}
