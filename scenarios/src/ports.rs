//! The ports of soft PLCs, and their files: what must hold of them, and how they are made.

use std::collections::BTreeMap;
use std::path::Path;

use onescan_base::regular::Limit;
use onescan_server::signal::{ClientName, SignalName, SignalType, did_you_mean};
use onescan_server::time::TimeSpan;
use onescan_soft_plc::SoftPlcClient;
use onescan_soft_plc::ports::{PlcPort, PlcWay, TerminalKind};
use onescan_stream::connection::Cuts;
use onescan_stream::serial::Rate;

use crate::error::ScenarioError;
use crate::file::ClientFile;
use crate::load::{Scenario, period_of};
use crate::permission;
use crate::ports_file::{PortFile, SerialFile, TcpFile};

/// The folder of files, unless a client says another.
const FILES: &str = "files";

/// Bits in a second, and of a byte, unless a port says others.
const BAUD: u32 = 9600;
const BITS_PER_BYTE: u32 = 10;

impl Scenario {
    /// Gives a soft PLC its ports and files.
    pub(crate) fn connected(&self, name: &ClientName, plc: SoftPlcClient) -> Result<SoftPlcClient, ScenarioError> {
        let Some(ClientFile::SoftPlc { ports, files, .. }) = self.file().clients.get(name).map(toml::Spanned::get_ref)
        else {
            return Ok(plc);
        };
        let wrong = |message: String| self.wrong_client(name, message, None);
        let mut described = Vec::new();
        for (port, file) in ports {
            described.push(self.port(name, port, file)?);
        }
        let plc = if described.is_empty() {
            plc
        } else {
            plc.with_ports(&described, self.seed()).map_err(|error| wrong(error.to_string()))?
        };
        let period = onescan_server::client::Client::join(&plc).period;
        for port in &described {
            self.covers(name, port, period)?;
        }
        // the folder that nobody names is for the PLCs that have a use for it
        if files.is_none() && !plc.opens_files() {
            return Ok(plc);
        }
        let found = self.files_of(name, files.as_deref())?;
        if found.is_empty() { Ok(plc) } else { plc.with_files(found).map_err(|error| wrong(error.to_string())) }
    }

    /// Signals of lines that a PLC writes and no port of it sends.
    pub(crate) fn check_lines(
        &self,
        name: &ClientName,
        ports: &BTreeMap<String, PortFile>,
    ) -> Result<(), ScenarioError> {
        let is_line = |signal: &&onescan_server::signal::SignalDecl| matches!(signal.ty, SignalType::Bytes(_));
        let own = self.plan().signals().iter().filter(is_line).filter(|signal| signal.writer.as_ref() == Some(name));
        for signal in own {
            if ports.values().all(|port| port.transmit != signal.name) {
                let message =
                    format!("`{name}` writes `{}`, a line of bytes, and has no port that sends it", signal.name);
                let help = format!("write `[clients.{name}.ports.PORT]` with `transmit = \"{}\"`", signal.name);
                return Err(self.wrong_signal(&signal.name, message, Some(help)));
            }
        }
        Ok(())
    }

    fn port(&self, name: &ClientName, port: &str, file: &PortFile) -> Result<PlcPort, ScenarioError> {
        let wrong = |message: String, help: &str| {
            self.wrong_client(name, format!("port `{port}`: {message}"), Some(help.to_owned()))
        };
        let way = match (&file.serial, &file.tcp) {
            (Some(serial), None) => serial_way(serial).map_err(|(message, help)| wrong(message, &help))?,
            (None, Some(tcp)) => tcp_way(tcp).map_err(|(message, help)| wrong(message, &help))?,
            (None, None) => return Err(wrong("what it is is not said".to_owned(), "write `serial` or `tcp`")),
            (Some(_), Some(_)) => return Err(wrong("it is both serial and of TCP".to_owned(), "keep one of the two")),
        };
        let receive = (file.receive.clone(), self.window(name, port, &file.receive)?);
        let transmit = (file.transmit.clone(), self.window(name, port, &file.transmit)?);
        let writer = |signal: &SignalName| self.file().signals.get(signal).map(|found| found.get_ref().writer.clone());
        if writer(&file.transmit).as_ref() != Some(name) {
            let message = format!("it sends `{}`, which `{name}` does not write", file.transmit);
            return Err(wrong(message, "name a signal whose writer is this PLC"));
        }
        if writer(&file.receive).as_ref() == Some(name) {
            let message = format!("it receives `{}`, which `{name}` writes itself", file.receive);
            return Err(wrong(message, "name a signal that the device writes"));
        }
        Ok(PlcPort { name: port.to_owned(), receive, transmit, way })
    }

    /// The window of a signal, which must be a line.
    fn window(&self, name: &ClientName, port: &str, signal: &SignalName) -> Result<u16, ScenarioError> {
        let Some(found) = self.file().signals.get(signal) else {
            let help = did_you_mean(signal.as_str(), self.file().signals.keys().map(SignalName::as_str));
            let message = format!("port `{port}`: the scenario has no signal `{signal}`");
            return Err(self.wrong_client(name, message, help));
        };
        match found.get_ref().ty {
            SignalType::Bytes(window) => Ok(window),
            ty => {
                let message = format!("`{signal}` is {ty}, and port `{port}` wants a line of bytes");
                Err(self.wrong_signal(signal, message, Some("write `type = \"BYTES[64]\"`".to_owned())))
            }
        }
    }

