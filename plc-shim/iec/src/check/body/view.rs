//! `b AT a : ARRAY [0..31] OF BOOL` of SCL: the memory of `a`, seen as another type (S7-SCL V5.3: views).
//!
//! There a value begins with its highest byte, here with its lowest. So a view has memory of its own, which is made the
//! same, byte for byte and bit for bit as they lie there, when the unit begins and behind each statement that may
//! write to one of the two.

use std::collections::BTreeSet;

use super::Body;
use crate::check::types::build::{assign, load};
use crate::check::types::first_high::{Cell, cells};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Part, Place, PouId, Statement, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Argument, Call, Ident, StatementKind};
use crate::syntax::walk::{self, Visitor, root};

/// A view and what it looks at.
#[derive(Debug, Clone)]
pub(super) struct View {
    own: Side,
    base: Side,
    /// Each byte of the view: where it lies in the view, and in what it looks at.
    cells: Vec<(Cell, Cell)>,
}

#[derive(Debug, Clone)]
struct Side {
    key: String,
    place: Place,
}

impl View {
    fn shown(&self) -> Vec<Statement> {
        self.cells.iter().flat_map(|(own, base)| copied(&self.base.place, *base, &self.own.place, *own)).collect()
    }

    fn written_back(&self) -> Vec<Statement> {
        self.cells.iter().flat_map(|(own, base)| copied(&self.own.place, *own, &self.base.place, *base)).collect()
    }
}

/// One byte from a variable to another; where one of them has bits, bit by bit.
fn copied(source: &Place, from: Cell, target: &Place, to: Cell) -> Vec<Statement> {
    let byte = |place: &Place, offset| place.clone().member(offset, ElementaryType::Byte.into());
    let bool_at = |place: &Place, offset| place.clone().member(offset, ElementaryType::Bool.into());
    let bit_of =
        |place: &Place, offset, bit: usize| Place { part: Some(Part::bit(bit as u8)), ..bool_at(place, offset) };
    let bits = |cell: Cell, place: &Place| -> [Option<Place>; 8] {
        match cell {
            Cell::Byte(offset) => std::array::from_fn(|bit| Some(bit_of(place, offset, bit))),
            Cell::Bits(bits) => bits.map(|offset| offset.map(|offset| bool_at(place, offset))),
            Cell::Gap => [const { None }; 8],
        }
    };
    if let (Cell::Byte(from), Cell::Byte(to)) = (from, to) {
        return vec![assign(&byte(target, to), load(&byte(source, from)))];
    }
    let pairs = bits(from, source).into_iter().zip(bits(to, target));
    pairs.filter_map(|(from, to)| Some(assign(&to?, load(&from?)))).collect()
}

impl Body<'_, '_> {
    /// Finds the views of a unit, and shows what they look at when it begins.
    pub(super) fn open_views(&mut self, id: PouId) -> Vec<Statement> {
        let ast = self.declarations.pou(id).ast();
        let declared = ast.sections.iter().flat_map(|section| &section.variables);
        let named = declared.filter_map(|variable| Some((variable, variable.viewed()?)));
        for (variable, viewed) in named {
            for name in &variable.names {
                let view = self.view(name, viewed);
                self.views.extend(view);
            }
        }
        self.views.iter().flat_map(View::shown).collect()
    }

    fn view(&mut self, name: &Ident, viewed: &Ident) -> Option<View> {
        let own = self.scope.find(&name.key())?.clone();
        let base = match self.scope.find(&viewed.key()) {
            Some(found) => found.clone(),
            None if self.scope.is_broken(&viewed.key()) => return None,
            None => {
                let message = format!("`{}` is not a variable of this block", viewed.text);
                self.report(Diagnostic::error(Code::UnknownName, viewed.span, message));
                return None;
            }
        };
        let (seen, looked_at) = (self.cells_of(&own, name.span)?, self.cells_of(&base, viewed.span)?);
        if seen.len() > looked_at.len() {
            let message =
                format!("`{}` has {} bytes, and `{}` {}", name.text, seen.len(), viewed.text, looked_at.len());
            let found = Diagnostic::error(Code::UnsuitableAddress, name.span, message);
            self.report(found.with_help("a view is no larger than what it looks at"));
            return None;
        }
        let side = |variable: Variable| Side {
            key: variable.name.to_ascii_uppercase(),
            place: Place::whole(variable.storage, variable.ty, variable.span),
        };
        let cells = seen.into_iter().zip(looked_at).collect();
        Some(View { own: side(own), base: side(base), cells })
    }

