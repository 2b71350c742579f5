//! What the program says of itself: `onescan help`, `completions` and `man`.

use std::io::Write as _;
use std::path::PathBuf;

use clap::builder::StyledStr;
use clap::{Args as ClapArgs, Command, ValueEnum};
use clap_complete::Shell;
use clap_mangen::Man;
use onescan_report::file::{Write, write_all_whole};
use onescan_report::{OutputError, colour};

use super::error::CommandError;
use super::topics::{TOPICS, Topic};
use onescan_runner::error::{ExitCode, Usage};

/// Options of `help`.
#[derive(Debug, ClapArgs)]
pub struct HelpArgs {
    /// A command, or a topic: `exit-codes`, `verdicts`, `environment`, `files`
    #[arg(value_name = "COMMAND|TOPIC")]
    pub about: Option<String>,
}

/// Options of `completions`.
#[derive(Debug, ClapArgs)]
pub struct CompletionsArgs {
    /// The shell that is to complete what you type
    #[arg(value_enum)]
    pub shell: ShellArg,
}

/// A shell that completes what is typed.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ShellArg {
    /// For `source <(onescan completions bash)` in `.bashrc`
    Bash,
    /// For a file `_onescan` in a folder of `fpath`
    Zsh,
    /// For `~/.config/fish/completions/onescan.fish`
    Fish,
    /// For the profile of `PowerShell`
    Powershell,
    /// For `rc.elv`
    Elvish,
}

impl From<ShellArg> for Shell {
    fn from(shell: ShellArg) -> Self {
        match shell {
            ShellArg::Bash => Self::Bash,
            ShellArg::Zsh => Self::Zsh,
            ShellArg::Fish => Self::Fish,
            ShellArg::Powershell => Self::PowerShell,
            ShellArg::Elvish => Self::Elvish,
        }
    }
}

/// Options of `man`.
#[derive(Debug, ClapArgs)]
pub struct ManArgs {
    /// The folder that gets `onescan.1` and a page for each command
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Prints the help of the program, of a command, or of a topic.
///
/// # Errors
/// There is neither a command nor a topic of this name.
pub fn help(args: &HelpArgs, mut program: Command) -> Result<ExitCode, CommandError> {
    program.build();
    let Some(name) = &args.about else { return print(&program.render_long_help()) };
    if let Some(command) = program.find_subcommand_mut(name) {
        return print(&command.render_long_help());
    }
    let Some(topic) = TOPICS.iter().find(|topic| topic.name == name.as_str()) else {
        let names: Vec<&str> = TOPICS.iter().map(|topic| topic.name).collect();
        let help = format!("the topics are {}; `onescan help` lists the commands", names.join(", "));
        return Err(Usage::new(format!("`{name}` is not a command or topic"), Some(help)).into());
    };
    write(topic.text().as_bytes())
}

/// Prints what a shell reads to complete the program's arguments.
///
/// # Errors
/// It cannot be written.
pub fn completions(args: &CompletionsArgs, mut program: Command) -> Result<ExitCode, CommandError> {
    let mut text = Vec::new();
    clap_complete::generate(Shell::from(args.shell), &mut program, "onescan", &mut text);
    write(&text)
}

/// Writes the manual pages.
///
/// # Errors
/// A file cannot be written.
pub fn man(args: &ManArgs, mut program: Command) -> Result<ExitCode, CommandError> {
    program.build();
    let commands = program.get_subcommands().filter(|command| !command.is_hide_set());
    let mut pages = Vec::new();
    for command in commands {
        let name = format!("onescan-{}", command.get_name());
        pages.push((format!("{name}.1"), page(command.clone(), &[])?));
    }
    pages.insert(0, ("onescan.1".to_owned(), page(program, TOPICS)?));
    let files: Vec<Write> =
        pages.into_iter().map(|(file, page)| Write { path: args.output.join(file), bytes: Some(page) }).collect();
    write_all_whole(&files)?;
    write(format!("wrote {} manual pages to {}\n", files.len(), args.output.display()).as_bytes())
}

/// A manual page in roff, with topics at its end.
fn page(command: Command, topics: &[Topic]) -> Result<Vec<u8>, OutputError> {
    let mut text = Vec::new();
    // without a date: the same program gives the same bytes
    let man = Man::new(command).source(concat!("onescan ", env!("CARGO_PKG_VERSION"))).manual("onescan");
    man.render(&mut text).map_err(OutputError)?;
    for topic in topics {
        text.extend_from_slice(topic.roff().as_bytes());
    }
    Ok(text)
}

/// As the terminal takes it: in colours, or without.
fn print(help: &StyledStr) -> Result<ExitCode, CommandError> {
    let text = if colour::suits(&std::io::stdout()) { help.ansi().to_string() } else { help.to_string() };
    write(text.as_bytes())
}

fn write(text: &[u8]) -> Result<ExitCode, CommandError> {
    std::io::stdout().lock().write_all(text).map_err(OutputError)?;
    Ok(ExitCode::Ok)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args;

    #[test]
    fn completions_know_each_command_of_the_help() {
        let mut text = Vec::new();
        clap_complete::generate(Shell::Bash, &mut args::program(), "onescan", &mut text);
        let text = String::from_utf8(text).unwrap();
        for command in args::program().get_subcommands().filter(|command| !command.is_hide_set()) {
            assert!(text.contains(&format!("onescan,{})", command.get_name())), "{}", command.get_name());
        }
    }

    #[test]
    fn manual_pages_are_equal_each_time_and_name_their_options() {
        let folder = tempfile::tempdir().unwrap();
        let written = |name: &str| {
            let output = folder.path().join(name);
            man(&ManArgs { output: output.clone() }, args::program()).unwrap();
            let text = |file: &str| std::fs::read_to_string(output.join(file)).unwrap();
            (text("onescan.1"), text("onescan-run.1"))
        };
        let (program, run) = written("first");
        assert_eq!((program.clone(), run.clone()), written("second"));
        assert!(program.contains(".TH onescan 1") && program.contains(".SH \"EXIT CODES\""), "{program}");
        assert!(run.contains(".TH onescan-run 1") && run.contains("\\-\\-record"), "{run}");
    }
}
