//! The PLC itself.

use std::ops::Range;
use std::sync::OnceLock;

use onescan_base::{TimeSpan, VirtualTime};

use super::fault::{self, PlcFault, WriteSite, explain};
use super::forces::Forces;
use super::frames::Trapped;
use super::journal::{Act, Journal};
use super::machine::{Machine, Occasion};
use super::plan::{Resolved, RunError, resolve};
use super::scheduler::Scheduler;
use super::state::{CodePolicy, Decoder, Meaning, RestoreError, State};
use super::task_info::TaskInfo;
use super::trace::{Trace, Watched};
use super::way::WayId;
use crate::application::{Application, UnknownVariable, Variable};
use crate::coverage::Coverage;
use onescan_iec::check::{INIT_RETAINS_OFFSET, VIRTUAL_TIME_OFFSET};
use onescan_iec::task_plan::TaskPlan;

/// Runs an application's programs by a task plan, one scan at a time.
///
/// ```
/// use onescan_iec::VirtualTime;
/// use onescan_iec_run::{Application, SoftPlc};
///
/// let text = "PROGRAM Main VAR pause : TON; END_VAR pause(IN := TRUE, PT := T#20ms); END_PROGRAM";
/// let application = Application::from_sources([("main.st", text)])?;
/// let mut plc = SoftPlc::new(&application, &application.single_task("10ms".parse()?))?;
/// let over = plc.variable("Main.pause.Q")?;
/// for ms in [10, 20, 30] {
///     plc.scan(VirtualTime::from_nanos(ms * 1_000_000))?;
/// }
/// assert_eq!(application.value_text(&over, plc.memory()), "TRUE");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SoftPlc {
    application: Application,
    machine: Machine,
    pub(super) scheduler: Scheduler,
    /// What each task runs.
    tasks: Vec<Vec<usize>>,
    /// What each scan runs at its end.
    pub(super) background: Vec<usize>,
    is_triggered: bool,
    task_info: Option<TaskInfo>,
    plan: TaskPlan,
    /// Made when a state is saved or restored first.
    meaning: OnceLock<Meaning>,
    /// Virtual time of the last scan.
    now: VirtualTime,
    /// The latest virtual time that this PLC has scanned, whatever was restored since.
    scanned_until: VirtualTime,
    /// The time of the latest state that was restored ahead of what the PLC had scanned itself.
    skipped_to: Option<VirtualTime>,
    fault: Option<PlcFault>,
    pub(super) forces: Forces,
}

impl std::fmt::Debug for SoftPlc {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut debug = formatter.debug_struct("SoftPlc");
        debug.field("now", &self.now).field("fault", &self.fault).finish_non_exhaustive()
    }
}

impl SoftPlc {
    /// Sets up a PLC in its state after a cold start.
    ///
    /// # Errors
    /// The plan does not suit the application.
    pub fn new(application: &Application, plan: &TaskPlan) -> Result<Self, RunError> {
        let Resolved { tasks, singles, background } = resolve(plan, application)?;
        let machine = Machine::new(application, &tasks)?;
        let mut plc = Self {
            application: application.clone(),
            machine,
            scheduler: Scheduler::new(plan, &singles),
            tasks,
            background,
            is_triggered: singles.iter().any(Option::is_some),
            task_info: TaskInfo::find(application, plan),
            plan: plan.clone(),
            meaning: OnceLock::new(),
            now: VirtualTime::default(),
            scanned_until: VirtualTime::default(),
            skipped_to: None,
            fault: None,
            forces: Forces::default(),
        };
        debug_assert_eq!(plc.memory().len(), application.initial_memory().len(), "memory is as large as the image");
        plc.reset();
        Ok(plc)
    }

    /// Gives all variables but the persistent ones their initial values and begins again at virtual
    /// time 0 (2nd ed. 2.4.2). Forces stay. A fault in an instance's `FB_init` is that
    /// of the next scan, as with every start.
    pub fn cold_start(&mut self) {
        self.end();
        self.initialise(&self.application.clone(), Application::persistent);
        self.begin(VirtualTime::default(), true);
    }

