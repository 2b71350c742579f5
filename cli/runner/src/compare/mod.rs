//! `onescan compare`: lockstep beside the other ways of bringing plant and PLC together, in one table and one plot.

use std::io::Write;
use std::path::PathBuf;

use onescan_base::notice::NOTICE;
use onescan_report::OutputError;
use onescan_report::file;
use onescan_report::plot::Plot;
use onescan_scenario::{Mode, Scenario};
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::signal::{SignalName, SignalType};
use serde::Serialize;

use crate::error::Usage;
use crate::format::Format;
use crate::interrupt::Interrupt;
use crate::run::config::{Drawing, Picture};
use crate::run::sampler::{Samples, drawn, panel};
use crate::run::{Ran, RunConfig, RunError, notices, one_run};

/// A way of bringing plant and PLC together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Way {
    mode: Mode,
    /// How much of its error a plant that follows corrects, %; as the scenario says if absent.
    gain_pct: Option<u8>,
}

/// The ways, lockstep first: the others are held against it. The plant follows by the scenario's gain, which is that of the paper
/// unless it says otherwise, and by half of the error.
const WAYS: [Way; 5] = [
    Way { mode: Mode::Lockstep, gain_pct: None },
    Way { mode: Mode::Freewheel, gain_pct: None },
    Way { mode: Mode::Halt, gain_pct: None },
    Way { mode: Mode::Follow, gain_pct: None },
    Way { mode: Mode::Follow, gain_pct: Some(50) },
];

/// Errors of a plant that follows which people are shown.
const ERRORS_SHOWN: usize = 10;

impl Way {
    /// What it is called in a table.
    fn name(self) -> String {
        match self.gain_pct {
            Some(gain_pct) => format!("{} {gain_pct}%", self.mode.name()),
            None => self.mode.name().to_owned(),
        }
    }
}

/// What is asked for.
#[derive(Clone, Debug)]
pub struct CompareConfig {
    /// How each run is made; its mode and what it writes are this command's business.
    pub run: RunConfig,
    /// A signal of which it is counted how often it comes true.
    pub count: Option<SignalName>,
    /// File for the plot.
    pub plot: Option<PathBuf>,
    /// For whom the table is.
    pub format: Format,
}

/// A way of bringing plant and PLC together, over all of its runs. Its JSON form is a contract.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub mode: Mode,
    pub runs: usize,
    /// Different digests among them.
    pub digests: usize,
    /// The largest distance of a signal with a fraction from lockstep, as a part of its range there, 0 to 1.
    pub deviation: f64,
    /// The signal that it is of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviating: Option<String>,
    /// How far edges are from those of lockstep on average, ms; positive if late.
    pub offset_ms: f64,
    /// Edges of lockstep that are missing, on average of the runs.
    pub lost_edges: f64,
    pub edges: usize,
    /// How often the signal that is counted came true, on average of the runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counted: Option<f64>,
    /// How much of its error a plant that follows corrects at each communication, %.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain_pct: Option<u8>,
    /// How far it was behind the PLC at each communication of the first run, ms.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub errors_ms: Vec<f64>,
    /// Steps a second, wall clock.
    pub steps_per_s: f64,
}

/// A run, as far as it is compared.
struct Run {
    digest: String,
    samples: Samples,
    errors_ns: Vec<i64>,
    steps_per_s: f64,
}

/// Nobody wonders about runs that are shorter than this in all, s.
const WORTH_A_WORD_S: u64 = 10;

/// Says how long runs in real time take: in a pipe nothing else is heard of them until they are over.
fn say_how_long(config: &CompareConfig, scenario: &Scenario) {
    if config.run.seed.is_some() {
        return;
    }
    let in_real_time = WAYS.iter().filter(|way| way.mode != Mode::Lockstep).count() as u64 * u64::from(config.run.runs);
    let span_s = config.run.subject.end(scenario).as_nanos() / 1_000_000_000;
    if in_real_time * span_s < WORTH_A_WORD_S {
        return;
    }
    tracing::info!(
        target: NOTICE,
        "{in_real_time} runs of {span_s} s in real time: {} s in all; with `--seed 1` their clocks are computed",
        in_real_time * span_s
    );
}

