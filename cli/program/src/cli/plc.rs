//! With PLCs: `onescan plc`, `browse` and `map`.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_scenario::Mode;
use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;

use super::error::CommandError;
use super::opcua::AccessArgs;
use super::run::gateway;
use super::value::{FormatArg, client_name};
use crate::browse::BrowseConfig;
use crate::map::{self, MapConfig};
use onescan_runner::error::ExitCode;
use onescan_runner::interrupt::Interrupt;
use onescan_runner::plc::{self, Cycle, PlcConfig};

/// Options of `plc`.
#[derive(Debug, ClapArgs)]
#[command(after_help = PLC_COMMANDS)]
pub struct PlcArgs {
    /// The scenario: a folder with a `scenario.toml`
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// Which of its soft PLCs [default: the only one]
    #[arg(long, value_name = "CLIENT", value_parser = client_name)]
    pub client: Option<ClientName>,
    /// `lockstep`: its programs run when they are granted; `freewheel`: by its own clock and tasks, as if there
    /// were no shim
    #[arg(long, value_enum, default_value_t)]
    pub mode: PlcModeArg,
    /// How often it scans, wall clock: a time, or `max` for one scan behind the other
    #[arg(long, default_value = "1ms", value_name = "TIME|max")]
    pub cycle: Cycle,
    /// Where data blocks are served over raw TCP [default, if no protocol is named: each at a free port of
    /// this machine]
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub tcp: Option<SocketAddr>,
    /// Be the TCP client: send data blocks to a gateway that listens here, and try again until it does
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub tcp_connect: Option<SocketAddr>,
    /// Over raw TCP, send the block at this interval, wall clock, whether or not anything has changed, and at no
    /// other time [default: when it has changed, and when a block has come]
    #[arg(long, value_name = "TIME", value_parser = interval)]
    pub push: Option<TimeSpan>,
    /// Where data blocks are served over ISO-on-TCP, as an S7 does
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub s7: Option<SocketAddr>,
    /// Where registers are served over Modbus TCP
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub modbus: Option<SocketAddr>,
    /// Where symbols are served over ADS, as TwinCAT does
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub ads: Option<SocketAddr>,
    /// Where variables are served over OPC UA
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub opcua: Option<SocketAddr>,
    /// Who is let in over OPC UA
    #[command(flatten)]
    pub access: AccessArgs,
}

/// See [`Mode`]; how a plant keeps its cycle is not the PLC's business.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum PlcModeArg {
    /// Programs run when they are granted
    #[default]
    Lockstep,
    /// Programs run by the PLC's own clock; for runs with `--mode freewheel`, `halt` or `follow`
    Freewheel,
}

impl From<PlcModeArg> for Mode {
    fn from(arg: PlcModeArg) -> Self {
        match arg {
            PlcModeArg::Lockstep => Self::Lockstep,
            PlcModeArg::Freewheel => Self::Freewheel,
        }
    }
}

const PLC_COMMANDS: &str = "Commands on standard input:
  run, stop    the switch: RUN or STOP
  cold, warm   restart it: all variables with their initial values, or RETAIN kept
  status       how it is
  quit         end it";

/// A time that is longer than nothing.
fn interval(text: &str) -> Result<TimeSpan, String> {
    let span: TimeSpan = text.parse().map_err(|error| format!("write a time as in `10ms`: {error}"))?;
    if span.as_nanos() == 0 { Err("an interval is longer than 0".to_owned()) } else { Ok(span) }
}

/// Runs a soft PLC.
///
/// # Errors
/// See [`CommandError`].
pub fn run_plc(args: PlcArgs) -> Result<ExitCode, CommandError> {
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let named = [args.tcp, args.s7, args.modbus, args.ads, args.opcua];
    let is_served = args.tcp_connect.is_some() || named.iter().any(Option::is_some);
    let somewhere = (!is_served).then_some(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
    let [tcp, s7, modbus, ads, opcua] = named.map(|address| address.or(somewhere));
    let access = args.access.access()?;
    let (scenario, client, mode, cycle) = (args.scenario, args.client, args.mode.into(), args.cycle);
    let (tcp_connect, push) = (args.tcp_connect, args.push);
    let config = PlcConfig { scenario, client, mode, cycle, tcp, tcp_connect, push, s7, modbus, ads, opcua, access };
    Ok(plc::run(&config, &interrupt, &mut std::io::stdout().lock())?)
}

/// Options of `browse`.
#[derive(Debug, ClapArgs)]
pub struct BrowseArgs {
    /// The PLC, as in `opc.tcp://192.168.0.1:4840`
    pub url: String,
    /// Map the signals of this scenario, and use what it says of the link
    #[arg(long, value_name = "SCENARIO")]
    pub scenario: Option<PathBuf>,
    /// The client of the scenario that speaks for the PLC
    #[arg(long, value_name = "CLIENT", value_parser = client_name, default_value = "plc")]
    pub client: ClientName,
    /// Write the mapping into this file, as a part of a `scenario.toml`
    #[arg(long, value_name = "FILE")]
    pub map: Option<PathBuf>,
    /// For people, or one JSON object a variable for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Lists what a PLC has.
///
/// # Errors
/// See [`CommandError`].
pub fn browse(args: BrowseArgs) -> Result<ExitCode, CommandError> {
    let config = BrowseConfig {
        url: args.url,
        scenario: args.scenario.map(|path| (path, args.client)),
        map: args.map,
        format: args.format.into(),
    };
    crate::browse::run(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}

/// Options of `map`.
#[derive(Debug, ClapArgs)]
pub struct MapArgs {
    /// The scenario: a folder with a `scenario.toml`
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// Which of its PLCs [default: the only one]
    #[arg(long, value_name = "CLIENT", value_parser = client_name)]
    pub client: Option<ClientName>,
    /// The link, as in `plc=modbus://192.168.0.1` [default URL: the scenario's]
    #[arg(long, value_name = "CLIENT[=URL]", value_parser = gateway)]
    pub gateway: Option<(ClientName, Option<String>)>,
    /// For people, or one JSON object for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Write the mapping into this file, too, as a part of a `scenario.toml` with every address written out
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Prints where everything lies.
///
/// # Errors
/// See [`CommandError`].
pub fn map(args: MapArgs) -> Result<ExitCode, CommandError> {
    let MapArgs { scenario, client, gateway, format, output } = args;
    let config = MapConfig { scenario, client, gateway, format: format.into(), output };
    map::run(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}