    /// Gives all variables but the retained and the persistent ones their initial values
    /// (2nd ed. 2.4.2). Virtual time goes on; every task is due one interval from now. Forces stay.
    pub fn warm_start(&mut self) {
        self.end();
        self.initialise(&self.application.clone(), Application::retained);
        self.begin(self.now, false);
    }

    /// Makes it a new PLC: all variables have their initial values, nothing is forced.
    pub fn reset(&mut self) {
        self.forces.clear();
        self.initialise(&self.application.clone(), |_| &[]);
        self.begin(VirtualTime::default(), true);
    }

    /// Lets instances do what they do before another start. A PLC that has stopped does nothing.
    fn end(&mut self) {
        if self.fault.is_none() && self.machine.has(Occasion::End) {
            let ended = self.begin_task().and_then(|()| self.machine.run_occasion(Occasion::End));
            // A fault there stops what ends anyway; the start that follows takes all of it away.
            drop(ended);
        }
    }

    /// Gives all memory but the kept ranges its initial bytes.
    fn initialise(&mut self, application: &Application, kept: fn(&Application) -> &[Range<u32>]) {
        let image = application.initial_memory();
        let memory = self.machine.memory_mut();
        // Memory is as large as the image, and ranges are inside of it, in ascending order.
        let mut from = 0;
        for range in kept(application) {
            let to = range.start as usize;
            debug_assert!(from <= to && range.start <= range.end, "kept ranges ascend and do not overlap");
            debug_assert!(range.end as usize <= memory.len(), "kept ranges lie within memory");
            memory[from..to].copy_from_slice(&image[from..to]);
            from = range.end as usize;
        }
        memory[from..].copy_from_slice(&image[from..]);
    }

    /// `initial` says that RETAIN variables have their initial values, too.
    fn begin(&mut self, now: VirtualTime, initial: bool) {
        self.scheduler.restart_at(now);
        self.now = now;
        self.fault = None;
        if self.machine.has(Occasion::Start) {
            copy_to(self.machine.memory_mut(), INIT_RETAINS_OFFSET as usize, &[u8::from(initial)]);
            let started = self.begin_task().and_then(|()| self.machine.run_occasion(Occasion::Start));
            if let Err(trapped) = started {
                self.fault = Some(explain(&self.application, &trapped, now));
            }
        }
        self.apply_forces();
    }

    pub(super) fn apply_forces(&mut self) {
        self.forces.apply(self.machine.memory_mut());
    }

