//! Symbols over ADS: the PLC's side, as a TwinCAT device with its own router. Each point is a symbol under the name by
//! which a gateway looks for it: the path that its variable has in the program. A request is answered between two cycles, a sum
//! command as one.

use std::io::Write;
use std::net::SocketAddr;
use std::sync::Arc;

use onescan_base::threads;
use onescan_server::transport::listeners;

use super::controller::{Controller, Snapshot};
use crate::accept::{Peer, serve_each};
use crate::gateway::ads::Options;
use crate::gateway::ads::command::{self, SUM_MAX};
use crate::gateway::ads::frame::{Bytes, Frame, Kind, MAX_DATA};
use crate::gateway::ads::symbol::{Form, READ_ONLY, Symbol};
use crate::gateway::exchange::{Direction, Point};
use crate::listener::bind;

/// Index group of a PLC's data; the offset is that of the packed value, behind [`FROM_PLC`] of those that it writes.
const DATA: u32 = 0x4040;
/// Where the PLC's own values begin.
const FROM_PLC: u32 = 0x0100_0000;
/// Name and version that the device says.
const DEVICE: &[u8; 20] = b"\x01\x00\x00\x00onescan plc\0\0\0\0\0";

/// Serves the PLC's symbols at `address`, named as `options` says; gives the address that it got. The server ends with
/// the controller.
///
/// # Errors
/// The address cannot be listened on, or there is no thread.
pub fn serve(address: SocketAddr, controller: &Arc<Controller>, options: &Options) -> std::io::Result<SocketAddr> {
    let (listener, address) = bind(address)?;
    let device = Arc::new(Device::new(Arc::clone(controller), options));
    threads::start("ADS", move || {
        serve_each(&listener, listeners::ADS, &device, || device.controller.is_over(), Device::attend);
    })?;
    Ok(address)
}

/// A symbol, its point, and the point's number among those of its direction.
struct Entry {
    symbol: Symbol,
    point: Point,
    direction: Direction,
    index: usize,
}

/// A return code that is an error.
struct Refused(u32);

/// What a request asks to be read or written.
type Answer = Result<Vec<u8>, Refused>;

struct Device {
    controller: Arc<Controller>,
    /// In the order of their places.
    entries: Vec<Entry>,
}

impl Device {
    fn new(controller: Arc<Controller>, options: &Options) -> Self {
        let mut entries = Vec::new();
        let exchange = controller.wires().exchange();
        for direction in [Direction::ToPlc, Direction::FromPlc] {
            for (index, point) in exchange.points(direction).iter().enumerate() {
                let form = Form::of(point.ty);
                let (first, flags) = if direction == Direction::ToPlc { (0, 0) } else { (FROM_PLC, READ_ONLY) };
                let symbol = Symbol {
                    place: (DATA, first + point.offset as u32),
                    size: form.size() as u32,
                    base: form.base(),
                    flags,
                    name: point.address.clone().unwrap_or_else(|| options.symbol(point)),
                    ty: point.ty.to_string(),
                };
                entries.push(Entry { symbol, point: point.clone(), direction, index });
            }
        }
        Self { controller, entries }
    }

    /// Answers what a client asks until it goes.
    fn attend(&self, peer: &mut Peer) -> std::io::Result<()> {
        while let Some(request) = Frame::read(peer)? {
            peer.stay()?;
            if request.kind == Kind::Request && !self.controller.is_over() {
                peer.write_all(&self.response(&request).encoded())?;
            }
        }
        Ok(())
    }

    fn response(&self, request: &Frame) -> Frame {
        let data = match self.answer(request.command, &request.data) {
            Ok(answer) => [&[0; 4][..], &answer].concat(),
            Err(Refused(code)) => code.to_le_bytes().to_vec(),
        };
        let Frame { target, source, command, invoke_id, .. } = *request;
        Frame { target: source, source: target, command, kind: Kind::Response, error: 0, invoke_id, data }
    }

