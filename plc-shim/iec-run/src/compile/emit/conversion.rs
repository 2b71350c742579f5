//! Conversions between elementary types, of the number itself.

use wasm_encoder::{Ieee32, Ieee64, Instruction, ValType};

use super::emitter::{Emitter, value_type};
use onescan_iec::ir::elementary::Kind;
use onescan_iec::ir::{ElementaryType, Expr, Rounding};

impl Emitter<'_, '_> {
    /// Turns the value on the stack from one type into another.
    pub(crate) fn convert(&mut self, operand: &Expr, to: ElementaryType, rounding: Rounding) {
        let from = self.held_as(operand.ty);
        match (from.kind(), to.kind()) {
            (_, Kind::Bool) => self.is_not_zero(from),
            (Kind::Real, Kind::Real) => match (from.size(), to.size()) {
                (4, 8) => self.emit(Instruction::F64PromoteF32),
                (8, 4) => self.emit(Instruction::F32DemoteF64),
                _ => {}
            },
            (Kind::Real, _) => self.real_to_integer(from, to, rounding),
            (_, Kind::Real) => self.integer_to_real(operand, from, to),
            _ => self.integer_to_integer(from, to),
        }
    }

    fn is_not_zero(&mut self, from: ElementaryType) {
        match value_type(from) {
            ValType::F32 => {
                self.emit(Instruction::F32Const(Ieee32::new(0)));
                self.emit(Instruction::F32Ne);
            }
            ValType::F64 => {
                self.emit(Instruction::F64Const(Ieee64::new(0)));
                self.emit(Instruction::F64Ne);
            }
            ValType::I64 => {
                self.emit(Instruction::I64Const(0));
                self.emit(Instruction::I64Ne);
            }
            _ => {
                self.emit(Instruction::I32Const(0));
                self.emit(Instruction::I32Ne);
            }
        }
    }

    fn integer_to_integer(&mut self, from: ElementaryType, to: ElementaryType) {
        match (from.size() == 8, to.size() == 8) {
            (false, true) if from.is_signed() => self.emit(Instruction::I64ExtendI32S),
            (false, true) => self.emit(Instruction::I64ExtendI32U),
            (true, false) => {
                self.emit(Instruction::I32WrapI64);
                self.wrap(to);
            }
            (false, false) => self.wrap(to),
            (true, true) => {}
        }
    }

    /// What never is as large as the sign is converted as a signed number, which machines do
    /// faster.
    fn integer_to_real(&mut self, operand: &Expr, from: ElementaryType, to: ElementaryType) {
        let small = |(_, greatest): (i128, i128)| greatest < 1 << 31 || (from.size() == 8 && greatest < 1 << 63);
        let signed = from.is_signed() || self.interval(operand).is_some_and(small);
        self.emit(match (from.size() == 8, signed, to.size()) {
            (false, true, 4) => Instruction::F32ConvertI32S,
            (false, false, 4) => Instruction::F32ConvertI32U,
            (true, true, 4) => Instruction::F32ConvertI64S,
            (true, false, 4) => Instruction::F32ConvertI64U,
            (false, true, _) => Instruction::F64ConvertI32S,
            (false, false, _) => Instruction::F64ConvertI32U,
            (true, true, _) => Instruction::F64ConvertI64S,
            (true, false, _) => Instruction::F64ConvertI64U,
        });
    }

    /// The standard leaves what is out of range to the implementer (2nd ed. Annex E): it
    /// becomes the nearest limit, and NaN becomes 0.
    fn real_to_integer(&mut self, from: ElementaryType, to: ElementaryType, rounding: Rounding) {
        if from.size() == 4 {
            self.emit(Instruction::F64PromoteF32);
        }
        match rounding {
            Rounding::NearestEven => self.emit(Instruction::F64Nearest),
            Rounding::NearestAway => self.round_away(),
            Rounding::Truncate => self.emit(Instruction::F64Trunc),
            Rounding::Up => self.emit(Instruction::F64Ceil),
            Rounding::Down => self.emit(Instruction::F64Floor),
        }
        if to.size() == 8 {
            let signed = to.is_signed();
            self.emit(if signed { Instruction::I64TruncSatF64S } else { Instruction::I64TruncSatF64U });
            return;
        }
        self.emit(Instruction::I64TruncSatF64S);
        if let Some((low, high)) = to.range() {
            self.limit(low as i64, Instruction::I64LtS);
            self.limit(high as i64, Instruction::I64GtS);
        }
        self.emit(Instruction::I32WrapI64);
    }

    /// Rounds the number on the stack, ties away from zero. What lies beyond the number's whole part is
    /// exact, so the half is found exactly too.
    fn round_away(&mut self) {
        let number = self.scratch(ValType::F64);
        self.tee(number);
        self.emit(Instruction::F64Trunc);
        self.get(number);
        self.get(number);
        self.emit(Instruction::F64Trunc);
        self.emit(Instruction::F64Sub);
        // Twice the fraction, without its own: -1, 0 or 1.
        self.emit(Instruction::F64Const(Ieee64::new(2.0_f64.to_bits())));
        self.emit(Instruction::F64Mul);
        self.emit(Instruction::F64Trunc);
        self.emit(Instruction::F64Add);
        self.release(number);
    }

    /// Replaces the number on the stack by `limit` if it lies `beyond`.
    fn limit(&mut self, limit: i64, beyond: Instruction<'static>) {
        let number = self.scratch(ValType::I64);
        self.set(number);
        self.emit(Instruction::I64Const(limit));
        self.get(number);
        self.get(number);
        self.emit(Instruction::I64Const(limit));
        self.emit(beyond);
        self.emit(Instruction::Select);
        self.release(number);
    }
}
