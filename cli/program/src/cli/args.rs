//! What may be typed, and who does it.

use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{ArgAction, CommandFactory, FromArgMatches as _, Parser, Subcommand};

use onescan_scenario::permission::Permission;

use super::access::{CertificateArgs, TokenArgs};
use super::campaign::{CampaignArgs, CampaignWorkerArgs};
use super::compare::CompareArgs;
use super::doctor::DoctorArgs;
use super::error::CommandError;
use super::explore::ExploreArgs;
use super::falsify::FalsifyArgs;
use super::grade::{GradeArgs, GradeWorkerArgs};
use super::manual::{CompletionsArgs, HelpArgs, ManArgs};
use super::minimise::MinimiseArgs;
use super::model::ModelArgs;
use super::mutate::MutateArgs;
use super::plant::{ComponentsArgs, DescribeArgs, EditArgs, NewArgs, ShowArgs, TemplatesArgs, WiringArgs};
use super::plc::{BrowseArgs, MapArgs, PlcArgs};
use super::recording::{BisectArgs, DiffArgs, ExportArgs, ReportArgs, ViewArgs};
use super::run::RunArgs;
use super::session::{ControlArgs, JoinArgs};
use super::shot::ShotArgs;
use super::source::{CheckArgs, ExplainArgs, InstrumentArgs};
use super::test::{ReviewArgs, TestArgs, WorkerArgs};
use super::train::TrainArgs;
use super::{
    access, campaign, compare, doctor, explore, falsify, grade, groups, manual, minimise, model, mutate, plant, plc,
    recording, run, session, shot, source, test, train,
};
use onescan_runner::error::ExitCode;

/// Deterministic lockstep virtual commissioning.
///
/// A PLC program and the model of its machine run against each other on one virtual clock: every scan
/// sees exactly one simulation step, and every run of a scenario gives the same bits.
#[derive(Debug, Parser)]
#[command(name = "onescan", bin_name = "onescan", version, after_help = EXIT_CODES, disable_help_subcommand = true)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Say more on standard error: -v what happens, -vv why, -vvv everything
    #[arg(short, long, action = ArgAction::Count, global = true, help_heading = ALL)]
    pub verbose: u8,
    /// Let scenarios read this file or folder, too; may be given several times [default: their own folder only]
    #[arg(long = "allow-path", env = "ONESCAN_ALLOW_PATH", hide_env_values = true, value_name = "PATH", global = true, value_delimiter = PATHS, help_heading = ALL)]
    pub allowed_paths: Vec<PathBuf>,
    /// Do not start the programs that scenarios name as `command`
    #[arg(long, env = "ONESCAN_NO_COMMANDS", hide_env_values = true, global = true, value_parser = clap::builder::FalseyValueParser::new(), action = ArgAction::SetTrue, help_heading = ALL)]
    pub no_commands: bool,
}

/// The heading of options that each command has.
const ALL: &str = "All commands";

/// Between the paths of a variable.
const PATHS: char = if cfg!(windows) { ';' } else { ':' };

/// What may be typed, with its help in groups.
pub fn program() -> clap::Command {
    Args::command().help_template(groups::template())
}

/// What was typed; ends the process where that is wrong, or only asks for help.
pub fn parsed() -> Args {
    let matches = program().get_matches_from(with_addresses_joined(std::env::args_os()));
    Args::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut program()).exit())
}

/// Joins `--web` and an address behind it: with commands whose `--web` stands alone, too, a word that is an address belongs
/// to it, and any other is a scenario.
fn with_addresses_joined(words: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut are_options = true;
    for word in words {
        let is_address = word.to_str().is_some_and(|word| word.parse::<SocketAddr>().is_ok());
        match joined.last_mut() {
            Some(last) if are_options && is_address && last == "--web" => {
                last.push("=");
                last.push(&word);
            }
            _ => {
                are_options &= word != "--";
                joined.push(word);
            }
        }
    }
    joined
}

impl Args {
    /// What scenarios may do.
    pub fn permission(&self) -> Permission {
        Permission { paths: self.allowed_paths.clone(), no_commands: self.no_commands }
    }
}

