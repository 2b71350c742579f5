//! Every conversion function of numbers, bit strings, durations and dates on random values: the compiled
//! code and a direct evaluation agree to the last bit. The evaluation here shares nothing with the compiler.

use std::cell::RefCell;
use std::fmt::Write;

use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::rig::Rig;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Bool,
    Signed,
    Unsigned,
    Bits,
    Real,
    Duration,
    Date,
    TimeOfDay,
    Moment,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Type {
    name: &'static str,
    bits: u32,
    kind: Kind,
    /// Nanoseconds of what it counts as a number.
    unit: i64,
}

const fn number(name: &'static str, bits: u32, kind: Kind) -> Type {
    Type { name, bits, kind, unit: 1 }
}

const fn count(name: &'static str, kind: Kind, unit: i64) -> Type {
    Type { name, bits: 64, kind, unit }
}

const TYPES: [Type; 23] = [
    number("BOOL", 8, Kind::Bool),
    number("SINT", 8, Kind::Signed),
    number("INT", 16, Kind::Signed),
    number("DINT", 32, Kind::Signed),
    number("LINT", 64, Kind::Signed),
    number("USINT", 8, Kind::Unsigned),
    number("UINT", 16, Kind::Unsigned),
    number("UDINT", 32, Kind::Unsigned),
    number("ULINT", 64, Kind::Unsigned),
    number("BYTE", 8, Kind::Bits),
    number("WORD", 16, Kind::Bits),
    number("DWORD", 32, Kind::Bits),
    number("LWORD", 64, Kind::Bits),
    number("REAL", 32, Kind::Real),
    number("LREAL", 64, Kind::Real),
    count("TIME", Kind::Duration, 1_000_000),
    count("LTIME", Kind::Duration, 1),
    count("DATE", Kind::Date, 1_000_000_000),
    count("LDATE", Kind::Date, 1),
    count("TOD", Kind::TimeOfDay, 1_000_000),
    count("LTOD", Kind::TimeOfDay, 1),
    count("DT", Kind::Moment, 1_000_000_000),
    count("LDT", Kind::Moment, 1),
];

const DAY: i64 = 86_400_000_000_000;

impl Type {
    fn counts(self) -> bool {
        matches!(self.kind, Kind::Duration | Kind::Date | Kind::TimeOfDay | Kind::Moment)
    }

    fn is_signed(self) -> bool {
        self.kind == Kind::Signed || self.counts()
    }

    /// The conversion functions that the tables have.
    fn converts_to(self, to: Self) -> bool {
        use Kind::{Bits, Bool, Date, Duration, Moment, Real, TimeOfDay};
        match (self.kind, to.kind) {
            _ if self == to => false,
            (Real, Bits) | (Bits, Real) => self.bits == to.bits,
            (Moment, Date | TimeOfDay | Moment)
            | (Date, Date | Moment)
            | (TimeOfDay, TimeOfDay | Duration)
            | (Duration, TimeOfDay | Duration) => true,
            (Date | TimeOfDay | Moment, _) => !to.counts() && to.kind != Bool,
            (_, Date | TimeOfDay | Moment) => !self.counts() && self.kind != Bool,
            _ => true,
        }
    }

    /// The integer cut to the type's width.
    fn wrap(self, value: i128) -> i128 {
        let low = value & ((1 << self.bits) - 1);
        if self.is_signed() && low >> (self.bits - 1) == 1 { low - (1 << self.bits) } else { low }
    }

    /// A whole real number, or the nearest limit.
    fn saturated(self, value: f64) -> i128 {
        let (low, high) = if self.is_signed() {
            (-(1_i128 << (self.bits - 1)), (1_i128 << (self.bits - 1)) - 1)
        } else {
            (0, (1_i128 << self.bits) - 1)
        };
        (value.round_ties_even() as i128).clamp(low, high)
    }

    /// A value of the type that has these bits, as nearly as there is one.
    fn sample(self, raw: u64) -> u64 {
        let ns = raw as i64;
        match self.kind {
            Kind::Bool => raw & 1,
            // The first midnight lies within the first day that there is.
            Kind::Date => (ns.max(i64::MIN + DAY) / DAY * DAY) as u64,
            Kind::TimeOfDay => ns.rem_euclid(DAY) as u64,
            _ => raw & (u64::MAX >> (64 - self.bits)),
        }
    }
}

#[derive(Debug, Clone, Copy)]
enum Value {
    Int(i128),
    Real(f64),
}

fn decoded(ty: Type, raw: u64) -> Value {
    match (ty.kind, ty.bits) {
        (Kind::Real, 32) => Value::Real(f64::from(f32::from_bits(raw as u32))),
        (Kind::Real, _) => Value::Real(f64::from_bits(raw)),
        _ => Value::Int(ty.wrap(i128::from(raw))),
    }
}

fn encoded(ty: Type, value: Value) -> u64 {
    match (value, ty.kind, ty.bits) {
        (Value::Int(value), Kind::Real, 32) => u64::from((value as f32).to_bits()),
        (Value::Int(value), Kind::Real, _) => (value as f64).to_bits(),
        (Value::Real(value), _, 32) => u64::from((value as f32).to_bits()),
        (Value::Real(value), ..) => value.to_bits(),
        (Value::Int(value), ..) => (value as u64) & (u64::MAX >> (64 - ty.bits)),
    }
}

