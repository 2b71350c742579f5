//! The elementary types, with names and literals of their values.

use super::super::dice::Dice;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Bool,
    Signed,
    Unsigned,
    Bits,
    Real,
    Time,
    Moment,
    Clock,
    Day,
    Text,
}

#[derive(Clone, Copy)]
pub(super) struct Type {
    pub(super) name: &'static str,
    pub(super) bits: u32,
    pub(super) kind: Kind,
}

pub(super) const fn ty(name: &'static str, bits: u32, kind: Kind) -> Type {
    Type { name, bits, kind }
}

pub(super) const BOOL: Type = ty("BOOL", 1, Kind::Bool);
pub(super) const INT: Type = ty("INT", 16, Kind::Signed);
pub(super) const LREAL: Type = ty("LREAL", 64, Kind::Real);
pub(super) const TIME: Type = ty("TIME", 64, Kind::Time);
pub(super) const MOMENT: Type = ty("DT", 64, Kind::Moment);
pub(super) const CLOCK: Type = ty("TOD", 64, Kind::Clock);
pub(super) const DAY: Type = ty("DATE", 64, Kind::Day);

/// Those of which a program has some.
pub(super) const OTHERS: [Type; 18] = [
    ty("SINT", 8, Kind::Signed),
    ty("DINT", 32, Kind::Signed),
    ty("LINT", 64, Kind::Signed),
    ty("USINT", 8, Kind::Unsigned),
    ty("UINT", 16, Kind::Unsigned),
    ty("UDINT", 32, Kind::Unsigned),
    ty("ULINT", 64, Kind::Unsigned),
    ty("BYTE", 8, Kind::Bits),
    ty("WORD", 16, Kind::Bits),
    ty("DWORD", 32, Kind::Bits),
    ty("LWORD", 64, Kind::Bits),
    ty("REAL", 32, Kind::Real),
    LREAL,
    TIME,
    MOMENT,
    CLOCK,
    DAY,
    ty("STRING", 0, Kind::Text),
];

impl Type {
    pub(super) fn variable(self, number: usize) -> String {
        format!("{}{number}", self.name.to_ascii_lowercase())
    }

    pub(super) fn input(self) -> String {
        format!("in_{}", self.name.to_ascii_lowercase())
    }

    /// Its initial value: without one, a date is that of 1970, and the moments before are not the peer's.
    pub(super) fn start(self) -> &'static str {
        match self.kind {
            Kind::Moment => " := DT#2001-02-03-04:05:06",
            Kind::Day => " := DATE#2001-02-03",
            _ => "",
        }
    }

    pub(super) fn is_integer(self) -> bool {
        matches!(self.kind, Kind::Signed | Kind::Unsigned)
    }

    /// The result of an operation in the type's own width.
    pub(super) fn own_width(self, text: &str) -> String {
        let widens = self.bits < 32 || self.name == "REAL";
        if widens { format!("W_{}({text})", self.name) } else { format!("({text})") }
    }

    /// Reals that surely become one of this type.
    pub(super) fn room(self) -> i64 {
        match (self.kind, self.bits) {
            (Kind::Signed, 8) => 127,
            (_, 8) => 255,
            (_, 16) => 32_000,
            _ => 1_000_000_000,
        }
    }

    /// A value as it is written.
    pub(super) fn literal(self, dice: &mut Dice) -> String {
        match self.kind {
            Kind::Bool => dice.pick(&["TRUE", "FALSE"]).to_owned(),
            Kind::Signed => {
                let limit = (1_i64 << (self.bits - 2)) - 1 + (1_i64 << (self.bits - 2));
                let value = match dice.below(6) {
                    0 => limit,
                    1 => -limit,
                    2 => dice.bits() as i64 % limit,
                    _ => dice.between(-9, 12),
                };
                format!("{}#{value}", self.name)
            }
            Kind::Unsigned | Kind::Bits => {
                let limit = u64::MAX >> (64 - self.bits);
                let value = match dice.below(6) {
                    0 => limit,
                    1 => dice.bits() & limit,
                    _ => dice.below(12) as u64,
                };
                if self.kind == Kind::Bits {
                    format!("{}#16#{value:X}", self.name)
                } else {
                    format!("{}#{value}", self.name)
                }
            }
            Kind::Real if self.bits == 32 => format!("REAL#{:.3}", dice.between(-80, 80) as f64 / 8.0),
            Kind::Real => format!("LREAL#{:.3}", dice.between(-9_000, 9_000) as f64 / 1_000.0),
            Kind::Time => format!("T#{}ms", dice.pick(&[0, 3, 5, 7, 10, 25, 30, 52, 100, 150, 375, 500, 1250])),
            Kind::Moment => format!("DT#{}-{}", day(dice), clock(dice)),
            Kind::Clock => format!("TOD#{}", clock(dice)),
            Kind::Day => format!("DATE#{}", day(dice)),
            Kind::Text => {
                let length = dice.below(5);
                let letters: String = (0..length).map(|_| char::from(b'a' + dice.below(3) as u8)).collect();
                format!("'{letters}'")
            }
        }
    }
}

fn day(dice: &mut Dice) -> String {
    let leap = dice.once_in(6);
    if leap {
        "2024-02-29".to_owned()
    } else {
        format!("20{:02}-{:02}-{:02}", dice.below(31), 1 + dice.below(12), 1 + dice.below(28))
    }
}

fn clock(dice: &mut Dice) -> String {
    format!("{:02}:{:02}:{:02}", dice.below(24), dice.below(60), dice.below(60))
}
