//! The scripts of `tests/`, behind one door: `cargo xtask NAME`.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use crate::error::TaskError;

/// A script of the repository.
#[derive(Debug)]
pub(crate) struct Script {
    /// What is typed.
    pub(crate) name: &'static str,
    /// Its file, from the root of the repository.
    file: &'static str,
    language: Language,
    about: &'static str,
    /// How long it takes on two cores, once everything is built.
    time: &'static str,
    /// Why it cannot run on Windows, if it cannot.
    not_on_windows: Option<&'static str>,
}

#[derive(Debug, Clone, Copy)]
enum Language {
    Bash,
    Python,
}

/// In the order in which somebody who changes something needs them.
pub(crate) const SCRIPTS: &[Script] = &[
    Script {
        name: "run",
        file: "tests/run",
        language: Language::Bash,
        about: "what must pass before a change is merged; `run quick` for the tests beside the code",
        time: "15 min; quick: 2 min",
        not_on_windows: None,
    },
    Script {
        name: "web",
        file: "tests/web",
        language: Language::Bash,
        about: "the page: types, units, licences, and a session in Chromium",
        time: "minutes",
        not_on_windows: None,
    },
    Script {
        name: "mutants",
        file: "tests/mutants",
        language: Language::Python,
        about: "small faults in PLC programs that the scenarios' cases must find",
        time: "many minutes, by `--each`",
        not_on_windows: None,
    },
    Script {
        name: "mutate",
        file: "tests/mutate",
        language: Language::Python,
        about: "seeded changes of files and frames: exit codes, panics, time, memory",
        time: "minutes",
        not_on_windows: Some("it limits memory with `setrlimit`"),
    },
    Script {
        name: "fuzz",
        file: "tests/fuzz",
        language: Language::Bash,
        about: "every parser of bytes from outside, led by coverage",
        time: "as `--for` says, per target",
        not_on_windows: Some("the compiler's wrapper is a shell script; use `cargo test -p onescan-fuzz`"),
    },
    Script {
        name: "kill",
        file: "tests/kill",
        language: Language::Python,
        about: "`kill -9` of a session: which processes are left, what its recording loses",
        time: "minutes",
        not_on_windows: Some("it looks for processes in /proc"),
    },
    Script {
        name: "attack",
        file: "tests/attack/run",
        language: Language::Python,
        about: "thousands of strangers at each listener: digests, memory, answers, descriptors, the log",
        time: "15 min, by `--seconds`",
        not_on_windows: Some("it looks at processes in /proc"),
    },
    Script {
        name: "long",
        file: "tests/long",
        language: Language::Python,
        about: "the shear for a million steps or more: memory and digests",
        time: "minutes; 10^8 steps: hours",
        not_on_windows: Some("it reads memory from /proc"),
    },
    Script {
        name: "futures",
        file: "tests/futures",
        language: Language::Python,
        about: "what forks save, and searches that are killed and continued",
        time: "15 min",
        not_on_windows: Some("it measures processor time with `getrusage`"),
    },
    Script {
        name: "falsify",
        file: "tests/falsify/compare",
        language: Language::Python,
        about: "onescan falsify compared with psy-taliro on benchmark models",
        time: "1 h",
        not_on_windows: Some("it expects the environment of Python in `bin`"),
    },
    Script {
        name: "foreign",
        file: "tests/foreign/compare",
        language: Language::Python,
        about: "test suites of other compilers and whole foreign projects, from a folder that you fetched",
        time: "minutes per suite",
        not_on_windows: None,
    },
    Script {
        name: "twins",
        file: "tests/twins/compare",
        language: Language::Python,
        about: "random scenes run by onescan and MuJoCo and compared; what differs is made small",
        time: "1 s per scene",
        not_on_windows: Some("it expects the environment of Python in `bin`"),
    },
    Script {
        name: "simulation-mutants",
        file: "tests/simulation/mutants",
        language: Language::Python,
        about: "small mistakes in lobby, listeners and recordings: do the histories of `tests/simulation` notice them?",
        time: "15 min",
        not_on_windows: None,
    },
    Script {
        name: "matiec",
        file: "tests/matiec",
        language: Language::Python,
        about: "the machines to learn on behind MatIEC's program: the soft PLC's digests (needs MatIEC and gcc)",
        time: "10 min",
        not_on_windows: Some("it needs MatIEC and gcc"),
    },
    Script {
        name: "learn",
        file: "tests/learn",
        language: Language::Python,
        about: "wrong programs for the machines to learn on, graded: does each report name the line of the mistake?",
        time: "4 s per program",
        not_on_windows: None,
    },
    Script {
        name: "robots",
        file: "tests/robots/compare",
        language: Language::Python,
        about: "robots' files of publishers, from a folder that you fetched, compared with Pinocchio and MuJoCo",
        time: "1 s per file",
        not_on_windows: Some("it expects the environment of Python in `bin`"),
    },
    Script {
        name: "tutorials",
        file: "tests/tutorials",
        language: Language::Python,
        about: "docs/tutorials typed in empty folders; `--update` puts what came into the documents",
        time: "1 min",
        not_on_windows: Some("it types into bash"),
    },
    Script {
        name: "site",
        file: "docs/site/make",
        language: Language::Python,
        about: "the documents as a site in target/site/book, every link followed",
        time: "seconds",
        not_on_windows: Some("it expects the environment of Python in `bin`"),
    },
    Script {
        name: "dist",
        file: "tests/dist/make",
        language: Language::Python,
        about: "the files of a release: wheel, archive, Debian package, crates; `--try` uses them where there is no Rust",
        time: "a build; packing: 1 min",
        not_on_windows: Some("it builds for Windows on Linux"),
    },
    Script {
        name: "platforms",
        file: "tests/platforms",
        language: Language::Bash,
        about: "equal digests on 64-bit Arm (qemu) and Windows (Wine)",
        time: "a build and minutes per platform",
        not_on_windows: Some("it builds on Linux and emulates the other platforms"),
    },
];

