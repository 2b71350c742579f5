//! Elementary data types (2nd ed. 2.3.1 Table 10, 3rd ed. Table 10) and their implicit
//! conversions (3rd ed. Figures 11 and 12).

macro_rules! elementary_types {
    ($($variant:ident $name:literal $size:literal $kind:ident $about:literal),* $(,)?) => {
        /// An elementary data type.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum ElementaryType {
            $(#[doc = concat!("`", $name, "`: ", $about)] $variant,)*
        }

        impl ElementaryType {
            /// Every type, in the order of the standard's table.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The keyword.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Bytes in memory; also the alignment.
            pub fn size(self) -> u32 {
                match self { $(Self::$variant => $size,)* }
            }

            pub(crate) fn kind(self) -> Kind {
                match self { $(Self::$variant => Kind::$kind,)* }
            }
        }
    };
}

elementary_types! {
    Bool "BOOL" 1 Bool "0 or 1 in one byte",
    Sint "SINT" 1 Signed "8 bit signed",
    Int "INT" 2 Signed "16 bit signed",
    Dint "DINT" 4 Signed "32 bit signed",
    Lint "LINT" 8 Signed "64 bit signed",
    Usint "USINT" 1 Unsigned "8 bit unsigned",
    Uint "UINT" 2 Unsigned "16 bit unsigned",
    Udint "UDINT" 4 Unsigned "32 bit unsigned",
    Ulint "ULINT" 8 Unsigned "64 bit unsigned",
    Byte "BYTE" 1 Bits "8 bits",
    Word "WORD" 2 Bits "16 bits",
    Dword "DWORD" 4 Bits "32 bits",
    Lword "LWORD" 8 Bits "64 bits",
    Real "REAL" 4 Real "IEC 60559 binary32",
    Lreal "LREAL" 8 Real "IEC 60559 binary64",
    Time "TIME" 8 Duration "signed 64 bit count of nanoseconds",
    Ltime "LTIME" 8 Duration "signed 64 bit count of nanoseconds",
    Date "DATE" 8 Date "midnight in signed 64 bit nanoseconds since 1970-01-01",
    Ldate "LDATE" 8 Date "midnight in signed 64 bit nanoseconds since 1970-01-01",
    Tod "TOD" 8 TimeOfDay "nanoseconds since midnight, 64 bit",
    Ltod "LTOD" 8 TimeOfDay "nanoseconds since midnight, 64 bit",
    Dt "DT" 8 DateTime "signed 64 bit nanoseconds since 1970-01-01",
    Ldt "LDT" 8 DateTime "signed 64 bit nanoseconds since 1970-01-01",
    Char "CHAR" 1 Character "an ISO 8859-1 character",
    Wchar "WCHAR" 2 Character "a UTF-16 code unit",
}

/// The generic types (2nd ed. Table 11) as far as they matter to operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Bool,
    Signed,
    Unsigned,
    Bits,
    Real,
    Duration,
    Date,
    TimeOfDay,
    DateTime,
    Character,
}

impl ElementaryType {
    /// The type of this keyword, in any case.
    pub fn find(name: &str) -> Option<Self> {
        const LONG: [(&str, ElementaryType); 4] = [
            ("TIME_OF_DAY", ElementaryType::Tod),
            ("LTIME_OF_DAY", ElementaryType::Ltod),
            ("DATE_AND_TIME", ElementaryType::Dt),
            ("LDATE_AND_TIME", ElementaryType::Ldt),
        ];
        let long = || LONG.iter().find(|(long, _)| long.eq_ignore_ascii_case(name)).map(|(_, ty)| *ty);
        Self::ALL.iter().copied().find(|ty| ty.name().eq_ignore_ascii_case(name)).or_else(long)
    }

    /// `ANY_INT`
    pub fn is_integer(self) -> bool {
        matches!(self.kind(), Kind::Signed | Kind::Unsigned)
    }

    /// `ANY_REAL`
    pub fn is_real(self) -> bool {
        self.kind() == Kind::Real
    }

    /// `ANY_NUM`
    pub fn is_number(self) -> bool {
        self.is_integer() || self.is_real()
    }

    /// `ANY_BIT`
    pub fn is_bits(self) -> bool {
        matches!(self.kind(), Kind::Bool | Kind::Bits)
    }

    /// `ANY_DURATION`
    pub fn is_duration(self) -> bool {
        self.kind() == Kind::Duration
    }

    /// `ANY_DATE`: dates and times of day.
    pub fn is_calendar(self) -> bool {
        matches!(self.kind(), Kind::Date | Kind::TimeOfDay | Kind::DateTime)
    }

    /// `ANY_CHAR`
    pub fn is_character(self) -> bool {
        self.kind() == Kind::Character
    }

    /// True if an integer constant can be one of its values.
    pub(crate) fn takes_integers(self) -> bool {
        !(self.is_duration() || self.is_calendar() || self.is_character())
    }

    /// True if negative values exist.
    pub fn is_signed(self) -> bool {
        matches!(self.kind(), Kind::Signed | Kind::Duration) || self.is_calendar()
    }

    /// Smallest and greatest value; nothing for reals.
    pub fn range(self) -> Option<(i128, i128)> {
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
    pub(crate) fn wrap(self, value: i128) -> i128 {
        let bits = self.size() * 8;
        let low = value & ((1_i128 << bits) - 1);
        let negative = self.is_signed() && (low >> (bits - 1)) & 1 == 1;
        match self.kind() {
            Kind::Bool => i128::from(value != 0),
            _ if negative => low - (1_i128 << bits),
            _ => low,
        }
    }
}

impl std::fmt::Display for ElementaryType {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::ElementaryType as E;

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
}
