//! Fuzzing: every parser of bytes from outside is given what nobody meant, in this process.
//!
//! | module | subject |
//! |---|---|
//! | `targets` | the parsers, what good input is, what is done with it |
//! | `change` | changes of bytes, drawn from a seed |
//! | `cover` | which branches an input has taken, where the build counts them |
//! | `memory` | how much an input holds |
//! | `judge` | one input, one target, one verdict |
//! | `hunt` | many of them, in a process of its own |
//! | `shrink` | findings made short |
//!
//! `tests/fuzz` builds it with overflow checks, debug assertions and counters of coverage. As one of the project's tests it
//! does the same for a fixed number of inputs, blind and as the program is built.

mod change;
mod cover;
mod hunt;
mod judge;
mod memory;
mod shrink;
mod targets;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use hunt::{CURRENT, Hunt, PROGRESS, Span};
use judge::{Limits, Wrong, judge};
use targets::{TARGETS, Target};

#[global_allocator]
static ALLOCATOR: memory::Counted = memory::Counted;

/// Inputs of each target in a run of all tests.
const INPUTS: u64 = 150;
/// Restarts after which a target is left: each is a finding of its own.
const RESTARTS_MAX: u64 = 20;

const USAGE: &str =
    "tests/fuzz [--for TIME] [--inputs N] [--target PART] [--seed N] [--keep DIR] [--seconds S] [--mib N]
           [--list] [--once FILE]

  --for TIME     of each target, as in 10s, 8m, 1h
  --inputs N     of each target, in place of a time [default: 150]
  --target PART  targets that have this in their names
  --seed N       the same seed and number of inputs give the same inputs [default: 1]
  --keep DIR     where findings are kept [default: fuzz-found]
  --seconds S    of the processor, that an input may take [default: 2]
  --mib N        of memory, that an input may take [default: 512]
  --list         name the targets
  --once FILE    give this input to the target, and nothing else";

struct Options {
    span: Span,
    target: String,
    seed: u64,
    keep: PathBuf,
    limits: Limits,
    once: Option<PathBuf>,
    /// This process is a hunt, with its files here.
    scratch: Option<PathBuf>,
    is_list: bool,
}

fn options() -> Result<Options, String> {
    let mut options = Options {
        span: Span::Inputs(INPUTS),
        target: String::new(),
        seed: 1,
        keep: "fuzz-found".into(),
        limits: Limits { seconds: 2.0, mib: 512 },
        once: None,
        scratch: None,
        is_list: false,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if word == "--list" {
            options.is_list = true;
            continue;
        }
        let value = words.next().ok_or_else(|| format!("`{word}` needs a value\n\n{USAGE}"))?;
        let number = || value.parse::<u64>().map_err(|_| format!("`{word} {value}`: not a number"));
        match word.as_str() {
            "--for" => {
                let span: onescan_base::TimeSpan =
                    value.parse().map_err(|error| format!("`{word} {value}`: {error}"))?;
                options.span = Span::Time(Duration::from_nanos(span.as_nanos()));
            }
            "--inputs" => options.span = Span::Inputs(number()?),
            "--target" => options.target = value,
            "--seed" => options.seed = number()?,
            "--keep" => options.keep = value.into(),
            "--seconds" => {
                options.limits.seconds = value.parse().map_err(|_| format!("`{word} {value}`: not a number"))?;
            }
            "--mib" => options.limits.mib = number()? as usize,
            "--once" => options.once = Some(value.into()),
            "--scratch" => options.scratch = Some(value.into()),
            _ => return Err(format!("there is no `{word}`\n\n{USAGE}")),
        }
    }
    Ok(options)
}

