//! The shim's protocol between gateway and PLC (`[SDSP]` sec. V): the scheduler POU and the
//! execution controllers as they are emitted, run by the soft PLC, in every order of cycles and messages.
//!
//! Every message of the gateway may arrive late, twice, never, in any order. The PLC's tasks run in any
//! order. The PLC is restarted at any point, however often. The gateway gives up a session at any point
//! and begins the next. The state of the PLC is its memory.
//!
//! Two programs write down what they run for: `Fast` in every step, `Slow`, of higher priority, in every
//! second. What stands there must be a beginning of what they would write without any of this; and as long
//! as nobody starts the PLC or leaves the session, the rest can still come to stand there.
//!
//! | module | subject |
//! |---|---|
//! | [`plc`] | the PLC as a function from memory to memory |
//! | [`gateway`] | what the gateway sends, and what it makes of what it reads |
//! | [`undisturbed`] | what comes when nobody disturbs |
//! | [`mutants`] | shims and gateways that are wrong, which the model must find |
//!
//! # What makes it small
//!
//! All of it is exact, or allows more than can be:
//!
//! - A message stays in flight for ever. To lose it is never to deliver it, so there is no losing; what is in
//!   flight follows from how far the gateway is.
//! - Of a session that is over, messages are in flight that were never sent: more than can be, in place of
//!   how far each session had come.
//! - A reading is judged when it is taken. The gateway does nothing else while one is on its way, and what the
//!   PLC does meanwhile it may as well do after, when no fewer messages are in flight: the same states are
//!   reached. A reading that shows nothing is none.
//! - How often the PLC was started is not counted, so starts are not limited; sessions are.
//! - What every cycle writes before it reads it is not part of the PLC's state; each cycle is run a second time
//!   with other values there, to prove that.
//! - What a cycle makes of a memory is computed once, and a memory is known by its number.

mod gateway;
mod mutants;
mod plc;
mod undisturbed;

use std::sync::Mutex;

use onescan_iec::{Task, TimeSpan};
use stateright::{Checker, Model, Property};

use self::gateway::{Gateway, Message, Progress, Verdict};
use self::plc::{Change, Event, MemoryId, Plc, Project, TaskIndex, View};
use crate::stamped::report;

const TEXT: &str = "
VAR_GLOBAL log : LINT; END_VAR
PROGRAM Fast log := log * 100 + 10 + TIME_TO_LINT(SDSP_Now); END_PROGRAM
PROGRAM Slow log := log * 100 + 20 + TIME_TO_LINT(SDSP_Now); END_PROGRAM";

/// What is written after each grant: program and time of every run.
const EXPECTED: [i64; 5] = [0, 11, 11_22_12, 11_22_12_13, 11_22_12_13_24_14];
/// A start of the PLC is answered with a session of a new number, greater than that of any grant before.
const SESSIONS: [u32; 4] = [100, 200, 300, 400];

fn task(name: &str, ms: u64, priority: u32, program: &str) -> Task {
    let programs = vec![program.to_owned()];
    Task { name: name.to_owned(), interval: TimeSpan::from_millis(ms), priority, programs, ..Task::default() }
}

fn project() -> Project {
    let tasks = vec![task("fast", 1, 2, "Fast"), task("slow", 2, 1, "Slow")];
    Project { text: TEXT, programs: &["Fast", "Slow"], tasks, changes: &[], expected: EXPECTED }
}

/// The same where `Fast` is interrupted, whenever it ends: it has counted the grant as done, and everything else may
/// happen before it hands on, which `Rest` stands for.
fn project_interrupted() -> Project {
    let text = "
VAR_GLOBAL log : LINT; interrupted : BOOL; END_VAR
PROGRAM Fast log := log * 100 + 10 + TIME_TO_LINT(SDSP_Now); END_PROGRAM
PROGRAM Slow log := log * 100 + 20 + TIME_TO_LINT(SDSP_Now); END_PROGRAM
PROGRAM Rest IF interrupted THEN interrupted := FALSE; SDSP_Turn := SDSP_Next[1 + 1]; END_IF; END_PROGRAM";
    let changes = &[
        ("SDSP_Turn := SDSP_Next[2];", "interrupted := TRUE;"),
        ("SDSP_Simulated AND SDSP_Turn = 2", "SDSP_Simulated AND SDSP_Turn = 2 AND NOT interrupted"),
    ];
    Project { text, programs: &["Fast", "Slow", "Rest"], changes, ..project() }
}

