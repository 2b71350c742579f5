//! With a session that another process serves: `onescan join` and `control`.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_server::operation::Operation;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::TimeSpan;

use super::access::EntranceArgs;
use super::error::CommandError;
use super::value::{FormatArg, client_name, signal_name};
use onescan_runner::error::{ExitCode, Usage};
use onescan_runner::session::{self, Asked};

/// Options of `join`.
#[derive(Debug, ClapArgs)]
pub struct JoinArgs {
    /// The scenario: a folder with a `scenario.toml`
    pub scenario: PathBuf,
    /// The client to be
    #[arg(value_parser = client_name)]
    pub client: ClientName,
    /// The server's address
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub server: SocketAddr,
    /// The case that the server runs [default: the scenario as it is]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// What is shown to the session
    #[command(flatten)]
    pub entrance: EntranceArgs,
}

/// Takes part in a session.
///
/// # Errors
/// See [`CommandError`].
pub fn join(args: &JoinArgs) -> Result<ExitCode, CommandError> {
    let entrance = args.entrance.entrance(args.server)?;
    session::join(&args.scenario, args.case.as_deref(), &args.client, entrance)?;
    Ok(ExitCode::Ok)
}

/// Stands guard over the processes of a session, until it is dismissed or the session's own process has died.
pub fn guard() -> ExitCode {
    onescan_runner::run::guard::stand(std::io::stdin().lock());
    ExitCode::Ok
}

/// Options of `control`.
#[derive(Debug, ClapArgs)]
pub struct ControlArgs {
    /// The server's address
    pub server: SocketAddr,
    /// What to ask for
    #[arg(value_enum, default_value_t)]
    pub wish: WishArg,
    /// The signal to get, watch, write, force or release
    #[arg(required_if_eq_any([("wish", "get"), ("wish", "watch"), ("wish", "write"), ("wish", "force"), ("wish", "release")]),
        value_parser = signal_name)]
    pub signal: Option<SignalName>,
    /// Its value, as in `TRUE`, `-3` or `1.5`; with `get` and `watch`, more signals
    #[arg(required_if_eq_any([("wish", "write"), ("wish", "force")]), allow_negative_numbers = true)]
    pub value: Vec<String>,
    /// How often `watch` looks, in wall-clock time
    #[arg(long, value_name = "TIME", default_value = "100ms")]
    pub interval: TimeSpan,
    /// For people, or a JSON object for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// What is shown to the session
    #[command(flatten)]
    pub entrance: EntranceArgs,
}

/// What an operator may ask for.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum WishArg {
    /// Report its state and virtual time
    #[default]
    Status,
    /// Hold virtual time at the next step boundary
    Pause,
    /// Let it run again
    Resume,
    /// Read signals, in the order in which they are named
    Get,
    /// Read signals each time that one of them has changed, until the session is over
    Watch,
    /// Run exactly one step, then hold
    Step,
    /// Restart at virtual time 0
    Reset,
    /// End the session
    Stop,
    /// Give a signal a value until its writer writes it again
    Write,
    /// Hold a signal at a value, whatever its writer writes
    Force,
    /// Let a forced signal's writer write it again
    Release,
}

impl ControlArgs {
    /// What is asked.
    ///
    /// # Errors
    /// A signal or a value where none belongs, or no name of a signal.
    pub fn asked(&self) -> Result<Asked, String> {
        let done = match (self.wish, self.signal.clone(), &self.value[..]) {
            (WishArg::Get | WishArg::Watch, Some(first), more) => {
                let more = more.iter().map(|name| signal_name(name)).collect::<Result<Vec<_>, _>>()?;
                let signals: Vec<SignalName> = std::iter::once(first).chain(more).collect();
                return Ok(match self.wish {
                    WishArg::Get => Asked::Get(signals),
                    _ => Asked::Watch(signals, Duration::from_nanos(self.interval.as_nanos())),
                });
            }
            (WishArg::Write, Some(signal), [value]) => Operation::Write { signal, value: value.clone() },
            (WishArg::Force, Some(signal), [value]) => Operation::Force { signal, value: value.clone() },
            (WishArg::Write | WishArg::Force, Some(_), [_, more, ..]) | (WishArg::Release, Some(_), [more, ..]) => {
                return Err(format!("`{more}` means nothing here"));
            }
            (WishArg::Release, Some(signal), []) => Operation::Release { signal },
            (_, Some(signal), _) => return Err(format!("`{signal}` means nothing here")),
            (WishArg::Pause, ..) => Operation::Pause,
            (WishArg::Resume, ..) => Operation::Resume,
            (WishArg::Step, ..) => Operation::Step,
            (WishArg::Reset, ..) => Operation::Reset,
            (WishArg::Stop, ..) => Operation::Stop,
            // Signals that these need are asked for by the reader of the command line.
            (
                WishArg::Status | WishArg::Get | WishArg::Watch | WishArg::Write | WishArg::Force | WishArg::Release,
                ..,
            ) => {
                return Ok(Asked::Status);
            }
        };
        Ok(Asked::Do(done))
    }
}

/// Asks a session.
///
/// # Errors
/// See [`CommandError`].
pub fn control(args: &ControlArgs) -> Result<ExitCode, CommandError> {
    let asked = args.asked().map_err(|message| Usage::new(message, None))?;
    session::control(args.entrance.entrance(args.server)?, asked, args.format.into(), &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}
