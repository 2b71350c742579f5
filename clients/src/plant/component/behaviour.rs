//! What every component is: parameters, a state, and two halves of a turn.
//!
//! 1. `drive`: reads the inputs and moves the state by one period, before the world moves.
//! 2. `sense`: looks at the world, after it has moved, and gives the outputs. At the set-up it does
//!    so once with a period of 0.

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::coupling::{Coordinate, Coupling, Effect, Seen};
use super::declare::{Failed, FailureSet, ParameterSet, SignalSet, Value};
use super::kind::Kind;

/// A kind of component, by its equations.
pub(crate) trait Component: Sized + Send + 'static {
    /// What a scene calls it.
    const NAME: &'static str;
    /// What it is, in one line.
    const SUMMARY: &'static str;
    /// Its equations.
    const FORMULA: &'static [&'static str];
    /// Where they come from.
    const SOURCE: &'static str;
    /// What of the scene it is bound to.
    const COUPLING: Coupling = Coupling::None;

    /// What describes one of its kind.
    type Parameters: ParameterSet;
    /// What it takes.
    type Inputs: SignalSet;
    /// What it gives.
    type Outputs: SignalSet;
    /// How it fails.
    type Failure: FailureSet;
    /// All that it remembers.
    type State: Clone + PartialEq + std::fmt::Debug + Send + Serialize + DeserializeOwned;

    /// A component with these parameters.
    fn new(parameters: Self::Parameters) -> Self;

    /// A conflict between two parameters: the key at fault and what it must be.
    fn conflict(_parameters: &Self::Parameters) -> Option<Conflict> {
        None
    }

    /// Its state at the set-up.
    fn initial(&self, start: &Start) -> Self::State;

    /// Moves the state by one period.
    fn drive(&self, _state: &mut Self::State, _inputs: &Self::Inputs, _turn: &Turn) {}

    /// What it does to the world in the period that `drive` has begun.
    fn effect(&self, _state: &Self::State) -> Effect {
        Effect::None
    }

    /// Looks at the world and says what there is.
    fn sense(&self, state: &mut Self::State, inputs: &Self::Inputs, turn: &Turn) -> Self::Outputs;
}

/// A parameter that does not go with another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Conflict {
    pub(crate) key: &'static str,
    pub(crate) wanted: &'static str,
}

/// What a component begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Start {
    /// The joint that it is bound to, if any.
    pub(crate) joint: Option<Coordinate>,
    /// A seed of its own, from the scenario's.
    pub(crate) seed: u64,
}

/// The circumstances of a half turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Turn {
    /// The period, s.
    pub(crate) dt_s: f64,
    /// What it sees of the world.
    pub(crate) seen: Seen,
    /// What has failed.
    pub(crate) failed: Failed,
}

/// A component of any kind, with its state.
pub(crate) trait Running: Send {
    fn drive(&mut self, inputs: &[Value], turn: &Turn);
    fn effect(&self) -> Effect;
    fn sense(&mut self, inputs: &[Value], turn: &Turn, outputs: &mut Vec<Value>);
    /// The state as bytes.
    fn save(&self) -> postcard::Result<Vec<u8>>;
    /// Checks that bytes are a state of such a component.
    fn check(&self, bytes: &[u8]) -> postcard::Result<()>;
    /// Takes the state in that [`check`](Self::check) accepts.
    fn restore(&mut self, bytes: &[u8]) -> postcard::Result<()>;
}

/// A component with its state.
pub(super) struct Runner<C: Component> {
    component: C,
    state: C::State,
}

impl<C: Component> Runner<C> {
    pub(super) fn new(component: C, start: &Start) -> Self {
        let state = component.initial(start);
        Self { component, state }
    }
}

impl<C: Component> Running for Runner<C> {
    fn drive(&mut self, inputs: &[Value], turn: &Turn) {
        self.component.drive(&mut self.state, &C::Inputs::read(inputs), turn);
    }

    fn effect(&self) -> Effect {
        self.component.effect(&self.state)
    }

    fn sense(&mut self, inputs: &[Value], turn: &Turn, outputs: &mut Vec<Value>) {
        self.component.sense(&mut self.state, &C::Inputs::read(inputs), turn).write(outputs);
    }

    fn save(&self) -> postcard::Result<Vec<u8>> {
        postcard::to_stdvec(&self.state)
    }

    fn check(&self, bytes: &[u8]) -> postcard::Result<()> {
        postcard::from_bytes::<C::State>(bytes).map(|_| ())
    }

    fn restore(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.state = postcard::from_bytes(bytes)?;
        Ok(())
    }
}

/// The data of a kind.
pub(super) fn kind<C: Component>() -> Kind {
    Kind {
        name: C::NAME,
        summary: C::SUMMARY,
        formula: C::FORMULA,
        source: C::SOURCE,
        coupling: C::COUPLING,
        parameters: C::Parameters::table(),
        inputs: C::Inputs::table(),
        outputs: C::Outputs::table(),
        failures: C::Failure::table(),
    }
}
