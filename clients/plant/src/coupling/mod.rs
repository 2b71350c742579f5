//! What ties a component to the world of rigid bodies, a coupling a file: the keys that a scene binds
//! it with, what it sees of the world, what it does there.
//!
//! | module | subject |
//! |---|---|
//! | `joint` | moves a joint, or measures it |
//! | `belt` | runs the surface of a body |
//! | `path` | moves joints along paths, and sees the force that this takes |
//! | `ray` | meets bodies along a line |
//! | `curtain` | meets bodies along lines beside each other |
//! | `touch` | is touched by bodies |
//! | `hold` | is touched by bodies, and holds one as long as its force suffices |
//! | `field` | is a field that bodies are in |
//! | `tag` | reads and writes the tags of bodies in its field |
//! | `press` | is pressed on by bodies |
//! | `motion` | sees how a body moves |
//! | `meet` | counts pairs of bodies in contact |
//! | `collect` | takes bodies out of the world |
//! | `place` | puts bodies into the world |
//! | `surface` | heats or bends the surface of a body, or looks at its temperature |
//!
//! # Invariants
//! - A component names its coupling as a type. It gets that coupling's sight and gives its effect;
//!   those of another do not compile.
//! - A new coupling is a file here. The reader of scenes and the schema know couplings by their keys
//!   only.

use std::fmt;

use onescan_server::client::ClientFault;
use rapier3d::prelude::RigidBodyHandle;
use serde::de::DeserializeOwned;
use serde::{Serialize, Serializer};
use thiserror::Error;

use super::model::Mechanics;
use super::model::{Bound, JointKind};
use super::world::coordinate::Measured;
use super::world::{Sought, Surface, World};

mod belt;
mod collect;
mod curtain;
mod field;
mod hold;
mod joint;
mod meet;
mod motion;
mod path;
mod place;
mod press;
mod ray;
mod surface;
mod tag;
mod touch;

pub(crate) use belt::{Belt, Run};
pub(crate) use collect::{Collect, Remove};
pub(crate) use curtain::{Beams, Curtain, Interrupted};
pub(crate) use field::{Field, InField};
pub(crate) use hold::{Grasp, Hold, Holds, Load};
pub(crate) use joint::{Coordinate, Follow, Indexes, Measures, Slides, Turns};
pub(crate) use meet::Meet;
pub(crate) use motion::{Motion, Moving};
pub(crate) use path::{Carried, Lifts, Stores};
pub(crate) use place::{Place, Put};
pub(crate) use press::{Pressing, Weighs};
pub(crate) use ray::{Hit, Ray};
pub(crate) use surface::{Bends, Heats, SeesHeat};
pub(crate) use tag::{InTags, Tags, WriteTag};
pub(crate) use touch::{Contact, Touch};

/// The bodies that a component meets, in words.
fn others(bound: &Bound) -> String {
    match bound.targets.len() {
        1 => "1 other".to_owned(),
        count => format!("{count} others"),
    }
}

/// A key that binds a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BindingKey {
    /// The key.
    pub key: &'static str,
    /// What it names, for people.
    pub about: &'static str,
    /// What it names, for the reader of scenes.
    pub names: Names,
    /// Whether a component cannot do without it.
    pub needed: bool,
}

/// What a binding key may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Names {
    /// A joint of one kind, which nothing else drives.
    DrivenJoint(JointKind),
    /// One more joint of one kind, which nothing else drives.
    DrivenBeside(JointKind),
    /// A joint that has a coordinate.
    MeasuredJoint,
    /// A kinematic body, which nothing else drives.
    Belt,
    /// A body of any kind, or the ground.
    Carrier,
    /// A body of any kind.
    Body,
    /// A body with a shape, which may also be the `shape` beside it.
    TouchedBody,
    /// One of the shapes of the `body` beside it.
    ShapeOfBody,
    /// Three numbers, not all 0.
    Direction,
    /// Three numbers, of which the part across the `direction` before it counts and is not 0.
    Along,
    /// Three numbers, m.
    Point,
    /// Bodies other than the `body` beside the key.
    Bodies {
        /// Which of them it may name.
        named: Which,
        /// Which of them it stands for if it is absent.
        absent: Which,
    },
}

/// Some of the bodies of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// Bodies of every kind.
    Any,
    /// Bodies that forces move.
    Dynamic,
}

const fn needed(key: &'static str, names: Names, about: &'static str) -> BindingKey {
    BindingKey { key, about, names, needed: true }
}

const fn optional(key: &'static str, names: Names, about: &'static str) -> BindingKey {
    BindingKey { key, about, names, needed: false }
}

/// A coupling as plain data: for the reader of scenes, for people, for the schema.
#[derive(Clone, Copy)]
pub struct Coupling {
    name: &'static str,
    keys: &'static [BindingKey],
    in_words: fn(&Bound, &Mechanics) -> String,
    targets_wait: bool,
}

impl Coupling {
    /// The keys that bind a component of this coupling.
    pub const fn keys(&self) -> &'static [BindingKey] {
        self.keys
    }

    /// What a component is bound to, for people; empty if it is bound to nothing.
    pub fn in_words(&self, bound: &Bound, scene: &Mechanics) -> String {
        (self.in_words)(bound, scene)
    }

    /// Whether what it names as `targets` is out of the world at the start.
    pub(crate) const fn targets_wait(&self) -> bool {
        self.targets_wait
    }

    /// The data of a tie.
    pub(crate) const fn of<T: Tie>() -> Self {
        Self { name: T::NAME, keys: T::KEYS, in_words: T::in_words, targets_wait: T::TARGETS_WAIT }
    }
}

