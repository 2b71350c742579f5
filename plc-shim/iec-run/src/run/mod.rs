//! The soft PLC: tasks, scans, faults, saved states.
//!
//! | module | subject |
//! |---|---|
//! | `configured` | the tasks of the application's own configuration |
//! | `plan` | tasks with interval and priority, validated |
//! | `scheduler` | which task is due when |
//! | `machine` | the compiled module with its memory |
//! | `row` | the programs of a task as one call |
//! | `frames` | the functions that were active when something happened |
//! | `fault` | a trap as an error in the source |
//! | `task_info` | what programs read about their task |
//! | `soft_plc` | the PLC itself |
//! | `late` | tasks that are late, once or for good |
//! | `force`, `forces` | variables that keep a value, reading and writing by path |
//! | `asserts` | what the asserts of a test program have found |
//! | `host_state` | what functions of the host work on |
//! | `text` | functions on character strings |
//! | `state` | its state as bytes |
//! | `tried` | statements that a fault ends |
//! | `trace`, `trace_link`, `way` | which statement wrote a byte; which ways decisions went |
//! | `journal` | all that a scan did |

mod asserts;
mod configured;
mod fault;
mod force;
mod forces;
mod frames;
mod host_state;
mod journal;
mod late;
mod machine;
mod plan;
mod row;
mod scheduler;
mod soft_plc;
mod state;
mod task_info;
pub(crate) mod text;
mod trace;
mod trace_link;
mod tried;
mod way;

pub use asserts::{Asserts, FailedAssert};
pub use fault::{FaultSite, PlcFault, WriteSite};
pub use journal::{ACTS_MAX, Act, Statement, StatementId, Wrote};
pub use late::LateError;
pub use plan::RunError;
pub use soft_plc::SoftPlc;
pub use state::{CodePolicy, PlanDifference, RestoreError};
pub use way::{Way, WayId};
