//! One unit of work, in a process of its own.

use std::cell::RefCell;
use std::io::Write;
use std::path::Path;
use std::rc::Rc;

use onescan_report::OutputError;
use onescan_scenario::Scenario;
use onescan_scenario::case::{Catalogue, DEFAULT};
use onescan_server::signal::pattern::SignalPattern;

use super::TestError;
use super::config::WorkerConfig;
use super::limited::end_with_parent;
use super::ran::{Covered, Ran, Worked};
use super::unit_test;
use crate::snapshot::take::{Choice, Taker};
use onescan_runner::interrupt::Interrupt;
use onescan_runner::run::config::{Drawing, Picture};
use onescan_runner::run::page::Event;
use onescan_runner::run::{RunConfig, watched};

/// Does the work and writes what came of it to `out`.
///
/// # Errors
/// The input is wrong.
pub fn work(config: &WorkerConfig, out: &mut dyn Write) -> Result<(), TestError> {
    end_with_parent()?;
    let worked = match &config.scenario {
        Some(scenario) => case(config, scenario)?,
        None => unit_test::run(config)?,
    };
    serde_json::to_writer(&mut *out, &worked).map_err(|error| OutputError(error.into()))?;
    Ok(out.flush().map_err(OutputError)?)
}

fn case(config: &WorkerConfig, folder: &Path) -> Result<Worked, TestError> {
    let mut scenario = Scenario::load_case(folder, config.case.as_deref())?;
    if config.cover {
        scenario.cover();
    }
    let catalogue = Catalogue::load(scenario.path())?;
    let choice = Choice::of(&scenario, &catalogue)?;
    let snapshot = Rc::new(RefCell::new(None));
    let taker = Taker::new(&scenario, choice.clone(), Rc::clone(&snapshot));
    let mut run = RunConfig::headless(folder.to_owned(), config.case.clone());
    if config.draw {
        let signals = choice.signals.iter().map(SignalPattern::from).collect();
        run.picture = Picture { drawing: Drawing::Kept, signals, ..Picture::default() };
    }
    let (report, plot) = watched(&run, &scenario, &Interrupt::new(), vec![Box::new(taker)])?;
    let mut ran = Ran::of(config.case.as_deref().unwrap_or(DEFAULT), &report, scenario.file().step.as_nanos());
    ran.snapshot = snapshot.borrow().as_ref().map(crate::snapshot::Snapshot::to_text);
    ran.picture = config.draw.then(|| plot.to_svg());
    ran.chart = config.draw.then(|| plot.to_chart());
    ran.events = scenario.case_events().into_iter().map(|(at_ns, text)| Event { at_ns, text }).collect();
    let coverage =
        scenario.coverage().map(|sink| Covered::all(&sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner)));
    Ok(Worked { tests: vec![ran], coverage: coverage.unwrap_or_default(), error: None })
}
