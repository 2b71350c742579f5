//! The scene: what the plant is made of, read from one TOML file.
//!
//! # The file
//! SI units, z up. Points and directions are in world coordinates, in the pose that the scene itself
//! gives its bodies. The order of tables is the order in which everything is built and evaluated.
//!
//! | at the top | meaning |
//! |---|---|
//! | `version` | 1 |
//! | `gravity_m_s2` | `[0, 0, -9.81]` if absent |
//! | `extent_m` | a body farther from the origin than this is a fault; 10 km if absent |
//! | `substeps` | world steps in a turn, 1 if absent |
//! | `solver_iterations` | in a world step, 8 if absent |
//! | `friction_rule` | of bodies that have none of their own, `mean` if absent |
//! | `sleeping` | whether bodies that rest on a floor or a belt sleep, `false` if absent |
//! | `libraries` | folders with kinds of component of the user's own, beside the file of the scene |
//!
//! | `[[body]]` | meaning |
//! |---|---|
//! | `name`, `kind` | `fixed`, `dynamic` or `kinematic` |
//! | `shape` | `box` (`size_m`, whole edges), `sphere` (`radius_m`), `cylinder` or `capsule` (`radius_m`, `length_m`, along z; a capsule's caps come on top), `mesh` (`mesh`, a file `.stl` or `.obj` beside the scene; `unit_m`, what 1 means in it, 1 if absent; `hull = false` for its very surface in place of its convex hull, where no force moves the body); only a dynamic body must have one |
//! | `position_m`, `rpy_deg` | origin; roll about x, then pitch about y, then yaw about z |
//! | `velocity_m_s` | at the start for a dynamic body, always for a kinematic one |
//! | `mass_kg` or `density_kg_m3` | of a dynamic body |
//! | `centre_m`, `inertia_kg_m2` | centre of mass and `[ixx, iyy, izz, ixy, ixz, iyz]` about it along the world's axes, with `mass_kg`, in place of those of the shape |
//! | `friction`, `restitution` | 0.5 and 0 if absent |
//! | `friction_rule` | how the friction of two bodies becomes one: `mean`, `least`, `product`, `greatest`; of two rules the later of these |
//! | `collides`, `group` | `collides = false` for a body that only sensors see; bodies of one group do not collide with each other |
//!
//! | `[[shape]]` | meaning: one more shape of a body |
//! |---|---|
//! | `name`, `body` | |
//! | `shape`, its measures, `position_m`, `rpy_deg`, `friction`, `restitution`, `collides` | as of a body |
//! | `mass_kg` or `density_kg_m3` | what it adds to a dynamic body, nothing if absent |
//!
//! | `[[urdf]]` | meaning: a robot from a file: URDF, xacro, MJCF |
//! |---|---|
//! | `name`, `file` | a link `upper` of robot `arm` is body `arm.upper`, a joint `elbow` is joint `arm.elbow` |
//! | `position_m`, `rpy_deg` | of its root link |
//! | `fixed` | whether the root stays in place, true if absent |
//! | `collides`, `friction` | of all of its shapes; links of one robot do not collide with each other |
//! | `density_kg_m3` | of each link that moves and has no mass |
//! | `initial_rad`, `initial_m` | coordinates of its joints in the scene's pose, by name |
//! | `packages`, `arguments` | folders of packages and arguments of a xacro, by name |
//!
//! | `[[joint]]` | meaning |
//! |---|---|
//! | `name`, `kind` | `prismatic`, `revolute`, `fixed`, `ball`, or `slot`: a pin of the child in a slot of the parent |
//! | `parent`, `child` | bodies; `ground` is the world as a parent |
//! | `anchor_m` | the child's origin if absent |
//! | `axis` | of translation for a prismatic joint, of rotation for a revolute one and for a slot |
//! | `slide` | of translation for a slot, across its `axis` |
//! | `initial_m` or `initial_rad` | coordinate in the scene's pose, 0 if absent |
//! | `lower_m`, `upper_m` or `lower_rad`, `upper_rad` | limits of the coordinate |
//! | `contacts` | whether the two bodies collide, false if absent |
//!
//! | `[[fitting]]` | meaning: what is fitted to a prismatic or revolute joint beside its drive |
//! |---|---|
//! | `name`, `joint` | also a joint of a robot |
//! | `friction_n`, `stiction_n`, `stribeck_m_s` (or `_nm`, `_rad_s`) | dry friction while it moves; at rest, as much if absent; the velocity over which it falls, 0.01 if absent |
//! | `damping_n_s_m` or `damping_nm_s_rad` | viscous friction |
//! | `spring_n_m`, `rest_m` or `spring_nm_rad`, `rest_rad` | a spring, and the coordinate at which it is at rest, 0 if absent |
//! | `balance_n` or `balance_nm` | a constant force up the coordinate: a counterweight |
//! | `brake_n` or `brake_nm`, `release_signal` | a brake that a spring applies, and the BOOL that releases it |
//!
//! | `[[coupling]]` | meaning: a prismatic or revolute joint that one or two others lead, and that leads them back |
//! |---|---|
//! | `name` | |
//! | `joint`, `of` | the joint, and a list of those that lead it |
//! | `ratio` | for each of them, how far the joint goes when it goes by 1: of a gear, a belt, a rack (1/radius or radius), a screw (lead/2π), a differential (two) |
//! | `cam` | in its place, points `[leading, led]` of a curve |
//! | `backlash_m` or `backlash_rad` | play of the joint, none if absent |
//! | `slip_n` or `slip_nm` | a belt or a clutch: it slips beyond this force on the joint, never if absent |
//!
//! | `[[axis]]` | meaning |
//! |---|---|
//! | `name` | |
//! | `joint` | the prismatic or revolute joint that it drives, or |
//! | `belt`, `direction` | the kinematic body whose surface it drives; the body itself stays in place |
//! | `drive` | `bidirectional` (`forward_signal`, `reverse_signal`: BOOL; both or none is stop and hold), `velocity` or `position` (`command_signal`) |
//! | `speed_m_s` or `speed_rad_s` | greatest speed, the only one of a bidirectional drive |
//! | `acceleration_m_s2` or `acceleration_rad_s2` | of every ramp |
//! | `force_max_n` or `torque_max_nm` | of a joint's drive, as much as it takes if absent |
//! | `position_signal`, `velocity_signal` | coordinate of the joint or travel of the belt, and its velocity over the last period |
//! | `force_signal` or `torque_signal`, `limit_signal` | of a joint's drive: the mean force over the last period; a BOOL: it is at its greatest |
//! | `signal_type` | `LREAL` or `REAL`, of all number signals of the axis; `LREAL` if absent |
//!
//! | `[[sensor]]` | meaning |
//! |---|---|
//! | `name`, `kind`, `signal` | `end_position` or `proximity`; a BOOL signal |
//! | `joint` | of an end position: prismatic, revolute or slot |
//! | `from_m`, `to_m`, `hysteresis_m` (or `_rad`) | true from here to there; false again farther outside than the hysteresis |
//! | `body`, `point_m`, `direction`, `range_m` | of a proximity sensor: a ray that the body carries, the ground if absent |
//! | `targets` | bodies that the ray detects, all but the carrier if absent |
//!
//! | `[[component]]` | meaning |
//! |---|---|
//! | `name`, `kind` | a kind of the library, see [`crate::component`] |
//! | its parameters | by their keys, each with a preset |
//! | `joint`, `belt`, `body`, … | what it is bound to, as its kind has it |
//! | `INPUT_signal`, `OUTPUT_signal` | the session's signal for an input or an output of its kind |
//! | `command_signals`, `feedback_signals` | a structure of signals whose members are the inputs or outputs of a kind that takes frames |
//! | `INPUT_from` | `"component.output"`: another component's output for an input |
//! | `INPUT` | a constant for an input, its preset if nothing is written |
//! | `signal_type` | `LREAL` or `REAL`, of all its number signals; `LREAL` if absent |
//! | `shown_at_m` | where pictures show it, if nothing that it is bound to says so |
//!
//! | `[[failure]]` | meaning |
//! |---|---|
//! | `component`, `mode` | what fails, and how |
//! | `signal` | a BOOL that switches it, or |
//! | `from_s`, `until_s` | virtual time; from the start and for ever if absent |
//!
//! | `[[signal]]` | meaning: what happens to a signal between plant and PLC, in this order |
//! |---|---|
//! | `name` | a signal of the plant |
//! | `sample_s` | looked at only so often |
//! | `noise_mean`, `noise_sigma` | N(µ, σ) is added, in the signal's unit |
//! | `quantum` | rounded to a multiple of this |
//! | `lost_rate` | a change is lost with this probability |
//! | `delay_s`, `jitter_s`, `delay_sigma_s` | arrives so much later, up to the jitter later than that, and by N(0, σ), in order |
//! | `flip_rate` | in a turn, a bit arrives inverted with this probability |
//! | `range`, `raw`, `type` | the range in the signal's unit, as it is in the PLC's type: scaled and limited |
//!
//! # Arrays
//! A table whose name has a range, as in `name = "arm[0..9]"`, is there once for each index, and
//! `[i]` in its other texts is the index: `hold_signal = "LW_ARM[i].OUT_HOLD_CONTAINER"`. In a list, as
//! `targets`, a range stands for all of its names. Bodies and shapes are put in a row by `step_m`, from
//! one to the next, or evenly around the vertical through `turn_about_m`.
//!
//! # Reading
//! A scene is read in two passes. The first gives the tables as they are written and stops at the
//! first fault of form, as TOML readers do. The second checks every value and finds every name; it
//! goes on after a fault, so that one run reports them all.
//!
//! | module | subject |
//! |---|---|
//! | `format` | the tables and keys of the file |
//! | `faults` | gathering faults, finding their lines |
//! | [`overrides`] | values in the place of the file's own |
//! | `placed` | a value with its place in the file |
//! | `number`, `names` | what a number and a name must be |
//! | `arrays` | one table for many things |
//! | `robots`, `robot_tables` | robots' files, and the tables that one stands for |
//! | [`own`] | kinds of component of the user's own |
//! | `bodies`, `shapes`, `meshes`, `joints`, `fittings`, `couplings`, `axes`, `sensors`, `signals` | the second pass, one sort of table each |
//! | `parameters` | which of them may change while a plant runs |
//! | `components`, `bindings`, `failures`, `conditions` | the same, for components and what surrounds them |
//! | [`model`] | the checked scene |
//! | [`error`] | what can be wrong |
//! | [`schema`] | the format as a JSON schema |

