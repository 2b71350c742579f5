//! Signals chosen by name, as numbers.

use onescan_server::layout::ImageLayout;
use onescan_server::session::Session;
use onescan_server::signal::{SignalId, SignalName};

/// Signals chosen by name, found again in each session.
#[derive(Clone)]
pub struct Chosen {
    names: Vec<SignalName>,
    signals: Vec<SignalId>,
}

impl Chosen {
    /// Signals by name; their numbers are looked up when the session begins.
    pub fn new(names: &[SignalName]) -> Self {
        Self { names: names.to_vec(), signals: Vec::new() }
    }

    /// Their names.
    pub(crate) fn names(&self) -> &[SignalName] {
        &self.names
    }

    /// Finds the signals in a session that begins; returns how many there are.
    pub fn find(&mut self, session: &Session) -> usize {
        self.signals = self.names.iter().filter_map(|name| session.signal_id(name.as_str())).collect();
        self.signals.len()
    }

    /// Their bytes now, in their order.
    pub fn bytes<'s>(&self, session: &'s Session) -> impl Iterator<Item = &'s [u8]> {
        self.bytes_in(session.layout(), session.image())
    }

    /// What they are now, in their order; texts are not numbers.
    pub fn numbers(&self, session: &Session) -> impl Iterator<Item = f64> {
        self.numbers_in(session.layout(), session.image())
    }

    /// Their bytes in an image of the session in which they were found.
    pub fn bytes_in<'s>(&self, layout: &ImageLayout, image: &'s [u8]) -> impl Iterator<Item = &'s [u8]> {
        self.signals.iter().map(|signal| layout.bytes(*signal, image))
    }

    /// What they are in such an image.
    pub fn numbers_in(&self, layout: &ImageLayout, image: &[u8]) -> impl Iterator<Item = f64> {
        self.signals.iter().map(|signal| layout.ty(*signal).as_f64(layout.bytes(*signal, image)).unwrap_or(f64::NAN))
    }
}
