//! The signals that are recorded, and where they lie in an image.

use onescan_server::session::Session;
use onescan_server::signal::pattern::{SignalPattern, Unmatched, choose};
use onescan_server::signal::{ClientName, SignalName, SignalType};

/// A signal that is recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    pub name: SignalName,
    pub ty: SignalType,
    pub unit: Option<String>,
    pub writer: Option<ClientName>,
    /// Its first byte in the image.
    pub offset: usize,
}

impl Column {
    /// Its bytes in `image`.
    pub(crate) fn bytes<'i>(&self, image: &'i [u8]) -> &'i [u8] {
        &image[self.offset..self.offset + self.ty.size()]
    }
}

/// The signals of `session` that `patterns` choose, all without patterns.
///
/// # Errors
/// A pattern that matches no signal.
pub(super) fn columns(session: &Session, patterns: &[SignalPattern]) -> Result<Vec<Column>, Unmatched> {
    let signals = session.plan().signals();
    let chosen = choose(patterns, signals.iter().map(|signal| &signal.name))?;
    let ids: Vec<_> = session.layout().signals().collect();
    let column = |index: usize| Column {
        name: signals[index].name.clone(),
        ty: signals[index].ty,
        unit: signals[index].unit.clone(),
        writer: session.writer(ids[index]).cloned(),
        offset: session.layout().offset(ids[index]),
    };
    Ok(chosen.into_iter().map(column).collect())
}
