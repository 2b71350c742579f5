//! The soft PLCs of a running session over ADS, for programs that read variables of a TwinCAT PLC: an operator's screen, a server that
//! keeps what was measured. They read, and change nothing; a session with readers is the session without them.
//!
//! Variables are found by their paths, arrays and structures as a whole. The first PLC is at AMS port 851, the others at those behind
//! it, in the order of their names. What one request reads, a sum command too, is of one step boundary.

use std::io::Write;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use onescan_base::threads;
use onescan_iec_run::Variable;
use onescan_server::client::Parts;
use onescan_server::published::{Published, SessionView};
use onescan_server::signal::{ClientName, SignalType};
use onescan_server::transport::listeners::INSPECTION;

use crate::accept::{Peer, serve_each};
use crate::gateway::ads::command::{self, SUM_MAX};
use crate::gateway::ads::frame::{Bytes, Frame, Kind, MAX_DATA};
use crate::gateway::ads::symbol::{Form, READ_ONLY, Symbol};
use crate::listener::bind;

/// AMS port of the first PLC.
const FIRST_PORT: u16 = 851;
/// Index group of a PLC's data; the offset is the place in its memory.
const DATA: u32 = 0x4040;
/// Number of the base type of arrays and structures.
const BIG: u32 = 65;
/// Name and version that the device says.
const DEVICE: &[u8; 20] = b"\x01\x00\x00\x00onescan\0\0\0\0\0\0\0\0\0";
/// Return code: the device has nothing to say yet.
const NOT_READY: u32 = 0x707;
/// Handles of one client at most.
const HANDLES_MAX: usize = 10_000;
/// How often somebody who waits looks.
const GLANCE: Duration = Duration::from_millis(1);
/// So many looks are taken for the next step boundary; then the view that there is must do.
const GLANCES: u32 = 3_000;

/// Finds a variable of a PLC by its path.
pub type Find = Box<dyn Fn(&str) -> Option<Variable> + Send + Sync>;

/// A soft PLC of the session, and where its variables are.
pub struct Inspected {
    pub client: ClientName,
    /// Finds a variable by its path.
    pub find: Find,
}

/// A server that ends when this is dropped.
#[derive(Debug)]
pub struct Inspection {
    address: SocketAddr,
    over: Arc<AtomicBool>,
}

impl Inspection {
    /// Serves the PLCs of a session whose views are published there, in the order of their names.
    ///
    /// # Errors
    /// The address cannot be listened on, or there is no thread.
    pub fn serve(address: SocketAddr, published: Published, plcs: Vec<Inspected>) -> std::io::Result<Self> {
        let (listener, address) = bind(address)?;
        let over = Arc::new(AtomicBool::new(false));
        let device = Arc::new(Device { published, plcs, over: Arc::clone(&over) });
        threads::start("readers", move || {
            serve_each(&listener, INSPECTION, &device, || device.is_over(), Device::attend);
        })?;
        Ok(Self { address, over })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Inspection {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
    }
}

struct Device {
    published: Published,
    plcs: Vec<Inspected>,
    over: Arc<AtomicBool>,
}

/// A return code that is an error.
struct Refused(u32);

type Answer = Result<Vec<u8>, Refused>;

impl Device {
    fn is_over(&self) -> bool {
        self.over.load(Ordering::Acquire)
    }

    /// Answers what a client asks until it goes.
    fn attend(&self, peer: &mut Peer) -> std::io::Result<()> {
        let (mut handles, mut memories) = (Vec::new(), None);
        while let Some(request) = Frame::read(peer)? {
            if self.is_over() {
                return Ok(());
            }
            peer.stay()?;
            // Nothing is published for who only connects.
            memories.get_or_insert_with(|| self.published.want(Parts::MEMORIES));
            if request.kind == Kind::Request {
                peer.write_all(&self.response(&request, &mut handles).encoded())?;
            }
        }
        Ok(())
    }

