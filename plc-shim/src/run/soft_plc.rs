//! The PLC itself.

use super::VirtualTime;
use super::fault::{PlcFault, explain};
use super::machine::Machine;
use super::plan::{RunError, TaskPlan, resolve};
use super::scheduler::Scheduler;
use super::state::{self, RestoreError, State};
use crate::application::{Application, UnknownVariable, Variable};
use crate::check::VIRTUAL_TIME_OFFSET;

/// Runs an application's programs by a task plan, one scan at a time.
pub struct SoftPlc {
    application: Application,
    machine: Machine,
    scheduler: Scheduler,
    /// The programs of each task.
    programs: Vec<Vec<usize>>,
    fuel_per_task: u64,
    fingerprint: u64,
    /// Virtual time of the last scan.
    now: VirtualTime,
    fault: Option<PlcFault>,
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
        let programs = resolve(plan, application)?;
        let machine = Machine::new(application)?;
        let mut plc = Self {
            application: application.clone(),
            machine,
            scheduler: Scheduler::new(plan),
            programs,
            fuel_per_task: plan.fuel_per_task,
            fingerprint: state::fingerprint(application, plan),
            now: VirtualTime::default(),
            fault: None,
        };
        plc.cold_start();
        Ok(plc)
    }

    /// Gives all variables their initial values and begins again at virtual time 0
    /// (2nd ed. 2.4.2).
    pub fn cold_start(&mut self) {
        let image = self.application.initial_memory();
        copy_to(self.machine.memory_mut(), 0, image);
        self.scheduler.reset();
        self.now = VirtualTime::default();
        self.fault = None;
    }

    /// Gives all variables but the retained ones their initial values (2nd ed. 2.4.2). Virtual
    /// time goes on; every task is due one interval from now.
    pub fn warm_start(&mut self) {
        let image = self.application.initial_memory();
        let memory = self.machine.memory_mut();
        let mut from = 0;
        for range in self.application.retained() {
            copy_range(memory, image, from, range.start as usize);
            from = range.end as usize;
        }
        copy_range(memory, image, from, image.len());
        self.scheduler.restart_at(self.now);
        self.fault = None;
    }

    /// Runs the tasks that are due at virtual time `now`: by priority, then the one that waits
    /// longest, then the one declared first. Every task sees the same time throughout.
    ///
    /// # Errors
    /// The program failed. The PLC has stopped: each further scan gives the same fault until a
    /// start or a restore.
    pub fn scan(&mut self, now: VirtualTime) -> Result<(), PlcFault> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        self.now = now;
        while let Some(task) = self.scheduler.take_due(now) {
            self.run_task(task)?;
        }
        Ok(())
    }

    fn run_task(&mut self, task: usize) -> Result<(), PlcFault> {
        let now = self.now;
        let time = now.as_ns().to_le_bytes();
        copy_to(self.machine.memory_mut(), VIRTUAL_TIME_OFFSET as usize, &time);
        self.machine.refuel(self.fuel_per_task);
        let Self { machine, programs, application, fault, .. } = self;
        for program in programs.get(task).map_or(&[][..], Vec::as_slice) {
            if let Err(trapped) = machine.run(*program) {
                let found = explain(application, &trapped, now);
                *fault = Some(found.clone());
                return Err(found);
            }
        }
        Ok(())
    }

    /// When a task is due next.
    pub fn next_due(&self) -> VirtualTime {
        self.scheduler.next_due()
    }

    /// Greatest common divisor of the tasks' intervals in nanoseconds: every task is due at a
    /// multiple of it.
    pub fn period_ns(&self) -> u64 {
        self.scheduler.period_ns()
    }

    /// The fault that stopped the PLC.
    pub fn fault(&self) -> Option<&PlcFault> {
        self.fault.as_ref()
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

    /// The complete state as bytes.
    pub fn save(&self) -> Vec<u8> {
        let state = State {
            now: self.now,
            due_ns: self.scheduler.due_times().collect(),
            fault: self.fault.clone(),
            memory: self.machine.memory(),
        };
        state.encode(self.fingerprint)
    }

    /// Takes a state back; the PLC goes on from there to the last bit. On an error nothing has
    /// changed.
    ///
    /// # Errors
    /// The bytes are not a state of this application under this plan.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), RestoreError> {
        let (tasks, size) = (self.programs.len(), self.machine.memory().len());
        let state = State::decode(bytes, self.fingerprint, tasks, size)?;
        copy_to(self.machine.memory_mut(), 0, state.memory);
        self.scheduler.set_due_times(&state.due_ns);
        self.now = state.now;
        self.fault = state.fault;
        Ok(())
    }
}

fn copy_to(memory: &mut [u8], offset: usize, bytes: &[u8]) {
    if let Some(target) = memory.get_mut(offset..offset + bytes.len()) {
        target.copy_from_slice(bytes);
    }
}

fn copy_range(memory: &mut [u8], image: &[u8], from: usize, to: usize) {
    if let Some(source) = image.get(from..to) {
        copy_to(memory, from, source);
    }
}
