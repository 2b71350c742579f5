//! Part in a session that another process serves: as one of its clients, or as its operator.

mod error;

use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;

use onescan_report::OutputError;
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::operation::Operation;
use onescan_server::signal::ClientName;
use onescan_server::transport::tcp::Entrance;
use onescan_server::transport::tcp::operator::operate;
use onescan_server::transport::tcp::participant::take_part;

pub use error::SessionError;

use crate::error::Usage;
use crate::format::Format;

/// How long an operator waits for the next step boundary.
const OPERATOR_PATIENCE: Duration = Duration::from_secs(30);

/// Takes part in a session as the client `name` of a scenario.
///
/// # Errors
/// The scenario is wrong or has no such client for this program, or the session could not be had to its end.
pub fn join(scenario: &Path, case: Option<&str>, name: &ClientName, server: Entrance) -> Result<(), SessionError> {
    let scenario = Scenario::load_case(scenario, case)?;
    let mut client = match scenario.member(name)? {
        Member::Plant(client) | Member::Plc(client) | Member::Gateway(client) => client,
        Member::External(_) => {
            return Err(Usage::new(format!("client `{name}` is external: its own program joins"), None).into());
        }
        Member::Seated { .. } => {
            let message = format!("client `{name}` takes part over OPC UA: its own program does");
            return Err(Usage::new(message, None).into());
        }
    };
    let end = take_part(client.as_mut(), server)?;
    tracing::info!(%end, "left");
    Ok(())
}

/// Asks a session for something, or only how it is, and writes how it is then to `out`.
///
/// # Errors
/// The session does not answer, or does not want it.
pub fn control(
    server: Entrance,
    operation: Option<Operation>,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), SessionError> {
    let status = operate(server, operation, OPERATOR_PATIENCE)?;
    let written = match format {
        Format::Json => serde_json::to_writer(&mut *out, &status).map_err(io::Error::from).and_then(|()| writeln!(out)),
        Format::Human => {
            let held = if status.held { "held" } else { "running" };
            writeln!(out, "{held} in state {} after step {}, t_v = {}", status.state, status.steps, status.t_v)
        }
    };
    Ok(written.map_err(OutputError)?)
}
