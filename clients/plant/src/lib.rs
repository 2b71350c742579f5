//! The plant: the simulated machine as a client of a session.
//!
//! A scene file says what the machine is made of; in each turn the plant takes the PLC's commands,
//! moves the world by one period and writes what its sensors see.
//!
//! | module | subject |
//! |---|---|
//! | [`mesh`] | corners and triangles from STL, OBJ, COLLADA and glTF files |
//! | [`robot`] | robots described in URDF, xacro and MJCF |
//! | [`scene`] | the scene file: read, checked, plain data |
//! | `pose` | orientations and joint frames from angles and directions |
//! | `model` | bodies, joints, axes and sensors of a checked scene: what the world is built from |
//! | `world` | the scene as a world of rigid bodies |
//! | `setpoint` | the motion a drive wants: ramps and trapezoids in closed form |
//! | `command` | what the PLC commands of a drive |
//! | `effort` | what a drive does to its joint, and what the joint reports to the drive |
//! | `coupled` | what couples the coordinate of a joint to those of others |
//! | `fitting` | what is fitted to a joint beside its drive |
//! | `follower` | a joint that follows another |
//! | `form` | the forms of bodies as they are, for readers that draw by themselves |
//! | `axis` | a driven axis: command, setpoint, what it moves, feedback |
//! | `sensor` | end-position and proximity sensors |
//! | `bend` | a shell that is bent: its run-out, and where a look meets it |
//! | `temperature_field` | the temperature on the surface of a shell that turns |
//! | [`scanner`] | an infrared line scanner as a device: protocol and optics |
//! | [`component`] | the library: cylinders, motors, sensors, … by their equations |
//! | [`coupling`] | what ties a component to the world of rigid bodies |
//! | `part` | a component of the scene, bound to signals, other components and the world |
//! | `machine` | all of these, one turn at a time |
//! | `start` | the world as a scene begins |
//! | `overlap` | bodies that are in each other at the start |
//! | `closure` | joints that close a loop |
//! | `excess` | what a scene asks for beyond what the plant can carry at its step |
//! | `dynamics` | mass matrix and gravity forces of mechanisms |
//! | `layout_mismatch` | why a saved state does not belong to this plant |
//! | `lateness` | how late a value arrives: a constant, an even part, a normal part |
//! | `channel` | what happens to signals between the plant and the PLC |
//! | `failure` | why a failure or a repair of a running plant is refused |
//! | `file_place` | a place in a file that a scene names |
//! | `identity` | whose state it is: what a plant is made of, and what differs from another |
//! | `state` | the plant's state as bytes |
//! | `placement` | where the bodies are, for recordings and pictures |
//! | `client` | the plant as a client of a session |
//!
//! # A turn
//! 1. Every axis reads its command and moves its setpoint by one period; every component is driven.
//! 2. The world takes its substeps.
//! 3. Every joint is measured, every sensor and component looks, all signals are written.
//!
//! # Invariants
//! - Order in the scene file is order of insertion, of evaluation and of signals.
//! - Nothing sleeps: a body at rest costs time, but never wakes late.
//! - A world that is no longer finite or leaves its extent is a fault that names the body.

mod axis;
mod bend;
mod channel;
mod client;
mod closure;
mod command;
pub mod component;
mod coupled;
pub mod coupling;
mod dynamics;
mod effort;
mod excess;
mod failure;
mod file_place;
mod fitting;
mod follower;
mod form;
mod identity;
mod lateness;
mod layout_mismatch;
mod machine;
pub mod mesh;
mod model;
mod outline;
mod overlap;
mod part;
mod placement;
mod pose;
pub mod robot;
pub mod scanner;
pub mod scene;
mod sensor;
mod setpoint;
mod start;
mod state;
mod temperature_field;
mod world;

pub use client::Plant;
pub use closure::Loop;
pub use dynamics::Dynamics;
pub use excess::{Excess, HULL_POINTS_MAX, MASS_RATIO_MAX, STEPS_A_SWING, TRIANGLES_MAX};
pub use failure::FailureRefused;
pub use file_place::{Place, Source};
pub use form::{Form, Frame, Geometry};
pub use outline::{Outline, Surface};
pub use overlap::{OVERLAP_MIN_M, Overlap};
pub use placement::{BodyPose, Placement};
pub use scene::{Inside, ParameterRefused, Scene, SceneError, SceneFault, SceneFaultKind, UnknownFailure};
