//! The soft PLC as a client of a session.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use onescan_base::ElementaryType;
use onescan_iec::TaskPlan;
use onescan_iec_run::{
    Application, CodePolicy, Coverage, PlcFault, RestoreError, RunError, SoftPlc, UnknownVariable, WriteError,
};
use onescan_server::client::{
    Client, ClientFault, ClientOperation, ClientView, JoinRequest, Memory, OperationRefused, Parts, SourcePlace,
    StateError, ValueTable, Wake,
};
use onescan_server::signal::{ClientName, Port, SignalName, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};

use onescan_stream::Losses;

use super::bind::{Bindings, Bound, Place};
use super::files::{FileError, PlcFile};
use super::journal::{Journalling, Keeper};
use super::ports::{PlcPort, PortError, Ports, PortsState};
use super::trace::{TraceSink, Tracing};
use super::watch::{SightingSink, Watch, Watcher};

/// The largest memory that is shown to those who look, bytes: they look 60 times a second.
const SHOWN_BYTES_MAX: usize = 1 << 20;

/// A value's bytes in a port and in the PLC's memory.
#[derive(Clone, Copy, Debug)]
struct Run {
    port: usize,
    memory: Place,
    len: usize,
}

impl Run {
    fn take(&self, memory: &[u8], port: &mut [u8]) {
        self.memory.take(memory, &mut port[self.port..self.port + self.len]);
    }

    fn give(&self, port: &[u8], memory: &mut [u8]) {
        self.memory.give(&port[self.port..self.port + self.len], memory);
    }
}

/// A soft PLC that takes part in a session.
pub struct SoftPlcClient {
    request: JoinRequest,
    plc: SoftPlc,
    inputs: Vec<Run>,
    outputs: Vec<Run>,
    /// Whose states [`Client::restore`] takes.
    code_policy: CodePolicy,
    /// Variables that begin with other values than the program says: path and literal.
    presets: Vec<(String, String)>,
    /// Where what was executed goes when the client's part is over.
    coverage: Option<CoverageSink>,
    tracing: Option<Tracing>,
    journal: Option<Keeper>,
    watcher: Option<Watcher>,
    /// The largest memory that is shown, bytes.
    shown_bytes_max: usize,
    ports: Ports,
    /// What the program finds in its file system at the set-up.
    files: Vec<PlcFile>,
    tables: Vec<Table>,
}

/// An array that is shown as a table.
struct Table {
    name: Arc<str>,
    offset: usize,
    ty: ElementaryType,
    columns: usize,
    elements: usize,
}

/// Why an array is not a table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTable {
    /// There is no such variable.
    #[error(transparent)]
    Unknown(#[from] UnknownVariable),
    /// It is not an array of elementary values.
    #[error("`{0}` is not an array of elementary values")]
    NoArray(String),
    /// Its elements are not whole rows.
    #[error("`{path}` has {elements} elements, which are not rows of {row}")]
    Rows {
        path: String,
        elements: usize,
        /// Elements of a row, as asked for.
        row: u32,
    },
}

/// What the PLCs of a run have executed together.
pub type CoverageSink = Arc<Mutex<Coverage>>;

impl SoftPlcClient {
    /// A client `name` that runs `application` by `plan`. It takes part in every `step` if tasks wait
    /// for an edge or programs have no task, else as often as its tasks' intervals want.
    ///
    /// # Errors
    /// The plan does not suit the application.
    pub fn new(
        name: ClientName,
        application: &Application,
        plan: &TaskPlan,
        bindings: &Bindings,
        step: TimeSpan,
    ) -> Result<Self, RunError> {
        let plc = SoftPlc::new(application, plan)?;
        let period = if plc.wants_every_step() { Some(step) } else { plc.period() };
        let period = period.ok_or(RunError::NoTasks)?;
        let ports = |bound: &[Bound]| bound.iter().map(|bound| bound.port.clone()).collect();
        let request = JoinRequest { name, period, reads: ports(&bindings.inputs), writes: ports(&bindings.outputs) };
        Ok(Self {
            request,
            plc,
            inputs: runs(&bindings.inputs),
            outputs: runs(&bindings.outputs),
            code_policy: CodePolicy::default(),
            presets: Vec::new(),
            coverage: None,
            tracing: None,
            journal: None,
            watcher: None,
            shown_bytes_max: SHOWN_BYTES_MAX,
            tables: Vec::new(),
            ports: Ports::default(),
            files: Vec::new(),
        })
    }

