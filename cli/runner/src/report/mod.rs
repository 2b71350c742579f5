//! `onescan report`: what recorded runs produced.

mod error;

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_recording::Recording;
use onescan_report::page::{Page, Section};
use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::load::kept_as;
use onescan_scenario::report::{Measures, Meter, Report};
use onescan_server::signal::SignalName;
use onescan_server::signal::pattern::{EmptyPattern, SignalPattern};
use onescan_server::time::VirtualTime;
use serde::Serialize;

pub use error::ReportError;

use crate::error::Usage;
use crate::format::Format;
use crate::run::cut_short;
use crate::run::production::{pictures, tables};
use crate::web::charts;

/// What is reported, and for whom.
#[derive(Clone, Debug)]
pub struct ReportConfig {
    pub recordings: Vec<PathBuf>,
    /// The scenario that says what is reported; each recording's own if absent.
    pub scenario: Option<PathBuf>,
    /// For whom the report is.
    pub format: Format,
    /// File for a page about all recordings.
    pub html: Option<PathBuf>,
}

/// What a recording reports. Its JSON form is a contract: fields are added, never changed.
#[derive(Debug, Serialize)]
struct Recorded {
    /// The folder, as it was typed.
    recording: String,
    scenario: String,
    /// The case of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    case: Option<String>,
    /// Steps that are recorded.
    steps: u64,
    /// The same as in the line of the run.
    report: Report,
}

/// Reports each recording to `out`.
///
/// # Errors
/// A recording that cannot be read or lacks a signal, a scenario that asks for no report, a file that cannot be written.
pub fn report(config: &ReportConfig, out: &mut dyn Write) -> Result<(), ReportError> {
    let asked = config.scenario.as_deref().map(Scenario::load).transpose()?;
    let mut all = Vec::new();
    for folder in &config.recordings {
        let recorded = recorded(folder, asked.as_ref())?;
        recorded.write(config.format, out).map_err(OutputError)?;
        all.push(recorded);
    }
    if let Some(path) = &config.html {
        file::write_output(path, page(&all).to_html().as_bytes())?;
    }
    Ok(())
}

fn recorded(folder: &Path, asked: Option<&Scenario>) -> Result<Recorded, ReportError> {
    let recording = Recording::open(folder)?;
    cut_short::report(&recording);
    let own = if asked.is_none() { Some(own_scenario(&recording)?) } else { None };
    let scenario = asked.or(own.as_ref());
    let Some(measures) = scenario.and_then(Scenario::measures) else {
        let help = "add a `[report]` to a scenario of these signals and name it with `--scenario` (docs/report.md)";
        let message = format!("the scenario of {} has no `[report]`", folder.display());
        return Err(Usage::new(message, Some(help.to_owned())).into());
    };
    let report = measured(&recording, measures)?;
    let provenance = &recording.header().provenance;
    Ok(Recorded {
        recording: folder.display().to_string(),
        scenario: provenance.scenario.clone(),
        case: provenance.case.clone(),
        steps: recording.steps().map_or(0, |steps| steps.end() - steps.start()),
        report,
    })
}

/// The recorded scenario.
fn own_scenario(recording: &Recording) -> Result<Scenario, ReportError> {
    let kept = &recording.header().provenance;
    Ok(Scenario::load(&kept_as(&recording.scenario(), &kept.scenario, kept.file.as_deref()))?)
}

fn measured(recording: &Recording, measures: &Measures) -> Result<Report, ReportError> {
    let patterns = patterns(recording, measures)?;
    let none = || Usage::new(format!("{} has no step", recording.folder().display()), None);
    let steps = recording.steps().ok_or_else(none)?;
    let mut meter = Meter::new(measures);
    let mut places: Option<Vec<usize>> = None;
    recording.each(&patterns, steps, &mut |columns, row| {
        let place = |name: &SignalName| columns.iter().position(|column| column.name == *name);
        let places = places.get_or_insert_with(|| measures.signals().filter_map(|(name, _)| place(name)).collect());
        let bytes = places.iter().filter_map(|place| columns.get(*place)).map(|column| row.bytes(column));
        meter.push(row.t_v.as_nanos(), bytes);
    })?;
    meter.report().ok_or_else(|| none().into())
}

/// The signals that are needed, each of which the recording must have.
fn patterns(recording: &Recording, measures: &Measures) -> Result<Vec<SignalPattern>, ReportError> {
    let folder = recording.folder().display();
    for (name, ty) in measures.signals() {
        let known = recording.header().signals.iter().find(|signal| signal.name == *name);
        let message = match known {
            Some(signal) if signal.recorded && signal.ty == ty => continue,
            Some(signal) if signal.recorded => {
                format!("signal `{name}` is a {} in {folder}, and a {ty} in the scenario", signal.ty)
            }
            _ => format!("the report needs signal `{name}`, which {folder} does not hold"),
        };
        let help = "record it: `--record-signals` chooses what is recorded".to_owned();
        return Err(Usage::new(message, known.is_none_or(|signal| !signal.recorded).then_some(help)).into());
    }
    let exact = |(name, _): (&SignalName, _)| name.as_str().parse();
    let exact: Result<Vec<SignalPattern>, EmptyPattern> = measures.signals().map(exact).collect();
    exact.map_err(|empty| Usage::new(empty.to_string(), None).into())
}

impl Recorded {
    fn name(&self) -> String {
        let case = self.case.as_ref().map(|case| format!(" {case}")).unwrap_or_default();
        format!("{}{case}", self.scenario)
    }

    fn write(&self, format: Format, out: &mut dyn Write) -> std::io::Result<()> {
        match format {
            Format::Json => {
                serde_json::to_writer(&mut *out, self)?;
                writeln!(out)?;
            }
            Format::Human => {
                writeln!(out, "{}: {}, {} steps", self.recording, self.name(), self.steps)?;
                tables::write(&self.report, out)?;
            }
        }
        out.flush()
    }

    fn section(&self) -> Section {
        Section {
            title: format!("{}: {}", self.recording, self.name()),
            steps: Some(self.steps),
            virtual_time: VirtualTime::from_nanos(self.report.to_ns).to_string(),
            tables: tables::for_pages(&self.report),
            pictures: pictures::of(&self.report),
            ..Section::default()
        }
    }
}

fn page(all: &[Recorded]) -> Page {
    Page {
        title: all.first().map_or_else(String::new, |first| first.scenario.clone()),
        totals: format!("{} recording{}", all.len(), if all.len() == 1 { "" } else { "s" }),
        sections: all.iter().map(Recorded::section).collect(),
        charts: charts(),
        ..Page::default()
    }
}
