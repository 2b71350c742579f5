//! Units of measurement, and numbers carried from one to another.

use onescan_server::signal::did_you_mean;

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Time,
    Length,
    Speed,
    Acceleration,
    Angle,
    AngularSpeed,
    Mass,
    Force,
    Torque,
    Pressure,
    Volume,
    Flow,
    Power,
    Energy,
    Voltage,
    Current,
    Frequency,
    Kelvin,
    Celsius,
    Ratio,
}

/// A unit: so many of its quantity's first unit, as a fraction of exact numbers where there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    pub(super) name: &'static str,
    quantity: Quantity,
    numerator: f64,
    denominator: f64,
}

const fn unit(name: &'static str, quantity: Quantity, numerator: f64, denominator: f64) -> Unit {
    Unit { name, quantity, numerator, denominator }
}

const UNITS: [Unit; 58] = [
    unit("s", Quantity::Time, 1.0, 1.0),
    unit("ms", Quantity::Time, 1.0, 1e3),
    unit("us", Quantity::Time, 1.0, 1e6),
    unit("µs", Quantity::Time, 1.0, 1e6),
    unit("ns", Quantity::Time, 1.0, 1e9),
    unit("min", Quantity::Time, 60.0, 1.0),
    unit("h", Quantity::Time, 3600.0, 1.0),
    unit("m", Quantity::Length, 1.0, 1.0),
    unit("cm", Quantity::Length, 1.0, 1e2),
    unit("mm", Quantity::Length, 1.0, 1e3),
    unit("um", Quantity::Length, 1.0, 1e6),
    unit("µm", Quantity::Length, 1.0, 1e6),
    unit("m/s", Quantity::Speed, 1.0, 1.0),
    unit("mm/s", Quantity::Speed, 1.0, 1e3),
    unit("m/min", Quantity::Speed, 1.0, 60.0),
    unit("m/s2", Quantity::Acceleration, 1.0, 1.0),
    unit("mm/s2", Quantity::Acceleration, 1.0, 1e3),
    unit("rad", Quantity::Angle, 1.0, 1.0),
    unit("mrad", Quantity::Angle, 1.0, 1e3),
    unit("deg", Quantity::Angle, std::f64::consts::PI, 180.0),
    unit("°", Quantity::Angle, std::f64::consts::PI, 180.0),
    unit("rad/s", Quantity::AngularSpeed, 1.0, 1.0),
    unit("deg/s", Quantity::AngularSpeed, std::f64::consts::PI, 180.0),
    unit("rpm", Quantity::AngularSpeed, std::f64::consts::PI, 30.0),
    unit("kg", Quantity::Mass, 1.0, 1.0),
    unit("g", Quantity::Mass, 1.0, 1e3),
    unit("t", Quantity::Mass, 1e3, 1.0),
    unit("N", Quantity::Force, 1.0, 1.0),
    unit("kN", Quantity::Force, 1e3, 1.0),
    unit("Nm", Quantity::Torque, 1.0, 1.0),
    unit("kNm", Quantity::Torque, 1e3, 1.0),
    unit("Pa", Quantity::Pressure, 1.0, 1.0),
    unit("hPa", Quantity::Pressure, 1e2, 1.0),
    unit("kPa", Quantity::Pressure, 1e3, 1.0),
    unit("MPa", Quantity::Pressure, 1e6, 1.0),
    unit("bar", Quantity::Pressure, 1e5, 1.0),
    unit("mbar", Quantity::Pressure, 1e2, 1.0),
    unit("m3", Quantity::Volume, 1.0, 1.0),
    unit("l", Quantity::Volume, 1.0, 1e3),
    unit("ml", Quantity::Volume, 1.0, 1e6),
    unit("m3/s", Quantity::Flow, 1.0, 1.0),
    unit("m3/h", Quantity::Flow, 1.0, 3600.0),
    unit("l/s", Quantity::Flow, 1.0, 1e3),
    unit("l/min", Quantity::Flow, 1.0, 6e4),
    unit("W", Quantity::Power, 1.0, 1.0),
    unit("kW", Quantity::Power, 1e3, 1.0),
    unit("J", Quantity::Energy, 1.0, 1.0),
    unit("kJ", Quantity::Energy, 1e3, 1.0),
    unit("V", Quantity::Voltage, 1.0, 1.0),
    unit("mV", Quantity::Voltage, 1.0, 1e3),
    unit("A", Quantity::Current, 1.0, 1.0),
    unit("mA", Quantity::Current, 1.0, 1e3),
    unit("Hz", Quantity::Frequency, 1.0, 1.0),
    unit("kHz", Quantity::Frequency, 1e3, 1.0),
    // Not carried into each other: a difference and a temperature would need different sums.
    unit("K", Quantity::Kelvin, 1.0, 1.0),
    unit("degC", Quantity::Celsius, 1.0, 1.0),
    unit("°C", Quantity::Celsius, 1.0, 1.0),
    unit("%", Quantity::Ratio, 1.0, 1.0),
];

