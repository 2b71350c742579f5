//! What runs with a program: its inputs before, its outputs after it (2nd ed. 2.7.1).

use std::collections::BTreeMap;

use super::Configurer;
use crate::check::body::Body;
use crate::check::declare::Scope;
use crate::check::types::operand::{Operand, constant};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Dialect;
use crate::ir::{
    ElementaryType, Entry, Expr, ExprKind, Guard, InstanceCall, Place, Pou, PouId, Program, Statement, StatementKind,
    Storage, Target, Type, Value,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, Connection, INITIAL_CALL, Ident, ProgramDeclaration, SectionKind};

/// The statements around an instance's call.
#[derive(Default)]
pub(super) struct Around {
    pub(super) before: Side,
    pub(super) after: Side,
}

/// Statements with the registers that they need.
#[derive(Default)]
pub(super) struct Side {
    pub(super) statements: Vec<Statement>,
    scope: Scope,
}

fn unit(name: &str, side: Side, span: Span) -> Pou {
    Pou {
        name: name.to_owned(),
        span,
        variables: Vec::new(),
        registers: side.scope.into_registers(),
        parameters: 0,
        result: None,
        guard: Guard::None,
        body: side.statements,
    }
}

impl<'a> Configurer<'_, 'a> {
    /// An entry for each program, then one for each function block with a task of its own.
    pub(super) fn make_entries(&mut self) {
        let declared: Vec<Option<(&'a ast::Resource, &'a ProgramDeclaration)>> =
            (0..self.declarations.programs().len()).map(|at| self.declaration_of(at)).collect();
        let mut blocks = Vec::new();
        for (at, declared) in declared.into_iter().enumerate() {
            let program = self.declarations.programs()[at].clone();
            let span =
                declared.map_or(self.declarations.pou(program.pou).ast().name.span, |(_, declared)| declared.name.span);
            let mut around = Around::default();
            around.before.statements = self.select_globals(program.resource, span);
            self.copy_locations(at, &mut around);
            for connection in declared.into_iter().flat_map(|(_, declared)| &declared.connections) {
                match connection {
                    Connection::Input(input, source) => self.connect_input(at, input, source, &mut around.before),
                    Connection::Output(output, target) => self.connect_output(at, output, target, &mut around.after),
                    Connection::Task(block, task) => {
                        blocks.extend(declared.and_then(|(resource, _)| self.task_block(at, block, task, resource)));
                        Some(())
                    }
                };
            }
            self.clear_initial_call(&program, span, &mut around.after);
            let name = self.entry_name(at);
            let entry = self.entry(name, program.pou, program.offset, around, span);
            self.configured.entries.push(entry);
            if let Some((resource, declared)) = declared {
                let task = declared.task.as_ref().map(|task| self.task_named(resource, task));
                // What names a task that is not there has been reported.
                self.schedule(program.resource, at, task.map(|task| task.unwrap_or(usize::MAX)));
            }
        }
        for (resource, task, entry) in blocks {
            self.schedule(resource, self.configured.entries.len(), Some(task));
            self.configured.entries.push(entry);
        }
    }

    /// `Initial_Call` of an organization block is TRUE in its first call alone.
    fn clear_initial_call(&self, program: &Program, span: Span, side: &mut Side) {
        let unit = self.declarations.pou(program.pou);
        let is_block = self.declarations.dialect(unit.ast().name.span) == Dialect::SiemensScl;
        let Some(variable) = unit.scope().filter(|_| is_block).and_then(|scope| scope.find(INITIAL_CALL)) else {
            return;
        };
        let bool = ElementaryType::Bool;
        if let (SectionKind::Input, Storage::Instance(offset)) = (variable.section, variable.storage)
            && variable.ty == bool.into()
        {
            let target = Place::whole(Storage::Absolute(program.offset + offset), variable.ty, span);
            let kind = StatementKind::Assign(target, constant(Value::Bool(false), bool, span));
            side.statements.push(Statement { kind, span });
        }
    }

    fn schedule(&mut self, resource: Option<usize>, entry: usize, task: Option<usize>) {
        let Some(resource) = resource.and_then(|index| self.configured.resources.get_mut(index)) else { return };
        match task {
            None => resource.background.push(entry),
            Some(task) => {
                if let Some(task) = resource.tasks.get_mut(task) {
                    task.entries.push(entry);
                }
            }
        }
    }

    fn declaration_of(&self, program: usize) -> Option<(&'a ast::Resource, &'a ProgramDeclaration)> {
        let program = self.declarations.programs().get(program)?;
        let resource = self.declarations.configuration()?.resources.get(program.resource?)?;
        let named = |each: &&ProgramDeclaration| each.name.text == program.name;
        Some((resource, resource.programs.iter().find(named)?))
    }

    /// The instance's name, with its resource's in front where others have the same.
    fn entry_name(&mut self, at: usize) -> String {
        let name = self.declarations.programs()[at].name.clone();
        let twins = self.declarations.programs().iter().filter(|other| other.name.eq_ignore_ascii_case(&name)).count();
        if twins > 1 { self.program_target(at).path } else { name }
    }

    /// What copies the inputs, if there are any; the call; what copies the outputs.
    fn entry(&mut self, name: String, pou: PouId, offset: u32, around: Around, span: Span) -> Entry {
        let Around { before, after } = around;
        let ty = self.declarations.types_mut().block(&name, pou);
        let mut scope = Scope::default();
        let pointer = scope.register(ElementaryType::Udint);
        let instance = Place::whole(Storage::Absolute(offset), ty, span);
        let call = InstanceCall::bare(instance, pou, pointer);
        let body = vec![Statement { kind: StatementKind::CallInstance(Box::new(call)), span }];
        let call = Side { statements: body, scope };
        let sides = [before, call, after].into_iter().filter(|side| !side.statements.is_empty());
        let units = sides.map(|side| unit(&name, side, span)).collect();
        self.declarations.enqueue(pou);
        Entry { name, units }
    }

    fn connect_input(&mut self, at: usize, input: &ast::Expr, source: &ast::Expr, side: &mut Side) -> Option<()> {
        let target = self.target_in_program(at, input)?;
        self.wants_section(&target, SectionKind::Input, input.span)?;
        let resource = self.declarations.programs()[at].resource;
        let global = self.is_configured_path(source, resource).then(|| self.target(source, resource));
        let mut body = Body::new(self.declarations, std::mem::take(&mut side.scope), None);
        let value = match global {
            Some(None) => None,
            Some(Some(found)) => {
                let value = loaded(&found, source.span);
                let ty = body.declarations().types().of_value(value.ty);
                body.coerce(Operand::Typed(Expr { ty, ..value }), target.ty)
            }
            None => body.expression_for(source, target.ty),
        };
        let statement = value.map(|value| body.assignment(place(&target, input.span), value, source.span));
        side.scope = body.into_scope();
        side.statements.push(statement?);
        Some(())
    }

    fn connect_output(&mut self, at: usize, output: &ast::Expr, sink: &ast::Expr, side: &mut Side) -> Option<()> {
        let source = self.target_in_program(at, output)?;
        self.wants_section(&source, SectionKind::Output, output.span)?;
        let resource = self.declarations.programs()[at].resource;
        let sink_place = if matches!(sink.kind, ast::ExprKind::DirectAddress(_)) {
            Body::outside(self.declarations).target(sink)?
        } else {
            let found = self.target(sink, resource)?;
            if found.variable.as_ref().is_some_and(|variable| variable.is_constant) {
                let message = "a constant is not assigned to";
                self.declarations.report(Diagnostic::error(Code::AssignToConstant, sink.span, message));
                return None;
            }
            place(&found, sink.span)
        };
        let mut body = Body::new(self.declarations, std::mem::take(&mut side.scope), None);
        let value = loaded(&source, output.span);
        let ty = body.declarations().types().of_value(value.ty);
        let value = body.coerce(Operand::Typed(Expr { ty, ..value }), sink_place.ty);
        let statement = value.map(|value| body.assignment(sink_place, value, output.span));
        side.scope = body.into_scope();
        side.statements.push(statement?);
        Some(())
    }

    /// Inputs are connected by `:=`, outputs by `=>`.
    fn wants_section(&mut self, target: &Target, wanted: SectionKind, span: Span) -> Option<()> {
        let variable = target.variable.as_ref()?;
        if variable.section == wanted {
            return Some(());
        }
        let (kind, mark) = if wanted == SectionKind::Input { ("an input", ":=") } else { ("an output", "=>") };
        let message = format!("`{}` is not {kind}, which `{mark}` wants", target.path);
        let found = Diagnostic::error(Code::UnsuitableConnection, span, message);
        self.declarations.report(found.with_label(variable.span, "declared here"));
        None
    }

    /// `fb WITH task`: the resource, its task, what runs.
    fn task_block(
        &mut self,
        at: usize,
        block: &ast::Expr,
        task: &Ident,
        resource: &'a ast::Resource,
    ) -> Option<(Option<usize>, usize, Entry)> {
        let task = self.task_named(resource, task);
        let target = self.target_in_program(at, block)?;
        let Type::FunctionBlock { pou, name } = self.declarations.types().get(target.ty).clone() else {
            let message = format!(
                "only instances of function blocks have tasks, this is {}",
                self.declarations.types().name(target.ty)
            );
            self.declarations.report(Diagnostic::error(Code::UnsuitableConnection, block.span, message));
            return None;
        };
        let scope = self.declarations.interface(pou, block.span)?;
        if let Some(reference) = scope.inputs().find(|input| input.section == SectionKind::InOut) {
            let message = format!("{name} has a VAR_IN_OUT `{}`, which nobody gives it here", reference.name);
            self.declarations.report(Diagnostic::error(Code::UnsuitableConnection, block.span, message));
            return None;
        }
        let program = self.declarations.programs()[at].clone();
        self.configured.task_blocks.push((at, target.inside - program.offset, block.span));
        let mut around = Around::default();
        around.before.statements = self.select_globals(program.resource, block.span);
        let inside = target.path.strip_prefix(&self.program_target(at).path).unwrap_or(&target.path).to_owned();
        let name = format!("{}{inside}", self.entry_name(at));
        let entry = self.entry(name, pou, target.inside, around, block.span);
        Some((program.resource, task?, entry))
    }

    /// The task alone runs such an instance (2nd ed. 2.7.2), so its program must not.
    pub(super) fn report_double_calls(&mut self, checked: &BTreeMap<PouId, Pou>) {
        for (program, offset, span) in self.configured.task_blocks.clone() {
            let Some(unit) = self.declarations.programs().get(program).and_then(|program| checked.get(&program.pou))
            else {
                continue;
            };
            if let Some(call) = call_of(&unit.body, offset) {
                let message = "this instance has a task of its own, and its program calls it too";
                let found = Diagnostic::error(Code::BlockCalledTwice, span, message).with_label(call, "called here");
                let help = "assign to its inputs and read its outputs, without a call";
                self.declarations.report(found.with_help(help));
            }
        }
    }
}