const EXIT_CODES: &str = "Exit codes:
  0  all is well
  1  a run is not what its scenario expects; runs that must be equal are not; a test failed;
     a check found warnings that are denied
  2  wrong input: options, scenario, PLC source, scene, checkpoint
  3  a client or a link failed, the PLC program stopped on a fault, or the output
     could not be written";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario and print the digest of its trajectories
    Run(Box<RunArgs>),
    /// Run a scenario in lockstep and in the other ways that are in use, and set them side by side: how far
    /// trajectories and edges are off, what is lost, how fast it is
    Compare(CompareArgs),
    /// Run all scenarios and cases, and hold them against their reviewed snapshots; run test programs in ST
    Test(Box<TestArgs>),
    /// Try every fault of a campaign with every activation, and report a verdict for each: detected by the control,
    /// safe, missed, collision, without effect
    Campaign(CampaignArgs),
    /// Try every timing that a scenario's `[timing]` allows: edges that are late, one at a time, then two, and show the
    /// fewest with which it does not do what is expected
    Explore(ExploreArgs),
    /// Search the inputs and parameters that a scenario's `[falsify]` allows for some with which it does not do what is
    /// expected
    Falsify(FalsifyArgs),
    /// Leave out of a failing case what it does not need to fail, and make the rest as small and as early as it can be
    Minimise(MinimiseArgs),
    /// Make small mistakes in the PLC's program, one at a time, and show which ones no expectation notices
    Mutate(MutateArgs),
    /// Let somebody take a lesson: malfunctions at the panels of a page, the times until they are identified and acted
    /// upon, and what an expert made of them
    Train(Box<TrainArgs>),
    /// Draw the machine at one virtual time as a picture, as its page shows it; needs a Chromium
    Shot(ShotArgs),
    /// One run, for `campaign`
    #[command(hide = true)]
    CampaignWorker(CampaignWorkerArgs),
    /// Look at snapshots that are new or have changed, and accept or reject them
    Review(ReviewArgs),
    /// One test, for `test`
    #[command(hide = true)]
    TestWorker(WorkerArgs),
    /// Mark programs that were handed in for a task: each runs in every case, in a process with limits
    Grade(Box<GradeArgs>),
    /// One submission, for `grade`
    #[command(hide = true)]
    GradeWorker(GradeWorkerArgs),
    /// Ends the processes of a session that cannot do so itself
    #[command(hide = true)]
    Guard,
    /// Take part in a session that another process serves, as one client of a scenario
    Join(JoinArgs),
    /// Ask a running session (see `run --listen`) how it is, or to pause, step, go on, reset or stop
    Control(ControlArgs),
    /// Make, list and revoke the tokens with which others take part in sessions over a network (`run --access`)
    Token(TokenArgs),
    /// Make the certificate of sessions over a network; revoke those of clients
    Certificate(CertificateArgs),
    /// Write a recording's trajectory as CSV, Parquet or MCAP
    Export(ExportArgs),
    /// Compare two recordings: where they first differ, in which signals, and which statement wrote them
    Diff(DiffArgs),
    /// Show a recording as a page in a browser: it is run again from its own files, and its digest checked on the way
    View(ViewArgs),
    /// Report what recorded runs produced: counts, throughput, cycle times, down time by cause, alarms, as their
    /// scenario's `[report]` asks
    Report(ReportArgs),
    /// Find the commit that first changed what a scenario does, and the statement that did
    Bisect(BisectArgs),
    /// Check PLC sources without running them
    Check(CheckArgs),
    /// Make a PLC project run in lockstep on any PLC: scheduler, execution controllers and timers on virtual
    /// time are attached; or take them off again
    Instrument(Box<InstrumentArgs>),
    /// Run a soft PLC of a scenario as a process of its own: it free-wheels, serves its variables over the
    /// protocols of real PLCs, and is started and stopped by commands that are typed
    Plc(PlcArgs),
    /// List what a real PLC has, and write a mapping to start from
    Browse(BrowseArgs),
    /// Print where every signal and word lies in a real PLC: direction, address, signal, variable, type, layout number
    Map(MapArgs),
    /// List the library of components and kinds of your own, or describe one kind in full
    Components(ComponentsArgs),
    /// Print what a scene is made of: bodies, joints, components, signals
    Describe(DescribeArgs),
    /// Print and draw how the signals of a scenario connect its clients, and what is unconnected, doubly written
    /// or of unequal type
    Wiring(WiringArgs),
    /// Print a scenario with everything that it takes in from its `base`, as one file that loads to the same session
    Show(ShowArgs),
    /// Wire a scenario and build its machine in a browser of this machine; both are written into its files
    Edit(EditArgs),
    /// Write a scenario that runs at once, to begin with: a small one, a task to learn on, or one made of an I/O list
    New(NewArgs),
    /// List what `new` writes: small scenarios to begin with, and tasks to learn on
    Templates(TemplatesArgs),
    /// Show the states by which a session runs, or write them as a model for the model checker NuSMV
    Model(ModelArgs),
    /// Explain a code of `check`, with an example that is wrong and one that is right
    Explain(ExplainArgs),
    /// Report what this program has, page and OPC UA, and what it finds on this machine: browser, git, folders, ports
    Doctor(DoctorArgs),
    /// Print the help of a command, or what holds for all of them: exit codes, environment, files
    Help(HelpArgs),
    /// Print what a shell needs to complete commands and options
    Completions(CompletionsArgs),
    /// Write the manual pages, `onescan.1` and one for each command
    Man(ManArgs),
}

