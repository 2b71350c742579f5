//! What every component is: parameters, a state, and two halves of a turn.
//!
//! 1. `drive`: reads the inputs and moves the state by one period, before the world moves.
//! 2. `sense`: looks at the world, after it has moved, and gives the outputs. At the set-up it does
//!    so once with a period of 0.

use onescan_iec_run::RestoreError;
use onescan_server::client::ClientFault;
use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

use super::declare::{Failed, FailureSet, ParameterSet, SignalSet, Value};
use super::dynamics::substeps;
use super::kind::{Dependence, Frames, Kind, Parameter, Setting, Signal};
use crate::coupling::{Coupling, Tie, Unbound};
use crate::effort::{Effort, Motion};
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::World;
use crate::world::coordinate::Measured;
use onescan_stream::{Form, Port};

/// A kind of component, by its equations.
pub(crate) trait Component: Sized + Send + 'static {
    /// What a scene calls it.
    const NAME: &'static str;
    /// What it is, in one line.
    const SUMMARY: &'static str;
    const FORMULA: &'static [&'static str];
    /// Where they come from.
    const SOURCE: &'static str;
    /// Which inputs mean nothing unless another one is driven.
    const DEPENDENCES: &'static [Dependence] = &[];
    /// Which of its signals a scene may bind together.
    const FRAMES: Frames = Frames::NONE;
    /// The parameters that it only begins with, by their keys.
    const INITIAL: &'static [&'static str] = &[];
    /// Whether it has no `drive`, so that it need not look at the world before that has moved.
    const ONLY_SENSES: bool = false;
    /// What describes one of its kind.
    type Parameters: ParameterSet;
    type Inputs: SignalSet + Send;
    type Outputs: SignalSet;
    type Failure: FailureSet;
    /// What ties it to the world.
    type Tie: Tie;
    /// All that it remembers.
    type State: Clone + PartialEq + std::fmt::Debug + Send + Serialize + DeserializeOwned;

    /// A component with these parameters.
    fn new(parameters: Self::Parameters) -> Self;

    /// A conflict between two parameters: the key at fault and what it must be.
    fn conflict(_parameters: &Self::Parameters) -> Option<Conflict> {
        None
    }

    /// Whether an input, by its place in the table, is of use with these parameters.
    fn uses(_parameters: &Self::Parameters, _input: usize) -> bool {
        true
    }

    /// Tells its tie what follows from its parameters: at the set-up, and whenever they change.
    fn arrange(&self, _tie: &mut Self::Tie) {}

    /// Its state at the set-up.
    fn initial(&self, start: &Start<SeenBy<Self>>) -> Self::State;

    /// Moves the state by one period.
    fn drive(&self, _state: &mut Self::State, _inputs: &Self::Inputs, _turn: &Turn<SeenBy<Self>>) {}

    /// The longest sub-step of its equations on a joint, s.
    fn longest_s(&self) -> f64 {
        f64::INFINITY
    }

    /// The way that its own stops leave to a joint, m or rad.
    fn stops(&self) -> Option<[f64; 2]> {
        None
    }

    /// Moves the state by a sub-step in which its joint moves so; what it exerts on the joint. A
    /// component that drives a joint has its equations here; without a joint, in [`drive`](Self::drive).
    fn advance(
        &self,
        _state: &mut Self::State,
        _inputs: &Self::Inputs,
        _turn: &Turn<SeenBy<Self>>,
        _motion: Motion,
        _dt_s: f64,
    ) -> Effort {
        Effort::of(0.0)
    }

    /// What it does to the world in the period that `drive` has begun.
    fn effect(&self, state: &Self::State) -> EffectOf<Self>;

    /// How its ports send: one for each of its inputs and outputs that are lines of bytes, in their order.
    fn ports(&self) -> Vec<Form> {
        Vec::new()
    }

    /// Receives and sends at its ports, after the world has moved and before it is looked at; not at the set-up.
    fn talk(&self, _state: &mut Self::State, _inputs: &Self::Inputs, _turn: &Turn<SeenBy<Self>>, _talk: &mut Talk<'_>) {
    }

    /// Looks at the world and says what there is.
    fn sense(&self, state: &mut Self::State, inputs: &Self::Inputs, turn: &Turn<SeenBy<Self>>) -> Self::Outputs;
}

/// What a component sees of the world.
pub(crate) type SeenBy<C> = <<C as Component>::Tie as Tie>::Seen;
/// What a component does to the world.
pub(crate) type EffectOf<C> = <<C as Component>::Tie as Tie>::Effect;

/// A parameter that does not go with another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Conflict {
    pub(crate) key: &'static str,
    pub(crate) wanted: &'static str,
}

