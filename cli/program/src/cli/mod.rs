//! The command line: arguments to plain configurations, errors to exit codes. No logic of its own.
//!
//! | module | subject |
//! |---|---|
//! | [`args`] | the commands, and who does them |
//! | [`run`], [`compare`] | a scenario |
//! | [`campaign`] | faults by campaigns |
//! | [`explore`] | timings that links may have |
//! | [`falsify`] | inputs and parameters that break what is expected |
//! | [`mutate`] | small mistakes in programs |
//! | [`shot`] | the machine at one time as a picture |
//! | [`minimise`] | the least of a case that still fails |
//! | [`train`] | lessons |
//! | [`test`] | all scenarios, and test programs |
//! | [`grade`] | programs that were handed in |
//! | [`session`] | a session that another process serves |
//! | [`recording`] | what was recorded |
//! | [`source`] | PLC sources |
//! | [`plc`] | PLCs |
//! | [`access`] | who may take part: tokens, certificates |
//! | [`opcua`] | who is let in over OPC UA |
//! | [`plant`] | scenes |
//! | [`model`] | the states of a session |
//! | [`doctor`] | what there is on this machine |
//! | [`manual`] | help, completions, manual pages |
//! | `groups`, `topics` | the commands by what they are for; what holds for all of them |
//! | `outputs` | what is to be written, looked at before |
//! | `verdict_output` | standard output of a command whose exit code is a verdict |
//! | [`value`] | words that several commands know |

pub mod access;
pub mod args;
pub mod campaign;
pub mod compare;
pub mod doctor;
mod error;
pub mod explore;
pub mod falsify;
pub mod grade;
mod groups;
mod log_writer;
mod logging;
pub mod manual;
pub mod minimise;
pub mod model;
pub mod mutate;
pub mod opcua;
mod outputs;
pub mod plant;
pub mod plc;
pub mod recording;
pub mod run;
pub mod session;
pub mod shot;
pub mod source;
pub mod test;
mod topics;
pub mod train;
pub mod value;
mod verdict_output;

use std::io::Write;

use onescan_base::foreign::for_terminal;
use onescan_report::{OutputError, colour};
use textwrap::{WordSeparator, WordSplitter};

pub use error::CommandError;

use onescan_runner::error::{Exit, ExitCode};
use onescan_runner::interrupt;

/// Runs the program with the process's arguments.
pub fn main() -> std::process::ExitCode {
    let args = args::parsed();
    logging::start(args.verbose);
    colour::show(colour::suits(&std::io::stdout()));
    onescan_runner::job::hold_what_is_started();
    onescan_scenario::permission::grant(args.permission());
    #[cfg(feature = "opcua")]
    onescan_opc_ua::install();
    render_errors_in_one_piece();
    let done = args::dispatch(args.command, args.verbose).and_then(flushed);
    let code = match done {
        Ok(code) => code,
        Err(error) => {
            let code = error.exit_code();
            if code != ExitCode::Ok {
                report(error);
            }
            code
        }
    };
    // One that was asked to end has not come to its end, whatever there is of it.
    std::process::ExitCode::from(interrupt::exit_code().unwrap_or(code as u8))
}

/// What is still buffered must not be lost in silence when the process ends. A reader that has left changes nothing.
fn flushed(code: ExitCode) -> Result<ExitCode, CommandError> {
    match std::io::stdout().flush().map_err(OutputError) {
        Err(error) if !error.is_closed_pipe() => Err(error.into()),
        _ => Ok(code),
    }
}

/// Errors go to standard error, with the place in the source where there is one.
fn report(error: CommandError) {
    // Where standard error takes nothing either, the exit code still says it.
    let _ = writeln!(std::io::stderr(), "{}", for_terminal(&format!("{:?}", miette::Report::new(error))));
}

/// Messages of this program hold their causes, so that they read well anywhere; a list of causes
/// behind them would say all of it again.
fn render_errors_in_one_piece() {
    // Names are there to be copied: lines end at blanks, and not at a hyphen or within a name.
    let handler = || {
        miette::MietteHandlerOpts::new()
            .without_cause_chain()
            .break_words(false)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation)
            .build()
    };
    // Only a second call fails, and this is the only one.
    let _ = miette::set_hook(Box::new(move |_| Box::new(handler())));
}
