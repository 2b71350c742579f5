//! Conversions that a program needs where integers are computed in other bits than its own dialect computes them in.
//!
//! CODESYS and TwinCAT compute in registers of the target, all others in the type of the operands. A text that goes from
//! one to the other says by conversions what its own dialect does without: `INT_TO_DINT(i) * 1000` where the registers had
//! room for the product, `TO_INT(a + b) / 2` where it was cut at once. What makes no difference stays as it is.
//!
//! | module | subject |
//! |---|---|
//! | [`tree`] | operations in registers, and the values they can have |
//! | [`implicit`] | what a dialect converts by itself, and the target's does not |
//! | [`initial`] | initial values that are computed |

mod implicit;
mod initial;
mod tree;

use std::collections::{BTreeMap, BTreeSet};

use self::tree::{Node, has, is_whole, node};
use super::{Refused, Written};
use onescan_iec::check::as_number;
use onescan_iec::dialect::Dialect;
use onescan_iec::front::Front;
use onescan_iec::ir::walk::{self, Visitor};
use onescan_iec::ir::{Binary, ElementaryType as E, Expr, ExprKind, TypeTable};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Declaration, Statement, StatementKind};
use onescan_iec::syntax::{self, FileId, SourceMap, Span};

/// Where a text goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// From registers to operands' types: operands become as wide as what is computed.
    ToOperands,
    /// From operands' types to registers: results are cut. The program is checked as that of the registers.
    ToRegisters,
}

/// A project, checked twice.
pub(crate) struct Fronts {
    /// As its author means it.
    pub(crate) own: Front,
    /// The same text as the target reads it.
    pub(crate) theirs: Front,
}

impl Fronts {
    /// The one that shows what registers hold.
    pub(crate) fn of_registers(&self, way: Way) -> &Front {
        match way {
            Way::ToOperands => &self.own,
            Way::ToRegisters => &self.theirs,
        }
    }
}

/// The changes of the files of a checked project that `is_concerned`.
///
/// # Errors
/// Places that cannot be written so.
pub(crate) fn explicit(
    fronts: &Fronts,
    way: Way,
    is_concerned: &dyn Fn(FileId) -> bool,
) -> Result<BTreeMap<FileId, Edits>, Vec<Refused>> {
    let front = fronts.of_registers(way);
    let types = &front.checked.types;
    let mut writer = Writer {
        types,
        sources: &front.sources,
        way,
        reader: fronts.theirs.sources.iter().next().map_or(Dialect::Iec3, |(_, file)| file.dialect()),
        unread: implicit::unread(&fronts.theirs),
        is_concerned,
        lists: instructions(front),
        done: BTreeMap::new(),
        refused: Vec::new(),
    };
    for pou in front.checked.pous.values().chain(&front.checked.start) {
        walk::statements(&pou.body, &mut writer);
    }
    match initial::changed(&fronts.own, &fronts.theirs) {
        Ok(changes) => {
            let concerned = changes.into_iter().filter(|(span, _)| is_concerned(span.file));
            for (span, change) in concerned {
                let noted = writer.note(span, vec![change]);
                writer.refused.extend(noted.err());
            }
        }
        Err(refused) => writer.refused.push(refused),
    }
    let Writer { done, refused, .. } = writer;
    if !refused.is_empty() {
        return Err(refused);
    }
    let mut edits: BTreeMap<FileId, Edits> = BTreeMap::new();
    for ((file, ..), changes) in done {
        let of_file = edits.entry(file).or_default();
        for Change { at, text } in changes {
            of_file.replace(at.0..at.1, text);
        }
    }
    Ok(edits)
}

/// The places of instructions in lists, which have no parentheses for a conversion.
fn instructions(front: &Front) -> Vec<Span> {
    struct Lists(Vec<Span>);
    impl syntax::walk::Visitor for Lists {
        fn statement(&mut self, statement: &Statement) {
            if matches!(statement.kind, StatementKind::Instruction(_)) {
                self.0.push(statement.span);
            }
        }
    }
    let mut lists = Lists(Vec::new());
    for declaration in front.units.iter().flat_map(|(_, unit)| &unit.declarations) {
        if let Declaration::Pou(pou) = declaration {
            syntax::walk::unit(pou, &mut lists);
            for member in &pou.object.members {
                syntax::walk::unit(&member.pou, &mut lists);
            }
        }
    }
    lists.0
}