    fn answer(&self, command: u16, data: &[u8]) -> Answer {
        let mut data = Bytes(data);
        let mut number = || data.u32().ok_or(Refused(command::BAD_DATA));
        match command {
            command::READ_DEVICE_INFO => Ok(DEVICE.to_vec()),
            command::READ_STATE => {
                let state = if self.controller.status().running { command::RUN } else { command::STOP };
                Ok([state.to_le_bytes(), [0; 2]].concat())
            }
            command::WRITE_CONTROL => self.control(data.u16().ok_or(Refused(command::BAD_DATA))?),
            command::READ => {
                let (group, offset, length) = (number()?, number()?, number()?);
                Ok(counted(&self.read(group, offset, length)?))
            }
            command::WRITE => {
                let (group, offset, length) = (number()?, number()?, number()?);
                let value = data.take(length as usize).ok_or(Refused(command::BAD_DATA))?;
                self.write(group, offset, value)?;
                Ok(Vec::new())
            }
            command::READ_WRITE => {
                let (group, offset, length, written) = (number()?, number()?, number()?, number()?);
                let written = data.take(written as usize).ok_or(Refused(command::BAD_DATA))?;
                let answer = self.call(group, offset, written)?;
                if answer.len() > length as usize { Err(Refused(command::BAD_SIZE)) } else { Ok(counted(&answer)) }
            }
            _ => Err(Refused(command::NOT_SUPPORTED)),
        }
    }

    /// The switch, as it is turned over the network.
    fn control(&self, state: u16) -> Answer {
        match state {
            command::RUN => self.controller.set_running(true),
            command::STOP => self.controller.set_running(false),
            command::RESET => self.controller.start_warm(),
            _ => return Err(Refused(command::NOT_SUPPORTED)),
        }
        Ok(Vec::new())
    }

    fn read(&self, group: u32, offset: u32, length: u32) -> Answer {
        let whole: Vec<u8> = match group {
            command::SYMBOL_UPLOAD => self.table(),
            command::TYPE_UPLOAD => Vec::new(),
            command::UPLOAD_INFO_2 => {
                let counts = [self.entries.len() as u32, self.table().len() as u32];
                let mut info: Vec<u8> = counts.iter().flat_map(|count| count.to_le_bytes()).collect();
                info.resize(64, 0);
                info
            }
            _ => {
                let entry = self.entry(group, offset)?;
                if length != entry.symbol.size {
                    return Err(Refused(command::BAD_SIZE));
                }
                let mut packed = vec![0; entry.point.ty.size()];
                self.controller.read_point(entry.direction, entry.index, &mut packed);
                return Ok(entry.value(&packed));
            }
        };
        Ok(whole.into_iter().take(length as usize).collect())
    }

    fn table(&self) -> Vec<u8> {
        self.entries.iter().flat_map(|entry| entry.symbol.encoded()).collect()
    }

    fn write(&self, group: u32, offset: u32, value: &[u8]) -> Result<(), Refused> {
        if group == command::RELEASE_HANDLE {
            return Ok(());
        }
        let entry = self.entry(group, offset)?;
        let packed = entry.packed(value)?;
        self.controller.write_points(std::iter::once((entry.index, &packed[..])));
        Ok(())
    }

    /// Services that are called by writing and reading.
    fn call(&self, group: u32, offset: u32, written: &[u8]) -> Answer {
        match group {
            // A handle is the number of the entry, counted from 1.
            command::HANDLE_BY_NAME => Ok((self.named(written)? as u32 + 1).to_le_bytes().to_vec()),
            command::INFO_BY_NAME_EX => Ok(self.entries[self.named(written)?].symbol.encoded()),
            command::SUM_READ => self.sum_read(offset, written),
            command::SUM_WRITE => self.sum_write(offset, written),
            _ => Err(Refused(command::BAD_GROUP)),
        }
    }

