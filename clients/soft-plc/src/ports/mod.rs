//! The ports of a soft PLC: what joins the lines of a session to what a program has of them.
//!
//! | module | subject |
//! |---|---|
//! | this file | the ports of a PLC, and their part in its turn |
//! | [`terminal`] | a serial terminal with a process image of 22 bytes |
//! | [`socket`] | a connection or a module's line, as the blocks of vendors have it |
//!
//! A turn lets bytes arrive and writes what is new into the PLC's variables, before the scan; after it, what the program
//! wants to send goes on its way.

mod socket;
mod terminal;

use std::ops::Range;

use onescan_iec_run::{Application, SoftPlc, Variable, WriteError};
use onescan_server::random::seed_for;
use onescan_server::signal::{Port as SignalPort, SignalName, SignalType};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use onescan_stream::connection::{Cuts, Role};
use onescan_stream::serial::Rate;
use onescan_stream::{ForeignPort, Form, Losses, Port, PortState};
use socket::{Reached, Socket};
use terminal::Terminal;
pub use terminal::TerminalKind;

/// A port as a scenario gives it to a PLC.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlcPort {
    pub name: String,
    /// The line that it reads, with its window.
    pub receive: (SignalName, u16),
    /// The line that it writes, with its window.
    pub transmit: (SignalName, u16),
    /// How it sends, and what the program has of it.
    pub way: PlcWay,
}

/// What a program has of a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlcWay {
    /// A terminal with a process image of 22 bytes.
    Serial {
        /// How fast bytes follow each other.
        rate: Rate,
        terminal: TerminalKind,
        /// Bytes that it keeps until the program takes them, in place of what the terminal has.
        receive_buffer: Option<usize>,
        /// Path of the variable that is the input of the process image.
        input: String,
        /// Path of the variable that is its output.
        output: String,
    },
    /// A communication module, which the program reaches by its number and its vendor's blocks.
    Module {
        /// How fast bytes follow each other.
        rate: Rate,
        /// The number that its blocks have for it.
        number: u16,
        /// Bytes that it keeps until the program takes them, in place of 1024.
        receive_buffer: Option<usize>,
    },
    /// A connection that the program begins, by its vendor's blocks.
    Tcp {
        /// Whom the port reaches, as the program says it.
        host: String,
        /// The number of the port there.
        number: u16,
        /// Where what is sent is cut.
        cuts: Cuts,
    },
}

/// Why a port cannot be.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PortError {
    /// A path that leads to no variable.
    #[error("port `{port}`: the PLC has no variable `{path}`")]
    Unknown {
        port: String,
        path: String,
        /// What may have been meant.
        help: Option<String>,
    },
    /// A variable that is not a process image.
    #[error("port `{port}`: `{path}` is {is}, of {bytes} bytes, and a process image of 22 bytes has 24 with its word")]
    NoImage { port: String, path: String, is: String, bytes: u32 },
    /// No block that could use it is in the program.
    #[error("port `{port}` is of TCP, and the program has no block that connects")]
    NoBlock { port: String },
    /// No block that could use it is in the program.
    #[error("port `{port}` is a module's, and the program has no block that sends or receives there")]
    NoModuleBlock { port: String },
    /// More than there is room for.
    #[error("port `{port}` is one too many: a PLC has at most {} of TCP and of modules", socket::COUNT)]
    Many { port: String },
}

/// All ports of a PLC.
#[derive(Default)]
pub(super) struct Ports {
    ports: Vec<Bound>,
}

struct Bound {
    name: String,
    port: Port,
    /// As it is at the set-up.
    fresh: Port,
    /// Whether the loss of bytes has been reported.
    is_reported: bool,
    end: End,
    /// Where its lines lie in the PLC's inputs and outputs.
    reads: Range<usize>,
    writes: Range<usize>,
}

/// The program's end of a port.
enum End {
    Terminal(Terminal),
    Socket(Socket),
}

/// What the ports of a PLC remember beside its memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PortsState(Vec<(PortState, terminal::TerminalState)>);

impl Ports {
    /// Ports of an application; `reads` and `writes` bytes of other signals lie before theirs.
    pub(super) fn bind(
        application: &Application,
        described: &[PlcPort],
        (mut reads, mut writes): (usize, usize),
        seed: u64,
    ) -> Result<Self, PortError> {
        let mut ports = Vec::new();
        let mut sockets = 0;
        for each in described {
            let windows = [each.receive.1, each.transmit.1];
            let seed = seed_for(seed, "port", &each.name);
            let (port, end) = match &each.way {
                PlcWay::Serial { rate, terminal, receive_buffer, input, output } => {
                    let images = [input, output].map(|path| image(application, &each.name, path));
                    let [input, output] = images;
                    let buffer = receive_buffer.unwrap_or_else(|| terminal.receive_buffer());
                    let port = Port::new(Form::Serial(*rate), windows, seed).with_buffer(buffer);
                    (port, End::Terminal(Terminal::new(*terminal, input?, output?)))
                }
                PlcWay::Module { rate, number, receive_buffer } => {
                    let buffer = receive_buffer.unwrap_or(socket::MODULE_BYTES);
                    let port = Port::new(Form::Serial(*rate), windows, seed).with_buffer(buffer);
                    let socket = Socket::bind(application, &each.name, sockets, Reached::Module(*number, *rate))?;
                    sockets += 1;
                    (port, End::Socket(socket))
                }
                PlcWay::Tcp { host, number, cuts } => {
                    let port = Port::new(Form::Connection(Role::Connects, *cuts), windows, seed);
                    let socket = Socket::bind(application, &each.name, sockets, Reached::Host(host, *number))?;
                    sockets += 1;
                    (port, End::Socket(socket))
                }
            };
            let [read, written] = port.types().map(SignalType::size);
            ports.push(Bound {
                name: each.name.clone(),
                fresh: port.clone(),
                port,
                is_reported: false,
                end,
                reads: reads..reads + read,
                writes: writes..writes + written,
            });
            (reads, writes) = (reads + read, writes + written);
        }
        Ok(Self { ports })
    }

