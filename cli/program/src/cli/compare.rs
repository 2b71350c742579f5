//! `onescan compare`.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_report::plot::Part;
use onescan_server::signal::SignalName;
use onescan_server::time::VirtualTime;

use super::error::CommandError;
use super::outputs;
use super::value::{FormatArg, part, plane, signal_name};
use onescan_runner::compare::CompareConfig;
use onescan_runner::error::ExitCode;
use onescan_runner::interrupt::Interrupt;
use onescan_runner::run::RunConfig;

/// Options of `compare`.
#[derive(Debug, ClapArgs)]
pub struct CompareArgs {
    /// The scenario: a folder with a `scenario.toml`
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// A case of the scenario's `cases.toml` [default: the scenario as it is]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// Virtual time at which a run is complete [default: the scenario's `until`]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// Runs of each way
    #[arg(long, default_value_t = 3, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000))]
    pub runs: u32,
    /// Compute the clocks of the ways without lockstep from this seed, the same on every machine, and take no real time
    /// (`docs/freewheel.md`)
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Count how often this signal comes true in each way, as one that reports that the PLC's checks fail
    #[arg(long, value_name = "SIGNAL", value_parser = signal_name)]
    pub count: Option<SignalName>,
    /// Draw the signals of the scenario's plot, a run of each way over each other, into this SVG file
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Draw two signals against each other, across and up, as `x.position,z.position`
    #[arg(long, value_name = "X,Y", requires = "plot", value_parser = plane)]
    pub xy: Option<[SignalName; 2]>,
    /// Draw a part of the plot enlarged beside the whole: `2s..2.5s`, or `0.9..1.2,0.3..0.5`, across and up, with `--xy`
    #[arg(long, value_name = "RANGE[,RANGE]", requires = "plot", value_parser = part, allow_hyphen_values = true)]
    pub enlarge: Option<Part>,
    /// For people, or one JSON object a way for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Sets lockstep beside the other ways.
///
/// # Errors
/// See [`CommandError`].
pub fn compare(args: CompareArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.plot])?;
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let mut run = RunConfig::headless(args.scenario, args.case);
    run.subject.until = args.until;
    run.runs = args.runs;
    run.seed = args.seed;
    run.picture.plane = args.xy;
    run.picture.enlarged = args.enlarge;
    let config = CompareConfig { run, count: args.count, plot: args.plot, format: args.format.into() };
    onescan_runner::compare::compare(&config, &interrupt, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}
