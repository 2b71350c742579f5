//! What the shim costs in a scan: every bench program as it is, beside the same instrumented and under the
//! scheduler with a grant a scan.
//!
//! `cargo bench -p onescan-tests --bench shim`; names after `--` choose programs.
//!
//! The two take turns in one run, end with the same checksum, and each figure is its fastest round, which other work
//! on the machine disturbs least. In front of each scan two inputs are written from outside: those of a grant, its time
//! and its number, or two as large that nobody reads. The limit is 5 % of a scan, and 1 µs.

mod random;
mod rungs;
mod timers;

use std::time::Instant;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Task, TaskPlan, TimeSpan, VirtualTime};
use onescan_iec_project::instrument::{Options, instrument};
use onescan_iec_run::{Application, SoftPlc};

const INTERVAL_NS: u64 = 10_000_000;
const ROUNDS: usize = 40;
/// Time that one round should take.
const ROUND_NS: f64 = 4e6;
/// The session that an instrumented PLC takes part in, which is the number of its first grant less 1.
const SESSION: u32 = 1;
const SCHEDULER: &str = "SDSP_Scheduler";
/// What is written from outside where there are no grants.
const INPUTS: &str = "VAR_GLOBAL time_input : LINT; number_input : UDINT; END_VAR\n";

fn cases() -> Vec<(&'static str, String)> {
    let [rungs, _] = rungs::programs(1);
    let [timers, _] = timers::programs(2, "");
    let file = |text: &str| text.to_owned();
    vec![
        ("rungs", rungs),
        ("control", file(include_str!("control.st"))),
        ("strings", file(include_str!("strings.st"))),
        ("arrays", file(include_str!("arrays.st"))),
        ("timers", timers),
        ("nest", file(include_str!("nest.st"))),
    ]
}

/// A program in the soft PLC, and how it is given a scan.
struct Bench {
    plc: SoftPlc,
    /// Offset of the checksum.
    sum: usize,
    /// Offsets of what is written from outside: a time, and a number.
    inputs: [usize; 2],
    /// Offset of the number of the last grant done.
    done: Option<usize>,
}

impl Bench {
    fn new(files: Vec<(String, String)>) -> Self {
        let application = Application::from_sources(files).unwrap_or_else(|found| panic!("{found}"));
        let names: Vec<String> = application.programs().map(|program| program.name).collect();
        let main = names.iter().find(|name| *name != SCHEDULER).expect("a case is one program");
        let is_granted = names.len() > 1;
        // As `onescan plc` has it in lockstep: scheduler and programs in one task.
        let scheduler = is_granted.then(|| SCHEDULER.to_owned());
        let programs = scheduler.into_iter().chain([main.clone()]).collect();
        let task =
            Task { name: "main".to_owned(), interval: TimeSpan::from_nanos(INTERVAL_NS), programs, ..Task::default() };
        let plc = SoftPlc::new(&application, &TaskPlan::new(vec![task])).expect("it can run");
        let offset = |path: &str| plc.variable(path).expect("it is there").offset as usize;
        let inputs = if is_granted { ["SDSP_TV", "SDSP_Grant"] } else { ["time_input", "number_input"] };
        let done = is_granted.then(|| offset("SDSP_Done"));
        Self { sum: offset(&format!("{main}.sum")), inputs: inputs.map(offset), done, plc }
    }

    fn scan(&mut self, number: u64) {
        let [time, count] = self.inputs;
        let now = number * INTERVAL_NS;
        let memory = self.plc.memory_mut();
        memory[time..time + 8].copy_from_slice(&now.to_le_bytes());
        memory[count..count + 4].copy_from_slice(&(SESSION + number as u32).to_le_bytes());
        // A cycle has been used to join.
        self.plc.scan(VirtualTime::from_nanos(now + INTERVAL_NS)).expect("it runs");
    }

    /// A cold start; an instrumented PLC joins the session.
    fn start(&mut self) {
        self.plc.cold_start();
        if self.done.is_some() {
            for (path, value) in [("SDSP_Limit", u32::MAX), ("SDSP_Session", SESSION)] {
                let at = self.plc.variable(path).expect("it is there").offset as usize;
                self.plc.memory_mut()[at..at + 4].copy_from_slice(&value.to_le_bytes());
            }
            self.plc.scan(VirtualTime::from_nanos(INTERVAL_NS)).expect("it joins");
        }
    }

    /// Nanoseconds of a scan and the final checksum of so many scans after a cold start.
    fn run(&mut self, scans: u64) -> (f64, u64) {
        self.start();
        let started = Instant::now();
        for number in 1..=scans {
            self.scan(number);
        }
        let time = started.elapsed().as_nanos() as f64 / scans as f64;
        let memory = self.plc.memory();
        if let Some(done) = self.done {
            // The next cycle would report that the last is done.
            assert_eq!(memory[done..done + 4], (SESSION + scans as u32 - 1).to_le_bytes(), "every grant was done");
        }
        (time, u64::from_le_bytes(*memory[self.sum..].first_chunk().expect("a checksum is an ULINT")))
    }
}

fn instrumented(name: &str, text: &str) -> Vec<(String, String)> {
    let input = Input::from_text(name, SourceKind::Text, text);
    let project = instrument(&[input], &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    project.files.into_iter().map(|file| (file.name, file.text.expect("it is not deleted").to_string())).collect()
}

/// Nanoseconds of one scan, original and granted.
fn compare(name: &str, text: &str) -> [f64; 2] {
    let name = format!("{name}.st");
    let text = format!("{INPUTS}{text}");
    let mut original = Bench::new(vec![(name.clone(), text.clone())]);
    let mut granted = Bench::new(instrumented(&name, &text));
    let (trial, _) = original.run(100);
    let scans = (ROUND_NS / trial).clamp(100.0, 100_000.0) as u64;
    let mut times = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        let ((plain, expected), (shimmed, sum)) = (original.run(scans), granted.run(scans));
        assert_eq!(sum, expected, "{name}: both compute the same");
        times = [times[0].min(plain), times[1].min(shimmed)];
    }
    times
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!("{:10} {:>12} {:>12} {:>10} {:>9}", "program", "original ns", "granted ns", "shim ns", "shim");
    for (name, text) in cases() {
        if wanted.is_empty() || wanted.iter().any(|wanted| wanted == name) {
            let [plain, granted] = compare(name, &text);
            let (more, share) = (granted - plain, (granted / plain - 1.0) * 100.0);
            println!("{name:10} {plain:>12.0} {granted:>12.0} {more:>+10.0} {share:>+8.1} %");
        }
    }
}