/// What comes in the place of a part of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Change {
    at: (u32, u32),
    text: String,
}

struct Writer<'w> {
    types: &'w TypeTable,
    sources: &'w SourceMap,
    way: Way,
    /// The dialect of the target.
    reader: Dialect,
    /// Where it finds a value of another type than it wants.
    unread: BTreeSet<Span>,
    is_concerned: &'w dyn Fn(FileId) -> bool,
    /// Instructions, in which no conversion can be put around an operand.
    lists: Vec<Span>,
    /// Changes by the place of what they belong to, the outer one first: a text may be checked more than once.
    done: BTreeMap<(FileId, u32, std::cmp::Reverse<u32>), Vec<Change>>,
    refused: Vec<Refused>,
}

impl Visitor for Writer<'_> {
    /// What an expression is made of depends on what becomes of it.
    fn goes_into_expressions(&self) -> bool {
        false
    }

    fn index(&mut self, index: &Expr) {
        let written = match self.way {
            Way::ToOperands if (self.is_concerned)(index.span.file) => self.indexed(index),
            _ => return self.expression(index),
        };
        self.refused.extend(written.err());
    }

    fn expression(&mut self, expr: &Expr) {
        if !(self.is_concerned)(expr.span.file) {
            return walk::children(expr, self);
        }
        let written = match self.way {
            Way::ToOperands => self.widened(expr),
            Way::ToRegisters => self.cut_within(expr),
        };
        if let Err(refused) = written {
            self.refused.push(refused);
        }
    }
}