impl PartialEq for Coupling {
    fn eq(&self, other: &Self) -> bool {
        (self.name, self.keys) == (other.name, other.keys)
    }
}

impl fmt::Debug for Coupling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl Serialize for Coupling {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

/// A component's tie to the world.
pub(crate) trait Tie: Sized + Send + 'static {
    /// What `onescan components` calls the coupling.
    const NAME: &'static str;
    /// The keys that a scene binds it with; a `body` stands before what refers to it.
    const KEYS: &'static [BindingKey];
    /// Whether its targets are out of the world until it puts them in.
    const TARGETS_WAIT: bool = false;

    /// What a component sees of the world.
    type Seen: Copy + fmt::Debug + Default + PartialEq + Send;
    /// What a component does to the world in a period.
    type Effect: Copy + fmt::Debug + PartialEq;
    /// What the tie itself remembers.
    type Memory: Copy + fmt::Debug + PartialEq + Send + Serialize + DeserializeOwned;

    /// Ties a component in a world that still stands in the scene's pose.
    ///
    /// # Errors
    /// A binding that lacks what the keys ask for, which no checked scene has.
    fn bind(bound: &Bound, scene: &Mechanics, world: &mut World) -> Result<Self, Unbound>;

    /// What a component sees before the first half turn.
    fn at_start(&self) -> Self::Seen {
        Self::Seen::default()
    }

    /// What a component sees now.
    fn see(&self, measured: Measured<'_>, world: &World) -> Self::Seen;

    /// The joint that a component drives by its own equations.
    fn driven(&self) -> Option<DrivenJoint> {
        None
    }

    /// Does what a component does in the period of `dt_s` that begins.
    ///
    /// # Errors
    /// Something that the world does not have, which no component of a checked scene causes.
    fn apply(
        &mut self,
        effect: Self::Effect,
        measured: Measured<'_>,
        dt_s: f64,
        world: &mut World,
    ) -> Result<(), ClientFault>;

    /// What the tie remembers.
    fn memory(&self) -> Self::Memory;

    /// Takes in what such a tie remembered.
    fn restore(&mut self, memory: Self::Memory);

    /// What a component is bound to, for people.
    fn in_words(bound: &Bound, scene: &Mechanics) -> String;
}

/// A joint, by its index in the scene, and the number of the drive that moves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DrivenJoint {
    pub(crate) joint: usize,
    pub(crate) drive: usize,
}

/// A binding without what its coupling needs.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("it is bound to no {0}")]
pub(crate) struct Unbound(&'static str);

/// What a binding has to have.
fn wanted<T>(found: Option<T>, what: &'static str) -> Result<T, Unbound> {
    found.ok_or(Unbound(what))
}

/// A tie that remembers nothing and does nothing to the world, as a sensor's.
macro_rules! without_effect {
    () => {
        type Effect = ();
        type Memory = ();

        fn apply(&mut self, (): (), _: Measured<'_>, _: f64, _: &mut World) -> Result<(), ClientFault> {
            Ok(())
        }

        fn memory(&self) {}

        fn restore(&mut self, (): ()) {}
    };
}
use without_effect;

/// No tie: the component neither sees nor does anything in the world.
pub(crate) struct Nothing;

impl Tie for Nothing {
    const NAME: &'static str = "none";
    const KEYS: &'static [BindingKey] = &[];
    type Seen = ();
    without_effect!();

    fn bind(_: &Bound, _: &Mechanics, _: &mut World) -> Result<Self, Unbound> {
        Ok(Self)
    }

    fn see(&self, _: Measured<'_>, _: &World) {}

    fn in_words(_: &Bound, _: &Mechanics) -> String {
        String::new()
    }
}

/// What is seen of several bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Targets {
    /// The first of them, by its place among the targets, to which something applies.
    pub(crate) first: Option<u32>,
    /// To how many it applies.
    pub(crate) count: u32,
}

impl Targets {
    /// Those that touch a surface and for which something more applies.
    fn touching(world: &World, surface: Surface, sought: &Sought, more: impl Fn(RigidBodyHandle) -> bool) -> Self {
        let mut seen = Self::default();
        let Some(ball) = world.ball_around(surface) else { return seen };
        world.each_near(&ball, sought, |place, target| {
            if world.touch(surface, target) && more(target) {
                seen.note(place);
            }
        });
        seen
    }

    /// It applies to one more, in whatever order they are found.
    fn note(&mut self, place: u32) {
        self.count += 1;
        self.first = Some(self.first.map_or(place, |first| first.min(place)));
    }
}

/// The targets of a binding, as a sensor looks for them.
fn sought(world: &mut World, indices: &[usize]) -> Sought {
    let handles = handles(world, indices);
    world.seek(handles)
}

fn handles(world: &World, indices: &[usize]) -> Vec<RigidBodyHandle> {
    indices.iter().map(|index| world.handle(Some(*index))).collect()
}

/// The target that a component means by its place among the targets.
fn target(targets: &[RigidBodyHandle], place: u32) -> Result<RigidBodyHandle, ClientFault> {
    let found = targets.get(place as usize).copied();
    found.ok_or_else(|| ClientFault::new(format!("target {place} of {} does not exist", targets.len())))
}
