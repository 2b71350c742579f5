//! The scene file as it is written: one struct a table, nothing checked yet but form and keys.
//!
//! Every value that a later check may refuse is [`Spanned`], so that the refusal can name its line.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::Spanned;

/// Three components, of which each has its place.
pub(super) type Triple = Spanned<[f64; 3]>;

/// A whole scene file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub(super) version: Spanned<i64>,
    pub(super) gravity_m_s2: Option<Triple>,
    pub(super) extent_m: Option<Spanned<f64>>,
    pub(super) substeps: Option<Spanned<i64>>,
    pub(super) solver_iterations: Option<Spanned<i64>>,
    #[serde(default)]
    pub(super) body: Vec<Spanned<BodyTable>>,
    #[serde(default)]
    pub(super) shape: Vec<Spanned<ShapeTable>>,
    #[serde(default)]
    pub(super) urdf: Vec<Spanned<UrdfTable>>,
    #[serde(default)]
    pub(super) joint: Vec<Spanned<JointTable>>,
    #[serde(default)]
    pub(super) axis: Vec<Spanned<AxisTable>>,
    #[serde(default)]
    pub(super) sensor: Vec<Spanned<SensorTable>>,
    #[serde(default)]
    pub(super) component: Vec<Spanned<ComponentTable>>,
    #[serde(default)]
    pub(super) failure: Vec<Spanned<FailureTable>>,
    #[serde(default)]
    pub(super) signal: Vec<Spanned<SignalTable>>,
}

/// `[[component]]`: its keys depend on its kind and are checked in the second pass.
pub(super) type ComponentTable = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

/// `[[failure]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FailureTable {
    pub(super) component: Spanned<String>,
    pub(super) mode: Spanned<String>,
    pub(super) signal: Option<Spanned<String>>,
    pub(super) from_s: Option<Spanned<f64>>,
    pub(super) until_s: Option<Spanned<f64>>,
}

/// `[[signal]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SignalTable {
    pub(super) name: Spanned<String>,
    #[serde(rename = "type")]
    pub(super) ty: Option<Spanned<String>>,
    pub(super) range: Option<Spanned<[f64; 2]>>,
    pub(super) raw: Option<Spanned<[f64; 2]>>,
    pub(super) delay_s: Option<Spanned<f64>>,
    pub(super) jitter_s: Option<Spanned<f64>>,
    pub(super) sample_s: Option<Spanned<f64>>,
    pub(super) quantum: Option<Spanned<f64>>,
    pub(super) noise_mean: Option<Spanned<f64>>,
    pub(super) noise_sigma: Option<Spanned<f64>>,
}

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyKind {
    /// Never moves.
    Fixed,
    /// Moves under forces.
    Dynamic,
    /// Moves with a constant velocity that no force changes.
    Kinematic,
}

/// The form of a body's only shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ShapeKind {
    Box,
    Sphere,
    Cylinder,
    Capsule,
    Mesh,
}

/// `[[body]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyTable {
    pub(super) name: Spanned<String>,
    pub(super) kind: BodyKind,
    pub(super) shape: Option<Spanned<ShapeKind>>,
    pub(super) size_m: Option<Triple>,
    pub(super) radius_m: Option<Spanned<f64>>,
    pub(super) length_m: Option<Spanned<f64>>,
    pub(super) mesh: Option<Spanned<String>>,
    pub(super) unit_m: Option<Spanned<f64>>,
    pub(super) hull: Option<Spanned<bool>>,
    pub(super) position_m: Option<Triple>,
    pub(super) rpy_deg: Option<Triple>,
    pub(super) velocity_m_s: Option<Triple>,
    pub(super) mass_kg: Option<Spanned<f64>>,
    pub(super) density_kg_m3: Option<Spanned<f64>>,
    pub(super) centre_m: Option<Triple>,
    pub(super) inertia_kg_m2: Option<Spanned<[f64; 6]>>,
    pub(super) friction: Option<Spanned<f64>>,
    pub(super) restitution: Option<Spanned<f64>>,
    pub(super) collides: Option<bool>,
    pub(super) group: Option<Spanned<String>>,
    pub(super) turn_about_m: Option<Triple>,
    pub(super) step_m: Option<Triple>,
}