    /// Runs the tasks that are due at virtual time `now`: by priority, then the one that waits
    /// longest, then the one declared first; after them the programs without a task. All see the
    /// same time.
    ///
    /// # Errors
    /// The program failed. The PLC has stopped: each further scan gives the same fault until a
    /// start or a restore.
    pub fn scan(&mut self, now: VirtualTime) -> Result<(), PlcFault> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        self.now = now;
        self.scanned_until = self.scanned_until.max(now);
        // Before the trace begins: what forces write is not a statement's.
        self.apply_forces();
        self.machine.begin_trace();
        self.scheduler.begin_scan();
        self.scheduler.look(now, self.machine.memory());
        while let Some(task) = self.scheduler.take_due(now) {
            self.begin_task().map_err(|trapped| self.stop(&trapped))?;
            self.enter(Some(task));
            self.run_task(task)?;
            self.scheduler.look(now, self.machine.memory());
        }
        for at in 0..self.background.len() {
            self.begin_task().map_err(|trapped| self.stop(&trapped))?;
            self.enter(None);
            self.run_entry(self.background[at])?;
        }
        self.machine.end_trace();
        Ok(())
    }

    /// Gives a task its virtual time and its budget.
    fn begin_task(&mut self) -> Result<(), Trapped> {
        let time = self.now.as_nanos().to_le_bytes();
        copy_to(self.machine.memory_mut(), VIRTUAL_TIME_OFFSET as usize, &time);
        self.machine.refuel(self.plan.fuel_per_task)
    }

    /// Gives the programs the task that runs them, if they ask.
    fn enter(&mut self, task: Option<usize>) {
        if let Some(info) = &self.task_info {
            info.enter(task, self.now, self.machine.memory_mut());
            self.apply_forces();
        }
    }

    fn run_task(&mut self, task: usize) -> Result<(), PlcFault> {
        debug_assert!(task < self.tasks.len(), "the scheduler knows the tasks of the plan only");
        // One call for the whole row. With forces or a trace the host has something to do between its parts.
        if self.forces.is_empty() && !self.machine.is_traced() {
            let ended = self.machine.run_row(task);
            return ended.map_err(|trapped| self.stop(&trapped));
        }
        for at in 0..self.tasks.get(task).map_or(0, Vec::len) {
            self.run_entry(self.tasks[task][at])?;
        }
        Ok(())
    }

    /// The program has failed.
    fn stop(&mut self, trapped: &Trapped) -> PlcFault {
        let found = explain(&self.application, trapped, self.now);
        self.fault = Some(found.clone());
        found
    }

    fn run_entry(&mut self, entry: usize) -> Result<(), PlcFault> {
        self.machine.begin_traced_unit();
        for part in 0..self.machine.parts(entry) {
            self.machine.run(entry, part).map_err(|trapped| self.stop(&trapped))?;
            self.apply_forces();
        }
        Ok(())
    }

    /// When a task is due next by its interval; nothing if none has one.
    pub fn next_due(&self) -> Option<VirtualTime> {
        self.scheduler.next_due()
    }

    /// Greatest common divisor of the tasks' intervals: every periodic task is due at a multiple of it. Nothing if no
    /// task is periodic.
    pub fn period(&self) -> Option<TimeSpan> {
        self.scheduler.period()
    }

    /// True if a scan may have something to do at any time: tasks wait for an edge, or programs have
    /// no task.
    pub fn wants_every_step(&self) -> bool {
        self.is_triggered || !self.background.is_empty()
    }

    /// Virtual time of the last scan, or of the start before the first.
    pub fn now(&self) -> VirtualTime {
        self.now
    }

    /// The fault that stopped the PLC.
    pub fn fault(&self) -> Option<&PlcFault> {
        self.fault.as_ref()
    }

    /// Its tasks.
    pub fn plan(&self) -> &TaskPlan {
        &self.plan
    }

    /// What the PLC runs.
    pub fn application(&self) -> &Application {
        &self.application
    }

    /// The variable at a path; see [`Application::variable`].
    ///
    /// # Errors
    /// The path leads nowhere; the error has the nearest name.
    pub fn variable(&self, path: &str) -> Result<Variable, UnknownVariable> {
        self.application.variable(path)
    }

    /// The PLC's memory; variables lie at their offsets.
    pub fn memory(&self) -> &[u8] {
        self.machine.memory()
    }

    /// The PLC's memory, to write inputs. Whatever is written, a scan ends with a result or a
    /// fault; what lies outside of variables is the PLC's own.
    pub fn memory_mut(&mut self) -> &mut [u8] {
        self.machine.memory_mut()
    }

    /// What has been executed since the PLC was made, whatever was started or restored meanwhile;
    /// nothing unless the application was compiled for it. If a state was restored that another PLC had saved
    /// later in its run, the report says that it counts from there on.
    pub fn coverage(&self) -> Option<Coverage> {
        let points = self.application.points();
        let sources = self.application.sources();
        (!points.is_empty() && !self.application.is_traced())
            .then(|| Coverage::new(sources, points, self.machine.notes(), self.skipped_to))
    }

    /// A byte for each place that notes whether it has been executed, 0 if not, in the order of
    /// [`Application::noted_places`]; empty unless the application was compiled for coverage.
    pub fn executed(&self) -> &[u8] {
        if self.application.is_traced() { &[] } else { self.machine.notes() }
    }

    /// Watches places in memory from here on, in place of those watched before. The application must
    /// have been compiled for it ([`Builder::traced`](crate::Builder::traced)).
    pub fn watch(&mut self, places: impl IntoIterator<Item = (Range<usize>, Option<u8>)>) {
        let watched = places.into_iter().map(|(range, bit)| Watched::new(range, bit)).collect();
        self.machine.set_trace(Trace::new(watched));
    }

    /// The statement that wrote the watched place at `index` last in the last scan; nothing if none did.
    pub fn last_writer(&self, index: usize) -> Option<WriteSite> {
        let writer = self.machine.trace()?.watched.get(index)?.writer.as_ref()?;
        let point = self.application.points().get(writer.point as usize)?;
        Some(fault::write_site(&self.application, point.span, writer))
    }

    /// The ways that decisions of the last scan went, in their order; nothing unless places are
    /// watched. What they are is in [`Application::ways`].
    pub fn ways(&self) -> impl Iterator<Item = WayId> {
        self.machine.trace().into_iter().flat_map(|trace| trace.ways.iter().copied().map(WayId))
    }

    /// Keeps a journal of each scan from here on, or no longer. Places must be watched, be it none.
    pub fn keep_journal(&mut self, is_kept: bool) {
        self.machine.keep_journal(is_kept);
    }

    /// What the last scan did; empty unless the journal is kept. It ends early
    /// where a scan does more than [`ACTS_MAX`](crate::run::ACTS_MAX) things. A scan that ended in a fault is in it up to there.
    pub fn journal(&self) -> &[Act] {
        self.machine.trace().and_then(|trace| trace.journal.as_ref()).map_or(&[], Journal::acts)
    }

    /// The complete state as bytes.
    pub fn save(&self) -> Vec<u8> {
        let state = State {
            now: self.now,
            waiting: self.scheduler.waiting().collect(),
            fault: self.fault.clone(),
            forces: self.forces.clone(),
            memory: self.machine.memory(),
        };
        state.encode(self.meaning())
    }

    /// Takes the state of a PLC with the same sources and the same plan; plain, covered and traced builds take
    /// each other's. The PLC goes on from there to the last bit. On an error nothing has changed.
    ///
    /// # Errors
    /// The bytes are not a state of this application under this plan; the error says in what they differ.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), RestoreError> {
        self.restore_with(bytes, CodePolicy::SameCode)
    }

    /// Checks that [`Self::restore`] would take these bytes.
    ///
    /// # Errors
    /// Those of [`Self::restore`].
    pub fn check_state(&self, bytes: &[u8]) -> Result<(), RestoreError> {
        self.decoded(bytes, CodePolicy::SameCode).map(drop)
    }

    /// Like [`Self::restore`], but `policy` says whether the sources must be the same.
    ///
    /// # Errors
    /// The bytes are not a state of a PLC with these variables and this plan, or of one that `policy` refuses.
    pub fn restore_with(&mut self, bytes: &[u8], policy: CodePolicy) -> Result<(), RestoreError> {
        let State { now, waiting, fault, forces, memory } = self.decoded(bytes, policy)?;
        debug_assert_eq!(memory.len(), self.memory().len(), "a state has all of memory");
        copy_to(self.machine.memory_mut(), 0, &memory);
        self.scheduler.set_waiting(&waiting);
        (self.now, self.fault, self.forces) = (now, fault, forces);
        if now > self.scanned_until {
            (self.scanned_until, self.skipped_to) = (now, Some(now));
        }
        Ok(())
    }

    fn decoded(&self, bytes: &[u8], policy: CodePolicy) -> Result<State<Vec<u8>>, RestoreError> {
        let (application, plan, meaning) = (&self.application, &self.plan, self.meaning());
        Decoder { application, plan, meaning, policy }.decode(bytes)
    }

    fn meaning(&self) -> &Meaning {
        self.meaning.get_or_init(|| Meaning::new(&self.application, &self.plan))
    }
}

/// `offset` and the bytes behind it are the PLC's own: memory is as large as the image, which is larger than the
/// cells in front of the variables.
fn copy_to(memory: &mut [u8], offset: usize, bytes: &[u8]) {
    debug_assert!(offset + bytes.len() <= memory.len(), "the PLC's own cells lie within memory");
    memory[offset..offset + bytes.len()].copy_from_slice(bytes);
}
