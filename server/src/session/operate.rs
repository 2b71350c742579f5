//! What operators ask of a session.

use onescan_base::did_you_mean;

use super::{Control, Mode, Session};
use crate::operation::{Operation, OperationError};
use crate::signal::{SignalId, SignalName};

impl Session {
    /// Asks for a stop, pause, single step or reset at the next step boundary.
    pub fn control(&mut self, control: Control) {
        match control {
            Control::Stop => self.stop = true,
            Control::Pause => self.mode = Mode::Held,
            Control::Resume => self.mode = Mode::Running,
            Control::Step => self.mode = Mode::OneStep,
            Control::Reset => self.reset = true,
        }
    }

    /// Does what an operator asks for, at a step boundary.
    ///
    /// # Errors
    /// A signal that there is not, a value that it cannot have; nothing has changed then.
    pub fn operate(&mut self, operation: &Operation) -> Result<(), OperationError> {
        match operation {
            Operation::Write { signal, value } => {
                let (offset, bytes) = self.valued(signal, value)?;
                self.image.write(offset, &bytes);
            }
            Operation::Force { signal, value } => {
                let (offset, bytes) = self.valued(signal, value)?;
                self.image.force(offset, bytes);
            }
            Operation::Release { signal } => {
                if !self.image.release(self.layout.offset(self.known(signal)?)) {
                    return Err(OperationError::NotForced(signal.clone()));
                }
            }
            Operation::Stop | Operation::Pause | Operation::Resume | Operation::Step | Operation::Reset => {
                if let Some(control) = operation.control() {
                    self.control(control);
                }
            }
        }
        Ok(())
    }

    fn known(&self, signal: &SignalName) -> Result<SignalId, OperationError> {
        self.signal_id(signal.as_str()).ok_or_else(|| {
            let names = self.plan.signals().iter().map(|known| known.name.as_str());
            OperationError::Unknown { signal: signal.clone(), nearest: did_you_mean(signal.as_str(), names) }
        })
    }

    /// Where a signal lies, and the bytes of a value.
    fn valued(&self, signal: &SignalName, value: &str) -> Result<(usize, Vec<u8>), OperationError> {
        let id = self.known(signal)?;
        let bytes = self.layout.ty(id).parse_text(value);
        let bytes = bytes.map_err(|source| OperationError::Value { signal: signal.clone(), source })?;
        Ok((self.layout.offset(id), bytes))
    }
}
