//! What the process of a submission may take of the machine: it limits itself before it reads anything.

use std::num::NonZeroU32;

use onescan_runner::error::Usage;

/// What a process says that the system has refused memory, in Rust's words.
pub(super) const OUT_OF_MEMORY: &str = "memory allocation of";

/// Lets this process take so many MiB of memory, and write no file. On systems other than Linux, only the limits of time
/// and output hold, which its parent keeps.
///
/// # Errors
/// The system refuses a limit.
#[cfg(target_os = "linux")]
pub(super) fn apply(memory_mib: NonZeroU32) -> Result<(), Usage> {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let bytes = u64::from(memory_mib.get()) << 20;
    // Memory that it can write to, and not what it reserves: machine code runs in a large reservation.
    for (resource, most) in [(Resource::Data, bytes), (Resource::Fsize, 0), (Resource::Core, 0)] {
        let limit = Rlimit { current: Some(most), maximum: Some(most) };
        setrlimit(resource, limit).map_err(|error| {
            let help = Some("give it more: `--memory-limit`".to_owned());
            Usage::new(format!("the limits of a submission's process cannot be set: {error}"), help)
        })?;
    }
    Ok(())
}

/// Does nothing where the system has no such limits.
#[cfg(not(target_os = "linux"))]
#[expect(clippy::unnecessary_wraps, reason = "where there are limits, the system may refuse them")]
pub(super) fn apply(_: NonZeroU32) -> Result<(), Usage> {
    Ok(())
}
