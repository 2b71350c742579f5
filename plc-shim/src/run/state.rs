//! A PLC's state as bytes.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | magic and version |
//! | 8 | fingerprint of application and plan |
//! | 8 | virtual time of the last scan |
//! | 4 + 17 each | how each task waits |
//! | 1 ... | 0, or 1 and the fault |
//! | 4 ... | forces |
//! | 8 + size | memory |
//!
//! All numbers are little-endian.

use onescan_base::{TimeSpan, VirtualTime};
use thiserror::Error;

use super::fault::{FaultSite, PlcFault};
use super::force::Forces;
use super::plan::TaskPlan;
use super::scheduler::Waiting;
use crate::application::Application;
use crate::compile::fault::FaultKind;

const MAGIC: [u8; 8] = *b"OSPLC\0\0\x03";

/// Why bytes were not taken as a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum RestoreError {
    /// They do not begin as a state does.
    #[error("this is not a saved PLC state, or one of another version")]
    NotAState,
    /// They are a state of something else.
    #[error("the saved state belongs to another program or task plan")]
    OtherApplication,
    /// They end too early, go on too long or hold impossible numbers.
    #[error("the saved state is damaged")]
    Damaged,
}

/// How a saved state writes an instant that does not come.
const NEVER_NS: u64 = u64::MAX;

pub(super) struct State<'m> {
    pub(super) now: VirtualTime,
    pub(super) waiting: Vec<Waiting>,
    pub(super) fault: Option<PlcFault>,
    pub(super) forces: Forces,
    pub(super) memory: &'m [u8],
}

/// Tells applications and plans apart (FNV-1a).
pub(super) fn fingerprint(application: &Application, plan: &TaskPlan) -> u64 {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    let mut add = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    add(application.wasm());
    add(application.initial_memory());
    add(&plan.fuel_per_task.to_le_bytes());
    for task in &plan.tasks {
        add(task.name.as_bytes());
        add(&task.interval.map_or(0, TimeSpan::as_nanos).to_le_bytes());
        add(&task.priority.to_le_bytes());
        for name in task.programs.iter().chain(&task.single) {
            add(name.to_ascii_uppercase().as_bytes());
            add(&[0]);
        }
        add(&[1, u8::from(task.single.is_some())]);
    }
    for program in &plan.background {
        add(program.to_ascii_uppercase().as_bytes());
        add(&[0]);
    }
    hash
}

impl<'m> State<'m> {
    pub(super) fn encode(&self, fingerprint: u64) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.memory.len() + 256);
        bytes.extend_from_slice(&MAGIC);
        bytes.extend_from_slice(&fingerprint.to_le_bytes());
        bytes.extend_from_slice(&self.now.as_nanos().to_le_bytes());
        bytes.extend_from_slice(&(self.waiting.len() as u32).to_le_bytes());
        for Waiting { due, edge, level } in &self.waiting {
            for instant in [due, edge] {
                bytes.extend_from_slice(&instant.map_or(NEVER_NS, VirtualTime::as_nanos).to_le_bytes());
            }
            bytes.push(u8::from(*level));
        }
        bytes.push(u8::from(self.fault.is_some()));
        if let Some(fault) = &self.fault {
            encode_fault(fault, &mut bytes);
        }
        bytes.extend_from_slice(&(self.forces.iter().len() as u32).to_le_bytes());
        for force in self.forces.iter() {
            for part in [force.variable.path.as_bytes(), &force.bytes] {
                bytes.extend_from_slice(&(part.len() as u32).to_le_bytes());
                bytes.extend_from_slice(part);
            }
        }
        bytes.extend_from_slice(&(self.memory.len() as u64).to_le_bytes());
        bytes.extend_from_slice(self.memory);
        bytes
    }

    pub(super) fn decode(
        bytes: &'m [u8],
        fingerprint: u64,
        application: &Application,
        tasks: usize,
        memory_size: usize,
    ) -> Result<Self, RestoreError> {
        let mut reader = Reader { rest: bytes };
        if reader.take(MAGIC.len()).ok_or(RestoreError::NotAState)? != MAGIC {
            return Err(RestoreError::NotAState);
        }
        if reader.number().ok_or(RestoreError::Damaged)? != fingerprint {
            return Err(RestoreError::OtherApplication);
        }
        reader.state(application, tasks, memory_size).ok_or(RestoreError::Damaged)
    }
}

