//! CASE (2nd ed. 3.3.2.3): a table of jumps for labels that lie close, a search for others.

use std::collections::BTreeMap;

use wasm_encoder::Instruction;

use super::emitter::{Emitter, Label};
use crate::compile::analyse::Register;
use crate::compile::points::PointKind;
use onescan_iec::ir::elementary::Kind;
use onescan_iec::ir::{Binary, CaseStatement, ElementaryType, Value};
use onescan_iec::syntax::Span;

/// Longest table of jumps: 4 KB of machine code.
const MAX_TABLE: i128 = 1024;

/// A range of values, both ends included, and where the arm begins that it selects.
type Range = (i128, i128, Label);

/// What a CASE selects by.
#[derive(Debug, Clone, Copy)]
struct Selector {
    register: Register,
    ty: ElementaryType,
    span: Span,
}

/// The ranges in ascending order, without what an earlier arm takes. `begins` has where each arm begins.
fn disjoint(inner: &CaseStatement, begins: &[Label]) -> Vec<Range> {
    let mut taken: BTreeMap<i128, (i128, Label)> = BTreeMap::new();
    for (begin, arm) in begins.iter().zip(&inner.arms) {
        for (low, high) in &arm.labels {
            let mut from = *low;
            while from <= *high {
                let before = taken.range(..=from).next_back().map(|(_, (end, _))| *end);
                if let Some(end) = before.filter(|end| *end >= from) {
                    from = end + 1;
                    continue;
                }
                let next = taken.range(from..).next().map(|(start, _)| *start);
                let to = next.map_or(*high, |start| (*high).min(start - 1));
                taken.insert(from, (to, *begin));
                from = to + 1;
            }
        }
    }
    taken.into_iter().map(|(low, (high, begin))| (low, high, begin)).collect()
}

impl Emitter<'_, '_> {
    pub(crate) fn case_statement(&mut self, inner: &CaseStatement, span: Span) {
        let ty = self.held_as(inner.selector.ty);
        let register = self.register(inner.register);
        self.expression(&inner.selector);
        self.set(register);
        let end = self.open_block();
        let otherwise = self.open_block();
        let mut labels: Vec<Label> = inner.arms.iter().map(|_| self.open_block()).collect();
        // The innermost block is the first arm's.
        labels.reverse();
        let selector = Selector { register, ty, span: inner.selector.span };
        self.dispatch(&disjoint(inner, &labels), selector, otherwise);
        let mut ways = self.open_ways();
        for (outcome, arm) in (0..).zip(&inner.arms) {
            self.close();
            let next = self.way();
            self.cover(PointKind::Outcome(outcome), span);
            self.statements(&arm.body);
            self.branch(end);
            self.end_way(&mut ways, next);
        }
        self.close();
        self.cover(PointKind::Outcome(inner.arms.len() as u32), span);
        self.statements(&inner.otherwise);
        self.close_ways(ways);
        self.close();
    }

    /// Jumps to the arm that the register's value selects.
    fn dispatch(&mut self, ranges: &[Range], selector: Selector, otherwise: Label) {
        let (Some((first, _, _)), Some((_, last, _))) = (ranges.first(), ranges.last()) else {
            self.branch(otherwise);
            return;
        };
        let span = last - first + 1;
        // A table pays from four ranges on, if it is not mostly holes.
        if ranges.len() > 3 && span <= MAX_TABLE && span <= 8 * ranges.len() as i128 {
            self.table(*first, ranges, selector, otherwise);
        } else {
            self.search(ranges, selector, otherwise);
        }
    }

    fn table(&mut self, first: i128, ranges: &[Range], Selector { register, ty, .. }: Selector, otherwise: Label) {
        let mut targets = Vec::new();
        for (low, high, begin) in ranges {
            targets.resize((low - first) as usize, otherwise);
            targets.resize((high - first + 1) as usize, *begin);
        }
        self.get(register);
        self.constant(ty, Value::Int(first));
        if ty.size() == 8 {
            self.emit(Instruction::I64Sub);
            self.set(register);
            self.get(register);
            self.emit(Instruction::I64Const(targets.len() as i64));
            self.emit(Instruction::I64GeU);
            self.branch_if(otherwise);
            self.get(register);
            self.emit(Instruction::I32WrapI64);
        } else {
            self.emit(Instruction::I32Sub);
        }
        self.branch_table(&targets, otherwise);
    }

    /// Halves the ranges until one is left.
    fn search(&mut self, ranges: &[Range], selector: Selector, otherwise: Label) {
        let Selector { register, ty, span } = selector;
        if let [(low, high, begin)] = ranges {
            self.within(register, ty, *low, *high);
            self.branch_if(*begin);
            self.branch(otherwise);
            return;
        }
        let (left, right) = ranges.split_at(ranges.len() / 2);
        let Some((middle, _, _)) = right.first() else { return self.impossible(span) };
        let next = self.open_block();
        self.get(register);
        self.constant(ty, Value::Int(*middle));
        self.operation(Binary::GreaterEqual, ty, span);
        self.branch_if(next);
        self.search(left, selector, otherwise);
        self.close();
        self.search(right, selector, otherwise);
    }

    /// Pushes whether the register lies in `low..=high`.
    fn within(&mut self, register: Register, ty: ElementaryType, low: i128, high: i128) {
        let wide = ty.size() == 8;
        let signed = ty.kind() == Kind::Signed;
        self.get(register);
        self.constant(ty, Value::Int(low));
        if low == high {
            self.emit(if wide { Instruction::I64Eq } else { Instruction::I32Eq });
            return;
        }
        self.emit(match (wide, signed) {
            (false, true) => Instruction::I32GeS,
            (false, false) => Instruction::I32GeU,
            (true, true) => Instruction::I64GeS,
            (true, false) => Instruction::I64GeU,
        });
        self.get(register);
        self.constant(ty, Value::Int(high));
        self.emit(match (wide, signed) {
            (false, true) => Instruction::I32LeS,
            (false, false) => Instruction::I32LeU,
            (true, true) => Instruction::I64LeS,
            (true, false) => Instruction::I64LeU,
        });
        self.emit(Instruction::I32And);
    }
}
