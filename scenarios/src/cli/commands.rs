//! What each command does.

use std::io::{IsTerminal, Write};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::time::Duration;

use onescan_clients::station::opcua::Access;
use onescan_server::record::Choice;
use onescan_server::recording::ExportFormat;
use onescan_server::time::VirtualTime;
use onescan_server::transport::tcp::operator::operate;
use onescan_server::transport::tcp::participant::take_part;

use super::args::{
    BisectArgs, BrowseArgs, CheckArgs, Command, CompareArgs, ControlArgs, DiffArgs, ExplainArgs, ExportArg, ExportArgs,
    InstrumentArgs, JoinArgs, PlcArgs, RecordAlso, RunArgs,
};
use crate::bisect::BisectConfig;
use crate::browse::BrowseConfig;
use crate::check::{self, CheckConfig, Warnings};
use crate::diff::DiffConfig;
use crate::export::ExportConfig;
use crate::instrument::{Destination, Diff, Direction, InstrumentConfig};
use crate::new;
use crate::plant;
use crate::plc::{self, PlcConfig};
use crate::run::compare::CompareConfig;
use crate::run::config::SaveRequest;
use crate::run::coverage::CoverageRequest;
use crate::run::error::{ExitCode, RunError};
use crate::run::interrupt::Interrupt;
use crate::run::recorded::RecordRequest;
use crate::run::{Format, RunConfig, execute};
use crate::scenario::Scenario;
use crate::scenario::compose::Member;
use crate::wiring::{self, WiringConfig};

/// How long an operator waits for the next step boundary.
const OPERATOR_PATIENCE: Duration = Duration::from_secs(30);

/// Does what was typed.
///
/// # Errors
/// See [`RunError`].
pub fn dispatch(command: Command) -> Result<ExitCode, RunError> {
    match command {
        Command::Run(args) => run(*args),
        Command::Compare(args) => compare(args),
        Command::Test(args) => crate::regress::test(&args.config(), &mut std::io::stdout().lock()),
        Command::Review(args) => crate::review::review(&args.config(), &mut std::io::stdout().lock()),
        Command::TestWorker(args) => {
            crate::regress::worker::work(&args.config(), &mut std::io::stdout().lock())?;
            Ok(ExitCode::Ok)
        }
        Command::Join(args) => join(&args),
        Command::Control(args) => control(&args),
        Command::Export(args) => export(args),
        Command::Diff(args) => diff(args),
        Command::Bisect(args) => bisect(args),
        Command::Check(args) => check(args),
        Command::Instrument(args) => instrument(*args),
        Command::Plc(args) => run_plc(args),
        Command::Browse(args) => browse(args),
        Command::Explain(args) => explain(&args),
        Command::Components(args) => {
            plant::components::write(args.kind.as_deref(), args.format.into(), &mut std::io::stdout().lock())?;
            Ok(ExitCode::Ok)
        }
        Command::Wiring(args) => {
            let config = WiringConfig { scenario: args.scenario, format: args.format.into(), svg: args.svg };
            let sound = wiring::write(&config, &mut std::io::stdout().lock())?;
            Ok(if sound { ExitCode::Ok } else { ExitCode::WrongInput })
        }
        Command::New(args) => {
            new::write(&args.folder, args.template.into(), &mut std::io::stdout().lock())?;
            Ok(ExitCode::Ok)
        }
        Command::Describe(args) => {
            plant::describe::write(&args.scene, args.format.into(), &mut std::io::stdout().lock())?;
            Ok(ExitCode::Ok)
        }
    }
}

fn run(args: RunArgs) -> Result<ExitCode, RunError> {
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let verdict = execute(&config(args), &interrupt, &mut std::io::stdout().lock())?;
    Ok(verdict.exit_code())
}

