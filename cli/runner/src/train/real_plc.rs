//! The real PLCs of a lesson. Nobody can save or load their state, so they stay connected from attempt to attempt and are
//! driven to where one begins. What is kept of one in a checkpoint says where it stood: it goes on from there, and from nowhere
//! else.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_links::gateway::HandshakeKind;
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::error::TrainError;
use crate::error::Usage;

/// Steps after which it is looked whether somebody wants the program to end, and said how far a real PLC is.
pub(super) const STEPS_AT_A_TIME: u64 = 64;

/// The real PLCs of a session of training.
#[derive(Default)]
pub(super) struct RealPlcs(Vec<(ClientName, RealPlc)>);

/// One of them, in whatever session is under way.
#[derive(Clone)]
struct RealPlc(Arc<Mutex<Connected>>);

/// Where a PLC stands: how often it was started here, and up to when it has run since; nothing while that is not known.
type Standing = Option<(u64, VirtualTime)>;

struct Connected {
    client: Box<dyn Client>,
    starts: u64,
    standing: Standing,
}

impl RealPlcs {
    /// Those of the scenario, connected.
    ///
    /// # Errors
    /// One cannot be reached, or cannot take part in lessons.
    pub(super) fn connect(scenario: &Scenario) -> Result<Self, TrainError> {
        let mut all = Vec::new();
        for name in scenario.plan().clients().iter().filter(|name| scenario.is_real_plc(name)) {
            if scenario.declared(name).handshake == HandshakeKind::Frames {
                let message = format!(
                    "the blocks of client `{name}` are counted (`handshake = \"frames\"`), so that nobody knows which of its \
                     scans saw what: no lesson can begin with it twice in the same state"
                );
                let help = "lessons need a PLC that runs the instrumented program (docs/gateway.md), or the soft PLC";
                return Err(Usage::new(message, Some(help.to_owned())).into());
            }
            if let Member::Gateway(client) = scenario.member(name)? {
                let connected = Connected { client, starts: 0, standing: None };
                all.push((name.clone(), RealPlc(Arc::new(Mutex::new(connected)))));
            }
        }
        Ok(Self(all))
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &ClientName> {
        self.0.iter().map(|(name, _)| name)
    }

    /// The PLC `name` as a client of another session.
    pub(super) fn client(&self, name: &ClientName) -> Option<Box<dyn Client>> {
        let (_, plc) = self.0.iter().find(|(known, _)| known == name)?;
        Some(Box::new(plc.clone()))
    }
}

impl RealPlc {
    /// A thread that panicked here has left the PLC where it does not say that it stands.
    fn lock(&self) -> MutexGuard<'_, Connected> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Where it stands as the bytes of a checkpoint.
fn to_bytes((starts, t_v): (u64, VirtualTime)) -> Vec<u8> {
    [starts.to_le_bytes(), t_v.as_nanos().to_le_bytes()].concat()
}

impl Client for RealPlc {
    fn join(&self) -> JoinRequest {
        self.lock().client.join()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        let mut plc = self.lock();
        plc.standing = None;
        plc.client.setup(outputs)?;
        plc.starts += 1;
        plc.standing = Some((plc.starts, VirtualTime::ZERO));
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let mut plc = self.lock();
        plc.standing = None;
        let wake = plc.client.turn(t_v, inputs, outputs)?;
        plc.standing = Some((plc.starts, t_v));
        Ok(wake)
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        let standing = self.lock().standing;
        standing.map(to_bytes).ok_or_else(|| StateError::Refused(ClientFault::new("nobody knows how far it has run")))
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        match self.lock().standing {
            Some(standing) if to_bytes(standing) == state => Ok(()),
            _ => Err(StateError::Refused(ClientFault::new(
                "a real PLC goes on from where it stands, and it has gone on",
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Plc;

    impl Client for Plc {
        fn join(&self) -> JoinRequest {
            let name = ClientName::new("plc").expect("a name");
            JoinRequest { name, period: onescan_server::time::TimeSpan::millis::<10>(), reads: vec![], writes: vec![] }
        }

        fn setup(&mut self, _: &mut [u8]) -> Result<(), ClientFault> {
            Ok(())
        }

        fn turn(&mut self, t_v: VirtualTime, _: &[u8], _: &mut [u8]) -> Result<Wake, ClientFault> {
            if t_v > at(20) { Err(ClientFault::new("it is gone")) } else { Ok(Wake::NextPeriod) }
        }
    }

    fn at(ms: u64) -> VirtualTime {
        VirtualTime::from_nanos(ms * 1_000_000)
    }

    /// It goes on from where it stands, in another session too; not from where it stood, nor after another start, nor when
    /// nobody knows.
    #[test]
    fn it_goes_on_from_where_it_stands() {
        let connected = Connected { client: Box::new(Plc), starts: 0, standing: None };
        let mut plc = RealPlc(Arc::new(Mutex::new(connected)));
        let mut other = plc.clone();
        assert!(plc.save().is_err(), "it has not been started here");
        plc.setup(&mut []).unwrap();
        plc.turn(at(10), &[], &mut []).unwrap();
        let early = plc.save().unwrap();
        assert_eq!(other.restore(&early), Ok(()));
        other.turn(at(20), &[], &mut []).unwrap();
        assert!(plc.restore(&early).is_err(), "it has gone on");
        plc.setup(&mut []).unwrap();
        plc.turn(at(10), &[], &mut []).unwrap();
        assert!(plc.restore(&early).is_err(), "started once more");
        plc.turn(at(30), &[], &mut []).unwrap_err();
        assert!(plc.save().is_err(), "it may have run, or not");
        assert!(plc.restore(&early).is_err());
    }
}
