//! What a session is before anybody joins: its step, coupling, signals and expected clients.

use onescan_base::nearest;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::client::ClientId;
use crate::signal::{ClientName, SignalDecl, SignalName};
use crate::time::TimeSpan;

/// How the clients of a step see each other.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coupling<C> {
    /// All read the image committed by the step before (`[SDSP]`).
    #[default]
    Parallel,
    /// They run in this order within a step; each sees what those before it wrote (OneScan of `[Sivtoft]`).
    Sequential { order: Vec<C> },
}

/// The plan of a session, checked: names are unique and known, lists sorted by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SessionPlan {
    step: TimeSpan,
    coupling: Coupling<ClientId>,
    signals: Vec<SignalDecl>,
    clients: Vec<ClientName>,
}

/// Why a plan cannot be a session.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlanError {
    /// Nobody to wait for.
    #[error("a session needs at least one client")]
    NoClients,
    /// The same name twice.
    #[error("client `{0}` is listed twice")]
    DoubleClient(ClientName),
    /// The same name twice.
    #[error("signal `{0}` is declared twice")]
    DoubleSignal(SignalName),
    /// Names that differ in case alone would be one identifier to a PLC (IEC 61131-3 2.1.2).
    #[error("signals `{0}` and `{1}` differ only in case; a PLC takes them for one")]
    CaseTwins(SignalName, SignalName),
    /// A signal whose writer is not a client of the session.
    #[error("signal `{signal}` is to be written by `{writer}`, which is not a client of this session{}", hint(nearest.as_deref()))]
    UnknownWriter {
        signal: SignalName,
        /// Its writer as declared.
        writer: ClientName,
        /// The client that may have been meant.
        nearest: Option<String>,
    },
    /// A sequential order that is not a permutation of the clients.
    #[error("the sequential order must list every client exactly once; `{0}` is missing, doubled or unknown")]
    Order(ClientName),
}

pub(crate) fn hint(nearest: Option<&str>) -> String {
    nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

impl SessionPlan {
    /// Checks and sorts a plan.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn new(
        step: TimeSpan,
        coupling: &Coupling<ClientName>,
        mut signals: Vec<SignalDecl>,
        mut clients: Vec<ClientName>,
    ) -> Result<Self, PlanError> {
        clients.sort();
        signals.sort_by(|a, b| a.name.cmp(&b.name));
        if clients.is_empty() {
            return Err(PlanError::NoClients);
        }
        if let Some(pair) = clients.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(PlanError::DoubleClient(pair[0].clone()));
        }
        check_signal_names(&signals)?;
        check_writers(&signals, &clients)?;
        let coupling = rank_order(coupling, &clients)?;
        Ok(Self { step, coupling, signals, clients })
    }

    /// The smallest increment of virtual time.
    pub fn step(&self) -> TimeSpan {
        self.step
    }

    /// How clients see each other within a step.
    pub fn coupling(&self) -> &Coupling<ClientId> {
        &self.coupling
    }

    /// All signals, sorted by name; a [`SignalId`](crate::signal::SignalId) indexes them.
    pub fn signals(&self) -> &[SignalDecl] {
        &self.signals
    }

    /// All clients, sorted by name; a [`ClientId`] indexes them.
    pub fn clients(&self) -> &[ClientName] {
        &self.clients
    }

    /// The client of this name.
    pub fn client_id(&self, name: &ClientName) -> Option<ClientId> {
        self.clients.binary_search(name).ok().map(ClientId::from_index)
    }
}

fn check_signal_names(signals: &[SignalDecl]) -> Result<(), PlanError> {
    let mut folded: Vec<(String, &SignalName)> =
        signals.iter().map(|signal| (signal.name.as_str().to_ascii_uppercase(), &signal.name)).collect();
    folded.sort();
    match folded.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        None => Ok(()),
        Some(pair) if pair[0].1 == pair[1].1 => Err(PlanError::DoubleSignal(pair[0].1.clone())),
        Some(pair) => Err(PlanError::CaseTwins(pair[0].1.clone(), pair[1].1.clone())),
    }
}

