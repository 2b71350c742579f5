//! The scene file as it is written: one struct a table, nothing checked yet but form and keys.
//!
//! Every value that a later check may refuse is [`Placed`], so that the refusal can name its line.

use std::collections::BTreeMap;

use super::placed::Placed;
use crate::model::{BodyKind, FrictionRule, JointKind, NumberType};
use schemars::JsonSchema;
use serde::Deserialize;

/// Three components, of which each has its place.
pub(super) type Triple = Placed<[f64; 3]>;

/// The key that says where pictures show a component.
pub(super) const SHOWN_AT: &str = "shown_at_m";

/// A whole scene file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub(super) version: Placed<i64>,
    pub(super) gravity_m_s2: Option<Triple>,
    pub(super) extent_m: Option<Placed<f64>>,
    pub(super) substeps: Option<Placed<i64>>,
    pub(super) solver_iterations: Option<Placed<i64>>,
    pub(super) friction_rule: Option<FrictionRule>,
    pub(super) sleeping: Option<bool>,
    #[serde(default)]
    pub(super) libraries: Vec<Placed<String>>,
    #[serde(default)]
    pub(super) body: Vec<Placed<BodyTable>>,
    #[serde(default)]
    pub(super) shape: Vec<Placed<ShapeTable>>,
    #[serde(default)]
    pub(super) urdf: Vec<Placed<UrdfTable>>,
    #[serde(default)]
    pub(super) joint: Vec<Placed<JointTable>>,
    #[serde(default)]
    pub(super) fitting: Vec<Placed<FittingTable>>,
    #[serde(default)]
    pub(super) coupling: Vec<Placed<CouplingTable>>,
    #[serde(default)]
    pub(super) axis: Vec<Placed<AxisTable>>,
    #[serde(default)]
    pub(super) sensor: Vec<Placed<SensorTable>>,
    /// The schema takes what a component may have from the library's kinds.
    #[serde(default)]
    #[schemars(with = "Vec<serde_json::Value>")]
    pub(super) component: Vec<Placed<ComponentTable>>,
    #[serde(default)]
    pub(super) failure: Vec<Placed<FailureTable>>,
    #[serde(default)]
    pub(super) signal: Vec<Placed<SignalTable>>,
}

/// `[[component]]`: its keys depend on its kind and are checked in the second pass.
pub(super) type ComponentTable = BTreeMap<Placed<String>, Placed<toml::Value>>;

/// `[[failure]]`
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FailureTable {
    pub(super) component: Placed<String>,
    pub(super) mode: Placed<String>,
    pub(super) signal: Option<Placed<String>>,
    pub(super) from_s: Option<Placed<f64>>,
    pub(super) until_s: Option<Placed<f64>>,
}

/// `[[signal]]`
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SignalTable {
    pub(super) name: Placed<String>,
    #[serde(rename = "type")]
    pub(super) ty: Option<Placed<String>>,
    pub(super) range: Option<Placed<[f64; 2]>>,
    pub(super) raw: Option<Placed<[f64; 2]>>,
    pub(super) delay_s: Option<Placed<f64>>,
    pub(super) jitter_s: Option<Placed<f64>>,
    pub(super) delay_sigma_s: Option<Placed<f64>>,
    pub(super) sample_s: Option<Placed<f64>>,
    pub(super) quantum: Option<Placed<f64>>,
    pub(super) noise_mean: Option<Placed<f64>>,
    pub(super) noise_sigma: Option<Placed<f64>>,
    pub(super) lost_rate: Option<Placed<f64>>,
    pub(super) flip_rate: Option<Placed<f64>>,
}

/// The form of a body's only shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum ShapeKind {
    Box,
    Sphere,
    Cylinder,
    Capsule,
    Mesh,
}

