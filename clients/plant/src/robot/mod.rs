//! Robots as their makers publish them: links with masses and shapes, joints between them.
//!
//! | module | subject |
//! |---|---|
//! | `xml` | elements and attributes with their places; faults |
//! | `package` | where `package://` and `$(find …)` lead |
//! | `xacro` | macros, properties and expressions in robots' files |
//! | `inertial` | which mass and inertia a link can have |
//! | `urdf` | the robot of a URDF file |
//! | `mjcf` | the robot of a MuJoCo model |
//! | `tree` | parents before children |
//!
//! What a picture shows, what a controller limits (effort, velocity) and what simulators add is left
//! aside: a scene says these things itself.

mod inertial;
mod mjcf;
mod package;
mod tree;
mod urdf;
mod xacro;
mod xml;

use std::path::Path;
use std::sync::Arc;

pub(crate) use inertial::MASS_MIN_KG;
pub use package::Packages;
pub use xml::RobotFault;

pub use crate::file_place::{Place, Source};

/// A robot: a tree of links, its root first.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// The links; each but the first is the child of a joint whose parent comes before it.
    pub links: Vec<Link>,
    /// The joints, in the order of their children.
    pub joints: Vec<Joint>,
    /// What was read otherwise than it is written, for people.
    pub remarks: Vec<String>,
}

/// A place and an orientation: roll about x, then pitch about y, then yaw about z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Origin {
    pub xyz_m: [f64; 3],
    pub rpy_rad: [f64; 3],
}

#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    pub name: String,
    /// Its mass, none for a mere frame.
    pub inertial: Option<Inertial>,
    pub collisions: Vec<Collision>,
    /// What a picture shows of it: only of use for a mass where nothing else says it.
    pub visuals: Vec<Collision>,
    /// Where it is described.
    pub place: Place,
}

/// Mass and inertia of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertial {
    /// The centre of mass, and the axes of the tensor.
    pub origin: Origin,
    /// The mass, above 0.
    pub mass_kg: f64,
    /// ixx, iyy, izz, ixy, ixz, iyz; none if the file gives none that a body can have.
    pub inertia_kg_m2: Option<[f64; 6]>,
}

/// A shape of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// Where it is on its link.
    pub origin: Origin,
    pub geometry: Geometry,
    /// Whether it collides, or only sensors see it.
    pub collides: bool,
    /// What it weighs, where its link has no mass and the file says so.
    pub weight: Option<Weight>,
    /// Where it is described.
    pub place: Place,
}

/// What a shape weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weight {
    /// So much in all, kg.
    Mass(f64),
    /// So much in each part of its volume, kg/m³.
    Density(f64),
}

impl Weight {
    /// Whether it is as much as a body can have.
    pub fn is_some(self) -> bool {
        match self {
            Self::Mass(mass_kg) => mass_kg >= MASS_MIN_KG,
            Self::Density(density_kg_m3) => density_kg_m3 > 0.0,
        }
    }
}

/// A form, centred on its origin.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    Box([f64; 3]),
    Sphere(f64),
    /// Radius and whole length, along z.
    Cylinder(f64, f64),
    /// Radius and length without the caps, along z.
    Capsule(f64, f64),
    /// A file, and what 1 means in it along each axis.
    Mesh(String, [f64; 3]),
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    Fixed,
    /// Rotation about its axis.
    Turns,
    /// Translation along its axis.
    Slides,
    Rolls,
    /// Everything: it is not a joint.
    Floats,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    pub name: String,
    /// What it leaves free.
    pub freedom: Freedom,
    /// Index of the link that it is measured from.
    pub parent: usize,
    /// Index of the link that it carries.
    pub child: usize,
    /// The child's frame on the parent, when the coordinate is `reference`.
    pub origin: Origin,
    /// The coordinate in the pose of the file, m or rad: MJCF's `ref`, 0 in URDF.
    pub reference: f64,
    /// Where the joint is in the child's frame.
    pub anchor_m: [f64; 3],
    /// Its axis in the child's frame, of any length.
    pub axis: [f64; 3],
    /// Limits of its coordinate, m or rad.
    pub limits: Option<[f64; 2]>,
    /// The joint that it follows.
    pub mimic: Option<Mimic>,
    /// Where it is described.
    pub place: Place,
}

/// A joint that follows another: `factor` times its coordinate, and `offset`, m or rad.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// The other joint's name.
    pub joint: String,
    /// Coordinate of this joint per coordinate of the other.
    pub factor: f64,
    /// m or rad, by the kind of this joint.
    pub offset: f64,
}

/// How a robot's file is read.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'r> {
    /// What the file is called in faults.
    pub file: &'r str,
    pub packages: &'r Packages,
    /// Arguments of a xacro, by name.
    pub arguments: &'r [(String, String)],
}

impl Robot {
    /// The robot of a file: URDF, xacro or MJCF, as its root element and its ending say.
    ///
    /// # Errors
    /// Every fault that was found.
    pub fn read(path: &Path, text: String, reading: &Reading<'_>) -> Result<Self, Vec<RobotFault>> {
        let source = Arc::new(Source { file: reading.file.to_owned(), text: text.into() });
        let root = xml::parse(&source).map_err(|fault| vec![fault])?;
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match root.name.as_str() {
            "mujoco" => mjcf::robot(&root, path, reading),
            _ if ending.as_deref() == Some("xacro") => {
                let expanded = xacro::expand(&root, path, reading).map_err(|fault| vec![fault])?;
                urdf::robot(&expanded)
            }
            _ => urdf::robot(&root),
        }
    }
}
