//! Entries of a device's table of symbols (Beckhoff: `AdsSymbolEntry`), and the types in them.

use onescan_server::signal::SignalType as T;

use super::frame::Bytes;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Where its value is: index group and index offset.
    pub place: (u32, u32),
    /// Bytes of its value.
    pub size: u32,
    /// Number of its base type.
    pub base: u32,
    /// Flags; 0x20 is read only.
    pub flags: u32,
    pub name: String,
    /// Its type, as declared.
    pub ty: String,
}

/// Flag of a symbol that must not be written.
pub const READ_ONLY: u32 = 0x20;
/// Bytes of an entry before its texts.
const FIXED: usize = 30;

impl Symbol {
    /// Its entry, without a comment.
    pub fn encoded(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let length = FIXED + self.name.len() + 1 + self.ty.len() + 1 + 1;
        for number in [length as u32, self.place.0, self.place.1, self.size, self.base, self.flags] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        for text in [&self.name[..], &self.ty, ""] {
            bytes.extend_from_slice(&(text.len() as u16).to_le_bytes());
        }
        for text in [&self.name[..], &self.ty, ""] {
            bytes.extend_from_slice(text.as_bytes());
            bytes.push(0);
        }
        bytes
    }

    /// The first entry of a table; nothing if it is cut short or its lengths cannot be.
    pub fn take(table: &mut Bytes<'_>) -> Option<Self> {
        let length = table.u32()? as usize;
        let mut entry = Bytes(table.take(length.checked_sub(4)?)?);
        let mut number = || entry.u32();
        let (place, size, base, flags) = ((number()?, number()?), number()?, number()?, number()?);
        let lengths = [entry.u16()?, entry.u16()?, entry.u16()?].map(usize::from);
        // Each text ends with a byte that is none of it.
        let mut text = |length: usize| {
            let bytes = entry.take(length)?;
            entry.take(1)?;
            Some(bytes.iter().copied().map(char::from).collect())
        };
        let (name, ty) = (text(lengths[0])?, text(lengths[1])?);
        Some(Self { place, size, base, flags, name, ty })
    }
}

/// How a value stands in the device's memory, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    ty: T,
}

impl Form {
    /// That of a signal's type.
    pub fn of(ty: T) -> Self {
        Self { ty }
    }

    /// Bytes of a value. A string has all of its characters and a zero behind them.
    pub fn size(self) -> usize {
        match self.ty {
            T::String(capacity) => usize::from(capacity) + 1,
            T::Wstring(capacity) => 2 * (usize::from(capacity) + 1),
            other @ (T::Elementary(_) | T::Bytes(_)) => other.size(),
        }
    }

    /// Number of the base type (Beckhoff: `ADSDATATYPEID`).
    pub fn base(self) -> u32 {
        match self.ty {
            T::BOOL => 33,
            T::SINT => 16,
            T::BYTE | T::USINT | T::CHAR => 17,
            T::INT => 2,
            T::WORD | T::UINT | T::WCHAR => 18,
            T::DINT => 3,
            T::DWORD | T::UDINT => 19,
            T::LINT => 20,
            T::REAL => 4,
            T::LREAL => 5,
            T::String(_) => 30,
            T::Wstring(_) => 31,
            // LWORD and ULINT; and durations and dates, which TwinCAT counts in ns without a sign.
            T::Elementary(_) => 21,
            // An array of bytes; the mapping refuses lines of bytes before anybody asks.
            T::Bytes(_) => 65,
        }
    }

    /// True if the symbol holds values of the type: by its name or, where that is the user's, by its base.
    pub fn fits(self, symbol: &Symbol) -> bool {
        let is_named = symbol.ty.eq_ignore_ascii_case(&self.ty.to_string());
        let is_counted = self.base() == 21 && symbol.base == 20;
        symbol.size as usize == self.size() && (is_named || is_counted || symbol.base == self.base())
    }

    /// A packed value to its bytes in the device.
    pub fn put(self, packed: &[u8], out: &mut Vec<u8>) {
        let end = out.len() + self.size();
        match self.ty {
            T::String(_) | T::Wstring(_) => out.extend_from_slice(&packed[2..]),
            T::Elementary(_) | T::Bytes(_) => out.extend_from_slice(packed),
        }
        out.resize(end, 0);
    }

