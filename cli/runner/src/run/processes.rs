//! Clients as processes of their own: started before the session, ended with it.

use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use onescan_server::signal::ClientName;

use super::config::Subject;
use super::error::RunError;
use super::guard::{Group, Guard};
use crate::access::admission::Shown;
use crate::environment;
use crate::error::SpawnError;

/// How long a process may take to leave once the session is over.
const LEAVE_TIMEOUT: Duration = Duration::from_secs(5);

/// What stands for the server's address in a command.
const SERVER: &str = "{server}";

/// What a scenario's own program sees of the environment.
pub(super) struct Passed<'p> {
    /// The variables that the scenario names.
    pub(super) named: &'p [String],
    /// What it shows to the session.
    pub(super) shown: Shown,
}

/// The processes of a session, and what they started themselves; none outlives it. Whatever ends this one, the
/// [`Guard`] ends them.
#[derive(Default)]
pub(super) struct Processes {
    children: Vec<(ClientName, Child)>,
    guard: Option<Guard>,
}

impl Processes {
    /// Starts this program as the client `name` of what is run.
    pub(super) fn start_client(
        &mut self,
        name: &ClientName,
        subject: &Subject,
        server: SocketAddr,
        shown: Shown,
    ) -> Result<(), RunError> {
        let program = std::env::current_exe().map_err(|source| SpawnError {
            client: name.to_string(),
            command: "onescan".to_owned(),
            source,
        })?;
        let mut command = Command::new(program);
        command.arg("join").arg(&subject.scenario).arg(name.as_str()).arg("--server").arg(server.to_string());
        if let Some(case) = &subject.case {
            command.arg("--case").arg(case);
        }
        command.envs(shown);
        self.start(name, command)
    }

    /// Starts a client's own command in the scenario's folder.
    pub(super) fn start_command(
        &mut self,
        name: &ClientName,
        words: &[String],
        folder: &Path,
        server: &str,
        pass: Passed<'_>,
    ) -> Result<(), RunError> {
        let Some((program, arguments)) = words.split_first() else { return Ok(()) };
        let mut command = Command::new(program);
        command.args(arguments.iter().map(|word| word.replace(SERVER, server)));
        if folder != Path::new("") {
            command.current_dir(folder);
        }
        environment::confine(&mut command, pass.named);
        command.envs(pass.shown);
        self.start(name, command)
    }

    fn start(&mut self, name: &ClientName, mut command: Command) -> Result<(), RunError> {
        let spawn = |command: &str| {
            let (client, command) = (name.to_string(), command.to_owned());
            move |source| SpawnError { client, command, source }
        };
        if self.guard.is_none() {
            self.guard = Some(Guard::start().map_err(spawn("onescan"))?);
        }
        command.stdin(Stdio::null()).stdout(Stdio::null());
        // Ctrl-C is for the server, which ends the session in order; clients leave when it does. What a client
        // starts is in its group and ends with it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let program = command.get_program().to_string_lossy().into_owned();
        let child = command.spawn().map_err(spawn(&program))?;
        if let Some(guard) = &mut self.guard {
            guard.watch(Group::led_by(&child));
        }
        self.children.push((name.clone(), child));
        Ok(())
    }

    /// A process that has ended, which before the session begins it must not.
    pub(super) fn first_ended(&mut self) -> Option<RunError> {
        self.children.iter_mut().find_map(|(name, child)| match child.try_wait() {
            Ok(Some(status)) => Some(RunError::ClientProcess { client: name.to_string(), status: status.to_string() }),
            // One that runs, or whose state cannot be read: its connection then shows whether it is there.
            Ok(None) | Err(_) => None,
        })
    }
}

impl Drop for Processes {
    /// The server has asked everybody to leave; what does not is killed, and what is left of its group.
    fn drop(&mut self) {
        let patience = Instant::now() + LEAVE_TIMEOUT;
        for (_, child) in &mut self.children {
            while matches!(child.try_wait(), Ok(None)) && Instant::now() <= patience {
                std::thread::sleep(Duration::from_millis(1));
            }
            Group::led_by(child).kill();
            // It may have ended by itself meanwhile; then there is nothing to do. The outcome of the session does not depend on
            // how its processes ended, so both errors are ignored.
            let _ = child.kill();
            let _ = child.wait();
        }
        if let Some(guard) = self.guard.take() {
            guard.dismiss();
        }
    }
}