fn check_writers(signals: &[SignalDecl], clients: &[ClientName]) -> Result<(), PlanError> {
    for signal in signals {
        if let Some(writer) = signal.writer.as_ref().filter(|writer| !clients.contains(writer)) {
            return Err(PlanError::UnknownWriter {
                signal: signal.name.clone(),
                writer: writer.clone(),
                nearest: nearest(writer.as_str(), clients.iter().map(ClientName::as_str)).map(str::to_owned),
            });
        }
    }
    Ok(())
}

fn rank_order(coupling: &Coupling<ClientName>, clients: &[ClientName]) -> Result<Coupling<ClientId>, PlanError> {
    let Coupling::Sequential { order } = coupling else { return Ok(Coupling::Parallel) };
    let mut ranks = Vec::with_capacity(order.len());
    for name in order {
        let rank = clients.binary_search(name).map_err(|_| PlanError::Order(name.clone()))?;
        if ranks.contains(&ClientId::from_index(rank)) {
            return Err(PlanError::Order(name.clone()));
        }
        ranks.push(ClientId::from_index(rank));
    }
    match clients.iter().find(|name| !order.contains(name)) {
        Some(missing) => Err(PlanError::Order(missing.clone())),
        None => Ok(Coupling::Sequential { order: ranks }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::SignalType;

    fn client(name: &str) -> ClientName {
        ClientName::new(name).unwrap()
    }

    fn signal(name: &str, writer: Option<&str>) -> SignalDecl {
        SignalDecl {
            name: SignalName::new(name).unwrap(),
            ty: SignalType::BOOL,
            writer: writer.map(client),
            unit: None,
        }
    }

    fn plan(signals: Vec<SignalDecl>, clients: &[&str]) -> Result<SessionPlan, PlanError> {
        let step = TimeSpan::from_millis(1).unwrap();
        SessionPlan::new(step, &Coupling::Parallel, signals, clients.iter().map(|name| client(name)).collect())
    }

    #[test]
    fn order_of_declaration_does_not_matter() {
        let one = plan(vec![signal("b", None), signal("a", None)], &["plc", "plant"]).unwrap();
        let two = plan(vec![signal("a", None), signal("b", None)], &["plant", "plc"]).unwrap();
        assert_eq!(one, two);
    }

    #[test]
    fn faults_of_a_plan_are_named() {
        assert_eq!(plan(vec![], &[]).unwrap_err(), PlanError::NoClients);
        assert_eq!(plan(vec![], &["a", "a"]).unwrap_err(), PlanError::DoubleClient(client("a")));
        assert!(matches!(plan(vec![signal("x", None), signal("x", None)], &["a"]), Err(PlanError::DoubleSignal(_))));
        assert!(matches!(plan(vec![signal("x", None), signal("X", None)], &["a"]), Err(PlanError::CaseTwins(..))));
        let unknown = plan(vec![signal("x", Some("plnat"))], &["plant"]).unwrap_err();
        assert!(unknown.to_string().ends_with("did you mean `plant`?"), "{unknown}");
    }

    #[test]
    fn a_sequential_order_is_a_permutation() {
        let step = TimeSpan::from_millis(1).unwrap();
        let order = |names: &[&str]| {
            let coupling = Coupling::Sequential { order: names.iter().map(|name| client(name)).collect() };
            SessionPlan::new(step, &coupling, vec![], vec![client("a"), client("b")])
        };
        assert!(order(&["b", "a"]).is_ok());
        assert_eq!(order(&["b"]).unwrap_err(), PlanError::Order(client("a")));
        assert_eq!(order(&["b", "b"]).unwrap_err(), PlanError::Order(client("b")));
        assert_eq!(order(&["a", "b", "c"]).unwrap_err(), PlanError::Order(client("c")));
    }
}