impl Writer<'_> {
    /// The register that holds an expression, if it is of a type that fills one.
    fn register(&self, expr: &Expr) -> Option<E> {
        let ty = self.types.elementary(expr.ty)?;
        let bits = self.sources.get(expr.span.file)?.word_size().bits();
        (ty.is_integer() && ty.size() * 8 == bits).then_some(ty)
    }

    /// What an expression computes in registers, if these hold more than its types.
    fn wider<'e>(&self, expr: &'e Expr) -> Option<(Node<'e>, E)> {
        let register = self.register(expr)?;
        let node = node(self.types, expr, register);
        node.is_wider_in(register).then_some((node, register))
    }

    fn note(&mut self, span: Span, changes: Vec<Change>) -> Written<()> {
        if changes.is_empty() {
            return Ok(());
        }
        let is_in = |list: &Span| list.file == span.file && (list.start..list.end).contains(&span.start);
        if self.lists.iter().any(is_in) {
            return Err(Refused {
                span,
                message: "an instruction list that goes beyond its operands' type".to_owned(),
            });
        }
        let key = (span.file, span.start, std::cmp::Reverse(span.end));
        match self.done.get(&key) {
            Some(known) if *known != changes => {
                let message = "what is computed here has other types in each of its uses, which no conversion can say";
                Err(Refused { span, message: message.to_owned() })
            }
            Some(_) => Ok(()),
            None => {
                self.done.insert(key, changes);
                Ok(())
            }
        }
    }

    fn widened(&mut self, expr: &Expr) -> Written<()> {
        let target = self.types.elementary(expr.ty);
        match (&expr.kind, target) {
            (ExprKind::FromRegister(inner) | ExprKind::Convert(_, inner), Some(target)) => {
                let Some((node, register)) = self.wider(given(inner)) else {
                    return self.said(expr);
                };
                self.converted(expr, (&node, register), target)?;
                self.leaves(&node);
            }
            (ExprKind::Binary(operator, left, right), _) if operator.is_comparison() => {
                let Some(register) = self.register(left) else {
                    return self.said(expr);
                };
                let sides = [left, right].map(|side| node(self.types, side, register));
                if sides.iter().any(|side| side.is_wider_in(register)) {
                    let as_small = small(register).filter(|ty| sides.iter().all(|side| side.fits(*ty)));
                    for side in &sides {
                        let mut changes = Vec::new();
                        self.operands(side, as_small.unwrap_or(register), &mut changes);
                        self.note(side.span(), changes)?;
                    }
                }
                for side in &sides {
                    self.leaves(side);
                }
            }
            _ => match self.wider(expr) {
                Some((node, register)) => {
                    let mut changes = Vec::new();
                    self.operands(&node, register, &mut changes);
                    self.note(expr.span, changes)?;
                    self.leaves(&node);
                }
                None => self.said(expr)?,
            },
        }
        Ok(())
    }

    /// What stands within the leaves of a tree, and what chooses among its parts.
    fn leaves(&mut self, node: &Node<'_>) {
        match node {
            Node::Literal { .. } => {}
            Node::Leaf { expr, .. } => self.expression(expr),
            Node::Operation { operands, selector, .. } => {
                if let Some(selector) = selector {
                    self.expression(selector);
                }
                for operand in operands {
                    self.leaves(operand);
                }
            }
        }
    }

    /// A tree whose value becomes one of `target`.
    fn converted(&mut self, expr: &Expr, (node, register): (&Node<'_>, E), target: E) -> Written<()> {
        if matches!(expr.kind, ExprKind::Convert(..)) && node.span() != expr.span {
            return self.renamed(expr.span, (node, register));
        }
        let is_low = is_whole(target) && target.size() <= register.size() && node.is_exact_below();
        let computed = if is_low { as_number(target) } else { fitting(node, register) };
        let (mut changes, mut inside) = (Vec::new(), Vec::new());
        self.operands(node, computed, &mut inside);
        if is_low && inside.is_empty() {
            return Ok(());
        }
        if computed != target {
            let (head, count) = conversions(&[computed], target);
            changes.extend(wrapped(node.span(), &head, count));
        }
        changes.extend(inside);
        self.note(node.span(), changes)
    }

    /// A tree that a conversion function is given: the function is that of what is computed.
    fn renamed(&mut self, call: Span, (node, register): (&Node<'_>, E)) -> Written<()> {
        let operand = node.span();
        let refused =
            || Refused { span: call, message: "a conversion in this form, of what registers hold,".to_owned() };
        let head = Span { end: operand.start, ..call };
        let text = self.sources.text(head);
        let name = text.trim_end_matches(|one: char| one == '(' || one.is_whitespace());
        if !text.get(name.len()..).is_some_and(|rest| rest.contains('(')) {
            return Err(refused());
        }
        let from = name.rfind(|one: char| !one.is_ascii_alphanumeric() && one != '_').map_or(0, |at| at + 1);
        let old = name.get(from..).unwrap_or("").to_ascii_uppercase();
        let to = old.rsplit_once("TO_").map(|(_, to)| to.to_owned()).ok_or_else(refused)?;
        let target = E::find(&to).filter(|ty| is_whole(*ty) && ty.size() <= register.size() && node.is_exact_below());
        let computed = target.map_or_else(|| fitting(node, register), as_number);
        let new = if to == computed.name() { String::new() } else { format!("{computed}_TO_{to}") };
        let place = (call.start + from as u32, call.start + name.len() as u32);
        let mut changes = vec![Change { at: place, text: new }];
        self.operands(node, computed, &mut changes);
        self.note(call, changes)
    }

    /// The operands of a tree as ones of `wanted`.
    fn operands(&self, node: &Node<'_>, wanted: E, changes: &mut Vec<Change>) {
        match node {
            Node::Literal { value, span } => {
                if !is_plain(self.sources.text(*span)) {
                    let text = if *value < 0 { format!("({value})") } else { value.to_string() };
                    changes.push(Change { at: (span.start, span.end), text });
                }
            }
            Node::Leaf { expr, types } => {
                let (head, count) = conversions(types, wanted);
                changes.extend(wrapped(expr.span, &head, count));
            }
            Node::Operation { operands, .. } => {
                for operand in operands {
                    self.operands(operand, wanted, changes);
                }
            }
        }
    }

    fn cut_within(&mut self, expr: &Expr) -> Written<()> {
        let computed = match &expr.kind {
            ExprKind::FromRegister(inner) | ExprKind::Convert(_, inner) => inner,
            _ => expr,
        };
        let Some((node, register)) = self.wider(computed) else {
            walk::children(expr, self);
            return Ok(());
        };
        let target = self.types.elementary(expr.ty).filter(|_| matches!(expr.kind, ExprKind::FromRegister(_)));
        let is_low = target.zip(node.own()).is_some_and(|(target, own)| target.size() <= own.size());
        match &node {
            Node::Operation { kind, .. } if is_low && kind.is_exact_below() => self.cut_operands(&node, register),
            _ => self.cut(&node, register),
        }
    }

    /// A tree all of whose bits count: what its type does not hold is cut.
    fn cut(&mut self, node: &Node<'_>, register: E) -> Written<()> {
        if let (Node::Operation { span, .. }, Some(own)) = (node, node.own()) {
            let (least, greatest) = node.range();
            if own.size() < register.size() && !(has(own, least) && has(own, greatest)) {
                self.note(*span, wrapped(*span, &format!("TO_{own}("), 1))?;
            }
        }
        self.cut_operands(node, register)
    }

    fn cut_operands(&mut self, node: &Node<'_>, register: E) -> Written<()> {
        let Node::Operation { kind, operands, selector, .. } = node else {
            self.leaves(node);
            return Ok(());
        };
        if let Some(selector) = selector {
            self.expression(selector);
        }
        for operand in operands {
            let is_narrower = operand.own().zip(node.own()).is_some_and(|(inner, outer)| inner.size() < outer.size());
            if kind.is_exact_below() && !is_narrower {
                self.cut_operands(operand, register)?;
            } else {
                self.cut(operand, register)?;
            }
        }
        Ok(())
    }
}

/// What a conversion function was given, where it computes with it: the number of a TIME, the lowest bit.
fn given(expr: &Expr) -> &Expr {
    let mut inner = expr;
    while let ExprKind::Binary(Binary::Multiply | Binary::And, operand, constant) = &inner.kind
        && constant.span == inner.span
    {
        inner = operand;
        while let ExprKind::Convert(_, operand) = &inner.kind {
            inner = operand;
        }
    }
    inner
}

/// The type of half a register, which more targets have.
fn small(register: E) -> Option<E> {
    match register {
        E::Lint => Some(E::Dint),
        E::Ulint => Some(E::Udint),
        _ => None,
    }
}

/// The smaller type that holds all of a tree, else its register's.
fn fitting(node: &Node<'_>, register: E) -> E {
    small(register).filter(|ty| node.fits(*ty)).unwrap_or(register)
}

/// `INT_TO_DINT(` and how many parentheses it opens: through `types` to `wanted`.
fn conversions(types: &[E], wanted: E) -> (String, usize) {
    let mut way: Vec<E> = Vec::new();
    for ty in types.iter().copied().chain([wanted]) {
        // A type on the way that holds every value of the one before changes nothing.
        if let [.., before, last] = way[..]
            && holds(last, before)
        {
            way.pop();
        }
        match way.last() {
            Some(last) if *last == ty => {}
            // How a number with a sign fills a longer bit string, tools see differently.
            Some(last) if ty.is_bits() && last.is_signed() && last.size() < ty.size() => {
                way.extend([signed(ty), ty]);
            }
            _ => way.push(ty),
        }
    }
    let steps: Vec<_> = way.windows(2).map(|pair| format!("{}_TO_{}(", pair[0], pair[1])).collect();
    (steps.iter().rev().map(String::as_str).collect(), steps.len())
}

/// The integer with a sign that has as many bits.
fn signed(bits: E) -> E {
    match bits.size() {
        1 => E::Sint,
        2 => E::Int,
        4 => E::Dint,
        _ => E::Lint,
    }
}

fn holds(wide: E, narrow: E) -> bool {
    let (wide, narrow) = (as_number(wide).range(), as_number(narrow).range());
    wide.zip(narrow).is_some_and(|(wide, narrow)| wide.0 <= narrow.0 && narrow.1 <= wide.1)
}

fn wrapped(span: Span, head: &str, parentheses: usize) -> Vec<Change> {
    if parentheses == 0 {
        return Vec::new();
    }
    let change = |at, text: String| Change { at: (at, at), text };
    vec![change(span.start, head.to_owned()), change(span.end, ")".repeat(parentheses))]
}

/// True for the text of a literal that has no type of its own.
fn is_plain(text: &str) -> bool {
    let digits = text.trim_start_matches('-');
    let is_based = ["2#", "8#", "16#"].iter().any(|base| digits.starts_with(base));
    let mut characters = digits.chars();
    is_based
        || digits.starts_with(|one: char| one.is_ascii_digit())
            && characters.all(|one| one.is_ascii_digit() || one == '_')
}
