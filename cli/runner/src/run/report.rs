//! What came of a run, for people and for machines.

use std::io::Write;
use std::time::Duration;

use onescan_scenario::report::Report;
use onescan_scenario::{Mode, Scenario};
use onescan_server::digest::Digest;
use onescan_server::end::{Failure, SessionEnd};
use onescan_server::lockstep::Outcome;
use onescan_server::time::{StepCount, TimeSpan, VirtualTime};
use serde::{Deserialize, Serialize};

use super::config::{RunConfig, Transport};
use super::expectation::ExpectationReport;
use super::production::tables;
use super::session_log::{self, ClientLatency};
use super::watch::WatchReport;
use crate::error::ExitCode;
use crate::format::Format;

/// What came of one run. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    pub scenario: String,
    /// The case of it, if one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// Number of the run, from 1.
    pub run: u32,
    /// In lockstep or not.
    pub mode: Mode,
    /// Of the clocks of a run without lockstep, if they were computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// How clients were reached.
    pub transport: Transport,
    pub status: RunStatus,
    /// The digest over all steps; absent if there was none.
    pub digest: Option<Digest>,
    pub steps: StepCount,
    /// Virtual time of the last of them.
    #[serde(rename = "virtual_time_ns")]
    pub virtual_time: VirtualTime,
    /// Wall-clock time of the run with everything around it.
    pub wall_time_s: f64,
    /// The failure, if one ended the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// The failure in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// What came of the scenario's expectations.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub expectations: Vec<ExpectationReport>,
    /// What it produced; absent unless the scenario has a `[report]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report: Option<Report>,
    /// How long the session waited for each client, if that was noted.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub latency: Vec<ClientLatency>,
    /// What watched variables were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub watched: Option<WatchReport>,
    /// The step of virtual time.
    #[serde(skip)]
    pub step: TimeSpan,
    /// The program that ran it.
    pub version: &'static str,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunStatus {
    /// It came to its end.
    Completed,
    Stopped,
    /// A client or a link ended it.
    Failed,
}

impl RunStatus {
    /// As it is written in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
        }
    }
}

