//! The kind that a component is of, with what makes one of it: one of the library's, or one of the user's own.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use onescan_server::time::TimeSpan;
use serde::{Serialize, Serializer};
use thiserror::Error;

use super::behaviour::{Built, Conflict, Running};
use super::declare::Value;
use super::kind::{Kind, Setting};
use super::library::{ENTRIES, Entry, kinds};
use super::program::{Program, ProgramError};
use crate::coupling::Unbound;
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::World;

/// A kind, which it dereferences to, and what makes components of it.
#[derive(Clone)]
pub struct Origin(Source);

#[derive(Clone)]
enum Source {
    Library { entry: &'static Entry, kind: &'static Kind },
    Program(Arc<Program>),
}

/// What a component is made with, beside its settings.
pub(crate) struct Making<'m> {
    /// A seed of its own.
    pub(crate) seed: u64,
    /// What it is bound to.
    pub(crate) bound: &'m Bound,
    pub(crate) scene: &'m Mechanics,
    /// How long its turns are.
    pub(crate) period: TimeSpan,
}

/// Why no component can be made; no checked scene is the cause.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum Unmade {
    #[error(transparent)]
    Unbound(#[from] Unbound),
    #[error(transparent)]
    Program(#[from] ProgramError),
}

impl Origin {
    /// The kind of the library of this name.
    pub(crate) fn of_library(name: &str) -> Option<Self> {
        let mut known = ENTRIES.iter().zip(kinds());
        known.find(|(entry, _)| entry.name == name).map(|(entry, kind)| Self(Source::Library { entry, kind }))
    }

    pub(crate) fn program(program: Arc<Program>) -> Self {
        Self(Source::Program(program))
    }

    /// A digest of the source of a kind of the user's own.
    pub fn code(&self) -> Option<&str> {
        match &self.0 {
            Source::Library { .. } => None,
            Source::Program(program) => Some(program.code()),
        }
    }

    /// The kind as it is with these settings, one for each parameter.
    ///
    /// # Errors
    /// A program that does not compile with them.
    pub(crate) fn settled(self, settings: &[Setting]) -> Result<Self, ProgramError> {
        match &self.0 {
            Source::Library { .. } => Ok(self),
            Source::Program(program) => Ok(Self::program(program.settled(settings)?)),
        }
    }

    /// A conflict between settings, one for each parameter.
    pub(crate) fn conflict(&self, settings: &[Setting]) -> Option<Conflict> {
        match &self.0 {
            Source::Library { entry, .. } => (entry.conflict)(settings),
            Source::Program(_) => None,
        }
    }

    /// Whether an input, by its place, is of use with these settings.
    pub(crate) fn uses(&self, settings: &[Setting], input: usize) -> bool {
        match &self.0 {
            Source::Library { entry, .. } => (entry.uses)(settings, input),
            Source::Program(_) => true,
        }
    }

    /// Whether it is of the user's own, and its parameters are constants of its program.
    pub(crate) fn is_program(&self) -> bool {
        matches!(self.0, Source::Program(_))
    }

    /// What the world is built with, of these settings.
    pub(crate) fn built(&self, settings: &[Setting]) -> Built {
        match &self.0 {
            Source::Library { entry, .. } => (entry.built)(settings),
            Source::Program(_) => Built::default(),
        }
    }

    /// What its inputs hold where nothing is connected.
    pub(crate) fn unconnected(&self) -> Vec<Value> {
        match &self.0 {
            Source::Library { entry, .. } => (entry.unconnected)(),
            Source::Program(program) => program.unconnected(),
        }
    }

    /// A component with these settings, one for each parameter, in a world that still stands in the scene's pose.
    pub(crate) fn make(
        &self,
        settings: &[Setting],
        making: &Making<'_>,
        world: &mut World,
    ) -> Result<Box<dyn Running>, Unmade> {
        match &self.0 {
            Source::Library { entry, .. } => {
                Ok((entry.start)(settings, making.seed, making.bound, making.scene, world)?)
            }
            Source::Program(program) => Ok(program.start(making.period)?),
        }
    }
}

impl Deref for Origin {
    type Target = Kind;

    fn deref(&self) -> &Kind {
        match &self.0 {
            Source::Library { kind, .. } => kind,
            Source::Program(program) => program.kind(),
        }
    }
}

impl fmt::Debug for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// Kinds are equal by name, and by their source where that is the user's.
impl PartialEq for Origin {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.code() == other.code()
    }
}

impl Serialize for Origin {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.name)
    }
}
