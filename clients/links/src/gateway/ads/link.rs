//! One sum command a direction for all points.

use std::time::Duration;

use onescan_base::did_you_mean;

use super::command::{self, SUM_MAX, state_name};
use super::connection::{Connection, Refusal, numbers, told};
use super::frame::Bytes;
use super::options::Options;
use super::symbol::{Form, READ_ONLY, Symbol, elementary};
use crate::gateway::exchange::{Direction, Exchange, Point, RUNNING};
use crate::gateway::fault::{LinkFault, MappingFault};
use crate::gateway::link::{Found, Link};

/// Bytes of an entry of the table of symbols at most.
const ENTRY_MAX: u32 = 0xFFFF;
/// Bytes of a table of symbols that is read at most.
const TABLE_MAX: u32 = 1 << 20;

/// Symbols of a TwinCAT PLC.
pub struct AdsLink {
    address: String,
    options: Options,
    exchange: Exchange,
    connection: Option<Connection>,
    /// The sum commands of a step, by direction.
    writes: Vec<Sum>,
    reads: Vec<Sum>,
    timeout: Duration,
}

/// A sum command for some points of a direction, one behind the other.
struct Sum {
    points: Vec<Point>,
    /// Group, offset and length of each.
    heads: Vec<u8>,
    /// Bytes of all values.
    size: u32,
}

impl Sum {
    /// The commands for all points; more than one takes go in several.
    fn of(points: &[Point], symbols: &[Symbol]) -> Vec<Self> {
        let sum = |(points, symbols): (&[Point], &[Symbol])| Self {
            points: points.to_vec(),
            heads: symbols.iter().flat_map(|symbol| numbers(&[symbol.place.0, symbol.place.1, symbol.size])).collect(),
            size: symbols.iter().map(|symbol| symbol.size).sum(),
        };
        points.chunks(SUM_MAX).zip(symbols.chunks(SUM_MAX)).map(sum).collect()
    }

    fn count(&self) -> u32 {
        self.points.len() as u32
    }
}

impl AdsLink {
    /// A link to `address`, a host and perhaps a port.
    pub fn new(address: &str, options: Options, exchange: &Exchange, timeout: Duration) -> Self {
        let exchange = exchange.clone();
        let (writes, reads) = (Vec::new(), Vec::new());
        Self { address: address.to_owned(), options, exchange, connection: None, writes, reads, timeout }
    }

    /// Everything that the PLC has.
    ///
    /// # Errors
    /// The PLC cannot be reached, or does not let this gateway in.
    pub fn browse(&mut self) -> Result<Vec<Found>, LinkFault> {
        self.open()?;
        let symbols = self.table()?;
        let found = |symbol: Symbol| Found {
            ty: elementary(&symbol),
            is_writable: symbol.flags & READ_ONLY == 0,
            address: symbol.name.clone(),
            name: symbol.name,
        };
        Ok(symbols.into_iter().map(found).collect())
    }

    fn connected(&mut self) -> Result<&mut Connection, LinkFault> {
        self.connection.as_mut().ok_or_else(LinkFault::not_connected)
    }

    /// Connects and asks for the state, which a PLC without a route to this gateway does not tell.
    fn open(&mut self) -> Result<u16, LinkFault> {
        // The old connection goes first: a router has room for one.
        self.connection = None;
        let mut connection = Connection::open(&self.address, &self.options, self.timeout)?;
        let (url, source) = (format!("ads://{}", self.address), connection.source());
        let state = connection.state().map_err(|refusal| match refusal {
            Refusal::Link(LinkFault::Lost(reason)) => LinkFault::Refused {
                url,
                reason: format!(
                    "{reason}; has the PLC a route to {}? Its NetId must be that of the route",
                    source.net_id
                ),
            },
            Refusal::Code(code) => LinkFault::Refused { url, reason: told(code) },
            Refusal::Link(fault) => fault,
        })?;
        self.connection = Some(connection);
        Ok(state)
    }

    fn table(&mut self) -> Result<Vec<Symbol>, LinkFault> {
        let connection = self.connected()?;
        let info = connection.read(command::UPLOAD_INFO_2, 0, 64).map_err(Refusal::into_fault)?;
        let mut info = Bytes(&info);
        let nonsense = || LinkFault::Nonsense("a table of symbols that is cut short".to_owned());
        let (count, length) = (info.u32().ok_or_else(nonsense)?, info.u32().ok_or_else(nonsense)?);
        if length > TABLE_MAX {
            return Err(LinkFault::Setting(format!("the PLC has {count} symbols, too many to list")));
        }
        let table = connection.read(command::SYMBOL_UPLOAD, 0, length).map_err(Refusal::into_fault)?;
        let mut table = Bytes(&table);
        let mut symbols = Vec::new();
        while !table.0.is_empty() {
            symbols.push(Symbol::take(&mut table).ok_or_else(nonsense)?);
        }
        Ok(symbols)
    }