mod arrays;
mod axes;
mod bindings;
mod bodies;
mod component_keys;
mod components;
mod conditions;
mod couplings;
pub mod error;
pub(super) mod failures;
mod faults;
mod fittings;
mod format;
mod joints;
mod meshes;
pub mod model;
mod names;
mod number;
pub mod overrides;
pub mod own;
pub(super) mod parameters;
mod placed;
mod robot_tables;
mod robots;
pub mod schema;
mod sensors;
mod shapes;
mod signals;

use onescan_base::regular::Within;
use placed::Placed;
use serde::Deserialize;
use toml::de::DeTable;

pub use error::{Inside, SceneError, SceneFault, SceneFaultKind, Thing};
pub use failures::UnknownFailure;
pub use model::Scene;
pub use overrides::Override;
pub use parameters::ParameterRefused;

use crate::model::Mechanics;
use bindings::Lookup;
use faults::Faults;
use format::SceneFile;
use names::Names;
use number::{Allowed, Entry};
use own::{Aliases, Kinds};
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
        Self::parse_with(text, file, &[], &Within::anywhere())
    }

    /// Reads a scene as [`Scene::parse`] does, with `overrides` in the place of the file's own values. Meshes, robots and
    /// what these name are read only where `within` allows it.
    ///
    /// # Errors
    /// [`SceneError::Faulty`] with every fault that was found; those of an override say which.
    pub fn parse_with(text: &str, file: &str, overrides: &[Override], within: &Within) -> Result<Self, SceneError> {
        let mut faults = Faults::new(text, file, within);
        let mut document = match DeTable::parse(text) {
            Ok(document) => document,
            Err(error) => return Err(faults.into_form_error(&error)),
        };
        overrides::apply(document.get_mut(), overrides, &mut faults);
        if !faults.is_empty() {
            // What an override was to change is not there: the rest would be checked without it.
            return Err(faults.into_error());
        }
        match SceneFile::deserialize(toml::Deserializer::from(document)) {
            Ok(mut written) => {
                arrays::expand(&mut written, &mut faults);
                let mut remarks = robots::expand(&mut written, &mut faults);
                let own = own::expand(&mut written, &mut faults);
                remarks.extend(own.remarks);
                let scene = Self { remarks, ..check(&written, &own.kinds, own.aliases, &mut faults) };
                faults.into_result(scene)
            }
            Err(error) => Err(faults.into_form_error(&error)),
        }
    }
}

