//! The suite in lockstep: each case as it is, instrumented and not simulated, and instrumented under the scheduler with
//! one grant per scan, side by side. All three hold the same after every scan, bit for bit. Once as text, once as
//! PLCopen XML for CODESYS, in whose dialect the cases are then read, and once written in SCL for TIA Portal.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, Task, TaskPlan, TimeSpan, VirtualTime};
use onescan_iec_project::instrument::{Options, Project, Target, instrument};
use onescan_iec_run::{Application, FaultKind, SoftPlc};

use super::case::Case;
use super::trace;

const MS: u64 = 1_000_000;
const SCHEDULER: &str = "SDSP_Scheduler";

/// A PLC that is given grants while it goes through cycles of its own, a millisecond each.
struct Granted {
    plc: SoftPlc,
    /// What stands before the names of the shim's variables.
    block: &'static str,
    /// The PLC's own clock.
    own_ns: u64,
    session: u32,
    grant: u32,
}

impl Granted {
    fn write(&mut self, word: &str, bytes: &[u8]) {
        let path = format!("{}{word}", self.block);
        let offset = self.plc.variable(&path).expect("the shim is there").offset as usize;
        self.plc.memory_mut()[offset..offset + bytes.len()].copy_from_slice(bytes);
    }

    fn number(&self, word: &str) -> u32 {
        let path = format!("{}{word}", self.block);
        let offset = self.plc.variable(&path).expect("the shim is there").offset as usize;
        u32::from_le_bytes(*self.plc.memory()[offset..].first_chunk().expect("four bytes"))
    }

    /// Cycles until the shim's variable has this value.
    fn cycle_until(&mut self, path: &str, value: u32) -> Result<(), Stop> {
        for _ in 0..1000 {
            self.own_ns += MS;
            self.plc.scan(VirtualTime::from_nanos(self.own_ns)).map_err(|fault| Stop::Fault(fault.kind))?;
            if self.number(path) == value {
                return Ok(());
            }
        }
        Err(Stop::Silent)
    }

    /// Joins a session of a number not used before.
    fn join(&mut self, now_ns: u64) -> Result<(), Stop> {
        self.session = self.grant + 100;
        self.grant = self.session;
        self.write("SDSP_Limit", &u32::MAX.to_le_bytes());
        self.write("SDSP_TV", &now_ns.to_le_bytes());
        self.write("SDSP_Grant", &self.session.to_le_bytes());
        self.write("SDSP_Session", &self.session.to_le_bytes());
        self.cycle_until("SDSP_Joined", self.session)
    }

    fn step(&mut self, now_ns: u64) -> Result<(), Stop> {
        self.grant += 1;
        self.write("SDSP_TV", &now_ns.to_le_bytes());
        self.write("SDSP_Grant", &self.grant.to_le_bytes());
        self.cycle_until("SDSP_Done", self.grant)
    }
}

/// Why a scan is not done.
#[derive(Debug, PartialEq, Eq)]
enum Stop {
    Fault(FaultKind),
    /// A grant is not answered.
    Silent,
}

fn task(name: &str, interval_ns: u64, priority: u32, programs: Vec<String>) -> Task {
    Task { name: name.to_owned(), interval: TimeSpan::from_nanos(interval_ns), priority, programs, ..Task::default() }
}

/// The three, with the name of the first program.
struct Three {
    prefix: String,
    /// The instrumented project, if its variables have other paths there.
    moved: Option<Project>,
    plain: SoftPlc,
    inert: SoftPlc,
    granted: Granted,
    now_ns: u64,
    interval_ns: u64,
}

