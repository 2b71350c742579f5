//! Why a list cannot be read.

use miette::Diagnostic;
use onescan_iec::input::encoding::EncodingError;
use onescan_links::gateway::SettingsFault;
use thiserror::Error;

use super::ListKind;
use onescan_regress::check::CheckError;
use onescan_runner::error::{Exit, ExitCode, Unreadable, Usage};

/// Why a list cannot be read.
#[derive(Debug, Error, Diagnostic)]
pub enum ListError {
    /// The file cannot be read.
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    /// What was typed is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Usage(#[from] Usage),
    /// The PLC's sources cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Sources(#[from] CheckError),
    /// The PLC does not say what it has.
    #[error(transparent)]
    Server(#[from] SettingsFault),
    /// It is too large.
    #[error("{file} is larger than {mib} MiB, which no I/O list is")]
    TooLarge { file: String, mib: u64 },
    /// It has too many points.
    #[error("{file} has more than {limit} inputs and outputs")]
    #[diagnostic(help("export a part of it, such as one tag table or one device"))]
    TooMany { file: String, limit: usize },
    /// It is not text.
    #[error("{file}: {source}")]
    NotText { file: String, source: EncodingError },
    /// It is no XML, or ends within an element.
    #[error("{file}:{line}: {cause}")]
    #[diagnostic(help("this is not a complete XML file: export it again"))]
    NotXml {
        file: String,
        line: u32,
        /// What the reader says.
        cause: String,
    },
    /// It is not a workbook.
    #[error("{file}: {cause}")]
    #[diagnostic(help("in TIA Portal, export the PLC tags of a tag table as `.xlsx`"))]
    NotWorkbook { file: String, cause: String },
    /// It is well-formed, and no list of this kind.
    #[error("{file}: {what}")]
    Other {
        file: String,
        what: String,
        #[help]
        help: Option<String>,
    },
    /// There is nothing in it that could be a signal.
    #[error("{file}, read as {title}, has no inputs and outputs{}", left(*.left_out))]
    Empty {
        file: String,
        /// What it was read as.
        title: &'static str,
        /// How many entries cannot be signals.
        left_out: usize,
        #[help]
        help: &'static str,
    },
}

/// What to do with a list that has no inputs and outputs.
pub(super) fn help_for_empty(kind: ListKind) -> &'static str {
    match kind {
        ListKind::TwinCat => {
            "inputs and outputs are what is linked or has an address in %I or %Q; a project without any needs no scenario: \
             `onescan test NAME.plcproj` runs its tests, `onescan check NAME.plcproj` checks it"
        }
        _ => "inputs and outputs are what is linked or has an address in %I or %Q",
    }
}

fn left(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => ", and one entry was left out".to_owned(),
        count => format!(", and {count} entries were left out"),
    }
}

impl Exit for ListError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Server(fault) => fault.exit_code(),
            Self::Sources(error) => error.exit_code(),
            _ => ExitCode::WrongInput,
        }
    }
}
