//! Programs as the global instances that they are with some vendors: `Cell(i := 1); x := Cell.n;`.

use super::Declarations;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::{PouId, Storage, Variable, Visibility};
use crate::syntax::Span;
use crate::syntax::ast::{Ident, PouKind, SectionKind};

impl Declarations<'_> {
    /// The program of this name, as it is seen from here.
    pub(in crate::check) fn program_of_name(&self, key: &str) -> Option<PouId> {
        self.pou_named(key).filter(|id| self.pou(*id).ast.kind == PouKind::Program)
    }

    /// The one instance of a program as a variable; reports one that there is not.
    pub(in crate::check) fn program_instance(&mut self, id: PouId, name: &Ident) -> Option<Variable> {
        let dialect = self.dialect(name.span);
        if !dialect.has(Feature::ProgramInstances) {
            let message = format!("`{}` is a program, which in {dialect} is not an instance", name.text);
            let homes = Feature::ProgramInstances.homes();
            let help = format!("it is one in {homes}: --dialect chooses; else make it a function block");
            self.report(Diagnostic::error(Code::NotCallable, name.span, message).with_help(help));
            return None;
        }
        self.interface(id, name.span)?;
        let offset = self.only_instance(id, name.span)?;
        let ast = self.pou(id).ast;
        let image = self.pou(id).image.clone();
        Some(Variable {
            name: ast.name.text.clone(),
            section: SectionKind::Global,
            ty: self.types.block(&ast.name.text, id),
            storage: Storage::Absolute(offset),
            constant: None,
            is_constant: false,
            retention: None,
            address: None,
            span: ast.name.span,
            image,
            edge: None,
            of_chart: false,
            visibility: Visibility::Public,
            owner: None,
        })
    }

    fn only_instance(&mut self, id: PouId, used: Span) -> Option<u32> {
        let instances: Vec<_> = self.programs.iter().filter(|program| program.pou == id).collect();
        if let [_, _, ..] = instances.as_slice() {
            let names: Vec<_> = instances.iter().map(|program| format!("`{}`", program.name)).collect();
            let message =
                format!("program `{}` has several instances: {}", self.pou(id).ast.name.text, names.join(", "));
            let found = Diagnostic::error(Code::NotCallable, used, message);
            self.report(found.with_help("only a program with one instance has a name of its own"));
            return None;
        }
        match instances.first() {
            Some(program) => Some(program.offset),
            None => self.first_instance(id, used),
        }
    }

    /// Where the first instance of a program lies: what needs its address may come before the configuration.
    pub(in crate::check) fn first_instance(&mut self, id: PouId, used: Span) -> Option<u32> {
        if let Some(offset) = self.program_places.get(&id) {
            return Some(*offset);
        }
        let (size, align, _) = self.pou(id).instance();
        let offset = self.allocate(size, align, used)?;
        self.program_places.insert(id, offset);
        Some(offset)
    }
}
