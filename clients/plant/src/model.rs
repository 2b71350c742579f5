//! What the world of rigid bodies is built from: plain data in SI units, names resolved to indices, everything finite.
//!
//! Points and directions are in world coordinates, in the pose that the scene gives its bodies. Nothing here names a
//! component: those stand on the world, and the world stands on this.

use onescan_server::signal::{SignalName, SignalType};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most collision groups of a scene; one bit of 32 stands for the bodies without a group.
pub const GROUPS_MAX: usize = 31;

/// Bodies, their joints, what drives the joints and what senses them.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mechanics {
    /// Acceleration of free fall.
    pub gravity_m_s2: [f64; 3],
    /// Distance from the origin beyond which a body has left the world.
    pub extent_m: f64,
    /// World steps a turn.
    pub substeps: u32,
    /// Solver iterations a world step.
    pub solver_iterations: u32,
    /// Whether what rests on a floor or rides on a belt may sleep.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub sleeping: bool,
    /// Bodies in the file's order, which is the order of their insertion.
    pub bodies: Vec<Body>,
    /// More shapes of bodies in the file's order, which is the order of their insertion.
    pub shapes: Vec<Attached>,
    /// Joints in the file's order, which is the order of their insertion.
    pub joints: Vec<Joint>,
    /// What is fitted to joints, in the file's order.
    pub fittings: Vec<Fitting>,
    /// Couplings between joints, in the file's order.
    pub couplings: Vec<Coupling>,
    /// Driven axes in the file's order.
    pub axes: Vec<Axis>,
    /// Sensors in the file's order.
    pub sensors: Vec<Sensor>,
}

/// One rigid body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: BodyKind,
    /// Its form, none for a body that only carries joints and sensors.
    pub shape: Option<Shape>,
    /// Its origin.
    pub position_m: [f64; 3],
    /// Its orientation: roll about x, then pitch about y, then yaw about z, all axes the world's.
    pub rpy_deg: [f64; 3],
    /// Its velocity at the session's start.
    pub velocity_m_s: [f64; 3],
    /// Its mass, of meaning for dynamic bodies only.
    pub mass: Mass,
    /// Coefficient of friction.
    pub friction: f64,
    /// How it becomes one with that of another body.
    #[serde(skip_serializing_if = "FrictionRule::is_preset")]
    pub friction_rule: FrictionRule,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// What it collides with.
    pub collisions: Collisions,
}

/// One more shape of a body, which moves with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attached {
    /// Its name.
    pub name: String,
    /// Index of its body.
    pub body: usize,
    /// Its form.
    pub shape: Shape,
    /// Its centre in the scene's pose, in world coordinates.
    pub position_m: [f64; 3],
    /// Its orientation in the scene's pose, as that of a body.
    pub rpy_deg: [f64; 3],
    /// What it adds to the mass of its body.
    pub mass_kg: f64,
    /// What it adds to the mass of its body in each part of its volume, in place of `mass_kg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
    /// Coefficient of friction.
    pub friction: f64,
    /// How it becomes one with that of another body.
    #[serde(skip_serializing_if = "FrictionRule::is_preset")]
    pub friction_rule: FrictionRule,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Whether it collides as its body does, or only sensors see it.
    pub collides: bool,
}

/// The form of a body, centred on its origin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Shape {
    /// Edges along the body's axes.
    Box {
        /// Whole lengths of the edges.
        size_m: [f64; 3],
    },
    /// A ball.
    Sphere {
        /// Its radius.
        radius_m: f64,
    },
    /// Its axis is the body's z.
    Cylinder {
        /// Its radius.
        radius_m: f64,
        /// Its whole length.
        length_m: f64,
    },
    /// Its axis is the body's z.
    Capsule {
        /// Radius of the caps and between them.
        radius_m: f64,
        /// Its length without the caps.
        length_m: f64,
    },
    /// The convex hull of a mesh.
    Hull {
        /// The mesh's file.
        file: String,
        /// Its corners.
        corners_m: Vec<[f64; 3]>,
    },
    /// The very surface of a mesh, for a body that no force moves.
    Surface {
        /// The mesh's file.
        file: String,
        /// Its corners.
        corners_m: Vec<[f64; 3]>,
        /// Indices of three corners each.
        triangles: Vec<[u32; 3]>,
    },
}

/// How the mass of a body is stated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Mass {
    /// Whole mass.
    Total {
        /// The mass.
        kg: f64,
    },
    /// Mass properties in place of those of the shape.
    Stated {
        /// The mass.
        kg: f64,
        /// Centre of mass in the scene's pose, in world coordinates.
        centre_m: [f64; 3],
        /// ixx, iyy, izz, ixy, ixz, iyz about it, along the world's axes in the scene's pose.
        inertia_kg_m2: [f64; 6],
    },
    /// Mass from the volume of the shape.
    Density {
        /// The density.
        kg_m3: f64,
    },
}

