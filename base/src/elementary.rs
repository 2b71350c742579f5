//! The elementary data types of IEC 61131-3 (2nd ed. 2.3.1 Table 10, 3rd ed. Table 10) and their implicit
//! conversions (3rd ed. Figures 11 and 12).

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

macro_rules! elementary_types {
    ($($variant:ident $name:literal $(= $other:literal)* # $prefix:literal $size:literal $kind:ident $about:literal),* $(,)?) => {
        /// An elementary data type.
        ///
        /// ```
        /// use onescan_base::ElementaryType;
        ///
        /// assert_eq!(ElementaryType::find("ltime_of_day"), Some(ElementaryType::Ltod));
        /// assert_eq!(ElementaryType::Ltod.name(), "LTOD");
        /// assert_eq!(ElementaryType::Lreal.size(), 8);
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum ElementaryType {
            $(#[doc = concat!("`", $name, "`: ", $about)] $variant,)*
        }

        impl ElementaryType {
            /// Every type, in the order of the standard's table.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The keyword; the short one where there are two.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// The shortest prefix of its literals (2nd ed. Tables 7 and 8): `T` in `T#1s`.
            pub const fn literal_prefix(self) -> &'static str {
                match self { $(Self::$variant => $prefix,)* }
            }

            /// Bytes in memory and in an image; also the natural alignment.
            #[inline] // as that of a signal's type
            pub const fn size(self) -> u32 {
                match self { $(Self::$variant => $size,)* }
            }

            /// The generic type that it belongs to.
            pub const fn kind(self) -> Kind {
                match self { $(Self::$variant => Kind::$kind,)* }
            }
        }

        /// Every spelling of every type, the short one first.
        const KEYWORDS: &[(&str, ElementaryType)] = &[
            $(($name, ElementaryType::$variant), $(($other, ElementaryType::$variant),)*)*
        ];
    };
}

elementary_types! {
    Bool "BOOL" # "BOOL" 1 Bool "0 or 1 in one byte",
    Sint "SINT" # "SINT" 1 Signed "8 bit signed",
    Int "INT" # "INT" 2 Signed "16 bit signed",
    Dint "DINT" # "DINT" 4 Signed "32 bit signed",
    Lint "LINT" # "LINT" 8 Signed "64 bit signed",
    Usint "USINT" # "USINT" 1 Unsigned "8 bit unsigned",
    Uint "UINT" # "UINT" 2 Unsigned "16 bit unsigned",
    Udint "UDINT" # "UDINT" 4 Unsigned "32 bit unsigned",
    Ulint "ULINT" # "ULINT" 8 Unsigned "64 bit unsigned",
    Byte "BYTE" # "BYTE" 1 Bits "8 bits",
    Word "WORD" # "WORD" 2 Bits "16 bits",
    Dword "DWORD" # "DWORD" 4 Bits "32 bits",
    Lword "LWORD" # "LWORD" 8 Bits "64 bits",
    Real "REAL" # "REAL" 4 Real "IEC 60559 binary32",
    Lreal "LREAL" # "LREAL" 8 Real "IEC 60559 binary64",
    Time "TIME" # "T" 8 Duration "signed 64 bit count of nanoseconds",
    Ltime "LTIME" # "LT" 8 Duration "signed 64 bit count of nanoseconds",
    Date "DATE" # "D" 8 Date "midnight in signed 64 bit nanoseconds since 1970-01-01",
    Ldate "LDATE" # "LD" 8 Date "midnight in signed 64 bit nanoseconds since 1970-01-01",
    Tod "TOD" = "TIME_OF_DAY" # "TOD" 8 TimeOfDay "nanoseconds since midnight, 64 bit",
    Ltod "LTOD" = "LTIME_OF_DAY" # "LTOD" 8 TimeOfDay "nanoseconds since midnight, 64 bit",
    Dt "DT" = "DATE_AND_TIME" # "DT" 8 DateTime "signed 64 bit nanoseconds since 1970-01-01",
    Ldt "LDT" = "LDATE_AND_TIME" # "LDT" 8 DateTime "signed 64 bit nanoseconds since 1970-01-01",
    Char "CHAR" # "CHAR" 1 Character "an ISO 8859-1 character",
    Wchar "WCHAR" # "WCHAR" 2 Character "a UTF-16 code unit",
}

/// The generic types (2nd ed. Table 11) as far as they matter to operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// BOOL.
    Bool,
    /// `ANY_SIGNED`
    Signed,
    /// `ANY_UNSIGNED`
    Unsigned,
    /// `ANY_BIT`, except BOOL.
    Bits,
    /// `ANY_REAL`
    Real,
    /// `ANY_DURATION`
    Duration,
    /// DATE and LDATE.
    Date,
    /// TOD and LTOD.
    TimeOfDay,
    /// DT and LDT.
    DateTime,
    /// `ANY_CHAR`
    Character,
}

