//! Threads, which a system may refuse: containers and users have a limit of them. `std::thread::spawn` panics then.

use std::io;
use std::thread::{Builder, JoinHandle, Scope, ScopedJoinHandle};

/// Starts a thread of its own.
///
/// # Errors
/// The system has no thread to give; the error names the one that was wanted.
pub fn start<T: Send + 'static>(name: &str, work: impl FnOnce() -> T + Send + 'static) -> io::Result<JoinHandle<T>> {
    Builder::new().name(name.to_owned()).spawn(work).map_err(|error| refused(name, &error))
}

/// Starts a thread that ends before `scope` does.
///
/// # Errors
/// As [`start`].
pub fn start_in<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    name: &str,
    work: impl FnOnce() -> T + Send + 'scope,
) -> io::Result<ScopedJoinHandle<'scope, T>> {
    Builder::new().name(name.to_owned()).spawn_scoped(scope, work).map_err(|error| refused(name, &error))
}

fn refused(name: &str, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("cannot start the thread `{name}`: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_does_its_work() {
        assert_eq!(start("one", || 1).unwrap().join().unwrap(), 1);
        let two = std::thread::scope(|scope| start_in(scope, "two", || 2).unwrap().join().unwrap());
        assert_eq!(two, 2);
    }

    #[test]
    fn a_refusal_names_the_thread_and_keeps_its_kind() {
        let error = refused("web", &io::ErrorKind::WouldBlock.into());
        assert_eq!(error.kind(), io::ErrorKind::WouldBlock);
        assert!(error.to_string().starts_with("cannot start the thread `web`: "), "{error}");
    }
}
