//! Room for what is nested: checker and code generator recurse into trees, up to the parser's limits.

use std::panic::resume_unwind;
use std::sync::Mutex;
use std::thread::{Builder, scope};

/// Of the stack they run on. The machine gives what is touched of it, no more.
const STACK_BYTES: usize = 64 << 20;

/// Does the work on a stack that has room for it, whatever stack the caller has; on the caller's if
/// the machine has no thread to give.
///
/// # Panics
/// With the panic of the work, if it has one.
pub fn with_room<T: Send, W: FnOnce() -> T + Send>(work: W) -> T {
    let slot = Mutex::new(Some(work));
    let run = || {
        let work = slot.lock().ok().and_then(|mut slot| slot.take());
        // One of the two callers below comes here, and once.
        work.expect("the work is done once")()
    };
    scope(|scope| match Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, run) {
        Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
        Err(_) => run(),
    })
}
