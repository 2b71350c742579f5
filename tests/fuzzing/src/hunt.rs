//! The hunt on one target, in a process of its own: inputs are changed, given, judged, and kept if they lead somewhere new.

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::{Seek, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::change::{Changer, Draw};
use crate::cover::{Seen, counters};
use crate::judge::{Limits, Wrong, judge, watch};
use crate::shrink::shrink;
use crate::targets::{Prepared, Target};

/// An input that takes this long is taken for one that never ends.
const PATIENCE: Duration = Duration::from_secs(40);
/// Most bytes of all inputs that are kept.
const CORPUS_BYTES_MAX: usize = 64 << 20;
/// Most inputs that are kept where nothing shows which are new.
const BLIND_MAX: usize = 400;

/// How long it goes on.
#[derive(Clone, Copy, Debug)]
pub enum Span {
    /// Inputs.
    Inputs(u64),
    /// Time.
    Time(Duration),
}

/// What is to be done.
pub struct Hunt<'h> {
    /// On what.
    pub target: &'h Target,
    /// Where inputs begin.
    pub seed: u64,
    /// How long.
    pub span: Span,
    /// What must hold.
    pub limits: Limits,
    /// A folder for the target's files.
    pub scratch: &'h Path,
    /// Where findings go.
    pub keep: &'h Path,
}

/// The input that is looked at, for whoever finds this process dead.
pub const CURRENT: &str = "current";
/// How far this process has come, as JSON.
pub const PROGRESS: &str = "progress.json";

#[derive(Default)]
struct Tally {
    inputs: u64,
    accepted: u64,
    worst_s: f64,
    worst_mib: usize,
}

impl Hunt<'_> {
    /// Hunts. Findings are files of `keep`.
    ///
    /// # Panics
    /// If the scratch folder cannot be written.
    pub fn run(&self) {
        watch(PATIENCE);
        let mut prepared = (self.target.prepare)(self.scratch);
        let mut corpus = prepared.seeds.clone();
        let mut changer = Changer::new(Draw::new(self.seed, self.target.name), prepared.words, &corpus);
        let mut held: usize = corpus.iter().map(Vec::len).sum();
        let mut seen = Seen::new();
        let mut known = BTreeSet::new();
        let mut tally = Tally::default();
        let mut current = OpenOptions::new().create(true).truncate(false).write(true).open(self.scratch.join(CURRENT));
        let start = Instant::now();
        let mut reported = Instant::now();
        let mut waiting: Vec<Vec<u8>> = corpus.clone();
        loop {
            let input = waiting.pop().unwrap_or_else(|| {
                let mut input = changer.next(&corpus);
                (prepared.mend)(&mut input);
                input
            });
            note(current.as_mut().expect("a scratch folder"), &input);
            let verdict = judge(&mut prepared, &input, self.limits);
            tally.inputs += 1;
            tally.accepted += u64::from(verdict.is_accepted);
            tally.worst_s = tally.worst_s.max(verdict.seconds);
            tally.worst_mib = tally.worst_mib.max(verdict.mib);
            if tally.inputs <= prepared.seeds.len() as u64 && !verdict.is_accepted && is_shown() {
                let begin = String::from_utf8_lossy(&input[..input.len().min(60)]);
                eprintln!("{}: refuses a good input that begins {begin:?}", self.target.name);
            }
            if tally.inputs == prepared.seeds.len() as u64 && tally.accepted == 0 {
                keep(self.keep, self.target.name, &input, "none of the good inputs is accepted");
            }
            let is_new = seen.take();
            if let Some(wrong) = verdict.wrong {
                if known.insert(wrong.key()) {
                    self.found(&mut prepared, input, &wrong);
                }
                seen.take();
            } else if is_new && held < CORPUS_BYTES_MAX
                || counters() == 0 && verdict.is_accepted && corpus.len() < BLIND_MAX
            {
                held += input.len();
                corpus.push(input);
            }
            let is_over = match self.span {
                Span::Inputs(most) => tally.inputs >= most,
                Span::Time(most) => start.elapsed() >= most,
            };
            if is_over || reported.elapsed() > Duration::from_secs(1) {
                reported = Instant::now();
                self.report(&tally, corpus.len(), seen.branches(), start.elapsed());
            }
            if is_over {
                return;
            }
        }
    }

    fn found(&self, prepared: &mut Prepared, input: Vec<u8>, wrong: &Wrong) {
        let key = wrong.key();
        let tries = if matches!(wrong, Wrong::Panic { .. }) { 3_000 } else { 25 };
        let limits = self.limits;
        let short = shrink(input, tries, |shorter| {
            let mut shorter = shorter.to_vec();
            (prepared.mend)(&mut shorter);
            judge(prepared, &shorter, limits).wrong.is_some_and(|wrong| wrong.key() == key)
        });
        let said = if let Wrong::Panic { message, .. } = wrong { format!("{key}: {message}") } else { key };
        keep(self.keep, self.target.name, &short, &said);
    }

    fn report(&self, tally: &Tally, corpus: usize, branches: usize, elapsed: Duration) {
        let progress = json!({
            "inputs": tally.inputs, "accepted": tally.accepted, "worst_s": tally.worst_s, "worst_mib": tally.worst_mib,
            "corpus": corpus, "branches": branches, "counters": counters(), "seconds": elapsed.as_secs_f64(),
        });
        std::fs::write(self.scratch.join(PROGRESS), progress.to_string()).expect("a scratch folder");
    }
}

/// What goes wrong is to be shown as it comes.
pub fn is_shown() -> bool {
    std::env::var_os("ONESCAN_FUZZ_SHOW").is_some()
}

/// Writes an input where it is found if this process ends.
fn note(current: &mut File, input: &[u8]) {
    let written =
        current.rewind().and_then(|()| current.write_all(input)).and_then(|()| current.set_len(input.len() as u64));
    written.expect("a scratch folder");
}

/// Keeps a finding, with what is wrong with it beside it.
///
/// # Panics
/// If the folder cannot be written.
pub fn keep(folder: &Path, target: &str, input: &[u8], said: &str) {
    std::fs::create_dir_all(folder).expect("a folder for findings");
    let hash = blake3::hash(said.as_bytes()).to_hex();
    let name = format!("{target}-{}", &hash[..8]);
    std::fs::write(folder.join(&name), input).expect("a folder for findings");
    std::fs::write(folder.join(format!("{name}.txt")), format!("{said}\n")).expect("a folder for findings");
}
