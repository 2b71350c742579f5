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
    /// The same, the plant held to the PLC's cycle by a timer (`[SDSP]` sec. III-B).
    Halt,
    /// The same, the plant following the PLC's clock (`[Vergnano]` Fig. 5).
    Follow,
}

impl Mode {
    const ALL: [Self; 4] = [Self::Lockstep, Self::Freewheel, Self::Halt, Self::Follow];

    /// The mode that is written so.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == name)
    }

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
