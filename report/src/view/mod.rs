//! A scene seen from one of its sides: a still picture of what stands where, as SVG.
//!
//! | module | subject |
//! |---|---|
//! | [`side`] | from where one looks |
//! | `face` | faces on the picture, those behind first |
//! | `hull` | the outline of a convex form |
//! | `picture` | the picture |
//!
//! Faces are drawn from behind to before (painter's algorithm), large ones in parts. Where forms run into each other the
//! order can be wrong; it is a picture to find one's way, not to measure by.
//!
//! Invariants. The same scene gives the same bytes on every machine: arithmetic is limited to the operations that
//! IEEE 754 rounds exactly. No input makes it panic.

mod face;
mod hull;
mod picture;
pub mod side;

pub use picture::picture;
pub use side::Side;

/// A form in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Whose it is; shown to a reader who points at it.
    pub name: String,
    /// Which of the kinds in the legend it is.
    pub kind: usize,
    /// How it is painted, beside its kind.
    pub paint: Paint,
    /// Whether it is but the ground on which the others are: drawn behind them all, as far as the picture reaches.
    pub backdrop: bool,
    pub surface: Surface,
}

/// How a form is painted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Paint {
    /// Red, green and blue, 0 to 255; those of its kind without one.
    pub colour: Option<[f64; 3]>,
    /// How much one sees through it, 0 to 1.
    pub transparent: f64,
}

/// A surface, in world coordinates, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// Plane faces, each with its corners in order, counter-clockwise from outside.
    Faces {
        faces: Vec<Vec<[f64; 3]>>,
        /// Whether the borders between them are drawn.
        edged: bool,
    },
    /// A convex form: the smallest that has these points.
    Convex(Vec<[f64; 3]>),
}

/// A ray of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Ray {
    pub name: String,
    /// Where it begins, m.
    pub from_m: [f64; 3],
    /// Where it ends, m.
    pub to_m: [f64; 3],
}

/// What a picture shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// What stands above it.
    pub title: String,
    /// What the kinds of solids are called.
    pub kinds: Vec<String>,
    pub solids: Vec<Solid>,
    pub rays: Vec<Ray>,
}
