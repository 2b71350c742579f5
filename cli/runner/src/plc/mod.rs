//! `onescan plc`: a soft PLC as a process of its own, which free-wheels and is operated as a real one is.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`operator`] | commands that are typed while it runs |

pub mod config;
mod error;
pub mod operator;

use std::io::Write;
use std::sync::Arc;
use std::time::Duration;

use onescan_iec::Diagnostics;
use onescan_iec_run::SoftPlc;
use onescan_links::gateway::modbus::RegisterMap;
use onescan_links::gateway::tcp::Layouts;
use onescan_links::gateway::{HandshakeKind, MappingFault};
use onescan_links::opcua::ServeError;
use onescan_links::station::opcua::ServedPlc;
use onescan_links::station::wires::word;
use onescan_links::station::{Clockwork, Controller, Wires, ads, modbus, opcua, s7, tcp};
use onescan_report::OutputError;
use onescan_scenario::file::ClientFile;
use onescan_scenario::gateway::Instrumented;
use onescan_scenario::{Mode, Scenario};
use onescan_server::signal::ClientName;

pub use config::{Cycle, PlcConfig};
pub use error::PlcError;

use crate::error::{ListenError, ThreadError, Usage};

use crate::error::ExitCode;
use crate::interrupt::Interrupt;

/// Lines about what goes by the PLC's own clock that are shown.
const WARNED: usize = 5;

/// Warns of what of a program in lockstep goes by the PLC's own clock all the same: its runs are not those of the soft PLC.
fn warn_of_clocks(warnings: &Diagnostics) {
    let text = warnings.to_string();
    let is_of_clocks = |line: &&str| ["[I1001]", "[I1002]"].iter().any(|code| line.contains(code));
    let lines: Vec<&str> = text.lines().filter(is_of_clocks).collect();
    for line in lines.iter().take(WARNED) {
        tracing::warn!("{line}");
    }
    if let Some(more @ 1..) = lines.len().checked_sub(WARNED) {
        tracing::warn!("{more} more go by the PLC's own clock: `onescan instrument` lists them");
    }
}

/// Runs the PLC until it is asked to quit.
///
/// # Errors
/// The scenario has no such PLC, its sources are wrong, or an address cannot be listened on.
pub fn run(config: &PlcConfig, interrupt: &Interrupt, out: &mut dyn Write) -> Result<ExitCode, PlcError> {
    let scenario = Scenario::load(&config.scenario)?;
    let name = the_plc(&scenario, config.client.as_ref())?;
    let program = scenario.instrumented(&name, config.mode)?;
    if program.settings.handshake == HandshakeKind::Frames && config.mode == Mode::Lockstep {
        let help = "add `--mode freewheel`: its program runs by its own clock, as one that is not instrumented";
        return Err(Usage::new(
            "the blocks of this PLC are counted, so that nobody grants its scans",
            Some(help.into()),
        )
        .into());
    }
    if config.mode == Mode::Lockstep {
        warn_of_clocks(&program.warnings);
    }
    let wrong = |text: String| PlcError::Scenario(scenario.wrong_client(&name, text, None));
    let plc = SoftPlc::new(&program.application, &program.plan).map_err(|error| scenario.not_set_up(&name, &error))?;
    let wires = Wires::new(&program.exchange, &program.application, &program.bindings);
    let wires = wires.map_err(|error| wrong(error.to_string()))?;
    let mut controller = Controller::new(plc, wires);
    // A gateway that counts its starts starts it; where a scenario says that nobody does, it is as real as that.
    if config.mode == Mode::Lockstep && program.settings.system_words.is_none() {
        controller = controller.starting_itself();
    }
    if config.mode == Mode::Freewheel {
        let simulated = word(&program.application, "SDSP_Simulated").map_err(|error| wrong(error.to_string()))?;
        controller = controller.with_preset(simulated.offset as usize, vec![0]);
    }
    let controller = Arc::new(controller);
    let (urls, _served) = serve(config, &scenario, &name, &program, &controller)?;
    let clockwork = Clockwork::start(Arc::clone(&controller), config.cycle.interval()).map_err(ThreadError)?;
    for url in &urls {
        writeln!(out, "serving {url}").map_err(OutputError)?;
    }
    if let Some(address) = config.tcp_connect {
        writeln!(out, "connecting to {address}").map_err(OutputError)?;
    }
    writeln!(out, "{}", operator::status(&controller)).and_then(|()| out.flush()).map_err(OutputError)?;
    let code = operator::attend(&controller, interrupt, out)?;
    drop(clockwork);
    Ok(code)
}

