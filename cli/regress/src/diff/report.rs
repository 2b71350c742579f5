//! What came of a comparison, for people and for machines.

use std::io::{self, Write};

use onescan_iec_run::{FaultSite, Way};
use onescan_recording::Recording;
use onescan_report::table;
use onescan_server::end::Failure;
use onescan_soft_plc::Written;
use serde_json::{Value, json};

use super::cause::{Cause, Causes};
use super::first::{Around, Basis, Compared, Divergence};
use super::parting::Parting;
use super::sources::FileDifference;
use crate::why;
use crate::why::report::Runs;

/// Signals that are listed for people.
const LISTED: usize = 20;
/// Signals whose statements are shown in text.
const EXPLAINED: usize = 4;
/// Decisions around a statement that are shown in text, the innermost.
const WITHIN: usize = 3;
/// What the two recordings are called.
pub(super) const NAMES: [&str; 2] = ["A", "B"];

/// All that was found.
#[derive(Debug)]
pub struct Report {
    pub recordings: [Recording; 2],
    /// What "no difference" rests on.
    pub compared: Compared,
    /// Where they part; nothing if they are equal.
    pub divergence: Option<Divergence>,
    /// How a client failed in the run that ends before the other.
    pub failure: Option<Failure>,
    /// Who wrote what differs.
    pub causes: Causes,
    pub around: Around,
    /// The files of the scenarios that differ.
    pub files: Vec<FileDifference>,
}

impl Report {
    /// True if nothing differs.
    pub fn is_equal(&self) -> bool {
        self.divergence.is_none()
    }