    fn response(&self, request: &Frame, handles: &mut Vec<Variable>) -> Frame {
        let plc = request.target.port.checked_sub(FIRST_PORT).and_then(|number| self.plcs.get(usize::from(number)));
        let answer = plc.ok_or(Refused(command::NO_PORT)).and_then(|plc| self.answer(plc, request, handles));
        let data = match answer {
            Ok(answer) => [&[0; 4][..], &answer].concat(),
            Err(Refused(code)) => code.to_le_bytes().to_vec(),
        };
        let Frame { target, source, command, invoke_id, .. } = *request;
        Frame { target: source, source: target, command, kind: Kind::Response, error: 0, invoke_id, data }
    }

    fn answer(&self, plc: &Inspected, request: &Frame, handles: &mut Vec<Variable>) -> Answer {
        let mut data = Bytes(&request.data);
        let mut number = || data.u32().ok_or(Refused(command::BAD_DATA));
        match request.command {
            command::READ_DEVICE_INFO => Ok(DEVICE.to_vec()),
            command::READ_STATE => {
                let state = if self.published.latest().end.is_some() { command::STOP } else { command::RUN };
                Ok([state.to_le_bytes(), [0; 2]].concat())
            }
            command::READ => {
                let part = Part::find([number()?, number()?, number()?], handles)?;
                Ok(counted(&part.read(memory(plc, &self.view())?)?))
            }
            // a handle that is given back is only forgotten with its client
            command::WRITE if number()? == command::RELEASE_HANDLE => Ok(Vec::new()),
            command::WRITE | command::WRITE_CONTROL => Err(Refused(command::NO_ACCESS)),
            command::READ_WRITE => {
                let (group, offset, length, written) = (number()?, number()?, number()?, number()?);
                let written = data.take(written as usize).ok_or(Refused(command::BAD_DATA))?;
                let answer = match group {
                    command::HANDLE_BY_NAME if handles.len() < HANDLES_MAX => {
                        handles.push(named(plc, written)?);
                        // Handles count from 1, so that 0 is none.
                        Ok((handles.len() as u32).to_le_bytes().to_vec())
                    }
                    command::HANDLE_BY_NAME => Err(Refused(command::NO_ACCESS)),
                    command::INFO_BY_NAME_EX => Ok(symbol(&named(plc, written)?).encoded()),
                    command::SUM_READ | command::SUM_READ_EX => self.sum_read(plc, group, offset, written, handles),
                    _ => Err(Refused(command::BAD_GROUP)),
                }?;
                if answer.len() > length as usize { Err(Refused(command::BAD_SIZE)) } else { Ok(counted(&answer)) }
            }
            _ => Err(Refused(command::NOT_SUPPORTED)),
        }
    }

    fn sum_read(&self, plc: &Inspected, group: u32, count: u32, written: &[u8], handles: &[Variable]) -> Answer {
        if count as usize > SUM_MAX {
            return Err(Refused(command::BAD_SIZE));
        }
        let view = self.view();
        let (mut written, mut codes, mut values) = (Bytes(written), Vec::new(), Vec::new());
        for _ in 0..count {
            let mut number = || written.u32().ok_or(Refused(command::BAD_DATA));
            let wanted = [number()?, number()?, number()?];
            let end = values.len().saturating_add(wanted[2] as usize);
            if end > MAX_DATA {
                return Err(Refused(command::BAD_SIZE));
            }
            let read = Part::find(wanted, handles).and_then(|part| part.read(memory(plc, &view)?));
            let code = match read {
                Ok(bytes) => {
                    values.extend(bytes);
                    0
                }
                Err(Refused(code)) => code,
            };
            values.resize(end, 0);
            codes.extend_from_slice(&u32::to_le_bytes(code));
            if group == command::SUM_READ_EX {
                codes.extend_from_slice(&wanted[2].to_le_bytes());
            }
        }
        Ok([codes, values].concat())
    }

