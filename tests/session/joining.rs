//! Who may not join receives the reason.

use onescan_server::client::JoinRequest;
use onescan_server::formation::{Formation, FormationError};
use onescan_server::plan::Coupling;
use onescan_server::session::Session;
use onescan_server::signal::{Port, SignalType as T};
use onescan_tests::run::boxed;
use onescan_tests::toy::{Mixer, ring_plan};
use onescan_tests::{client, plan, port, span_ms};

fn session() -> Session {
    let signals = [("Sensor_1", T::BOOL, "plant"), ("Position_1", T::LREAL, "plant"), ("Drive_1", T::LREAL, "plc")];
    Session::new(plan(span_ms(10), &Coupling::Parallel, &signals, &["plant", "plc"]))
}

fn refusal(name: &str, period_ms: u64, reads: &[(&str, T)], writes: &[(&str, T)]) -> String {
    let ports = |ports: &[(&str, T)]| -> Vec<Port> { ports.iter().map(|(n, t)| port(n, *t)).collect() };
    let (reads, writes) = (ports(reads), ports(writes));
    let request = JoinRequest { name: client(name), period: span_ms(period_ms), reads, writes };
    session().join(&request).map_or_else(|refusal| refusal.to_string(), |_| String::new())
}

#[test]
fn every_refusal_says_what_is_wrong() {
    let cases = [
        refusal("plnat", 10, &[], &[]),
        refusal("plant", 15, &[], &[]),
        refusal("plc", 10, &[("Senosr_1", T::BOOL)], &[]),
        refusal("plc", 10, &[("Sensor_1", T::INT)], &[]),
        refusal("plc", 10, &[], &[("Sensor_1", T::BOOL)]),
        refusal("plc", 10, &[("Sensor_1", T::BOOL), ("Sensor_1", T::BOOL)], &[]),
        refusal("plant", 10, &[], &[("Sensor_1", T::BOOL)]),
        refusal("plant", 20, &[("Drive_1", T::LREAL)], &[("Sensor_1", T::BOOL), ("Position_1", T::LREAL)]),
    ];
    insta::assert_snapshot!(cases.join("\n"));
}

#[test]
fn nobody_joins_twice_or_late() {
    let mut session = session();
    let writes = vec![port("Sensor_1", T::BOOL), port("Position_1", T::LREAL)];
    let request = JoinRequest { name: client("plant"), period: span_ms(10), reads: vec![], writes };
    session.join(&request).unwrap();
    assert_eq!(session.join(&request).unwrap_err().to_string(), "client `plant` has already joined");
}

#[test]
fn a_signal_without_writer_or_a_missing_client_keeps_a_session_from_starting() {
    let mut formation = Formation::new(ring_plan(&Coupling::Parallel));
    for client in boxed([Mixer::new("alpha", span_ms(10), &[]), Mixer::new("beta", span_ms(10), &[])]) {
        formation.join(client).unwrap();
    }
    match formation.start() {
        Err(FormationError::Missing { missing, .. }) => assert_eq!(missing, "`gamma`"),
        _ => panic!("gamma is missing"),
    }
}