fn converted(from: Type, to: Type, raw: u64) -> u64 {
    let whole = |ns: i64| match to.kind {
        Kind::Date => ns.wrapping_sub(ns.rem_euclid(DAY)),
        Kind::TimeOfDay => ns.rem_euclid(DAY),
        _ => ns,
    };
    let value = match (decoded(from, raw), from.kind, to.kind) {
        (_, Kind::Real, Kind::Bits) | (_, Kind::Bits, Kind::Real) => return raw,
        (Value::Int(value), Kind::Bits, Kind::Bool) => Value::Int(value & 1),
        (Value::Int(value), _, Kind::Bool) => Value::Int(i128::from(value != 0)),
        (Value::Real(value), _, Kind::Bool) => Value::Int(i128::from(value != 0.0)),
        (Value::Int(ns), ..) if from.counts() && to.counts() => Value::Int(whole(ns as i64).into()),
        (Value::Int(ns), _, Kind::Real) if from.counts() => Value::Real(ns as f64 / from.unit as f64),
        (Value::Int(ns), ..) if from.counts() => Value::Int(to.wrap(ns / i128::from(from.unit))),
        (Value::Real(value), ..) if to.counts() => {
            let ns = if value.is_nan() { 0 } else { to.saturated(value * to.unit as f64) };
            Value::Int(whole(ns as i64).into())
        }
        (Value::Int(value), ..) if to.counts() => Value::Int(whole((value as i64).wrapping_mul(to.unit)).into()),
        (value, _, Kind::Real) => value,
        (Value::Real(value), ..) => Value::Int(if value.is_nan() { 0 } else { to.saturated(value) }),
        (Value::Int(value), ..) => Value::Int(to.wrap(value)),
    };
    encoded(to, value)
}

fn is_nan(ty: Type, raw: u64) -> bool {
    matches!(decoded(ty, raw), Value::Real(value) if value.is_nan())
}

fn pairs() -> impl Iterator<Item = (Type, Type)> {
    let all = TYPES.into_iter().flat_map(|from| TYPES.into_iter().map(move |to| (from, to)));
    all.filter(|(from, to)| from.converts_to(*to))
}

/// One program with a variable of every type and the result of every conversion, typed and overloaded.
fn program() -> String {
    let mut text = "PROGRAM P VAR ".to_owned();
    for ty in TYPES {
        write!(text, "v_{0} : {0}; ", ty.name).expect("a string takes all");
    }
    for (from, to) in pairs() {
        let (from, to) = (from.name, to.name);
        write!(text, "{from}_{to}, o_{from}_{to} : {to}; ").expect("a string takes all");
    }
    text.push_str("END_VAR\n");
    for (from, to) in pairs() {
        let (from, to) = (from.name, to.name);
        writeln!(text, "{from}_{to} := {from}_TO_{to}(v_{from}); o_{from}_{to} := TO_{to}(v_{from});")
            .expect("a string takes all");
    }
    text + "END_PROGRAM"
}

/// Where the result of a conversion lies.
struct Result {
    from: Type,
    to: Type,
    offset: usize,
}

/// Of the typed and the overloaded function.
fn results(rig: &Rig, from: Type, to: Type) -> [Result; 2] {
    ["", "o_"].map(|form| {
        let offset = rig.variable(&format!("P.{form}{}_{}", from.name, to.name)).offset as usize;
        Result { from, to, offset }
    })
}

#[test]
fn every_pair_of_types() {
    assert_eq!(pairs().count(), 454);
    let rig = Rig::new(&program());
    let results: Vec<_> = pairs().flat_map(|(from, to)| results(&rig, from, to)).collect();
    let rig = RefCell::new(rig);
    let real = any::<f64>().prop_map(f64::to_bits);
    let near = (-70_000.0..70_000.0_f64).prop_map(|value| ((value * 2.0).round() / 2.0).to_bits());
    let single = (-70_000.0..70_000.0_f32).prop_map(|value| u64::from(((value * 2.0).round() / 2.0).to_bits()));
    let raw = prop_oneof![
        any::<u64>(),
        any::<u16>().prop_map(u64::from),
        (-300_i64..300).prop_map(|value| value as u64),
        real,
        near,
        single,
        Just(i64::MIN as u64),
        Just(i64::MAX as u64)
    ];
    let values = prop::collection::vec(raw, TYPES.len());
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) };
    let outcome = TestRunner::new(config).run(&values, |values| {
        let mut rig = rig.borrow_mut();
        let raws: Vec<u64> = TYPES.iter().zip(values).map(|(ty, raw)| ty.sample(raw)).collect();
        for (ty, raw) in TYPES.iter().zip(&raws) {
            rig.set(&format!("P.v_{}", ty.name), *raw as i64);
        }
        rig.scan().expect("no fault");
        for Result { from, to, offset } in &results {
            let raw = TYPES.iter().zip(&raws).find(|(ty, _)| *ty == from).map_or(0, |(_, raw)| *raw);
            let wanted = converted(*from, *to, raw);
            let mut found = [0; 8];
            let bytes = (to.bits / 8) as usize;
            found[..bytes].copy_from_slice(&rig.plc.memory()[*offset..*offset + bytes]);
            let found = u64::from_le_bytes(found);
            let same = found == wanted || is_nan(*to, found) && is_nan(*to, wanted);
            prop_assert!(same, "{} {raw:#x} to {} is {found:#x}, not {wanted:#x}", from.name, to.name);
        }
        Ok(())
    });
    outcome.unwrap_or_else(|failure| panic!("{failure}"));
}
