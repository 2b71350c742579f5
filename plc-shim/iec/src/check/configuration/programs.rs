//! Instances of programs (2nd ed. 2.7.1).

use super::Configurer;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::dialect::Dialect;
use crate::ir::{PouId, Program, Retention};
use crate::syntax::ast::{self, Ident, PouKind, ProgramDeclaration, SectionKind};

impl<'a> Configurer<'_, 'a> {
    /// Places the programs of a resource.
    pub(super) fn place_instances(&mut self, resource: &'a ast::Resource, index: usize) {
        let names: Vec<&Ident> = resource.programs.iter().map(|program| &program.name).collect();
        self.declarations.report_twins(&names);
        for declared in &resource.programs {
            let Some(pou) = self.program_type(&declared.program) else { continue };
            self.report_hidden(declared);
            let retention = Retention::of(declared.qualifier.as_slice());
            self.place_program(pou, &declared.name, Some(index), retention);
        }
    }

    /// Every other program has one instance, under its own name.
    pub(super) fn place_other_programs(&mut self) {
        for id in self.declarations.unit_ids() {
            let ast = self.declarations.pou(id).ast();
            if ast.kind != PouKind::Program || self.declarations.programs().iter().any(|program| program.pou == id) {
                continue;
            }
            self.place_program(id, &ast.name, None, None);
        }
    }

    /// What no resource declares never runs, unless another unit calls it, as vendors allow.
    pub(super) fn report_idle_programs(&mut self) {
        let Some(ast) = self.declarations.configuration() else { return };
        let declared: usize = ast.resources.iter().map(|resource| resource.programs.len()).sum();
        // A program may be the one that is meant by a wrong name.
        if self.declarations.programs().iter().filter(|program| program.resource.is_some()).count() < declared {
            return;
        }
        let called = self.declarations.called();
        for program in self.declarations.programs().to_vec() {
            if program.resource.is_some() || called.contains(&program.pou) {
                continue;
            }
            let span = self.declarations.pou(program.pou).ast().name.span;
            let name = program.name;
            let message = format!("program `{name}` has no instance in the configuration, so it never runs");
            let help = format!("write `PROGRAM {name} WITH .. : {name};` in one of its resources");
            self.declarations.report(Diagnostic::warning(Code::ProgramNeverRuns, span, message).with_help(help));
        }
    }

    /// Notes which programs other units call.
    pub(super) fn note_called_programs(&mut self) {
        let called = self.declarations.called();
        for program in self.declarations.programs_mut() {
            program.is_called = program.runs_at_start || called.contains(&program.pou);
        }
    }

    fn place_program(&mut self, pou: PouId, name: &Ident, resource: Option<usize>, retention: Option<Retention>) {
        let (size, align, image) = self.declarations.pou(pou).instance();
        let is_first = self.declarations.programs().iter().all(|program| program.pou != pou);
        let offset = if is_first {
            self.declarations.first_instance(pou, name.span)
        } else {
            self.declarations.allocate(size, align, name.span)
        };
        if let Some(offset) = offset {
            // The type of the program's instances, for paths that lead through them.
            let unit = &self.declarations.pou(pou).ast().name.text;
            let ty = self.declarations.types_mut().block(unit, pou);
            self.declarations.types_mut().complete_block(ty, align, image.clone());
            self.declarations.place(offset, image);
            self.declarations.add_program(Program {
                name: name.text.clone(),
                pou,
                offset,
                resource,
                retention,
                is_called: false,
                runs_at_start: self.declarations.pou(pou).ast().object.runs_at_start,
            });
        }
    }

    fn program_type(&mut self, name: &Ident) -> Option<PouId> {
        let found = self.declarations.unit_of_key(&name.key());
        if let Some(pou) = found
            && self.declarations.pou(pou).ast().kind == PouKind::Program
        {
            return Some(pou);
        }
        if found.is_none() && self.is_task_of_library(name) {
            let message = format!(
                "program `{}` does not exist, and the project has no other program; this task runs nothing",
                name.text
            );
            let help = "a library needs no program; an application declares one of this name";
            self.declarations.report(Diagnostic::warning(Code::UnknownProgram, name.span, message).with_help(help));
            return None;
        }
        let (message, help) = if found.is_some() {
            (format!("`{}` is not a program", name.text), None)
        } else {
            let programs = self.declarations.unit_names(|kind| kind == PouKind::Program);
            let help = did_you_mean(&name.text, programs);
            (format!("program `{}` is not declared", name.text), help)
        };
        self.declarations.report(Diagnostic::error(Code::UnknownProgram, name.span, message).with_optional_help(help));
        None
    }

    /// True for the task that TwinCAT puts into each new project, where the project is a library without programs.
    fn is_task_of_library(&self, name: &Ident) -> bool {
        let has_programs = self.declarations.unit_names(|kind| kind == PouKind::Program).next().is_some();
        self.declarations.dialect(name.span) == Dialect::TwinCat && !has_programs
    }

    /// A task gives a program's `VAR_IN_OUT` nothing, so such a program is for others to call.
    pub(super) fn report_unbound_programs(&mut self) {
        for program in self.declarations.programs().to_vec() {
            if program.is_called && program.resource.is_none() {
                continue;
            }
            let Some(scope) = self.declarations.pou(program.pou).scope().cloned() else { continue };
            for variable in scope.variables().iter().filter(|variable| variable.section == SectionKind::InOut) {
                let (name, given) = (&program.name, &variable.name);
                let message =
                    format!("VAR_IN_OUT `{given}` of program `{name}` is never assigned; a task cannot pass one");
                let help = format!("call it from another program, as `{name}({given} := ..);`");
                self.declarations.report(Diagnostic::error(Code::WrongSection, variable.span, message).with_help(help));
            }
        }
    }

    /// Paths begin with globals, resources and programs alike.
    fn report_hidden(&mut self, declared: &ProgramDeclaration) {
        if let Some((_, first)) = self.declarations.global_declared(&declared.name.key()) {
            self.declarations.report_duplicate(&declared.name, Some(first));
        }
    }
}
