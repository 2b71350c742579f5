//! Soft PLCs compiled once for all cases of a scenario that compile to the same.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use onescan_server::signal::ClientName;

use crate::compose::Compiled;
use crate::error::ScenarioError;
use crate::load::Scenario;

/// What a compilation is of. The sources are not part of it: a scenario that is loaded is as it was then.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    client: ClientName,
    /// What the case sets, some of which are constants of the program.
    settings: Vec<(String, String)>,
    is_traced: bool,
    is_covered: bool,
}

/// The compilations of a scenario, shared by all its copies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compilations(Arc<Mutex<BTreeMap<Key, Arc<Compiled>>>>);

impl Scenario {
    /// What `compile` gives for soft PLC `client`, or gave for another case that sets the same.
    ///
    /// # Errors
    /// Those of `compile`.
    pub(crate) fn compiled_once(
        &self,
        client: &ClientName,
        compile: impl FnOnce() -> Result<Compiled, ScenarioError>,
    ) -> Result<Arc<Compiled>, ScenarioError> {
        let settings = self.case().map(|case| case.settings.as_slice()).unwrap_or_default();
        let key = Key {
            client: client.clone(),
            settings: settings.iter().map(|one| (one.path.clone(), one.value.to_string())).collect(),
            is_traced: self.is_traced(),
            is_covered: self.coverage().is_some(),
        };
        // A compilation is put in as a whole: nothing is half done where a thread panics.
        let mut all = self.compilations().0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(compiled) = all.get(&key) {
            return Ok(Arc::clone(compiled));
        }
        let compiled = Arc::new(compile()?);
        all.insert(key, Arc::clone(&compiled));
        Ok(compiled)
    }
}
