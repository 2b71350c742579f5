//! How grave a finding is.

use serde::Serialize;

/// How grave a finding is, in the words of SARIF (3.27.10) and of the JSON lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Legal, and seldom meant.
    Warning,
    Error,
}
