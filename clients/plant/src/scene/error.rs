//! What can be wrong with a scene file, each fault with its place and a hint.

use std::fmt;

use onescan_server::client::SourcePlace;
use onescan_server::signal::BadName;
use thiserror::Error;

use crate::component::kind::Text;
use crate::file_place::Place;
use onescan_base::array::ArrayError;

/// Why a scene file is not a scene.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{file}: cannot be read: {cause}")]
    Unreadable {
        /// The file, as it was asked for.
        file: String,
        /// What the operating system says.
        cause: String,
    },
    /// The file was read and is wrong: every fault that was found, in the file's order.
    #[error("{}", lines(.0))]
    Faulty(Vec<SceneFault>),
}

impl SceneError {
    /// The faults in the file, in the file's order; none if it cannot be read.
    pub fn faults(&self) -> &[SceneFault] {
        match self {
            Self::Unreadable { .. } => &[],
            Self::Faulty(faults) => faults,
        }
    }
}

fn lines(faults: &[SceneFault]) -> String {
    faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// One thing that is wrong in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFault {
    pub kind: SceneFaultKind,
    /// Where it is wrong.
    pub place: SourcePlace,
    /// The bytes of the file that are wrong, for a reader that underlines them.
    pub span: std::ops::Range<usize>,
    /// What the user could do.
    pub hint: Option<String>,
    /// The place in another file that the scene names, where the fault is that file's.
    pub inside: Option<Inside>,
    /// Which of the overrides is at fault, from 0; nothing if the file itself is. `span` then lies
    /// behind the text.
    pub overridden: Option<usize>,
}

/// A fault in a file that a scene names.
#[derive(Clone, Debug, PartialEq)]
pub struct Inside {
    /// What is wrong, for a reader who sees the place.
    pub reported: String,
    pub place: Place,
}

impl fmt::Display for SceneFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.kind)?;
        match &self.hint {
            Some(hint) => write!(f, " ({hint})"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for SceneFault {}

/// The things of a scene that have names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Thing {
    Body,
    Shape,
    Joint,
    /// `[[fitting]]`, by its joint
    Fitting,
    Coupling,
    Axis,
    Sensor,
    Component,
    /// A signal that the plant writes.
    Signal,
}

impl fmt::Display for Thing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Body => "body",
            Self::Shape => "shape",
            Self::Joint => "joint",
            Self::Fitting => "fitting",
            Self::Coupling => "coupling",
            Self::Axis => "axis",
            Self::Sensor => "sensor",
            Self::Component => "component",
            Self::Signal => "signal",
        })
    }
}

