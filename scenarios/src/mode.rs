//! In lockstep or not.

/// How plant and PLC come together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// One scan, one step.
    #[default]
    Lockstep,
    /// Each on its own clock.
    Freewheel,
    /// The same, the plant held to the PLC's cycle by a timer (seed 004 sec. III-B).
    Halt,
    /// The same, the plant following the PLC's clock (seed 002 Fig. 5).
    Follow,
}

impl Mode {
    /// As it is written on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lockstep => "lockstep",
            Self::Freewheel => "freewheel",
            Self::Halt => "halt",
            Self::Follow => "follow",
        }
    }
}