    /// Gives the PLC ports; `seed` is for what happens on them by chance.
    ///
    /// # Errors
    /// The application has not what a port is bound to.
    pub fn with_ports(mut self, described: &[PlcPort], seed: u64) -> Result<Self, PortError> {
        let size = |ports: &[Port]| ports.iter().map(|port| port.ty.size()).sum();
        let before = (size(&self.request.reads), size(&self.request.writes));
        self.ports = Ports::bind(self.plc.application(), described, before, seed)?;
        let [reads, writes] = Ports::signals(described);
        self.request.reads.extend(reads);
        self.request.writes.extend(writes);
        Ok(self)
    }

    /// Whether its program has a block or function that opens files.
    pub fn opens_files(&self) -> bool {
        PlcFile::are_in(self.plc.application())
    }

    /// Puts files into the PLC's file system, where its program finds them from the set-up on.
    ///
    /// # Errors
    /// The program has no block or function of files, or there is no room for so many or so long ones.
    pub fn with_files(mut self, files: Vec<(String, Vec<u8>)>) -> Result<Self, FileError> {
        self.files = PlcFile::all(self.plc.application(), files)?;
        Ok(self)
    }

    /// Bytes that did not get through its ports so far, by the name of the port.
    pub fn losses(&self) -> impl Iterator<Item = (&str, Losses)> {
        self.ports.losses()
    }

    /// Lets the variable at `path` begin with a value, given as a literal, in place of that of its declaration.
    ///
    /// # Errors
    /// There is no such variable, it may not be written, or the text is not a value of its type.
    pub fn preset(&mut self, path: &str, value: &str) -> Result<(), WriteError> {
        self.plc.write(path, value)?;
        self.presets.push((path.to_owned(), value.to_owned()));
        Ok(())
    }

    /// Whether the variable at `path` could be written or forced to a value, given as a literal.
    ///
    /// # Errors
    /// There is no such variable, it may not be written, or the text is not a value of its type.
    pub fn check_write(&self, path: &str, value: &str) -> Result<(), WriteError> {
        self.plc.check_write(path, value)
    }

    /// Says whose states [`Client::restore`] takes from here on: at first those of the same sources alone.
    pub fn accept_states_of(&mut self, policy: CodePolicy) {
        self.code_policy = policy;
    }

    /// Takes a saved state as [`Client::restore`] does, and says why if it cannot.
    ///
    /// # Errors
    /// See [`SoftPlc::restore_with`]. Nothing has changed then.
    pub fn restore_with(&mut self, state: &[u8], policy: CodePolicy) -> Result<(), RestoreError> {
        let (state, ports) = self.split(state)?;
        self.plc.restore_with(state, policy)?;
        if let Some(ports) = ports {
            self.ports.restore(ports).map_err(|_| RestoreError::Damaged)?;
        }
        // What was seen of a run that went further is of a future that may never come.
        let now = self.plc.now();
        if let Some(tracing) = &self.tracing {
            tracing.rewind(now);
        }
        if let Some(watcher) = &mut self.watcher {
            watcher.rewind(now);
            watcher.look(&self.plc, now);
        }
        Ok(())
    }

    /// Gives what has been executed to `sink` when the client is dropped. The application must have
    /// been compiled for it.
    pub fn cover(&mut self, sink: CoverageSink) {
        self.coverage = Some(sink);
    }

    /// Tells `sink` which statements write those of `signals` that are its outputs, and which ways
    /// decisions go. The application must have been compiled for it.
    pub fn trace(&mut self, signals: &BTreeSet<SignalName>, sink: TraceSink) {
        // An output has one place.
        let outputs = self.request.writes.iter().zip(&self.outputs).map(|(port, run)| {
            let Place { offset, bit, .. } = run.memory;
            (port.name.clone(), (offset..offset + run.memory.size(run.len), bit))
        });
        self.tracing = Some(Tracing::start(&self.request.name, &mut self.plc, signals, outputs, sink));
    }

    /// Hands over what each scan does. The application must have been compiled for tracing if acts are wanted, and
    /// [`Self::trace`] is not for the same run then.
    pub fn journal(&mut self, journalling: &Journalling) {
        self.journal = Keeper::new(&self.request.name, journalling);
    }

    /// Looks at variables after the set-up and after every turn, all changes if `changes`, else for what
    /// they are last. A watch comes with its number among those of all PLCs.
    ///
    /// # Errors
    /// A path leads to no variable.
    pub fn watch(
        &mut self,
        watches: &[(usize, Watch)],
        changes: bool,
        sink: SightingSink,
    ) -> Result<(), UnknownVariable> {
        self.watcher = Some(Watcher::new(self.plc.application(), watches, changes, sink)?);
        Ok(())
    }