/// The kinds of fault in a scene file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneFaultKind {
    /// An override of something that the scene does not have.
    #[error("the scene has nothing called `{0}`")]
    Nothing(String),
    /// An override that may mean two things.
    #[error("`{name}` may be a {one} or a {other} of the scene")]
    Ambiguous { name: String, one: &'static str, other: &'static str },
    /// Not TOML, an unknown key, a missing key or a value of the wrong type.
    #[error("{0}")]
    Form(String),
    /// A version of the format that this program does not read.
    #[error("scene format version {0} is not known")]
    Version(i64),
    /// A name that was given before.
    #[error("{thing} `{name}` is named twice; first at {first}")]
    Doubled {
        thing: Thing,
        name: String,
        /// Where it was named first.
        first: SourcePlace,
    },
    /// A name that the scene reserves.
    #[error("`{0}` is reserved for the world itself and cannot name a body")]
    Reserved(String),
    /// A name that nothing in the scene has.
    #[error("no {thing} `{name}` in this scene")]
    Unknown {
        /// What was looked for.
        thing: Thing,
        /// The name that was looked for.
        name: String,
    },
    /// A range in a name that stands for nothing.
    #[error(transparent)]
    Array(ArrayError),
    /// A mesh that cannot be used.
    #[error("mesh `{file}` {cause}")]
    Mesh {
        file: String,
        /// What is wrong with it.
        cause: String,
    },
    /// A robot that cannot be used.
    #[error("robot `{file}` {cause}")]
    Urdf {
        file: String,
        /// What is wrong with it.
        cause: String,
    },
    /// A surface without an inside, where a body has to have one.
    #[error("{0} is of a dynamic body and needs its hull: only what no force moves can be a mere surface")]
    OpenSurface(String),
    /// A shape of another body.
    #[error("shape `{shape}` is none of body `{body}`")]
    ForeignShape { shape: String, body: String },
    /// A text that cannot name a signal.
    #[error(transparent)]
    SignalName(#[from] BadName),
    /// A number outside of what the key allows.
    #[error("`{key}` must be {wanted}, not {value}")]
    Number {
        key: Text,
        wanted: String,
        /// The value in the file.
        value: String,
    },
    /// A key that is needed here.
    #[error("{whose} needs `{key}`")]
    Missing { whose: String, key: &'static str },
    /// A key that means nothing here.
    #[error("{whose} has no `{key}`")]
    Misplaced {
        /// What does not have it.
        whose: String,
        key: &'static str,
    },
    /// A dynamic body with no or two statements of its mass.
    #[error("dynamic body `{0}` needs either `mass_kg` or `density_kg_m3`")]
    Mass(String),
    /// A joint whose two bodies are one.
    #[error("joint `{0}` joins a body with itself")]
    SelfJoined(String),
    /// A joint whose two bodies cannot be moved by it.
    #[error("joint `{0}` joins two bodies that no force moves")]
    Immovable(String),
    /// Something but an axis that is to act on a joint of a robot without dynamics.
    #[error("joint `{0}` is one of a kinematic robot, on which no force acts")]
    Guided(String),
    /// A slot whose slide is not across its axis.
    #[error("`slide` of slot `{0}` is not at a right angle to its `axis`")]
    Oblique(String),
    /// A lower bound above the upper one.
    #[error("`{lower}` is above `{upper}`")]
    Order {
        /// Key of the lower bound.
        lower: &'static str,
        /// Key of the upper bound.
        upper: &'static str,
    },
    /// An axis on a joint that cannot be driven.
    #[error("`{joint}` is a {kind} joint and cannot be driven")]
    Undrivable { joint: String, kind: &'static str },
    /// An end-position sensor on a joint without a coordinate.
    #[error("`{joint}` is a {kind} joint and has no position")]
    Unmeasurable { joint: String, kind: &'static str },
    /// A joint with two fittings.
    #[error("joint `{name}` has fitting `{first}` already")]
    FittedTwice { name: String, first: String },
    /// A joint or a belt that two axes drive.
    #[error("{thing} `{name}` is driven twice; first by {first}")]
    DrivenTwice {
        thing: Thing,
        /// The joint, or the belt's body.
        name: String,
        /// The axis or component that drives it already.
        first: String,
    },
    /// A component of a kind that is neither in the library nor in the scene's own.
    #[error("`{0}` is not a kind of component")]
    ComponentKind(String),
    /// A kind of the user's own that cannot be used.
    #[error("kind `{kind}`: {cause}")]
    OwnKind {
        kind: String,
        /// What is wrong with it, or with its file.
        cause: String,
    },
    /// A folder of kinds that cannot be used.
    #[error("the folder of kinds `{folder}` {cause}")]
    Kinds {
        folder: String,
        /// What is wrong with it.
        cause: String,
    },
    /// A key that this kind of component has not.
    #[error("{whose} has no `{key}`")]
    ComponentKey { whose: String, key: String },
    /// A key that must name something.
    #[error("`{key}` must be {wanted}")]
    Text {
        key: String,
        /// What it must be.
        wanted: &'static str,
    },
    /// Something that a component has not: an output, a failure mode.
    #[error("component `{component}` has no {what} `{name}`")]
    ComponentPart {
        component: String,
        /// What was looked for.
        what: &'static str,
        name: String,
    },
    /// An input that is wired to an output of other values.
    #[error("`{output}` is {is}, but `{key}` takes {wanted}")]
    WireType {
        output: String,
        is: String,
        /// The key of the input.
        key: String,
        /// The values of the input.
        wanted: String,
    },
    /// An input with two sources.
    #[error("{whose} has two sources for `{input}`")]
    WiredTwice { whose: String, input: String },
    /// An input that is driven and of which nothing comes.
    #[error("nothing comes of `{key}`: nobody drives `{on}` of {whose}")]
    Idle {
        whose: String,
        /// The key that drives the input.
        key: String,
        /// What it depends on.
        on: String,
    },
    /// A body without a shape, where one is needed.
    #[error("body `{0}` has no shape, and nothing can touch it")]
    Shapeless(String),
    /// A body that is not dynamic, where one is needed.
    #[error("body `{0}` is not dynamic")]
    NotDynamic(String),
    /// A failure with both a signal and times.
    #[error("a failure follows either a `signal` or times, not both")]
    FailureTwice,
    /// A signal that the plant neither reads nor writes.
    #[error("the plant neither reads nor writes a signal `{0}`")]
    ForeignSignal(String),
    /// A key of a `[[signal]]` that a signal of this type cannot have.
    #[error("signal `{name}` is {ty} and has no `{key}`")]
    SignalKey { name: String, ty: String, key: &'static str },
    /// An axis that drives nothing, or two things at once.
    #[error("axis `{0}` needs either a `joint` or a `belt`")]
    Undriven(String),
    /// A belt that is not a kinematic body.
    #[error("body `{0}` is not kinematic and cannot be a belt")]
    NotKinematic(String),
    /// A signal that is read as two types.
    #[error("signal `{0}` is read both as BOOL and as a number, or as two number types")]
    SignalType(String),
    /// A signal that the plant would both read and write.
    #[error("the plant writes signal `{0}` itself and cannot also be commanded by it")]
    OwnSignal(String),
    /// More collision groups than there are bits.
    #[error("group `{0}` is one too many: a scene has at most {max} groups", max = crate::model::GROUPS_MAX)]
    Groups(String),
}
