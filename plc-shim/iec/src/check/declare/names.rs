//! What the files declare, by name, before any of it is resolved.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Declarations;
use super::class::{Class, Membership, Role};
use super::entry::{GlobalEntry, PouEntry, Progress, TypeEntry};
use super::start::Starts;
use crate::check::standard;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Dialect, Feature};
use crate::ir::{ElementaryType, PouId};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, TypeDeclaration};

impl<'a> Declarations<'a> {
    pub(super) fn collect_pou(&mut self, ast: &'a ast::Pou) {
        // The library comes last: what it finds taken, the user has named like the standard.
        if self.library.contains(&ast.name.span.file)
            && let Some(user) = self.declared_at(&ast.name)
        {
            // Functions of the 3rd edition are younger than many programs, whose own go before.
            let may_be_own = self.dialect(user).has(Feature::OwnStandardBlocks);
            if ast.kind != ast::PouKind::Function && !may_be_own {
                self.report_reserved(&ast.name, user);
            }
            return;
        }
        let is_own_function = ast.kind == PouKind::Function
            && self.declared_at(&ast.name).is_none()
            && standard::is_reserved(&ast.name.key())
            && (self.has_own_standard_functions(ast.name.span) || self.home.is_named());
        if self.stands_beside(ast) {
            self.add_overload(ast);
            return;
        }
        if !is_own_function && self.is_taken(&ast.name) {
            return;
        }
        self.add_unit(ast);
        // What is made of a generic block stands where that does.
        let templates = self.templates;
        templates.made_of(ast).for_each(|made| self.add_unit(made));
    }

    /// In SCL they have quotation marks wherever they are called.
    fn has_own_standard_functions(&self, span: Span) -> bool {
        let dialect = self.dialect(span);
        dialect == Dialect::SiemensScl || dialect.has(Feature::OwnStandardFunctions)
    }

    fn add_unit(&mut self, ast: &'a ast::Pou) {
        let id = self.add_pou(ast, None);
        let key = self.home.key(&ast.name);
        if let Some(short) = self.home.short_key(&ast.name) {
            self.open.units.entry(short).or_insert_with(|| key.clone());
        }
        self.pou_names.insert(key, id);
        let mut class = Class::default();
        for member in &ast.object.members {
            let role = member.kind.into();
            let found = self.add_pou(&member.pou, Some(Membership { owner: id, role }));
            let name = &member.pou.name;
            if let Some(first) = class.members.insert((role, self.overloads.member_key(&member.pou, role)), found) {
                self.report_duplicate(name, Some(self.pou(first).ast.name.span));
            }
            match role {
                Role::Getter | Role::Setter => self.property_names.insert(name.key()),
                Role::Method | Role::Body | Role::Start | Role::AfterStart | Role::End => {
                    self.method_names.insert(name.key())
                }
            };
        }
        if ast.kind != PouKind::Function {
            self.classes.insert(id, class);
            self.collect_stages(id);
        }
    }

    pub(super) fn add_pou(&mut self, ast: &'a ast::Pou, membership: Option<Membership>) -> PouId {
        let id = PouId(self.pous.len() as u32);
        let (home, progress) = (self.home.with(&ast.object.using), Progress::Untouched);
        let image = Arc::from([]);
        let (starts, fleeting) = (Starts::default(), Arc::default());
        self.pous.push(PouEntry {
            ast,
            home,
            membership,
            progress,
            scope: None,
            align: 1,
            image,
            starts,
            fleeting,
            kept: BTreeMap::new(),
        });
        id
    }

    pub(super) fn collect_type(&mut self, ast: &'a TypeDeclaration) {
        // The library comes last. What it declares of vendors many projects declare for themselves.
        if self.library.contains(&ast.name.span.file) && self.declared_at(&ast.name).is_some() {
            return;
        }
        if !self.is_taken(&ast.name) {
            let (home, progress) = (self.home.clone(), Progress::Untouched);
            let entry = TypeEntry { ast, home, progress, reserved: None, resolved: None };
            let key = self.home.key(&ast.name);
            if let Some(short) = self.home.short_key(&ast.name) {
                self.open.types.entry(short).or_insert_with(|| key.clone());
            }
            self.type_names.insert(key, entry);
        }
    }

    pub(super) fn collect_globals(&mut self, section: &'a ast::Section) {
        for variable in &section.variables {
            for name in &variable.names {
                let key = self.home.key(name);
                if let Some(first) = self.globals.get(&key) {
                    if self.library.contains(&name.span.file) {
                        continue;
                    }
                    let first = first.ast.map(|_| first.span);
                    self.report_duplicate(name, first);
                    continue;
                }
                let entry = GlobalEntry {
                    ast: Some((variable, &section.qualifiers)),
                    name: name.text.clone(),
                    seen_from: self.home.clone(),
                    span: name.span,
                    progress: Progress::Untouched,
                    variable: None,
                    home: None,
                };
                if let Some(short) = self.home.short_key(name) {
                    self.open.globals.entry(short).or_insert_with(|| key.clone());
                }
                self.globals.insert(key, entry);
            }
        }
    }

    /// True, with a report, if a type or unit of the name exists already.
    fn is_taken(&mut self, name: &Ident) -> bool {
        if ElementaryType::find(&name.text).is_some()
            || matches!(name.key().as_str(), "STRING" | "WSTRING")
            || standard::is_reserved(&name.key())
        {
            self.report_reserved(name, name.span);
            return true;
        }
        let first = self.declared_at(name);
        if first.is_some() {
            self.report_duplicate(name, first);
        }
        first.is_some()
    }

    /// Where a unit or type of the name is declared.
    fn declared_at(&self, name: &Ident) -> Option<Span> {
        let key = self.home.key(name);
        let pou = self.pou_names.get(&key).map(|id| self.pou(*id).ast.name.span);
        pou.or_else(|| self.type_names.get(&key).map(|ty| ty.ast.name.span))
    }

    fn report_reserved(&mut self, name: &Ident, span: Span) {
        let message = format!("`{}` is a name of the standard", name.text);
        self.report(Diagnostic::error(Code::ReservedName, span, message));
    }

    pub(in crate::check) fn report_duplicate(&mut self, name: &Ident, first: Option<Span>) {
        let message = format!("`{}` is declared twice", name.text);
        let mut found = Diagnostic::error(Code::DuplicateName, name.span, message);
        if let Some(first) = first {
            found = found.with_label(first, "first declared here");
        }
        self.report(found);
    }
}
