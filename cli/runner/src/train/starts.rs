//! Prepared states: made by a run, kept as checkpoints in files that are named after all that made them.

use std::path::{Path, PathBuf};

use onescan_base::notice::NOTICE;
use onescan_base::regular::{self, Limit};
use onescan_report::file;
use onescan_scenario::Scenario;
use onescan_scenario::lesson::{Book, Start};
use onescan_server::checkpoint::Checkpoint;
use onescan_server::end::SessionEnd;
use onescan_server::lockstep::Reached;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::attempt::elsewhere;
use super::error::{StartError, TrainError};
use super::real_plc::{RealPlcs, STEPS_AT_A_TIME};
use crate::error::Unreadable;
use crate::interrupt::Interrupt;
use crate::run::in_process::with_clients;
use crate::web::Driving;

/// Where prepared states are kept, unless somebody says otherwise: below the user's cache, else below the temporary folder.
pub(crate) fn usual_folder() -> PathBuf {
    let cache = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".cache"));
    let cache = cache.filter(|path| path.is_absolute()).or_else(home).unwrap_or_else(std::env::temp_dir);
    cache.join("onescan").join("starts")
}

/// The prepared states of a scenario.
pub(super) struct Starts<'a> {
    scenario: &'a Scenario,
    book: &'a Book,
    folder: PathBuf,
}

impl<'a> Starts<'a> {
    pub(super) fn new(scenario: &'a Scenario, book: &'a Book, folder: Option<&Path>) -> Self {
        Self { scenario, book, folder: folder.map_or_else(usual_folder, Path::to_owned) }
    }

    /// The state `start`: from its file, or made and kept.
    ///
    /// # Errors
    /// The run that makes it cannot be formed or ends too early.
    pub(super) fn prepare(&self, start: &Start, interrupt: &Interrupt) -> Result<Checkpoint, TrainError> {
        let scenario = self.book.prepared(self.scenario, start)?;
        let path = self.folder.join(format!("{}.ckpt", self.identity(&scenario, start)?));
        if let Some(kept) = kept(&path) {
            return Ok(kept);
        }
        let checkpoint = make(&scenario, start, None, interrupt)?;
        let failed = |source| StartError::Checkpoint { name: start.name.clone(), source };
        let bytes = checkpoint.to_bytes().map_err(failed)?;
        // Without a file the state is made again next time: that costs time and nothing else.
        let written = file::create_folder(&self.folder).and_then(|_| file::write_whole(&path, &bytes));
        if let Err(error) = written {
            tracing::warn!(%error, "start `{}` is not kept", start.name);
        }
        Ok(checkpoint)
    }

    /// A name by all that makes the state: the program, the scenario's files, the case, the time.
    fn identity(&self, scenario: &Scenario, start: &Start) -> Result<String, TrainError> {
        let mut hash = blake3::Hasher::new();
        let mut part = |bytes: &[u8]| {
            hash.update(&(bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        };
        part(env!("CARGO_PKG_VERSION").as_bytes());
        part(&start.at.as_nanos().to_le_bytes());
        for file in scenario.files()? {
            let path = scenario.folder().join(&file);
            part(file.to_string_lossy().as_bytes());
            part(&regular::read(&path, Limit::DATA).map_err(Unreadable::at(&path))?);
        }
        part(start.case.as_deref().unwrap_or_default().as_bytes());
        let short: String = hash.finalize().to_hex().chars().take(32).collect();
        Ok(format!("{}-{short}", self.scenario.name()))
    }
}

/// A state that was kept; nothing if there is none, or one that is damaged or of another version.
fn kept(path: &Path) -> Option<Checkpoint> {
    let bytes = regular::read(path, Limit::DATA).ok()?;
    Checkpoint::from_bytes(&bytes).inspect_err(|error| tracing::warn!(%error, "{} is made again", path.display())).ok()
}

/// Drives the real PLCs, and all else with them, from their cold start to the state; they stand there then.
///
/// # Errors
/// As those of [`Starts::prepare`], or a PLC fails on the way.
pub(super) fn driven(
    scenario: &Scenario,
    start: &Start,
    (real, driving): (&RealPlcs, &Driving),
    interrupt: &Interrupt,
) -> Result<Checkpoint, TrainError> {
    for name in real.names() {
        tracing::info!(target: NOTICE, "client `{name}`: driven to `{}`, t_v = {}, from its cold start", start.name, start.at);
    }
    make(scenario, start, Some((real, driving)), interrupt)
}

/// Runs up to the state, unless the program is asked to end.
fn make(
    scenario: &Scenario,
    start: &Start,
    driven: Option<(&RealPlcs, &Driving)>,
    interrupt: &Interrupt,
) -> Result<Checkpoint, TrainError> {
    let until = start.at + scenario.plan().step();
    let here = |name: &ClientName| driven.and_then(|(real, _)| real.client(name));
    let mut lockstep = with_clients(scenario, until, [], here, elsewhere)?;
    lockstep.set_settings(scenario.session_settings());
    let mut at = VirtualTime::ZERO;
    loop {
        if interrupt.is_raised() {
            return Err(StartError::Interrupted { name: start.name.clone() }.into());
        }
        let next = scenario.plan().step().times(STEPS_AT_A_TIME).and_then(|some| at.checked_add(some));
        at = next.map_or(start.at, |next| next.min(start.at));
        if lockstep.run_to(at)? == Reached::End {
            if let Some(SessionEnd::Failed(failure)) = lockstep.session().end() {
                return Err(StartError::Failed { name: start.name.clone(), failure: failure.clone() }.into());
            }
            return Err(StartError::Ended { name: start.name.clone(), ended: lockstep.session().t_v() }.into());
        }
        if let Some((_, driving)) = driven {
            driving.reach(at);
        }
        if at == start.at {
            break;
        }
    }
    let taken = lockstep.checkpoint();
    Ok(taken.map_err(|source| StartError::Checkpoint { name: start.name.clone(), source })?)
}
