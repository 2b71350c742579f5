//! Why a change is refused, and why there is no editor.

use onescan_report::FileError;
use onescan_scenario::ScenarioError;
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

use onescan_runner::error::{ListenError, Unreadable, Usage, sum_of_errors};

/// A line of a file, from 1.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Place {
    /// The file, as the scenario names it.
    pub file: String,
    /// The line.
    pub line: usize,
}

/// Something that refers to a thing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Reference {
    /// What refers to it, as in "component `cylinder`, joint".
    pub by: String,
    /// Where.
    #[serde(flatten)]
    pub place: Place,
}

/// Why a change is not made. Nothing is changed then.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum EditError {
    /// The file is no TOML, so nobody knows where to write.
    #[error("{} is not TOML as it stands: {message}", place.file)]
    NoToml {
        /// What the reader of TOML says.
        message: String,
        /// Where.
        place: Place,
    },
    /// Two changes that would be made together are of the same text.
    #[error("two changes of {file} are of the same text: make one after the other")]
    Overlap {
        /// The file, which stays as it is.
        file: String,
    },
    /// A scene that the scenario does not name.
    #[error("the scenario has no scene `{0}`")]
    NoScene(String),
    /// Something that is not there.
    #[error("there is no {what} `{name}` in {file}{}", near.as_ref().map(|near| format!(" (did you mean `{near}`?)")).unwrap_or_default())]
    Missing {
        /// What sort of thing.
        what: String,
        /// Its name.
        name: String,
        /// The file.
        file: String,
        /// A name that is there.
        near: Option<String>,
    },
    /// Something of this name is there already.
    #[error("there is a {what} `{name}` already")]
    Taken {
        /// What sort of thing.
        what: String,
        /// The name.
        name: String,
        /// Where it is.
        place: Place,
    },
    /// A thing that others refer to.
    #[error("{what} `{name}` is needed by {}", listed(by))]
    Referred {
        /// What sort of thing.
        what: String,
        /// Its name.
        name: String,
        /// Who needs it.
        by: Vec<Reference>,
    },
    /// A key that such a table has not.
    #[error("{what} has no `{key}`")]
    NoKey {
        /// What has it not.
        what: String,
        /// The key.
        key: String,
    },
    /// A value that a key cannot have.
    #[error("`{key}` is {wanted}, which {value} is not")]
    Value {
        /// The key.
        key: String,
        /// What it may be.
        wanted: String,
        /// What it was to be.
        value: String,
    },
    /// A table without a key that it needs.
    #[error("{what} needs `{key}`")]
    Lacking {
        /// What needs it.
        what: String,
        /// The key.
        key: String,
    },
    /// A key without which a table means nothing.
    #[error("`{key}` of {what} can be changed, but not taken away")]
    Needed {
        /// What needs it.
        what: String,
        /// The key.
        key: String,
    },
    /// A key that is what a thing is.
    #[error("`{key}` of {what} is not set: rename it, or place another in its stead")]
    Fixed {
        /// The thing.
        what: String,
        /// The key.
        key: String,
    },
    /// A name that nothing can have.
    #[error("`{0}` cannot be a name: one without spaces at its ends, line breaks and quotes is needed")]
    Name(String),
    /// An array is renamed with another range.
    #[error("`{name}` stands for several: its new name ends with `{range}`, too")]
    Range {
        /// The array.
        name: String,
        /// The range of its indices.
        range: String,
    },
    /// A signal that is bound by a pattern or an array, or written in another way than by a line of its own.
    #[error("`{name}` is written together with others, as `{}`: change that by hand, at {}:{}", written, place.file, place.line)]
    Together {
        /// The signal.
        name: String,
        /// What is written.
        written: String,
        /// Where.
        place: Place,
    },
    /// A signal that is connected by its name alone.
    #[error(
        "`{signal}` is the variable of its name in `{client}`: nothing in `bind` says so, and nothing there can take it back"
    )]
    ByName {
        /// The signal.
        signal: String,
        /// The PLC.
        client: String,
    },
    /// Two ends that cannot be connected.
    #[error("{0}")]
    Unlike(String),
}

impl EditError {
    /// Where it is, if it is somewhere.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::NoToml { place, .. } | Self::Taken { place, .. } | Self::Together { place, .. } => Some(place),
            Self::Referred { by, .. } => by.first().map(|reference| &reference.place),
            _ => None,
        }
    }

    /// Who is in the way.
    pub fn references(&self) -> &[Reference] {
        if let Self::Referred { by, .. } = self { by } else { &[] }
    }
}

fn listed(by: &[Reference]) -> String {
    by.iter().map(|one| one.by.as_str()).collect::<Vec<_>>().join("; ")
}

/// Files that are not as the editor has last read or written them.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("somebody else has changed {}: read the files again first, so that nothing of theirs is lost", .0.join(" and "))]
pub struct Changed(pub Vec<String>);

sum_of_errors! {
    /// Why there is no editor.
    pub enum EditorError {
        /// The address is not one of this machine.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be read.
        Unreadable(Unreadable),
        /// A file that the scenario may not have.
        #[diagnostic(transparent)]
        Scenario(ScenarioError),
        /// A file cannot be written.
        File(FileError),
        /// The address cannot be listened on.
        Listen(ListenError),
    }
}