    fn cells_of(&mut self, variable: &Variable, span: Span) -> Option<Vec<Cell>> {
        let found = cells(self.declarations.types(), variable.ty);
        if found.is_none() {
            let message = format!("a view `AT` of or as {} is not supported", self.type_name(variable.ty));
            let help = "BOOL, bit strings, integers, reals, CHAR, and arrays and structures of them have the same form \
                        there";
            self.report(Diagnostic::error(Code::UnsupportedFeature, span, message).with_help(help));
        }
        found
    }

    /// What makes views and what they look at the same again behind a statement.
    pub(super) fn seen_again(&mut self, statement: &ast::Statement) -> Vec<Statement> {
        if self.views.is_empty() {
            return Vec::new();
        }
        if let StatementKind::For(inner) = &statement.kind {
            self.refuse_as_control(&inner.variable);
        }
        let is_leaf = matches!(
            statement.kind,
            StatementKind::Assign(..)
                | StatementKind::Chain(..)
                | StatementKind::Update(..)
                | StatementKind::SetReset(..)
                | StatementKind::Call(_)
        );
        if !is_leaf {
            return Vec::new();
        }
        let mut writes = Writes::default();
        walk::statements(std::slice::from_ref(statement), &mut writes);
        let bases: BTreeSet<String> = self.views.iter().map(|view| view.base.key.clone()).collect();
        bases.iter().flat_map(|base| self.group_again(base, &writes, statement.span)).collect()
    }

    /// The same of one variable and its views.
    fn group_again(&mut self, base: &str, writes: &Writes, span: Span) -> Vec<Statement> {
        let group: Vec<View> = self.views.iter().filter(|view| view.base.key == base).cloned().collect();
        let of_group = |names: &BTreeSet<String>| -> Vec<String> {
            let is_of = |name: &&String| *name == base || group.iter().any(|view| view.own.key == **name);
            names.iter().filter(is_of).cloned().collect()
        };
        let (sure, possible) = (of_group(&writes.sure), of_group(&writes.possible));
        let written = if sure.is_empty() { possible } else { sure };
        let [written] = &written[..] else {
            if written.len() > 1 {
                let message = format!("{} lie in the same memory, and each may be written here", written.join(", "));
                let found = Diagnostic::error(Code::UnsupportedFeature, span, message);
                self.report(found.with_help("write one of them, or hand over a copy"));
            }
            return Vec::new();
        };
        let (own, others): (Vec<&View>, Vec<&View>) = group.iter().partition(|view| view.own.key == *written);
        own.into_iter().flat_map(View::written_back).chain(others.into_iter().flat_map(View::shown)).collect()
    }

    fn refuse_as_control(&mut self, control: &ast::Expr) {
        let Some(name) = root(control) else { return };
        let key = name.key();
        if self.views.iter().any(|view| view.own.key == key || view.base.key == key) {
            let message = format!("`{}` has a view, and counts turns", name.text);
            let found = Diagnostic::error(Code::UnsupportedFeature, name.span, message);
            self.report(found.with_help("count with another variable"));
        }
    }
}

/// Names that a statement writes to.
#[derive(Debug, Default)]
struct Writes {
    sure: BTreeSet<String>,
    /// Those that a call is given, which may be for a `VAR_IN_OUT`.
    possible: BTreeSet<String>,
}

impl Visitor for Writes {
    fn target(&mut self, target: &ast::Expr) {
        self.sure.extend(root(target).map(Ident::key));
    }

    fn call(&mut self, call: &Call) {
        for argument in &call.arguments {
            if let Argument::Positional(value) | Argument::Input(_, value) = argument {
                self.possible.extend(root(value).map(Ident::key));
            }
        }
    }
}
