//! Soft PLCs compiled once for all cases of a scenario that compile to the same.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use onescan_plc_shim::{Application, Input};
use onescan_server::signal::{ClientName, SignalName};

/// The variables of signals, as `bind` names them.
pub type Paths = BTreeMap<SignalName, Vec<String>>;

/// A soft PLC's sources, compiled, and what its `bind` says.
#[derive(Debug)]
pub struct Compiled {
    /// The program.
    pub application: Application,
    /// What `bind` says, patterns written out.
    pub paths: Paths,
    /// The sources as they are, without what the case changes.
    pub inputs: Vec<Input>,
}

/// What a compilation is of. The sources are not part of it: a scenario that is loaded is as it was then.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Compilation {
    pub(crate) client: ClientName,
    /// What the case sets, some of which are constants of the program, by path.
    pub(crate) settings: Vec<(String, String)>,
    pub(crate) is_traced: bool,
    pub(crate) is_covered: bool,
}

/// The compilations of a scenario, shared by all its copies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compilations(Arc<Mutex<BTreeMap<Compilation, Arc<Compiled>>>>);

impl Compilations {
    /// What `compile` gives, or gave before for the same.
    ///
    /// # Errors
    /// Those of `compile`.
    pub(crate) fn once<E>(
        &self,
        of: Compilation,
        compile: impl FnOnce() -> Result<Compiled, E>,
    ) -> Result<Arc<Compiled>, E> {
        // A compilation is put in as a whole: nothing is half done where a thread panics.
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(compiled) = all.get(&of) {
            return Ok(Arc::clone(compiled));
        }
        let compiled = Arc::new(compile()?);
        all.insert(of, Arc::clone(&compiled));
        Ok(compiled)
    }
}