impl Three {
    /// # Errors
    /// Why the case has nothing to show here.
    fn of(case: &Case, text: &str, target: Target) -> Result<Self, String> {
        let mut input = Input::from_text("case.st", SourceKind::Text, text);
        let dialect = if target == Target::Codesys { Some(Dialect::Codesys) } else { case.dialect };
        if case.dialect.is_some() && case.dialect != dialect {
            return Err("is of another dialect".to_owned());
        }
        if let Some(dialect) = dialect {
            input = input.in_dialect(dialect);
        }
        let first_error = |found: &dyn std::fmt::Display| {
            found.to_string().lines().find(|line| line.contains("error")).unwrap_or("").to_owned()
        };
        let plain = Application::from_inputs([input.clone()]);
        let plain = plain.map_err(|found| format!("does not compile: {}", first_error(&found)))?;
        let configured = plain.configured_tasks();
        let single = || plain.single_task(case.interval());
        let plan = configured.clone().unwrap_or_else(single);
        let tasks = configured.is_none().then(|| plan.tasks.clone());
        let project = instrument(&[input], &Options { tasks, target, ..Options::default() });
        let project = project.map_err(|error| format!("is refused: {}", first_error(&error)))?;
        let files = project.program().map(|file| {
            let text = file.text.as_deref().expect("nothing is deleted");
            let is_xml = project.whole.is_some() && target == Target::Codesys;
            let kind = if is_xml { SourceKind::PlcOpen } else { SourceKind::Text };
            let input = Input::from_text(&file.name, kind, text);
            match dialect.filter(|_| file.name == "case.st") {
                Some(dialect) => input.in_dialect(dialect),
                None => input,
            }
        });
        let shimmed = Application::from_inputs(files).unwrap_or_else(|found| panic!("{found}"));
        let called = project.tasks.clone().map_or_else(|| plan.clone(), TaskPlan::new);
        let plans = shimmed.configured_tasks().map_or_else(|| plans(&called), |plan| [plan.clone(), plan]);
        let [free, own] = plans.map(|plan| SoftPlc::new(&shimmed, &plan).expect("the plan suits"));
        let plc = SoftPlc::new(&plain, &plan).map_err(|error| error.to_string())?;
        let prefix = plain.programs().next().map(|program| program.name).unwrap_or_default();
        let moved = project.tasks.is_some().then_some(project);
        let block = if moved.is_some() { "SDSP." } else { "" };
        let granted = Granted { plc: own, block, own_ns: 0, session: 0, grant: 0 };
        Ok(Self {
            prefix,
            moved,
            interval_ns: plc.period().map_or(0, TimeSpan::as_nanos),
            plain: plc,
            inert: free,
            granted,
            now_ns: 0,
        })
    }

    fn begin(&mut self) {
        let simulated = format!("{}SDSP_Simulated", self.granted.block);
        let simulated = self.inert.variable(&simulated).expect("the shim is there").offset as usize;
        self.inert.memory_mut()[simulated] = 0;
        self.granted.join(self.now_ns).expect("the PLC is fresh");
    }

    fn restart(&mut self, start: &str) {
        let start: fn(&mut SoftPlc) = match start {
            "warm" => SoftPlc::warm_start,
            "cold" => SoftPlc::cold_start,
            _ => return,
        };
        [&mut self.plain, &mut self.inert, &mut self.granted.plc].into_iter().for_each(start);
        self.begin();
    }

    /// One scan of each.
    fn scan(&mut self) -> [Result<(), Stop>; 3] {
        self.now_ns += self.interval_ns;
        let now = VirtualTime::from_nanos(self.now_ns);
        let fault = |fault: onescan_iec_run::PlcFault| Stop::Fault(fault.kind);
        [self.plain.scan(now).map_err(fault), self.inert.scan(now).map_err(fault), self.granted.step(self.now_ns)]
    }

    /// Where one of the instrumented holds something else.
    fn difference(&self) -> Option<String> {
        let wanted = held(&self.plain);
        [("not simulated", &self.inert), ("granted", &self.granted.plc)].into_iter().find_map(|(how, plc)| {
            let found = match &self.moved {
                Some(project) => moved(project, plc, &wanted),
                None => held(plc),
            };
            let differs = wanted.iter().find(|(path, bytes)| found.get(*path) != Some(bytes));
            differs.map(|(path, bytes)| format!("{how}: {path} is {:?}, not {bytes:?}", found.get(path)))
        })
    }
}

/// The tasks beside the scheduler; all programs in one task behind it.
fn plans(plan: &TaskPlan) -> [TaskPlan; 2] {
    let scheduler = || vec![task("sdsp", MS, 0, vec![SCHEDULER.to_owned()])];
    let programs = plan.tasks.iter().flat_map(|task| task.programs.clone()).collect();
    let moved = [scheduler(), vec![task("programs", 2 * MS, 1, programs)]].concat();
    let kept = plan.tasks.iter().map(|task| Task { priority: task.priority + 1, ..task.clone() });
    [TaskPlan::new(scheduler().into_iter().chain(kept).collect()), TaskPlan::new(moved)]
}

/// What a source of time keeps for itself, by the beginning of its type's name: the original has it, or the shim.
const INTERNAL: [(&str, &[&str]); 6] = [
    ("TON", &["M", "since", "ONESCAN_TV"]),
    ("TOF", &["M", "since", "ONESCAN_TV"]),
    ("TP", &["M", "since", "running", "ONESCAN_TV"]),
    ("RTC", &["M", "since", "start", "ONESCAN_TV"]),
    ("ONESCAN_SFC_STEP", &["T", "since"]),
    ("ONESCAN_SFC_CONTROL", &[]),
];

