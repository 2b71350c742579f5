//! A PLC's state as bytes.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | magic and version |
//! | 32 + 32 | digest of layout and task plan; digest of the code |
//! | 3 (4 ...) | layout, plan and code, to say in what another PLC differs |
//! | 8 | virtual time of the last scan |
//! | 4 + 17 each | how each task waits |
//! | 1 ... | 0, or 1 and the fault |
//! | 4 ... | forces |
//! | 8 + size | memory |
//!
//! All numbers are little-endian.
//!
//! | module | subject |
//! |---|---|
//! | [`tasks`] | the task plan in it |
//! | [`error`] | why bytes are not the state of a PLC |

mod error;
mod tasks;

pub use self::error::RestoreError;
pub use self::tasks::PlanDifference;
use onescan_base::VirtualTime;

use super::fault::{FaultSite, PlcFault};
use super::forces::Forces;
use super::scheduler::Waiting;
use crate::application::Application;
use crate::application::identity::bytes::{Reader, Writer};
use crate::application::identity::code::Code;
use crate::application::identity::layout::Layout;
use crate::application::identity::{Digest, VariableDifference, digest};
use crate::compile::fault::FaultKind;
use onescan_iec::check::VIRTUAL_TIME_OFFSET;
use onescan_iec::task_plan::TaskPlan;

/// How a saved state writes an instant that does not come.
const NEVER_NS: u64 = u64::MAX;

fn instant(ns: u64) -> Option<VirtualTime> {
    (ns != NEVER_NS).then(|| VirtualTime::from_nanos(ns))
}

const MAGIC: [u8; 8] = *b"OSPLC\0\0\x04";

/// Whose states a PLC takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CodePolicy {
    /// Those of the same sources, apart from comments and white space.
    #[default]
    SameCode,
    /// Those of any sources with the same variables and tasks. Each variable takes its saved value; constants
    /// are those of the PLC's own sources.
    AnyCode,
}

/// What a PLC's states mean.
#[derive(Debug)]
pub(super) struct Meaning {
    layout: Digest,
    code: Digest,
    /// Layout, plan and code as bytes, each with its length in front. Names are as they are written, for messages;
    /// in the digests they have no case.
    tables: Vec<u8>,
}

impl Meaning {
    pub(super) fn new(application: &Application, plan: &TaskPlan) -> Self {
        let (layout, code) = (application.layout(), application.code());
        let mut tables = Writer::default();
        for table in [layout.encode(), tasks::encode(plan), code.encode()] {
            tables.block(&table);
        }
        let mut meant = Writer::default();
        meant.raw(&layout.digest());
        meant.raw(&tasks::encode(&tasks::folded(plan)));
        Self { layout: digest(&meant.finish()), code: code.digest(), tables: tables.finish() }
    }
}

/// A PLC's state with its memory: that of the PLC while it is saved, bytes of its own once it was read.
pub(super) struct State<M> {
    pub(super) now: VirtualTime,
    pub(super) waiting: Vec<Waiting>,
    pub(super) fault: Option<PlcFault>,
    pub(super) forces: Forces,
    pub(super) memory: M,
}

impl State<&[u8]> {
    pub(super) fn encode(&self, meaning: &Meaning) -> Vec<u8> {
        let mut writer = Writer::with_capacity(self.memory.len() + meaning.tables.len() + 256);
        writer.raw(&MAGIC);
        writer.raw(&meaning.layout);
        writer.raw(&meaning.code);
        writer.raw(&meaning.tables);
        writer.number(self.now.as_nanos());
        writer.count(self.waiting.len());
        for Waiting { due, edge, level } in &self.waiting {
            for instant in [due, edge] {
                writer.number(instant.map_or(NEVER_NS, VirtualTime::as_nanos));
            }
            writer.flag(*level);
        }
        writer.flag(self.fault.is_some());
        if let Some(fault) = &self.fault {
            encode_fault(fault, &mut writer);
        }
        writer.count(self.forces.iter().len());
        for force in self.forces.iter() {
            writer.text(&force.variable.path);
            writer.block(&force.bytes);
        }
        writer.number(self.memory.len() as u64);
        writer.raw(self.memory);
        writer.finish()
    }
}

fn encode_fault(fault: &PlcFault, writer: &mut Writer) {
    writer.byte(fault.kind as u8);
    writer.number(fault.virtual_time.as_nanos());
    writer.count(fault.callers.len());
    for site in std::iter::once(&fault.at).chain(&fault.callers) {
        writer.small_number(site.line);
        writer.small_number(site.column);
        for text in [&site.file, &site.pou, &site.instance, &site.part] {
            writer.text(text);
        }
    }
}

/// Reads states for a PLC.
pub(super) struct Decoder<'p> {
    pub(super) application: &'p Application,
    pub(super) plan: &'p TaskPlan,
    pub(super) meaning: &'p Meaning,
    pub(super) policy: CodePolicy,
}

/// Whether a state comes from the very sources that the PLC runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Provenance {
    SameCode,
    OtherCode,
}

