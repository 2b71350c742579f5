//! What an application is compiled from, and for what.

use super::{Application, Purpose};
use onescan_iec::diagnostic::Diagnostics;
use onescan_iec::front::{ConstantError, Front, with_room};
use onescan_iec::input::Input;
use onescan_iec::ir::MemoryLimit;
use onescan_iec::task_plan::TaskPlan;

/// Collects what an application is compiled from; made by [`Application::builder`].
///
/// ```
/// use onescan_iec::Input;
/// use onescan_iec::input::kind::SourceKind;
/// use onescan_iec_run::Application;
///
/// let text = "PROGRAM Main VAR CONSTANT limit : TIME := T#1s; END_VAR VAR t : TON; END_VAR
///     t(IN := TRUE, PT := limit); END_PROGRAM";
/// let main = Input::from_text("main.st", SourceKind::Text, text);
/// let application = Application::builder().input(main).constant("Main.limit", "T#20ms").build();
/// assert!(application.is_ok());
/// ```
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Builder {
    pub(super) inputs: Vec<Input>,
    pub(super) constants: Vec<(String, String)>,
    pub(super) purpose: Purpose,
    pub(super) memory_limit: MemoryLimit,
    pub(super) inspection: Inspection,
}

/// Whether what is legal and seldom meant is looked for.
#[derive(Debug, Clone, Default)]
pub(super) enum Inspection {
    #[default]
    None,
    /// With the tasks, if they are known.
    Of(Option<TaskPlan>),
}

/// Why there is no application.
#[derive(Debug, Clone, thiserror::Error)]
pub enum BuildError {
    /// A constant cannot be set.
    #[error(transparent)]
    Constant(#[from] ConstantError),
    /// The sources do not compile, as they are or with the constants' values: the errors, and the warnings too.
    #[error(transparent)]
    Sources(#[from] Diagnostics),
}

impl Builder {
    /// Adds a file.
    pub fn input(mut self, input: Input) -> Self {
        self.inputs.push(input);
        self
    }

    /// Adds files.
    pub fn inputs(mut self, inputs: impl IntoIterator<Item = Input>) -> Self {
        self.inputs.extend(inputs);
        self
    }

    /// Gives a constant another initial value, written as in a program. The path is that of the declaration, as
    /// in `Main.limit`, `Axis.Home.speed`, `Limits.highest` or `highest`, without regard to case. Whatever is
    /// computed from the constant, such as the bounds of an array, follows.
    pub fn constant(mut self, path: impl Into<String>, literal: impl Into<String>) -> Self {
        self.constants.push((path.into(), literal.into()));
        self
    }

    /// True if [`Self::constant`] finds the path in the files, so that it is not a variable, which
    /// [`SoftPlc::write`](crate::SoftPlc::write) sets. Reads the files each time.
    pub fn has_constant(&self, path: &str) -> bool {
        with_room(|| Front::has_constant(self.inputs.iter().cloned(), path))
    }

    /// Compiles for [`SoftPlc::coverage`](crate::SoftPlc::coverage). What the program computes stays the same.
    pub fn covered(mut self) -> Self {
        self.purpose = Purpose::Coverage;
        self
    }

    /// Compiles for [`SoftPlc::watch`](crate::SoftPlc::watch). What the program computes stays the same; it runs
    /// slowly.
    pub fn traced(mut self) -> Self {
        self.purpose = Purpose::Trace;
        self
    }

    /// Sets how much memory all variables may take together, 64 MiB if nobody says otherwise.
    pub fn memory_limit(mut self, limit: MemoryLimit) -> Self {
        self.memory_limit = limit;
        self
    }

    /// Looks for what is legal and seldom meant as well, which [`Application::warnings`] then has; `plan` says which
    /// programs run in which task.
    pub fn inspected(mut self, plan: Option<TaskPlan>) -> Self {
        self.inspection = Inspection::Of(plan);
        self
    }

    /// Compiles the files, together with the standard function blocks.
    ///
    /// # Errors
    /// A constant that cannot be set; all that is wrong with the files.
    pub fn build(self) -> Result<Application, BuildError> {
        Application::built(self)
    }
}
