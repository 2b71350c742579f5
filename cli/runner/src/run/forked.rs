//! The past of a run that is shown as a page: who re-runs it, and what goes on from a moment of it.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};

use onescan_scenario::file::ClientFile;
use onescan_scenario::{Scenario, permission};
use onescan_server::pacing::Pace;
use onescan_server::time::VirtualTime;

use super::config::RunConfig;
use super::guard::{Group, Guard};
use super::in_process::in_process;
use crate::access::admission::Admission;
use crate::error::Usage;
use crate::past::Form;
use crate::web::Launch;
use onescan_base::notice::NOTICE;
use onescan_base::threads;

/// Why the past of a run of `scenario` cannot be shown: a client of it that cannot be saved and run again.
pub(crate) fn fork_blocker(scenario: &Scenario, config: Option<&RunConfig>) -> Option<String> {
    const REAL: &str = "a real PLC";
    const PROGRAM: &str = "a program of its own";
    scenario.file().clients.iter().find_map(|(name, client)| {
        let is_gateway = config.is_some_and(|config| config.reach.gateways.iter().any(|(gateway, _)| gateway == name));
        let is_seated = config.is_some_and(|config| config.reach.opcua_clients.contains(name));
        let what = match client.get_ref() {
            ClientFile::Gateway { .. } => REAL,
            ClientFile::External { .. } | ClientFile::OpcUa { .. } => PROGRAM,
            ClientFile::Plant { .. } | ClientFile::SoftPlc { .. } | ClientFile::Operator { .. } => {
                if is_gateway {
                    REAL
                } else if is_seated {
                    PROGRAM
                } else {
                    return None;
                }
            }
        };
        Some(format!("client `{name}` is {what}, which cannot be saved and run again"))
    })
}

/// Forms further sessions of the scenario, in this process.
pub(crate) fn former(scenario: &Scenario) -> Form {
    let scenario = scenario.unobserved();
    Box::new(move || {
        let elsewhere = |name: &_, _: &_| Usage::new(format!("client `{name}` is not in this process"), None);
        let mut lockstep = in_process(&scenario, VirtualTime::MAX, [], elsewhere).map_err(|error| error.to_string())?;
        lockstep.set_until(None);
        lockstep.set_settings(scenario.session_settings());
        Ok(lockstep)
    })
}

/// The line with which a session says where its page is, up to the address.
pub(super) const PAGE_AT: &str = "the session is at ";

/// What a session is given that goes on from another.
#[derive(Clone, Debug)]
pub(crate) struct ForkSettings {
    /// How many may run at a time.
    limit: u32,
    /// The scenario, its case, who is operated, what the page is: as they are typed.
    pub(crate) words: Vec<OsString>,
    /// When such a session is complete, unless the scenario says it.
    until: Option<VirtualTime>,
}

impl ForkSettings {
    /// What is typed beside where the page is, and who is let in there: at the same address, at a port of its own.
    pub(crate) fn at(
        (mut words, until): (Vec<OsString>, Option<VirtualTime>),
        web: Option<SocketAddr>,
        admission: &Admission,
        limit: u32,
    ) -> Self {
        let web = web.map_or(IpAddr::V4(Ipv4Addr::LOCALHOST), |address| address.ip());
        words.push(format!("--web={}", SocketAddr::new(web, 0)).into());
        // It may be short, its viewer has yet to come, and may look back.
        words.extend(["--await-viewer".into(), "--stay".into()]);
        if let Admission::Holders(folder) = admission {
            words.extend(["--access".into(), folder.clone().into()]);
        }
        // A fork may be forked, too, but not so often: all that come of one session are a few.
        words.extend(["--forks".into(), (limit / FORKS_OF_FORK).to_string().into()]);
        Self { limit, words, until }
    }

