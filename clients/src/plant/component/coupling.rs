//! What ties a component to the world of rigid bodies: what it sees there, what it does there.

use serde::Serialize;

/// What of the scene a component is bound to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Coupling {
    /// Nothing.
    None,
    /// A prismatic joint that it moves, or nothing: then it moves by itself.
    Slides,
    /// A revolute joint that it turns, or nothing: then it turns by itself.
    Turns,
    /// A joint that it measures.
    Measures,
    /// A kinematic body whose surface it runs.
    Belt,
    /// A ray, carried by a body, that meets other bodies.
    Ray,
    /// A body that dynamic bodies touch, or one shape of it.
    Touch,
    /// A body that other bodies of any kind touch, or one shape of it.
    Contact,
    /// Bodies that may meet each other.
    Meet,
    /// A body that takes out of the world what touches it and is not held.
    Collect,
    /// A body at whose place other bodies appear.
    Place,
}

/// A key that binds a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct BindingKey {
    /// The key.
    pub key: &'static str,
    /// What it names.
    pub about: &'static str,
    /// Whether a component cannot do without it.
    pub needed: bool,
}

const fn needed(key: &'static str, about: &'static str) -> BindingKey {
    BindingKey { key, about, needed: true }
}

const fn optional(key: &'static str, about: &'static str) -> BindingKey {
    BindingKey { key, about, needed: false }
}

impl Coupling {
    /// The keys that bind a component of this coupling.
    pub const fn keys(self) -> &'static [BindingKey] {
        match self {
            Self::None => &[],
            Self::Slides => const { &[optional("joint", "prismatic joint that it moves; by itself if absent")] },
            Self::Turns => const { &[optional("joint", "revolute joint that it turns; by itself if absent")] },
            Self::Measures => const { &[needed("joint", "prismatic, revolute or slot joint that it measures")] },
            Self::Belt => {
                const {
                    &[
                        needed("belt", "kinematic body whose surface runs, while it stays in place itself"),
                        needed("direction", "along which the surface runs, of any length"),
                    ]
                }
            }
            Self::Ray => {
                const {
                    &[
                        optional("body", "body that carries it; the ground if absent"),
                        needed("point_m", "where the ray begins, in world coordinates of the scene's pose"),
                        needed("direction", "of the ray, of any length"),
                        optional("targets", "bodies that are detected; all but the carrier if absent"),
                    ]
                }
            }
            Self::Touch | Self::Contact => {
                const {
                    &[
                        needed("body", "body with a shape, which the targets touch"),
                        optional("shape", "the one of its `[[shape]]`s that counts; all of it if absent"),
                        optional("targets", "bodies that count; all dynamic ones but itself if absent"),
                    ]
                }
            }
            Self::Collect => {
                const {
                    &[
                        needed("body", "body with a shape, which the targets touch"),
                        optional("targets", "bodies that count; all dynamic ones but itself if absent"),
                    ]
                }
            }
            Self::Meet => const { &[optional("targets", "bodies that count; all dynamic ones if absent")] },
            Self::Place => {
                const {
                    &[
                        needed(
                            "body",
                            "body at whose place the targets appear; if it has a shape, only when nothing is in it",
                        ),
                        needed("targets", "dynamic bodies with a shape, out of the world until they appear"),
                    ]
                }
            }
        }
    }
}

/// Coordinate of a joint and its velocity, in m or rad and per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Coordinate {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

/// What a component sees of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    /// The joint that it drives or measures, if any.
    pub(crate) joint: Option<Coordinate>,
    /// How far away the ray meets something, m, if it does.
    pub(crate) hit_m: Option<f64>,
    /// The first of the targets that touches, or that can appear.
    pub(crate) target: Option<u32>,
    /// How many targets touch, or can appear; how many pairs of them meet.
    pub(crate) count: u32,
}

/// What a component does to the world in a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Effect {
    /// Nothing.
    None,
    /// Moves its joint, with an effort up to the greatest, N or N·m.
    Move { from: f64, to: f64, effort_max: f64 },
    /// Runs its belt, m/s.
    Run { velocity_m_s: f64 },
    /// Holds a target fast, by its place among the targets; lets go of any other.
    Hold(Option<u32>),
    /// Takes a target out of the world.
    Remove(u32),
    /// Puts a target into the world.
    Place(u32),
}
