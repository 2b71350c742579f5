//! Paths as in `Line.P1.fb.x` to variables: names and constant indices, no code.

use super::Configurer;
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{Field, Storage, Target, Type, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{Expr, ExprKind, Ident};
use crate::syntax::direct_address::{Area, DirectAddress};

/// One piece of a path.
#[derive(Clone, Copy)]
enum Piece<'e> {
    Name(&'e Ident),
    Index(&'e [Expr], Span),
}

/// `a.b[1]` in pieces; nothing for what is not a path.
fn pieces(expr: &Expr) -> Option<Vec<Piece<'_>>> {
    let mut found = Vec::new();
    let mut next = expr;
    loop {
        match &next.kind {
            ExprKind::Name(name) => {
                found.push(Piece::Name(name));
                found.reverse();
                return Some(found);
            }
            ExprKind::Member(base, name) => {
                found.push(Piece::Name(name));
                next = base;
            }
            ExprKind::Index(base, indices) => {
                found.push(Piece::Index(indices, next.span));
                next = base;
            }
            _ => return None,
        }
    }
}

impl Configurer<'_, '_> {
    /// The variable at a path written in `resource`, or outside of resources.
    pub(in crate::check) fn target(&mut self, expr: &Expr, resource: Option<usize>) -> Option<Target> {
        let Some(pieces) = pieces(expr) else {
            let message = "the path of a variable is wanted here";
            self.declarations.report(Diagnostic::error(Code::UnknownPath, expr.span, message));
            return None;
        };
        let (root, rest) = self.root(&pieces, resource)?;
        self.along(root, rest)
    }

    /// True for a path that begins with a name of the configuration's.
    pub(super) fn is_configured_path(&self, expr: &Expr, resource: Option<usize>) -> bool {
        let Some(Piece::Name(first)) = pieces(expr).and_then(|pieces| pieces.first().copied()) else {
            return false;
        };
        self.declarations.key_in(&first.key(), resource).is_some()
            || self.resource_named(first).is_some()
            || self.program_named(first, resource).is_some()
    }

    fn resource_named(&self, name: &Ident) -> Option<usize> {
        let resources = &self.declarations.configuration()?.resources;
        let is_it = |each: &Ident| each.text.eq_ignore_ascii_case(&name.text);
        resources.iter().position(|resource| resource.name.as_ref().is_some_and(|(each, _)| is_it(each)))
    }

    /// The program's instance of this name, in `resource` or else the only one.
    fn program_named(&self, name: &Ident, resource: Option<usize>) -> Option<usize> {
        let named = |at: &usize| {
            self.declarations.programs().get(*at).is_some_and(|each| each.name.eq_ignore_ascii_case(&name.text))
        };
        let all: Vec<usize> = (0..self.declarations.programs().len()).filter(named).collect();
        let own = |at: &&usize| {
            resource.is_some() && self.declarations.programs().get(**at).is_some_and(|it| it.resource == resource)
        };
        all.iter().find(own).copied().or(if all.len() == 1 { all.first().copied() } else { None })
    }

    /// Where a path begins, and what is left of it.
    fn root<'p, 'e>(&mut self, pieces: &'p [Piece<'e>], resource: Option<usize>) -> Option<(Target, &'p [Piece<'e>])> {
        let (Piece::Name(first), rest) = pieces.split_first()? else { return None };
        if let Some(found) = self.global_target(first, resource) {
            return Some((found.ok()?, rest));
        }
        if let Some(index) = self.program_named(first, resource) {
            return Some((self.program_target(index), rest));
        }
        if let Some(index) = self.resource_named(first) {
            let Some((Piece::Name(second), rest)) = rest.split_first() else {
                return self.no_path(first, "a resource is not a variable", None);
            };
            if let Some(found) = self.global_target(second, Some(index)) {
                return Some((found.ok()?, rest));
            }
            let inside =
                |at: usize| self.declarations.programs().get(at).is_some_and(|each| each.resource == Some(index));
            if let Some(found) = self.program_named(second, Some(index)).filter(|at| inside(*at)) {
                return Some((self.program_target(found), rest));
            }
            let message = format!("resource `{}` has no `{}`", first.text, second.text);
            let help = self.similar(second, Some(index));
            return self.no_path(second, &message, help);
        }
        let help = self.similar(first, resource);
        self.no_path(first, &format!("`{}` is not declared", first.text), help)
    }

    fn similar(&self, name: &Ident, resource: Option<usize>) -> Option<String> {
        let globals = self.declarations.global_names_in(resource);
        let programs = self.declarations.programs().iter().map(|each| each.name.as_str());
        let resources = self.declarations.configuration().into_iter().flat_map(|ast| &ast.resources);
        let resources = resources.filter_map(|each| Some(each.name.as_ref()?.0.text.as_str()));
        did_you_mean(&name.text, globals.chain(programs).chain(resources))
    }

    fn no_path<T>(&mut self, name: &Ident, message: &str, help: Option<String>) -> Option<T> {
        let found = Diagnostic::error(Code::UnknownPath, name.span, message).with_optional_help(help);
        self.declarations.report(found);
        None
    }

    /// A global variable as `resource` sees it; an error is one whose declaration is wrong, which has
    /// been reported.
    fn global_target(&mut self, name: &Ident, resource: Option<usize>) -> Option<Result<Target, ()>> {
        let key = self.declarations.key_in(&name.key(), resource)?;
        let home = self.declarations.resource_of_global(&key);
        let Some(variable) = self.declarations.global(&key, Some(name.span)) else {
            return Some(Err(()));
        };
        let (storage, inside) = match variable.storage {
            Storage::Absolute(offset) => (Storage::Absolute(0), offset),
            located => (located, 0),
        };
        let home = home.and_then(|home| self.resource_name(home)).map(|home| format!("{}.", home.text));
        let path = format!("{}{}", home.unwrap_or_default(), variable.name);
        let open = open_area(&variable);
        Some(Ok(Target { path, storage, inside, ty: variable.ty, variable: Some(variable), open }))
    }

    pub(super) fn program_target(&mut self, index: usize) -> Target {
        // Indices come from `program_named` and from walks over all programs.
        let program = self.declarations.programs()[index].clone();
        let home = program.resource.and_then(|home| self.resource_name(home));
        let path = home.map_or_else(|| program.name.clone(), |home| format!("{}.{}", home.text, program.name));
        let ty = self.declarations.types_mut().block(&program.name, program.pou);
        Target { path, storage: Storage::Absolute(0), inside: program.offset, ty, variable: None, open: None }
    }

    /// The variable at a path inside of program `index`.
    pub(super) fn target_in_program(&mut self, index: usize, expr: &Expr) -> Option<Target> {
        let root = self.program_target(index);
        let Some(pieces) = pieces(expr) else {
            let message = "the path of a variable is wanted here";
            self.declarations.report(Diagnostic::error(Code::UnknownPath, expr.span, message));
            return None;
        };
        self.along(root, &pieces)
    }

    fn along(&mut self, from: Target, pieces: &[Piece<'_>]) -> Option<Target> {
        pieces.iter().try_fold(from, |at, piece| match piece {
            Piece::Name(name) => self.step_to_member(at, name),
            Piece::Index(indices, span) => self.step_to_element(at, indices, *span),
        })
    }

    fn step_to_field(&mut self, at: Target, field: &Field, name: &Ident) -> Option<Target> {
        if field.bit.is_some() {
            let message = format!("`{}` is one bit of a byte of its structure", field.name);
            let found = Diagnostic::error(Code::UnsuitableConnection, name.span, message);
            self.declarations.report(found.with_help("connect a variable of its own"));
            return None;
        }
        let path = format!("{}.{}", at.path, field.name);
        let open = field.open.or(at.open);
        Some(Target { path, inside: at.inside + field.offset, ty: field.ty, open, ..at })
    }

    fn step_to_member(&mut self, at: Target, name: &Ident) -> Option<Target> {
        if let Some(field) = self.declarations.types().field(at.ty, &name.text).cloned() {
            return self.step_to_field(at, &field, name);
        }
        match self.declarations.types().get(at.ty).clone() {
            Type::Struct { fields, .. } => {
                let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
                self.no_member(&at, name, &names)
            }
            Type::FunctionBlock { pou, .. } => {
                let scope = self.declarations.interface(pou, name.span)?;
                if scope.may_have(&name.key()) {
                    return None;
                }
                let Some(variable) = scope.find(&name.key()) else {
                    let names: Vec<&str> = scope.variables().iter().map(|each| each.name.as_str()).collect();
                    return self.no_member(&at, name, &names);
                };
                let (storage, inside) = match variable.storage {
                    Storage::Instance(offset) => (at.storage, at.inside + offset),
                    Storage::Located(_) => (variable.storage, 0),
                    _ => {
                        let message = format!("`{}` does not lie in its instance", variable.name);
                        return self.no_path(name, &message, None);
                    }
                };
                let path = format!("{}.{}", at.path, variable.name);
                let (ty, open) = (variable.ty, open_area(variable));
                Some(Target { path, storage, inside, ty, variable: Some(variable.clone()), open })
            }
            _ => self.no_member(&at, name, &[]),
        }
    }

    fn no_member<T>(&mut self, at: &Target, name: &Ident, known: &[&str]) -> Option<T> {
        let help = did_you_mean(&name.text, known.iter().copied());
        self.no_path(name, &format!("`{}` has no `{}`", at.path, name.text), help)
    }

    fn step_to_element(&mut self, at: Target, indices: &[Expr], span: Span) -> Option<Target> {
        let Type::Array { dimensions, element } = self.declarations.types().get(at.ty).clone() else {
            let message = format!("`{}` is not an array", at.path);
            self.declarations.report(Diagnostic::error(Code::NotIndexable, span, message));
            return None;
        };
        if dimensions.len() != indices.len() {
            let (wanted, found) = (dimensions.len(), indices.len());
            let message = format!("the array has {wanted} dimensions, there are {found} indices");
            self.declarations.report(Diagnostic::error(Code::WrongDimensions, span, message));
            return None;
        }
        let mut number: u64 = 0;
        let mut list = Vec::new();
        for (bounds, index) in dimensions.iter().zip(indices) {
            let value = Body::outside(self.declarations).constant_integer(index)?;
            if !(i128::from(bounds.low)..=i128::from(bounds.high)).contains(&value) {
                let message = format!("index {value} is outside of {}..{}", bounds.low, bounds.high);
                self.declarations.report(Diagnostic::error(Code::IndexOutOfRange, index.span, message));
                return None;
            }
            number = number * bounds.count() + (value - i128::from(bounds.low)) as u64;
            list.push(value.to_string());
        }
        let inside = at.inside + number as u32 * self.declarations.types().size(element);
        let path = format!("{}[{}]", at.path, list.join(","));
        Some(Target { path, inside, ty: element, ..at })
    }
}

/// The area of a variable that is declared `AT %I*` and the like.
fn open_area(variable: &Variable) -> Option<Area> {
    let address = variable.address.as_ref().filter(|text| text.ends_with('*'))?;
    DirectAddress::parse(address).ok().map(|address| address.area)
}