/// What a component begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Start<Seen = ()> {
    /// What it sees of the world in the scene's pose.
    pub(crate) seen: Seen,
    /// A seed of its own, from the scenario's.
    pub(crate) seed: u64,
}

/// The circumstances of a half turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Turn<Seen = ()> {
    /// The period, s; 0 at the set-up.
    pub(crate) dt_s: f64,
    /// What it sees of the world.
    pub(crate) seen: Seen,
    pub(crate) failed: Failed,
}

/// The ports of a component in a turn.
pub(crate) struct Talk<'p> {
    /// Virtual time at the end of the turn, ns: what is sent goes on its way now.
    pub(crate) now_ns: u64,
    /// Its ports, in the order of its lines.
    pub(crate) ports: &'p mut [Port],
}

/// What surrounds a component of any kind in a half turn.
#[derive(Clone, Copy)]
pub(crate) struct Surroundings<'s> {
    /// Virtual time at the end of the turn, ns.
    pub(crate) t_v_ns: u64,
    /// The period, s; 0 at the set-up.
    pub(crate) dt_s: f64,
    pub(crate) measured: Measured<'s>,
    pub(crate) failed: Failed,
}

/// A component of any kind, with its state and its tie to the world.
pub(crate) trait Running: Send {
    /// First half of a turn; what the component then does to the world is done.
    fn drive(&mut self, inputs: &[Value], around: &Surroundings<'_>, world: &mut World) -> Result<(), ClientFault>;
    /// Second half of a turn.
    fn sense(&mut self, inputs: &[Value], around: &Surroundings<'_>, world: &World, outputs: &mut Vec<Value>);
    /// How its ports send.
    fn ports(&self) -> Vec<Form> {
        Vec::new()
    }
    /// Receives and sends at its ports.
    fn talk(&mut self, _inputs: &[Value], _around: &Surroundings<'_>, _world: &World, _ports: &mut [Port]) {}
    /// The number of the drive that it is, if it drives a joint by its own equations.
    fn drive_number(&self) -> Option<usize>;
    /// The longest sub-step of its equations, s.
    fn longest_s(&self) -> f64;
    /// Moves the state by a sub-step in which its joint moves so.
    fn advance(&mut self, motion: Motion, dt_s: f64) -> Effort;
    /// What it would exert at the end of a step in which its joint moves so; the state stays.
    fn foresee(&self, motion: Motion, dt_s: f64) -> Effort;
    /// Takes other values of its parameters, one for each, and keeps its state.
    ///
    /// # Errors
    /// A component that is compiled with its parameters.
    fn tune(&mut self, settings: &[Setting]) -> Result<(), Compiled>;
    /// The state as bytes.
    fn save(&self) -> postcard::Result<Vec<u8>>;
    /// Checks that bytes are a state of such a component.
    fn check(&self, bytes: &[u8]) -> Result<(), StateError>;
    /// Takes the state in that [`check`](Self::check) accepts.
    fn restore(&mut self, bytes: &[u8]) -> Result<(), StateError>;
}

/// A component's parameters are compiled with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("its parameters are constants of its program")]
pub(crate) struct Compiled;

/// What the world is built with, of some parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Built {
    /// The way that the component's own stops leave to a joint, m or rad.
    pub(crate) stops: Option<[f64; 2]>,
    /// How its ports send.
    pub(crate) ports: Vec<Form>,
}

/// Why bytes are not the state of a component.
#[derive(Debug, Error)]
pub(crate) enum StateError {
    #[error(transparent)]
    Form(#[from] postcard::Error),
    #[error(transparent)]
    Program(#[from] RestoreError),
}

/// A component with its state and its tie to the world.
struct Runner<C: Component> {
    component: C,
    state: C::State,
    tie: C::Tie,
    /// What it takes and sees in the turn that goes on.
    turn: Option<(C::Inputs, Turn<SeenBy<C>>)>,
}

/// What a [`Runner`] remembers.
type Memory<C> = (<C as Component>::State, <<C as Component>::Tie as Tie>::Memory);

/// Ties a component to a world that still stands in the scene's pose.
///
/// # Errors
/// A binding that is not one of the component's coupling.
pub(super) fn run<C: Component>(
    component: C,
    seed: u64,
    bound: &Bound,
    scene: &Mechanics,
    world: &mut World,
) -> Result<Box<dyn Running>, Unbound> {
    let mut tie = C::Tie::bind(bound, scene, world)?;
    component.arrange(&mut tie);
    let state = component.initial(&Start { seen: tie.at_start(), seed });
    if let (Some(stops), Some(driven)) = (component.stops(), tie.driven()) {
        world.restrict(driven.joint, stops);
    }
    Ok(Box::new(Runner { component, state, tie, turn: None }))
}

impl<C: Component> Runner<C> {
    fn turn(&self, around: &Surroundings<'_>, world: &World) -> Turn<SeenBy<C>> {
        let Surroundings { dt_s, measured, failed, .. } = *around;
        Turn { dt_s, seen: self.tie.see(measured, world), failed }
    }
}

impl<C: Component> Running for Runner<C> {
    fn drive(&mut self, inputs: &[Value], around: &Surroundings<'_>, world: &mut World) -> Result<(), ClientFault> {
        if !C::ONLY_SENSES {
            let turn = self.turn(around, world);
            let inputs = C::Inputs::read(inputs);
            self.component.drive(&mut self.state, &inputs, &turn);
            self.turn = Some((inputs, turn));
        }
        let effect = self.component.effect(&self.state);
        self.tie.apply(effect, around.measured, around.dt_s, world)
    }

    fn sense(&mut self, inputs: &[Value], around: &Surroundings<'_>, world: &World, outputs: &mut Vec<Value>) {
        let turn = self.turn(around, world);
        self.component.sense(&mut self.state, &C::Inputs::read(inputs), &turn).write(outputs);
    }

    fn ports(&self) -> Vec<Form> {
        self.component.ports()
    }

    fn talk(&mut self, inputs: &[Value], around: &Surroundings<'_>, world: &World, ports: &mut [Port]) {
        let (turn, inputs) = (self.turn(around, world), C::Inputs::read(inputs));
        let mut talk = Talk { now_ns: around.t_v_ns, ports };
        self.component.talk(&mut self.state, &inputs, &turn, &mut talk);
    }

    fn drive_number(&self) -> Option<usize> {
        self.tie.driven().map(|driven| driven.drive)
    }

    fn longest_s(&self) -> f64 {
        self.component.longest_s()
    }

    fn advance(&mut self, motion: Motion, dt_s: f64) -> Effort {
        let Self { component, state, turn, .. } = self;
        turn.as_ref().map_or(Effort::of(0.0), |(inputs, turn)| component.advance(state, inputs, turn, motion, dt_s))
    }

    fn foresee(&self, motion: Motion, dt_s: f64) -> Effort {
        let Some((inputs, turn)) = &self.turn else { return Effort::of(0.0) };
        let mut state = self.state.clone();
        let (count, part_s) = substeps(dt_s, self.component.longest_s());
        let mut effort = Effort::of(0.0);
        for index in 0..count {
            let position = motion.position + motion.velocity * part_s * f64::from(index);
            effort = self.component.advance(&mut state, inputs, turn, Motion { position, ..motion }, part_s);
        }
        effort
    }

    fn tune(&mut self, settings: &[Setting]) -> Result<(), Compiled> {
        self.component = C::new(C::Parameters::read(settings));
        self.component.arrange(&mut self.tie);
        Ok(())
    }

    fn save(&self) -> postcard::Result<Vec<u8>> {
        postcard::to_stdvec(&(&self.state, self.tie.memory()))
    }

    fn check(&self, bytes: &[u8]) -> Result<(), StateError> {
        Ok(postcard::from_bytes::<Memory<C>>(bytes).map(|_| ())?)
    }

    fn restore(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let (state, tie) = postcard::from_bytes::<Memory<C>>(bytes)?;
        self.state = state;
        self.tie.restore(tie);
        Ok(())
    }
}

/// The data of a kind.
pub(super) fn kind<C: Component>() -> Kind {
    Kind {
        name: C::NAME.into(),
        summary: C::SUMMARY.into(),
        formula: C::FORMULA,
        source: C::SOURCE.into(),
        coupling: Coupling::of::<C::Tie>(),
        parameters: parameters::<C>(),
        inputs: inputs::<C>(),
        outputs: C::Outputs::table(),
        dependences: C::DEPENDENCES,
        frames: C::FRAMES,
        failures: C::Failure::table(),
    }
}

/// The parameters of a kind.
fn parameters<C: Component>() -> Vec<Parameter> {
    let is_initial = |key: &str| C::INITIAL.contains(&key);
    let all = C::Parameters::table().into_iter();
    all.map(|parameter| Parameter { initial: is_initial(&parameter.key), ..parameter }).collect()
}

/// The inputs of a kind, with what they are if nobody drives them.
fn inputs<C: Component>() -> Vec<Signal> {
    let presets = C::Inputs::unconnected().into_iter().map(Value::setting);
    C::Inputs::table().into_iter().zip(presets).map(|(input, preset)| Signal { preset, ..input }).collect()
}
