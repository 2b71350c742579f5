//! Where a signal lies in a block's memory.

use onescan_base::ElementaryType;
use onescan_iec_run::Application;

use super::{HOLDER, INSTANCE, ProgramError};
use crate::component::declare::Value;
use crate::component::kind::Values;

/// A variable of the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Socket {
    offset: usize,
    ty: ElementaryType,
}

impl Socket {
    /// The variable `name` of the block; `wrong` gives a fault the place of its declaration.
    ///
    /// # Errors
    /// None for a variable that the block declares with an elementary type.
    pub(super) fn find(
        application: &Application,
        name: &str,
        wrong: impl Fn(String, Option<String>) -> ProgramError,
    ) -> Result<Self, ProgramError> {
        let found = application.variable(&format!("{HOLDER}.{INSTANCE}.{name}"));
        let found = found.map_err(|error| wrong(error.to_string(), error.help))?;
        let unusable = || wrong(format!("`{name}` is {}, which no signal is", found.type_name), None);
        let ty = found.ty.ok_or_else(unusable)?;
        Ok(Self { offset: found.offset as usize, ty })
    }

    /// The name of its type.
    pub(super) const fn type_name(self) -> &'static str {
        self.ty.name()
    }

    /// What values it takes; none for a type that no signal of a component has.
    pub(super) fn values(self) -> Option<Values> {
        match self.ty {
            ElementaryType::Bool => Some(Values::Bool),
            ElementaryType::Real | ElementaryType::Lreal => Some(Values::Number),
            ElementaryType::Sint
            | ElementaryType::Usint
            | ElementaryType::Int
            | ElementaryType::Uint
            | ElementaryType::Dint => Some(Values::Whole),
            _ => None,
        }
    }

    /// Writes a value; false if the variable's type does not hold it.
    #[must_use]
    pub(super) fn set(self, memory: &mut [u8], value: Value) -> bool {
        let small = |whole: i32| match self.ty {
            ElementaryType::Sint => i8::try_from(whole).map(|small| small.to_le_bytes().to_vec()),
            ElementaryType::Usint => u8::try_from(whole).map(|small| small.to_le_bytes().to_vec()),
            ElementaryType::Int => i16::try_from(whole).map(|small| small.to_le_bytes().to_vec()),
            ElementaryType::Uint => u16::try_from(whole).map(|small| small.to_le_bytes().to_vec()),
            _ => Ok(whole.to_le_bytes().to_vec()),
        };
        let bytes = match (value, self.ty) {
            (Value::Bool(flag), ElementaryType::Bool) => vec![u8::from(flag)],
            (Value::Number(number), ElementaryType::Lreal) => number.to_le_bytes().to_vec(),
            (Value::Number(number), ElementaryType::Real) => (number as f32).to_le_bytes().to_vec(),
            (Value::Whole(whole), _) => match small(whole) {
                Ok(bytes) => bytes,
                Err(_) => return false,
            },
            _ => return false,
        };
        let Some(place) = memory.get_mut(self.offset..self.offset + bytes.len()) else { return false };
        place.copy_from_slice(&bytes);
        true
    }

    /// Reads the value; none if there is none of its type.
    pub(super) fn get(self, memory: &[u8]) -> Option<Value> {
        fn bytes<const N: usize>(memory: &[u8], at: usize) -> Option<[u8; N]> {
            memory.get(at..at + N)?.try_into().ok()
        }
        let at = self.offset;
        Some(match self.ty {
            ElementaryType::Bool => Value::Bool(*memory.get(at)? != 0),
            ElementaryType::Real => Value::Number(f64::from(f32::from_le_bytes(bytes(memory, at)?))),
            ElementaryType::Lreal => Value::Number(f64::from_le_bytes(bytes(memory, at)?)),
            ElementaryType::Sint => Value::Whole(i32::from(i8::from_le_bytes(bytes(memory, at)?))),
            ElementaryType::Usint => Value::Whole(i32::from(u8::from_le_bytes(bytes(memory, at)?))),
            ElementaryType::Int => Value::Whole(i32::from(i16::from_le_bytes(bytes(memory, at)?))),
            ElementaryType::Uint => Value::Whole(i32::from(u16::from_le_bytes(bytes(memory, at)?))),
            ElementaryType::Dint => Value::Whole(i32::from_le_bytes(bytes(memory, at)?)),
            _ => return None,
        })
    }
}
