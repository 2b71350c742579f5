//! A gateway and a PLC: the gateway grants steps, the PLC goes through its cycles as it likes.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Task, TaskPlan, TimeSpan, VirtualTime};
use onescan_iec_project::instrument::{Options, instrument};
use onescan_iec_run::{Application, SoftPlc};

use crate::rig::{MS, Rig, task};

/// The instrumented text of one file and of the shim.
pub(crate) fn instrumented(text: &str, tasks: &[Task]) -> Vec<(String, String)> {
    let options = Options { tasks: Some(tasks.to_vec()), ..Options::default() };
    let input = Input::from_text("test.st", SourceKind::Text, text);
    let project = instrument(&[input], &options).unwrap_or_else(|error| panic!("{error}"));
    project.files.into_iter().map(|file| (file.name, file.text.expect("a text").to_string())).collect()
}

/// The same, compiled.
pub(crate) fn application(text: &str, tasks: &[Task]) -> Application {
    let files = instrumented(text, tasks);
    Application::from_sources(files.clone()).unwrap_or_else(|found| panic!("{found}\n{files:?}"))
}

/// Where programs run on the PLC.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Tasks {
    /// In the tasks that they came from, at those tasks' own pace; in place of edges at a pace, too.
    Kept,
    /// In one task of lower priority, in their order.
    Moved,
}

/// The PLC's own plan: the scheduler first, in a fast task; the programs behind it.
pub(crate) fn own_plan(tasks: &[Task], form: Tasks) -> TaskPlan {
    let mut plan = vec![task("sdsp", 1, 0, &["SDSP_Scheduler"])];
    match form {
        Tasks::Kept => plan.extend(tasks.iter().map(|each| {
            let interval = each.interval.or(TimeSpan::from_nanos(MS));
            Task { priority: each.priority + 1, single: None, interval, ..each.clone() }
        })),
        Tasks::Moved => {
            let mut order: Vec<&Task> = tasks.iter().collect();
            order.sort_by_key(|each| each.priority);
            let programs: Vec<&str> = order.iter().flat_map(|each| each.programs.iter().map(String::as_str)).collect();
            plan.push(task("programs", 2, 1, &programs));
        }
    }
    TaskPlan::new(plan)
}

/// What the scheduler answers.
pub(crate) mod answer {
    pub(crate) const READY: i64 = 0;
    pub(crate) const RUNNING: i64 = 1;
    pub(crate) const OLD: i64 = 2;
    pub(crate) const MISSING: i64 = 3;
    pub(crate) const HELD: i64 = 4;
    pub(crate) const TIME: i64 = 5;
    pub(crate) const NOT_FRESH: i64 = 6;
    pub(crate) const NOT_SIMULATED: i64 = 7;
}

/// The instrumented PLC and what the gateway knows.
pub(crate) struct Driver {
    pub(crate) rig: Rig,
    /// What stands before the names of the shim's variables.
    prefix: &'static str,
    pub(crate) session: i64,
    pub(crate) grant: i64,
}

impl Driver {
    /// A PLC that has joined session 1000.
    pub(crate) fn joined(application: &Application, plan: &TaskPlan) -> Self {
        Self::joined_in("", application, plan)
    }

    /// The same where the shim's variables are parts of another.
    pub(crate) fn joined_in(prefix: &'static str, application: &Application, plan: &TaskPlan) -> Self {
        let mut driver = Self { prefix, ..Self::started(application, plan) };
        driver.join(1000);
        driver
    }

    fn set(&mut self, word: &str, value: i64) {
        self.rig.set(&format!("{}SDSP_{word}", self.prefix), value);
    }

    fn word(&self, word: &str) -> i64 {
        self.rig.int(&format!("{}SDSP_{word}", self.prefix))
    }

    /// A PLC that has been started, and goes through its cycles.
    pub(crate) fn started(application: &Application, plan: &TaskPlan) -> Self {
        let plc = SoftPlc::new(application, plan).expect("the plan suits");
        Self { rig: Rig { plc, step_ns: MS, now_ns: 0 }, prefix: "", session: 0, grant: 0 }
    }

    pub(crate) fn join(&mut self, session: i64) {
        self.set("Limit", i64::from(u32::MAX));
        self.set("TV", 0);
        self.set("Grant", session);
        self.set("Session", session);
        (self.session, self.grant) = (session, 0);
        let mut cycles = 0;
        while self.word("Joined") != session {
            cycles += 1;
            assert!(cycles < 100, "the PLC does not join and answers {}", self.answer());
            self.cycles(1);
        }
    }

    /// Cycles of the PLC, a millisecond each by its own clock.
    pub(crate) fn cycles(&mut self, count: u32) {
        for _ in 0..count {
            self.rig.scan().expect("no fault");
        }
    }

    /// Writes a grant; its number counts from the session's.
    pub(crate) fn write_grant(&mut self, number: i64, t_v: u64) {
        self.set("TV", t_v as i64);
        self.set("Grant", self.session + number);
    }

    /// The last grant that is done, from the session's number.
    pub(crate) fn done(&self) -> i64 {
        self.word("Done") - self.session
    }

    pub(crate) fn answer(&self) -> i64 {
        self.word("Answer")
    }

    /// Grants the next step and waits until it is done; how many cycles that took.
    pub(crate) fn step(&mut self, t_v: u64) -> u32 {
        self.grant += 1;
        self.write_grant(self.grant, t_v);
        (1..1000)
            .find(|_| {
                self.cycles(1);
                self.done() == self.grant
            })
            .expect("the grant is done some time")
    }

    /// Restarts, as after power on.
    pub(crate) fn restart(&mut self) {
        self.rig.plc.cold_start();
        self.rig.now_ns = 0;
    }
}

/// The original on its own tasks, scanned at virtual times.
pub(crate) fn original(text: &str, tasks: &[Task]) -> SoftPlc {
    let application = crate::rig::application(text);
    SoftPlc::new(&application, &TaskPlan::new(tasks.to_vec())).expect("the plan suits")
}

/// All variables of all programs that are not instances, with their bytes.
pub(crate) fn state(plc: &SoftPlc) -> Vec<(String, Vec<u8>)> {
    let programs = plc.application().programs().filter(|program| !program.name.starts_with("SDSP_"));
    let variables = programs.flat_map(|program| [program.inputs, program.outputs, program.locals].concat());
    // What the PLC notes of its own scans, idle ones too: the first of a chart, a transition that was cleared.
    let idle = |path: &str| {
        let last = path.rsplit('.').next();
        path.contains("SDSP_") || matches!(last, Some("SFC_Begun" | "both"))
    };
    let own = variables.filter(|variable| variable.ty.is_some() && !idle(&variable.path));
    let mut state: Vec<_> = own
        .map(|variable| {
            let range = variable.offset as usize..(variable.offset + variable.size) as usize;
            (variable.path, plc.memory()[range].to_vec())
        })
        .collect();
    // A port has its programs in the order of its tasks.
    state.sort();
    state
}

/// Writes inputs by path.
pub(crate) fn write(plc: &mut SoftPlc, path: &str, value: i64) {
    let variable = plc.variable(path).expect("the variable exists");
    let (offset, size) = (variable.offset as usize, variable.size as usize);
    plc.memory_mut()[offset..offset + size].copy_from_slice(&value.to_le_bytes()[..size]);
}

/// Scans at a time.
pub(crate) fn scan(plc: &mut SoftPlc, at_ns: u64) {
    plc.scan(VirtualTime::from_nanos(at_ns)).expect("no fault");
}