impl RunReport {
    pub(super) fn new(
        config: &RunConfig,
        scenario: &Scenario,
        run: u32,
        outcome: &Outcome,
        wall_time: Duration,
    ) -> Self {
        let (status, failure) = match &outcome.end {
            SessionEnd::Completed { .. } => (RunStatus::Completed, None),
            SessionEnd::Stopped { .. } => (RunStatus::Stopped, None),
            SessionEnd::Failed(failure) => (RunStatus::Failed, Some(failure.clone())),
        };
        Self {
            scenario: scenario.name().to_owned(),
            case: scenario.case().map(|case| case.name.clone()),
            run,
            mode: config.mode,
            seed: config.seed,
            transport: config.reach.transport,
            status,
            digest: outcome.digest,
            steps: outcome.steps,
            virtual_time: outcome.t_v,
            wall_time_s: wall_time.as_secs_f64(),
            error: failure.as_ref().map(ToString::to_string),
            failure,
            expectations: Vec::new(),
            report: None,
            latency: Vec::new(),
            watched: None,
            step: scenario.file().step,
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// The step that ends at `t_v`, which is not after the last.
    pub(super) fn step_at(&self, t_v: VirtualTime) -> StepCount {
        StepCount(self.steps.0.saturating_sub((self.virtual_time - t_v) / self.step.as_nanos()))
    }

    /// True if a client ended it.
    pub fn is_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// True if it did not show what was expected.
    pub fn is_unmet(&self) -> bool {
        self.expectations.iter().any(ExpectationReport::is_violated)
    }

    /// True if it came to the same end by the same way, with nothing else to say: equal runs are reported once.
    fn is_as(&self, before: &Self) -> bool {
        let has_more = !self.latency.is_empty() || self.watched.is_some() || self.error.is_some();
        !has_more
            && (self.status, &self.digest, self.steps) == (before.status, &before.digest, before.steps)
            && self.digest.is_some()
            && (&self.expectations, &self.report) == (&before.expectations, &before.report)
    }

    /// Writes what came of this run, which is one of so many; `before` is the last of them.
    pub(super) fn write(
        &self,
        format: Format,
        runs: u32,
        before: Option<&Self>,
        out: &mut dyn Write,
    ) -> std::io::Result<()> {
        match format {
            Format::Json => {
                serde_json::to_writer(&mut *out, self)?;
                writeln!(out)?;
            }
            Format::Human => {
                let case = self.case.as_ref().map(|case| format!(" {case}")).unwrap_or_default();
                let name =
                    if runs == 1 { format!("{}{case}", self.scenario) } else { format!("run {}/{runs}", self.run) };
                let digest = self.digest.map_or_else(|| "none".to_owned(), |digest| digest.to_string());
                let (steps, t_v, wall) = (self.steps, self.virtual_time, self.wall_time_s);
                if let Some(before) = before.filter(|before| self.is_as(before)) {
                    writeln!(out, "{name}: the same as run {}, in {wall:.3} s", before.run)?;
                    return out.flush();
                }
                writeln!(out, "{name}: {}, {steps} steps, {t_v} virtual in {wall:.3} s", self.status.word())?;
                writeln!(out, "  digest {digest}")?;
                if let Some(error) = &self.error {
                    writeln!(out, "  {error}")?;
                }
                for expectation in &self.expectations {
                    expectation.write(out)?;
                }
                session_log::write(&self.latency, out)?;
                if let Some(watched) = &self.watched {
                    watched.write(out)?;
                }
                match (&self.report, before) {
                    (None, _) => {}
                    (now, Some(before)) if *now == before.report => writeln!(out, "  report as in run {}", before.run)?,
                    (Some(report), _) => tables::write(report, out)?,
                }
            }
        }
        out.flush()
    }
}

/// What came of all runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every run came to its end, and those that must be equal are.
    Good,
    /// Runs in lockstep differ: something on a session's path is not deterministic.
    Unequal,
    /// A run did not show what the scenario expects.
    Unmet,
    Failed,
}

impl Verdict {
    pub(super) fn of(mode: Mode, reports: &[RunReport]) -> Self {
        if reports.iter().any(RunReport::is_failed) {
            Self::Failed
        } else if mode == Mode::Lockstep && distinct_digests(&completed(reports)) > 1 {
            Self::Unequal
        } else if reports.iter().any(RunReport::is_unmet) {
            Self::Unmet
        } else {
            Self::Good
        }
    }

    /// 0 if all is well, 1 for unequal runs and violated expectations, 3 for a session that failed.
    pub fn exit_code(self) -> ExitCode {
        match self {
            Self::Good => ExitCode::Ok,
            Self::Unequal | Self::Unmet => ExitCode::Unmet,
            Self::Failed => ExitCode::Fault,
        }
    }

    /// The last line for people, where there is more than one run.
    pub(super) fn write(self, format: Format, reports: &[RunReport], out: &mut dyn Write) -> std::io::Result<()> {
        if format == Format::Json || reports.len() < 2 || self == Self::Failed {
            return Ok(());
        }
        let runs = reports.len();
        match distinct_digests(&completed(reports)) {
            0 => Ok(()),
            1 => writeln!(out, "{runs} runs, all digests equal"),
            n if self == Self::Unequal => writeln!(
                out,
                "{runs} runs, {n} different digests: a client reads something that the scenario does not fix \
                 (a clock, a random source, an order)"
            ),
            n => writeln!(out, "{runs} runs, {n} different digests"),
        }
    }
}

/// Runs that came to their end; one that was stopped half-way is equal to nothing.
fn completed(reports: &[RunReport]) -> Vec<&RunReport> {
    reports.iter().filter(|report| report.status == RunStatus::Completed).collect()
}

fn distinct_digests(reports: &[&RunReport]) -> usize {
    let mut digests: Vec<String> = reports.iter().filter_map(|report| report.digest).map(|d| d.to_string()).collect();
    digests.sort();
    digests.dedup();
    digests.len()
}
