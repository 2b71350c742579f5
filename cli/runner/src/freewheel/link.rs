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
        let mut taken: Vec<Vec<u8>> = self.routes.iter().map(|route| self.source.get(route.source)).collect();
        // A subscription begins with the value that each item has.
        let mut queue: VecDeque<usize> = (0..self.routes.len()).collect();
        let mut next_update = Instant::now();
        while !stops.iter().any(|stop| stop.load(Ordering::Relaxed)) {
            if Instant::now() >= next_update {
                self.look(&mut taken, &mut queue);
                next_update = sleep::after(Instant::now(), self.update_rate);
            }
            match queue.pop_front() {
                Some(route) => {
                    sleep::until(sleep::after(Instant::now(), self.item_transfer), stops);
                    deliver(&self.routes[route], &taken[route]);
                }
                None => sleep::until(next_update, stops),
            }
        }
    }

    /// Takes the items that changed. One that still waits in the queue keeps its place and loses its
    /// old value.
    fn look(&self, taken: &mut [Vec<u8>], queue: &mut VecDeque<usize>) {
        for (index, route) in self.routes.iter().enumerate() {
            let value = self.source.get(route.source);
            if value != taken[index] {
                taken[index] = value;
                if !queue.contains(&index) {
                    queue.push_back(index);
                }
            }
        }
    }
}

fn deliver(route: &Route, value: &[u8]) {
    for (items, index) in &route.targets {
        items.put(*index, value);
    }
}
