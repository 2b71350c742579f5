//! What can be wrong with a scenario: one error, with file and line where there is one.

use std::path::PathBuf;

use miette::{Diagnostic, NamedSource, SourceSpan};
use onescan_clients::gateway::LinkFault;
use onescan_plc_shim::Diagnostics;
use onescan_server::signal::ClientName;
use thiserror::Error;

/// Why a scenario is none.
#[derive(Debug, Error, Diagnostic)]
pub enum ScenarioError {
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    #[diagnostic(code(scenario::unreadable))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
        /// What to do.
        #[help]
        help: Option<String>,
    },
    /// A place in `scenario.toml` that is wrong.
    #[error("{message}")]
    #[diagnostic(code(scenario::wrong))]
    Wrong {
        /// What is wrong.
        message: String,
        /// The file.
        #[source_code]
        file: NamedSource<String>,
        /// The place.
        #[label("here")]
        place: Option<SourceSpan>,
        /// What to do.
        #[help]
        help: Option<String>,
    },
    /// The scene of a plant is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] Box<SceneReport>),
    /// The sources of a soft PLC are wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Plc(#[from] Box<PlcReport>),
    /// The link to a real PLC does not come about.
    #[error("client `{client}`: {fault}")]
    #[diagnostic(code(gateway::link))]
    Link {
        /// The client that speaks for it.
        client: ClientName,
        /// Why.
        fault: LinkFault,
    },
}

/// What was found in a PLC's sources, each with its place.
#[derive(Debug, Error)]
#[error("the sources of client `{client}` do not compile")]
pub struct PlcReport {
    /// The PLC.
    pub client: ClientName,
    /// Errors and warnings.
    pub findings: Diagnostics,
}

impl Diagnostic for PlcReport {
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        self.findings.related()
    }
}

/// A scene's faults with the places they are at.
#[derive(Debug, Error, Diagnostic)]
#[error("{message}")]
#[diagnostic(code(scene::wrong))]
pub struct SceneReport {
    /// The first fault, in words.
    pub message: String,
    /// The scene file.
    #[source_code]
    pub file: NamedSource<String>,
    /// Its place.
    #[label("here")]
    pub place: Option<SourceSpan>,
    /// What to do.
    #[help]
    pub help: Option<String>,
    /// The other faults.
    #[related]
    pub others: Vec<SceneReport>,
}