    /// Shows its memory whole to those who look, however large it is: for those who look now and then.
    pub fn show_whole(&mut self) {
        self.shown_bytes_max = usize::MAX;
    }

    /// Shows the array at `path` as a table with rows of so many elements.
    ///
    /// # Errors
    /// There is no such array, or it has no such rows.
    pub fn show_table(&mut self, path: &str, row: u32) -> Result<(), NoTable> {
        let whole = self.plc.application().variable(path)?;
        let ty = whole.element.ok_or_else(|| NoTable::NoArray(path.to_owned()))?;
        let elements = (whole.size / ty.size()) as usize;
        if row == 0 || !elements.is_multiple_of(row as usize) {
            return Err(NoTable::Rows { path: path.to_owned(), elements, row });
        }
        let (name, offset) = (Arc::from(path), whole.offset as usize);
        self.tables.push(Table { name, offset, ty, columns: row as usize, elements });
        Ok(())
    }

    /// The state of the PLC, and that of its ports if it has some, which lies behind it.
    fn split<'s>(&self, state: &'s [u8]) -> Result<(&'s [u8], Option<PortsState>), RestoreError> {
        if self.ports.is_empty() {
            return Ok((state, None));
        }
        let (rest, length) = state.split_last_chunk::<8>().ok_or(RestoreError::Damaged)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| RestoreError::Damaged)?;
        let at = rest.len().checked_sub(length).ok_or(RestoreError::Damaged)?;
        let ports: PortsState = postcard::from_bytes(&rest[at..]).map_err(|_| RestoreError::Damaged)?;
        self.ports.check(&ports).map_err(|_| RestoreError::Damaged)?;
        Ok((&rest[..at], Some(ports)))
    }

    fn look(&mut self, t_v: VirtualTime) {
        if let Some(watcher) = &mut self.watcher {
            watcher.look(&self.plc, t_v);
        }
    }

    /// The PLC.
    pub fn plc(&self) -> &SoftPlc {
        &self.plc
    }

    pub(super) fn plc_mut(&mut self) -> &mut SoftPlc {
        &mut self.plc
    }

    /// The signal that writes into a part of memory, or into the bit of a byte, before every scan.
    pub(super) fn input_at(&self, range: Range<usize>, bit: Option<u8>) -> Option<SignalName> {
        let reaches = |run: &&Run| {
            let Place { offset, bit: own, .. } = run.memory;
            let shares_bytes = offset < range.end && range.start < offset + run.memory.size(run.len);
            shares_bytes && (own.is_none() || bit.is_none() || own == bit)
        };
        let found = self.inputs.iter().find(reaches)?;
        // Ports lie behind one another, so that a place in them tells the signal.
        let mut end = 0;
        let mut signals = self.request.reads.iter();
        let holds = |port: &&Port| {
            end += port.ty.size();
            found.port < end
        };
        signals.find(holds).map(|port| port.name.clone())
    }

    fn take_outputs(&self, outputs: &mut [u8]) {
        let memory = self.plc.memory();
        for run in &self.outputs {
            run.take(memory, outputs);
        }
    }
}

impl Table {
    fn of(&self, client: &ClientName, memory: &[u8]) -> ValueTable {
        let size = self.ty.size() as usize;
        let of_array = memory.get(self.offset..self.offset + size * self.elements).unwrap_or_default();
        let values = self.ty.numbers(of_array);
        let rows = self.elements / self.columns;
        ValueTable {
            client: client.clone(),
            name: Arc::clone(&self.name),
            columns: self.columns,
            across: [0.0, self.columns as f64],
            down: [0.0, rows as f64],
            values,
        }
    }
}

/// Where the values of a port go, in its order; an input may go to several places.
fn runs(bound: &[Bound]) -> Vec<Run> {
    let mut port = 0;
    let mut runs = Vec::new();
    for bound in bound {
        let len = bound.port.ty.size();
        runs.extend(bound.places.iter().map(|&memory| Run { port, memory, len }));
        port += len;
    }
    runs
}

impl Drop for SoftPlcClient {
    fn drop(&mut self) {
        if let Some((sink, coverage)) = self.coverage.as_ref().zip(self.plc.coverage()) {
            // Merging only adds: whoever panicked while it held the lock left counts that are true.
            sink.lock().unwrap_or_else(PoisonError::into_inner).merge(&coverage);
        }
    }
}

