//! `onescan doctor`: what this program has, and what it finds on this machine.
//!
//! | module | subject |
//! |---|---|
//! | [`finding`] | one thing that was looked at |
//! | `places` | folders, ports and descriptors |
//!
//! It looks and starts nothing: a program that it names is one on the `PATH`, whatever it does when it runs.

mod finding;
mod places;

use std::ffi::OsStr;
use std::io::{self, Write};

use onescan_report::OutputError;

pub use finding::{Finding, State};

use crate::environment;
use crate::error::ExitCode;
use crate::format::Format;
use crate::shot;
use crate::web::Page;

/// What the one who built the program has put into it.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// Its version, as in `0.2.0`.
    pub version: &'static str,
    /// Whether it speaks OPC UA.
    pub has_opcua: bool,
}

/// Looks at all of it, and reports it.
///
/// # Errors
/// It cannot be written.
pub fn run(build: Build, format: Format, out: &mut dyn Write) -> Result<ExitCode, OutputError> {
    let findings = examined(build);
    match format {
        Format::Human => write_table(&findings, out).map_err(OutputError)?,
        Format::Json => serde_json::to_writer(&mut *out, &findings)
            .map_err(io::Error::from)
            .and_then(|()| writeln!(out))
            .map_err(OutputError)?,
    }
    let is_wrong = findings.iter().any(|finding| finding.state == State::Wrong);
    Ok(if is_wrong { ExitCode::Fault } else { ExitCode::Ok })
}

fn examined(build: Build) -> Vec<Finding> {
    let platform = format!("onescan {} for {} on {}", build.version, std::env::consts::OS, std::env::consts::ARCH);
    let mut findings = vec![Finding::ok("program", platform), page(), opcua(build.has_opcua), browser()];
    findings.extend(PROGRAMS.iter().map(|(subject, names, help)| program(subject, names, help)));
    findings.extend(places::examined());
    findings
}

fn page() -> Finding {
    match Page::is_absent() {
        Some(how) => Finding::missing("page", "not in this program", how),
        None => Finding::ok("page", format!("in this program, {} kB", Page::size() / 1000)),
    }
}

fn opcua(has_opcua: bool) -> Finding {
    if has_opcua {
        return Finding::ok("OPC UA", "in this program");
    }
    let help =
        "`--opcua` and PLCs at `opc.tcp://` need it: build the program with `--features opcua`, or install the wheel";
    Finding::missing("OPC UA", "not in this program", help)
}

fn browser() -> Finding {
    match shot::browser() {
        Some(path) => Finding::ok("browser", path.display().to_string()),
        None => Finding::missing(
            "browser",
            "no Chromium, Chrome or Edge on the PATH",
            "`onescan shot` draws with one: install it (Debian: `apt install chromium`), or name it in the variable `CHROMIUM`",
        ),
    }
}

/// Programs of others: how they are called, and who needs them.
const PROGRAMS: &[(&str, &[&str], &str)] = &[
    (
        "git",
        &["git"],
        "`onescan bisect`, and the cause that `onescan test` names for a change, read the repository with it",
    ),
    ("Python", &["python3", "python"], "plants and clients in Python need it, as `onescan new --template python`"),
    (
        "MatIEC",
        &["iec2c"],
        "it translates what `instrument --target beremiz` writes, and the tests of onescan compare with it",
    ),
];

fn program(subject: &'static str, names: &[&str], help: &str) -> Finding {
    match names.iter().find_map(|name| environment::on_path(OsStr::new(name))) {
        Some(path) => Finding::ok(subject, path.display().to_string()),
        None => Finding::missing(subject, format!("no `{}` on the PATH", names[0]), help),
    }
}

/// One line for each, and beneath it what to do.
fn write_table(findings: &[Finding], out: &mut dyn Write) -> io::Result<()> {
    let width = findings.iter().map(|finding| finding.subject.len()).max().unwrap_or(0);
    for finding in findings {
        let state = match finding.state {
            State::Ok => "ok",
            State::Missing => "missing",
            State::Wrong => "WRONG",
        };
        writeln!(out, "{state:<7}  {:<width$}  {}", finding.subject, finding.found)?;
        if let Some(help) = &finding.help {
            writeln!(out, "{:1$}{help}", "", 7 + 2 + width + 2)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_work_ends_with_a_fault_and_what_is_missing_does_not() {
        let mut text = Vec::new();
        let findings = [
            Finding::ok("page", "in this program"),
            Finding::missing("git", "no `git`", "bisect needs it"),
            Finding::wrong("temporary folder", "read only", "name another"),
        ];
        write_table(&findings, &mut text).unwrap();
        insta::assert_snapshot!(String::from_utf8(text).unwrap(), @r"
        ok       page              in this program
        missing  git               no `git`
                                   bisect needs it
        WRONG    temporary folder  read only
                                   name another
        ");
    }

    #[test]
    fn machines_get_one_line_of_json() {
        let mut text = Vec::new();
        run(Build { version: "1.2.3", has_opcua: false }, Format::Json, &mut text).unwrap();
        let all: serde_json::Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(all[0]["subject"], "program");
        assert_eq!((&all[2]["subject"], &all[2]["state"]), (&"OPC UA".into(), &"missing".into()));
        assert_eq!(text.split(|byte| *byte == b'\n').count(), 2, "one line and nothing behind it");
    }
}
