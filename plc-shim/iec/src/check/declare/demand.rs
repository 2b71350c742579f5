//! What is resolved when it is first needed, once. What is being resolved and needed again contains itself.

use std::sync::Arc;

use super::entry::{Declared, Progress, TypedImage};
use super::layout::align_up;
use super::scope::Scope;
use super::{Declarations, MAX_DEPTH};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{PouId, TypeId, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, Qualifier, TypeSpecKind};

/// Works out what a declaration means. That takes expressions, which stand above this room and need declarations in
/// their turn; so the declarations are made with one, and ask it for what they do not know yet.
pub(in crate::check) trait Resolve {
    /// A type, with what its variables begin with.
    fn type_declaration<'a>(
        &self,
        declarations: &mut Declarations<'a>,
        ast: &'a ast::TypeDeclaration,
    ) -> Option<TypedImage<'a>>;

    /// The type that a name means where it stands; reports one that means none.
    fn type_meant(&self, declarations: &mut Declarations<'_>, name: &Ident) -> Option<TypeId>;

    /// A global variable in its place.
    fn global_variable<'a>(
        &self,
        declarations: &mut Declarations<'a>,
        name: &Ident,
        ast: &'a ast::Variable,
        qualifiers: &[Qualifier],
    ) -> Option<Variable>;

    /// The value of a constant that a generic block is given, where the unit names it.
    fn template_argument(
        &self,
        declarations: &mut Declarations<'_>,
        unit: Option<PouId>,
        argument: &ast::Expr,
    ) -> Option<i128>;

    /// The variables of a unit, and its instances.
    fn unit<'a>(&self, declarations: &mut Declarations<'a>, id: PouId) -> Declared<'a>;
}

/// Whether the size of a type matters where it is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum Need {
    /// A variable is made of it.
    Size,
    /// Only its address is kept.
    Reference,
}

impl<'a> Declarations<'a> {
    /// A type of a `TYPE` block; `used` is where it is needed.
    pub(in crate::check) fn named_type(&mut self, key: &str, used: Option<Span>) -> Option<TypedImage<'a>> {
        let entry = self.type_names.get_mut(key)?;
        let (ast, home) = (entry.ast, entry.home.clone());
        match entry.progress {
            Progress::Done => return entry.resolved.clone(),
            Progress::Running => {
                self.report_recursive_type(&ast.name, used);
                return None;
            }
            Progress::Untouched => entry.progress = Progress::Running,
        }
        let resolve = |declarations: &mut Self| {
            declarations.deeper(ast.name.span, |declarations| declarations.resolver.type_declaration(declarations, ast))
        };
        let resolved = self.at_home(home, resolve);
        if let Some(entry) = self.type_names.get_mut(key) {
            entry.progress = Progress::Done;
            entry.resolved.clone_from(&resolved);
            if resolved.is_none() {
                self.unmade.extend(entry.reserved);
            }
        }
        resolved
    }

    /// The type that a name means here; reports one that means none.
    pub(in crate::check) fn type_meant(&mut self, name: &Ident) -> Option<TypeId> {
        self.resolver.type_meant(self, name)
    }

    /// The type of a structure that may not be resolved yet; nothing for other types.
    pub(in crate::check) fn reserved(&mut self, key: &str) -> Option<TypeId> {
        let entry = self.type_names.get_mut(key)?;
        let kind = &entry.ast.spec.kind;
        if !matches!(kind, TypeSpecKind::Struct(_) | TypeSpecKind::Overlapping(_) | TypeSpecKind::Union(_)) {
            return None;
        }
        let name = &entry.ast.name.text;
        Some(*entry.reserved.get_or_insert_with(|| self.types.structure(name.clone())))
    }

    /// The type that is kept for a name declared here.
    pub(in crate::check) fn own_reserved(&mut self, name: &Ident) -> Option<TypeId> {
        let key = self.home.key(name);
        self.reserved(&key)
    }

    fn report_recursive_type(&mut self, name: &Ident, used: Option<Span>) {
        let message = format!("type `{}` contains itself", name.text);
        let span = used.unwrap_or(name.span);
        self.report(Diagnostic::error(Code::Recursion, span, message));
    }

    /// Runs `resolve` one level deeper; what needs too many others in a row is reported.
    fn deeper<T>(&mut self, span: Span, resolve: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        if self.depth == MAX_DEPTH {
            let message = format!("more than {MAX_DEPTH} declarations need each other in a row");
            self.report(Diagnostic::error(Code::NestingTooDeep, span, message));
            return None;
        }
        self.depth += 1;
        let resolved = resolve(self);
        self.depth -= 1;
        resolved
    }
}