    /// Refuses a window that does not cover what a serial line may carry while the PLC and who sends to it sleep.
    fn covers(&self, name: &ClientName, port: &PlcPort, period: TimeSpan) -> Result<(), ScenarioError> {
        let (PlcWay::Serial { rate, .. } | PlcWay::Module { rate, .. }) = &port.way else { return Ok(()) };
        let step = self.file().step;
        let writer = self.file().signals.get(&port.receive.0).map(|signal| &signal.get_ref().writer);
        let other = writer.and_then(|writer| self.file().clients.get(writer));
        let sleeps = other.and_then(|client| period_of(client.get_ref(), step)).unwrap_or(step);
        let bytes = rate.within(period.as_nanos().saturating_add(sleeps.as_nanos())) + 1;
        if bytes <= u64::from(port.receive.1) {
            return Ok(());
        }
        let (signal, window) = &port.receive;
        let message = format!(
            "port `{}`: {bytes} bytes may come on `{signal}` while `{name}` sleeps for {period} and its writer for \
             {sleeps}, and its window has {window}",
            port.name
        );
        Err(self.wrong_client(name, message, Some(format!("write `type = \"BYTES[{bytes}]\"`, or shorten a period"))))
    }

    /// The files that the program of a PLC finds: those of its folder, by their names.
    fn files_of(&self, name: &ClientName, folder: Option<&str>) -> Result<Vec<(String, Vec<u8>)>, ScenarioError> {
        let path = self.folder().join(folder.unwrap_or(FILES));
        if folder.is_none() && !path.is_dir() {
            return Ok(Vec::new());
        }
        permission::granted().check(self.folder(), &path)?;
        let unreadable = |path: &Path, source| ScenarioError::Unreadable { path: path.to_owned(), source, help: None };
        let entries = std::fs::read_dir(&path).map_err(|error| unreadable(&path, error))?;
        let mut found = Vec::new();
        for entry in entries {
            let path = entry.map_err(|error| unreadable(&path, error))?.path();
            let Some(file) = path.file_name().and_then(|file| file.to_str()).map(str::to_owned) else {
                let message = format!("`{}` has a name that no program can write", path.display());
                return Err(self.wrong_client(name, message, None));
            };
            let bytes = permission::granted().read(self.folder(), &path, Limit::TEXT)?;
            found.push((file, bytes.map_err(|error| unreadable(&path, error))?));
        }
        // the order of a folder is the machine's
        found.sort();
        Ok(found)
    }
}

fn serial_way(file: &SerialFile) -> Result<PlcWay, (String, String)> {
    let rate = Rate::of(file.baud.unwrap_or(BAUD), file.bits_per_byte.unwrap_or(BITS_PER_BYTE));
    let rate =
        rate.ok_or_else(|| ("a rate of 0".to_owned(), "`baud` and `bits_per_byte` are at least 1".to_owned()))?;
    let receive_buffer = file.receive_buffer.and_then(|bytes| usize::try_from(bytes).ok());
    let (input, output) = match (&file.input, &file.output, file.module) {
        (None, None, Some(number)) if file.terminal.is_none() => {
            return Ok(PlcWay::Module { rate, number, receive_buffer });
        }
        (Some(input), Some(output), None) => (input.clone(), output.clone()),
        _ => {
            let help = "write `input` and `output`, the variables of a terminal's process image, or `module`, the number of a \
                        communication module";
            return Err(("it has neither a process image nor a module, or both".to_owned(), help.to_owned()));
        }
    };
    let terminal = match &file.terminal {
        None => TerminalKind::default(),
        Some(written) => TerminalKind::named(&written.to_ascii_uppercase()).ok_or_else(|| {
            let help = format!("write one of {}", TerminalKind::NAMES.join(", "));
            (format!("`{written}` is not a terminal that is known"), help)
        })?,
    };
    Ok(PlcWay::Serial { rate, terminal, receive_buffer, input, output })
}

fn tcp_way(file: &TcpFile) -> Result<PlcWay, (String, String)> {
    let no_address = || {
        let help = "write host and number, as in `address = \"192.168.42.30:2727\"`".to_owned();
        (format!("`{}` is not an address", file.address), help)
    };
    let (host, number) = file.address.rsplit_once(':').ok_or_else(no_address)?;
    let is_host = |host: &str| {
        let is_part = |each: char| each.is_ascii_alphanumeric() || each == '.' || each == '-';
        (1..=80).contains(&host.len()) && host.chars().all(is_part)
    };
    let number = number.parse().ok().filter(|_| is_host(host)).ok_or_else(no_address)?;
    let cuts = match (file.cut_behind, file.cut_every, file.cut_at_random) {
        (None, None, false) => Cuts::Nowhere,
        (Some(at), None, false) => Cuts::Behind(at),
        (None, Some(most), false) => Cuts::Every(most),
        (None, None, true) => Cuts::Random,
        _ => {
            let help = "keep one of `cut_behind`, `cut_every` and `cut_at_random`".to_owned();
            return Err(("where messages are cut is said twice".to_owned(), help));
        }
    };
    Ok(PlcWay::Tcp { host: host.to_owned(), number, cuts })
}
