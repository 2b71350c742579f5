//! What is asked of a session from outside.

use onescan_base::did_you_mean;

use super::{Mode, Session};
use crate::client::OperationRefused;
use crate::operation::{Control, Operation, OperationError, SignalFault};
use crate::signal::{SignalId, SignalName};
use crate::signal_overlay::Onset;

impl Session {
    /// The signals that are forced.
    pub fn forced(&self) -> impl Iterator<Item = SignalId> + '_ {
        self.image.signal_overlay().forced()
    }

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

    /// Takes an operation on signals or on the session itself, at a step boundary. Values change with
    /// the commit that ends the next step.
    ///
    /// # Errors
    /// An unknown signal, a value that it cannot have, an operation for a client, which the session
    /// does not reach; nothing has changed then.
    pub fn operate(&mut self, operation: &Operation) -> Result<(), OperationError> {
        if let Some(control) = operation.control() {
            self.control(control);
            return Ok(());
        }
        match operation {
            Operation::Write { signal, value } => {
                let (id, bytes) = self.valued(signal, value)?;
                if self.image.signal_overlay().is_forced(id) {
                    return Err(OperationError::Forced(signal.clone()));
                }
                self.image.signal_overlay_mut().write(id, bytes);
            }
            Operation::Force { signal, value } => {
                let (id, bytes) = self.valued(signal, value)?;
                self.image.signal_overlay_mut().force(id, bytes);
            }
            Operation::Release { signal } => {
                let id = self.known(signal)?;
                if !self.image.signal_overlay_mut().release(id) {
                    return Err(OperationError::NotForced(signal.clone()));
                }
            }
            Operation::Disturb { signal, fault } => self.disturb(signal, fault)?,
            Operation::Mend { signal } => {
                let id = self.known(signal)?;
                if !self.image.signal_overlay_mut().clear(id) {
                    return Err(OperationError::NotDisturbed(signal.clone()));
                }
            }
            _ => {
                if let Some((client, _)) = operation.for_client() {
                    let refused =
                        OperationError::Client { client: client.clone(), source: OperationRefused::Unsupported };
                    return Err(refused);
                }
            }
        }
        Ok(())
    }

    fn disturb(&mut self, signal: &SignalName, fault: &SignalFault) -> Result<(), OperationError> {
        let id = self.known(signal)?;
        let (ty, step) = (self.layout.ty(id), self.plan.step());
        let committed = self.layout.bytes(id, self.image.committed()).to_vec();
        let onset = Onset { ty, committed: &committed, step, steps: self.cycle.steps() };
        if self.image.signal_overlay_mut().disturb(id, fault, &onset) {
            return Ok(());
        }
        Err(OperationError::FaultType { signal: signal.clone(), ty, fault: fault.clone() })
    }

    pub(super) fn known(&self, signal: &SignalName) -> Result<SignalId, OperationError> {
        self.signal_id(signal.as_str()).ok_or_else(|| {
            let names = self.plan.signals().iter().map(|known| known.name.as_str());
            OperationError::Unknown { signal: signal.clone(), nearest: did_you_mean(signal.as_str(), names) }
        })
    }

    /// A signal, and the bytes of a value.
    pub(crate) fn valued(&self, signal: &SignalName, value: &str) -> Result<(SignalId, Vec<u8>), OperationError> {
        let id = self.known(signal)?;
        let bytes = self.layout.ty(id).parse_text(value);
        let bytes = bytes.map_err(|source| OperationError::Value { signal: signal.clone(), source })?;
        debug_assert_eq!(bytes.len(), self.layout.ty(id).size(), "a value has the size of its signal");
        Ok((id, bytes))
    }
}
