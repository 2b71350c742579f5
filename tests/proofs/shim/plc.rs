//! The PLC as a function from memory to memory, each value of which is computed once.

use std::collections::HashMap;
use std::ops::Range;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Task, TaskPlan, TimeSpan, VirtualTime};
use onescan_iec_project::instrument::{Options, instrument};
use onescan_iec_run::{Application, SoftPlc};

use super::gateway::Message;

/// One of the PLC's tasks: the scheduler, then each program.
pub(crate) type TaskIndex = usize;
/// A state of the PLC: its memory, by number.
pub(crate) type MemoryId = usize;

/// What is written before it is read in whatever runs: it shows nothing of what comes.
const DEAD: [&str; 2] = ["Fast.SDSP_Granted", "Slow.SDSP_Granted"];

/// What a project for the model has.
pub(crate) struct Project {
    pub(crate) text: &'static str,
    /// In the order in which they write.
    pub(crate) programs: &'static [&'static str],
    pub(crate) tasks: Vec<Task>,
    /// What stands in its text instead, once it is instrumented.
    pub(crate) changes: &'static [Change],
    /// What stands in the log behind each grant: program and time of every run.
    pub(crate) expected: [i64; 5],
}

/// A text of the instrumented project, and what stands there instead.
pub(crate) type Change = (&'static str, &'static str);

/// What the gateway, and the properties, see of a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct View {
    pub(crate) joined: i64,
    pub(crate) done: i64,
    pub(crate) answer: i64,
    pub(crate) log: i64,
    /// No program has run since the PLC was started.
    pub(crate) is_fresh: bool,
}

/// What changes the PLC's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Event {
    /// A task runs once.
    Cycle(TaskIndex),
    /// A request of the gateway is written.
    Deliver(Message),
}

pub(crate) struct Plc {
    application: Application,
    /// The same program, a task each: the model says which runs.
    tasks: Vec<SoftPlc>,
    dead: Vec<Range<usize>>,
    /// Every memory that was seen, and its number.
    memories: Vec<(Vec<u8>, View)>,
    numbers: HashMap<Vec<u8>, MemoryId>,
    after: HashMap<(MemoryId, Event), MemoryId>,
}

impl Plc {
    /// Number of the memory after a start.
    pub(crate) const STARTED: MemoryId = 0;

    /// The project, instrumented, with `changes` made to it.
    pub(crate) fn new(project: &Project, changes: &[Change]) -> Self {
        let input = Input::from_text("p.st", SourceKind::Text, project.text);
        let options = Options { tasks: Some(project.tasks.clone()), ..Options::default() };
        let instrumented = instrument(&[input], &options).expect("it can be instrumented");
        let files = instrumented.files.into_iter().map(|file| (file.name, file.text.expect("a text").to_string()));
        let mut files: Vec<(String, String)> = files.collect();
        for (from, to) in project.changes.iter().chain(changes) {
            assert!(files.iter().any(|(_, text)| text.contains(from)), "nothing reads `{from}`");
            for (_, text) in &mut files {
                *text = text.replace(from, to);
            }
        }
        let application = Application::from_sources(files).expect("it compiles");
        let tasks = std::iter::once(&"SDSP_Scheduler").chain(project.programs).map(|program| {
            let programs = vec![(*program).to_owned()];
            let only =
                Task { name: "only".to_owned(), interval: Some(TimeSpan::millis::<1>()), programs, ..Task::default() };
            SoftPlc::new(&application, &TaskPlan::new(vec![only])).expect("it runs")
        });
        let tasks = tasks.collect();
        let dead = DEAD.iter().filter_map(|path| application.variable(path).ok());
        let dead = dead.map(|variable| variable.offset as usize..(variable.offset + variable.size) as usize).collect();
        let started = application.initial_memory().to_vec();
        let mut plc =
            Self { application, tasks, dead, memories: Vec::new(), numbers: HashMap::new(), after: HashMap::new() };
        plc.number(started);
        plc
    }

    /// How many tasks there are.
    pub(crate) fn tasks(&self) -> usize {
        self.tasks.len()
    }

    /// How many states of the PLC have been seen.
    pub(crate) fn states(&self) -> usize {
        self.memories.len()
    }

    /// The memory behind `event`.
    pub(crate) fn after(&mut self, memory: MemoryId, event: Event) -> MemoryId {
        if let Some(known) = self.after.get(&(memory, event)) {
            return *known;
        }
        let before = self.memories[memory].0.clone();
        let behind = match event {
            Event::Cycle(task) => self.cycle(task, before),
            Event::Deliver(message) => self.deliver(message, before),
        };
        let number = self.number(behind);
        self.after.insert((memory, event), number);
        number
    }

    pub(crate) fn view(&self, memory: MemoryId) -> View {
        self.memories[memory].1
    }

    fn number(&mut self, memory: Vec<u8>) -> MemoryId {
        let next = self.memories.len();
        let number = *self.numbers.entry(memory.clone()).or_insert(next);
        if number == next {
            let read = |path| self.read(&memory, path);
            let view = View {
                joined: read("SDSP_Joined"),
                done: read("SDSP_Done"),
                answer: read("SDSP_Answer"),
                log: read("log"),
                is_fresh: read("SDSP_Scheduler.Fresh") != 0,
            };
            self.memories.push((memory, view));
        }
        number
    }

    /// Runs a task twice, the second time with other values in what is said to be dead: that it is, is so
    /// proved for every state in which it is used.
    fn cycle(&mut self, task: TaskIndex, memory: Vec<u8>) -> Vec<u8> {
        let mut other = memory.clone();
        self.fill_dead(&mut other, 1);
        let mut behind = [memory, other].map(|memory| self.run(task, memory));
        for memory in &mut behind {
            self.fill_dead(memory, 0);
        }
        let [behind, other] = behind;
        assert!(behind == other, "one of {DEAD:?} is read before it is written");
        behind
    }

    fn run(&mut self, task: TaskIndex, mut memory: Vec<u8>) -> Vec<u8> {
        let plc = &mut self.tasks[task];
        plc.cold_start();
        plc.memory_mut()[..memory.len()].copy_from_slice(&memory);
        plc.scan(VirtualTime::from_nanos(1_000_000)).expect("no fault");
        let size = memory.len();
        memory.copy_from_slice(&plc.memory()[..size]);
        memory
    }

    fn fill_dead(&self, memory: &mut [u8], value: u8) {
        self.dead.iter().for_each(|range| memory[range.clone()].fill(value));
    }

    fn deliver(&self, message: Message, mut memory: Vec<u8>) -> Vec<u8> {
        self.write(&mut memory, "SDSP_Session", i64::from(message.session));
        if message.session != 0 {
            self.write(&mut memory, "SDSP_Limit", i64::from(u32::MAX));
            self.write(&mut memory, "SDSP_TV", i64::from(message.step) * 1_000_000);
            self.write(&mut memory, "SDSP_Grant", i64::from(message.session + message.step));
        }
        memory
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
