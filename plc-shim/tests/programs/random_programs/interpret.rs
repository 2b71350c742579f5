//! What a program does, statement by statement.

use onescan_iec_run::FaultKind;

use super::program::{DEPTH, Number, Statement, Truth, control};

/// Why a block is left before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    Fault(FaultKind),
    Exit,
    Continue,
    Return,
}

/// The variables of the program.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Memory {
    pub(super) ints: [i16; 4],
    pub(super) bools: [bool; 3],
    pub(super) array: [i32; 4],
    pub(super) loops: [i16; DEPTH * 3],
    pub(super) counts: [i16; 2],
    /// Of the last fault after which the program went on.
    pub(super) code: i64,
}

impl Memory {
    /// One scan.
    pub(super) fn run(&mut self, body: &[Statement]) -> Result<(), Stop> {
        match self.block(body, 0) {
            Err(Stop::Return) => Ok(()),
            other => other,
        }
    }

    fn number(&self, number: &Number) -> Result<i16, Stop> {
        Ok(match number {
            Number::Literal(value) => *value,
            Number::Variable(index) => self.ints[*index],
            Number::Control(index) => self.loops[*index],
            Number::Element(index) => self.array[(self.number(index)? % 4).unsigned_abs() as usize] as i16,
            Number::Negate(value) => self.number(value)?.wrapping_neg(),
            Number::Call(value) => self.number(value)?.clamp(-100, 100),
            Number::Select(condition, a, b) => {
                let (condition, a, b) = (self.truth(condition)?, self.number(a)?, self.number(b)?);
                if condition { b } else { a }
            }
            Number::Binary(operator, a, b) => {
                let (a, b) = (self.number(a)?, self.number(b)?);
                match *operator {
                    "+" => a.wrapping_add(b),
                    "-" => a.wrapping_sub(b),
                    "*" => a.wrapping_mul(b),
                    "/" if b == 0 => return Err(Stop::Fault(FaultKind::DivisionByZero)),
                    "/" => a.wrapping_div(b),
                    _ if b == 0 => 0,
                    _ => a.wrapping_rem(b),
                }
            }
        })
    }

    fn truth(&self, truth: &Truth) -> Result<bool, Stop> {
        Ok(match truth {
            Truth::Literal(value) => *value,
            Truth::Variable(index) => self.bools[*index],
            Truth::Not(value) => !self.truth(value)?,
            Truth::Join(operator, a, b) => {
                let (a, b) = (self.truth(a)?, self.truth(b)?);
                match *operator {
                    "AND" => a && b,
                    "OR" => a || b,
                    _ => a != b,
                }
            }
            Truth::Compare(operator, a, b) => {
                let (a, b) = (self.number(a)?, self.number(b)?);
                match *operator {
                    "<" => a < b,
                    "<=" => a <= b,
                    ">" => a > b,
                    ">=" => a >= b,
                    "=" => a == b,
                    _ => a != b,
                }
            }
        })
    }

    fn block(&mut self, block: &[Statement], depth: usize) -> Result<(), Stop> {
        block.iter().try_for_each(|statement| self.statement(statement, depth))
    }

