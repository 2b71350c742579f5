//! The shim's protocol between gateway and PLC (seed: Carlsson et al. 2012, sec. V): the scheduler POU and the
//! execution controllers as they are emitted, run by the soft PLC, in every order of cycles and messages.
//!
//! Messages of the gateway stay in flight for ever: each may arrive late, twice, never, in any order. The
//! PLC's tasks run in any order. The PLC is started anew at any point. The state of the PLC is its memory.
//!
//! Two programs write down what they run for: `Fast` in every step, `Slow`, of higher priority, in every
//! second. What stands there must be a beginning of what they would write without any of this.

use std::cell::RefCell;
use std::collections::BTreeSet;

use onescan_plc_shim::input::kind::SourceKind;
use onescan_plc_shim::instrument::{Options, instrument};
use onescan_plc_shim::{Application, Input, SoftPlc, Task, TaskPlan, VirtualTime};
use stateright::{Checker, Model, Property};

use crate::stamped::report;

const TEXT: &str = "
VAR_GLOBAL log : LINT; END_VAR
PROGRAM Fast log := log * 100 + 10 + TIME_TO_LINT(SDSP_Now); END_PROGRAM
PROGRAM Slow log := log * 100 + 20 + TIME_TO_LINT(SDSP_Now); END_PROGRAM";

/// What is written after each grant: program and time of every run.
const EXPECTED: [i64; 4] = [0, 11, 11_22_12, 11_22_12_13];
/// A start of the PLC is answered with a session of a new number.
const SESSIONS: [u32; 2] = [100, 200];

/// One of the PLC's tasks: the scheduler, `Fast`, `Slow`.
type TaskIndex = usize;

struct Plc {
    application: Application,
    /// The same program, a task each: the model says which runs.
    tasks: Vec<SoftPlc>,
}

impl Plc {
    fn new() -> Self {
        let task = |name: &str, ms: u64, priority: u32, program: &str| Task {
            name: name.to_owned(),
            interval_ns: ms * 1_000_000,
            priority,
            programs: vec![program.to_owned()],
            ..Task::default()
        };
        let tasks = vec![task("fast", 1, 2, "Fast"), task("slow", 2, 1, "Slow")];
        let input = Input::from_text("p.st", SourceKind::Text, TEXT);
        let options = Options { tasks: Some(tasks), ..Options::default() };
        let project = instrument(&[input], &options).expect("it can be instrumented");
        let files = project.files.into_iter().map(|file| (file.name, file.text.expect("a text")));
        let application = Application::from_sources(files).expect("it compiles");
        let tasks = ["SDSP_Scheduler", "Fast", "Slow"].map(|program| {
            let plan = TaskPlan::new(vec![task("only", 1, 0, program)]);
            SoftPlc::new(&application, &plan).expect("it runs")
        });
        Self { tasks: tasks.into(), application }
    }

    fn cycle(&mut self, task: TaskIndex, memory: &mut [u8]) {
        let plc = &mut self.tasks[task];
        plc.cold_start();
        plc.memory_mut()[..memory.len()].copy_from_slice(memory);
        plc.scan(VirtualTime::from_ns(1_000_000)).expect("no fault");
        let size = memory.len();
        memory.copy_from_slice(&plc.memory()[..size]);
    }

    fn read(&self, memory: &[u8], path: &str) -> i64 {
        let variable = self.application.variable(path).expect("it exists");
        let mut bytes = [0; 8];
        let size = variable.size as usize;
        bytes[..size].copy_from_slice(&memory[variable.offset as usize..][..size]);
        i64::from_le_bytes(bytes)
    }

    fn write(&self, memory: &mut [u8], path: &str, value: i64) {
        let variable = self.application.variable(path).expect("it exists");
        let size = variable.size as usize;
        memory[variable.offset as usize..][..size].copy_from_slice(&value.to_le_bytes()[..size]);
    }
}

thread_local! {
    static PLC: RefCell<Plc> = RefCell::new(Plc::new());
}

/// One request of the gateway. In a session's first, the grant is its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Message {
    session: u32,
    grant: u32,
}

/// What the gateway has read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Reading {
    joined: i64,
    done: i64,
    log: i64,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct ShimState {
    memory: Vec<u8>,
    in_flight: BTreeSet<Message>,
    /// A reading on its way back, as old as it may be.
    reading: Option<Reading>,
    session: usize,
    /// The grant that the gateway waits for; 0 while it waits for the PLC to join.
    waiting: u32,
    starts: u32,
    broken: Option<&'static str>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum ShimAct {
    Cycle(TaskIndex),
    Deliver(Message),
    Lose(Message),
    Read,
    Receive,
    Start,
}

struct Shim {
    /// How often the PLC may be started anew.
    starts: u32,
    /// How many grants a session has.
    grants: u32,
}

impl ShimState {
    fn message(&self) -> Message {
        let session = SESSIONS[self.session];
        Message { session, grant: session + self.waiting }
    }

    /// The gateway looks at what it has read.
    fn receive(&mut self, Reading { joined, done, log }: Reading, grants: u32) {
        let session = i64::from(SESSIONS[self.session]);
        let waiting = i64::from(self.waiting);
        if joined == session && done == session + waiting {
            if log != EXPECTED[self.waiting as usize] {
                self.broken = Some("outputs are taken for those of a grant that was not run");
            }
            self.waiting = (self.waiting + 1).min(grants);
        } else if self.waiting > 0 && !(joined == session && done == session + waiting - 1) {
            // The PLC was started anew; the session is over, the next begins.
            self.session = (self.session + 1).min(SESSIONS.len() - 1);
            self.waiting = 0;
        }
        self.in_flight.insert(self.message());
    }