    /// The sum commands of a direction; the symbol of each point is there, has its type, and may be written if it must.
    fn check(&mut self, direction: Direction) -> Result<Vec<Sum>, LinkFault> {
        let points = self.exchange.points(direction).to_vec();
        let symbols: Result<Vec<_>, _> = points.iter().map(|point| self.check_point(point, direction)).collect();
        Ok(Sum::of(&points, &symbols?))
    }

    fn check_point(&mut self, point: &Point, direction: Direction) -> Result<Symbol, LinkFault> {
        let name = point.address.clone().unwrap_or_else(|| self.options.symbol(point));
        let written = [name.as_bytes(), &[0]].concat();
        let entry = self.connected()?.read_write(command::INFO_BY_NAME_EX, 0, ENTRY_MAX, &written);
        let entry = match entry {
            Ok(entry) => entry,
            Err(Refusal::Code(command::NO_SYMBOL)) => return Err(self.unknown(point, &name)),
            Err(refusal) => return Err(refusal.into_fault()),
        };
        let symbol = Symbol::take(&mut Bytes(&entry))
            .ok_or_else(|| LinkFault::Nonsense(format!("the entry of `{name}` is cut short")))?;
        let (signal, ty, point) = (&point.name, point.ty, point.label());
        if !Form::of(ty).fits(&symbol) {
            let text =
                format!("type mismatch: `{point}` is {ty}, but `{name}` is {} of {} bytes", symbol.ty, symbol.size);
            let is_short = symbol.ty.eq_ignore_ascii_case("TIME") && Form::of(ty).size() == 8;
            let help = is_short.then(|| "TIME of TwinCAT has 32 bits and counts ms; declare it LTIME there".to_owned());
            return Err(MappingFault::new(signal, text).with_help(help).into());
        }
        if direction == Direction::ToPlc && symbol.flags & READ_ONLY != 0 {
            let text = format!("`{point}` is written by the gateway, but `{name}` can only be read");
            return Err(MappingFault::new(signal, text).into());
        }
        Ok(symbol)
    }

    /// A point without a symbol, with the nearest that there is.
    fn unknown(&mut self, point: &Point, name: &str) -> LinkFault {
        let names: Vec<String> = self.table().unwrap_or_default().into_iter().map(|symbol| symbol.name).collect();
        let help = did_you_mean(name, names.iter().map(String::as_str));
        let text = format!("`{}` is mapped to `{name}`, which the PLC does not have", point.label());
        MappingFault::new(&point.name, text).with_help(help).into()
    }
}

/// The return codes of a sum command's parts, of which none may be an error.
fn all_well(codes: &mut Bytes<'_>, points: &[Point], what: &str) -> Result<(), LinkFault> {
    for point in points {
        match codes.u32() {
            Some(0) => {}
            Some(code) => {
                let text = format!("`{}` cannot be {what}: {}", point.label(), told(code));
                return Err(MappingFault::new(&point.name, text).into());
            }
            None => return Err(LinkFault::Nonsense("a sum that is cut short".to_owned())),
        }
    }
    Ok(())
}

impl Link for AdsLink {
    fn connect(&mut self) -> Result<(), LinkFault> {
        let state = self.open()?;
        // With `PLC_Running` the handshake sees a STOP itself, and waits for the PLC to go on.
        let tells_itself = self.exchange.from_plc().iter().any(|point| point.name == RUNNING.0);
        if state != command::RUN && !tells_itself {
            let reason = format!("the PLC is in {}; set it to RUN", state_name(state));
            return Err(LinkFault::Unreachable { url: format!("ads://{}", self.address), reason });
        }
        self.writes = self.check(Direction::ToPlc)?;
        self.reads = self.check(Direction::FromPlc)?;
        Ok(())
    }

    /// The grant is in the last command.
    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault> {
        let connection = self.connection.as_mut().ok_or_else(LinkFault::not_connected)?;
        for sum in &self.writes {
            let mut written = sum.heads.clone();
            for point in &sum.points {
                Form::of(point.ty).put(&to_plc[point.range()], &mut written);
            }
            let codes = connection.read_write(command::SUM_WRITE, sum.count(), 4 * sum.count(), &written);
            all_well(&mut Bytes(&codes.map_err(Refusal::into_fault)?), &sum.points, "written")?;
        }
        Ok(())
    }

    fn read(&mut self, _patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        let connection = self.connection.as_mut().ok_or_else(LinkFault::not_connected)?;
        for sum in &self.reads {
            // A return code for each symbol comes first, then the values of all.
            let length = 4 * sum.count() + sum.size;
            let answer = connection.read_write(command::SUM_READ, sum.count(), length, &sum.heads);
            let answer = answer.map_err(Refusal::into_fault)?;
            let mut answer = Bytes(&answer);
            all_well(&mut answer, &sum.points, "read")?;
            for point in &sum.points {
                let form = Form::of(point.ty);
                let value = answer.take(form.size());
                if !value.is_some_and(|value| form.take(value, &mut from_plc[point.range()])) {
                    return Err(LinkFault::Nonsense(format!("`{}` is {}, which did not come", point.name, point.ty)));
                }
            }
        }
        Ok(true)
    }
}
