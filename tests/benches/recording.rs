//! Steps a second of a session with 1,000 signals at 1 kHz, recorded, beside the same session
//! without; the time of processors that a step costs, which another load of the machine hardly
//! changes; and how much memory the process has while it records.
//!
//! `cargo bench -p onescan-tests --bench recording`, with `-- --parquet` in that form only; with
//! `-- --steps 10000000` one long run, to see that memory stays flat.

use std::time::{Duration, Instant};

use onescan_recording::{Choice, Recorder};
use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::lockstep::Lockstep;
use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::signal::{ClientName, Port, SignalDecl, SignalName, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_tests::run::{boxed, in_process, provenance};

/// How many signals of a type a client writes, and every how many of them changes in a step.
#[derive(Clone, Copy)]
struct Group {
    ty: SignalType,
    count: usize,
    every: usize,
}

/// The I/O of a machine: mostly BOOLs that stand still, some counters, axes that move.
const MACHINE: [Group; 3] = [
    Group { ty: SignalType::BOOL, count: 400, every: 100 },
    Group { ty: SignalType::INT, count: 75, every: 10 },
    Group { ty: SignalType::LREAL, count: 25, every: 1 },
];

/// The worst case: nothing but real numbers, all of which change in every step.
const WORST: [Group; 1] = [Group { ty: SignalType::LREAL, count: 500, every: 1 }];

/// Writes half of the signals and reads the other half.
struct Half {
    request: JoinRequest,
    groups: Vec<Group>,
    state: u64,
}

impl Client for Half {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, _outputs: &mut [u8]) -> Result<(), ClientFault> {
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, _inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let step = (t_v.as_nanos() / 1_000_000) as usize;
        let mut offset = 0;
        for group in &self.groups {
            let size = group.ty.size();
            let first = step % group.every;
            for index in (first..group.count).step_by(group.every) {
                self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let place = &mut outputs[offset + index * size..offset + (index + 1) * size];
                match group.ty {
                    SignalType::BOOL => place[0] ^= 1,
                    SignalType::INT => place.copy_from_slice(&(step as u16).to_le_bytes()),
                    // A position with noise: 20 bits of it change.
                    _ => place.copy_from_slice(&(step as f64 * 1e-3 + (self.state >> 44) as f64 * 1e-9).to_le_bytes()),
                }
            }
            offset += group.count * size;
        }
        Ok(Wake::NextPeriod)
    }
}

fn session(groups: &[Group]) -> Lockstep {
    let step = TimeSpan::from_millis(1).expect("not zero");
    let names = ["plant", "plc"].map(|name| ClientName::new(name).expect("a name"));
    let ports = |name: &ClientName| -> Vec<Port> {
        let of = |group: &Group| (0..group.count).map(|index| (group.ty, index)).collect::<Vec<_>>();
        let all = groups.iter().flat_map(of);
        let name_of = |ty: SignalType, index: usize| SignalName::new(format!("{name}.{ty}.{index:03}"));
        all.map(|(ty, index)| Port { name: name_of(ty, index).expect("a name"), ty }).collect()
    };
    let both = names.each_ref().map(ports);
    let declared = names.iter().zip(&both).flat_map(|(name, ports)| {
        let declare =
            |port: &Port| SignalDecl { name: port.name.clone(), ty: port.ty, writer: Some(name.clone()), unit: None };
        ports.iter().map(declare).collect::<Vec<_>>()
    });
    let plan = SessionPlan::new(step, &Coupling::Parallel, declared.collect(), names.to_vec()).expect("a plan");
    let half = |(own, name): (usize, ClientName)| {
        let request = JoinRequest { name, period: step, reads: both[1 - own].clone(), writes: both[own].clone() };
        Half { request, groups: groups.to_vec(), state: own as u64 }
    };
    in_process(plan, boxed(names.into_iter().enumerate().map(half)))
}

/// What some steps take.
#[derive(Clone, Copy, Debug)]
struct Cost {
    /// By the clock, up to the last byte of the recording if there is one.
    wall: Duration,
    /// Time of processors of the session's thread, where the system reports it.
    session: Option<Duration>,
    /// The same of all threads.
    all: Option<Duration>,
}

