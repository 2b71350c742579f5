//! A machine that is busy with other things.

use std::sync::atomic::{AtomicBool, Ordering};

/// Ends the load when it goes, also by a failed assertion.
struct Ended<'a>(&'a AtomicBool);

impl Drop for Ended<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Does `work` beside more threads that spin than the machine has cores.
pub(crate) fn under_load<T>(work: impl FnOnce() -> T) -> T {
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let _at_the_end = Ended(&ended);
        for _ in 0..8 {
            scope.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        work()
    })
}