/// All that the project declares, with its bytes, but not the inputs of programs: these are given.
fn held(plc: &SoftPlc) -> BTreeMap<String, Vec<u8>> {
    let application = plc.application();
    let inputs: BTreeSet<String> =
        application.programs().flat_map(|program| program.inputs).map(|input| input.path).collect();
    // True for the part `rest` of what lies at `parent`.
    let is_internal = |(parent, rest): (&str, &str)| {
        let block = application.variable(parent).map(|variable| variable.type_name.to_uppercase()).unwrap_or_default();
        let block = block.strip_prefix("SDSP_").unwrap_or(&block);
        let found = INTERNAL.iter().find(|(name, _)| block == *name || block.starts_with(&format!("{name}_")));
        found.is_some_and(|(_, members)| members.is_empty() || members.contains(&rest))
    };
    let is_own = |path: &str| {
        let mut splits = path.match_indices('.').map(|(at, _)| (&path[..at], &path[at + 1..]));
        let shims = path.contains("SDSP") || path.starts_with("ONESCAN_TV");
        !shims && !inputs.contains(path) && !splits.any(is_internal)
    };
    let bytes = |offset: u32, size: u32| plc.memory()[offset as usize..][..size as usize].to_vec();
    let leaves = application.leaves().filter(|leaf| is_own(&leaf.path));
    leaves.map(|leaf| (in_text(&leaf.path), bytes(leaf.offset, leaf.size))).collect()
}

/// The same of a project that was written in another language: what is a constant there has no place.
fn moved(project: &Project, plc: &SoftPlc, wanted: &BTreeMap<String, Vec<u8>>) -> BTreeMap<String, Vec<u8>> {
    let value = |(path, bytes): (&String, &Vec<u8>)| match plc.variable(&project.path(path)) {
        Ok(variable) => (path.clone(), variable.bytes(plc.memory())),
        Err(_) => (path.clone(), bytes.clone()),
    };
    wanted.iter().map(value).collect()
}

/// The path that a variable has in text. PLCopen XML has lists of global variables, and its resources have names.
fn in_text(path: &str) -> String {
    let path = path.strip_prefix("Application.").unwrap_or(path);
    let names: Vec<&str> = path.split('.').filter(|name| !name.starts_with("GVL_case")).collect();
    names.join(".")
}

/// Runs a case; what is not the same.
fn run(case: &Case, three: &mut Three) -> Result<(), String> {
    three.begin();
    for scan in 0..case.scans {
        three.restart(case.restarts.get(scan).map_or("-", String::as_str));
        for row in &case.given {
            for plc in [&mut three.plain, &mut three.inert, &mut three.granted.plc] {
                trace::give(plc, &three.prefix, row, scan).expect("it can be given");
            }
        }
        let [plain, inert, granted] = three.scan();
        if plain != inert || plain != granted {
            return Err(format!("scan {}: {plain:?}, not simulated {inert:?}, granted {granted:?}", scan + 1));
        }
        if let Some(difference) = three.difference().filter(|_| plain.is_ok()) {
            return Err(format!("scan {}: {difference}", scan + 1));
        }
    }
    Ok(())
}

/// What SCL does in its own way, see README.md: neither a division by zero nor a value outside of its subrange is
/// a fault.
const OTHERWISE_IN_SCL: [&str; 2] = ["iec2_annex_e_division_by_zero", "iec2_annex_e_value_out_of_subrange"];

/// How many cases are the same, and those that cannot be instrumented, with the reason.
fn outcome(target: Target) -> String {
    let (mut same, mut left, mut failures) = (0, Vec::new(), Vec::new());
    for path in super::files() {
        let (name, text) = (super::stem(&path), std::fs::read_to_string(&path).expect("a case"));
        let case = Case::parse(&text).expect("it has a trace");
        let ran = Three::of(&case, &text, target).map(|mut three| run(&case, &mut three));
        match ran {
            Ok(Ok(())) => same += 1,
            Ok(Err(why)) if target == Target::Scl && OTHERWISE_IN_SCL.contains(&name.as_str()) => {
                left.push(format!("{name}: {why}"));
            }
            Ok(Err(why)) => failures.push(format!("{name}, {why}")),
            Err(why) => left.push(format!("{name}: {why}")),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    format!("{same} are the same, {} are not there:\n{}", left.len(), left.join("\n"))
}

#[test]
fn every_case_is_the_same_in_lockstep() {
    insta::assert_snapshot!(outcome(Target::Iec));
}

#[test]
fn every_case_is_the_same_in_plcopen_xml() {
    insta::assert_snapshot!(outcome(Target::Codesys));
}

#[test]
fn every_case_is_the_same_in_scl() {
    insta::assert_snapshot!(outcome(Target::Scl));
}