    fn look_at(&mut self, plc: &Plc) {
        let [log, done, joined] = ["log", "SDSP_Done", "SDSP_Joined"].map(|path| plc.read(&self.memory, path));
        let grant = done - joined;
        let right = match (joined, usize::try_from(grant)) {
            (0, _) => log == 0,
            (_, Ok(grant)) if grant < EXPECTED.len() => {
                let end = EXPECTED[(grant + 1).min(EXPECTED.len() - 1)];
                beginnings(end).any(|beginning| beginning == log) && log >= EXPECTED[grant]
            }
            _ => false,
        };
        if !right {
            self.broken = Some("a program ran twice, not at all, or out of order for a grant");
        }
    }
}

/// What may stand there while `log` is being written.
fn beginnings(log: i64) -> impl Iterator<Item = i64> {
    std::iter::successors(Some(log), |rest| (*rest > 0).then_some(rest / 100))
}

impl Model for Shim {
    type State = ShimState;
    type Action = ShimAct;

    fn init_states(&self) -> Vec<ShimState> {
        let memory = PLC.with_borrow(|plc| plc.application.initial_memory().to_vec());
        let mut state = ShimState {
            memory,
            in_flight: BTreeSet::new(),
            reading: None,
            session: 0,
            waiting: 0,
            starts: 0,
            broken: None,
        };
        state.in_flight.insert(state.message());
        vec![state]
    }

    fn actions(&self, state: &ShimState, actions: &mut Vec<ShimAct>) {
        if state.broken.is_some() {
            return;
        }
        actions.extend((0..3).map(ShimAct::Cycle));
        actions.extend(state.in_flight.iter().copied().map(ShimAct::Deliver));
        actions.extend(state.in_flight.iter().copied().map(ShimAct::Lose));
        actions.push(if state.reading.is_some() { ShimAct::Receive } else { ShimAct::Read });
        if state.starts < self.starts {
            actions.push(ShimAct::Start);
        }
    }

    fn next_state(&self, last: &ShimState, action: ShimAct) -> Option<ShimState> {
        let mut state = last.clone();
        PLC.with_borrow_mut(|plc| {
            match action {
                ShimAct::Cycle(task) => plc.cycle(task, &mut state.memory),
                ShimAct::Deliver(Message { session, grant }) => {
                    let step = i64::from(grant - session);
                    plc.write(&mut state.memory, "SDSP_Session", i64::from(session));
                    plc.write(&mut state.memory, "SDSP_Limit", i64::from(u32::MAX));
                    plc.write(&mut state.memory, "SDSP_TV", step * 1_000_000);
                    plc.write(&mut state.memory, "SDSP_Grant", i64::from(grant));
                }
                ShimAct::Lose(message) => {
                    state.in_flight.remove(&message);
                }
                ShimAct::Read => {
                    let read = |path| plc.read(&state.memory, path);
                    let reading = Reading { joined: read("SDSP_Joined"), done: read("SDSP_Done"), log: read("log") };
                    state.reading = Some(reading);
                }
                ShimAct::Receive => {
                    let reading = state.reading.take()?;
                    state.receive(reading, self.grants);
                }
                ShimAct::Start => {
                    state.memory.copy_from_slice(plc.application.initial_memory());
                    state.starts += 1;
                }
            }
            state.look_at(plc);
            Some(state)
        })
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("nothing is broken", |_, state: &ShimState| state.broken.is_none()),
            Property::sometimes("all grants are run", |model: &Self, state: &ShimState| {
                let log = || PLC.with_borrow(|plc| plc.read(&state.memory, "log"));
                state.waiting == model.grants && log() == EXPECTED[model.grants as usize]
            }),
            Property::sometimes("every start of the PLC is seen", |model: &Self, state: &ShimState| {
                state.session == model.starts as usize
            }),
            Property::sometimes("the last session is run to its end", |model: &Self, state: &ShimState| {
                let done = || PLC.with_borrow(|plc| plc.read(&state.memory, "SDSP_Done"));
                let last = SESSIONS[model.starts as usize] + model.grants;
                state.session == model.starts as usize && done() == i64::from(last)
            }),
        ]
    }
}

#[test]
fn no_program_runs_twice_or_not_at_all_for_a_grant() {
    // Each start makes the states many times more: about a hundred times.
    for (starts, grants) in [(0, 3), (1, 3)] {
        let checker = Shim { starts, grants }.checker().threads(2).spawn_bfs().join();
        checker.assert_properties();
        report(format_args!(
            "shim, the PLC started anew up to {starts} times: {} states",
            checker.unique_state_count()
        ));
    }
}

/// The check can fail: without the numbers of the grants it would.
#[test]
fn a_program_that_runs_once_more_would_be_found() {
    let model = Shim { starts: 0, grants: 3 };
    let mut state = model.init_states().remove(0);
    PLC.with_borrow_mut(|plc| {
        plc.write(&mut state.memory, "SDSP_Turn", 1);
        plc.cycle(2, &mut state.memory);
        state.look_at(plc);
    });
    assert!(state.broken.is_some());
}