/// The same where an edge that `Fast` makes in every second step starts `Slow` behind it (2nd ed. 2.7.2).
fn project_with_single() -> Project {
    let text = "
VAR_GLOBAL log : LINT; flag : BOOL; END_VAR
PROGRAM Fast log := log * 100 + 10 + TIME_TO_LINT(SDSP_Now); flag := NOT flag; END_PROGRAM
PROGRAM Slow log := log * 100 + 20 + TIME_TO_LINT(SDSP_Now); END_PROGRAM";
    let slow = Task { single: Some("flag".to_owned()), ..task("slow", 0, 1, "Slow") };
    let expected = [0, 11_21, 11_21_12, 11_21_12_13_23, 11_21_12_13_23_14];
    Project { text, tasks: vec![task("fast", 1, 2, "Fast"), slow], expected, ..project() }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ShimState {
    memory: MemoryId,
    gateway: Progress,
    broken: Option<&'static str>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum ShimAct {
    Cycle(TaskIndex),
    Deliver(Message),
    /// The gateway reads, and learns something.
    Read(View, Verdict),
    /// The gateway gives its session up.
    Leave,
    /// The PLC is restarted.
    Start,
}

pub(crate) struct Shim {
    plc: Mutex<Plc>,
    gateway: Gateway,
    /// What stands in the log behind each grant.
    expected: [i64; 5],
}

impl Shim {
    fn new(gateway: Gateway, changes: &[Change]) -> Self {
        Self::of(&project(), gateway, changes)
    }

    fn of(project: &Project, gateway: Gateway, changes: &[Change]) -> Self {
        Self { plc: Mutex::new(Plc::new(project, changes)), gateway, expected: project.expected }
    }

    fn view(&self, state: &ShimState) -> View {
        self.plc.lock().expect("no panic").view(state.memory)
    }

    /// Number of the session that the gateway is in; 0 if it is silent.
    fn session(&self, state: &ShimState) -> i64 {
        self.gateway.sessions.get(state.gateway.session).map_or(0, |session| i64::from(*session))
    }

    /// What is wrong with a memory behind another.
    fn fault(&self, before: View, after: View) -> Option<&'static str> {
        if after.joined == 0 {
            let is_still = before.joined != 0 || before.log == after.log;
            return (!is_still).then_some("a program ran outside of a session");
        }
        let grant =
            usize::try_from(after.done - after.joined).ok().filter(|grant| *grant <= self.gateway.grants as usize);
        let is_right = grant.is_some_and(|grant| {
            let end = self.expected[(grant + 1).min(self.gateway.grants as usize)];
            after.log >= self.expected[grant] && beginnings(end).any(|beginning| beginning == after.log)
        });
        (!is_right).then_some("a program ran twice, not at all, or out of order for a grant")
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
        vec![ShimState { memory: Plc::STARTED, gateway: Progress { session: 0, waiting: 0 }, broken: None }]
    }

    fn actions(&self, state: &ShimState, actions: &mut Vec<ShimAct>) {
        if state.broken.is_some() {
            return;
        }
        let plc = self.plc.lock().expect("no panic");
        actions.extend((0..plc.tasks()).map(ShimAct::Cycle));
        actions.extend(self.gateway.in_flight(state.gateway).map(ShimAct::Deliver));
        let seen = plc.view(state.memory);
        actions.extend(self.gateway.judge(state.gateway, seen).map(|verdict| ShimAct::Read(seen, verdict)));
        actions.extend([ShimAct::Leave, ShimAct::Start]);
    }

    fn next_state(&self, last: &ShimState, action: ShimAct) -> Option<ShimState> {
        let mut state = last.clone();
        let event = match action {
            ShimAct::Cycle(task) => Event::Cycle(task),
            ShimAct::Deliver(message) => Event::Deliver(message),
            ShimAct::Read(seen, verdict) => {
                let is_right = seen.log == self.expected[last.gateway.waiting as usize];
                if verdict == Verdict::Done && !is_right {
                    state.broken = Some("outputs are taken for those of a grant that was not run");
                }
                state.gateway = last.gateway.after(verdict);
                return Some(state);
            }
            ShimAct::Leave => {
                state.gateway = self.gateway.leave(last.gateway)?;
                return Some(state);
            }
            ShimAct::Start => {
                state.memory = Plc::STARTED;
                return Some(state);
            }
        };
        let mut plc = self.plc.lock().expect("no panic");
        state.memory = plc.after(last.memory, event);
        state.broken = self.fault(plc.view(last.memory), plc.view(state.memory));
        Some(state)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("nothing is broken", |_, state: &ShimState| state.broken.is_none()),
            Property::sometimes("the last session is run to its end", |model: &Self, state: &ShimState| {
                state.gateway.session == model.gateway.sessions.len() - 1
                    && state.gateway.waiting > model.gateway.grants
            }),
            Property::sometimes("a session that is over is begun once more", |model: &Self, state: &ShimState| {
                let view = model.view(state);
                let session = i64::from(model.gateway.sessions[0]);
                state.gateway.session == model.gateway.sessions.len()
                    && (view.joined, view.done) == (session, session + 1)
            }),
            Property::sometimes("the PLC leaves a session that is under way", |model: &Self, state: &ShimState| {
                let view = model.view(state);
                view.joined == 0 && view.log != 0 && state.gateway.waiting == 2
            }),
        ]
    }
}

