//! Runtimes for listeners and links. The library panics where it gets no descriptor for its signals or no thread for its
//! workers, so both are tried before it is asked.

use std::io;

use onescan_base::threads;
use tokio::runtime::{Builder, Runtime};

/// A runtime for the thread that enters it.
///
/// # Errors
/// The system has no descriptors for it.
pub fn of_this_thread() -> io::Result<Runtime> {
    try_descriptors()?;
    Builder::new_current_thread().enable_all().build()
}

/// A runtime with a thread of its own beside the one that enters it.
///
/// # Errors
/// The system has no descriptors or no thread for it.
pub fn with_a_thread() -> io::Result<Runtime> {
    try_descriptors()?;
    // What became of it does not matter: it could be started.
    drop(threads::start("runtime", || ())?.join());
    Builder::new_multi_thread().worker_threads(1).enable_all().build()
}

/// As many descriptors as a runtime takes, and a few more.
#[cfg(unix)]
fn try_descriptors() -> io::Result<()> {
    let pair = std::os::unix::net::UnixStream::pair;
    let _taken = [pair()?, pair()?, pair()?, pair()?];
    Ok(())
}

#[cfg(not(unix))]
#[expect(clippy::unnecessary_wraps, reason = "elsewhere they are limited")]
fn try_descriptors() -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runtimes_are_there() {
        assert_eq!(of_this_thread().unwrap().block_on(async { 1 }), 1);
        assert_eq!(with_a_thread().unwrap().block_on(async { 2 }), 2);
    }
}