impl Declarations<'_> {
    /// A global variable, placed in memory; `used` is where it is needed.
    pub(in crate::check) fn global(&mut self, key: &str, used: Option<Span>) -> Option<Variable> {
        if self.globals.get(key)?.progress == Progress::Untouched
            && let Some(found) = self.alternative_global(key, used)
        {
            return Some(found);
        }
        let entry = self.globals.get_mut(key)?;
        let (progress, span) = (entry.progress, entry.span);
        if progress == Progress::Done {
            return entry.variable.clone();
        }
        let (ast, qualifiers) = entry.ast?;
        if progress == Progress::Running {
            let message = "the initial value of a variable needs the variable itself";
            self.report(Diagnostic::error(Code::Recursion, used.unwrap_or(span), message));
            return None;
        }
        entry.progress = Progress::Running;
        let home = entry.seen_from.clone();
        let name = ast.names.iter().find(|name| name.span == span);
        let place = |declarations: &mut Self| {
            declarations.deeper(span, |declarations| {
                declarations.resolver.global_variable(declarations, name?, ast, qualifiers)
            })
        };
        let variable = self.at_home(home, place);
        if let Some(entry) = self.globals.get_mut(key) {
            entry.progress = Progress::Done;
            entry.variable.clone_from(&variable);
        }
        variable
    }

    /// True for a global variable whose initial value is being worked out.
    pub(in crate::check) fn is_being_placed(&self, name: &str) -> bool {
        let key = self.global_key(name);
        key.and_then(|key| self.globals.get(&key)).is_some_and(|entry| entry.progress == Progress::Running)
    }

    /// Resolves a unit's variables and, for what has instances, their layout. Nothing, with a
    /// report, if the unit contains itself.
    pub(in crate::check) fn declare(&mut self, id: PouId, used: Option<Span>) -> Option<()> {
        let index = id.0 as usize;
        let ast = self.pou(id).ast;
        match self.pous[index].progress {
            Progress::Done => return Some(()),
            Progress::Running => {
                let message = format!("`{}` contains itself", ast.name.text);
                let span = used.unwrap_or(ast.name.span);
                self.report(Diagnostic::error(Code::Recursion, span, message));
                return None;
            }
            Progress::Untouched => self.pous[index].progress = Progress::Running,
        }
        let home = self.pou(id).home.clone();
        let declared = self.at_home(home, |declarations| {
            declarations.deeper(ast.name.span, |declarations| Some(declarations.resolver.unit(declarations, id)))
        });
        // Declarations that need too many others have been reported; such a unit has no variables.
        let Declared { scope, align, mut image, starts, fleeting, kept } = declared.unwrap_or_default();
        // At least a byte, as for structures.
        image.resize(align_up(image.len().max(1) as u32, align) as usize, 0);
        let (align, image): (u32, Arc<[u8]>) = (align.max(1), image.into());
        if ast.kind.has_instances() {
            let ty = self.types.block(&ast.name.text, id);
            self.types.complete_block(ty, align, image.clone());
        }
        let mut scope = scope;
        self.add_vendor_names(id, &mut scope);
        let entry = &mut self.pous[index];
        entry.scope = Some(Arc::new(scope));
        entry.align = align;
        entry.image = image;
        (entry.starts, entry.fleeting, entry.kept) = (starts.into(), fleeting.into(), kept);
        entry.progress = Progress::Done;
        Some(())
    }

    /// The interface of a unit that is not being declared right now.
    pub(in crate::check) fn interface(&mut self, id: PouId, used: Span) -> Option<Arc<Scope>> {
        self.declare(id, Some(used))?;
        self.pou(id).scope.clone()
    }
}

impl Declarations<'_> {
    pub(in crate::check) fn resolve_declarations(&mut self) {
        let names: Vec<String> = self.type_names.keys().cloned().collect();
        for name in names {
            self.named_type(&name, None);
        }
        let names: Vec<String> = self.globals.keys().cloned().collect();
        for name in names {
            self.global(&name, None);
        }
        for index in 0..self.pous.len() {
            let id = PouId(index as u32);
            if !self.is_library(id) && self.stage_of(id).is_none() && !self.lacks_constants(id) {
                self.declare(id, None);
                if !self.is_prototype(id) {
                    self.enqueue(id);
                }
            }
        }
    }
}
