//! The tasks of this repository: its test scripts, its measures, its releases.
//!
//! | module | subject |
//! |---|---|
//! | `workspace` | members and files |
//! | `rust` | Rust sources as tokens, functions and blocks of docs |
//! | `measure` | figures about the sources and documents |
//! | `draw` | functions drawn by a seed, to be read |
//! | `scripts` | the scripts of `tests/` |
//! | `release` | what must hold for a release, and its files |

mod draw;
mod error;
mod measure;
mod release;
mod rust;
mod scripts;
mod workspace;

use std::ffi::OsString;
use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::{Parser, Subcommand, ValueEnum};

use error::TaskError;

/// The tasks of this repository
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    task: Option<Task>,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Count what the sources and documents consist of [seconds]
    Measure {
        /// A table for people, or JSON
        #[arg(long, value_enum, default_value = "markdown")]
        format: Format,
    },
    /// List functions drawn by a seed, to be read [seconds]
    Draw {
        /// The same seed draws the same functions
        #[arg(long)]
        seed: u64,
        /// Number of functions
        #[arg(long, default_value_t = 100)]
        count: usize,
    },
    /// Check what a release needs, test everything, and build its files [20 min]
    Release {
        /// Check only: neither test nor build
        #[arg(long)]
        dry_run: bool,
    },
    /// A script of `tests/`
    #[command(external_subcommand)]
    Script(Vec<OsString>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Markdown,
    Json,
}

fn main() -> ExitCode {
    let done = run(Arguments::parse().task);
    match done {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            // Nobody is left to read a failure to write this.
            drop(writeln!(io::stderr(), "cargo xtask: {error}"));
            ExitCode::from(error.exit_code())
        }
    }
}

fn run(task: Option<Task>) -> Result<u8, TaskError> {
    let root = workspace::root();
    let mut out = io::stdout().lock();
    match task {
        None => write!(out, "{OWN}{}", scripts::list())?,
        Some(Task::Measure { format }) => {
            let measured = measure::measure(&root)?;
            match format {
                Format::Markdown => write!(out, "{}", measure::table::markdown(&measured))?,
                Format::Json => {
                    serde_json::to_writer_pretty(&mut out, &measured).map_err(io::Error::from)?;
                    writeln!(out)?;
                }
            }
        }
        Some(Task::Draw { seed, count }) => {
            for function in draw::drawn(&root, seed, count)? {
                writeln!(out, "{function}")?;
            }
        }
        Some(Task::Release { dry_run }) => release::release(&root, dry_run, &mut out)?,
        Some(Task::Script(words)) => {
            // The script has the output for itself.
            drop(out);
            return scripts::run(&root, &words);
        }
    }
    Ok(0)
}

/// The tasks that are not scripts, as `--help` describes them in full.
const OWN: &str = "\
cargo xtask TASK [ARGUMENTS]; `cargo xtask TASK --help` describes one

  measure    figures about the sources and documents [seconds]
  draw       functions drawn by a seed, to be read [seconds]
  release    what a release needs: checks, tests, files [20 min]
";
