//! Items: values that a link reads and writes one by one, as an OPC server offers them.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use onescan_server::signal::PortLayout;

/// The bytes of a port, shared between a client and a link.
///
/// A client takes or leaves all of them at its cycle, in one piece; that is how far a process image
/// reaches. What a link does, it does item by item.
pub(super) struct Items {
    bytes: Mutex<Vec<u8>>,
    places: Vec<Range<usize>>,
}

impl Items {
    pub(super) fn new(layout: &PortLayout) -> Self {
        let places = layout.iter().map(|(port, offset)| offset..offset + port.ty.size()).collect();
        Self { bytes: Mutex::new(vec![0; layout.size()]), places }
    }

    /// The value of item `index`.
    pub(super) fn get(&self, index: usize) -> Vec<u8> {
        self.lock()[self.places[index].clone()].to_vec()
    }

    /// Puts a value into item `index`.
    pub(super) fn put(&self, index: usize, value: &[u8]) {
        self.lock()[self.places[index].clone()].copy_from_slice(value);
    }

    /// The bytes of all items, as one picture of them.
    pub(super) fn all(&self) -> Vec<u8> {
        self.lock().clone()
    }

    /// Copies all items out.
    pub(super) fn copy_to(&self, port: &mut [u8]) {
        port.copy_from_slice(&self.lock());
    }

    /// Copies all items in.
    pub(super) fn copy_from(&self, port: &[u8]) {
        self.lock().copy_from_slice(port);
    }

    /// A thread that panicked here left whole values: each access is one copy.
    fn lock(&self) -> MutexGuard<'_, Vec<u8>> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