/// One line per script, for people.
pub(crate) fn list() -> String {
    let mut text = String::new();
    for script in SCRIPTS {
        let here = if cfg!(windows) && script.not_on_windows.is_some() { " (not on Windows)" } else { "" };
        writeln!(text, "  {:<10} {}{here} [{}]", script.name, script.about, script.time).expect("a string takes all");
    }
    text
}

/// Runs the script of this name and returns its exit code.
///
/// # Errors
/// There is no such script, it cannot run on this system, or it does not start.
pub(crate) fn run(root: &Path, words: &[OsString]) -> Result<u8, TaskError> {
    let (name, arguments) = match words.split_first() {
        Some((name, arguments)) => (name.to_string_lossy().into_owned(), arguments),
        None => return Err(TaskError::Unknown(String::new())),
    };
    let found = SCRIPTS.iter().find(|script| script.name == name);
    let script = found.ok_or(TaskError::Unknown(name))?;
    if let Some(reason) = script.not_on_windows.filter(|_| cfg!(windows)) {
        return Err(TaskError::Windows { name: script.name, reason });
    }
    let file = root.join(script.file);
    // Windows does not read the first line of a script, which names its interpreter.
    let mut command = match (cfg!(windows), script.language) {
        (false, _) => Command::new(&file),
        (true, Language::Bash) => interpreted("bash", &file),
        (true, Language::Python) => interpreted("python", &file),
    };
    // The caller's folder stays: arguments may be paths in it.
    let status = command.args(arguments).status();
    let program = command.get_program().to_string_lossy().into_owned();
    let status = status.map_err(|source| TaskError::NotStarted { program, source })?;
    // A script that a signal ended has no code.
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1))
}

fn interpreted(interpreter: &str, file: &Path) -> Command {
    let mut command = Command::new(interpreter);
    command.arg(file);
    command
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::root;

    #[test]
    fn every_script_is_there() {
        for script in SCRIPTS {
            let text = std::fs::read_to_string(root().join(script.file)).unwrap();
            let interpreter = match script.language {
                Language::Bash => "bash",
                Language::Python => "python3",
            };
            assert_eq!(text.lines().next(), Some(format!("#!/usr/bin/env {interpreter}").as_str()), "{}", script.name);
        }
    }

    #[test]
    fn every_script_of_the_tests_has_a_name_here() {
        for entry in std::fs::read_dir(root().join("tests")).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() && path.extension().is_none() {
                let file = path.strip_prefix(root()).unwrap();
                assert!(SCRIPTS.iter().any(|script| Path::new(script.file) == file), "{}", file.display());
            }
        }
    }

    #[test]
    fn another_name_is_wrong_input() {
        let error = run(&root(), &["walk".into()]).unwrap_err();
        assert_eq!((error.exit_code(), error.to_string().contains("`walk`")), (2, true));
    }
}