impl Decoder<'_> {
    pub(super) fn decode(&self, bytes: &[u8]) -> Result<State<Vec<u8>>, RestoreError> {
        let mut reader = Reader::new(bytes);
        if reader.take(MAGIC.len()) != Some(&MAGIC) {
            return Err(RestoreError::NotAState);
        }
        let provenance = self.provenance(&mut reader)?;
        let (now, waiting, fault) = self.progress(&mut reader).ok_or(RestoreError::Damaged)?;
        let forces = self.forces(&mut reader)?;
        let memory = self.memory(&mut reader, provenance).ok_or(RestoreError::Damaged)?;
        let state = State { now, waiting, fault, forces, memory };
        if reader.is_at_end() { Ok(state) } else { Err(RestoreError::Damaged) }
    }

    /// Refuses what means something else. The tables are read only to say in what it does.
    fn provenance(&self, reader: &mut Reader<'_>) -> Result<Provenance, RestoreError> {
        let mut digest = || reader.array::<32>().ok_or(RestoreError::Damaged);
        let (layout, code) = (digest()?, digest()?);
        let mut table = || reader.block().ok_or(RestoreError::Damaged);
        let (variables, plan, sources) = (table()?, table()?, table()?);
        if layout != self.meaning.layout {
            let saved = Layout::decode(variables).ok_or(RestoreError::Damaged)?;
            if let Some(found) = self.application.layout().difference(&saved) {
                return Err(found.into());
            }
            let saved = tasks::decode(plan).ok_or(RestoreError::Damaged)?;
            let found = tasks::difference(self.plan, &saved);
            return Err(found.map_or(RestoreError::Damaged, RestoreError::from));
        }
        match self.policy {
            _ if code == self.meaning.code => Ok(Provenance::SameCode),
            CodePolicy::AnyCode => Ok(Provenance::OtherCode),
            CodePolicy::SameCode => {
                let saved = Code::decode(sources).ok_or(RestoreError::Damaged)?;
                Err(RestoreError::OtherCode(self.application.code().difference(&saved)))
            }
        }
    }

    fn progress(&self, reader: &mut Reader<'_>) -> Option<(VirtualTime, Vec<Waiting>, Option<PlcFault>)> {
        let now = VirtualTime::from_nanos(reader.number()?);
        let waiting = reader.list(|reader| {
            let [due, edge] = [reader.number()?, reader.number()?].map(instant);
            Some(Waiting { due, edge, level: reader.flag()? })
        })?;
        let fault = if reader.flag()? { Some(decode_fault(reader)?) } else { None };
        (waiting.len() == self.plan.tasks.len()).then_some((now, waiting, fault))
    }

    fn forces(&self, reader: &mut Reader<'_>) -> Result<Forces, RestoreError> {
        let list = reader.list(|reader| Some((reader.text()?, reader.block()?))).ok_or(RestoreError::Damaged)?;
        let mut forces = Forces::default();
        for (path, bytes) in list {
            // Names of VAR_ACCESS are paths, too, and no part of the layout.
            let variable = self.application.variable(&path);
            let variable = variable.map_err(|unknown| VariableDifference::Unknown { path: unknown.path })?;
            if variable.size as usize != bytes.len() {
                return Err(RestoreError::Damaged);
            }
            forces.hold(variable, bytes.to_vec());
        }
        Ok(forces)
    }

    fn memory(&self, reader: &mut Reader<'_>, provenance: Provenance) -> Option<Vec<u8>> {
        let size = usize::try_from(reader.number()?).ok()?;
        let saved = reader.take(size)?;
        let image = self.application.initial_memory();
        // Bytes that belong to no variable are placed by the compiler, of which there may be other versions.
        if provenance == Provenance::SameCode && saved.len() == image.len() {
            return Some(saved.to_vec());
        }
        let mut memory = image.to_vec();
        let time = VIRTUAL_TIME_OFFSET as usize;
        let time = time..time + size_of::<u64>();
        for range in std::iter::once(time).chain(self.application.layout().ranges()) {
            memory.get_mut(range.clone())?.copy_from_slice(saved.get(range)?);
        }
        Some(memory)
    }
}

fn decode_fault(reader: &mut Reader<'_>) -> Option<PlcFault> {
    let code = reader.byte()?;
    let kind = FaultKind::ALL.into_iter().find(|kind| *kind as u8 == code)?;
    let virtual_time = VirtualTime::from_nanos(reader.number()?);
    let count = reader.small_number()?;
    let at = decode_site(reader)?;
    let callers = (0..count).map(|_| decode_site(reader)).collect::<Option<_>>()?;
    Some(PlcFault { kind, at, callers, virtual_time })
}

fn decode_site(reader: &mut Reader<'_>) -> Option<FaultSite> {
    let (line, column) = (reader.small_number()?, reader.small_number()?);
    let (file, pou, instance) = (reader.text()?, reader.text()?, reader.text()?);
    Some(FaultSite { pou, instance, part: reader.text()?, file, line, column })
}