    /// Writes the report for people.
    ///
    /// # Errors
    /// `out` takes no more.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        for (name, recording) in NAMES.iter().zip(&self.recordings) {
            let last = recording.steps().map_or(0, |steps| *steps.end());
            let (scenario, folder) = (&recording.header().provenance.scenario, recording.folder().display());
            writeln!(out, "{name}  {folder}: {scenario}, up to step {last}")?;
        }
        writeln!(out)?;
        self.write_findings(out)
    }

    /// Writes what was found, without what was compared.
    ///
    /// # Errors
    /// `out` takes no more.
    pub fn write_findings(&self, out: &mut dyn Write) -> io::Result<()> {
        let Some(found) = &self.divergence else {
            return writeln!(out, "no difference, by {}", self.compared);
        };
        write_place(found, out)?;
        if let Some(failure) = &self.failure {
            writeln!(out, "  {failure}")?;
        }
        write_differences(found, out)?;
        for cause in self.causes.signals.iter().take(EXPLAINED) {
            self.write_cause(cause, out)?;
        }
        for parting in &self.causes.partings {
            write_parting(parting, out)?;
        }
        if let Some(way_back) = &self.causes.why {
            why::report::write(way_back, &Runs::named(NAMES), out)?;
        }
        for (name, why) in NAMES.iter().zip(&self.causes.unknown) {
            if let Some(why) = why {
                writeln!(out, "\nstatements of {name} are not known: {why}")?;
            }
        }
        self.write_files(out)?;
        self.write_around(found, out)
    }

    fn write_cause(&self, cause: &Cause, out: &mut dyn Write) -> io::Result<()> {
        let Some(client) = &cause.client else { return Ok(()) };
        if cause.written.iter().all(Option::is_none) && self.causes.unknown.iter().any(Option::is_some) {
            return Ok(());
        }
        writeln!(out, "\n{}, written by client `{client}`", cause.signal)?;
        if cause.written.iter().all(Option::is_none) {
            return writeln!(
                out,
                "  by no statement up to there: it has its initial value, or `{client}` is not a soft PLC"
            );
        }
        for (name, written) in NAMES.iter().zip(&cause.written) {
            match written {
                None => writeln!(out, "  {name}  by no statement so far")?,
                Some(Written { t_v, site, within }) => {
                    let FaultSite { file, line, .. } = &site.at;
                    writeln!(out, "  {name}  {file}:{line} in {}, at {t_v}", site.at)?;
                    writeln!(out, "       {}", site.statement)?;
                    for way in within.iter().take(WITHIN) {
                        writeln!(out, "       within {}:{}  {way}", way.file, way.line)?;
                    }
                    for caller in &site.callers {
                        writeln!(out, "       called by {caller} at {}:{}", caller.file, caller.line)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn write_files(&self, out: &mut dyn Write) -> io::Result<()> {
        if self.files.is_empty() {
            return Ok(());
        }
        writeln!(out, "\nfiles that differ")?;
        for file in &self.files {
            writeln!(out, "  {} ({})", file.path, file.how)?;
            for (mark, number, line) in &file.lines {
                writeln!(out, "  {mark} {number:>4}  {}", line.trim_end())?;
            }
        }
        Ok(())
    }

    fn write_around(&self, found: &Divergence, out: &mut dyn Write) -> io::Result<()> {
        if self.around.rows.is_empty() {
            return Ok(());
        }
        writeln!(out, "\naround it")?;
        let mut head = vec![String::new(), "t_v".to_owned()];
        for signal in &self.around.signals {
            head.extend(NAMES.map(|name| format!("{signal} {name}")));
        }
        let mut rows = vec![head];
        for (t_v, values) in &self.around.rows {
            let mut row = vec![if *t_v == found.at { ">".to_owned() } else { String::new() }, t_v.to_string()];
            row.extend(values.iter().flatten().map(|value| value.clone().unwrap_or_else(|| "-".to_owned())));
            rows.push(row);
        }
        table::write(&rows, out)
    }

    /// Writes the report as one JSON object. Fields are added, never changed.
    ///
    /// # Errors
    /// `out` takes no more.
    pub fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer(&mut *out, &self.json())?;
        writeln!(out)
    }

    /// The report as JSON.
    pub fn json(&self) -> Value {
        let runs = self.recordings.each_ref().map(|recording| {
            json!({
                "path": recording.folder().display().to_string(),
                "scenario": recording.header().provenance.scenario,
                "steps": recording.steps().map_or(0, |steps| *steps.end()),
            })
        });
        let mut all = json!({ "equal": self.is_equal(), "a": runs[0], "b": runs[1], "files": self.files });
        if let (Some(found), Some(object)) = (&self.divergence, all.as_object_mut()) {
            object.insert("t_v_ns".to_owned(), json!(found.at.as_nanos()));
            object.insert("step_a".to_owned(), json!(found.steps[0]));
            object.insert("step_b".to_owned(), json!(found.steps[1]));
            object.insert("basis".to_owned(), json!(if found.basis == Basis::Digests { "digests" } else { "values" }));
            object.insert("ended".to_owned(), json!(found.ended.map(|ended| ["a", "b"][ended])));
            object.insert("failure".to_owned(), json!(self.failure));
            object.insert("signals".to_owned(), self.json_signals(found));
            let partings: Vec<Value> = self.causes.partings.iter().map(json_parting).collect();
            object.insert("partings".to_owned(), json!(partings));
            object.insert("why".to_owned(), json!(self.causes.why.as_ref().map(why::report::json)));
            let unknown = &self.causes.unknown;
            object.insert("statements_unknown".to_owned(), json!({ "a": unknown[0], "b": unknown[1] }));
        }
        all
    }

    fn json_signals(&self, found: &Divergence) -> Value {
        let signal = |difference: &super::first::Difference| {
            let cause = self.causes.signals.iter().find(|cause| cause.signal == difference.signal);
            let written = |index: usize| cause.and_then(|cause| cause.written[index].as_ref()).map(json_written);
            json!({
                "signal": difference.signal,
                "type": difference.ty,
                "writer": difference.writer,
                "a": { "value": difference.values[0], "written": written(0) },
                "b": { "value": difference.values[1], "written": written(1) },
            })
        };
        found.differences.iter().map(signal).collect()
    }
}

fn write_place(found: &Divergence, out: &mut dyn Write) -> io::Result<()> {
    let [a, b] = found.steps;
    if let Some(ended) = found.ended {
        let (short, long) = (NAMES[ended], NAMES[1 - ended]);
        return writeln!(out, "equal up to t_v = {}, where {short} ends; {long} goes on", found.at);
    }
    let steps = if a == b { format!("step {a}") } else { format!("step {a} of A, step {b} of B") };
    writeln!(out, "first difference at t_v = {}, {steps}", found.at)
}

/// Where a PLC went another way.
fn write_parting(Parting { client, at, ways }: &Parting, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "\nclient `{client}` goes another way at {at}")?;
    for (name, way) in NAMES.iter().zip(ways) {
        match way {
            Some(way) => writeln!(out, "  {name}  {}:{} in {}\n       {way}", way.file, way.line, way.unit)?,
            None => writeln!(out, "  {name}  nothing more is decided in this scan")?,
        }
    }
    Ok(())
}

fn write_differences(found: &Divergence, out: &mut dyn Write) -> io::Result<()> {
    if found.differences.is_empty() && found.ended.is_none() {
        return writeln!(out, "  in signals that are not recorded: the digests differ, what is recorded does not");
    }
    let rows: Vec<[String; 5]> = found
        .differences
        .iter()
        .take(LISTED)
        .map(|difference| {
            let writer = difference.writer.as_ref().map(ToString::to_string).unwrap_or_default();
            let [a, b] = difference.values.clone();
            [difference.signal.to_string(), difference.ty.to_string(), writer, a, b]
        })
        .collect();
    if !rows.is_empty() {
        let head = ["signal", "type", "writer", "A", "B"].map(str::to_owned);
        table::write(&[vec![head.to_vec()], rows.into_iter().map(|row| row.to_vec()).collect()].concat(), out)?;
    }
    match found.differences.len().saturating_sub(LISTED) {
        0 => Ok(()),
        more => writeln!(out, "  and {more} more"),
    }
}

fn json_written(written: &Written) -> Value {
    let site = |site: &FaultSite| {
        json!({
            "file": site.file, "line": site.line, "column": site.column, "unit": site.pou, "instance": site.instance,
        })
    };
    json!({
        "t_v_ns": written.t_v.as_nanos(),
        "statement": written.site.statement,
        "at": site(&written.site.at),
        "callers": written.site.callers.iter().map(site).collect::<Vec<_>>(),
        "within": written.within.iter().map(json_way).collect::<Vec<_>>(),
    })
}

fn json_way(way: &Way) -> Value {
    json!({
        "file": way.file, "line": way.line, "column": way.column, "unit": way.unit,
        "question": way.question, "answer": way.answer,
    })
}

fn json_parting(Parting { client, at, ways: [a, b] }: &Parting) -> Value {
    let way = |way: &Option<Way>| way.as_ref().map(json_way);
    json!({ "client": client, "t_v_ns": at.as_nanos(), "a": way(a), "b": way(b) })
}
