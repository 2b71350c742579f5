//! Steps a second with a real PLC behind a gateway, over each link, beside a bare write and read of the same points by
//! the same library on the same server, in the same run. The PLC is the shear's, in this process, with one cycle behind
//! the other.
//!
//! `cargo bench -p onescan-tests --bench links`

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use onescan_iec_run::SoftPlc;
use onescan_links::gateway::exchange::Direction;
use onescan_links::gateway::modbus::RegisterMap;
use onescan_links::gateway::tcp::Layouts;
use onescan_links::gateway::{Exchange, Gateway, Link, Patience, Settings};
use onescan_links::opcua::Access;
use onescan_links::station::{Clockwork, Controller, Wires, ads, modbus, opcua, tcp};
use onescan_scenario::{Mode, Scenario};
use onescan_server::client::{Client, JoinRequest};
use onescan_server::time::VirtualTime;
use onescan_tests::bench::Ledger;
use onescan_tests::run::loopback;
use onescan_tests::{client, port, span_ms};

/// Steps of one measurement, and how often it is taken; the median counts.
const STEPS: u64 = 2_000;
const ROUNDS: usize = 7;
const STEP_NS: u64 = 10_000_000;

/// The shear's PLC, served over all links.
struct Station {
    exchange: Exchange,
    settings: Settings,
    request: JoinRequest,
    urls: BTreeMap<&'static str, String>,
    _opcua: Box<dyn onescan_links::station::opcua::ServedPlc>,
    _clockwork: Clockwork,
}

fn station() -> Station {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/shear");
    let scenario = Scenario::load(&folder).expect("the shear");
    let program = scenario.instrumented(&client("plc"), Mode::Lockstep).expect("it is instrumented");
    let plc = SoftPlc::new(&program.application, &program.plan).expect("it runs");
    let wires = Wires::new(&program.exchange, &program.application, &program.bindings).expect("it has the shim");
    let controller = Arc::new(Controller::new(plc, wires));
    let layouts = Layouts::new(&program.settings.layout, &program.exchange).expect("a layout");
    let map = RegisterMap::new(&program.settings.modbus, &program.exchange).expect("a map");
    let tcp = tcp::serve(loopback(), &controller, tcp::Blocks { layouts, push: None }).expect("a free port");
    let modbus = modbus::serve(loopback(), &controller, map).expect("a free port");
    let ads = ads::serve(loopback(), &controller, &program.settings.ads).expect("a free port");
    let opcua = opcua::serve(loopback(), &controller, &Access::default()).expect("a free port");
    let urls = BTreeMap::from([
        ("raw TCP", format!("tcp://{tcp}")),
        ("Modbus TCP", format!("modbus://{modbus}")),
        ("ADS", format!("ads://{ads}")),
        ("OPC UA", format!("opc.tcp://{}", opcua.address())),
    ]);
    let ports = |bound: &[onescan_soft_plc::bind::Bound]| {
        bound.iter().map(|bound| port(bound.port.name.as_str(), bound.port.ty)).collect()
    };
    let (reads, writes) = (ports(&program.bindings.inputs), ports(&program.bindings.outputs));
    let request = JoinRequest { name: client("plc"), period: span_ms(10), reads, writes };
    Station {
        exchange: program.exchange,
        settings: program.settings,
        request,
        urls,
        _opcua: opcua,
        _clockwork: Clockwork::start(controller, None).expect("a thread"),
    }
}

impl Station {
    fn link(&self, name: &str) -> Box<dyn Link> {
        let settings = Settings { url: self.urls[name].clone(), ..self.settings.clone() };
        settings.link(&self.exchange).expect("a link")
    }
}

/// A write and a read of all points, again and again, and nothing else. What is written changes in every step, as
/// inputs do; it asks for nothing.
fn bare(station: &Station, name: &str) -> Duration {
    let mut link = station.link(name);
    link.connect().expect("the station is there");
    let exchange = &station.exchange;
    let (mut to, mut from) = (vec![0; exchange.size(Direction::ToPlc)], vec![0; exchange.size(Direction::FromPlc)]);
    let started = Instant::now();
    for step in 0..STEPS {
        to[..8].copy_from_slice(&(step as f64).to_le_bytes());
        link.write(&to).expect("connected");
        while !link.read(Duration::from_secs(5), &mut from).expect("connected") {}
    }
    started.elapsed()
}

/// The gateway's steps, from a cold start.
fn lockstep(station: &Station, name: &str) -> Duration {
    let mut gateway =
        Gateway::new(station.request.clone(), station.exchange.clone(), station.link(name), Patience::default());
    gateway.connect().expect("the station is there");
    let size = |ports: &[onescan_server::signal::Port]| ports.iter().map(|port| port.ty.size()).sum();
    let (mut inputs, mut outputs): (Vec<u8>, Vec<u8>) =
        (vec![0; size(&station.request.reads)], vec![0; size(&station.request.writes)]);
    gateway.setup(&mut outputs).expect("it starts");
    let started = Instant::now();
    for step in 1..=STEPS {
        inputs[..8].copy_from_slice(&(step as f64).to_le_bytes());
        gateway.turn(VirtualTime::from_nanos(step * STEP_NS), &inputs, &mut outputs).expect("it is answered");
    }
    started.elapsed()
}

fn main() {
    onescan_opc_ua::install();
    let station = station();
    let ledger = Ledger::default();
    let pairs = [
        ("lockstep over raw TCP", "bare blocks to and fro", "raw TCP"),
        ("lockstep over Modbus TCP", "bare registers to and fro", "Modbus TCP"),
        ("lockstep over ADS", "bare sum commands", "ADS"),
        ("lockstep over OPC UA", "bare Write and Read", "OPC UA"),
    ];
    for _ in 0..ROUNDS {
        for (own, reference, name) in pairs {
            ledger.note(reference, bare(&station, name), STEPS);
            ledger.note(own, lockstep(&station, name), STEPS);
        }
    }
    for (own, reference, _) in pairs {
        ledger.compare(own, reference);
    }
}
