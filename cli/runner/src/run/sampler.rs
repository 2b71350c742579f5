//! Chosen signals of every step as numbers, and the plot of several runs.

use std::cell::RefCell;
use std::rc::Rc;

use onescan_report::plot::{Mark, Panel, Plot, Shape, Trajectory};
use onescan_scenario::{Mode, Scenario};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::session::Session;
use onescan_server::signal::{SignalName, SignalType};

use super::chosen::Chosen;
use super::config::{Picture, RunsDrawn};
use super::report::RunReport;
use crate::error::Usage;

/// Chosen signals of one run.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    pub names: Vec<SignalName>,
    pub t_ns: Vec<u64>,
    /// A row a signal.
    pub values: Vec<Vec<f64>>,
}

impl Samples {
    pub(super) fn new(names: &[SignalName]) -> Self {
        Self { names: names.to_vec(), t_ns: Vec::new(), values: vec![Vec::new(); names.len()] }
    }
}

/// Takes a sample of a session at every step.
pub(super) struct Sampler {
    samples: Rc<RefCell<Samples>>,
    chosen: Chosen,
}

impl Sampler {
    pub(super) fn new(samples: Rc<RefCell<Samples>>) -> Self {
        let chosen = Chosen::new(&samples.borrow().names);
        Self { samples, chosen }
    }
}

impl Observer for Sampler {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.chosen.find(session);
        self.samples.replace(Samples::new(self.chosen.names()));
        self.step(session, digest)
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        let mut samples = self.samples.borrow_mut();
        samples.t_ns.push(session.t_v().as_nanos());
        for (row, number) in samples.values.iter_mut().zip(self.chosen.numbers(session)) {
            row.push(number);
        }
        Ok(())
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}

/// The picture of a plot: over time, or in the plane that was asked for.
///
/// If no run comes to the part that was to be enlarged, it is the picture without it, and why.
pub(super) fn picture(
    scenario: &Scenario,
    mode: Mode,
    picture: &Picture,
    runs: &[Samples],
    reports: &[RunReport],
) -> (String, Option<Usage>) {
    let plot = plot(scenario, mode, picture, runs, reports);
    let plot = match (&picture.plane, picture.runs) {
        (Some(plane), _) => {
            let panels = plane.iter().map(|name| panel(scenario, name, runs.iter())).collect();
            Plot { panels, ..plot }
        }
        (None, RunsDrawn::Overlaid) => plot,
        (None, RunsDrawn::Apart) => apart(plot),
    };
    drawn(&plot, picture)
}

/// A plot as a picture, with a part of it enlarged if that was asked for; the whole and why if that part is empty.
pub(crate) fn drawn(plot: &Plot, picture: &Picture) -> (String, Option<Usage>) {
    let whole = || picture.plane.as_ref().and_then(|_| plot.to_plane_svg()).unwrap_or_else(|| plot.to_svg());
    match picture.enlarged.map(|part| plot.to_svg_enlarging(part)) {
        None => (whole(), None),
        Some(Ok(svg)) => (svg, None),
        Some(Err(nothing)) => (whole(), Some(Usage::new(format!("--enlarge: {nothing}"), Some(nothing.drawn)))),
    }
}

/// The same with each run in panels of its own.
fn apart(plot: Plot) -> Plot {
    let Plot { title, runs, panels, marks } = plot;
    let of_run = |run: usize, name: &str, panel: &Panel| Panel {
        signal: format!("{name}: {}", panel.signal),
        runs: panel.runs.get(run).cloned().into_iter().collect(),
        ..panel.clone()
    };
    let each = runs.iter().enumerate().flat_map(|(run, name)| panels.iter().map(move |panel| of_run(run, name, panel)));
    Plot { title, panels: each.collect(), runs: vec!["a run each".to_owned()], marks }
}

/// A signal of several runs.
pub fn panel<'r>(scenario: &Scenario, name: &SignalName, runs: impl Iterator<Item = &'r Samples>) -> Panel {
    let signal = scenario.file().signals.get(name).map(toml::Spanned::get_ref);
    let trajectory = |run: &Samples| {
        let row = run.names.iter().position(|known| known == name);
        let values = row.and_then(|row| run.values.get(row).cloned()).unwrap_or_default();
        Trajectory { t_ns: run.t_ns.clone(), values }
    };
    Panel {
        shape: signal.map_or(Shape::Line, |signal| shape(signal.ty)),
        unit: signal.and_then(|signal| signal.unit.clone()),
        names: signal.map(|signal| signal.names.pairs()).unwrap_or_default(),
        signal: name.to_string(),
        runs: runs.map(trajectory).collect(),
    }
}

/// The plot of several runs, laid over each other.
pub(super) fn plot(
    scenario: &Scenario,
    mode: Mode,
    picture: &Picture,
    runs: &[Samples],
    reports: &[RunReport],
) -> Plot {
    let mode = match mode {
        Mode::Lockstep => "lockstep",
        Mode::Freewheel => "free-wheeling",
        Mode::Halt => "held by a timer",
        Mode::Follow => "following the PLC's clock",
    };
    let count = match runs.len() {
        1 => String::new(),
        n => format!(", {n} runs"),
    };
    let panels = picture.plotted(scenario).into_iter().map(|name| panel(scenario, &name, runs.iter()));
    Plot {
        title: format!("{}: {mode}{count}", scenario.name()),
        runs: (1..=runs.len()).map(|number| format!("run {number}")).collect(),
        panels: panels.collect(),
        marks: marks(reports),
    }
}

/// Where runs first went against an expectation; once for those that did so at one time.
fn marks(reports: &[RunReport]) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    for expectation in reports.iter().flat_map(|report| &report.expectations) {
        let Some(at) = expectation.at else { continue };
        let mark = Mark { t_ns: at.as_nanos(), label: format!("`{}` violated", expectation.name) };
        if !marks.contains(&mark) {
            marks.push(mark);
        }
    }
    marks
}

/// Numbers with a fraction change between samples; everything else jumps.
pub(super) fn shape(ty: SignalType) -> Shape {
    match ty {
        SignalType::REAL | SignalType::LREAL => Shape::Line,
        _ => Shape::Step,
    }
}
