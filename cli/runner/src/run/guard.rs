//! Who ends the processes of a session if the server cannot: killed, or out of memory.
//!
//! The guard is this program once more, with a pipe to the server as its input. It gets the groups of processes that
//! are to end with the server. When the pipe closes before the guard was dismissed, the server is dead, and the guard
//! kills them. Only a process that leaves its group on purpose escapes. Outside of Unix there are no groups: on Windows a job
//! holds all that is started ([`crate::job`]), elsewhere the server's connection closes, and clients leave by themselves.

use std::io::{BufRead, Write};
use std::process::{Child, ChildStdin, Command, Stdio};

/// The word with which a guard may go.
const DISMISSED: &str = "dismissed";

/// A process and what it has started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Group(u32);

impl Group {
    /// The group of a process that was started as the first of its own.
    pub(super) fn led_by(child: &Child) -> Self {
        Self(child.id())
    }

    /// Ends all of its processes at once; whatever is gone is gone.
    #[cfg(unix)]
    pub(super) fn kill(self) {
        // The number may be wrong, for example if the guard's input was cut off. 0 would be this process's own group, and
        // 1 every process.
        let group = i32::try_from(self.0).ok().filter(|id| *id > 1).and_then(rustix::process::Pid::from_raw);
        if let Some(group) = group {
            // An error means that no process is left in the group, which is the aim.
            let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        }
    }

    /// There are no groups to kill.
    #[cfg(not(unix))]
    pub(super) fn kill(self) {
        let Self(_) = self;
    }
}

#[derive(Debug)]
pub(super) struct Guard {
    process: Child,
    orders: ChildStdin,
}

impl Guard {
    /// Starts it.
    pub(super) fn start() -> std::io::Result<Self> {
        let mut command = Command::new(std::env::current_exe()?);
        command.arg("guard").stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
        // What ends the server's group must leave it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut process = command.spawn()?;
        match process.stdin.take() {
            Some(orders) => Ok(Self { process, orders }),
            None => Err(std::io::Error::other("the guard has no input")),
        }
    }

    /// From now on this group ends with the server. A guard that was killed guards nothing; the session goes on.
    pub(super) fn watch(&mut self, group: Group) {
        if let Err(error) = writeln!(self.orders, "{}", group.0) {
            tracing::warn!(%error, "processes of clients may outlive this one");
        }
    }

    /// Everybody has left.
    pub(super) fn dismiss(self) {
        let Self { mut process, mut orders } = self;
        // If it is gone already, it need not be notified.
        let _ = writeln!(orders, "{DISMISSED}");
        drop(orders);
        // Its status says nothing that anybody could act on: the processes that it guarded have ended.
        let _ = process.wait();
    }
}

/// The guard's side: reads what it receives from `input`, and when that ends too early kills all groups.
pub fn stand(input: impl BufRead) {
    let mut groups = Vec::new();
    for line in input.lines() {
        match line {
            Ok(line) if line == DISMISSED => return,
            // If the server died while it wrote a line, that line is not a number, or the number of another process.
            Ok(line) => groups.extend(line.parse().ok().map(Group)),
            // Input that cannot be read any more has ended too early, as with a dead server.
            Err(_) => break,
        }
    }
    groups.into_iter().for_each(Group::kill);
}

#[cfg(all(test, unix))]
mod tests {
    use std::io::Read as _;
    use std::os::unix::process::CommandExt as _;

    use super::*;

    fn family() -> Child {
        let mut command = Command::new("sh");
        command.args(["-c", "sleep 300 & sleep 300"]).stdout(Stdio::piped()).process_group(0);
        command.spawn().expect("a process")
    }

    /// Ends when nobody of the family is left to write.
    fn wait_for_all(mut child: Child) {
        let mut said = Vec::new();
        child.stdout.take().expect("a pipe").read_to_end(&mut said).expect("what it says");
        assert!(!child.wait().expect("an end").success());
    }

    #[test]
    fn when_the_server_is_gone_children_and_grandchildren_end() {
        let (first, second) = (family(), family());
        stand(format!("{}\n{}\n", first.id(), second.id()).as_bytes());
        wait_for_all(first);
        wait_for_all(second);
    }

    #[test]
    fn a_guard_that_is_dismissed_ends_nobody() {
        let mut child = family();
        stand(format!("{}\n{DISMISSED}\n", child.id()).as_bytes());
        assert!(child.try_wait().unwrap().is_none());
        Group::led_by(&child).kill();
        wait_for_all(child);
    }
}
