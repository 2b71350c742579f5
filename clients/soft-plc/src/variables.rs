//! Variables of the PLC written and forced by path, between two steps of the session.
//!
//! What is written or forced is there from the PLC's next scan on. Forces are part of the saved state; a reset
//! of the session ends them.

use onescan_iec_run::{UnknownVariable, WriteError};
use onescan_server::signal::SignalName;
use thiserror::Error;

use super::SoftPlcClient;

/// Why a variable was not written or forced.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum VariableError {
    /// There is no such variable, it must not be written, or the text is not a value of its type.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A signal overwrites it before every scan.
    #[error("`{path}` takes the value of signal `{signal}` before each scan: force it, or write the signal")]
    Input { path: String, signal: SignalName },
}

impl SoftPlcClient {
    /// Writes the variable at `path` once, given as a literal such as `T#20ms`. A forced variable keeps its forced
    /// value.
    ///
    /// # Errors
    /// There is no such variable, it must not be written, a signal gives its value, or the text is not a value of
    /// its type. Nothing has changed then.
    pub fn set_variable(&mut self, path: &str, literal: &str) -> Result<(), VariableError> {
        let variable = self.plc().variable(path).map_err(WriteError::from)?;
        let start = variable.offset as usize;
        if let Some(signal) = self.input_at(start..start + variable.size as usize, variable.bit) {
            return Err(VariableError::Input { path: variable.path, signal });
        }
        Ok(self.plc_mut().write(path, literal)?)
    }

    /// Lets the variable at `path` keep a value until it is released, whatever the program and signals write; an
    /// earlier force of it ends.
    ///
    /// # Errors
    /// There is no such variable, it must not be written, or the text is not a value of its type. Nothing has
    /// changed then.
    pub fn force_variable(&mut self, path: &str, literal: &str) -> Result<(), VariableError> {
        Ok(self.plc_mut().force(path, literal)?)
    }

    /// Gives the variable at `path` back to the program, which finds the forced value in it; false if it was not
    /// forced.
    ///
    /// # Errors
    /// There is no such variable.
    pub fn release_variable(&mut self, path: &str) -> Result<bool, UnknownVariable> {
        self.plc_mut().unforce(path)
    }
}
