//! Instances of programs (2nd ed. 2.7.1).

use std::collections::BTreeSet;

use crate::check::declare::declarations::Checker;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{PouId, Program, Retention};
use crate::syntax::ast::{self, Ident, PouKind, ProgramDeclaration};

impl<'a> Checker<'a> {
    /// Places the programs of a resource.
    pub(in crate::check) fn place_instances(&mut self, resource: &'a ast::Resource, index: usize) {
        let names: Vec<&Ident> = resource.programs.iter().map(|program| &program.name).collect();
        self.report_twins(&names);
        for declared in &resource.programs {
            let Some(pou) = self.program_type(&declared.program) else { continue };
            self.report_hidden(declared);
            let retention = Retention::of(declared.qualifier.as_slice());
            self.place_program(pou, &declared.name, Some(index), retention);
        }
    }

    /// Every other program has one instance, under its own name.
    pub(in crate::check) fn place_other_programs(&mut self) {
        for index in 0..self.pous.len() {
            let id = PouId(index as u32);
            let ast = self.pou(id).ast;
            if ast.kind != PouKind::Program || self.programs.iter().any(|program| program.pou == id) {
                continue;
            }
            self.place_program(id, &ast.name, None, None);
        }
    }

    /// What no resource declares never runs, unless another unit calls it, as vendors allow.
    pub(in crate::check) fn report_idle_programs(&mut self) {
        let Some(ast) = self.configured.ast else { return };
        let declared: usize = ast.resources.iter().map(|resource| resource.programs.len()).sum();
        // A program may be the one that is meant by a wrong name.
        if self.programs.iter().filter(|program| program.resource.is_some()).count() < declared {
            return;
        }
        let called: BTreeSet<PouId> = self.calls.values().flatten().map(|(callee, _)| *callee).collect();
        for program in self.programs.clone() {
            if program.resource.is_some() || called.contains(&program.pou) {
                continue;
            }
            let span = self.pou(program.pou).ast.name.span;
            let name = program.name;
            let message = format!("program `{name}` has no instance in the configuration, so it never runs");
            let help = format!("write `PROGRAM {name} WITH .. : {name};` in one of its resources");
            self.report(Diagnostic::warning(Code::ProgramNeverRuns, span, message).with_help(help));
        }
    }

    fn place_program(&mut self, pou: PouId, name: &Ident, resource: Option<usize>, retention: Option<Retention>) {
        let (size, align, image) = self.pou(pou).instance();
        if let Some(offset) = self.allocate(size, align, name.span) {
            // The type of the program's instances, for paths that lead through them.
            let ty = self.types.block(&self.pou(pou).ast.name.text.clone(), pou);
            self.types.complete_block(ty, align, image.clone());
            self.placed.push((offset, image));
            self.programs.push(Program { name: name.text.clone(), pou, offset, resource, retention });
        }
    }

    fn program_type(&mut self, name: &Ident) -> Option<PouId> {
        let found = self.pou_names.get(&name.key()).copied();
        if let Some(pou) = found
            && self.pou(pou).ast.kind == PouKind::Program
        {
            return Some(pou);
        }
        let (message, help) = if found.is_some() {
            (format!("`{}` is no program", name.text), None)
        } else {
            let programs = self.pous.iter().filter(|pou| pou.ast.kind == PouKind::Program);
            let help = did_you_mean(&name.text, programs.map(|pou| pou.ast.name.text.as_str()));
            (format!("program `{}` is not declared", name.text), help)
        };
        self.report(Diagnostic::error(Code::UnknownProgram, name.span, message).with_optional_help(help));
        None
    }

    /// Paths begin with globals, resources and programs alike.
    fn report_hidden(&mut self, declared: &ProgramDeclaration) {
        if let Some(global) = self.globals.get(&declared.name.key()) {
            let first = global.span;
            self.report_duplicate(&declared.name, Some(first));
        }
    }
}
