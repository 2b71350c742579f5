//! Registers and coils over Modbus TCP: the PLC's side.

use std::future::{Ready, ready};
use std::net::SocketAddr;
use std::sync::Arc;

use onescan_base::threads;
use onescan_server::transport::accept::{Guarded, Pass, not_taken, refused};
use onescan_server::transport::connection_limit::ConnectionLimit;
use onescan_server::transport::listeners::MODBUS;
use onescan_server::transport::runtime;
use tokio::net::{TcpListener, TcpStream};
use tokio_modbus::prelude::{ExceptionCode, Request, Response};
use tokio_modbus::server::Service;
use tokio_modbus::server::tcp::Server;

use super::controller::Controller;
use crate::accept::GLANCE;
use crate::gateway::exchange::Direction;
use crate::gateway::modbus::RegisterMap;
use crate::gateway::modbus::map::{Entry, Span, Table};
use crate::gateway::modbus::registers;
use crate::listener::bind;

/// Serves the PLC's registers at `address`; gives the address that it got. The server ends with the controller.
///
/// # Errors
/// The address cannot be listened on, or there is no thread.
pub fn serve(address: SocketAddr, controller: &Arc<Controller>, map: RegisterMap) -> std::io::Result<SocketAddr> {
    let (listener, address) = bind(address)?;
    let runtime = runtime::of_this_thread()?;
    let bank = Arc::new(Bank { controller: Arc::clone(controller), map });
    threads::start("Modbus", move || runtime.block_on(listen(&listener, &bank)))?;
    Ok(address)
}

/// Serves until the controller ends. The library's server ends when it cannot take a connection, as where there are no
/// descriptors; then it is started again.
async fn listen(listener: &std::net::TcpListener, bank: &Arc<Bank>) {
    let limit = ConnectionLimit::new(MODBUS.limits);
    while !bank.controller.is_over() {
        match serve_until_over(listener, bank, &limit).await {
            Ok(()) => return,
            Err(error) => {
                not_taken(MODBUS.what, &error);
                tokio::time::sleep(GLANCE).await;
            }
        }
    }
}

async fn serve_until_over(
    listener: &std::net::TcpListener,
    bank: &Arc<Bank>,
    limit: &ConnectionLimit,
) -> std::io::Result<()> {
    let listener = TcpListener::from_std(listener.try_clone()?)?;
    let controller = Arc::clone(&bank.controller);
    let over = async move {
        while !controller.is_over() {
            tokio::time::sleep(GLANCE).await;
        }
    };
    let connected = |stream: TcpStream, from: SocketAddr| ready(Ok(admitted(stream, from, bank, limit)));
    let broken = |error: std::io::Error| tracing::debug!(%error, "a Modbus client has gone");
    Server::new(listener).serve_until(&connected, broken, Box::pin(over)).await.map(drop)
}

/// A connection and who answers it, if there is room for it.
fn admitted(
    stream: TcpStream,
    from: SocketAddr,
    bank: &Arc<Bank>,
    limit: &ConnectionLimit,
) -> Option<(Registers, Guarded<TcpStream>)> {
    // It only costs time where it cannot be set.
    let _ = stream.set_nodelay(true);
    let Some((place, leaving)) = limit.admit_task(from.ip()) else {
        refused(MODBUS.what, from);
        return None;
    };
    let guarded = Guarded::new(stream, place, leaving, MODBUS.proof).idle_for(MODBUS.idle);
    Some((Registers { bank: Arc::clone(bank), pass: guarded.pass() }, guarded))
}

/// The PLC's four tables.
struct Bank {
    controller: Arc<Controller>,
    map: RegisterMap,
}

/// The answers to one client, which stays once it has asked for something.
struct Registers {
    bank: Arc<Bank>,
    pass: Pass,
}

impl Service for Registers {
    type Request = Request<'static>;
    type Response = Response;
    type Exception = ExceptionCode;
    type Future = Ready<Result<Response, ExceptionCode>>;

    fn call(&self, request: Request<'static>) -> Self::Future {
        // A client that is one too many hears so, and has to leave for the next that comes.
        ready(if self.pass.stay() { self.bank.answer(&request) } else { Err(ExceptionCode::ServerDeviceBusy) })
    }
}

