//! Random programs against `MatIEC`, a compiler of the 2nd edition that nobody of this project wrote: the same inputs, 100
//! scans of 10 ms, and every value after every scan.
//!
//! | module | subject |
//! |---|---|
//! | [`dice`] | choices from a seed |
//! | [`known`] | what is known to differ, and who is right |
//! | [`peer_program`] | a program that both sides run; the soft PLC's trace of it |
//! | [`typed`] | every elementary type, statement, standard function and block |
//! | [`statements`], [`timers`], [`charts`] | the random programs of other tests, without what is known to differ |
//!
//! The peer is `tests/peers/matiec`; it needs a C compiler, and `iec2c` on the PATH with its library beside it (`lib`), or
//! in the folder that `ONESCAN_MATIEC_LIB` names. Without `iec2c` the test says so and compares nothing. For more
//! programs, and others:
//!
//! ```sh
//! ONESCAN_MATIEC=10000 ONESCAN_MATIEC_SEED=0 cargo test --release -p onescan-iec-tests --test programs matiec -- --nocapture
//! ```
//!
//! Seeds 0 to 9,999 with `MatIEC` of October 2024, 1,000,000 scans, took 13 minutes on two cores: of 30,338,100 values
//! 30,249,078 were the same to the last bit, 85,129 results of SIN, EXP and the like the next real, and 3,893 zeros had
//! the other sign. One program was the same only after the peer's carry of seconds had been mended.
//!
//! `ONESCAN_MATIEC_FOLDER` keeps the programs, traces and C code in a folder.

mod charts;
pub(crate) mod dice;
mod known;
pub(crate) mod peer_program;
mod statements;
mod timers;
mod typed;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use dice::Dice;
use known::KNOWN;
use peer_program::{PRELUDE, PeerProgram, SCANS};

use crate::lockstep::random;
use crate::random_programs::program as statement;
use crate::sfc::chart::{Chart, arbitrary_part};

/// Programs that the peer compiles at once: most of the time is the C compiler's, for the headers.
const BATCH: u64 = 50;
/// Why nothing is compared.
const ABSENT: &str = "skipped: `iec2c`, the compiler of MatIEC, is not on the PATH";
/// Batches at work at once.
const WORKERS: u64 = 2;

/// The value that a strategy gives for a seed.
fn value<S: Strategy>(strategy: &S, seed: u64) -> S::Value {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    let tree = strategy.new_tree(&mut TestRunner::new_with_rng(config, rng));
    tree.expect("nothing is filtered out").current()
}

/// The program of a seed.
fn program(seed: u64) -> PeerProgram {
    match seed % 8 {
        1 | 5 => statements::program(value(&statement::program(), seed)),
        3 => timers::program(&value(&random::statements(), seed)),
        7 => {
            let numbers = prop::collection::vec(any::<u32>(), 61);
            let (part, numbers) = value(&(arbitrary_part(), numbers), seed);
            charts::program(&Chart::new(&part, &numbers))
        }
        _ => typed::program(&mut Dice::new(seed)),
    }
}

/// Writes the programs of seeds, and what the soft PLC makes of them.
fn write(folder: &Path, seeds: std::ops::Range<u64>) {
    std::fs::create_dir_all(folder).expect("a folder can be made");
    std::fs::write(folder.join("prelude.st"), PRELUDE).expect("a file can be written");
    for seed in seeds {
        let program = program(seed);
        write_one(folder, &format!("{}_{seed}", program.family), &program, &mut Dice::new(!seed));
    }
}

/// Writes a program under a name, and what the soft PLC makes of it.
fn write_one(folder: &Path, name: &str, program: &PeerProgram, dice: &mut Dice) {
    std::fs::write(folder.join(format!("{name}.st")), program.named(name)).expect("a file can be written");
    std::fs::write(folder.join(format!("{name}.trace")), program.trace(dice)).expect("a file can be written");
}

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

/// The library of `iec2c`; nothing if that is not on the PATH.
pub(crate) fn library() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let found = std::env::split_paths(&path).find(|folder| folder.join("iec2c").is_file())?;
    let named = std::env::var_os("ONESCAN_MATIEC_LIB").map(PathBuf::from);
    Some(named.unwrap_or_else(|| found.join("lib")))
}

