//! The gateway's side: as few requests as the map allows.

use std::net::ToSocketAddrs;
use std::time::{Duration, Instant};

use tokio::runtime::Runtime;
use tokio_modbus::client::{Context, Reader, Writer, tcp};
use tokio_modbus::{Error, ExceptionCode, Slave};

use super::map::{Entry, Options, RegisterMap, Span, Table};
use super::registers;
use crate::gateway::byte_order::ByteOrder;
use crate::gateway::exchange::Exchange;
use crate::gateway::fault::{LinkFault, MappingFault};
use crate::gateway::link::Link;

/// A PLC that is busy is asked again after this.
const BUSY: Duration = Duration::from_millis(50);

/// Registers and coils over Modbus TCP.
pub struct ModbusLink {
    address: String,
    options: Options,
    map: RegisterMap,
    writes: Vec<Span>,
    reads: Vec<Span>,
    runtime: Runtime,
    context: Option<Context>,
    /// For a connection, for an answer, and for a PLC that is busy.
    timeout: Duration,
}

/// A request that came to nothing.
enum Failed {
    /// The connection, or time.
    Lost(String),
    Refused(ExceptionCode),
    /// The answer is none.
    Nonsense(String),
}

impl ModbusLink {
    /// A link to `address`, a host and a port.
    ///
    /// # Errors
    /// A point without a place.
    pub fn new(address: &str, options: Options, exchange: &Exchange, timeout: Duration) -> Result<Self, LinkFault> {
        let map = RegisterMap::new(&options, exchange)?;
        let runtime = onescan_server::transport::runtime::of_this_thread();
        let runtime = runtime.map_err(|error| LinkFault::Lost(format!("no runtime: {error}")))?;
        let (writes, reads) = (map.writes(), map.reads());
        let address = if address.contains(':') { address.to_owned() } else { format!("{address}:502") };
        Ok(Self { address, options, map, writes, reads, runtime, context: None, timeout })
    }

    fn url(&self) -> String {
        format!("modbus://{}", self.address)
    }

    fn open(&self) -> Result<Context, String> {
        let mut reason = "no such host".to_owned();
        for address in self.address.to_socket_addrs().map_err(|error| error.to_string())? {
            let slave = Slave(self.options.unit);
            let connected = self
                .runtime
                .block_on(async { tokio::time::timeout(self.timeout, tcp::connect_slave(address, slave)).await });
            match connected {
                Ok(Ok(context)) => return Ok(context),
                Ok(Err(error)) => reason = error.to_string(),
                Err(_) => reason = format!("no answer within {:?}", self.timeout),
            }
        }
        Err(reason)
    }

    /// Does `request` again while the PLC is busy: it says so for a moment, and asks for that (exceptions 5 and 6).
    fn patiently<T>(&mut self, request: impl Fn(&mut Self) -> Result<T, Failed>) -> Result<T, Failed> {
        let begun = Instant::now();
        loop {
            match request(self) {
                Err(Failed::Refused(code)) if is_busy(code) && begun.elapsed() < self.timeout => {
                    std::thread::sleep(BUSY);
                }
                done => return done,
            }
        }
    }

    /// The point whose register the PLC has not, found by asking for each alone.
    fn refused(&mut self, spans: &[Span], code: ExceptionCode) -> LinkFault {
        let is_asked = |entry: &&Entry| spans.iter().any(|span| span.table == entry.address.table);
        let entries: Vec<Entry> = self.map.to_plc.iter().chain(&self.map.from_plc).filter(is_asked).cloned().collect();
        for Entry { point, address, count } in entries {
            let span = Span { table: address.table, at: address.at, count };
            if let Err(Failed::Refused(code)) = self.read_span(span)
                && is_of_the_address(code)
            {
                let message = format!("`{}` is mapped to {address}, which the PLC refuses: {code}", point.label());
                return MappingFault::new(&point.name, message).into();
            }
        }
        LinkFault::Nonsense(format!("a request was refused that its parts are not: {code}"))
    }

    fn read_span(&mut self, span: Span) -> Result<Vec<u16>, Failed> {
        let timeout = self.timeout;
        let Some(context) = self.context.as_mut() else {
            return Err(Failed::Lost("there is no connection".to_owned()));
        };
        let Span { table, at, count } = span;
        let bits = |bits: Vec<bool>| bits.into_iter().map(u16::from).collect::<Vec<u16>>();
        let answer = self.runtime.block_on(async {
            tokio::time::timeout(timeout, async {
                match table {
                    Table::Coil => context.read_coils(at, count).await.map(|answer| answer.map(bits)),
                    Table::DiscreteInput => {
                        context.read_discrete_inputs(at, count).await.map(|answer| answer.map(bits))
                    }
                    Table::InputRegister => context.read_input_registers(at, count).await,
                    Table::HoldingRegister => context.read_holding_registers(at, count).await,
                }
            })
            .await
        });
        let words = checked(answer, timeout)?;
        if words.len() < usize::from(count) {
            return Err(Failed::Nonsense(format!("{} values came where {count} were asked for", words.len())));
        }
        Ok(words)
    }

