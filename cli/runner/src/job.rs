//! What this process starts ends with it, on Windows: all of it is in one job of the system, which ends when the process does,
//! however that comes about. Elsewhere a guard does this for groups of processes ([`crate::run::guard`]).

#[cfg(windows)]
#[expect(
    unsafe_code,
    reason = "jobs are had by calls of the system alone, each of which stands here with what it needs"
)]
mod system {
    use std::io;
    use std::os::windows::io::{AsRawHandle as _, FromRawHandle as _, OwnedHandle};

    use windows_sys::Win32::System::JobObjects::{
        AssignProcessToJobObject, CreateJobObjectW, JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE,
        JOBOBJECT_EXTENDED_LIMIT_INFORMATION, JobObjectExtendedLimitInformation, SetInformationJobObject,
    };
    use windows_sys::Win32::System::Threading::GetCurrentProcess;

    /// A job whose processes end with its last handle.
    pub(super) fn new() -> io::Result<OwnedHandle> {
        // SAFETY: both pointers may be null, for a job without a name and of the usual rights.
        let handle = unsafe { CreateJobObjectW(std::ptr::null(), std::ptr::null()) };
        if handle.is_null() {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: the handle is a new one of its own, which nobody else closes.
        let job = unsafe { OwnedHandle::from_raw_handle(handle) };
        let mut limits = JOBOBJECT_EXTENDED_LIMIT_INFORMATION::default();
        limits.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE;
        let size = size_of::<JOBOBJECT_EXTENDED_LIMIT_INFORMATION>() as u32;
        // SAFETY: the information is of the class that is named and of the size that is said, and is only read.
        let set = unsafe {
            SetInformationJobObject(
                job.as_raw_handle(),
                JobObjectExtendedLimitInformation,
                std::ptr::from_ref(&limits).cast(),
                size,
            )
        };
        if set == 0 { Err(io::Error::last_os_error()) } else { Ok(job) }
    }

    /// Puts this process, and so all that it starts from now on, into a job.
    pub(super) fn enter(job: &OwnedHandle) -> io::Result<()> {
        // SAFETY: the job's handle is open, and that of the current process always is.
        let entered = unsafe { AssignProcessToJobObject(job.as_raw_handle(), GetCurrentProcess()) };
        if entered == 0 { Err(io::Error::last_os_error()) } else { Ok(()) }
    }
}

/// From now on what this process starts, and what that starts, ends with it. Where a system refuses that, it is logged, and
/// programs that do not leave when their connection closes outlive a process that is killed.
#[cfg(windows)]
pub fn hold_what_is_started() {
    let held = system::new().and_then(|job| system::enter(&job).map(|()| job));
    match held {
        // The handle stays open as long as the process lives: the system closes it, and so ends the job.
        Ok(job) => std::mem::forget(job),
        Err(error) => tracing::debug!(%error, "programs that are started may outlive this one"),
    }
}

/// The guard does it.
#[cfg(not(windows))]
pub fn hold_what_is_started() {}