fn main() -> ExitCode {
    let options = match options() {
        Ok(options) => options,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    let chosen: Vec<&Target> = TARGETS.iter().filter(|target| target.name.contains(&options.target)).collect();
    if let (Some(scratch), [target, ..]) = (&options.scratch, &chosen[..]) {
        let target = chosen.iter().find(|each| each.name == options.target).unwrap_or(target);
        return as_child(target, scratch, &options);
    }
    if options.is_list {
        for target in &chosen {
            println!("{:16} {}", target.name, target.about);
        }
        return ExitCode::SUCCESS;
    }
    if chosen.is_empty() {
        eprintln!("no target has `{}` in its name; `--list` names them", options.target);
        return ExitCode::from(2);
    }
    println!(
        "{:16} {:>8} {:>9} {:>8} {:>7} {:>8} {:>8} {:>9}  found",
        "target", "seconds", "inputs", "accepted", "corpus", "branches", "worst s", "worst MiB"
    );
    let found: usize = chosen.iter().map(|target| in_child(target, &options)).sum();
    match found {
        0 => println!("nothing found"),
        count => println!("{count} found, kept in {}", options.keep.display()),
    }
    ExitCode::from(u8::from(found > 0))
}

fn as_child(target: &Target, scratch: &Path, options: &Options) -> ExitCode {
    if let Some(file) = &options.once {
        let input = std::fs::read(file).expect("an input");
        let mut prepared = (target.prepare)(scratch);
        judge::watch(Duration::from_secs(40));
        let verdict = judge(&mut prepared, &input, options.limits);
        println!("{verdict:?}");
        return ExitCode::from(u8::from(verdict.wrong.is_some()));
    }
    let Options { seed, span, limits, keep, .. } = options;
    Hunt { target, seed: *seed, span: *span, limits: *limits, scratch, keep }.run();
    ExitCode::SUCCESS
}

/// Hunts on one target in a process of its own, which is restarted if it ends; gives how much was found.
fn in_child(target: &Target, options: &Options) -> usize {
    let begun = Instant::now();
    let before = kept(&options.keep, target.name);
    let mut sums = Sums::default();
    for restart in 0..RESTARTS_MAX {
        let place = scratch();
        let span = match options.span {
            Span::Inputs(most) => Span::Inputs(most.saturating_sub(sums.inputs)),
            Span::Time(most) => Span::Time(most.saturating_sub(begun.elapsed())),
        };
        let mut child = child(target, place.path(), options);
        match span {
            Span::Inputs(most) => child.args(["--inputs", &most.to_string()]),
            Span::Time(most) => child.args(["--for", &format!("{}ms", most.as_millis().max(1))]),
        };
        child.args(["--seed", &(options.seed + restart * 1_000_003).to_string()]);
        if let Some(once) = &options.once {
            child.arg("--once").arg(once).stdout(Stdio::inherit()).stderr(Stdio::inherit());
        }
        let status = child.status().expect("this program");
        if options.once.is_some() {
            println!("{status}");
            return usize::from(!status.success());
        }
        sums.add(&place.path().join(PROGRESS));
        if status.success() {
            break;
        }
        let input = std::fs::read(place.path().join(CURRENT)).unwrap_or_default();
        let short = shrink::shrink(input, 60, |shorter| ends(target, shorter, options));
        hunt::keep(
            &options.keep,
            target.name,
            &short,
            &format!("{}: {status}, {} bytes", Wrong::Ended.key(), short.len()),
        );
    }
    let found = kept(&options.keep, target.name) - before;
    println!(
        "{:16} {:8.0} {:9} {:7.0}% {:7} {:8} {:8.2} {:9}  {}",
        target.name,
        sums.seconds,
        sums.inputs,
        100.0 * sums.accepted as f64 / sums.inputs.max(1) as f64,
        sums.corpus,
        sums.branches,
        sums.worst_s,
        sums.worst_mib,
        if found == 0 { "-".to_owned() } else { found.to_string() }
    );
    found
}

fn child(target: &Target, scratch: &Path, options: &Options) -> Command {
    let mut child = Command::new(std::env::current_exe().expect("this program"));
    child.args(["--target", target.name, "--scratch"]).arg(scratch);
    child.arg("--keep").arg(std::path::absolute(&options.keep).expect("a folder"));
    child.args(["--seconds", &options.limits.seconds.to_string(), "--mib", &options.limits.mib.to_string()]);
    child.stdin(Stdio::null()).stdout(Stdio::null());
    if !hunt::is_shown() {
        child.stderr(Stdio::null());
    }
    child
}

/// Whether an input ends a process that is given it.
fn ends(target: &Target, input: &[u8], options: &Options) -> bool {
    let place = scratch();
    let file = place.path().join("input");
    std::fs::write(&file, input).expect("a scratch folder");
    let status = child(target, place.path(), options).arg("--once").arg(&file).status().expect("this program");
    status.code().is_none()
}

/// A folder in memory where there is one.
fn scratch() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    let made = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    made.expect("a scratch folder")
}

/// How many findings of a target are kept.
fn kept(folder: &Path, target: &str) -> usize {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names
        .filter(|name| {
            name.strip_suffix(".txt").is_some_and(|name| name.rsplit_once('-').is_some_and(|(of, _)| of == target))
        })
        .count()
}

#[derive(Default)]
struct Sums {
    inputs: u64,
    accepted: u64,
    seconds: f64,
    worst_s: f64,
    worst_mib: u64,
    corpus: u64,
    branches: u64,
}

impl Sums {
    fn add(&mut self, progress: &Path) {
        let text = std::fs::read_to_string(progress).unwrap_or_default();
        let reported: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
        let count = |key: &str| reported[key].as_u64().unwrap_or_default();
        let number = |key: &str| reported[key].as_f64().unwrap_or_default();
        self.inputs += count("inputs").max(1);
        self.accepted += count("accepted");
        self.seconds += number("seconds");
        self.worst_s = self.worst_s.max(number("worst_s"));
        self.worst_mib = self.worst_mib.max(count("worst_mib"));
        self.corpus = self.corpus.max(count("corpus"));
        self.branches = self.branches.max(count("branches"));
    }
}
