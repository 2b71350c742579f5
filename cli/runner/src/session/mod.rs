//! Part in a session that another process serves: as one of its clients, or as its operator.

mod error;

use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;

use onescan_base::foreign::one_line;
use onescan_report::OutputError;
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::mailbox::Wish;
use onescan_server::operation::Operation;
use onescan_server::signal::{ClientName, SignalName, SignalType};
use onescan_server::transport::tcp::Entrance;
use onescan_server::transport::tcp::operator::OperatorConnection;
use onescan_server::transport::tcp::participant::{ParticipantError, take_part};
use onescan_server::wire::message::Status;

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

/// What somebody asks of a session.
#[derive(Clone, Debug)]
pub enum Asked {
    /// Its state and virtual time.
    Status,
    /// An operation on it.
    Do(Operation),
    /// The values of signals.
    Get(Vec<SignalName>),
    /// The values of signals whenever one has changed, read at this interval of wall-clock time.
    Watch(Vec<SignalName>, Duration),
}

/// Asks a session and writes what it says to `out`.
///
/// # Errors
/// The session does not answer, or does not want it.
pub fn control(server: Entrance, asked: Asked, format: Format, out: &mut dyn Write) -> Result<(), SessionError> {
    let mut session = OperatorConnection::open(server)?;
    let wish = match asked {
        Asked::Status => Wish::Look(Vec::new()),
        Asked::Do(operation) => Wish::Do(operation),
        Asked::Get(signals) => {
            let status = session.ask(Wish::Look(signals.clone()), OPERATOR_PATIENCE)?;
            let written = match format {
                Format::Json => json(&status, out),
                Format::Human => values(&session, &signals, &status, out),
            };
            return Ok(written.map_err(OutputError)?);
        }
        Asked::Watch(signals, interval) => return watch(&mut session, &signals, interval, format, out),
    };
    let status = session.ask(wish, OPERATOR_PATIENCE)?;
    let written = match format {
        Format::Json => json(&status, out),
        Format::Human => {
            let held = if status.held { "held" } else { "running" };
            writeln!(out, "{held} in state {} after step {}, t_v = {}", status.state, status.steps, status.t_v)
        }
    };
    Ok(written.map_err(OutputError)?)
}

fn json(status: &Status, out: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer(&mut *out, status).map_err(io::Error::from)?;
    writeln!(out)
}

/// A line for each signal.
fn values(
    session: &OperatorConnection,
    signals: &[SignalName],
    status: &Status,
    out: &mut dyn Write,
) -> io::Result<()> {
    let width = signals.iter().map(|signal| signal.as_str().len()).max().unwrap_or(0);
    for signal in signals {
        let declared = session.signals().iter().find(|declared| declared.name == *signal);
        let is_bool = declared.is_some_and(|declared| declared.ty == SignalType::BOOL);
        let value = match status.values.get(signal).map_or("", String::as_str) {
            "0" if is_bool => "FALSE",
            "1" if is_bool => "TRUE",
            value => value,
        };
        let unit = declared.and_then(|declared| declared.unit.as_ref()).map(|unit| format!(" {unit}"));
        writeln!(out, "{:width$} = {}{}", signal.as_str(), one_line(value), unit.unwrap_or_default())?;
    }
    Ok(())
}

/// Writes a block whenever a signal has changed, until the session is over.
fn watch(
    session: &mut OperatorConnection,
    signals: &[SignalName],
    interval: Duration,
    format: Format,
    out: &mut dyn Write,
) -> Result<(), SessionError> {
    let mut before: Option<Status> = None;
    loop {
        let status = match session.ask(Wish::Look(signals.to_vec()), OPERATOR_PATIENCE) {
            Ok(status) => status,
            // Its connection ends with the session.
            Err(ParticipantError::Handshake(error)) if before.is_some() && error.is_disconnect() => return Ok(()),
            Err(error) => return Err(error.into()),
        };
        if before.as_ref().is_none_or(|before| before.values != status.values) {
            let written = match format {
                Format::Json => json(&status, out),
                Format::Human => {
                    writeln!(out, "t_v = {}", status.t_v).and_then(|()| values(session, signals, &status, out))
                }
            };
            written.and_then(|()| out.flush()).map_err(OutputError)?;
        }
        before = Some(status);
        std::thread::sleep(interval);
    }
}
