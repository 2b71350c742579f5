//! What a run produced, by its scenario's `[report]`: measured as the run goes, reported to people and in pages.
//!
//! | module | subject |
//! |---|---|
//! | this file | a run shown to its meter |
//! | [`tables`] | the report as tables, for terminals and pages |
//! | [`pictures`] | the report as pictures |

pub mod pictures;
pub mod tables;

use std::cell::RefCell;
use std::rc::Rc;

use onescan_scenario::report::{Measures, Meter, Report};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::layout::ImageLayout;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::session::Session;

use super::chosen::Chosen;

/// The meter of a run; nothing if its scenario asks for no report.
#[derive(Clone, Default)]
pub struct Metered(Option<Rc<RefCell<Meter>>>);

impl Metered {
    /// Meters what a scenario counts; without measures nothing is metered.
    pub fn new(measures: Option<&Measures>) -> Self {
        Self(measures.map(|measures| Rc::new(RefCell::new(Meter::new(measures)))))
    }

    /// What shows it the run.
    pub(crate) fn observer(&self, measures: Option<&Measures>) -> Option<Box<dyn Observer>> {
        Some(Box::new(self.metering(measures)?))
    }

    /// The same, for one who shows it images.
    pub fn metering(&self, measures: Option<&Measures>) -> Option<Metering> {
        let (meter, measures) = (self.0.as_ref()?, measures?);
        let names: Vec<_> = measures.signals().map(|(name, _)| name.clone()).collect();
        let chosen = Chosen::new(&names);
        Some(Metering { meter: Rc::clone(meter), measures: measures.clone(), chosen })
    }

    /// What came of the run.
    pub fn report(&self) -> Option<Report> {
        self.0.as_ref()?.borrow().report()
    }
}

/// Shows a run to its meter.
pub struct Metering {
    meter: Rc<RefCell<Meter>>,
    measures: Measures,
    chosen: Chosen,
}

impl Metering {
    /// Finds its signals in a session that begins.
    pub fn find(&mut self, session: &Session) {
        self.chosen.find(session);
    }

    /// Forgets what it has seen: the run begins here.
    pub fn begin_here(&mut self) {
        self.meter.replace(Meter::new(&self.measures));
    }

    /// Shows it the next image of the session with which it began.
    pub fn look(&mut self, t_ns: u64, layout: &ImageLayout, image: &[u8]) {
        self.meter.borrow_mut().push(t_ns, self.chosen.bytes_in(layout, image));
    }
}

impl Observer for Metering {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.find(session);
        self.begin_here();
        self.step(session, digest)
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.look(session.t_v().as_nanos(), session.layout(), session.image());
        Ok(())
    }

    /// All that it measures begins and ends where a value changes, or by a delay that is reckoned from there.
    fn wants_idle_steps(&self) -> bool {
        false
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