/// What a body collides with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Collisions {
    /// Nothing; sensors see it all the same.
    None,
    /// Every body that collides at all.
    All,
    /// Every body that collides at all, except those of the same group.
    OutsideGroup(u32),
}

/// One joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// What it leaves free.
    pub kind: JointKind,
    /// Index of the body that it is measured from, none for the ground.
    pub parent: Option<usize>,
    /// Index of the body that is measured.
    pub child: usize,
    /// Where it joins the two.
    pub anchor_m: [f64; 3],
    /// Unit vector: of translation for a prismatic joint, of rotation for the others.
    pub axis: [f64; 3],
    /// Unit vector at a right angle to `axis`; of translation for a slot.
    pub across: [f64; 3],
    /// Its coordinate in the pose of the scene, m or rad.
    pub initial: f64,
    /// Its lowest coordinate, m or rad.
    pub lower: Option<f64>,
    /// Its highest coordinate, m or rad.
    pub upper: Option<f64>,
    /// Whether the joined bodies collide with each other.
    pub contacts: bool,
    /// Whether it is of a robot without dynamics: where its axis sets it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub guided: bool,
    /// The joint that it follows, whatever drives that one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub follows: Option<Follows>,
}

/// What a joint follows: `factor` times the coordinate of another joint, and `offset`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Follows {
    /// Index of the other joint.
    pub joint: usize,
    /// Of its coordinate.
    pub factor: f64,
    /// Added to it, m or rad.
    pub offset: f64,
}

/// What is fitted to a joint beside its drive. All forces are in N or N·m.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fitting {
    /// Its name.
    pub name: String,
    /// Index of the joint, prismatic or revolute.
    pub joint: usize,
    /// Dry friction while it moves.
    pub friction: f64,
    /// Dry friction at rest, not below the one while it moves.
    pub stiction: f64,
    /// Velocity by which the friction at rest has fallen to a third of what it is above the other, m/s or rad/s.
    pub stribeck: f64,
    /// Viscous friction, N·s/m or N·m·s/rad.
    pub damping: f64,
    /// Stiffness of a spring, N/m or N·m/rad.
    pub spring: f64,
    /// Coordinate at which the spring is at rest, m or rad.
    pub rest: f64,
    /// A constant force up the coordinate, as of a counterweight.
    pub balance: f64,
    /// A brake, which a spring applies.
    pub brake: Option<Brake>,
}

/// A joint that others lead.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coupling {
    /// Its name.
    pub name: String,
    /// Index of the joint that is led.
    pub joint: usize,
    /// What leads it: its coordinate is the sum of what they ask for.
    pub of: Vec<Share>,
    /// Play, m or rad of the joint that is led.
    pub backlash: f64,
    /// The greatest force on the joint that is led, N or N·m: beyond it the coupling slips, and stays where it is then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<f64>,
}

/// What one joint has of leading another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Index of the joint that leads.
    pub joint: usize,
    /// What it asks for.
    pub law: CouplingLaw,
}

/// What a joint asks of one that it leads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum CouplingLaw {
    /// So much of its own way, counted from the scene's pose.
    Ratio(f64),
    /// The curve through these points of coordinates, the leading one first.
    Cam(Vec<[f64; 2]>),
    /// The same, again and again: from the last point on as from the first, so much further.
    RepeatingCam(Vec<[f64; 2]>),
}

/// A brake that a spring applies and a signal releases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Brake {
    /// What it holds.
    pub most: f64,
    /// The BOOL that releases it; without one it is always applied.
    pub release: Option<SignalName>,
}

/// One driven axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Its name.
    pub name: String,
    /// What it moves.
    pub moved: Moved,
    /// How it is commanded.
    pub drive: Drive,
    /// Greatest speed, m/s or rad/s.
    pub speed: f64,
    /// Greatest acceleration and deceleration, m/s² or rad/s².
    pub acceleration: f64,
    /// Greatest force or torque, N or N·m, none for as much as it takes.
    pub effort_max: Option<f64>,
    /// Where the coordinate is written.
    pub position: Option<SignalName>,
    /// Where the coordinate's velocity is written.
    pub velocity: Option<SignalName>,
    /// Where the drive's mean force or torque over the last period is written.
    pub effort: Option<SignalName>,
    /// Where it is written that the drive is at its greatest force or torque, a BOOL.
    pub limit: Option<SignalName>,
    /// Type of the axis's number signals.
    pub number: NumberType,
}

/// What an axis moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Moved {
    /// The joint of this index, prismatic or revolute.
    Joint(usize),
    /// The surface of a kinematic body, which itself stays in place.
    Belt {
        /// Index of the body.
        body: usize,
        /// Unit vector that the surface runs along.
        direction: [f64; 3],
    },
}

