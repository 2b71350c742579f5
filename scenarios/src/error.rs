//! What can be wrong with a scenario: one error, with file and line where there is one.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};
use onescan_iec::Diagnostics;
use onescan_links::gateway::LinkFault;
use onescan_server::signal::ClientName;
use thiserror::Error;

/// Why a scenario is none.
#[derive(Debug, Error, Diagnostic)]
pub enum ScenarioError {
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    #[diagnostic(code(scenario::unreadable))]
    Unreadable {
        path: PathBuf,
        source: std::io::Error,
        #[help]
        help: Option<String>,
    },
    /// A file that is something else.
    #[error("{} is not a scenario", path.display())]
    #[diagnostic(code(scenario::other))]
    Other {
        path: PathBuf,
        #[help]
        help: String,
    },
    /// A file that the scenario may not read.
    #[error("{} is outside of the scenario's folder{}", path.display(), leads(path, real))]
    #[diagnostic(
        code(scenario::outside),
        help(
            "a scenario reads its own folder; allow more with `--allow-path PATH` or ONESCAN_ALLOW_PATH (docs/security.md)"
        )
    )]
    Outside {
        /// The file, as it is named.
        path: PathBuf,
        real: PathBuf,
    },
    /// A place in `scenario.toml` that is wrong.
    #[error("{message}")]
    #[diagnostic(code(scenario::wrong))]
    Wrong {
        message: String,
        #[source_code]
        file: NamedSource<String>,
        #[label("here")]
        place: Option<SourceSpan>,
        #[help]
        help: Option<String>,
    },
    /// A case that the scenario has not.
    #[error("scenario `{scenario}` has no case `{case}`")]
    #[diagnostic(code(scenario::unknown_case))]
    UnknownCase {
        scenario: String,
        /// The case as it was asked for.
        case: String,
        #[help]
        help: String,
    },
    /// The scene of a plant is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] Box<SceneReport>),
    /// The sources of a soft PLC are wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Plc(#[from] Box<PlcReport>),
    /// The system does not give the memory for a soft PLC.
    #[error("client `{client}`: {message}")]
    #[diagnostic(code(scenario::memory))]
    Memory { client: ClientName, message: String },
    /// The link to a real PLC does not come about.
    #[error("client `{client}`: {fault}")]
    #[diagnostic(code(gateway::link))]
    Link {
        /// The client that speaks for it.
        client: ClientName,
        fault: LinkFault,
    },
}

fn leads(path: &Path, real: &Path) -> String {
    if path == real { String::new() } else { format!(": it is {}", real.display()) }
}

/// An error at a place of a file.
pub(crate) fn wrong(
    path: &Path,
    text: &str,
    message: String,
    place: Option<Range<usize>>,
    help: Option<String>,
) -> ScenarioError {
    ScenarioError::Wrong {
        message,
        file: NamedSource::new(path.display().to_string(), text.to_owned()),
        place: place.map(SourceSpan::from),
        help,
    }
}

/// What is wrong with a part of a file, where, and what to do: an error as soon as the file's name and text are put to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Wrong {
    pub(crate) message: String,
    pub(crate) place: Range<usize>,
    pub(crate) help: Option<String>,
}

/// Errors of sources that are shown with their places. Each takes a look at all of its source, and nobody reads thousands.
const ERRORS_SHOWN: usize = 100;

/// What was found in a PLC's sources, each with its place.
#[derive(Debug, Error)]
#[error("the sources of client `{client}` do not compile")]
pub struct PlcReport {
    pub client: ClientName,
    pub findings: Diagnostics,
}

impl Diagnostic for PlcReport {
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.findings.errors().take(ERRORS_SHOWN)))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let more = self.findings.errors().count().saturating_sub(ERRORS_SHOWN);
        (more > 0).then(|| Box::new(format!("{more} more errors are not shown: `onescan check` lists them")) as Box<_>)
    }
}

/// A scene's faults with the places they are at.
#[derive(Debug, Error, Diagnostic)]
#[error("{message}")]
#[diagnostic(code(scene::wrong))]
pub struct SceneReport {
    /// The first fault, in words.
    pub message: String,
    #[source_code]
    pub file: NamedSource<Arc<str>>,
    #[label("here")]
    pub place: Option<SourceSpan>,
    #[help]
    pub help: Option<String>,
    #[related]
    pub others: Vec<SceneReport>,
}
