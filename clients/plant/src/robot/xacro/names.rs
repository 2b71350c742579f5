//! What an expression asks its surroundings for.

use super::expression::Expression;
use super::value::Value;

/// What an expression is worth, or why it has no value.
pub(super) type Evaluated = Result<Value, String>;
/// What evaluates the expressions within another one.
pub(super) type Evaluate = fn(&Expression, &mut dyn Names) -> Evaluated;

/// What an expression asks for outside of itself.
pub(super) trait Names {
    /// The value of a property.
    ///
    /// # Errors
    /// A property whose own expression is at fault.
    fn value(&mut self, name: &str) -> Result<Option<Value>, String>;
    /// The contents of a YAML file.
    ///
    /// # Errors
    /// A file that cannot be read.
    fn yaml(&mut self, file: &str) -> Result<Value, String>;
    /// An argument of the robot.
    ///
    /// # Errors
    /// An argument that is not given.
    fn argument(&mut self, name: &str) -> Result<Value, String>;
    /// Takes a part of what lists may have in all.
    ///
    /// # Errors
    /// The lists would have more than they may.
    fn spend(&mut self, size: usize) -> Result<(), String>;
}
