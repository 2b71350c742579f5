//! For whom a project is instrumented, and a file of the shim's own.

/// For whom the shim's sources are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Target {
    /// Program text of the standard, in one file.
    #[default]
    Iec,
    /// TwinCAT 3: one object per file.
    TwinCat,
    /// CODESYS: a project in PLCopen XML.
    Codesys,
    /// Siemens' TIA Portal: SCL as external source, in one file.
    Scl,
    /// OpenPLC v3: one file for MatIEC, with addresses that its Modbus server serves.
    OpenPlc,
    Beremiz,
}

impl Target {
    /// True for a PLC that has PLCopen's motion control of its own, which moves its axes while not simulated.
    pub(super) fn has_motion(self) -> bool {
        !matches!(self, Self::Scl | Self::OpenPlc | Self::Beremiz)
    }

    /// True for text of the standard.
    pub(super) fn is_text(self) -> bool {
        matches!(self, Self::Iec | Self::OpenPlc | Self::Beremiz)
    }
}

/// A file of the shim's own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) name: String,
    pub(super) text: String,
}
