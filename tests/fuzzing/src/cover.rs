//! Which branches of the program an input has taken: counters that LLVM's pass `sancov-module` puts into the project's own
//! crates, which `tests/fuzz` asks for and a plain build does not have. The pass is part of the stable compiler.

use std::sync::Mutex;

/// The counters of each object of the program, as address and length.
static REGIONS: Mutex<Vec<(usize, usize)>> = Mutex::new(Vec::new());

/// Called by each instrumented object before `main`.
#[unsafe(no_mangle)]
extern "C" fn __sanitizer_cov_8bit_counters_init(start: *mut u8, end: *mut u8) {
    let length = (end as usize).saturating_sub(start as usize);
    if let Ok(mut regions) = REGIONS.lock()
        && length > 0
        && !regions.contains(&(start as usize, length))
    {
        regions.push((start as usize, length));
    }
}

/// What has been seen of all inputs so far: for each counter the orders of magnitude at which it was found.
#[derive(Debug, Default)]
pub struct Seen {
    orders: Vec<u8>,
}

impl Seen {
    /// Nothing seen.
    pub fn new() -> Self {
        Self { orders: vec![0; counters()] }
    }

    /// Branches that were taken by any input.
    pub fn branches(&self) -> usize {
        self.orders.iter().filter(|orders| **orders != 0).count()
    }

    /// Takes what the counters say since the last call; true if there is something new among it.
    pub fn take(&mut self) -> bool {
        let mut is_new = false;
        let mut first = 0;
        for (start, length) in regions() {
            // SAFETY: the region is a static array of the program's own, which the pass has reported. Other threads may
            // count meanwhile; a count more or less does no harm.
            let counts = unsafe { std::slice::from_raw_parts_mut(start as *mut u8, length) };
            for (chunk, orders) in counts.chunks_mut(64).zip(self.orders[first..first + length].chunks_mut(64)) {
                if chunk.iter().fold(0, |any, count| any | count) == 0 {
                    continue;
                }
                for (count, seen) in chunk.iter_mut().zip(orders) {
                    let order = order_of(*count);
                    is_new |= *seen & order != order;
                    *seen |= order;
                    *count = 0;
                }
            }
            first += length;
        }
        is_new
    }
}

/// How often, as one bit: once, twice, up to 4, 16, 64 times, more.
fn order_of(count: u8) -> u8 {
    match count {
        0 => 0,
        1 => 1,
        2 => 2,
        3..=4 => 4,
        5..=16 => 8,
        17..=64 => 16,
        _ => 32,
    }
}

fn regions() -> Vec<(usize, usize)> {
    REGIONS.lock().map(|regions| regions.clone()).unwrap_or_default()
}

/// How many counters the program has; none in a plain build.
pub fn counters() -> usize {
    regions().iter().map(|(_, length)| length).sum()
}
