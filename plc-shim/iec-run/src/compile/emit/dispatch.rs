//! Calls of methods: the instance, the table of what each type runs, and what guards a unit that
//! may be called while it runs.

use wasm_encoder::{ConstExpr, ElementSection, Elements, Instruction, MemArg, RefType, TableSection, TableType};

use super::emitter::{Emitter, RowPlace, Shared, value_type};
use super::inline::Call;
use crate::compile::analyse::Address;
use crate::compile::fault::FaultKind;
use onescan_iec::check::CALL_DEPTH_OFFSET;
use onescan_iec::ir::{Cast, Dispatch, Guard, Pou, PouId, Receiver, Row};

/// Deepest nesting of calls that come back to a unit that still runs.
const MAX_CALL_DEPTH: i32 = 128;

const WORD: MemArg = MemArg { offset: 0, align: 2, memory_index: 0 };
const BYTE: MemArg = MemArg { offset: 0, align: 0, memory_index: 0 };

/// The rows behind one another; `add_type` gives a signature its index.
pub(crate) fn place_rows(
    rows: &[Row],
    mut add_type: impl FnMut(Vec<wasm_encoder::ValType>, Vec<wasm_encoder::ValType>) -> u32,
) -> Vec<RowPlace> {
    let mut start = 0;
    let place = |row: &Row| {
        let parameters = row.parameters.iter().map(|ty| value_type(*ty)).collect();
        let signature = add_type(parameters, row.result.map(value_type).into_iter().collect());
        let place = RowPlace { start, first: row.first, signature };
        start += row.targets.len() as u32;
        place
    };
    rows.iter().map(place).collect()
}

/// The table and what stands in it; a type that never takes part in a row has no entry.
pub(crate) fn table(rows: &[Row], shared: &Shared<'_>) -> (TableSection, ElementSection) {
    let function = |target: &Option<PouId>| {
        let index = target.and_then(|pou| shared.function(pou));
        index.map_or_else(|| ConstExpr::ref_null(wasm_encoder::HeapType::FUNC), ConstExpr::ref_func)
    };
    let entries: Vec<ConstExpr> = rows.iter().flat_map(|row| &row.targets).map(function).collect();
    let (mut table, mut elements) = (TableSection::new(), ElementSection::new());
    let size = entries.len() as u64;
    debug_assert_eq!(
        entries.len(),
        rows.iter().map(|row| row.targets.len()).sum::<usize>(),
        "rows stand behind one another, as `place_rows` has placed them"
    );
    let element_type = RefType::FUNCREF;
    table.table(TableType { element_type, table64: false, minimum: size, maximum: Some(size), shared: false });
    elements.active(None, &ConstExpr::i32_const(0), Elements::Expressions(element_type, entries.into()));
    (table, elements)
}

/// What a call costs whose unit only the run decides: it pays for itself beyond this.
const DYNAMIC_CALL: u64 = 100;

impl Emitter<'_, '_> {
    /// Puts the address of the instance into its register.
    pub(crate) fn receiver(&mut self, receiver: &Receiver) -> Address {
        self.expression(&receiver.instance);
        let register = self.unpoint(receiver.pointer);
        self.set(register);
        if receiver.may_be_null {
            self.get(register);
            self.emit(Instruction::I32Eqz);
            self.fault_if(FaultKind::NullReference, receiver.instance.span);
        }
        Address::of_register(register)
    }

    /// Calls what is known, or what the table has for the type of the instance at `address`.
    pub(crate) fn call_on(&mut self, address: Address, dispatch: Dispatch, call: Call) {
        let Dispatch::Row(row) = dispatch else {
            return self.call(call);
        };
        let Call { callee, span, .. } = call;
        let Some(RowPlace { start, first, signature }) = self.shared().row(row) else {
            return self.impossible(span);
        };
        self.meter();
        self.put_budget_back();
        self.push_address(address);
        self.emit(Instruction::I32Load(WORD));
        self.emit(Instruction::I32Const(start.wrapping_sub(first) as i32));
        self.emit(Instruction::I32Add);
        self.mark_call(callee, span);
        self.emit(Instruction::CallIndirect { type_index: signature, table_index: 0 });
        self.charge(DYNAMIC_CALL);
        self.take_budget();
        self.changed(None);
    }

    /// Pushes the reference, or 0 if what it refers to is of none of the types.
    pub(crate) fn cast(&mut self, cast: &Cast) {
        self.expression(&cast.reference);
        let pointer = self.unpoint(cast.pointer);
        self.tee(pointer);
        self.emit(Instruction::I32Const(0));
        self.emit(Instruction::I32Const(0));
        // Nothing lies at 0, so a reference to nothing is of no type.
        for (first, last) in &cast.types {
            self.get(pointer);
            self.emit(Instruction::I32Load(WORD));
            self.emit(Instruction::I32Const(*first as i32));
            self.emit(Instruction::I32Sub);
            self.emit(Instruction::I32Const((last - first) as i32));
            self.emit(Instruction::I32LeU);
            self.emit(Instruction::I32Or);
        }
        self.emit(Instruction::Select);
    }

    /// Stops the PLC if the unit must not be entered now.
    pub(crate) fn enter_guarded(&mut self, pou: &Pou) {
        match pou.guard {
            Guard::None => {}
            Guard::Once(flag) => {
                self.emit(Instruction::I32Const(flag as i32));
                self.emit(Instruction::I32Load8U(BYTE));
                self.fault_if(FaultKind::Reentered, pou.span);
                self.set_flag(flag, 1);
            }
            Guard::Depth => {
                self.load_depth();
                self.emit(Instruction::I32Const(MAX_CALL_DEPTH));
                self.emit(Instruction::I32GeU);
                self.fault_if(FaultKind::CallTooDeep, pou.span);
                self.count_depth(1);
            }
        }
    }

    pub(crate) fn leave_guarded(&mut self, pou: &Pou) {
        match pou.guard {
            Guard::None => {}
            Guard::Once(flag) => self.set_flag(flag, 0),
            Guard::Depth => self.count_depth(-1),
        }
    }

    fn set_flag(&mut self, flag: u32, value: i32) {
        self.emit(Instruction::I32Const(flag as i32));
        self.emit(Instruction::I32Const(value));
        self.emit(Instruction::I32Store8(BYTE));
    }

    fn load_depth(&mut self) {
        self.emit(Instruction::I32Const(CALL_DEPTH_OFFSET as i32));
        self.emit(Instruction::I32Load(WORD));
    }

    fn count_depth(&mut self, step: i32) {
        self.emit(Instruction::I32Const(CALL_DEPTH_OFFSET as i32));
        self.load_depth();
        self.emit(Instruction::I32Const(step));
        self.emit(Instruction::I32Add);
        self.emit(Instruction::I32Store(WORD));
    }
}