/// The checked scene; of no meaning where faults were found.
fn check(written: &SceneFile, kinds: &Kinds, aliases: Aliases, faults: &mut Faults<'_>) -> Scene {
    let version = *written.version.get_ref();
    if version != VERSION {
        let hint = Some(format!("this program reads version {VERSION}"));
        faults.add_hinted(written.version.span(), SceneFaultKind::Version(version), hint);
    }
    let bodies = Names::gather(Thing::Body, written.body.iter().map(|body| &body.get_ref().name), faults);
    let joints = Names::gather(Thing::Joint, written.joint.iter().map(|joint| &joint.get_ref().name), faults);
    let shapes = Names::gather(Thing::Shape, written.shape.iter().map(|shape| &shape.get_ref().name), faults);
    let mut signals = Signals::new();
    let extent = Entry::new("extent_m", written.extent_m.as_ref());
    let rule = written.friction_rule.unwrap_or_default();
    let scene_bodies = bodies::check(&written.body, rule, faults);
    let scene_shapes = shapes::check(&written.shape, &written.body, rule, &bodies, faults);
    let scene_joints = joints::check(&written.joint, &written.body, &bodies, faults);
    let fittings = fittings::check(written, &joints, &mut signals, faults);
    let couplings = couplings::check(written, &joints, &scene_joints, faults);
    let axes = axes::check(written, &bodies, &joints, &mut signals, faults);
    let sensors = sensors::check(written, &bodies, &joints, &mut signals, faults);
    let placed = Lookup { file: written, bodies: &bodies, shapes: &shapes, joints: &joints, axes: &axes, kinds };
    let (mut components, mut lost) = components::check(&placed, &mut signals, faults);
    lost.extend(aliases.lost().map(str::to_owned));
    failures::check(&written.failure, (&mut components, &lost, &aliases), &mut signals, faults);
    let conditions = conditions::check(&written.signal, &mut signals, faults);
    let (reads, writes) = signals.into_ports(faults);
    Scene {
        mechanics: Mechanics {
            gravity_m_s2: faults.triple("gravity_m_s2", written.gravity_m_s2.as_ref()).unwrap_or(GRAVITY_M_S2),
            extent_m: faults.number(extent, Allowed::Positive).unwrap_or(EXTENT_M),
            substeps: faults.count("substeps", written.substeps.as_ref(), SUBSTEPS_MAX).unwrap_or(1),
            solver_iterations: faults
                .count("solver_iterations", written.solver_iterations.as_ref(), SOLVER_ITERATIONS_MAX)
                .unwrap_or(SOLVER_ITERATIONS),
            sleeping: written.sleeping.unwrap_or(false),
            bodies: scene_bodies,
            shapes: scene_shapes,
            joints: scene_joints,
            fittings,
            couplings,
            axes,
            sensors,
        },
        components,
        aliases,
        conditions,
        remarks: Vec::new(),
        kind_files: kinds.files.clone(),
        reads,
        writes,
    }
}

/// The text of a spanned name.
fn text(name: &Placed<String>) -> &str {
    name.get_ref()
}