    fn named(&self, name: &[u8]) -> Result<usize, Refused> {
        let name: String = name.iter().copied().take_while(|byte| *byte != 0).map(char::from).collect();
        let is_it = |entry: &Entry| entry.symbol.name.eq_ignore_ascii_case(&name);
        self.entries.iter().position(is_it).ok_or(Refused(command::NO_SYMBOL))
    }

    /// By place or by handle.
    fn entry(&self, group: u32, offset: u32) -> Result<&Entry, Refused> {
        let found = match group {
            command::VALUE_BY_HANDLE => (offset as usize).checked_sub(1).and_then(|index| self.entries.get(index)),
            DATA => self
                .entries
                .binary_search_by_key(&offset, |entry| entry.symbol.place.1)
                .ok()
                .map(|at| &self.entries[at]),
            _ => return Err(Refused(command::BAD_GROUP)),
        };
        found.ok_or(Refused(command::BAD_OFFSET))
    }

    fn sum_read(&self, count: u32, written: &[u8]) -> Answer {
        let parts = parts(count, &mut Bytes(written))?;
        let snapshot = self.controller.snapshot();
        let (mut codes, mut values) = (Vec::new(), Vec::new());
        for [group, offset, length] in parts {
            let entry = self.entry(group, offset).and_then(|entry| {
                if entry.symbol.size == length { Ok(entry) } else { Err(Refused(command::BAD_SIZE)) }
            });
            let end = values.len().saturating_add(length as usize);
            let code = match entry {
                Ok(entry) => {
                    values.extend(entry.value_in(&snapshot));
                    0
                }
                // Nobody may have more written for him than there is.
                Err(_) if end > MAX_DATA => return Err(Refused(command::BAD_SIZE)),
                Err(Refused(code)) => code,
            };
            values.resize(end, 0);
            codes.extend_from_slice(&u32::to_le_bytes(code));
        }
        Ok([codes, values].concat())
    }

    fn sum_write(&self, count: u32, written: &[u8]) -> Answer {
        let mut written = Bytes(written);
        let parts = parts(count, &mut written)?;
        let (mut codes, mut points) = (Vec::new(), Vec::new());
        for [group, offset, length] in parts {
            let value = written.take(length as usize).ok_or(Refused(command::BAD_DATA))?;
            let packed = self.entry(group, offset).and_then(|entry| Ok((entry.index, entry.packed(value)?)));
            let code = match packed {
                Ok(point) => {
                    points.push(point);
                    0
                }
                Err(Refused(code)) => code,
            };
            codes.extend_from_slice(&u32::to_le_bytes(code));
        }
        self.controller.write_points(points.iter().map(|(index, packed)| (*index, &packed[..])));
        Ok(codes)
    }
}

impl Entry {
    /// A packed value, as it stands in a device's memory.
    fn value(&self, packed: &[u8]) -> Vec<u8> {
        let mut value = Vec::new();
        Form::of(self.point.ty).put(packed, &mut value);
        value
    }

    fn value_in(&self, snapshot: &Snapshot) -> Vec<u8> {
        self.value(&snapshot.of(self.direction)[self.point.range()])
    }

    /// A value that is to be written, packed.
    fn packed(&self, value: &[u8]) -> Result<Vec<u8>, Refused> {
        if self.direction == Direction::FromPlc {
            return Err(Refused(command::NO_ACCESS));
        }
        if value.len() != self.symbol.size as usize {
            return Err(Refused(command::BAD_SIZE));
        }
        let mut packed = vec![0; self.point.ty.size()];
        if Form::of(self.point.ty).take(value, &mut packed) { Ok(packed) } else { Err(Refused(command::BAD_DATA)) }
    }
}

/// Group, offset and length of each part of a sum command.
fn parts(count: u32, written: &mut Bytes<'_>) -> Result<Vec<[u32; 3]>, Refused> {
    if count as usize > SUM_MAX {
        return Err(Refused(command::BAD_SIZE));
    }
    let mut part = || Some([written.u32()?, written.u32()?, written.u32()?]);
    (0..count).map(|_| part().ok_or(Refused(command::BAD_DATA))).collect()
}

/// With its length in front.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}