/// `[[body]]`
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyTable {
    pub(super) name: Placed<String>,
    pub(super) kind: BodyKind,
    pub(super) shape: Option<Placed<ShapeKind>>,
    pub(super) size_m: Option<Triple>,
    pub(super) radius_m: Option<Placed<f64>>,
    pub(super) length_m: Option<Placed<f64>>,
    pub(super) mesh: Option<Placed<String>>,
    pub(super) unit_m: Option<Placed<f64>>,
    pub(super) hull: Option<Placed<bool>>,
    pub(super) position_m: Option<Triple>,
    pub(super) rpy_deg: Option<Triple>,
    pub(super) velocity_m_s: Option<Triple>,
    pub(super) mass_kg: Option<Placed<f64>>,
    pub(super) density_kg_m3: Option<Placed<f64>>,
    pub(super) centre_m: Option<Triple>,
    pub(super) inertia_kg_m2: Option<Placed<[f64; 6]>>,
    pub(super) friction: Option<Placed<f64>>,
    pub(super) friction_rule: Option<FrictionRule>,
    pub(super) restitution: Option<Placed<f64>>,
    pub(super) collides: Option<bool>,
    pub(super) group: Option<Placed<String>>,
    pub(super) turn_about_m: Option<Triple>,
    pub(super) step_m: Option<Triple>,
    /// Whether its `[[shape]]`s give it all of its mass: a link of a robot.
    #[serde(skip)]
    pub(super) weighed_by_shapes: bool,
}

/// `[[shape]]`: one more shape of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ShapeTable {
    pub(super) name: Placed<String>,
    pub(super) body: Placed<String>,
    pub(super) shape: Placed<ShapeKind>,
    pub(super) size_m: Option<Triple>,
    pub(super) radius_m: Option<Placed<f64>>,
    pub(super) length_m: Option<Placed<f64>>,
    pub(super) mesh: Option<Placed<String>>,
    pub(super) unit_m: Option<Placed<f64>>,
    pub(super) hull: Option<Placed<bool>>,
    pub(super) position_m: Option<Triple>,
    pub(super) rpy_deg: Option<Triple>,
    pub(super) mass_kg: Option<Placed<f64>>,
    pub(super) density_kg_m3: Option<Placed<f64>>,
    pub(super) friction: Option<Placed<f64>>,
    pub(super) friction_rule: Option<FrictionRule>,
    pub(super) restitution: Option<Placed<f64>>,
    pub(super) collides: Option<bool>,
    pub(super) turn_about_m: Option<Triple>,
    pub(super) step_m: Option<Triple>,
    /// What 1 means in a robot's mesh along each axis.
    #[serde(skip)]
    pub(super) stretch: Option<[f64; 3]>,
}

/// `[[urdf]]`: bodies, shapes and joints from a file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct UrdfTable {
    pub(super) name: Placed<String>,
    pub(super) file: Placed<String>,
    pub(super) position_m: Option<Triple>,
    pub(super) rpy_deg: Option<Triple>,
    pub(super) fixed: Option<bool>,
    pub(super) kinematic: Option<Placed<bool>>,
    pub(super) collides: Option<bool>,
    pub(super) friction: Option<Placed<f64>>,
    pub(super) density_kg_m3: Option<Placed<f64>>,
    pub(super) initial_rad: Option<BTreeMap<String, Placed<f64>>>,
    pub(super) initial_m: Option<BTreeMap<String, Placed<f64>>>,
    pub(super) packages: Option<BTreeMap<String, Placed<String>>>,
    #[schemars(with = "Option<BTreeMap<String, serde_json::Value>>")]
    pub(super) arguments: Option<BTreeMap<String, Placed<toml::Value>>>,
}

/// `[[joint]]`
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct JointTable {
    pub(super) name: Placed<String>,
    pub(super) kind: Placed<JointKind>,
    pub(super) parent: Placed<String>,
    pub(super) child: Placed<String>,
    pub(super) anchor_m: Option<Triple>,
    pub(super) axis: Option<Triple>,
    pub(super) slide: Option<Triple>,
    pub(super) initial_m: Option<Placed<f64>>,
    pub(super) initial_rad: Option<Placed<f64>>,
    pub(super) lower_m: Option<Placed<f64>>,
    pub(super) lower_rad: Option<Placed<f64>>,
    pub(super) upper_m: Option<Placed<f64>>,
    pub(super) upper_rad: Option<Placed<f64>>,
    pub(super) contacts: Option<bool>,
    /// Whether it is of a robot without dynamics.
    #[serde(skip)]
    pub(super) guided: bool,
    /// What a joint of a robot follows.
    #[serde(skip)]
    pub(super) follows: Option<FollowTable>,
}

/// What a joint follows.
#[derive(Clone, Debug)]
pub(super) struct FollowTable {
    pub(super) joint: Placed<String>,
    pub(super) factor: f64,
    pub(super) offset: f64,
}