impl Unit {
    /// The unit that is written so; case matters, as between mm and Mm.
    pub(super) fn find(name: &str) -> Option<Self> {
        UNITS.iter().copied().find(|unit| unit.name == name)
    }

    pub(super) fn names<'n>() -> impl Iterator<Item = &'n str> {
        UNITS.iter().map(|unit| unit.name)
    }

    /// What a value in this unit is times and by in another; nothing between different quantities.
    pub(super) fn factor_to(self, other: Self) -> Option<(f64, f64)> {
        (self.quantity == other.quantity)
            .then_some((self.numerator * other.denominator, self.denominator * other.numerator))
    }
}

/// How values are carried from one unit to another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Carrying {
    /// Times the first, by the second.
    By((f64, f64)),
    /// They measure different quantities, or one of them is known to its signal only.
    Never,
    /// The unit to carry to is not known; one that is written much alike.
    Unknown(Option<String>),
}

impl Carrying {
    /// From the unit of a signal to the one that is wanted. A unit that only its signal knows is carried to itself.
    pub(crate) fn between(own: &str, wanted: &str) -> Self {
        match (Unit::find(own), Unit::find(wanted)) {
            _ if own == wanted => Self::By((1.0, 1.0)),
            (_, None) => Self::Unknown(did_you_mean(wanted, Unit::names())),
            (Some(own), Some(wanted)) => own.factor_to(wanted).map_or(Self::Never, Self::By),
            (None, Some(_)) => Self::Never,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_carried_exactly_where_both_units_are_decimal() {
        let carry = |value: f64, from: &str, to: &str| {
            let (times, by) = Unit::find(from).unwrap().factor_to(Unit::find(to).unwrap()).unwrap();
            value * times / by
        };
        assert_eq!(carry(200.0, "mm", "m"), 0.2);
        assert_eq!(carry(0.3, "MPa", "bar"), 3.0);
        assert_eq!(carry(200.0, "ms", "s"), 0.2);
        assert_eq!(carry(90.0, "l/min", "m3/h"), 5.4);
        assert_eq!(carry(180.0, "deg", "rad"), std::f64::consts::PI);
    }

    #[test]
    fn quantities_do_not_mix() {
        assert_eq!(Unit::find("bar").unwrap().factor_to(Unit::find("mm").unwrap()), None);
        assert_eq!(Unit::find("K").unwrap().factor_to(Unit::find("degC").unwrap()), None);
    }

    #[test]
    fn a_unit_is_carried_to_itself_and_to_those_of_its_quantity() {
        assert_eq!(Carrying::between("mm", "m"), Carrying::By((1.0, 1e3)));
        assert_eq!(Carrying::between("pieces", "pieces"), Carrying::By((1.0, 1.0)));
        assert_eq!(
            [Carrying::between("K", "°C"), Carrying::between("pieces", "m")],
            [Carrying::Never, Carrying::Never]
        );
        assert!(matches!(Carrying::between("bar", "mbarr"), Carrying::Unknown(Some(help)) if help.contains("mbar")));
    }

    #[test]
    fn a_name_is_one_unit() {
        let mut names: Vec<_> = Unit::names().collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), UNITS.len());
    }
}
