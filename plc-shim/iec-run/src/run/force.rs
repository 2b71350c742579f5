//! Forcing: a variable keeps a value whatever the program does.
//!
//! A forced value stands in memory when a scan begins, after what was written from outside; when a
//! program begins, after its inputs were copied from where they are connected; when it ends, before
//! its outputs are copied; and when the scan ends. Between those points the program sees what it
//! writes itself. Starts leave forces as they are; they are part of the saved state.

use super::SoftPlc;
use crate::application::{UnknownVariable, Variable, WriteError};

impl SoftPlc {
    /// Lets the variable at `path` keep a value, given as a literal, until [`SoftPlc::unforce`].
    ///
    /// # Errors
    /// There is no such variable, it is a constant or `READ_ONLY`, or the text is not a value of its
    /// type.
    pub fn force(&mut self, path: &str, value: &str) -> Result<(), WriteError> {
        let (variable, bytes) = self.parsed(path, value)?;
        self.forces.hold(variable, bytes);
        self.apply_forces();
        Ok(())
    }

    /// Gives the variable at `path` back to the program; false if it was not forced.
    ///
    /// # Errors
    /// There is no such variable.
    pub fn unforce(&mut self, path: &str) -> Result<bool, UnknownVariable> {
        let variable = self.variable(path)?;
        Ok(self.forces.release(&variable))
    }

    /// The forced variables, the oldest first.
    pub fn forced(&self) -> impl ExactSizeIterator<Item = &Variable> {
        self.forces.iter().map(|force| &force.variable)
    }

    /// The value at `path` as a literal; see [`Application::value_text`](crate::Application::value_text).
    ///
    /// # Errors
    /// There is no such variable.
    pub fn read(&self, path: &str) -> Result<String, UnknownVariable> {
        let variable = self.variable(path)?;
        Ok(self.application().value_text(&variable, self.memory()))
    }

    /// Writes a value once, given as a literal; see [`Application::value_bytes`](crate::Application::value_bytes). A forced variable
    /// keeps its forced value.
    ///
    /// # Errors
    /// There is no such variable, it is a constant or `READ_ONLY`, or the text is not a value of its
    /// type.
    pub fn write(&mut self, path: &str, value: &str) -> Result<(), WriteError> {
        let (variable, bytes) = self.parsed(path, value)?;
        variable.store(&bytes, self.memory_mut());
        self.apply_forces();
        Ok(())
    }

    /// Whether a value, given as a literal, could be written or forced there.
    ///
    /// # Errors
    /// As [`SoftPlc::write`].
    pub fn check_write(&self, path: &str, value: &str) -> Result<(), WriteError> {
        self.parsed(path, value).map(drop)
    }

    fn parsed(&self, path: &str, value: &str) -> Result<(Variable, Vec<u8>), WriteError> {
        let variable = self.variable(path)?;
        variable.writable()?;
        let bytes = self.application().value_bytes(&variable, value)?;
        Ok((variable, bytes))
    }
}