/// `[[coupling]]`: a joint that others lead.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CouplingTable {
    pub(super) name: Placed<String>,
    pub(super) joint: Placed<String>,
    pub(super) of: Vec<Placed<String>>,
    pub(super) ratio: Option<Placed<Vec<f64>>>,
    pub(super) cam: Option<Placed<Vec<[f64; 2]>>>,
    /// From its last point on the cam goes through its points again.
    pub(super) cam_repeats: Option<Placed<bool>>,
    pub(super) backlash_m: Option<Placed<f64>>,
    pub(super) backlash_rad: Option<Placed<f64>>,
    /// Beyond this force on the led joint it slips.
    pub(super) slip_n: Option<Placed<f64>>,
    pub(super) slip_nm: Option<Placed<f64>>,
}

/// `[[fitting]]`: what is fitted to a joint beside its drive.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FittingTable {
    pub(super) name: Placed<String>,
    pub(super) joint: Placed<String>,
    pub(super) friction_n: Option<Placed<f64>>,
    pub(super) friction_nm: Option<Placed<f64>>,
    pub(super) stiction_n: Option<Placed<f64>>,
    pub(super) stiction_nm: Option<Placed<f64>>,
    pub(super) stribeck_m_s: Option<Placed<f64>>,
    pub(super) stribeck_rad_s: Option<Placed<f64>>,
    pub(super) damping_n_s_m: Option<Placed<f64>>,
    pub(super) damping_nm_s_rad: Option<Placed<f64>>,
    pub(super) spring_n_m: Option<Placed<f64>>,
    pub(super) spring_nm_rad: Option<Placed<f64>>,
    pub(super) rest_m: Option<Placed<f64>>,
    pub(super) rest_rad: Option<Placed<f64>>,
    pub(super) balance_n: Option<Placed<f64>>,
    pub(super) balance_nm: Option<Placed<f64>>,
    pub(super) brake_n: Option<Placed<f64>>,
    pub(super) brake_nm: Option<Placed<f64>>,
    pub(super) release_signal: Option<Placed<String>>,
}

/// How an axis is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum DriveKind {
    /// Two BOOL signals and one fixed speed.
    Bidirectional,
    /// A number signal that commands the velocity.
    Velocity,
    /// A number signal that commands the position.
    Position,
}

/// `[[axis]]`
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AxisTable {
    pub(super) name: Placed<String>,
    pub(super) joint: Option<Placed<String>>,
    pub(super) belt: Option<Placed<String>>,
    pub(super) direction: Option<Triple>,
    pub(super) drive: Placed<DriveKind>,
    pub(super) forward_signal: Option<Placed<String>>,
    pub(super) reverse_signal: Option<Placed<String>>,
    pub(super) command_signal: Option<Placed<String>>,
    pub(super) speed_m_s: Option<Placed<f64>>,
    pub(super) speed_rad_s: Option<Placed<f64>>,
    pub(super) acceleration_m_s2: Option<Placed<f64>>,
    pub(super) acceleration_rad_s2: Option<Placed<f64>>,
    pub(super) force_max_n: Option<Placed<f64>>,
    pub(super) torque_max_nm: Option<Placed<f64>>,
    pub(super) position_signal: Option<Placed<String>>,
    pub(super) velocity_signal: Option<Placed<String>>,
    pub(super) force_signal: Option<Placed<String>>,
    pub(super) torque_signal: Option<Placed<String>>,
    pub(super) limit_signal: Option<Placed<String>>,
    #[serde(default)]
    pub(super) signal_type: NumberType,
}

/// What a sensor detects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum SensorKind {
    EndPosition,
    Proximity,
}

/// `[[sensor]]`
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SensorTable {
    pub(super) name: Placed<String>,
    pub(super) kind: Placed<SensorKind>,
    pub(super) signal: Placed<String>,
    pub(super) joint: Option<Placed<String>>,
    pub(super) from_m: Option<Placed<f64>>,
    pub(super) from_rad: Option<Placed<f64>>,
    pub(super) to_m: Option<Placed<f64>>,
    pub(super) to_rad: Option<Placed<f64>>,
    pub(super) hysteresis_m: Option<Placed<f64>>,
    pub(super) hysteresis_rad: Option<Placed<f64>>,
    pub(super) body: Option<Placed<String>>,
    pub(super) point_m: Option<Triple>,
    pub(super) direction: Option<Triple>,
    pub(super) range_m: Option<Placed<f64>>,
    pub(super) targets: Option<Vec<Placed<String>>>,
}