    fn write_span(&mut self, span: Span, words: &[u16]) -> Result<(), Failed> {
        let timeout = self.timeout;
        let Some(context) = self.context.as_mut() else {
            return Err(Failed::Lost("there is no connection".to_owned()));
        };
        let answer = self.runtime.block_on(async {
            tokio::time::timeout(timeout, async {
                if span.table == Table::Coil {
                    let coils: Vec<bool> = words.iter().map(|word| *word != 0).collect();
                    context.write_multiple_coils(span.at, &coils).await
                } else {
                    context.write_multiple_registers(span.at, words).await
                }
            })
            .await
        });
        checked(answer, timeout)
    }

    fn fault(&mut self, failed: Failed, span: Span) -> LinkFault {
        match failed {
            Failed::Lost(reason) => LinkFault::Lost(reason),
            Failed::Nonsense(what) => LinkFault::Nonsense(what),
            Failed::Refused(code) if is_of_the_address(code) => self.refused(&[span], code),
            // The PLC or what lies before it: another attempt may find it well.
            Failed::Refused(code) => {
                LinkFault::Lost(format!("the PLC answers `{code}` (Modbus exception {})", u8::from(code)))
            }
        }
    }
}

/// True for what the PLC will do if it is asked again.
fn is_busy(code: ExceptionCode) -> bool {
    matches!(code, ExceptionCode::Acknowledge | ExceptionCode::ServerDeviceBusy)
}

/// True for what the PLC says of a request that it will never do: the function, the register or the value.
fn is_of_the_address(code: ExceptionCode) -> bool {
    matches!(code, ExceptionCode::IllegalFunction | ExceptionCode::IllegalDataAddress | ExceptionCode::IllegalDataValue)
}

type Answer<T> = Result<Result<Result<T, ExceptionCode>, Error>, tokio::time::error::Elapsed>;

fn checked<T>(answer: Answer<T>, timeout: Duration) -> Result<T, Failed> {
    match answer {
        Ok(Ok(Ok(value))) => Ok(value),
        Ok(Ok(Err(code))) => Err(Failed::Refused(code)),
        Ok(Err(Error::Transport(error))) if error.kind() == std::io::ErrorKind::InvalidData => {
            Err(Failed::Nonsense(error.to_string()))
        }
        Ok(Err(Error::Transport(error))) => Err(Failed::Lost(error.to_string())),
        Ok(Err(Error::Protocol(error))) => Err(Failed::Nonsense(error.to_string())),
        Err(_) => Err(Failed::Lost(format!("no answer within {timeout:?}"))),
    }
}

impl Link for ModbusLink {
    fn connect(&mut self) -> Result<(), LinkFault> {
        self.context = None;
        let url = self.url();
        self.context = Some(self.open().map_err(|reason| LinkFault::Unreachable { url, reason })?);
        // What is written can be read as well: that it is there is seen before anything is written.
        for span in [self.writes.clone(), self.reads.clone()].concat() {
            if let Err(failed) = self.patiently(|link| link.read_span(span)) {
                return Err(self.fault(failed, span));
            }
        }
        Ok(())
    }

    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault> {
        let order: ByteOrder = self.map.word_order;
        for index in 0..self.writes.len() {
            let span = self.writes[index];
            let mut words = vec![0; usize::from(span.count)];
            for entry in &self.map.to_plc {
                registers::put(entry, to_plc, order, &span, &mut words);
            }
            if let Err(failed) = self.patiently(|link| link.write_span(span, &words)) {
                return Err(self.fault(failed, span));
            }
        }
        Ok(())
    }

    fn read(&mut self, _patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        for index in 0..self.reads.len() {
            let span = self.reads[index];
            let words = match self.patiently(|link| link.read_span(span)) {
                Ok(words) => words,
                Err(failed) => return Err(self.fault(failed, span)),
            };
            for entry in &self.map.from_plc {
                registers::take(entry, &words, self.map.word_order, &span, from_plc);
            }
        }
        Ok(true)
    }
}