    /// The signals of ports, those that are read and those that are written.
    pub(super) fn signals(described: &[PlcPort]) -> [Vec<SignalPort>; 2] {
        let signal =
            |(name, window): &(SignalName, u16)| SignalPort { name: name.clone(), ty: SignalType::Bytes(*window) };
        let read = described.iter().map(|each| signal(&each.receive)).collect();
        [read, described.iter().map(|each| signal(&each.transmit)).collect()]
    }

    /// The set-up: ports are as new, and the program knows which there are.
    pub(super) fn begin(&mut self, plc: &mut SoftPlc, outputs: &mut [u8]) -> Result<(), WriteError> {
        for bound in &mut self.ports {
            bound.port = bound.fresh.clone();
            match &mut bound.end {
                End::Terminal(terminal) => terminal.begin(),
                End::Socket(socket) => socket.begin(plc)?,
            }
            if let Some(output) = outputs.get_mut(bound.writes.clone()) {
                bound.port.show(output);
            }
        }
        Ok(())
    }

    /// Before a scan.
    pub(super) fn arrive(&mut self, now_ns: u64, inputs: &[u8], memory: &mut [u8]) {
        for Bound { name, port, end, reads, is_reported, .. } in &mut self.ports {
            port.arrive(now_ns, inputs.get(reads.clone()).unwrap_or_default());
            let Losses { window, buffer, .. } = port.losses();
            if !*is_reported && window + buffer > 0 {
                *is_reported = true;
                tracing::warn!(port = %name, now_ns, window, buffer, "bytes were lost before the PLC took them");
            }
            match end {
                End::Terminal(terminal) => terminal.exchange(port, memory),
                End::Socket(socket) => socket.arrive(port, memory),
            }
        }
    }

    /// After a scan.
    pub(super) fn depart(&mut self, now_ns: u64, inputs: &[u8], outputs: &mut [u8], memory: &mut [u8]) {
        for Bound { port, end, reads, writes, .. } in &mut self.ports {
            // a terminal sees what the scan has left at its next exchange
            if let End::Socket(socket) = end {
                socket.depart(port, memory);
            }
            let input = inputs.get(reads.clone()).unwrap_or_default();
            port.depart(now_ns, input, outputs.get_mut(writes.clone()).unwrap_or_default());
        }
    }

    /// True if there is none.
    pub(super) fn is_empty(&self) -> bool {
        self.ports.is_empty()
    }

    /// Bytes that did not get through so far, by the name of the port.
    pub(super) fn losses(&self) -> impl Iterator<Item = (&str, Losses)> {
        self.ports.iter().map(|bound| (bound.name.as_str(), bound.port.losses()))
    }

    pub(super) fn state(&self) -> PortsState {
        let state = |bound: &Bound| {
            let end = match &bound.end {
                End::Terminal(terminal) => terminal.state(),
                End::Socket(_) => terminal::TerminalState::default(),
            };
            (bound.port.state().clone(), end)
        };
        PortsState(self.ports.iter().map(state).collect())
    }

    /// Whether a state is one of these ports.
    pub(super) fn check(&self, state: &PortsState) -> Result<(), ForeignPort> {
        if state.0.len() != self.ports.len() {
            return Err(ForeignPort);
        }
        self.ports.iter().zip(&state.0).try_for_each(|(bound, (port, _))| bound.port.check(port))
    }

    /// Goes on from a state that [`check`](Self::check) accepts.
    pub(super) fn restore(&mut self, state: PortsState) -> Result<(), ForeignPort> {
        self.check(&state)?;
        for (bound, (port, end)) in self.ports.iter_mut().zip(state.0) {
            bound.port.restore(port)?;
            if let End::Terminal(terminal) = &mut bound.end {
                terminal.restore(end);
            }
        }
        Ok(())
    }
}

fn variable(application: &Application, port: &str, path: &str) -> Result<Variable, PortError> {
    application.variable(path).map_err(|unknown| PortError::Unknown {
        port: port.to_owned(),
        path: path.to_owned(),
        help: unknown.help,
    })
}

/// Where a process image of 22 bytes and its word lie.
fn image(application: &Application, port: &str, path: &str) -> Result<Range<usize>, PortError> {
    let found = variable(application, port, path)?;
    if found.size as usize != terminal::IMAGE_BYTES {
        let (port, path) = (port.to_owned(), path.to_owned());
        return Err(PortError::NoImage { port, path, is: found.type_name, bytes: found.size });
    }
    let start = found.offset as usize;
    Ok(start..start + terminal::IMAGE_BYTES)
}