impl Client for SoftPlcClient {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.plc.reset();
        if let Some(tracing) = &self.tracing {
            tracing.begin();
        }
        // A reset has given every variable its declared value again.
        for (path, value) in &self.presets {
            self.plc.write(path, value).map_err(|error| ClientFault::new(error.to_string()))?;
        }
        let begun = self.ports.begin(&mut self.plc, outputs);
        let begun = begun.and_then(|()| self.files.iter().try_for_each(|file| file.put(&mut self.plc)));
        begun.map_err(|error| ClientFault::new(error.to_string()))?;
        self.take_outputs(outputs);
        self.look(VirtualTime::default());
        Ok(())
    }

    fn begin(&mut self, operations: &[ClientOperation], outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.setup(outputs)?;
        for operation in operations {
            self.operate(operation).map_err(|refused| ClientFault::new(format!("{operation}: {refused}")))?;
        }
        // What was set may be an output.
        self.take_outputs(outputs);
        Ok(())
    }

    fn operate(&mut self, operation: &ClientOperation) -> Result<(), OperationRefused> {
        let refused = |error: &dyn std::fmt::Display| OperationRefused::Because(error.to_string());
        match operation {
            ClientOperation::WriteVariable { variable, value } => {
                self.set_variable(variable, value).map_err(|error| refused(&error))
            }
            ClientOperation::ForceVariable { variable, value } => {
                self.force_variable(variable, value).map_err(|error| refused(&error))
            }
            ClientOperation::ReleaseVariable { variable } => match self.release_variable(variable) {
                Ok(true) => Ok(()),
                Ok(false) => Err(refused(&format!("variable `{variable}` is not forced"))),
                Err(unknown) => Err(refused(&unknown)),
            },
            ClientOperation::Postpone { task, by } => {
                self.plc.postpone(task.as_deref(), *by).map_err(|error| refused(&error))
            }
            ClientOperation::CatchUp { task, by } => {
                self.plc.catch_up(task.as_deref(), *by).map_err(|error| refused(&error))
            }
            ClientOperation::Fail { .. }
            | ClientOperation::Repair { .. }
            | ClientOperation::ChangeParameter { .. }
            | ClientOperation::RestoreParameter { .. } => Err(OperationRefused::Unsupported),
        }
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let memory = self.plc.memory_mut();
        for run in &self.inputs {
            run.give(inputs, memory);
        }
        self.ports.arrive(t_v.as_nanos(), inputs, memory);
        if let Some(journal) = &mut self.journal {
            journal.begin(&mut self.plc, t_v);
        }
        // The scan's fault is looked at last: journal, trace and watches show what led to it.
        let scanned = self.plc.scan(t_v);
        if let Some(journal) = &self.journal {
            journal.end(&self.plc, t_v);
        }
        if let Some(tracing) = &self.tracing {
            tracing.note(&self.plc, t_v);
        }
        self.look(t_v);
        scanned.map_err(|fault| client_fault(&fault))?;
        self.ports.depart(t_v.as_nanos(), inputs, outputs, self.plc.memory_mut());
        self.take_outputs(outputs);
        Ok(match self.plc.next_due() {
            Some(due) if !self.plc.wants_every_step() => Wake::At(due),
            // Without a task that may be due at any step nothing is due only past the end of time.
            _ => Wake::NextPeriod,
        })
    }

    fn show(&self, parts: Parts, view: &mut ClientView) {
        let memory = self.plc.memory();
        if parts.tables {
            view.tables.extend(self.tables.iter().map(|table| table.of(&self.request.name, memory)));
        }
        if !parts.memories || memory.len() > self.shown_bytes_max {
            return;
        }
        view.memories.push(Memory {
            client: self.request.name.clone(),
            bytes: memory.to_vec(),
            forced: self.plc.forced().map(|variable| variable.path.clone()).collect(),
            executed: self.plc.executed().to_vec(),
        });
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        let mut state = self.plc.save();
        if !self.ports.is_empty() {
            let ports = postcard::to_stdvec(&self.ports.state());
            let ports = ports.map_err(|error| StateError::Corrupt(format!("its ports cannot be saved: {error}")))?;
            state.extend_from_slice(&ports);
            state.extend_from_slice(&(ports.len() as u64).to_le_bytes());
        }
        Ok(state)
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        self.restore_with(state, self.code_policy).map_err(|error| StateError::Corrupt(error.to_string()))
    }
}

/// The fault in the session's words; the session adds client and virtual time.
fn client_fault(fault: &PlcFault) -> ClientFault {
    let at = &fault.at;
    let place = SourcePlace { file: at.file.clone(), line: at.line, column: at.column };
    let place = (!at.file.is_empty()).then_some(place);
    let way = fault.way();
    // The place comes last, so that who called stands before what happened there.
    let way = way.strip_prefix(", ").map(|way| format!(" ({way})")).unwrap_or_default();
    ClientFault { message: format!("PLC fault: {} in {at}{way}", fault.kind), place }
}