/// Does what was typed; `verbose` is how often somebody asked for more to be said.
///
/// # Errors
/// See [`CommandError`].
pub fn dispatch(command: Command, verbose: u8) -> Result<ExitCode, CommandError> {
    match command {
        Command::Run(args) => run::run(*args),
        Command::Compare(args) => compare::compare(args),
        Command::Test(args) => test::test(*args),
        Command::Explore(args) => explore::explore(args),
        Command::Falsify(args) => falsify::falsify(args),
        Command::Mutate(args) => mutate::mutate(args),
        Command::Minimise(args) => minimise::minimise(args),
        Command::Train(args) => train::train(*args),
        Command::Shot(args) => shot::shot(args),
        Command::Campaign(args) => campaign::campaign(args),
        Command::CampaignWorker(args) => campaign::work(args),
        Command::Review(args) => test::review(args),
        Command::TestWorker(args) => test::work(args),
        Command::Grade(args) => grade::grade(*args, verbose),
        Command::GradeWorker(args) => grade::work(args),
        Command::Guard => Ok(session::guard()),
        Command::Join(args) => session::join(&args),
        Command::Control(args) => session::control(&args),
        Command::Token(args) => access::token(args),
        Command::Certificate(args) => access::certificate(args),
        Command::Export(args) => recording::export(args),
        Command::Diff(args) => recording::diff(args),
        Command::View(args) => recording::view(args),
        Command::Report(args) => recording::report(args),
        Command::Bisect(args) => recording::bisect(args),
        Command::Check(args) => source::check(args),
        Command::Instrument(args) => source::instrument(*args),
        Command::Plc(args) => plc::run_plc(args),
        Command::Browse(args) => plc::browse(args),
        Command::Map(args) => plc::map(args),
        Command::Components(args) => plant::components(&args),
        Command::Describe(args) => plant::describe(&args),
        Command::Wiring(args) => plant::wiring(args),
        Command::Show(args) => plant::show(args),
        Command::Edit(args) => plant::edit(args),
        Command::New(args) => plant::new(args),
        Command::Templates(args) => plant::templates(&args),
        Command::Model(args) => model::model(args),
        Command::Explain(args) => source::explain(&args),
        Command::Doctor(args) => doctor::doctor(&args),
        Command::Help(args) => manual::help(&args, program()),
        Command::Completions(args) => manual::completions(&args, program()),
        Command::Man(args) => manual::man(&args, program()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_behind_web_belongs_to_it_and_another_word_does_not() {
        let joined = |typed: &str| {
            let words = with_addresses_joined(typed.split(' ').map(OsString::from));
            words.iter().map(|word| word.to_str().unwrap().to_owned()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(joined("run --web 127.0.0.1:8080 shear"), "run --web=127.0.0.1:8080 shear");
        assert_eq!(joined("run --web [::1]:80"), "run --web=[::1]:80");
        for typed in
            ["run --web shear", "run --web", "run --web=[::1]:80 shear", "run --web --stay", "run -- --web 127.0.0.1:1"]
        {
            assert_eq!(joined(typed), typed);
        }
    }

    /// clap's own checks of the arguments of each command.
    #[test]
    fn arguments_are_consistent() {
        program().debug_assert();
    }
}