/// Runs the scenario in every mode and writes the table to `out`.
///
/// # Errors
/// As those of a run.
pub fn compare(config: &CompareConfig, interrupt: &Interrupt, out: &mut dyn Write) -> Result<Vec<Row>, RunError> {
    let plain = Scenario::load_case(&config.run.subject.scenario, config.run.subject.case.as_deref())?;
    notices::warn(&plain)?;
    say_how_long(config, &plain);
    let counted = config.count.as_ref().map(|name| counted(&plain, name)).transpose()?;
    let scenario = &plain;
    let names: Vec<SignalName> = scenario.file().signals.keys().cloned().collect();
    let mut all: Vec<Vec<Run>> = Vec::new();
    for Way { mode, gain_pct } in WAYS {
        let mut scenario = plain.clone();
        if let Some(gain_pct) = gain_pct {
            scenario.follow_with(gain_pct);
        }
        let run = RunConfig {
            mode,
            seed: config.run.seed.filter(|_| mode != Mode::Lockstep),
            picture: Picture {
                drawing: Drawing::Kept,
                signals: names.iter().map(SignalPattern::from).collect(),
                ..config.run.picture.clone()
            },
            ..config.run.clone()
        };
        run.check(&scenario)?;
        let mut runs = Vec::new();
        for number in 1..=config.run.runs {
            let Ran { report, samples, errors_ns, .. } = one_run(&run, &scenario, number, interrupt, Vec::new())?;
            if let Some(error) = &report.error {
                return Err(Usage::new(format!("{}: {error}", mode.name()), None).into());
            }
            let digest = report.digest.map_or_else(String::new, |digest| digest.to_string());
            runs.push(Run {
                digest,
                samples,
                errors_ns,
                steps_per_s: report.steps.0 as f64 / report.wall_time_s.max(1e-9),
            });
            if interrupt.is_raised() {
                return Err(Usage::new("stopped before there was anything to compare", None).into());
            }
        }
        all.push(runs);
    }
    let types: Vec<SignalType> = scenario.file().signals.values().map(|signal| signal.get_ref().ty).collect();
    let mut rows: Vec<Row> =
        WAYS.iter().zip(&all).map(|(way, runs)| row(way.mode, runs, &all[0][0].samples, &types)).collect();
    for ((row, way), runs) in rows.iter_mut().zip(WAYS).zip(&all) {
        row.counted = counted.map(|index| times_true(runs, index));
        if way.mode == Mode::Follow {
            row.gain_pct = Some(way.gain_pct.unwrap_or(scenario.file().freewheel.synchronizer_gain_pct));
            row.errors_ms = runs[0].errors_ns.iter().map(|ns| *ns as f64 / 1e6).collect();
        }
    }
    let mut not_there = None;
    if let Some(path) = &config.plot {
        let (svg, nothing) = drawn(&plot(&config.run.picture, scenario, &all), &config.run.picture);
        file::write_output(path, svg.as_bytes())?;
        not_there = nothing;
    }
    write(&rows, config.format, out).map_err(OutputError)?;
    not_there.map_or(Ok(rows), |nothing| Err(nothing.into()))
}

fn row(mode: Mode, runs: &[Run], lockstep: &Samples, types: &[SignalType]) -> Row {
    let mut digests: Vec<&str> = runs.iter().map(|run| run.digest.as_str()).collect();
    digests.sort_unstable();
    digests.dedup();
    let (mut deviation, mut deviating) = (0.0, None);
    let (mut edges, mut lost, mut offsets) = (0, 0, Vec::new());
    for (index, ty) in types.iter().enumerate() {
        let analog = matches!(*ty, SignalType::REAL | SignalType::LREAL);
        for run in runs {
            if analog {
                let found = distance(&lockstep.values[index], &run.samples.values[index]);
                if found > deviation {
                    (deviation, deviating) = (found, Some(lockstep.names[index].to_string()));
                }
                continue;
            }
            let (ours, theirs) = (edges_of(lockstep, index), edges_of(&run.samples, index));
            edges += ours.len();
            lost += ours.len().saturating_sub(theirs.len());
            offsets.extend(ours.iter().zip(&theirs).map(|(a, b)| (*b as f64 - *a as f64) / 1e6));
        }
    }
    let count = runs.len().max(1);
    let mean = |values: &[f64]| if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 };
    let rates: Vec<f64> = runs.iter().map(|run| run.steps_per_s).collect();
    Row {
        mode,
        runs: runs.len(),
        digests: digests.len(),
        deviation,
        deviating,
        offset_ms: mean(&offsets),
        lost_edges: lost as f64 / count as f64,
        edges: edges / count,
        counted: None,
        gain_pct: None,
        errors_ms: Vec::new(),
        steps_per_s: mean(&rates),
    }
}

/// The column of a signal that is counted.
fn counted(scenario: &Scenario, name: &SignalName) -> Result<usize, Usage> {
    let mut known = scenario.file().signals.keys();
    known.position(|signal| signal == name).ok_or_else(|| {
        let names = scenario.file().signals.keys().map(SignalName::as_str);
        Usage::new(format!("there is no signal `{name}` to count"), onescan_base::did_you_mean(name.as_str(), names))
    })
}

/// How often a signal comes true, on average of the runs.
fn times_true(runs: &[Run], index: usize) -> f64 {
    let of_run =
        |run: &Run| run.samples.values[index].windows(2).filter(|pair| pair[0] == 0.0 && pair[1] != 0.0).count();
    runs.iter().map(of_run).sum::<usize>() as f64 / runs.len().max(1) as f64
}