/// `[[shape]]`: one more shape of a body.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShapeTable {
    pub(super) name: Spanned<String>,
    pub(super) body: Spanned<String>,
    pub(super) shape: Spanned<ShapeKind>,
    pub(super) size_m: Option<Triple>,
    pub(super) radius_m: Option<Spanned<f64>>,
    pub(super) length_m: Option<Spanned<f64>>,
    pub(super) mesh: Option<Spanned<String>>,
    pub(super) unit_m: Option<Spanned<f64>>,
    pub(super) hull: Option<Spanned<bool>>,
    pub(super) position_m: Option<Triple>,
    pub(super) rpy_deg: Option<Triple>,
    pub(super) mass_kg: Option<Spanned<f64>>,
    pub(super) friction: Option<Spanned<f64>>,
    pub(super) restitution: Option<Spanned<f64>>,
    pub(super) collides: Option<bool>,
    pub(super) turn_about_m: Option<Triple>,
    pub(super) step_m: Option<Triple>,
}

/// `[[urdf]]`: bodies, shapes and joints from a file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct UrdfTable {
    pub(super) name: Spanned<String>,
    pub(super) file: Spanned<String>,
    pub(super) position_m: Option<Triple>,
    pub(super) rpy_deg: Option<Triple>,
    pub(super) fixed: Option<bool>,
    pub(super) collides: Option<bool>,
    pub(super) friction: Option<Spanned<f64>>,
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// Translation along `axis`.
    Prismatic,
    /// Rotation about `axis`.
    Revolute,
    /// Nothing.
    Fixed,
    /// A pin of the child in a slot of the parent: rotation about `axis`, translation along `slide`.
    Slot,
    /// All rotations.
    Ball,
}

/// `[[joint]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointTable {
    pub(super) name: Spanned<String>,
    pub(super) kind: Spanned<JointKind>,
    pub(super) parent: Spanned<String>,
    pub(super) child: Spanned<String>,
    pub(super) anchor_m: Option<Triple>,
    pub(super) axis: Option<Triple>,
    pub(super) slide: Option<Triple>,
    pub(super) initial_m: Option<Spanned<f64>>,
    pub(super) initial_rad: Option<Spanned<f64>>,
    pub(super) lower_m: Option<Spanned<f64>>,
    pub(super) lower_rad: Option<Spanned<f64>>,
    pub(super) upper_m: Option<Spanned<f64>>,
    pub(super) upper_rad: Option<Spanned<f64>>,
    pub(super) contacts: Option<bool>,
}

/// How an axis is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum DriveKind {
    /// Two BOOL signals and one fixed speed.
    Bidirectional,
    /// A number signal that commands the velocity.
    Velocity,
    /// A number signal that commands the position.
    Position,
}

/// The IEC type of an axis's number signals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum NumberType {
    /// IEC 60559 binary32.
    #[serde(rename = "REAL")]
    Real,
    /// IEC 60559 binary64.
    #[default]
    #[serde(rename = "LREAL")]
    Lreal,
}

/// `[[axis]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AxisTable {
    pub(super) name: Spanned<String>,
    pub(super) joint: Option<Spanned<String>>,
    pub(super) belt: Option<Spanned<String>>,
    pub(super) direction: Option<Triple>,
    pub(super) drive: Spanned<DriveKind>,
    pub(super) forward_signal: Option<Spanned<String>>,
    pub(super) reverse_signal: Option<Spanned<String>>,
    pub(super) command_signal: Option<Spanned<String>>,
    pub(super) speed_m_s: Option<Spanned<f64>>,
    pub(super) speed_rad_s: Option<Spanned<f64>>,
    pub(super) acceleration_m_s2: Option<Spanned<f64>>,
    pub(super) acceleration_rad_s2: Option<Spanned<f64>>,
    pub(super) force_max_n: Option<Spanned<f64>>,
    pub(super) torque_max_nm: Option<Spanned<f64>>,
    pub(super) position_signal: Option<Spanned<String>>,
    pub(super) velocity_signal: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) signal_type: NumberType,
}

/// What a sensor detects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SensorKind {
    EndPosition,
    Proximity,
}

/// `[[sensor]]`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SensorTable {
    pub(super) name: Spanned<String>,
    pub(super) kind: Spanned<SensorKind>,
    pub(super) signal: Spanned<String>,
    pub(super) joint: Option<Spanned<String>>,
    pub(super) from_m: Option<Spanned<f64>>,
    pub(super) from_rad: Option<Spanned<f64>>,
    pub(super) to_m: Option<Spanned<f64>>,
    pub(super) to_rad: Option<Spanned<f64>>,
    pub(super) hysteresis_m: Option<Spanned<f64>>,
    pub(super) hysteresis_rad: Option<Spanned<f64>>,
    pub(super) body: Option<Spanned<String>>,
    pub(super) point_m: Option<Triple>,
    pub(super) direction: Option<Triple>,
    pub(super) range_m: Option<Spanned<f64>>,
    pub(super) targets: Option<Vec<Spanned<String>>>,
}