    /// The other way; false if the bytes are not a value.
    pub fn take(self, bytes: &[u8], packed: &mut [u8]) -> bool {
        let width = match self.ty {
            T::String(_) => 1,
            T::Wstring(_) => 2,
            T::BOOL => {
                packed[0] = bytes[0];
                return bytes[0] <= 1;
            }
            T::Elementary(_) | T::Bytes(_) => {
                packed.copy_from_slice(bytes);
                return true;
            }
        };
        let characters = bytes.chunks_exact(width);
        let count = characters.clone().position(|character| character.iter().all(|byte| *byte == 0));
        let Some(count) = count else { return false };
        packed.fill(0);
        packed[..2].copy_from_slice(&(count as u16).to_le_bytes());
        packed[2..2 + count * width].copy_from_slice(&bytes[..count * width]);
        true
    }
}

/// One type of each base.
const NUMBERS: [T; 11] =
    [T::BOOL, T::SINT, T::USINT, T::INT, T::UINT, T::DINT, T::UDINT, T::LINT, T::ULINT, T::REAL, T::LREAL];

/// The elementary type that a symbol can be bound to.
pub fn elementary(symbol: &Symbol) -> Option<T> {
    let is_as_long = |ty: &T| Form::of(*ty).size() == symbol.size as usize;
    let by_name = symbol.ty.parse().ok().filter(is_as_long);
    by_name.or_else(|| {
        let characters =
            |width: u32| u16::try_from((symbol.size / width).checked_sub(1)?).ok().filter(|count| *count > 0);
        match symbol.base {
            30 => characters(1).map(T::String),
            31 => characters(2).map(T::Wstring),
            base => NUMBERS.into_iter().find(|ty| Form::of(*ty).base() == base && is_as_long(ty)),
        }
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn symbol(ty: &str, base: u32, size: u32) -> Symbol {
        Symbol { place: (0x4040, 8), size, base, flags: 0, name: "MAIN.x".to_owned(), ty: ty.to_owned() }
    }

    #[test]
    fn types_fit_by_name_or_base() {
        assert!(Form::of(T::INT).fits(&symbol("INT", 2, 2)));
        assert!(Form::of(T::INT).fits(&symbol("E_State", 2, 2)), "an enumeration");
        assert!(Form::of(T::LTIME).fits(&symbol("LTIME", 21, 8)));
        assert!(!Form::of(T::TIME).fits(&symbol("TIME", 19, 4)), "TIME of TwinCAT has 32 bits and counts ms");
        assert!(!Form::of(T::INT).fits(&symbol("DINT", 3, 4)));
        assert!(!Form::of(T::DINT).fits(&symbol("REAL", 4, 4)));
        assert!(Form::of(T::String(5)).fits(&symbol("STRING(5)", 30, 6)));
    }

    #[test]
    fn strings_end_with_a_zero() {
        let (form, packed) = (Form::of(T::Wstring(3)), [2, 0, b'a', 0, b'b', 0, 0, 0]);
        let mut bytes = Vec::new();
        form.put(&packed, &mut bytes);
        assert_eq!(bytes, [b'a', 0, b'b', 0, 0, 0, 0, 0]);
        let mut back = [9; 8];
        assert!(form.take(&bytes, &mut back));
        assert_eq!(back, packed);
        assert!(!Form::of(T::String(2)).take(b"abc", &mut [0; 4]), "no zero");
        assert!(!Form::of(T::BOOL).take(&[2], &mut [0]));
    }

    proptest! {
        #[test]
        fn an_entry_comes_as_it_went(name in "[A-Za-z0-9_.\\[\\]]{0,40}", ty in "[A-Z_]{0,20}", numbers in any::<[u32; 5]>()) {
            let [group, offset, size, base, flags] = numbers;
            let symbol = Symbol { place: (group, offset), size, base, flags, name, ty };
            let bytes = [symbol.encoded(), vec![1, 2, 3]].concat();
            let mut rest = Bytes(&bytes);
            prop_assert_eq!(Symbol::take(&mut rest), Some(symbol));
            prop_assert_eq!(rest.0, &[1, 2, 3]);
        }

        #[test]
        fn any_bytes_are_an_entry_or_none(bytes in prop::collection::vec(any::<u8>(), 0..80), length in 0_u8..90) {
            let bytes = [&[length, 0, 0, 0][..], &bytes].concat();
            let _ = Symbol::take(&mut Bytes(&bytes));
        }
    }
}
