//! Whole numbers in a base of the reader's choice.

use onescan_base::elementary::Kind;

use super::super::{Application, Variable};
use onescan_iec::ir::ElementaryType;

/// How whole numbers are shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Radix {
    /// As literals of their types: bit strings hexadecimal, all others decimal.
    #[default]
    Own,
    Decimal,
    /// `16#2A`, as many digits as the type has; negative numbers as two's complement.
    Hexadecimal,
    Binary,
}

impl Application {
    /// The value of a variable, in `radix` if it is an integer, a bit string or an enumeration; else as
    /// [`Self::value_text`] shows it.
    pub fn value_text_in(&self, variable: &Variable, memory: &[u8], radix: Radix) -> String {
        let whole = |ty: &ElementaryType| ty.is_integer() || ty.kind() == Kind::Bits;
        let Some(ty) = variable.ty.filter(whole).filter(|_| radix != Radix::Own) else {
            return self.value_text(variable, memory);
        };
        let mut raw = [0; 8];
        raw.iter_mut().zip(variable.bytes(memory)).for_each(|(target, source)| *target = source);
        let (bits, size) = (u64::from_le_bytes(raw), ty.size() as usize);
        match radix {
            Radix::Hexadecimal => format!("16#{bits:0width$X}", width = 2 * size),
            Radix::Binary => format!("2#{bits:0width$b}", width = 8 * size),
            Radix::Own | Radix::Decimal => ty.wrap(i128::from(bits)).to_string(),
        }
    }
}
