//! What a PLC commands of a drive: two BOOLs, a velocity or a position.

use onescan_server::client::ClientFault;
use onescan_server::signal::{PortLayout, SignalName, Slot, SlotError};

use super::model::{Drive, NumberType};
use super::setpoint::{Bounds, Setpoint};

/// A REAL or an LREAL in a port.
#[derive(Clone, Copy)]
pub(super) enum NumberSlot {
    Real(Slot<f32>),
    Lreal(Slot<f64>),
}

impl NumberSlot {
    pub(super) fn find(layout: &PortLayout, name: &SignalName, number: NumberType) -> Result<Self, SlotError> {
        match number {
            NumberType::Real => layout.slot(name.as_str()).map(Self::Real),
            NumberType::Lreal => layout.slot(name.as_str()).map(Self::Lreal),
        }
    }

    pub(super) fn get(self, port: &[u8]) -> f64 {
        match self {
            Self::Real(slot) => f64::from(slot.get(port)),
            Self::Lreal(slot) => slot.get(port),
        }
    }

    pub(super) fn set(self, port: &mut [u8], value: f64) {
        match self {
            Self::Real(slot) => slot.set(port, value as f32),
            Self::Lreal(slot) => slot.set(port, value),
        }
    }

    /// The number, if it is one; `axis` is who asks, for the fault.
    fn finite(self, axis: &str, port: &[u8]) -> Result<f64, ClientFault> {
        let value = self.get(port);
        if value.is_finite() {
            return Ok(value);
        }
        Err(ClientFault::new(format!("axis `{axis}` is commanded {value}, which is not a finite number")))
    }
}

/// Where the command of an axis lies in the plant's inputs.
pub(super) enum Command {
    Bidirectional { forward: Slot<bool>, reverse: Slot<bool> },
    Velocity(NumberSlot),
    Position(NumberSlot),
}

impl Command {
    pub(super) fn find(reads: &PortLayout, drive: &Drive, number: NumberType) -> Result<Self, SlotError> {
        Ok(match drive {
            Drive::Bidirectional { forward, reverse } => {
                Self::Bidirectional { forward: reads.slot(forward.as_str())?, reverse: reads.slot(reverse.as_str())? }
            }
            Drive::Velocity { command } => Self::Velocity(NumberSlot::find(reads, command, number)?),
            Drive::Position { command } => Self::Position(NumberSlot::find(reads, command, number)?),
        })
    }

    /// Whether the drive is to stand, wherever it is.
    pub(super) fn stands(&self, inputs: &[u8]) -> bool {
        match self {
            Self::Bidirectional { forward, reverse } => forward.get(inputs) == reverse.get(inputs),
            Self::Velocity(slot) => slot.get(inputs) == 0.0,
            Self::Position(_) => false,
        }
    }

    /// The setpoint a period after `from`, as the command in `inputs` wants it.
    ///
    /// # Errors
    /// A commanded number that is not finite; `axis` names who was commanded.
    pub(super) fn advance(
        &self,
        axis: &str,
        from: Setpoint,
        bounds: &Bounds,
        dt_s: f64,
        inputs: &[u8],
    ) -> Result<Setpoint, ClientFault> {
        Ok(match self {
            Self::Bidirectional { forward, reverse } => {
                let wanted = match (forward.get(inputs), reverse.get(inputs)) {
                    (true, false) => bounds.speed,
                    (false, true) => -bounds.speed,
                    (true, true) | (false, false) => 0.0,
                };
                from.towards_velocity(wanted, bounds, dt_s)
            }
            Self::Velocity(slot) => from.towards_velocity(slot.finite(axis, inputs)?, bounds, dt_s),
            Self::Position(slot) => {
                let wanted = slot.finite(axis, inputs)?.clamp(bounds.lower, bounds.upper);
                from.towards_position(wanted, bounds, dt_s)
            }
        })
    }
}
