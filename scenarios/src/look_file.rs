//! `[[view]]`, `[[figure]]` and `[[look]]` of `scenario.toml` as they are written.

use onescan_server::signal::SignalName;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::form::Name;

/// A place from which the machine is seen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ViewFile {
    /// Its name; unique.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// Where the eye is, m.
    pub position_m: [f64; 3],
    /// What it looks at, m.
    pub target_m: [f64; 3],
}

/// A body for the eye only: it is drawn, and no plant knows of it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FigureFile {
    /// Its name, unique; with a range it is an array, as `"panel[0..11]"`.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// What it is; cylinders and tubes stand along z.
    pub shape: FigureShape,
    /// Lengths along x, y and z of a box, m.
    pub size_m: Option<[f64; 3]>,
    /// Radius of what is round, m.
    pub radius_m: Option<f64>,
    /// Radius at the upper end of a cylinder or a tube, m; `radius_m` if absent.
    pub top_radius_m: Option<f64>,
    /// Length of a cylinder or a tube, m.
    pub length_m: Option<f64>,
    /// Where its middle is, m.
    #[serde(default)]
    pub position_m: [f64; 3],
    /// How it is turned about x, y and z, in this order, degrees.
    #[serde(default)]
    pub rpy_deg: [f64; 3],
    /// Of an array: from each copy to the next, m.
    #[serde(default)]
    pub step_m: [f64; 3],
    /// Of an array: copies stand in a circle about the upright axis through this point, m.
    pub turn_about_m: Option<[f64; 3]>,
    /// The figure or the body that it moves with: places are in its frame. A figure stands further up in the file.
    #[schemars(with = "Option<String>")]
    pub on: Option<Spanned<String>>,
    /// Its colour: `#rrggbb`, or a word such as `red`.
    #[schemars(with = "Option<String>")]
    pub colour: Option<Spanned<String>>,
    /// How much one sees through it, 0 to 1.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub transparent: f64,
}

/// What a figure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FigureShape {
    /// With `size_m`.
    Box,
    /// With `radius_m` and `length_m`, closed.
    Cylinder,
    /// With `radius_m` and `length_m`, open at both ends.
    Tube,
    /// With `radius_m`.
    Sphere,
}

/// How bodies look while something holds, or by the value of a signal.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LookFile {
    /// The look is one for each of these numbers, first and last, with the number in place of `i` in each `[i]` of its texts.
    pub each: Option<[usize; 2]>,
    /// Figures and bodies, by name or pattern (`panel*`).
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub bodies: Vec<Spanned<String>>,
    /// Components, by name or pattern: their bodies.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub parts: Vec<Spanned<String>>,
    /// A formula of the present; the look is on while it holds, always if absent.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// The colour.
    #[schemars(with = "Option<String>")]
    pub colour: Option<Spanned<String>>,
    /// Whether they are not seen at all.
    #[serde(default)]
    pub hidden: bool,
    /// How much one sees through them, 0 to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub transparent: Option<f64>,
    /// How much larger they are drawn.
    pub scale: Option<f64>,
    /// The signal whose value drives the keys below.
    #[schemars(with = "Option<Name>")]
    pub follows: Option<Spanned<SignalName>>,
    /// Values of the signal at which the way begins and ends, beyond which nothing changes; without it, 0 and 1 without an
    /// end.
    pub over: Option<[f64; 2]>,
    /// How long the whole way takes for the eye at least, virtual seconds: of a signal that jumps.
    pub takes_s: Option<f64>,
    /// The way that figures move, m.
    pub move_m: Option<[f64; 3]>,
    /// The angle that figures turn: an axis, as long as the angle in degrees.
    pub turn_deg: Option<[f64; 3]>,
    /// The point about which they turn, m; their middle if absent.
    pub turn_about_m: Option<[f64; 3]>,
    /// The axis along which they grow, from their lower end: from nothing to their size.
    pub grow: Option<Axis>,
    /// Colours at the begin and the end of the way.
    #[schemars(with = "Option<[String; 2]>")]
    pub colours: Option<Spanned<[String; 2]>>,
    /// How fast their surface runs, m/s: of belts.
    pub run_m_s: Option<[f64; 3]>,
}

/// An axis of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// Upwards.
    Z,
}