impl Bank {
    fn answer(&self, request: &Request<'static>) -> Result<Response, ExceptionCode> {
        use Table::{Coil, DiscreteInput, HoldingRegister, InputRegister};
        let bits = |words: Vec<u16>| words.into_iter().map(|word| word != 0).collect();
        Ok(match request {
            Request::ReadCoils(at, count) => Response::ReadCoils(bits(self.read(Coil, *at, *count)?)),
            Request::ReadDiscreteInputs(at, count) => {
                Response::ReadDiscreteInputs(bits(self.read(DiscreteInput, *at, *count)?))
            }
            Request::ReadInputRegisters(at, count) => {
                Response::ReadInputRegisters(self.read(InputRegister, *at, *count)?)
            }
            Request::ReadHoldingRegisters(at, count) => {
                Response::ReadHoldingRegisters(self.read(HoldingRegister, *at, *count)?)
            }
            Request::WriteSingleCoil(at, coil) => {
                self.write(Coil, *at, &[u16::from(*coil)])?;
                Response::WriteSingleCoil(*at, *coil)
            }
            Request::WriteMultipleCoils(at, coils) => {
                let words: Vec<u16> = coils.iter().map(|coil| u16::from(*coil)).collect();
                self.write(Coil, *at, &words)?;
                Response::WriteMultipleCoils(*at, words.len() as u16)
            }
            Request::WriteSingleRegister(at, word) => {
                self.write(HoldingRegister, *at, &[*word])?;
                Response::WriteSingleRegister(*at, *word)
            }
            Request::WriteMultipleRegisters(at, words) => {
                self.write(HoldingRegister, *at, words)?;
                Response::WriteMultipleRegisters(*at, words.len() as u16)
            }
            Request::ReadWriteMultipleRegisters(read_at, count, at, words) => {
                self.write(HoldingRegister, *at, words)?;
                Response::ReadWriteMultipleRegisters(self.read(HoldingRegister, *read_at, *count)?)
            }
            _ => return Err(ExceptionCode::IllegalFunction),
        })
    }

    fn entries(&self, table: Table) -> impl Iterator<Item = (&Entry, Direction)> {
        let to_plc = self.map.to_plc.iter().map(|entry| (entry, Direction::ToPlc));
        let from_plc = self.map.from_plc.iter().map(|entry| (entry, Direction::FromPlc));
        to_plc.chain(from_plc).filter(move |(entry, _)| entry.address.table == table)
    }

    /// Gaps between points read as 0; what lies behind the last point is not there.
    fn read(&self, table: Table, at: u16, count: u16) -> Result<Vec<u16>, ExceptionCode> {
        if count == 0 || count > table.at_most(Direction::FromPlc) {
            return Err(ExceptionCode::IllegalDataValue);
        }
        let end = self.entries(table).map(|(entry, _)| end_of(entry)).max().unwrap_or(0);
        if u32::from(at) + u32::from(count) > end {
            return Err(ExceptionCode::IllegalDataAddress);
        }
        let span = Span { table, at, count };
        Ok(self.words(span))
    }

    /// The words of `span`; a value that lies in it in part is there in part.
    fn words(&self, span: Span) -> Vec<u16> {
        let snapshot = self.controller.snapshot();
        let (span, from) = self.widened(span);
        let mut words = vec![0; usize::from(span.1.count)];
        for (entry, direction) in self.entries(span.1.table) {
            registers::put(entry, snapshot.of(direction), self.map.word_order, &span.1, &mut words);
        }
        words[from..from + usize::from(span.0)].to_vec()
    }

    /// The span with all of the values that lie in it in part; its own length, and where it begins in that.
    fn widened(&self, span: Span) -> ((u16, Span), usize) {
        let touched = || self.entries(span.table).map(|(entry, _)| entry).filter(|entry| touches(entry, span));
        let at = touched().map(|entry| entry.address.at).min().unwrap_or(span.at).min(span.at);
        let past = u32::from(span.at) + u32::from(span.count);
        let end = touched().map(end_of).max().unwrap_or(past).max(past);
        let wide = Span { table: span.table, at, count: (end - u32::from(at)).min(u32::from(u16::MAX)) as u16 };
        ((span.count, wide), usize::from(span.at - at))
    }

    /// Writes the values that lie in these words, all as one request; nothing if one of them is the PLC's own.
    fn write(&self, table: Table, at: u16, words: &[u16]) -> Result<(), ExceptionCode> {
        let count = u16::try_from(words.len()).map_err(|_| ExceptionCode::IllegalDataValue)?;
        let span = Span { table, at, count };
        let covered: u32 = self.entries(table).filter(|(entry, _)| touches(entry, span)).map(|_| 1).sum();
        let is_own = |(entry, direction): (&Entry, Direction)| direction == Direction::FromPlc && touches(entry, span);
        if covered == 0 || self.entries(table).any(is_own) {
            return Err(ExceptionCode::IllegalDataAddress);
        }
        let ((_, wide), from) = self.widened(span);
        let mut all = self.words(wide);
        all[from..from + words.len()].copy_from_slice(words);
        let mut packed = vec![0; self.controller.wires().exchange().size(Direction::ToPlc)];
        let mut touched = Vec::new();
        for (index, entry) in self.map.to_plc.iter().enumerate() {
            if entry.address.table == table && touches(entry, span) {
                registers::take(entry, &all, self.map.word_order, &wide, &mut packed);
                touched.push((index, entry.point.range()));
            }
        }
        self.controller.write_points(touched.into_iter().map(|(index, range)| (index, &packed[range])));
        Ok(())
    }
}

fn end_of(entry: &Entry) -> u32 {
    u32::from(entry.address.at) + u32::from(entry.count)
}

fn touches(entry: &Entry, span: Span) -> bool {
    u32::from(entry.address.at) < u32::from(span.at) + u32::from(span.count) && u32::from(span.at) < end_of(entry)
}
