//! Signals chosen by name, as numbers.

use onescan_server::session::Session;
use onescan_server::signal::{SignalId, SignalName};

/// Signals chosen by name, found anew in each session.
#[derive(Clone)]
pub(crate) struct Chosen {
    names: Vec<SignalName>,
    signals: Vec<SignalId>,
}

impl Chosen {
    pub(crate) fn new(names: &[SignalName]) -> Self {
        Self { names: names.to_vec(), signals: Vec::new() }
    }

    /// Their names.
    pub(crate) fn names(&self) -> &[SignalName] {
        &self.names
    }

    /// Finds the signals in a session that begins; returns how many there are.
    pub(crate) fn find(&mut self, session: &Session) -> usize {
        self.signals = self.names.iter().filter_map(|name| session.signal_id(name.as_str())).collect();
        self.signals.len()
    }

    /// Their bytes now, in their order.
    pub(crate) fn bytes<'s>(&self, session: &'s Session) -> impl Iterator<Item = &'s [u8]> {
        self.signals.iter().map(|signal| session.layout().bytes(*signal, session.image()))
    }

    /// What they are now, in their order; texts are no numbers.
    pub(crate) fn numbers(&self, session: &Session) -> impl Iterator<Item = f64> {
        self.signals.iter().map(|signal| {
            let bytes = session.layout().bytes(*signal, session.image());
            session.layout().ty(*signal).as_f64(bytes).unwrap_or(f64::NAN)
        })
    }
}
