//! The user's units as they have been checked: their expressions have types, their names have places.

use std::collections::BTreeMap;

use super::index::Index;
use crate::check::constant_value;
use crate::front::Front;
use crate::ir::{Expr, Pou, PouId, TypeTable, Value};
use crate::syntax::ast;
use crate::syntax::{FileId, Span};

/// A checked unit and its text.
#[derive(Clone, Copy)]
pub(super) struct Body<'a> {
    pub(super) checked: &'a Pou,
    pub(super) pou: &'a ast::Pou,
}

/// All bodies that the user wrote.
pub(super) struct Bodies<'a> {
    front: &'a Front,
    own: Vec<Body<'a>>,
}

impl<'a> Bodies<'a> {
    pub(super) fn new(front: &'a Front, index: &Index<'a>) -> Self {
        let written: BTreeMap<(FileId, u32), &'a ast::Pou> =
            index.own().chain(index.own_members()).map(|pou| (place_of(pou.name.span), pou)).collect();
        let checked = front.checked.pous.values();
        let own = checked.filter_map(|checked| Some(Body { checked, pou: written.get(&place_of(checked.span))? }));
        Self { front, own: own.collect() }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Body<'a>> {
        self.own.iter().copied()
    }

    pub(super) fn types(&self) -> &'a TypeTable {
        &self.front.checked.types
    }

    /// A unit by its number, be it the user's or a library's.
    pub(super) fn unit(&self, id: PouId) -> Option<&'a Pou> {
        self.front.checked.pous.get(&id)
    }

    /// True for a unit of a library.
    pub(super) fn is_of_library(&self, pou: &Pou) -> bool {
        self.front.library.contains(&pou.span.file)
    }

    pub(super) fn constant(&self, expr: &Expr) -> Option<Value> {
        constant_value(self.types(), expr)
    }

    /// The value that stands in the text as a number; nothing for a name, whose value may be changed.
    pub(super) fn literal(&self, expr: &Expr) -> Option<Value> {
        let text = self.text(expr.span);
        let is_spelled =
            text.contains('#') || !text.contains(|sign: char| sign.is_alphabetic() && sign != 'E' && sign != 'e');
        self.constant(expr).filter(|_| is_spelled && !text.is_empty())
    }

    pub(super) fn text(&self, span: Span) -> &'a str {
        self.front.sources.text(span)
    }
}

fn place_of(name: Span) -> (FileId, u32) {
    (name.file, name.start)
}
