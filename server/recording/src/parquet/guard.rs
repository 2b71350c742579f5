//! What the library panics at in a damaged file is an error here.
//!
//! The library takes for granted much of what a file says: that a dictionary comes before what refers to it, that a
//! page is as long as its head says. Each such place is an index or an `expect` in its decoders, and there are many.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use parquet::errors::{ParquetError, Result};

thread_local! {
    /// Whether this thread reads a file, so that a panic is the file's and not for people to read.
    static READS: Cell<bool> = const { Cell::new(false) };
}

/// Reads by the library.
///
/// # Errors
/// Those of `read`, and a panic of the library.
pub(super) fn guarded<T>(read: impl FnOnce() -> Result<T>) -> Result<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !READS.get() {
                before(panic);
            }
        }));
    });
    READS.set(true);
    // What is left half done is dropped with the reader, or cleared before the next block is filled.
    let read = catch_unwind(AssertUnwindSafe(read));
    READS.set(false);
    read.unwrap_or_else(|_| Err(ParquetError::General("it is damaged: its pages contradict one another".to_owned())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_and_what_is_read_is_kept() {
        assert_eq!(guarded(|| Ok(7)).expect("read"), 7);
        let wrong = guarded(|| -> Result<u8> { panic!("index out of bounds") }).expect_err("a panic");
        assert!(wrong.to_string().contains("damaged"), "{wrong}");
        assert!(guarded(|| -> Result<u8> { Err(ParquetError::EOF("end".to_owned())) }).is_err());
    }
}
