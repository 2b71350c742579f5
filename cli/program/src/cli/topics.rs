//! What holds for all commands, for `onescan help TOPIC` and the manual page.

use std::fmt::Write as _;

/// A topic of the help.
#[derive(Debug)]
pub(super) struct Topic {
    /// The word behind `onescan help`.
    pub(super) name: &'static str,
    /// Over the entries, in capitals on the manual page.
    title: &'static str,
    /// Each with what it means.
    entries: &'static [(&'static str, &'static str)],
}

/// All topics, in the order of the manual page.
pub(super) const TOPICS: &[Topic] = &[
    Topic {
        name: "exit-codes",
        title: "Exit codes",
        entries: &[
            ("0", "all is well"),
            (
                "1",
                "a run violates an expectation, runs that must be equal differ, a test failed, or a check found \
                   warnings that are denied",
            ),
            ("2", "wrong input: options, scenario, PLC source, scene, checkpoint"),
            ("3", "a client or a link failed, the PLC stopped on a fault, or the output could not be written"),
            ("130, 143, 129", "Ctrl-C, SIGTERM or SIGHUP ended it"),
        ],
    },
    Topic {
        name: "verdicts",
        title: "Verdicts",
        entries: &[
            ("met", "the run showed what was expected, and nothing that comes later can change it"),
            ("open", "the run ended before it could be decided"),
            ("violated", "the run did not show it; the first time at which that is certain stands beside it"),
            (
                "margin",
                "how far the run was from another verdict at its tightest, in the unit of the signals: 0 is met, exactly \
                   at the limit, and less than 0 is violated by so much",
            ),
        ],
    },
    Topic {
        name: "environment",
        title: "Environment",
        entries: &[
            ("ONESCAN_ALLOW_PATH", "files and folders that scenarios may read, as `--allow-path`"),
            ("ONESCAN_NO_COMMANDS", "start no programs that scenarios name, as `--no-commands`"),
            ("ONESCAN_LOG", "what is logged on standard error, as in `onescan_runner=debug`; `-v` says it in general"),
            ("ONESCAN_TOKEN", "the token with which you take part in a session over a network"),
            ("ONESCAN_TLS_CA", "the certificate that signs the session's"),
            ("ONESCAN_TLS_CERT, ONESCAN_TLS_KEY", "your own certificate and its key"),
            ("ONESCAN_OPCUA_PASSWORD", "the password of a user of OPC UA"),
            ("CHROMIUM", "the browser that draws for `onescan shot`"),
            ("CI", "CI servers set it: `onescan test` then says on standard error when each test ends"),
            ("GITHUB_STEP_SUMMARY", "the page of a job, to which `onescan test --format github` adds a table"),
            ("NO_COLOR", "no colours on a terminal"),
        ],
    },
    Topic {
        name: "files",
        title: "Files",
        entries: &[
            ("scenario.toml", "a scenario: signals, clients, expectations"),
            ("plant.toml", "a scene: bodies, joints, components"),
            ("cases.toml", "the cases of a scenario"),
            ("lessons.toml", "what operators are trained in"),
            ("snapshots/*.traj", "what was reviewed: keep it in your repository"),
            ("snapshots/*.traj.new", "what waits for `onescan review`: do not keep it"),
            ("libraries/", "libraries and stubs that the PLC project beside it uses"),
        ],
    },
];

impl Topic {
    /// For a terminal of 80 columns.
    pub(super) fn text(&self) -> String {
        let width = self.entries.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        let mut text = format!("{}:\n", self.title);
        for (name, meaning) in self.entries {
            let mut column = 2 + width;
            write!(text, "  {name:<width$} ").expect("a string takes all");
            for word in meaning.split(' ') {
                if column + 1 + word.len() >= 80 {
                    write!(text, "\n{:1$}", "", width + 3).expect("a string takes all");
                    column = 2 + width;
                }
                write!(text, " {word}").expect("a string takes all");
                column += 1 + word.len();
            }
            text.push('\n');
        }
        text
    }

    /// A section of a manual page.
    pub(super) fn roff(&self) -> String {
        let escaped = |text: &str| text.replace('\\', "\\\\").replace('-', "\\-");
        let mut text = format!(".SH \"{}\"\n", self.title.to_uppercase());
        for (name, meaning) in self.entries {
            writeln!(text, ".TP\n{}\n{}", escaped(name), escaped(meaning)).expect("a string takes all");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_a_terminal() {
        for topic in TOPICS {
            let text = topic.text();
            assert!(text.lines().all(|line| line.len() <= 80 && line.trim_end() == line), "{text}");
        }
    }
}