#[test]
fn no_program_runs_twice_or_not_at_all_for_a_grant() {
    check("shim", &project(), &[(2, 3), (3, 3), (4, 4)]);
}

#[test]
fn no_edge_starts_a_program_twice_or_not_at_all_for_a_grant() {
    check("shim with SINGLE", &project_with_single(), &[(3, 4)]);
}

#[test]
fn a_program_that_is_interrupted_as_it_ends_runs_neither_twice_nor_not_at_all() {
    check("shim, a program interrupted as it ends", &project_interrupted(), &[(2, 3)]);
}

/// Passes of the PLC through its tasks, in this order, that each of four grants takes.
fn passes(project: &Project, order: &[TaskIndex]) -> [usize; 4] {
    let mut plc = Plc::new(project, &[]);
    let session = SESSIONS[0];
    let mut memory = plc.after(Plc::STARTED, Event::Deliver(Message { session, step: 0 }));
    let pass = |plc: &mut Plc, memory| order.iter().fold(memory, |memory, task| plc.after(memory, Event::Cycle(*task)));
    memory = pass(&mut plc, memory);
    [1, 2, 3, 4].map(|step| {
        memory = plc.after(memory, Event::Deliver(Message { session, step }));
        let taken = (1..10).find(|_| {
            memory = pass(&mut plc, memory);
            plc.view(memory).done == i64::from(session + step)
        });
        taken.expect("it is done")
    })
}

/// The scheduler is task 0, `Fast` 1 and `Slow` 2, which comes before `Fast` when both are due.
#[test]
fn a_grant_takes_one_cycle_of_the_plc() {
    assert_eq!(passes(&project(), &[0, 2, 1]), [1; 4]);
    // A scheduler that runs last sees a grant a cycle later; against the order of the line, each program has its own.
    assert_eq!(passes(&project(), &[2, 1, 0]), [2; 4]);
    assert_eq!(passes(&project(), &[0, 1, 2]), [1, 2, 1, 2]);
    // The scheduler looks for edges behind each task.
    assert_eq!(passes(&project_with_single(), &[0, 1, 2]), [3, 2, 3, 2]);
}

fn check(name: &str, project: &Project, sizes: &[(usize, u32)]) {
    for &(sessions, grants) in sizes {
        let model = Shim::of(project, Gateway::new(&SESSIONS[..sessions], grants), &[]);
        let checker = model.checker().threads(2).spawn_bfs().join();
        checker.assert_properties();
        report(format_args!(
            "{name}, {sessions} sessions of {grants} grants, the PLC restarted any number of times: {} states, {} of \
             the PLC",
            checker.unique_state_count(),
            checker.model().plc.lock().expect("no panic").states()
        ));
    }
}
