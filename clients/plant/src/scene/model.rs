//! A checked scene: the mechanics, the components, and the signals of both.

use std::ops::Deref;
use std::path::PathBuf;

use onescan_server::signal::Port;
use serde::Serialize;

use super::own::Aliases;

pub use crate::component::instance::{Between, Component, FailureSwitch, When, Wire};
pub use crate::model::*;

/// A scene that can be built.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// What the world of rigid bodies is built from; a scene dereferences to it.
    #[serde(flatten)]
    pub(crate) mechanics: Mechanics,
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

impl Deref for Scene {
    type Target = Mechanics;

    fn deref(&self) -> &Mechanics {
        &self.mechanics
    }
}
