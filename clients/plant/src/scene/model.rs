//! A checked scene: plain data in SI units, names resolved to indices, everything finite.
//!
//! Points and directions are in world coordinates, in the pose that the scene gives its bodies.

use std::path::PathBuf;

use onescan_server::signal::{Port, SignalName};
use serde::Serialize;

use super::own::Aliases;

pub use super::component_model::{Between, Bound, Component, Condition, Driven, FailureSwitch, Range, When, Wire};
pub use super::format::{BodyKind, FrictionRule, JointKind, NumberType};

/// Most collision groups of a scene; one bit of 32 stands for the bodies without a group.
pub const GROUPS_MAX: usize = 31;

/// A scene that can be built.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// Acceleration of free fall.
    pub gravity_m_s2: [f64; 3],
    /// Distance from the origin beyond which a body has left the world.
    pub extent_m: f64,
    /// World steps a turn.
    pub substeps: u32,
    /// Solver iterations a world step.
    pub solver_iterations: u32,
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
    /// Components in the file's order.
    pub components: Vec<Component>,
    /// What the names of its assemblies stand for.
    #[serde(skip)]
    pub(crate) aliases: Aliases,
    /// What happens to signals between the plant and the session.
    pub conditions: Vec<Condition>,
    /// What of robots' files was read otherwise than it is written, for people.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    /// The files that its kinds of the user's own were read from.
    #[serde(skip)]
    pub kind_files: Vec<PathBuf>,
    /// Signals that the plant reads, in the order of axes, then components.
    pub reads: Vec<Port>,
    /// Signals that the plant writes: those of axes, sensors, then components.
    pub writes: Vec<Port>,
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
