//! Soft PLCs compiled once, and scenes read once, for all cases of a scenario that come to the same.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use onescan_iec::Input;
use onescan_iec_run::Application;
use onescan_plant::Scene;
use onescan_plant::scene::Override;
use onescan_server::signal::{ClientName, SignalName};

use super::case::CodeChange;

/// The variables of signals, as `bind` names them.
pub type Paths = BTreeMap<SignalName, Vec<String>>;

/// A soft PLC's sources, compiled, and what its `bind` says.
#[derive(Debug)]
pub struct Compiled {
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
    /// What the case sets in it, some of which are constants of the program, by path.
    pub(crate) settings: Vec<(String, String)>,
    /// What the case changes in its sources.
    pub(crate) code: Vec<(String, CodeChange)>,
    pub(crate) is_traced: bool,
    pub(crate) is_covered: bool,
}

/// The compilations of a scenario, shared by all its copies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Compilations {
    plcs: Arc<Mutex<BTreeMap<Compilation, Arc<Compiled>>>>,
    scenes: Arc<Mutex<BTreeMap<ClientName, ReadScene>>>,
}

/// A scene as it was read last, with the values that were put into it.
type ReadScene = (Vec<Override>, Arc<Scene>);

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
        let mut all = self.plcs.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(compiled) = all.get(&of) {
            return Ok(Arc::clone(compiled));
        }
        let compiled = Arc::new(compile()?);
        all.insert(of, Arc::clone(&compiled));
        Ok(compiled)
    }

    /// What `read` gives, or gave the last time if that was for the same. Only the last scene of a plant is kept: where a
    /// parameter is varied, each one is another.
    ///
    /// # Errors
    /// Those of `read`.
    pub(crate) fn scene<E>(
        &self,
        of: &ClientName,
        overrides: &[Override],
        read: impl FnOnce() -> Result<Scene, E>,
    ) -> Result<Arc<Scene>, E> {
        let all = || self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, scene)) = all().get(of).filter(|(known, _)| known == overrides) {
            return Ok(Arc::clone(scene));
        }
        let scene = Arc::new(read()?);
        all().insert(of.clone(), (overrides.to_vec(), Arc::clone(&scene)));
        Ok(scene)
    }
}