/// How an axis is commanded.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Drive {
    /// Two BOOL signals and one fixed speed.
    Bidirectional {
        /// Moves up the coordinate.
        forward: SignalName,
        /// Moves down the coordinate.
        reverse: SignalName,
    },
    /// A commanded velocity.
    Velocity {
        /// The velocity.
        command: SignalName,
    },
    /// A commanded position.
    Position {
        /// The position.
        command: SignalName,
    },
}

/// One sensor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensor {
    /// Its name.
    pub name: String,
    /// Where it is written, a BOOL.
    pub signal: SignalName,
    /// What it detects.
    pub sensing: Sensing,
}

/// What a sensor detects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Sensing {
    /// A joint's coordinate within a range.
    EndPosition {
        /// Index of the joint.
        joint: usize,
        /// Where the range begins, m or rad.
        from: f64,
        /// Where the range ends, m or rad.
        to: f64,
        /// How far outside the range the coordinate must be before the sensor falls, m or rad.
        hysteresis: f64,
    },
    /// A body that a ray meets.
    Proximity {
        /// Index of the body that carries the sensor, none for the ground.
        body: Option<usize>,
        /// Where the ray begins.
        point_m: [f64; 3],
        /// Unit vector of the ray.
        direction: [f64; 3],
        /// Length of the ray.
        range_m: f64,
        /// Indices of the bodies that are detected.
        targets: Vec<usize>,
    },
}

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BodyKind {
    /// Never moves.
    Fixed,
    /// Moves under forces.
    Dynamic,
    /// Moves with a constant velocity that no force changes.
    Kinematic,
}

/// How the coefficients of friction of two bodies become one. Of two rules the later one here holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrictionRule {
    /// Their arithmetic mean.
    #[default]
    Mean,
    /// The least: what is slippery is slippery with everything.
    Least,
    /// Their product.
    Product,
    /// The greatest: what grips grips everything.
    Greatest,
}

impl FrictionRule {
    /// Whether it is the one that holds where nothing is said.
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    pub(crate) fn is_preset(&self) -> bool {
        *self == Self::Mean
    }
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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

/// The IEC type of an axis's number signals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum NumberType {
    /// IEC 60559 binary32.
    #[serde(rename = "REAL")]
    Real,
    /// IEC 60559 binary64.
    #[default]
    #[serde(rename = "LREAL")]
    Lreal,
}

/// What of the world a component is bound to: what its coupling's keys name, and nothing else.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bound {
    /// What it drives; nothing else in the scene does.
    pub drives: Option<Driven>,
    /// Indices of the joints that it drives beside, in the order of its keys.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub beside: Vec<usize>,
    /// Index of the joint that it measures.
    pub measures: Option<usize>,
    /// Index of the body that carries it, is touched or gives the place; none for the ground.
    pub body: Option<usize>,
    /// Index of the only shape of the body that counts, all if none.
    pub shape: Option<usize>,
    /// Where it begins.
    pub point_m: Option<[f64; 3]>,
    /// Unit vector along which it points or runs.
    pub direction: Option<[f64; 3]>,
    /// Unit vector across `direction`, along which one of its beams is beside the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<[f64; 3]>,
    /// Indices of the bodies that it sees, holds or places.
    pub targets: Vec<usize>,
}

impl Bound {
    /// All that it drives.
    pub fn driven(&self) -> impl Iterator<Item = Driven> + '_ {
        self.drives.into_iter().chain(self.beside.iter().copied().map(Driven::Joint))
    }
}

/// What one axis or component alone drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Driven {
    /// The joint of this index.
    Joint(usize),
    /// The surface of the kinematic body of this index.
    Belt(usize),
}

impl Driven {
    /// The joint, if it is one.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Joint(joint) => Some(joint),
            Self::Belt(_) => None,
        }
    }
}

/// What happens to a signal between the plant and the session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// The signal.
    pub signal: SignalName,
    /// Its type inside of the plant; the session's is that of its port.
    pub inner: SignalType,
    /// What part of it is which raw value; as it is if none.
    pub scale: Option<Range>,
    /// Later by so much, ns.
    pub delay_ns: u64,
    /// And by up to so much more, ns.
    pub jitter_ns: u64,
    /// And by a time from N(0, σ) with this σ, ns.
    pub delay_sigma_ns: u64,
    /// Looked at so often, ns; in every period if 0.
    pub sample_ns: u64,
    /// Rounded to a multiple of this; not if 0.
    pub quantum: f64,
    /// Mean of the noise.
    pub noise_mean: f64,
    /// Standard deviation of the noise.
    pub noise_sigma: f64,
    /// How probable it is that a change is lost.
    pub lost_rate: f64,
    /// How probable it is, in each turn, that a bit arrives inverted.
    pub flip_rate: f64,
}

/// A range in a signal's unit, and the raw values of its ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// In the signal's unit.
    pub range: [f64; 2],
    /// Raw.
    pub raw: [f64; 2],
}