    /// As a run of `config`.
    pub(crate) fn of(config: &RunConfig) -> Self {
        let mut words: Vec<OsString> = vec![config.subject.scenario.clone().into()];
        let mut add = |option: &str, value: String| words.extend([option.into(), value.into()]);
        if let Some(case) = &config.subject.case {
            add("--case", case.clone());
        }
        for client in &config.reach.operated {
            add("--operator", client.to_string());
        }
        let pace = match config.course.pace {
            Pace::Max => "max".to_owned(),
            Pace::Factor(factor) => factor.to_string(),
        };
        add("--pace", pace);
        add("--past-memory", config.doors.past.to_string());
        Self::at((words, config.subject.until), config.doors.web, &config.doors.admission, config.doors.forks)
    }
}

/// Of so many forks that a session may have, each of them may have one.
const FORKS_OF_FORK: u32 = 4;

/// Sessions that went on from this one, each in a process of its own. They end with it.
#[derive(Debug, Default)]
struct ChildSessions {
    children: Vec<Child>,
    guard: Option<Guard>,
}

/// Lets sessions go on from checkpoints, as `fork_settings` says.
pub(crate) fn launcher(fork_settings: ForkSettings) -> Launch {
    let child_sessions = Mutex::new(ChildSessions::default());
    Arc::new(move |checkpoint, until| {
        // a thread that panicked under the lock has left whole values
        let mut child_sessions = child_sessions.lock().unwrap_or_else(PoisonError::into_inner);
        child_sessions.begin(checkpoint, &fork_settings, until).map_err(|error| error.to_string())
    })
}

impl ChildSessions {
    /// Begins a session of a process of its own, and waits until it says where its page is.
    fn begin(
        &mut self,
        checkpoint: &[u8],
        ForkSettings { words, limit, until }: &ForkSettings,
        other_end: Option<VirtualTime>,
    ) -> std::io::Result<String> {
        self.children.retain_mut(|child| !matches!(child.try_wait(), Ok(Some(_))));
        if self.children.len() >= *limit as usize {
            let running = self.children.len();
            return Err(std::io::Error::other(match limit {
                0 => "a fork of a fork has no forks of its own: fork the first session, or allow more there with `--forks`".to_owned(),
                _ => format!("{running} forks of this session run already: end one of them, or allow more with `--forks`"),
            }));
        }
        let mut file = tempfile::Builder::new().prefix("onescan-fork-").suffix(".checkpoint").tempfile()?;
        file.write_all(checkpoint)?;
        file.flush()?;
        let path: PathBuf = file.path().to_owned();
        if self.guard.is_none() {
            self.guard = Some(Guard::start()?);
        }
        let mut command = Command::new(std::env::current_exe()?);
        command.arg("run").args(words).arg("--resume").arg(&path);
        if let Some(until) = other_end.or(*until) {
            command.arg("--until").arg(format!("{}ns", until.as_nanos()));
        }
        command.envs(permission::granted().variables());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn()?;
        if let Some(guard) = &mut self.guard {
            guard.watch(Group::led_by(&child));
        }
        let said = child.stderr.take();
        self.children.push(child);
        let said = said.ok_or_else(|| std::io::Error::other("the session has no voice"))?;
        // the file is read before the page is there
        address(BufReader::new(said))
    }
}

/// Reads where the page is; what is said after it is passed on.
fn address(mut said: BufReader<std::process::ChildStderr>) -> std::io::Result<String> {
    let (mut line, mut before) = (String::new(), String::new());
    while said.read_line(&mut line)? > 0 {
        if let Some((_, url)) = line.split_once(PAGE_AT) {
            let url = url.trim().to_owned();
            let pass_on = move || {
                said.lines().map_while(Result::ok).for_each(|line| tracing::info!(target: NOTICE, "fork: {line}"));
            };
            threads::start("fork", pass_on)?;
            return Ok(url);
        }
        before += &line;
        line.clear();
    }
    Err(std::io::Error::other(before.trim().to_owned()))
}

impl Drop for ChildSessions {
    fn drop(&mut self) {
        for child in &mut self.children {
            Group::led_by(child).kill();
            // it may have ended by itself; then there is nothing to do
            let _ = child.kill();
            let _ = child.wait();
        }
        if let Some(guard) = self.guard.take() {
            guard.dismiss();
        }
    }
}
