//! The OPC-like link from one client's outputs to the others' inputs (`[SDSP]` Fig. 1).
//!
//! A link begins with the value of each item. At every update it compares each with what it last took, and queues those
//! that changed: a change that is undone between two updates is never seen (*slow sampling*). The queue
//! travels through the gateway one item after another, so that what changed together arrives apart
//! (*race condition*), late (*time delay*), and never equally late (*jitter*).

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::item::Items;
use super::sleep;

/// An item of the source and the places it goes to.
pub(super) struct Route {
    pub(super) source: usize,
    pub(super) targets: Vec<(Arc<Items>, usize)>,
}

/// A link from `source` along `routes`.
pub(super) struct OpcLink {
    pub(super) source: Arc<Items>,
    pub(super) routes: Vec<Route>,
    pub(super) update_rate: Duration,
    pub(super) item_transfer: Duration,
}

impl OpcLink {
    /// Exchanges until one of `stops` is set.
    pub(super) fn run(&self, stops: [&AtomicBool; 2]) {
        let mut exchange = Exchange::begin(self);
        let mut next_update = Instant::now();
        while !stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
            if Instant::now() >= next_update {
                exchange.look(self);
                next_update = sleep::after(Instant::now(), self.update_rate);
            }
            if exchange.carry() {
                sleep::until(sleep::after(Instant::now(), self.item_transfer), stops);
                exchange.deliver(self);
            } else {
                sleep::until(next_update, stops);
            }
        }
    }
}

/// What a link has seen, and what of it is under way.
pub(super) struct Exchange {
    taken: Vec<Vec<u8>>,
    queue: VecDeque<usize>,
    carried: Option<usize>,
}

impl Exchange {
    /// A subscription begins with the value that each item has.
    pub(super) fn begin(link: &OpcLink) -> Self {
        let taken = link.routes.iter().map(|route| link.source.get(route.source)).collect();
        Self { taken, queue: (0..link.routes.len()).collect(), carried: None }
    }

    /// Takes the items that changed. One that still waits in the queue keeps its place and loses its
    /// old value.
    pub(super) fn look(&mut self, link: &OpcLink) {
        for (index, route) in link.routes.iter().enumerate() {
            let value = link.source.get(route.source);
            if value != self.taken[index] {
                self.taken[index] = value;
                if !self.queue.contains(&index) {
                    self.queue.push_back(index);
                }
            }
        }
    }

    /// Takes the next item from the queue; false if there is none.
    pub(super) fn carry(&mut self) -> bool {
        self.carried = self.queue.pop_front();
        self.carried.is_some()
    }

    /// The item that was carried arrives, with the newest value that was seen of it.
    pub(super) fn deliver(&mut self, link: &OpcLink) {
        let Some(route) = self.carried.take() else { return };
        for (items, index) in &link.routes[route].targets {
            items.put(*index, &self.taken[route]);
        }
    }
}