/// What the peer said of all batches: numbers by the words before them, and each difference.
#[derive(Debug, Default)]
pub(crate) struct Reported {
    pub(crate) counts: BTreeMap<String, u64>,
    pub(crate) differences: Vec<String>,
}

impl Reported {
    /// A line is a count, `typed values 4000`, or a difference.
    fn take(&mut self, line: &str) {
        match line.rsplit_once(' ').and_then(|(what, count)| Some((what, count.parse::<u64>().ok()?))) {
            Some((what, count)) if !line.starts_with("difference") => {
                *self.counts.entry(what.to_owned()).or_default() += count;
            }
            _ => self.differences.push(line.to_owned()),
        }
    }
}

#[expect(clippy::print_stdout, reason = "a difference is reported at once, a long run before its end")]
pub(crate) fn compare(folder: &Path, library: &Path, reported: &Mutex<Reported>) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/matiec/compare.py");
    let output =
        Command::new("python3").arg(script).arg(folder).arg(library).output().expect("Python is on the machine");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut reported = reported.lock().expect("no panic");
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        if line.starts_with("difference") && !line.starts_with("difference known") {
            println!("{line}");
        }
        reported.take(line);
    }
}

#[test]
#[expect(clippy::print_stdout, reason = "a measurement's figures, and why there are none")]
fn random_programs_do_the_same_in_matiec() {
    let Some(library) = library() else {
        println!("{ABSENT}");
        return;
    };
    let (count, first) = (number("ONESCAN_MATIEC", 100), number("ONESCAN_MATIEC_SEED", 0));
    let kept = std::env::var_os("ONESCAN_MATIEC_FOLDER").map(PathBuf::from);
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("matiec-{}", std::process::id()));
    let root = kept.clone().unwrap_or(root);
    let (reported, next, started) = (Mutex::new(Reported::default()), AtomicU64::new(first), Instant::now());
    std::thread::scope(|scope| {
        for _ in 0..WORKERS {
            scope.spawn(|| {
                loop {
                    let from = next.fetch_add(BATCH, Ordering::Relaxed);
                    if from >= first + count {
                        break;
                    }
                    let folder = root.join(from.to_string());
                    write(&folder, from..(from + BATCH).min(first + count));
                    compare(&folder, &library, &reported);
                    if kept.is_none() {
                        std::fs::remove_dir_all(&folder).unwrap();
                    }
                }
            });
        }
    });
    if kept.is_none() {
        std::fs::remove_dir_all(&root).unwrap();
    }
    let Reported { counts, differences } = reported.into_inner().unwrap();
    println!("{count} programs of {SCANS} scans in {:.0?}", started.elapsed());
    for (what, count) in counts {
        println!("{what} {count}");
    }
    assert!(differences.is_empty(), "{} differences:\n{}", differences.len(), differences.join("\n"));
}

/// What the random programs leave out does differ, as it is written down.
#[test]
#[expect(clippy::print_stdout, reason = "the table of differences, and why there is none")]
fn what_is_known_to_differ_in_matiec_does() {
    let Some(library) = library() else {
        println!("{ABSENT}");
        return;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("matiec-known-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("prelude.st"), PRELUDE).expect("a file can be written");
    let named = || KNOWN.iter().enumerate().map(|(number, known)| (format!("known_{number}"), known));
    for (name, known) in named() {
        write_one(&folder, &name, &known.program(), &mut Dice::new(0));
    }
    let reported = Mutex::new(Reported::default());
    compare(&folder, &library, &reported);
    std::fs::remove_dir_all(&folder).unwrap();
    let differences = reported.into_inner().unwrap().differences;
    for known in KNOWN {
        println!("{:?} by {}: {}: {}", known.verdict, known.clause, known.what, known.found);
    }
    let wrong: Vec<String> = named()
        .filter(|(name, known)| !differences.contains(&known.line(name)))
        .map(|(name, known)| {
            let found = differences.iter().find(|line| line.starts_with(&format!("difference {name}:")));
            format!("{}: wanted {}, found {found:?}", known.what, known.line(&name))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(differences.len(), KNOWN.len());
}