/// The PLC that is meant: the only soft PLC, if no name is given.
fn the_plc(scenario: &Scenario, wanted: Option<&ClientName>) -> Result<ClientName, PlcError> {
    if let Some(name) = wanted {
        return Ok(name.clone());
    }
    let is_plc = |client: &toml::Spanned<ClientFile>| matches!(client.get_ref(), ClientFile::SoftPlc { .. });
    let mut plcs = scenario.file().clients.iter().filter(|(_, client)| is_plc(client)).map(|(name, _)| name);
    match (plcs.next(), plcs.next()) {
        (Some(one), None) => Ok(one.clone()),
        (None, _) => Err(Usage::new("the scenario has no soft PLC", None).into()),
        (Some(one), Some(other)) => {
            let help = Some(format!("say which: `--client {one}` or `--client {other}`"));
            Err(Usage::new("the scenario has several soft PLCs", help).into())
        }
    }
}

/// The addresses of the servers, and the one over OPC UA as long as it runs.
type Served = (Vec<String>, Option<Box<dyn ServedPlc>>);

/// Opens the servers that are asked for.
fn serve(
    config: &PlcConfig,
    scenario: &Scenario,
    name: &ClientName,
    program: &Instrumented,
    controller: &Arc<Controller>,
) -> Result<Served, PlcError> {
    let (mut urls, mut served) = (Vec::new(), None);
    let unfit = |fault: MappingFault| PlcError::Scenario(scenario.wrong_client(name, fault.message, fault.help));
    let blocks = || -> Result<tcp::Blocks, PlcError> {
        let layouts = Layouts::new(&program.settings.layout, &program.exchange).map_err(unfit)?;
        let push = config.push.map(|interval| Duration::from_nanos(interval.as_nanos()));
        Ok(tcp::Blocks { layouts, push })
    };
    if let Some(address) = config.tcp_connect {
        tcp::connect(address, controller, blocks()?).map_err(ThreadError)?;
    }
    if let Some(address) = config.tcp {
        let address = tcp::serve(address, controller, blocks()?).map_err(ListenError::on(address))?;
        urls.push(format!("tcp://{address}"));
    }
    if let Some(address) = config.s7 {
        let layouts = Layouts::new(&program.settings.layout, &program.exchange).map_err(unfit)?;
        let address = s7::serve(address, controller, program.settings.s7, layouts).map_err(ListenError::on(address))?;
        urls.push(format!("s7://{address}"));
    }
    if let Some(address) = config.modbus {
        let map = RegisterMap::new(&program.settings.modbus, &program.exchange).map_err(unfit)?;
        let address = modbus::serve(address, controller, map).map_err(ListenError::on(address))?;
        urls.push(format!("modbus://{address}"));
    }
    if let Some(address) = config.ads {
        let options = &program.settings.ads;
        let address = ads::serve(address, controller, options).map_err(ListenError::on(address))?;
        urls.push(format!("ads://{address}"));
    }
    if let Some(address) = config.opcua {
        let running = opcua::serve(address, controller, &config.access).map_err(|error| match error {
            ServeError::Io(source) => PlcError::from(ListenError { address, source }),
            error => Usage::new(error.to_string(), None).into(),
        })?;
        urls.push(format!("opc.tcp://{}", running.address()));
        served = Some(running);
    }
    Ok((urls, served))
}