/// Time of processors that the process or thread behind `path` of procfs has had, as `stat` counts
/// it: in hundredths of a second.
fn processors(path: &str) -> Option<Duration> {
    let stat = std::fs::read_to_string(path).ok()?;
    // The name, in parentheses, may hold blanks; behind it user time is the 12th field, system time the 13th.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11).map(str::parse::<u64>);
    let (user, system) = (fields.next()?.ok()?, fields.next()?.ok()?);
    Some(Duration::from_millis(10 * (user + system)))
}

/// Runs `steps` steps.
fn timed(groups: &[Group], steps: u64, record: Option<Choice>) -> Cost {
    let folder = tempfile::tempdir().expect("a folder");
    let mut lockstep = session(groups);
    lockstep.set_until(Some(VirtualTime::from_nanos(steps * 1_000_000)));
    if let Some(choice) = record {
        lockstep.observe(Box::new(Recorder::new(folder.path(), provenance(), choice)));
    }
    let used = || (processors("/proc/thread-self/stat"), processors("/proc/self/stat"));
    let (started, before) = (Instant::now(), used());
    lockstep.run().expect("it can be recorded");
    let (wall, after) = (started.elapsed(), used());
    let between = |(before, after): (Option<Duration>, Option<Duration>)| after?.checked_sub(before?);
    Cost { wall, session: between((before.0, after.0)), all: between((before.1, after.1)) }
}

/// Resident memory in MiB, where the system reports it.
fn resident_mib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib / 1024)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

#[expect(clippy::print_stdout, reason = "a bench prints its figures")]
fn compare(name: &str, groups: &[Group], steps: u64, parquet_only: bool) {
    let mut forms = vec![
        ("Parquet", Choice::default()),
        ("Parquet and MCAP", Choice { mcap: true, ..Choice::default() }),
        ("Parquet and CSV", Choice { csv: true, ..Choice::default() }),
    ];
    forms.truncate(if parquet_only { 1 } else { forms.len() });
    // In turns, so that what else the machine does meets all alike.
    let mut costs = vec![Vec::new(); forms.len() + 1];
    for _ in 0..5 {
        costs[0].push(timed(groups, steps, None));
        for (costs, (_, choice)) in costs[1..].iter_mut().zip(&forms) {
            costs.push(timed(groups, steps, Some(choice.clone())));
        }
    }
    let of = |costs: &[Cost], part: fn(&Cost) -> Option<Duration>| {
        let parts: Option<Vec<f64>> = costs.iter().map(|cost| part(cost).map(|part| part.as_secs_f64())).collect();
        parts.map(median)
    };
    let walls: Vec<f64> = costs.iter().filter_map(|costs| of(costs, |cost| Some(cost.wall))).collect();
    let per_step = |costs: &[Cost], part| of(costs, part).map_or(f64::NAN, |time| time / steps as f64 * 1e6);
    println!("{name}: a step's time of processors is that of the session's thread, and of all threads");
    let names = std::iter::once("unrecorded").chain(forms.iter().map(|(form, _)| *form));
    for ((form, costs), wall) in names.zip(&costs).zip(&walls) {
        println!(
            "  {form:18} {:>9.0} steps/s  {:5.1} %   {:6.2} µs  {:6.2} µs",
            steps as f64 / wall,
            100.0 * walls[0] / wall,
            per_step(costs, |cost| cost.session),
            per_step(costs, |cost| cost.all)
        );
    }
}

#[expect(clippy::print_stdout, reason = "a bench prints its figures")]
fn memory(steps: u64) {
    let done = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let started = Instant::now();
            while !done.load(std::sync::atomic::Ordering::Relaxed) {
                if let Some(mib) = resident_mib() {
                    println!("{:6.1} s  {mib} MiB", started.elapsed().as_secs_f64());
                }
                std::thread::sleep(Duration::from_secs(2));
            }
        });
        let time = timed(&MACHINE, steps, Some(Choice::default())).wall;
        done.store(true, std::sync::atomic::Ordering::Relaxed);
        println!(
            "{steps} steps recorded in {:.1} s, {:.0} steps/s",
            time.as_secs_f64(),
            steps as f64 / time.as_secs_f64()
        );
    });
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let steps = words.iter().position(|word| word == "--steps").and_then(|at| words.get(at + 1)?.parse().ok());
    if let Some(steps) = steps {
        memory(steps);
    } else {
        let parquet_only = words.iter().any(|word| word == "--parquet");
        compare("1,000 signals of a machine", &MACHINE, 100_000, parquet_only);
        compare("1,000 LREALs that change in every step", &WORST, 20_000, parquet_only);
    }
}
