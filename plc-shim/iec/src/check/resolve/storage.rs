//! Where a unit's variables lie: in its instance, in registers, in memory of its own (2nd ed. 2.4.2).

use std::sync::Arc;

use super::interface::{Interface, POINTER};
use crate::check::declare::{TypedImage, align_up};
use crate::check::types::parameter::takes_open_arrays;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{EdgeDetection, ElementaryType, Storage, TypeId, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, Section, SectionKind};

impl Interface<'_, '_> {
    /// Where a variable that no direct address places lies; its unit's kind and its section say it.
    pub(in crate::check) fn storage(
        &mut self,
        section: &Section,
        declared: &TypedImage<'_>,
        name: &Ident,
    ) -> Option<Storage> {
        let span = name.span;
        if !takes_open_arrays(self.kind, section.kind) {
            self.written().body.reject_open_array(declared.ty, span)?;
        } else if matches!(section.kind, SectionKind::Input | SectionKind::Output)
            && self.written().body.is_open(declared.ty)
        {
            return Some(Storage::RegisterPointer(self.scope_mut().register(POINTER)));
        }
        match (self.kind, section.kind) {
            (_, SectionKind::Instance) => self.kept_storage(section, name),
            (kind, SectionKind::Input) if kind.keeps_nothing() => Some(self.parameter(declared, name)?),
            (PouKind::Method, SectionKind::InOut | SectionKind::Output) | (PouKind::Function, SectionKind::InOut) => {
                Some(Storage::RegisterPointer(self.scope_mut().register(POINTER)))
            }
            // The caller reads outputs after the call, so they outlive it.
            (PouKind::Function, SectionKind::Output) | (_, SectionKind::Static) => self.frame(declared, span),
            (kind, section) if kind.keeps_nothing() || section == SectionKind::Temp => {
                if !self.declarations().dialect(span).has(Feature::FleetingInstances) {
                    self.reject_instance(declared.ty, span)?;
                }
                self.temporary(declared, name)
            }
            (PouKind::Program, SectionKind::InOut) if self.is_own_in_out(section) => {
                Some(Storage::Instance(self.in_instance(declared, span)?))
            }
            // Where nobody calls a program, nobody could give the variable.
            (PouKind::Program, SectionKind::InOut)
                if !self.declarations().dialect(span).has(Feature::ProgramInstances) =>
            {
                let message = "a program has no VAR_IN_OUT";
                self.report(Diagnostic::error(Code::WrongSection, span, message));
                None
            }
            (_, SectionKind::InOut) => {
                let pointer: TypeId = POINTER.into();
                let image = vec![0; POINTER.size() as usize].into();
                let offset = self.in_instance(&TypedImage::plain(pointer, image), span)?;
                Some(Storage::InstancePointer(offset))
            }
            _ => Some(Storage::Instance(self.in_instance(declared, span)?)),
        }
    }

    /// True for a `VAR_IN_OUT` that nobody can give: one of a program as `MatIEC` has it, a variable like any other.
    pub(super) fn is_own_in_out(&self, section: &Section) -> bool {
        section.kind == SectionKind::InOut
            && self.kind == PouKind::Program
            && self.declarations().dialect(section.span).has(Feature::ProgramInOuts)
    }

    /// The trigger of an input with `R_EDGE` or `F_EDGE`.
    pub(super) fn edge_detection(&mut self, edge: ast::Edge, variable: &Variable) -> Option<EdgeDetection> {
        let bool_type: TypeId = ElementaryType::Bool.into();
        let suitable = variable.section == SectionKind::Input && !self.kind.keeps_nothing();
        if !suitable || variable.ty != bool_type {
            let message = "R_EDGE and F_EDGE are for BOOL inputs of function blocks and programs";
            self.report(Diagnostic::error(Code::WrongSection, variable.span, message));
            return None;
        }
        let image = Arc::from([0]);
        let memory = Storage::Instance(self.in_instance(&TypedImage::plain(bool_type, image), variable.span)?);
        let seen = self.scope_mut().register(ElementaryType::Bool);
        Some(EdgeDetection { edge, memory, seen })
    }

    /// Functions keep nothing between calls (2nd ed. 2.5.1), instances do.
    fn reject_instance(&mut self, ty: TypeId, span: Span) -> Option<()> {
        if matches!(self.declarations().types().get(ty), crate::ir::Type::FunctionBlock { .. }) {
            let message = "a function or VAR_TEMP section keeps nothing, so it has no instances";
            let found = Diagnostic::error(Code::WrongSection, span, message);
            self.report(found.with_help("declare it in VAR or pass it by VAR_IN_OUT"));
            return None;
        }
        Some(())
    }

    /// A value comes in a register, an aggregate's address too; the callee copies that.
    pub(in crate::check) fn parameter(&mut self, declared: &TypedImage<'_>, name: &Ident) -> Option<Storage> {
        if let Some(ty) = self.written().body.elementary(declared.ty) {
            let register = self.scope_mut().register(ty);
            let referred = self.referred.contains(&name.key());
            return if referred { self.frame(declared, name.span) } else { Some(Storage::Register(register)) };
        }
        self.scope_mut().register(POINTER);
        self.frame(declared, name.span)
    }

    pub(in crate::check) fn temporary(&mut self, declared: &TypedImage<'_>, name: &Ident) -> Option<Storage> {
        match self.written().body.elementary(declared.ty) {
            Some(ty) if !self.referred.contains(&name.key()) => Some(Storage::Register(self.scope_mut().register(ty))),
            _ => self.frame(declared, name.span),
        }
    }

    /// Fixed memory: no unit is active twice (2nd ed. 2.5, no recursion).
    fn frame(&mut self, declared: &TypedImage<'_>, span: Span) -> Option<Storage> {
        self.scope_mut().keep_memory();
        let types = self.declarations().types();
        let (size, align) = (types.size(declared.ty), types.align(declared.ty));
        let offset = self.declarations_mut().allocate(size, align, span)?;
        self.declarations_mut().place(offset, declared.image.clone());
        Some(Storage::Absolute(offset))
    }

    pub(super) fn in_instance(&mut self, declared: &TypedImage<'_>, span: Span) -> Option<u32> {
        let align = self.declarations().types().align(declared.ty);
        let offset = align_up(self.image.len() as u32, align);
        let size = declared.image.len() as u64;
        if u64::from(offset) + size > self.declarations().memory_limit() {
            self.declarations_mut().report_too_large(span, Some(size));
            return None;
        }
        self.declarations_mut().charge_image(size, span)?;
        self.align = self.align.max(align);
        self.image.resize(offset as usize, 0);
        self.image.extend_from_slice(&declared.image);
        Some(offset)
    }
}
