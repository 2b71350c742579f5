//! Which point is which place in the PLC's memory.

use onescan_iec_run::{Application, UnknownVariable, Variable};
use onescan_server::signal::SignalName;
use thiserror::Error;

use crate::gateway::exchange::{ANSWER, BOOTS, Direction, Exchange, Point, RUNNING, START, is_word};
use onescan_soft_plc::bind::{Bindings, Bound, Place};

/// Where a point's value is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// In the PLC's memory; a signal that is one point may have several places.
    Memory(Vec<Place>),
    Start,
    Boots,
    Running,
}

/// A point and its source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wire {
    pub(super) point: Point,
    pub(super) source: Source,
}

/// All points of a PLC.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wires {
    pub(super) to_plc: Vec<Wire>,
    pub(super) from_plc: Vec<Wire>,
    /// What the scheduler answers, where there is one.
    pub(super) answer: Option<Wire>,
    exchange: Exchange,
}

/// A point without a variable.
#[derive(Clone, Debug, Error)]
pub enum WireError {
    /// The program has not the shim.
    #[error("the program has no `{word}`: it is not instrumented")]
    NoShim {
        /// The word that is missing.
        word: String,
        /// What was found in its place.
        cause: UnknownVariable,
    },
    /// A signal that the PLC takes no part in.
    #[error("the PLC takes no part in `{0}`")]
    Unbound(String),
}

impl Wires {
    /// The points of `exchange` in `application`, whose signals are bound by `bindings`.
    ///
    /// # Errors
    /// A word or a signal without a variable.
    pub fn new(exchange: &Exchange, application: &Application, bindings: &Bindings) -> Result<Self, WireError> {
        let wires = |points: &[Point], bound: &[Bound]| -> Result<Vec<Wire>, WireError> {
            let wire = |point: &Point| {
                let source = source(point, application, bound)?;
                Ok(Wire { point: point.clone(), source })
            };
            points.iter().map(wire).collect()
        };
        let from_plc = wires(exchange.from_plc(), &bindings.outputs)?;
        Ok(Self {
            to_plc: wires(exchange.to_plc(), &bindings.inputs)?,
            answer: from_plc.iter().find(|wire| wire.point.name == ANSWER.0).cloned(),
            from_plc,
            exchange: exchange.clone(),
        })
    }

    /// Those of a direction, in the order of its points.
    pub(super) fn of(&self, direction: Direction) -> &[Wire] {
        match direction {
            Direction::ToPlc => &self.to_plc,
            Direction::FromPlc => &self.from_plc,
        }
    }

    /// The points.
    pub fn exchange(&self) -> &Exchange {
        &self.exchange
    }
}

/// The variable of the shim's `name`: in SCL all of them are members of a data block.
///
/// # Errors
/// The program has no shim.
pub fn word(application: &Application, name: &str) -> Result<Variable, WireError> {
    let found = application.variable(name).or_else(|cause| {
        let in_block = application.variable(&format!("{BLOCK}.{name}"));
        in_block.map_err(|_| cause)
    });
    found.map_err(|cause| WireError::NoShim { word: name.to_owned(), cause })
}

/// The data block of the shim's variables.
const BLOCK: &str = "SDSP";

fn source(point: &Point, application: &Application, bound: &[Bound]) -> Result<Source, WireError> {
    let name = point.name.as_str();
    if name == START.0 {
        return Ok(Source::Start);
    } else if name == BOOTS.0 {
        return Ok(Source::Boots);
    } else if name == RUNNING.0 {
        return Ok(Source::Running);
    }
    if is_word(name) {
        let found = word(application, name)?;
        return Ok(Source::Memory(vec![Place::of(&found)]));
    }
    let unbound = || WireError::Unbound(point.label());
    let is_it = |bound: &&Bound| SignalName::as_str(&bound.port.name) == name;
    let found = bound.iter().find(is_it).ok_or_else(unbound)?;
    let Some(path) = &point.variable else { return Ok(Source::Memory(found.places.clone())) };
    let place = found.variables.iter().zip(&found.places).find(|(known, _)| *known == path);
    place.map(|(_, place)| Source::Memory(vec![*place])).ok_or_else(unbound)
}
