//! The scene: what the plant is made of, read from one TOML file.
//!
//! A scene is read in two passes. The first gives the tables as they are written and stops at the
//! first fault of form, as TOML readers do. The second checks every value and finds every name; it
//! goes on after a fault, so that one run reports them all.
//!
//! | module | subject |
//! |---|---|
//! | `format` | the tables and keys of the file |
//! | `faults` | gathering faults, finding their lines |
//! | `number`, `names` | what a number and a name must be |
//! | `bodies`, `joints`, `axes`, `sensors`, `signals` | the second pass, one sort of table each |
//! | [`model`] | the checked scene |
//! | [`error`] | what can be wrong |

mod axes;
mod bodies;
pub mod error;
mod faults;
mod format;
mod joints;
pub mod model;
mod names;
mod number;
mod sensors;
mod signals;

use toml::Spanned;

pub use error::{SceneError, SceneFault, SceneFaultKind, Thing};
pub use model::Scene;

use faults::Faults;
use format::SceneFile;
use names::Names;
use number::{Allowed, Entry};
use signals::Signals;

/// The version of the scene format.
const VERSION: i64 = 1;
const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];
const EXTENT_M: f64 = 10_000.0;
/// Enough for a jointed machine to follow its drives; a chain of many joints may need more.
const SOLVER_ITERATIONS: u32 = 8;
const SUBSTEPS_MAX: u32 = 10_000;
const SOLVER_ITERATIONS_MAX: u32 = 1_000;

impl Scene {
    /// Reads a scene from the text of a file that is called `file` in faults.
    ///
    /// # Errors
    /// [`SceneError::Faulty`] with every fault that was found.
    pub fn parse(text: &str, file: &str) -> Result<Self, SceneError> {
        let mut faults = Faults::new(text, file);
        match toml::from_str::<SceneFile>(text) {
            Ok(written) => {
                let scene = check(&written, &mut faults);
                faults.into_result(scene)
            }
            Err(error) => Err(faults.into_form_error(&error)),
        }
    }
}

/// The checked scene; of no meaning where faults were found.
fn check(written: &SceneFile, faults: &mut Faults<'_>) -> Scene {
    let version = *written.version.get_ref();
    if version != VERSION {
        let hint = Some(format!("this program reads version {VERSION}"));
        faults.add_hinted(written.version.span(), SceneFaultKind::Version(version), hint);
    }
    let bodies = Names::gather(Thing::Body, written.body.iter().map(|body| &body.get_ref().name), faults);
    let joints = Names::gather(Thing::Joint, written.joint.iter().map(|joint| &joint.get_ref().name), faults);
    let mut signals = Signals::new();
    let extent = Entry::new("extent_m", written.extent_m.as_ref());
    let scene_bodies = bodies::check(&written.body, faults);
    let scene_joints = joints::check(&written.joint, &written.body, &bodies, faults);
    let axes = axes::check(&written.axis, &written.joint, &joints, &mut signals, faults);
    let sensors = sensors::check(written, &bodies, &joints, &mut signals, faults);
    let (reads, writes) = signals.into_ports(faults);
    Scene {
        gravity_m_s2: faults.triple("gravity_m_s2", written.gravity_m_s2.as_ref()).unwrap_or(GRAVITY_M_S2),
        extent_m: faults.number(extent, Allowed::Positive).unwrap_or(EXTENT_M),
        substeps: faults.count("substeps", written.substeps.as_ref(), SUBSTEPS_MAX).unwrap_or(1),
        solver_iterations: faults
            .count("solver_iterations", written.solver_iterations.as_ref(), SOLVER_ITERATIONS_MAX)
            .unwrap_or(SOLVER_ITERATIONS),
        bodies: scene_bodies,
        joints: scene_joints,
        axes,
        sensors,
        reads,
        writes,
    }
}

/// The text of a spanned name.
fn text(name: &Spanned<String>) -> &str {
    name.get_ref()
}
