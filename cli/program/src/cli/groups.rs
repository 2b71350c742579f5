//! The commands by what they are for, one line each, as `onescan --help` shows them.

use std::fmt::Write as _;

/// A heading, and its commands with what each does.
type Group = (&'static str, &'static [(&'static str, &'static str)]);

const GROUPS: &[Group] = &[
    (
        "Begin",
        &[
            ("new", "write a scenario that runs at once, or one made of an I/O list"),
            ("templates", "list what `new` writes: beginnings, and tasks to learn on"),
            ("check", "check PLC sources without running them"),
            ("explain", "explain a code of `check`, with examples"),
            ("run", "run a scenario and print the digest of its trajectories"),
        ],
    ),
    (
        "Test",
        &[
            ("test", "run scenarios, cases, test programs; compare with snapshots"),
            ("review", "look at new and changed snapshots; accept or reject"),
            ("bisect", "find the commit and statement that changed a scenario"),
            ("grade", "mark programs that were handed in for a task"),
            ("mutate", "make small mistakes in the PLC's program: are they noticed?"),
        ],
    ),
    (
        "Search",
        &[
            ("campaign", "try every fault with every activation"),
            ("explore", "try every timing that `[timing]` allows"),
            ("falsify", "search inputs and parameters that break an expectation"),
            ("minimise", "leave out of a failing case what it does not need to fail"),
        ],
    ),
    (
        "See and operate",
        &[
            ("edit", "wire a scenario and build its machine in a browser"),
            ("train", "let somebody take a lesson at the panels of a page"),
            ("shot", "draw the machine at one virtual time, as its page shows it"),
            ("describe", "print what a scene is made of"),
            ("components", "list the library of components, or describe one"),
            ("wiring", "print how signals connect clients, and what is unconnected"),
            ("show", "print a scenario with everything of its `base`, as one file"),
        ],
    ),
    (
        "Recordings",
        &[
            ("export", "write a recording as CSV, Parquet or MCAP"),
            ("diff", "compare two recordings: where they first differ, and why"),
            ("view", "show a recording as a page in a browser"),
            ("report", "report counts, throughput, down time, alarms of runs"),
            ("compare", "set lockstep and free-wheeling runs side by side"),
        ],
    ),
    (
        "Real PLCs and other sessions",
        &[
            ("instrument", "make a PLC project run in lockstep on any PLC, or undo it"),
            ("plc", "run a soft PLC by itself, as a stand-in for a real one"),
            ("browse", "list what a real PLC has, and write a mapping"),
            ("map", "print where every signal lies in a real PLC"),
            ("join", "take part in a session that another process serves"),
            ("control", "pause, step, reset or stop a running session"),
            ("token", "make, list and revoke tokens for sessions over a network"),
            ("certificate", "make the certificate of sessions over a network"),
            ("model", "show the states of a session, or write them for NuSMV"),
        ],
    ),
    (
        "This program",
        &[
            ("help", "help on a command, or on exit-codes, verdicts, …"),
            ("doctor", "report what this program and this machine have"),
            ("completions", "print what your shell needs to complete commands"),
            ("man", "write the manual pages"),
        ],
    ),
];

/// What the help shows; clap fills in what stands in braces.
pub(super) fn template() -> String {
    let mut text = "{about-with-newline}\n{usage-heading} {usage}\n".to_owned();
    for (heading, commands) in GROUPS {
        write!(text, "\n{heading}:\n").expect("a string takes all");
        for (name, does) in *commands {
            writeln!(text, "  {name:<11}  {does}").expect("a string takes all");
        }
    }
    text + "\n`onescan COMMAND --help` describes a command.\n\nOptions:\n{options}{after-help}"
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::cli::args;

    #[test]
    fn each_command_is_in_one_group_on_one_line() {
        let program = args::program();
        let commands = program.get_subcommands().filter(|command| !command.is_hide_set());
        let wanted: BTreeSet<&str> = commands.map(clap::Command::get_name).collect();
        let listed: Vec<&str> = GROUPS.iter().flat_map(|(_, commands)| *commands).map(|(name, _)| *name).collect();
        assert_eq!((listed.len(), listed.into_iter().collect()), (wanted.len(), wanted));
        assert!(template().lines().all(|line| line.len() <= 80), "{}", template());
    }
}
