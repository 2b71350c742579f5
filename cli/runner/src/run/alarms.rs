//! The alarms of a run, noted for its page at the step at which they come and go.

use onescan_scenario::Scenario;
use onescan_scenario::panel_file::ElementKind;
use onescan_scenario::report::{Bell, Measures};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::lockstep::Lockstep;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::session::Session;
use onescan_server::signal::SignalName;

use super::chosen::Chosen;
use crate::web::AlarmLog;

/// Shows a session to its bell, and notes in a log what it says.
struct Ringer {
    log: AlarmLog,
    bell: Bell,
    measures: Measures,
    signals: Chosen,
    /// The signals with which panels acknowledge.
    keys: Chosen,
    is_pressed: bool,
}

/// Notes in a log the alarms of a session that is about to begin, if its scenario has any.
pub(crate) fn note(log: &AlarmLog, scenario: &Scenario, lockstep: &mut Lockstep) {
    let Some(measures) = scenario.measures().filter(|measures| !measures.alarms().is_empty()) else { return };
    let names: Vec<SignalName> = measures.signals().map(|(name, _)| name.clone()).collect();
    let elements = scenario.file().panel.iter().flat_map(|panel| &panel.element);
    let alarms = elements.map(toml::Spanned::get_ref).filter(|element| element.kind == ElementKind::Alarms);
    let mut keys: Vec<SignalName> =
        alarms.filter_map(|element| Some(element.signal.as_ref()?.get_ref().clone())).collect();
    keys.sort();
    keys.dedup();
    lockstep.observe(Box::new(Ringer {
        log: log.clone(),
        bell: Bell::new(measures),
        measures: measures.clone(),
        signals: Chosen::new(&names),
        keys: Chosen::new(&keys),
        is_pressed: false,
    }));
}

impl Ringer {
    fn look(&mut self, session: &Session) {
        let t_ns = session.t_v().as_nanos();
        let passages = self.bell.push(t_ns, self.signals.bytes(session));
        if !passages.is_empty() {
            self.log.take(&passages);
        }
        let is_pressed = self.keys.numbers(session).any(|value| value != 0.0);
        if is_pressed && !self.is_pressed {
            self.log.acknowledge(0..self.measures.alarms().len(), t_ns);
        }
        self.is_pressed = is_pressed;
    }
}

impl Observer for Ringer {
    fn begin(&mut self, session: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        self.log.begin();
        self.bell = Bell::new(&self.measures);
        self.signals.find(session);
        self.keys.find(session);
        self.is_pressed = false;
        self.look(session);
        Ok(())
    }

    fn step(&mut self, session: &Session, _: &TrajectoryDigest) -> Result<(), RecordError> {
        self.look(session);
        Ok(())
    }

    fn end(&mut self, _: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}