fn encode_fault(fault: &PlcFault, bytes: &mut Vec<u8>) {
    let kind = FaultKind::ALL.iter().position(|kind| *kind == fault.kind);
    bytes.push(kind.unwrap_or(FaultKind::ALL.len() - 1) as u8);
    bytes.extend_from_slice(&fault.virtual_time.as_nanos().to_le_bytes());
    bytes.extend_from_slice(&(fault.callers.len() as u32).to_le_bytes());
    for site in std::iter::once(&fault.at).chain(&fault.callers) {
        bytes.extend_from_slice(&site.line.to_le_bytes());
        bytes.extend_from_slice(&site.column.to_le_bytes());
        for text in [&site.file, &site.pou, &site.instance, &site.part] {
            bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
            bytes.extend_from_slice(text.as_bytes());
        }
    }
}

/// Reads from the front; nothing where the bytes end.
struct Reader<'m> {
    rest: &'m [u8],
}

impl<'m> Reader<'m> {
    fn take(&mut self, count: usize) -> Option<&'m [u8]> {
        let (front, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(front)
    }

    fn number(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    fn small_number(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    fn byte(&mut self) -> Option<u8> {
        self.take(1)?.first().copied()
    }

    fn text(&mut self) -> Option<String> {
        let length = self.small_number()? as usize;
        String::from_utf8(self.take(length)?.to_vec()).ok()
    }

    fn state(&mut self, application: &Application, tasks: usize, memory_size: usize) -> Option<State<'m>> {
        let now = VirtualTime::from_nanos(self.number()?);
        if self.small_number()? as usize != tasks {
            return None;
        }
        let waiting = (0..tasks).map(|_| self.waiting()).collect::<Option<_>>()?;
        let fault = if self.flag()? { Some(self.fault()?) } else { None };
        let forces = self.forces(application)?;
        if self.number()? != memory_size as u64 {
            return None;
        }
        let memory = self.take(memory_size)?;
        self.rest.is_empty().then_some(State { now, waiting, fault, forces, memory })
    }

    fn fault(&mut self) -> Option<PlcFault> {
        let kind = *FaultKind::ALL.get(self.byte()? as usize)?;
        let virtual_time = VirtualTime::from_nanos(self.number()?);
        let count = self.small_number()?;
        let at = self.site()?;
        let callers = (0..count).map(|_| self.site()).collect::<Option<_>>()?;
        Some(PlcFault { kind, at, callers, virtual_time })
    }

    fn site(&mut self) -> Option<FaultSite> {
        let (line, column) = (self.small_number()?, self.small_number()?);
        let (file, pou, instance) = (self.text()?, self.text()?, self.text()?);
        let part = self.text()?;
        Some(FaultSite { pou, instance, part, file, line, column })
    }

    fn forces(&mut self, application: &Application) -> Option<Forces> {
        let mut forces = Forces::default();
        for _ in 0..self.small_number()? {
            let path = self.text()?;
            let size = self.small_number()? as usize;
            forces.restore(application, &path, self.take(size)?)?;
        }
        Some(forces)
    }

    fn waiting(&mut self) -> Option<Waiting> {
        let instant = |ns: u64| (ns != NEVER_NS).then(|| VirtualTime::from_nanos(ns));
        let (due, edge) = (instant(self.number()?), instant(self.number()?));
        let level = self.flag()?;
        Some(Waiting { due, edge, level })
    }

    fn flag(&mut self) -> Option<bool> {
        match self.byte()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}
