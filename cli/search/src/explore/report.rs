//! What was found, or that nothing was.

use std::io::{self, Write};

use onescan_report::number::counted;
use onescan_scenario::Scenario;
use onescan_scenario::case::written::{Entry, Written};
use onescan_scenario::timing::TimingTolerance;
use serde_json::json;

use super::config::ExploreConfig;
use super::deviation::Deviation;
use super::search::{Finding, Found};
use onescan_runner::format::Format;

/// All that is reported of an exploration.
pub(super) struct ExploreReport<'a> {
    pub(super) config: &'a ExploreConfig,
    pub(super) scenario: &'a Scenario,
    pub(super) tolerances: &'a [TimingTolerance],
    pub(super) found: &'a Found,
    /// The case to which deviations came.
    pub(super) written: &'a Written,
}

impl ExploreReport<'_> {
    /// Writes what came of it.
    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self.config.format {
            Format::Human => self.human(out)?,
            Format::Json => self.json(out)?,
        }
        out.flush()
    }

    fn json(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { config, scenario, found, .. } = self;
        for (number, finding) in found.findings.iter().enumerate() {
            writeln!(
                out,
                "{}",
                json!({ "deviations": finding.deviations, "violated": finding.violated, "failure": finding.failure,
                    "digest": finding.digest, "drawn": finding.drawn, "case": self.case(number + 1, finding) })
            )?;
        }
        let statement = json!({ "scenario": scenario.name(), "holds": found.findings.is_empty(),
            "schedules": found.schedules, "joined": found.joined, "runs": found.runs.done(),
            "edges": found.places.values().sum::<u64>(), "bound": config.bound, "exhausted": found.exhausted,
            "samples": found.sampled, "seed": config.seed, "version": env!("CARGO_PKG_VERSION") });
        writeln!(out, "{statement}")
    }

    fn human(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { scenario, found, .. } = self;
        for (number, finding) in found.findings.iter().enumerate() {
            let what: Vec<String> =
                finding.violated.iter().map(|one| format!("`{}`", one.name)).chain(finding.failure.clone()).collect();
            writeln!(out, "{}: {} does not hold if", scenario.name(), what.join(", "))?;
            if finding.deviations.is_empty() {
                writeln!(out, "  nothing is late: the run without deviations is wrong already")?;
                continue;
            }
            for deviation in &finding.deviations {
                writeln!(out, "  {deviation}")?;
            }
            for line in self.case(number + 1, finding).lines() {
                writeln!(out, "    {line}")?;
            }
        }
        writeln!(out, "{}: {}", scenario.name(), self.statement())
    }

    /// What is known now: no more than was tried.
    fn statement(&self) -> String {
        let Self { config, found, .. } = self;
        let schedules = counted(found.schedules, "schedule");
        let joined =
            if found.joined > 0 { format!(", {} of them by equal states", found.joined) } else { String::new() };
        let by_chance = found.findings.iter().filter(|finding| finding.drawn.is_some()).count();
        let systematic = found.findings.len() - by_chance;
        let known = match (systematic, found.exhausted) {
            (0, Some(bound)) if bound == config.bound => {
                format!("all {schedules} with at most {} hold{joined}", self.late(bound))
            }
            (0, exhausted) => {
                let known = exhausted.map_or_else(
                    || "nothing is exhausted".to_owned(),
                    |bound| format!("only those with at most {bound} late of {} are exhausted", self.places()),
                );
                format!(
                    "{schedules} hold{joined}; {known}, because {} were done, which is the limit (see `--runs`)",
                    counted(found.runs.done(), "run")
                )
            }
            (findings, _) if config.all => {
                let wrong = if findings == 1 { "does not" } else { "do not" };
                format!("{findings} of {schedules} {wrong} hold, with at most {}{joined}", self.late(config.bound))
            }
            _ => return format!("found in {schedules}"),
        };
        if found.sampled == 0 {
            return known;
        }
        let least = config.bound.saturating_add(1);
        let random = format!("random ones with {least} to {}, of seed {}", config.most.max(least), config.seed);
        match (by_chance, found.sampled) {
            (0, 1) => format!("{known}, and so does 1 of the {random}"),
            (0, sampled) => format!("{known}, and so do {sampled} {random}"),
            (_, sampled) if config.all => format!("{known}; of {sampled} {random} some do not: {by_chance} causes"),
            (_, sampled) => format!("{known}; found in number {sampled} of the {random}"),
        }
    }

    /// How many of what may be late are.
    fn late(&self, bound: u32) -> String {
        let latest = |tolerance: &TimingTolerance| {
            if let TimingTolerance::Late { steps, .. } = tolerance { Some(*steps) } else { None }
        };
        // Where nothing but signals may be late it is said by how much.
        let latest: Option<Vec<u64>> = self.tolerances.iter().map(latest).collect();
        let by = latest.and_then(|all| all.into_iter().max()).map(|latest| match latest {
            1 => " late by 1 step".to_owned(),
            latest => format!(" late by 1 to {latest} steps"),
        });
        format!("{bound} of {}{}", self.places(), by.unwrap_or_else(|| " late".to_owned()))
    }

    /// What may happen later in the run without deviations.
    fn places(&self) -> String {
        let count = |is: fn(&TimingTolerance) -> bool| -> u64 {
            let of =
                |(number, count): (&usize, &u64)| self.tolerances.get(*number).filter(|one| is(one)).map(|_| *count);
            self.found.places.iter().filter_map(of).sum()
        };
        let all = [
            (count(|one| matches!(one, TimingTolerance::Late { together: false, .. })), "edge"),
            (count(|one| matches!(one, TimingTolerance::Late { together: true, .. })), "frame"),
            (count(|one| matches!(one, TimingTolerance::Behind { .. })), "order"),
            (count(|one| matches!(one, TimingTolerance::Jitter { .. })), "scan"),
            (count(|one| matches!(one, TimingTolerance::TwoCycles { .. })), "double cycle"),
            (count(|one| matches!(one, TimingTolerance::Phase { .. })), "phase"),
            (count(|one| matches!(one, TimingTolerance::Start { .. })), "start"),
        ];
        let counts: Vec<String> =
            all.into_iter().filter(|(count, _)| *count > 0).map(|(count, noun)| counted(count, noun)).collect();
        if counts.is_empty() { "0 edges".to_owned() } else { counts.join(", ") }
    }

    /// All findings as a file of cases.
    pub(super) fn cases(&self) -> String {
        let mut text = "version = 1\n".to_owned();
        for (number, finding) in self.found.findings.iter().enumerate() {
            text.push('\n');
            text.push_str(&self.case(number + 1, finding));
        }
        text
    }

    /// A finding as a case that runs by itself.
    fn case(&self, number: usize, finding: &Finding) -> String {
        let about: Vec<String> = finding.deviations.iter().map(ToString::to_string).collect();
        let mut written = self.written.clone();
        (written.about, written.until) = (Some(about.join("; ")), Some(self.found.until));
        let own = finding.deviations.iter().flat_map(Deviation::entries);
        let entries: Vec<Entry> = written.entries.iter().cloned().chain(own).collect();
        written.to_toml(&format!("timing-{number}"), &entries)
    }
}