impl ElementaryType {
    /// The type of this keyword, in any case and any of its spellings.
    ///
    /// ```
    /// # use onescan_base::ElementaryType;
    /// assert_eq!(ElementaryType::find("Date_And_Time"), Some(ElementaryType::Dt));
    /// assert_eq!(ElementaryType::find("FLOAT"), None);
    /// ```
    pub fn find(name: &str) -> Option<Self> {
        KEYWORDS.iter().find(|(keyword, _)| keyword.eq_ignore_ascii_case(name)).map(|(_, ty)| *ty)
    }

    /// The type whose literals begin with this prefix, in any case: `T`, `TIME`, `D`, `INT`.
    ///
    /// ```
    /// # use onescan_base::ElementaryType;
    /// assert_eq!(ElementaryType::of_literal("lt"), Some(ElementaryType::Ltime));
    /// assert_eq!(ElementaryType::of_literal("DATE"), Some(ElementaryType::Date));
    /// ```
    pub fn of_literal(prefix: &str) -> Option<Self> {
        let short = Self::ALL.iter().copied().find(|ty| ty.literal_prefix().eq_ignore_ascii_case(prefix));
        short.or_else(|| Self::find(prefix))
    }

    /// `ANY_INT`
    pub const fn is_integer(self) -> bool {
        matches!(self.kind(), Kind::Signed | Kind::Unsigned)
    }

    /// `ANY_REAL`
    pub const fn is_real(self) -> bool {
        matches!(self.kind(), Kind::Real)
    }

    /// `ANY_NUM`
    pub const fn is_number(self) -> bool {
        self.is_integer() || self.is_real()
    }

    /// `ANY_BIT`
    pub const fn is_bits(self) -> bool {
        matches!(self.kind(), Kind::Bool | Kind::Bits)
    }

    /// `ANY_DURATION`
    pub const fn is_duration(self) -> bool {
        matches!(self.kind(), Kind::Duration)
    }

    /// `ANY_DATE`: dates and times of day.
    pub const fn is_calendar(self) -> bool {
        matches!(self.kind(), Kind::Date | Kind::TimeOfDay | Kind::DateTime)
    }

    /// `ANY_CHAR`
    pub const fn is_character(self) -> bool {
        matches!(self.kind(), Kind::Character)
    }

    /// True if an integer constant can be one of its values.
    pub const fn takes_integers(self) -> bool {
        !(self.is_duration() || self.is_calendar() || self.is_character())
    }

    /// True if negative values exist.
    pub const fn is_signed(self) -> bool {
        matches!(self.kind(), Kind::Signed | Kind::Duration) || self.is_calendar()
    }

    /// Smallest and greatest value; nothing for reals.
    pub const fn range(self) -> Option<(i128, i128)> {
        let bits = self.size() * 8;
        match self.kind() {
            Kind::Bool => Some((0, 1)),
            Kind::Signed | Kind::Duration | Kind::Date | Kind::TimeOfDay | Kind::DateTime => {
                Some((-(1 << (bits - 1)), (1 << (bits - 1)) - 1))
            }
            Kind::Unsigned | Kind::Bits | Kind::Character => Some((0, (1 << bits) - 1)),
            Kind::Real => None,
        }
    }

    /// True if a value becomes one of `target` without a conversion function and without loss
    /// (3rd ed. Figure 11).
    pub fn widens_to(self, target: Self) -> bool {
        if self == target {
            return true;
        }
        match (self.kind(), target.kind()) {
            (Kind::Signed, Kind::Signed)
            | (Kind::Unsigned, Kind::Unsigned | Kind::Signed)
            | (Kind::Bits, Kind::Bits)
            | (Kind::Real | Kind::Signed | Kind::Unsigned, Kind::Real) => self.size() < target.size(),
            (Kind::Bool, Kind::Bits) => true,
            (Kind::Duration, Kind::Duration)
            | (Kind::Date, Kind::Date)
            | (Kind::TimeOfDay, Kind::TimeOfDay)
            | (Kind::DateTime, Kind::DateTime) => matches!(self, Self::Time | Self::Date | Self::Tod | Self::Dt),
            _ => false,
        }
    }

    /// The smallest type that both widen to.
    pub fn common(self, other: Self) -> Option<Self> {
        let fits = |ty: &Self| self.widens_to(*ty) && other.widens_to(*ty);
        Self::ALL.iter().copied().filter(fits).min_by_key(|ty| ty.size())
    }

    /// `value` cut to the type's width, two's complement.
    pub fn wrap(self, value: i128) -> i128 {
        let bits = self.size() * 8;
        let low = value & ((1_i128 << bits) - 1);
        let negative = self.is_signed() && (low >> (bits - 1)) & 1 == 1;
        match self.kind() {
            Kind::Bool => i128::from(value != 0),
            _ if negative => low - (1_i128 << bits),
            _ => low,
        }
    }

