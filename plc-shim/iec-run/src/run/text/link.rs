//! The imports of the module, bound to the PLC's memory.

use wasmtime::{Caller, Error, Linker, Trap, Val};

use super::view::{Outside, Target, View};
use super::{edit, parse};
use crate::application::text::{Line, format, format_long_time};
use crate::compile::text_host::{LONG_TIME, MODULE, TextImport};
use crate::run::host_state::HostState;
use onescan_iec::ir::ElementaryType;
use onescan_iec::ir::text::Edit;

/// Characters that cost as much as one instruction.
const CHARACTERS_PER_INSTRUCTION: u64 = 4;

/// So many characters are paid for with the call.
const FREE_CHARACTERS: u64 = 80;

impl From<Outside> for Error {
    fn from(_: Outside) -> Self {
        Trap::MemoryOutOfBounds.into()
    }
}

fn with_memory<T>(
    caller: &mut Caller<'_, HostState>,
    work: impl FnOnce(&mut [u8]) -> Result<(T, u64), Outside>,
) -> Result<T, Error> {
    let memory = caller.data().memory.ok_or(Outside)?;
    let (result, characters) = work(memory.data_mut(&mut *caller))?;
    if characters > FREE_CHARACTERS {
        pay(caller, characters / CHARACTERS_PER_INSTRUCTION)?;
    }
    Ok(result)
}

fn pay(caller: &mut Caller<'_, HostState>, cost: u64) -> Result<(), Error> {
    let budget = caller.data().budget.ok_or_else(|| Error::msg("the module has no budget"))?;
    let left = budget.get(&mut *caller).i64().ok_or_else(|| Error::msg("the budget is not a LINT"))?;
    let left = left.saturating_sub(cost.cast_signed());
    budget.set(&mut *caller, Val::I64(left))?;
    if left < 0 { Err(Trap::OutOfFuel.into()) } else { Ok(()) }
}

/// Gives the module its functions on strings.
pub(in crate::run) fn link(linker: &mut Linker<HostState>) -> Result<(), Error> {
    linker.func_wrap(MODULE, TextImport::Length.name(), length)?;
    linker.func_wrap(MODULE, TextImport::Compare.name(), compare)?;
    linker.func_wrap(MODULE, TextImport::Find.name(), find)?;
    linker.func_wrap(MODULE, TextImport::Edit.name(), edit_strings)?;
    linker.func_wrap(MODULE, TextImport::Format.name(), format_value)?;
    linker.func_wrap(MODULE, TextImport::Parse.name(), parse_value)?;
    Ok(())
}

fn length(mut caller: Caller<'_, HostState>, a: i32, a_code: i32) -> Result<i32, Error> {
    with_memory(&mut caller, |memory| {
        let used = View::new(memory, a, a_code)?.used;
        Ok((used as i32, used as u64))
    })
}

fn compare(mut caller: Caller<'_, HostState>, a: i32, a_code: i32, b: i32, b_code: i32) -> Result<i32, Error> {
    with_memory(&mut caller, |memory| {
        let (left, right) = (View::new(memory, a, a_code)?, View::new(memory, b, b_code)?);
        Ok((edit::compare(memory, &left, &right), left.used.min(right.used) as u64))
    })
}

fn find(mut caller: Caller<'_, HostState>, a: i32, a_code: i32, b: i32, b_code: i32) -> Result<i32, Error> {
    with_memory(&mut caller, |memory| {
        let (whole, part) = (View::new(memory, a, a_code)?, View::new(memory, b, b_code)?);
        Ok(edit::find(memory, &whole, &part))
    })
}

#[expect(clippy::too_many_arguments, reason = "the import's signature")]
fn edit_strings(
    mut caller: Caller<'_, HostState>,
    form: i32,
    a: i32,
    a_code: i32,
    b: i32,
    b_code: i32,
    length: i64,
    position: i64,
    target: i32,
    target_code: i32,
) -> Result<i32, Error> {
    let form = Edit::ALL.get(form.cast_unsigned() as usize).copied();
    let form = form.ok_or_else(|| Error::msg("a function on strings that there is not"))?;
    with_memory(&mut caller, |memory| {
        let strings = [View::new(memory, a, a_code)?, View::new(memory, b, b_code)?];
        let made = Target::new(memory, target, target_code)?;
        let work = strings.iter().map(|view| view.used as u64).sum();
        edit::edit(memory, form, strings, length, position, made);
        Ok((target, work))
    })
}

fn type_of(number: i32) -> Result<ElementaryType, Error> {
    let known = ElementaryType::ALL.get(number.cast_unsigned() as usize);
    known.copied().ok_or_else(|| Error::msg("a number that stands for no elementary type"))
}

fn format_value(
    mut caller: Caller<'_, HostState>,
    ty: i32,
    bits: i64,
    target: i32,
    target_code: i32,
) -> Result<i32, Error> {
    let ty = if ty == LONG_TIME { None } else { Some(type_of(ty)?) };
    with_memory(&mut caller, |memory| {
        let mut made = Target::new(memory, target, target_code)?;
        if ty.is_some_and(ElementaryType::is_character) {
            made.push(memory, bits as u16);
        }
        let line = ty.map_or_else(|| format_long_time(bits.cast_unsigned()), |ty| format(ty, bits));
        made.append(memory, line.text().as_bytes());
        made.finish(memory);
        Ok((target, line.text().len() as u64))
    })
}

/// Characters beyond ASCII, and those beyond a line's length, belong to no value.
fn parse_value(mut caller: Caller<'_, HostState>, ty: i32, a: i32, a_code: i32) -> Result<i64, Error> {
    let ty = type_of(ty)?;
    with_memory(&mut caller, |memory| {
        let text = View::new(memory, a, a_code)?;
        if ty.is_character() {
            let first = if text.used == 0 { 0 } else { text.get(memory, 0) };
            // What a CHAR cannot be becomes `?`, as in a STRING.
            let fits = ty.size() > 1 || first <= 0xff;
            return Ok((i64::from(if fits { first } else { u16::from(b'?') }), 1));
        }
        let mut line = Line::new();
        for index in 0..text.used {
            match u8::try_from(text.get(memory, index)) {
                Ok(byte) if byte.is_ascii() => line.push(byte),
                _ => break,
            }
        }
        Ok((parse::parse(ty, line.text()), line.text().len() as u64))
    })
}