    /// The session at a step boundary that comes now; where it stands, if none comes.
    fn view(&self) -> Arc<SessionView> {
        let before = self.published.latest();
        if before.end.is_some() {
            return before;
        }
        self.published.ask();
        for _ in 0..GLANCES {
            let view = self.published.latest();
            let is_whole = view.clients.parts.memories || view.end.is_some();
            if (view.revision != before.revision && is_whole) || self.is_over() {
                return view;
            }
            std::thread::sleep(GLANCE);
        }
        self.published.latest()
    }
}

/// What is to be read of a PLC's memory.
enum Part<'h> {
    /// So many bytes of a variable.
    Of(&'h Variable, usize),
    /// Bytes at a place.
    At(usize, usize),
}

impl<'h> Part<'h> {
    /// That of a group, an offset and a length.
    fn find([group, offset, length]: [u32; 3], handles: &'h [Variable]) -> Result<Self, Refused> {
        let (offset, length) = (offset as usize, length as usize);
        match group {
            _ if length > MAX_DATA => Err(Refused(command::BAD_SIZE)),
            command::VALUE_BY_HANDLE => {
                let variable = offset.checked_sub(1).and_then(|number| handles.get(number));
                variable.map(|variable| Self::Of(variable, length)).ok_or(Refused(command::BAD_OFFSET))
            }
            DATA => Ok(Self::At(offset, length)),
            _ => Err(Refused(command::BAD_GROUP)),
        }
    }

    fn read(&self, memory: &[u8]) -> Answer {
        let at = |offset: usize, length: usize| memory.get(offset..offset.saturating_add(length));
        match *self {
            Self::At(offset, length) => at(offset, length).map(<[u8]>::to_vec).ok_or(Refused(command::BAD_OFFSET)),
            Self::Of(variable, length) => {
                let bytes = at(variable.offset as usize, variable.size as usize).ok_or(Refused(command::BAD_OFFSET))?;
                let value = value(variable, bytes);
                if length > value.len() { Err(Refused(command::BAD_SIZE)) } else { Ok(value[..length].to_vec()) }
            }
        }
    }
}

/// The memory of a PLC in a view.
fn memory<'v>(plc: &Inspected, view: &'v SessionView) -> Result<&'v [u8], Refused> {
    let own = view.clients.memories.iter().find(|memory| memory.client == plc.client);
    own.map(|memory| &memory.bytes[..]).ok_or(Refused(NOT_READY))
}

/// The variable whose name is written, which ends at its first byte of 0.
fn named(plc: &Inspected, name: &[u8]) -> Result<Variable, Refused> {
    let name: String = name.iter().copied().take_while(|byte| *byte != 0).map(char::from).collect();
    (plc.find)(&name).ok_or(Refused(command::NO_SYMBOL))
}

/// The type of a text that lies in memory otherwise than TwinCAT has it: with its length in front.
fn counted_text(variable: &Variable) -> Option<SignalType> {
    let text = |ty: &SignalType| matches!(ty, SignalType::String(_) | SignalType::Wstring(_));
    variable.signal_type.filter(|ty| text(ty) && variable.zero_terminated.is_none())
}

/// The bytes of a variable as TwinCAT has them.
fn value(variable: &Variable, bytes: &[u8]) -> Vec<u8> {
    match (variable.bit, counted_text(variable)) {
        (Some(bit), _) => bytes.iter().take(1).map(|byte| byte >> bit & 1).collect(),
        (None, Some(ty)) => {
            let mut value = Vec::new();
            Form::of(ty).put(bytes, &mut value);
            value
        }
        (None, None) => bytes.to_vec(),
    }
}

fn symbol(variable: &Variable) -> Symbol {
    let form = variable.signal_type.map(Form::of);
    Symbol {
        place: (DATA, variable.offset),
        size: counted_text(variable).map_or(variable.size, |ty| Form::of(ty).size() as u32),
        base: form.map_or(BIG, Form::base),
        flags: READ_ONLY,
        name: variable.path.clone(),
        ty: variable.type_name.clone(),
    }
}

/// With its length in front.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}