/// The mean size of the errors in the second half of a run, ms: what is left of them.
fn left_ms(errors_ms: &[f64]) -> f64 {
    let late = &errors_ms[errors_ms.len() / 2..];
    late.iter().map(|error| error.abs()).sum::<f64>() / late.len().max(1) as f64
}

/// The largest distance of two trajectories, as a part of the first one's range.
fn distance(ours: &[f64], theirs: &[f64]) -> f64 {
    let (low, high) =
        ours.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
    let largest = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if high > low { largest / (high - low) } else { 0.0 }
}

/// When a signal that jumps has changed.
fn edges_of(samples: &Samples, index: usize) -> Vec<u64> {
    let values = &samples.values[index];
    let changed = |k: &usize| values[*k] != values[*k - 1];
    (1..values.len()).filter(changed).map(|k| samples.t_ns[k]).collect()
}

/// One run of each mode over each other.
fn plot(picture: &Picture, scenario: &Scenario, all: &[Vec<Run>]) -> Plot {
    let first = |runs: &'_ [Run]| runs.first().map(|run| run.samples.clone()).unwrap_or_default();
    let samples: Vec<Samples> = all.iter().map(|runs| first(runs)).collect();
    let names = picture.plane.as_ref().map_or_else(|| picture.plotted(scenario), |plane| plane.to_vec());
    Plot {
        title: format!("{}: lockstep and the other ways", scenario.name()),
        runs: WAYS.iter().map(|way| way.name()).collect(),
        panels: names.iter().map(|name| panel(scenario, name, samples.iter())).collect(),
        marks: Vec::new(),
    }
}

fn write(rows: &[Row], format: Format, out: &mut dyn Write) -> std::io::Result<()> {
    if format == Format::Json {
        for row in rows {
            serde_json::to_writer(&mut *out, row)?;
            writeln!(out)?;
        }
        return out.flush();
    }
    writeln!(out, "mode        runs  digests  deviation  time offset  lost edges     steps/s")?;
    for (row, way) in rows.iter().zip(WAYS) {
        let (mode, lost) = (way.name(), format!("{:.1} of {}", row.lost_edges, row.edges));
        writeln!(
            out,
            "{mode:10}  {:4}  {:7}  {:7.2} %  {:+8.1} ms  {lost:>10}  {:10.0}",
            row.runs,
            row.digests,
            row.deviation * 100.0,
            row.offset_ms,
            row.steps_per_s
        )?;
    }
    for (row, way) in rows.iter().zip(WAYS) {
        if let Some(counted) = row.counted {
            writeln!(out, "{}: counted {counted:.1} times", way.name())?;
        }
        if let Some(gain_pct) = row.gain_pct.filter(|_| !row.errors_ms.is_empty()) {
            let first: Vec<String> = row.errors_ms.iter().take(ERRORS_SHOWN).map(|ms| format!("{ms:+.0}")).collect();
            let (count, left) = (row.errors_ms.len(), left_ms(&row.errors_ms));
            let errors = first.join(", ");
            writeln!(
                out,
                "{}: gain {gain_pct} %, {count} communications; the plant is behind by {errors} ms …; {left:.1} ms in the mean of \
                 the second half",
                way.name()
            )?;
        }
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(digest: &str, level: &[f64], flag: &[f64]) -> Run {
        let names = ["level", "flag"].map(|name| SignalName::new(name).unwrap()).to_vec();
        let t_ns = (0..level.len() as u64).map(|k| k * 10_000_000).collect();
        let samples = Samples { names, t_ns, values: vec![level.to_vec(), flag.to_vec()] };
        Run { digest: digest.to_owned(), samples, errors_ns: Vec::new(), steps_per_s: 100.0 }
    }

    #[test]
    fn what_free_wheeling_costs_is_counted() {
        let types = [SignalType::LREAL, SignalType::BOOL];
        let lockstep = run("a", &[0.0, 1.0, 2.0, 4.0], &[0.0, 1.0, 0.0, 1.0]);
        let same =
            row(Mode::Lockstep, &[run("a", &[0.0, 1.0, 2.0, 4.0], &[0.0, 1.0, 0.0, 1.0])], &lockstep.samples, &types);
        assert_eq!((same.digests, same.deviation, same.offset_ms, same.lost_edges, same.edges), (1, 0.0, 0.0, 0.0, 3));
        let others = [
            run("b", &[0.0, 0.0, 2.0, 4.0], &[0.0, 0.0, 1.0, 1.0]),
            run("c", &[0.0, 1.0, 2.0, 2.0], &[0.0, 1.0, 0.0, 1.0]),
        ];
        let free = row(Mode::Freewheel, &others, &lockstep.samples, &types);
        assert_eq!((free.digests, free.deviating.as_deref()), (2, Some("level")));
        // 2 of 4; one edge of four is 10 ms late; two of three are missing in one of two runs.
        assert_eq!((free.deviation, free.offset_ms, free.lost_edges), (0.5, 2.5, 1.0));
    }
}
