//! The variables that a gateway writes and reads: what the shim has to know of the plant's side.

use onescan_base::SignalType;

/// Which way a value goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// The gateway writes it.
    ToPlc,
    /// The gateway reads it.
    FromPlc,
}

/// A variable that the gateway writes or reads. A signal that several variables read has one of these for each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exchanged {
    pub signal: String,
    /// The variable's path in the project, as in `Shear.Sensor_1`, or a global variable's name.
    pub variable: String,
    /// The type of both.
    pub ty: SignalType,
    /// Which way it goes.
    pub way: Way,
    /// Where the variable is to lie in the PLC, as in `%QX0.0`, if the scenario says so.
    pub address: Option<String>,
}