    /// `depth` counts the loops around.
    fn statement(&mut self, statement: &Statement, depth: usize) -> Result<(), Stop> {
        match statement {
            Statement::Assign(index, value) => self.ints[*index] = self.number(value)?,
            Statement::AssignTruth(index, value) => self.bools[*index] = self.truth(value)?,
            Statement::AssignElement(index, value) => {
                // The target's index is looked at before the value.
                let index = usize::try_from(self.number(index)?).ok().filter(|index| *index < 4);
                let index = index.ok_or(Stop::Fault(FaultKind::IndexOutOfRange))?;
                self.array[index] = i32::from(self.number(value)?).wrapping_mul(100_000);
            }
            Statement::Exit(condition) if depth > 0 => return self.leave(condition, Stop::Exit),
            Statement::Continue(condition) if depth > 0 => return self.leave(condition, Stop::Continue),
            Statement::Exit(_) | Statement::Continue(_) => {}
            Statement::Return(condition) => return self.leave(condition, Stop::Return),
            Statement::CallInstance(index, value) => {
                self.counts[*index] = self.counts[*index].wrapping_add(self.number(value)?);
            }
            Statement::If(branches, otherwise) => {
                for (condition, body) in branches {
                    if self.truth(condition)? {
                        return self.block(body, depth);
                    }
                }
                return self.block(otherwise, depth);
            }
            Statement::Case(value, arms, otherwise) => {
                let value = self.number(value)?;
                let selected =
                    arms.iter().find(|(labels, _)| labels.iter().any(|(low, high)| (low..=high).contains(&&value)));
                return self.block(selected.map_or(otherwise, |(_, body)| body), depth);
            }
            Statement::For { from, to, by, body } => return self.for_loop(from, to, *by, body, depth),
            Statement::While(limit, condition, body) => {
                let control = control(1, depth);
                self.loops[control] = *limit;
                loop {
                    let condition = self.truth(condition)?;
                    if self.loops[control] <= 0 || !condition {
                        break;
                    }
                    self.loops[control] -= 1;
                    if !self.turn(body, depth)? {
                        break;
                    }
                }
            }
            Statement::Try { body, handler, finally } => return self.tried(body, handler, finally, depth),
            Statement::Repeat(limit, until, body) => {
                let control = control(2, depth);
                self.loops[control] = *limit;
                loop {
                    self.loops[control] -= 1;
                    if !self.turn(body, depth)? {
                        break;
                    }
                    let until = self.truth(until)?;
                    if self.loops[control] <= 0 || until {
                        break;
                    }
                }
            }
        }
        Ok(())
    }

    /// What is done in any case follows however the rest is left, but for a fault of the handler.
    fn tried(
        &mut self,
        body: &[Statement],
        handler: &[Statement],
        finally: &[Statement],
        depth: usize,
    ) -> Result<(), Stop> {
        self.code = match self.block(body, depth) {
            Err(Stop::Fault(FaultKind::DivisionByZero)) => 0x102,
            Err(Stop::Fault(FaultKind::IndexOutOfRange)) => 0x101,
            other => return self.finally(other, finally, depth),
        };
        let ended = self.block(handler, depth);
        self.finally(ended, finally, depth)
    }

    fn finally(&mut self, ended: Result<(), Stop>, finally: &[Statement], depth: usize) -> Result<(), Stop> {
        if matches!(ended, Err(Stop::Fault(_))) {
            return ended;
        }
        self.block(finally, depth).and(ended)
    }

    fn leave(&self, condition: &Truth, way: Stop) -> Result<(), Stop> {
        if self.truth(condition)? { Err(way) } else { Ok(()) }
    }

    /// One turn of a loop; false if it was the last.
    fn turn(&mut self, body: &[Statement], depth: usize) -> Result<bool, Stop> {
        match self.block(body, depth + 1) {
            Ok(()) | Err(Stop::Continue) => Ok(true),
            Err(Stop::Exit) => Ok(false),
            Err(other) => Err(other),
        }
    }

    /// The last value and the step are computed once, before the first; a variable at its limit ends the loop.
    fn for_loop(&mut self, from: &Number, to: &Number, by: i16, body: &[Statement], depth: usize) -> Result<(), Stop> {
        let control = control(0, depth);
        let last = self.number(to)?;
        self.loops[control] = self.number(from)?;
        if by == 0 {
            return Err(Stop::Fault(FaultKind::ZeroStep));
        }
        loop {
            let at = self.loops[control];
            let beyond = if by > 0 { at > last } else { at < last };
            if beyond || !self.turn(body, depth)? {
                return Ok(());
            }
            let at = self.loops[control];
            self.loops[control] = at.wrapping_add(by);
            if at.checked_add(by).is_none() {
                return Ok(());
            }
        }
    }
}
