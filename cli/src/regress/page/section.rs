//! One test or run of a page.

use std::fmt::Write as _;

use onescan_server::signal::SignalType;
use onescan_server::time::{TimeSpan, VirtualTime};

use super::markup::{escaped, facts};
use crate::regress::outcome::{Outcome, Status};
use crate::regress::ran::{Event, Ran, Shown};
use crate::regress::snapshot::Snapshot;
use crate::regress::snapshot::value::show;
use crate::regress::summary::details;

/// So many events are listed; a machine's signals change often.
const EVENTS_MAX: usize = 200;

/// What a page says of one test or run.
#[derive(Clone, Debug, Default)]
pub struct Section {
    pub(super) title: String,
    pub(super) status: String,
    pub(super) steps: u64,
    pub(super) virtual_time: String,
    is_bad: bool,
    facts: Vec<(&'static str, String)>,
    lines: Vec<String>,
    expectations: Vec<Shown>,
    events: Vec<Event>,
    svg: Option<String>,
}

impl Section {
    /// Of a test.
    pub(super) fn of_test(outcome: &Outcome) -> Self {
        let mut facts = statistics(outcome.steps, outcome.step_ns, outcome.virtual_time_ns, outcome.digest.as_ref());
        if let Some(made) = outcome.asserts_made {
            facts.push(("asserts", made.to_string()));
        }
        if !outcome.tags.is_empty() {
            facts.push(("tags", outcome.tags.join(", ")));
        }
        let mut events = outcome.shown.events.clone();
        events.extend(outcome.shown.snapshot.iter().flat_map(edges));
        Self {
            title: format!("{}: {}", outcome.suite, outcome.name),
            status: outcome.status.word().to_owned(),
            steps: outcome.steps,
            virtual_time: VirtualTime::from_nanos(outcome.virtual_time_ns).to_string(),
            is_bad: outcome.status.is_bad() || outcome.status == Status::New,
            facts,
            lines: details(outcome),
            expectations: outcome.expectations.clone(),
            events: with_violations(events, &outcome.expectations),
            svg: outcome.shown.svg.clone(),
        }
    }

    /// Of a run.
    pub(super) fn of_run(ran: &Ran, svg: Option<String>) -> Self {
        let is_violated = ran.expectations.iter().any(|shown| shown.verdict == "violated");
        Self {
            title: ran.name.clone(),
            status: ran.status.clone(),
            steps: ran.steps,
            virtual_time: VirtualTime::from_nanos(ran.virtual_time_ns).to_string(),
            is_bad: ran.status == "failed" || is_violated,
            facts: statistics(ran.steps, ran.step_ns, ran.virtual_time_ns, ran.digest.as_ref()),
            lines: ran.error.iter().cloned().collect(),
            expectations: ran.expectations.clone(),
            events: with_violations(ran.events.clone(), &ran.expectations),
            svg,
        }
    }

    /// Of a snapshot that waits for a review.
    pub(crate) fn of_review(title: String, status: &str, lines: Vec<String>, svg: String) -> Self {
        Self { title, status: status.to_owned(), lines, svg: Some(svg), is_bad: true, ..Self::default() }
    }

    /// How its status is shown.
    pub(super) fn class(&self) -> &'static str {
        if self.is_bad { "bad" } else { "good" }
    }

    pub(super) fn write(&self, index: usize, text: &mut String) -> std::fmt::Result {
        let (title, status, class) = (escaped(&self.title), escaped(&self.status), self.class());
        writeln!(text, "<section id=\"t{index}\"><h2>{title} <span class=\"{class}\">{status}</span></h2>")?;
        if !self.lines.is_empty() {
            writeln!(text, "<pre>{}</pre>", escaped(&self.lines.join("\n")))?;
        }
        text.push_str(&facts(&self.facts));
        self.write_expectations(text)?;
        if let Some(svg) = &self.svg {
            writeln!(text, "<h3>trajectories</h3>\n{svg}")?;
        }
        self.write_events(text)?;
        writeln!(text, "</section>")
    }

    fn write_expectations(&self, text: &mut String) -> std::fmt::Result {
        if self.expectations.is_empty() {
            return Ok(());
        }
        text.push_str(
            "<h3>expectations</h3>\n<table><thead><tr><th>name<th>verdict<th>at<th>signals<th>margin</thead>\n",
        );
        for Shown { name, verdict, at_ns, values, margin } in &self.expectations {
            let class = match verdict.as_str() {
                "violated" => "bad",
                "open" => "open",
                _ => "good",
            };
            let at = at_ns.map(|at| VirtualTime::from_nanos(at).to_string()).unwrap_or_default();
            let values: Vec<String> = values.iter().map(|(signal, value)| format!("{signal} = {value}")).collect();
            let (name, values) = (escaped(name), escaped(&values.join(", ")));
            let margin = margin.map(|margin| format!("{margin:.3e}")).unwrap_or_default();
            writeln!(
                text,
                "<tr><td>{name}<td class=\"{class}\">{verdict}<td>{at}<td class=\"value\">{values}<td>{margin}"
            )?;
        }
        writeln!(text, "</table>")
    }

    fn write_events(&self, text: &mut String) -> std::fmt::Result {
        if self.events.is_empty() {
            return Ok(());
        }
        let count = self.events.len();
        writeln!(text, "<details><summary>{count} events</summary>\n<table>")?;
        for Event { at_ns, text: what } in self.events.iter().take(EVENTS_MAX) {
            writeln!(text, "<tr><td class=\"value\">{}<td>{}", VirtualTime::from_nanos(*at_ns), escaped(what))?;
        }
        if count > EVENTS_MAX {
            writeln!(text, "<tr><td><td>... and {} more", count - EVENTS_MAX)?;
        }
        writeln!(text, "</table></details>")
    }
}

/// Step statistics: how many, how long, and the digest over all of them.
fn statistics(steps: u64, step_ns: u64, end_ns: u64, digest: Option<&String>) -> Vec<(&'static str, String)> {
    let step = TimeSpan::from_nanos(step_ns).map(|step| step.to_string()).unwrap_or_default();
    let mut facts = vec![
        ("steps", steps.to_string()),
        ("step", step),
        ("virtual time", VirtualTime::from_nanos(end_ns).to_string()),
    ];
    facts.extend(digest.map(|digest| ("digest", digest.clone())));
    facts
}

/// The changes of all BOOLs.
fn edges(snapshot: &Snapshot) -> impl Iterator<Item = Event> {
    let bools = snapshot.signals.iter().filter(|track| track.ty == SignalType::BOOL);
    bools.flat_map(|track| {
        track.changes.iter().skip(1).map(|(since, bytes)| Event {
            at_ns: since.as_nanos(),
            text: format!("{} becomes {}", track.name, show(track.ty, bytes)),
        })
    })
}

fn with_violations(mut events: Vec<Event>, expectations: &[Shown]) -> Vec<Event> {
    for shown in expectations.iter().filter(|shown| shown.verdict == "violated") {
        events.extend(shown.at_ns.map(|at_ns| Event { at_ns, text: format!("expectation `{}` violated", shown.name) }));
    }
    events.sort_by(|a, b| (a.at_ns, &a.text).cmp(&(b.at_ns, &b.text)));
    events
}
