//! CASE (2nd ed. 3.3.2.3): a table of jumps for labels that lie close, a search for others.

use std::collections::BTreeMap;

use wasm_encoder::Instruction;

use super::emitter::{Emitter, Label};
use crate::compile::analyse::Register;
use crate::compile::points::PointKind;
use crate::ir::elementary::Kind;
use crate::ir::{Binary, CaseStatement, ElementaryType, Value};
use crate::syntax::Span;

/// Longest table of jumps.
const MAX_TABLE: i128 = 1024;

/// A range of values and the arm that it selects.
type Range = (i128, i128, usize);

/// The ranges in ascending order, without what an earlier arm takes.
fn disjoint(inner: &CaseStatement) -> Vec<Range> {
    let mut taken: BTreeMap<i128, (i128, usize)> = BTreeMap::new();
    for (arm, labels) in inner.arms.iter().enumerate() {
        for (low, high) in &labels.labels {
            let mut from = *low;
            while from <= *high {
                let before = taken.range(..=from).next_back().map(|(_, (end, _))| *end);
                if let Some(end) = before.filter(|end| *end >= from) {
                    from = end + 1;
                    continue;
                }
                let next = taken.range(from..).next().map(|(start, _)| *start);
                let to = next.map_or(*high, |start| (*high).min(start - 1));
                taken.insert(from, (to, arm));
                from = to + 1;
            }
        }
    }
    taken.into_iter().map(|(low, (high, arm))| (low, high, arm)).collect()
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
        self.dispatch(&disjoint(inner), (register, ty, inner.selector.span), &labels, otherwise);
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
    fn dispatch(
        &mut self,
        ranges: &[Range],
        selector: (Register, ElementaryType, Span),
        labels: &[Label],
        otherwise: Label,
    ) {
        let (Some((first, _, _)), Some((_, last, _))) = (ranges.first(), ranges.last()) else {
            self.branch(otherwise);
            return;
        };
        let span = last - first + 1;
        if ranges.len() > 3 && span <= MAX_TABLE && span <= 8 * ranges.len() as i128 {
            self.table(ranges, selector, labels, otherwise);
        } else {
            self.search(ranges, selector, labels, otherwise);
        }
    }

    fn table(
        &mut self,
        ranges: &[Range],
        (register, ty, _): (Register, ElementaryType, Span),
        labels: &[Label],
        otherwise: Label,
    ) {
        let first = ranges.first().map_or(0, |(low, _, _)| *low);
        let mut targets = Vec::new();
        for (low, high, arm) in ranges {
            targets.resize((low - first) as usize, otherwise);
            let label = labels.get(*arm).copied().unwrap_or(otherwise);
            targets.resize((high - first + 1) as usize, label);
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
    fn search(
        &mut self,
        ranges: &[Range],
        selector: (Register, ElementaryType, Span),
        labels: &[Label],
        otherwise: Label,
    ) {
        let (register, ty, span) = selector;
        if let [(low, high, arm)] = ranges {
            self.within(register, ty, *low, *high);
            if let Some(label) = labels.get(*arm) {
                self.branch_if(*label);
            }
            self.branch(otherwise);
            return;
        }
        let (left, right) = ranges.split_at(ranges.len() / 2);
        let Some((middle, _, _)) = right.first() else { return };
        let next = self.open_block();
        self.get(register);
        self.constant(ty, Value::Int(*middle));
        self.operation(Binary::GreaterEqual, ty, span);
        self.branch_if(next);
        self.search(left, selector, labels, otherwise);
        self.close();
        self.search(right, selector, labels, otherwise);
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