pub(in crate::check) fn place(target: &Target, span: Span) -> Place {
    let place = Place::whole(target.storage, target.ty, span);
    if target.inside == 0 { place } else { place.member(target.inside, target.ty) }
}

pub(super) fn loaded(target: &Target, span: Span) -> Expr {
    Expr { kind: ExprKind::Load(place(target, span)), ty: target.ty, span }
}

/// Where statements call the instance at this offset of their own one.
fn call_of(statements: &[Statement], offset: u32) -> Option<Span> {
    let mut open: Vec<&Statement> = statements.iter().collect();
    while let Some(statement) = open.pop() {
        match &statement.kind {
            StatementKind::CallInstance(call) => {
                let place = &call.instance;
                if constant_offset(place) == Some(offset) {
                    return Some(statement.span);
                }
            }
            StatementKind::If(branches, otherwise) => {
                open.extend(branches.iter().flat_map(|branch| &branch.body).chain(otherwise));
            }
            StatementKind::Case(inner) => {
                open.extend(inner.arms.iter().flat_map(|arm| &arm.body).chain(&inner.otherwise));
            }
            StatementKind::For(inner) => open.extend(&inner.body),
            StatementKind::Labelled(inner) => {
                open.extend(inner.first.iter().chain(inner.parts.iter().flat_map(|(_, part)| part)));
            }
            StatementKind::While(_, body) | StatementKind::Repeat(body, _) => open.extend(body),
            // The others have no statements inside.
            _ => {}
        }
    }
    None
}

fn constant_offset(place: &Place) -> Option<u32> {
    let Storage::Instance(start) = place.storage else { return None };
    place.steps.iter().try_fold(start, |offset, step| match step {
        crate::ir::Step::Offset(further) => Some(offset + further),
        _ => None,
    })
}
