//! Commands that are typed while the PLC runs, as at the switch of a real one.

use std::io::{BufRead, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use onescan_base::threads;
use onescan_links::station::{Controller, Status};
use onescan_report::OutputError;
use onescan_server::signal::did_you_mean;

use super::error::PlcError;
use crate::error::{ExitCode, ThreadError};
use crate::interrupt::Interrupt;

/// How often Ctrl-C is looked for.
const GLANCE: Duration = Duration::from_millis(50);

/// The commands there are.
const COMMANDS: [&str; 6] = ["run", "stop", "cold", "warm", "status", "quit"];

/// Does what is typed on standard input until `quit` or Ctrl-C; the end of the input is not the PLC's.
///
/// # Errors
/// The answers cannot be written, or there is no thread.
pub fn attend(controller: &Controller, interrupt: &Interrupt, out: &mut dyn Write) -> Result<ExitCode, PlcError> {
    let mut lines = Some(typed().map_err(ThreadError)?);
    interrupt.watch();
    while !interrupt.is_raised() {
        let Some(typed) = &lines else {
            std::thread::sleep(GLANCE);
            continue;
        };
        match typed.recv_timeout(GLANCE) {
            Ok(line) => match obey(line.trim(), controller) {
                Some(answer) => writeln!(out, "{answer}").and_then(|()| out.flush()).map_err(OutputError)?,
                None => break,
            },
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => lines = None,
        }
    }
    Ok(if controller.status().fault.is_some() { ExitCode::Fault } else { ExitCode::Ok })
}

/// Lines of standard input, read in a thread that ends with the process.
fn typed() -> std::io::Result<Receiver<String>> {
    let (sender, receiver) = channel();
    threads::start("operator", move || {
        let lines = std::io::stdin().lock().lines();
        for line in lines.map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    })?;
    Ok(receiver)
}

/// What is said of a command; nothing for the one that ends it all.
fn obey(command: &str, controller: &Controller) -> Option<String> {
    match command {
        "run" => controller.set_running(true),
        "stop" => controller.set_running(false),
        "cold" => controller.start_cold(),
        "warm" => controller.start_warm(),
        "status" | "" => {}
        "quit" => return None,
        other => {
            let hint = did_you_mean(other, COMMANDS).unwrap_or_else(|| format!("known are: {}", COMMANDS.join(", ")));
            return Some(format!("no command `{other}`; {hint}"));
        }
    }
    Some(status(controller))
}

/// How the PLC is, in a line.
pub(super) fn status(controller: &Controller) -> String {
    let Status { running, boots, cycles, session, fault } = controller.status();
    let state = if running { "RUN" } else { "STOP" };
    let session = session.map_or_else(
        || "in no session".to_owned(),
        |(session, grants)| format!("in session {session} with {grants} grants done"),
    );
    let fault = fault.map(|fault| format!(", {fault}")).unwrap_or_default();
    format!("{state}, start {}, {cycles} cycles, {session}{fault}", boots.saturating_add(1))
}
