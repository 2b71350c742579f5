//! One thing that was looked at.

use serde::Serialize;

/// Whether commands can use it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// It is there, and works.
    Ok,
    /// It is not there; only some commands need it.
    Missing,
    /// It does not work, and commands that people use every day need it.
    Wrong,
}

/// One thing that was looked at, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What was looked at, in a word or two.
    pub subject: &'static str,
    /// Whether commands can use it; `Wrong` ends the command with code 3.
    pub state: State,
    /// What was found: a path, a number, why it does not work.
    pub found: String,
    /// What needs it, and what you do; nothing where it is there.
    pub help: Option<String>,
}

impl Finding {
    pub(super) fn ok(subject: &'static str, found: impl Into<String>) -> Self {
        Self { subject, state: State::Ok, found: found.into(), help: None }
    }

    pub(super) fn missing(subject: &'static str, found: impl Into<String>, help: impl Into<String>) -> Self {
        Self { subject, state: State::Missing, found: found.into(), help: Some(help.into()) }
    }

    pub(super) fn wrong(subject: &'static str, found: impl Into<String>, help: impl Into<String>) -> Self {
        Self { subject, state: State::Wrong, found: found.into(), help: Some(help.into()) }
    }
}