fn compare(args: CompareArgs) -> Result<ExitCode, RunError> {
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let run = RunConfig {
        until: args.until,
        runs: args.runs,
        format: Format::Human,
        ..RunConfig::headless(args.scenario, None)
    };
    let config = CompareConfig { run, plot: args.plot, format: args.format.into() };
    crate::run::compare::compare(&config, &interrupt, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}

fn config(args: RunArgs) -> RunConfig {
    let format = args.format.into();
    RunConfig {
        scenario: args.scenario,
        case: args.case,
        until: args.until,
        pace: args.pace,
        mode: args.mode.into(),
        runs: args.runs,
        transport: args.transport.into(),
        gateways: args.gateways,
        record: args.record.map(|folder| RecordRequest {
            folder,
            choice: Choice {
                signals: args.record_signals,
                csv: args.record_also.contains(&RecordAlso::Csv),
                mcap: args.record_also.contains(&RecordAlso::Mcap),
            },
        }),
        replay_operator: args.replay_operator,
        format,
        plot: args.plot,
        signals: args.signals,
        watch: args.watch,
        watch_changes: args.watch_on == super::args::WatchOnArg::Change,
        coverage: args.coverage.map(|path| CoverageRequest::new(path, args.coverage_format.map(Into::into))),
        html: args.html,
        listen: args.listen,
        join_timeout: Duration::from_nanos(args.join_timeout.as_nanos()),
        reply_timeout: Duration::from_nanos(args.reply_timeout.as_nanos()),
        save: args.save_at.zip(args.save).map(|(at, path)| SaveRequest { at, path }),
        resume: args.resume,
        latency: args.latency,
        progress: format == Format::Human && std::io::stderr().is_terminal(),
    }
}

fn join(args: &JoinArgs) -> Result<ExitCode, RunError> {
    let scenario = Scenario::load_case(&args.scenario, args.case.as_deref())?;
    let mut client = match scenario.member(&args.client)? {
        Member::Plant(client) | Member::Plc(client) | Member::Gateway(client) => client,
        Member::External(_) => {
            let message = format!("client `{}` is external: its own program joins", args.client);
            return Err(RunError::usage(message, None));
        }
    };
    let end = take_part(client.as_mut(), args.server)?;
    tracing::info!(%end, "left");
    Ok(ExitCode::Ok)
}

fn run_plc(args: PlcArgs) -> Result<ExitCode, RunError> {
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let named = [args.tcp, args.modbus, args.opcua];
    let somewhere = named.iter().all(Option::is_none).then_some(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
    let [tcp, modbus, opcua] = named.map(|address| address.or(somewhere));
    let access = access(args.opcua_user, args.opcua_pki, args.opcua_trust)?;
    let (scenario, client, mode, cycle) = (args.scenario, args.client, args.mode.into(), args.cycle);
    let config = PlcConfig { scenario, client, mode, cycle, tcp, modbus, opcua, access };
    plc::run(&config, &interrupt, &mut std::io::stdout().lock())
}

fn browse(args: BrowseArgs) -> Result<ExitCode, RunError> {
    let config = BrowseConfig {
        url: args.url,
        scenario: args.scenario.map(|path| (path, args.client)),
        map: args.map,
        format: args.format.into(),
    };
    crate::browse::run(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}

fn access(user: Option<String>, pki: Option<PathBuf>, trust_clients: bool) -> Result<Access, RunError> {
    const PASSWORD: &str = "ONESCAN_OPCUA_PASSWORD";
    let user = match user {
        None => None,
        Some(user) => {
            let Ok(password) = std::env::var(PASSWORD) else {
                let help = Some(format!("set the environment variable {PASSWORD}"));
                return Err(RunError::usage(format!("there is no password for user `{user}`"), help));
            };
            Some((user, password))
        }
    };
    Ok(Access { user, pki, trust_clients })
}

fn control(args: &ControlArgs) -> Result<ExitCode, RunError> {
    let operation = args.operation().map_err(|message| RunError::usage(message, None))?;
    let status = operate(args.server, operation, OPERATOR_PATIENCE)?;
    let mut out = std::io::stdout().lock();
    let written = match Format::from(args.format) {
        Format::Json => {
            serde_json::to_writer(&mut out, &status).map_err(std::io::Error::from).and_then(|()| writeln!(out))
        }
        Format::Human => {
            let held = if status.held { "held" } else { "running" };
            writeln!(out, "{held} in state {} after step {}, t_v = {}", status.state, status.steps, status.t_v)
        }
    };
    written.map_err(RunError::Output)?;
    Ok(ExitCode::Ok)
}

fn export(args: ExportArgs) -> Result<ExitCode, RunError> {
    let extension = args.output.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    let format = match (args.format, extension.as_deref()) {
        (Some(ExportArg::Csv), _) | (None, Some("csv")) => ExportFormat::Csv,
        (Some(ExportArg::Parquet), _) | (None, Some("parquet")) => ExportFormat::Parquet,
        (Some(ExportArg::Mcap), _) | (None, Some("mcap")) => ExportFormat::Mcap,
        (None, _) => {
            let message = format!("the name `{}` does not say in which form to write", args.output.display());
            return Err(RunError::usage(message, Some("add `--format csv`, `parquet` or `mcap`".to_owned())));
        }
    };
    let times = [args.from.unwrap_or(VirtualTime::ZERO), args.to.unwrap_or(VirtualTime::MAX)];
    let ExportArgs { recording, output, signals, .. } = args;
    crate::export::export(&ExportConfig { recording, format, output, signals, times })?;
    Ok(ExitCode::Ok)
}

fn diff(args: DiffArgs) -> Result<ExitCode, RunError> {
    let DiffArgs { a, b, since, signals, format } = args;
    let config = DiffConfig { recordings: [a, b], since, signals, format: format.into() };
    crate::diff::diff(&config, &mut std::io::stdout().lock())
}

fn bisect(args: BisectArgs) -> Result<ExitCode, RunError> {
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let BisectArgs { scenario, good, bad, until, format } = args;
    let config = BisectConfig { scenario, good, bad, until, format: format.into() };
    crate::bisect::bisect(&config, &interrupt, &mut std::io::stdout().lock(), &mut std::io::stderr().lock())
}

fn check(args: CheckArgs) -> Result<ExitCode, RunError> {
    let warnings = if args.deny_warnings { Warnings::Denied } else { Warnings::Allowed };
    let config = CheckConfig { paths: args.paths, dialect: args.dialect, format: args.format.into(), warnings };
    check::check(&config, &mut std::io::stdout().lock())
}

fn instrument(args: InstrumentArgs) -> Result<ExitCode, RunError> {
    let destination = match args.output {
        Some(folder) => Destination::Folder(folder),
        None if args.in_place => Destination::InPlace,
        None => Destination::Nowhere,
    };
    let config = InstrumentConfig {
        project: args.project,
        direction: if args.remove { Direction::Remove } else { Direction::Attach },
        target: args.target.into(),
        tasks: args.tasks,
        destination,
        diff: if args.diff { Diff::Shown } else { Diff::Hidden },
        format: args.format.into(),
        warnings: if args.deny_warnings { Warnings::Denied } else { Warnings::Allowed },
    };
    crate::instrument::instrument(&config, &mut std::io::stdout().lock(), &mut std::io::stderr().lock())
}

fn explain(args: &ExplainArgs) -> Result<ExitCode, RunError> {
    let mut out = std::io::stdout().lock();
    match &args.code {
        Some(code) => check::explain::page(code, &mut out)?,
        None => check::explain::list(&mut out).map_err(RunError::Output)?,
    }
    Ok(ExitCode::Ok)
}