    /// The elements of an array of this type as numbers; `bytes` holds them one behind the other, and a rest that is not a
    /// whole element is left out. Times and dates are nanoseconds.
    ///
    /// The type is looked at once and not for each element: pages show arrays of ten thousands of elements.
    ///
    /// ```
    /// use onescan_base::ElementaryType;
    ///
    /// assert_eq!(ElementaryType::Int.numbers(&[0xfe, 0xff, 7, 0]), [-2.0, 7.0]);
    /// ```
    #[must_use]
    pub fn numbers(self, bytes: &[u8]) -> Vec<f64> {
        match (self.kind(), self.is_signed(), self.size()) {
            (Kind::Bool, ..) => each(bytes, |[byte]| f64::from(u8::from(byte != 0))),
            (Kind::Real, _, 4) => each(bytes, |real| f64::from(f32::from_le_bytes(real))),
            (Kind::Real, ..) => each(bytes, f64::from_le_bytes),
            (_, true, 1) => each(bytes, |whole| f64::from(i8::from_le_bytes(whole))),
            (_, true, 2) => each(bytes, |whole| f64::from(i16::from_le_bytes(whole))),
            (_, true, 4) => each(bytes, |whole| f64::from(i32::from_le_bytes(whole))),
            (_, true, _) => each(bytes, |whole| i64::from_le_bytes(whole) as f64),
            (_, false, 1) => each(bytes, |whole| f64::from(u8::from_le_bytes(whole))),
            (_, false, 2) => each(bytes, |whole| f64::from(u16::from_le_bytes(whole))),
            (_, false, 4) => each(bytes, |whole| f64::from(u32::from_le_bytes(whole))),
            (_, false, _) => each(bytes, |whole| u64::from_le_bytes(whole) as f64),
        }
    }
}

fn each<const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|element| number(*element)).collect()
}

impl fmt::Display for ElementaryType {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A text that is not a keyword of an elementary type.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is not an elementary type of IEC 61131-3 (BOOL, INT, REAL, TIME, …)")]
pub struct NoElementaryType(pub String);

impl FromStr for ElementaryType {
    type Err = NoElementaryType;

    fn from_str(text: &str) -> Result<Self, NoElementaryType> {
        Self::find(text).ok_or_else(|| NoElementaryType(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::ElementaryType as E;

    #[test]
    fn every_spelling_is_found_and_belongs_to_one_type() {
        for (at, (keyword, ty)) in super::KEYWORDS.iter().enumerate() {
            assert_eq!(E::find(&keyword.to_ascii_lowercase()), Some(*ty));
            assert_eq!(E::of_literal(keyword), Some(*ty));
            assert_eq!(ty.name().parse(), Ok(*ty));
            assert!(super::KEYWORDS[..at].iter().all(|(other, _)| other != keyword), "{keyword}");
        }
        assert!("FLOAT".parse::<E>().is_err() && "".parse::<E>().is_err());
    }

    #[test]
    fn implicit_conversions_lose_nothing() {
        assert!(E::Sint.widens_to(E::Int) && E::Usint.widens_to(E::Int) && E::Int.widens_to(E::Real));
        assert!(E::Dint.widens_to(E::Lreal) && E::Bool.widens_to(E::Byte));
        assert!(!E::Int.widens_to(E::Sint) && !E::Uint.widens_to(E::Int) && !E::Int.widens_to(E::Uint));
        assert!(!E::Dint.widens_to(E::Real) && !E::Lint.widens_to(E::Lreal));
        assert!(!E::Word.widens_to(E::Uint) && !E::Byte.widens_to(E::Bool));
        assert!(E::Time.widens_to(E::Ltime) && !E::Ltime.widens_to(E::Time));
    }

    #[test]
    fn common_types_are_the_smallest() {
        assert_eq!(E::Sint.common(E::Usint), Some(E::Int));
        assert_eq!(E::Dint.common(E::Real), Some(E::Lreal));
        assert_eq!(E::Int.common(E::Real), Some(E::Real));
        assert_eq!(E::Lint.common(E::Ulint), None);
        assert_eq!(E::Word.common(E::Bool), Some(E::Word));
    }

    #[test]
    fn wrapping_is_two_s_complement() {
        assert_eq!(E::Sint.wrap(128), -128);
        assert_eq!(E::Usint.wrap(-1), 255);
        assert_eq!(E::Lint.wrap(1 << 63), -(1 << 63));
        assert_eq!(E::Ulint.wrap(-1), (1 << 64) - 1);
    }

    #[test]
    fn numbers_of_an_array_are_those_of_its_elements() {
        let bytes: Vec<u8> = (0..64_u8).map(|byte| byte.wrapping_mul(41) ^ 0x80).collect();
        for &ty in E::ALL {
            let one_by_one = bytes.chunks_exact(ty.size() as usize).map(|element| -> f64 {
                let signal = crate::SignalType::Elementary(ty);
                match (signal.integer(element), element) {
                    (Some(whole), _) => whole as f64,
                    (None, [a, b, c, d]) => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
                    (None, element) => f64::from_le_bytes(element.try_into().expect("eight bytes")),
                }
            });
            let (whole, single): (Vec<u64>, Vec<u64>) =
                (ty.numbers(&bytes).into_iter().map(f64::to_bits).collect(), one_by_one.map(f64::to_bits).collect());
            assert_eq!(whole, single, "{ty}");
        }
    }
}
