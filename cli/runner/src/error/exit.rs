//! Exit codes, and which of them each error stands for.

use std::io;

use onescan_links::gateway::{LinkFault, SettingsFault};
use onescan_recording::RecordingError;
use onescan_report::{FileError, OutputError};
use onescan_scenario::ScenarioError;
use onescan_server::formation::FormationError;
use onescan_server::observer::RecordError;
use onescan_server::transport::tcp::participant::ParticipantError;

use super::{ListenError, SpawnError, ThreadError, Unreadable, Usage};

/// The exit code of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitCode {
    Ok = 0,
    /// A run failed its expectations: those of its scenario, or runs that must be equal are not.
    Unmet = 1,
    /// The input is wrong: options, scenario, sources, checkpoint.
    WrongInput = 2,
    /// A client or a link failed, or what was found cannot be written.
    Fault = 3,
}

/// An error that ends the program.
pub trait Exit {
    /// Whose fault it is. [`ExitCode::Ok`] means that nobody is left to report to, and there is nothing to report.
    fn exit_code(&self) -> ExitCode;
}

impl Exit for Usage {
    fn exit_code(&self) -> ExitCode {
        ExitCode::WrongInput
    }
}

impl Exit for Unreadable {
    fn exit_code(&self) -> ExitCode {
        of_reading(&self.source)
    }
}

impl Exit for ListenError {
    fn exit_code(&self) -> ExitCode {
        of_reading(&self.source)
    }
}

impl Exit for ThreadError {
    fn exit_code(&self) -> ExitCode {
        ExitCode::Fault
    }
}

impl Exit for SpawnError {
    fn exit_code(&self) -> ExitCode {
        ExitCode::Fault
    }
}

impl Exit for OutputError {
    /// A reader that has left (`onescan explain --list | head -2`) has what he wanted: that is not a failure, and
    /// a shell with `pipefail` must not take it for one.
    fn exit_code(&self) -> ExitCode {
        if self.is_closed_pipe() { ExitCode::Ok } else { ExitCode::Fault }
    }
}

impl Exit for FileError {
    fn exit_code(&self) -> ExitCode {
        of_writing(&self.source)
    }
}

impl Exit for RecordError {
    /// The folder was there when the run began: whatever became of it since, nobody typed it.
    fn exit_code(&self) -> ExitCode {
        ExitCode::Fault
    }
}

impl Exit for RecordingError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Foreign { .. } | Self::Version { .. } | Self::Damaged { .. } | Self::Unmatched(_) => {
                ExitCode::WrongInput
            }
            Self::Output(source) => of_writing(source),
        }
    }
}

/// A path or an address that cannot be is a mistake of who typed it; that the system has no more descriptors, memory or
/// threads to give is not.
fn of_reading(source: &io::Error) -> ExitCode {
    use io::ErrorKind as Kind;
    let is_short = matches!(source.kind(), Kind::OutOfMemory | Kind::WouldBlock | Kind::QuotaExceeded);
    if is_short || source.raw_os_error().is_some_and(|code| TOO_MANY_FILES.contains(&code)) {
        ExitCode::Fault
    } else {
        ExitCode::WrongInput
    }
}

/// The system's codes for too many open files, of which the standard library has no kind: `ENFILE` and `EMFILE`, or
/// `ERROR_TOO_MANY_OPEN_FILES` and `WSAEMFILE`.
const TOO_MANY_FILES: [i32; 2] = if cfg!(windows) { [4, 10024] } else { [23, 24] };

/// A path that cannot be is a mistake of who typed it; a disk that is full or broken is not.
fn of_writing(source: &io::Error) -> ExitCode {
    use io::ErrorKind as Kind;
    match source.kind() {
        Kind::NotFound
        | Kind::PermissionDenied
        | Kind::AlreadyExists
        | Kind::NotADirectory
        | Kind::IsADirectory
        | Kind::ReadOnlyFilesystem
        | Kind::InvalidFilename
        | Kind::InvalidInput => ExitCode::WrongInput,
        _ => ExitCode::Fault,
    }
}

impl Exit for ScenarioError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Link { .. } | Self::Memory { .. } => ExitCode::Fault,
            Self::Unreadable { source, .. } => of_reading(source),
            Self::Outside { .. }
            | Self::Other { .. }
            | Self::Wrong { .. }
            | Self::UnknownCase { .. }
            | Self::Scene(_)
            | Self::Plc(_) => ExitCode::WrongInput,
        }
    }
}

impl Exit for SettingsFault {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Link(
                LinkFault::Unreachable { .. }
                | LinkFault::Listen { .. }
                | LinkFault::NobodyCame { .. }
                | LinkFault::Refused { .. }
                | LinkFault::Lost(_),
            ) => ExitCode::Fault,
            Self::Url(_)
            | Self::Mapping(_)
            | Self::Link(LinkFault::Mapping(_) | LinkFault::Setting(_) | LinkFault::Nonsense(_)) => {
                ExitCode::WrongInput
            }
        }
    }
}

impl Exit for FormationError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Missing { .. } | Self::Interrupted { .. } => ExitCode::Fault,
            Self::Refused(_) | Self::Unwritten(_) => ExitCode::WrongInput,
        }
    }
}

impl Exit for ParticipantError {
    fn exit_code(&self) -> ExitCode {
        if matches!(self, Self::Refused(_)) { ExitCode::WrongInput } else { ExitCode::Fault }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn what_the_system_has_no_more_of_is_a_fault() {
        let listening = |source: io::Error| ListenError { address: ([127, 0, 0, 1], 1).into(), source }.exit_code();
        assert_eq!(listening(io::Error::from_raw_os_error(TOO_MANY_FILES[1])), ExitCode::Fault);
        assert_eq!(listening(io::ErrorKind::WouldBlock.into()), ExitCode::Fault);
        assert_eq!(listening(io::ErrorKind::AddrInUse.into()), ExitCode::WrongInput);
    }

    #[test]
    fn a_full_disk_is_a_fault_and_a_wrong_path_is_not() {
        let file = |kind: io::ErrorKind| FileError { path: PathBuf::from("p.svg"), source: kind.into() }.exit_code();
        assert_eq!(file(io::ErrorKind::StorageFull), ExitCode::Fault);
        assert_eq!(file(io::ErrorKind::NotFound), ExitCode::WrongInput);
        let output = |kind: io::ErrorKind| OutputError(kind.into()).exit_code();
        assert_eq!(output(io::ErrorKind::StorageFull), ExitCode::Fault);
        assert_eq!(output(io::ErrorKind::BrokenPipe), ExitCode::Ok);
    }
}
