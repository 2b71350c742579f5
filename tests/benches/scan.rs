//! Time of one scan of the shear's two programs, beside a bare function call through the same
//! interface.
//!
//! `cargo bench -p onescan-tests --bench scan`

use std::path::Path;
use std::time::Instant;

use criterion::{Criterion, Throughput};
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::Client;
use onescan_server::signal::PortLayout;
use onescan_server::time::VirtualTime;
use onescan_tests::bench::{Ledger, two_carriers};
use onescan_tests::client;

fn shear_plc() -> Box<dyn Client> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/shear");
    let scenario = Scenario::load(&folder).expect("the shear is a scenario");
    match scenario.member(&client("plc")).expect("it has a PLC") {
        Member::Plc(plc) => plc,
        _ => panic!("the plc of the shear is a soft PLC"),
    }
}

fn main() {
    let ledger = Ledger::default();
    let (_, [carrier, _]) = two_carriers(20);
    let cases: [(&'static str, Box<dyn Client>); 2] =
        [("scan of the shear", shear_plc()), ("bare call", Box::new(carrier))];
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("scan");
    group.throughput(Throughput::Elements(1));
    for (what, mut client) in cases {
        let request = client.join();
        let inputs = vec![0; PortLayout::new(request.reads).size()];
        let mut outputs = vec![0; PortLayout::new(request.writes).size()];
        client.setup(&mut outputs).expect("it starts");
        let mut t_v = VirtualTime::ZERO;
        group.bench_function(what, |bencher| {
            bencher.iter_custom(|scans| {
                let started = Instant::now();
                for _ in 0..scans {
                    t_v = t_v + request.period;
                    client.turn(t_v, &inputs, &mut outputs).expect("it runs");
                }
                ledger.note(what, started.elapsed(), scans);
                started.elapsed()
            });
        });
    }
    group.finish();
    criterion.final_summary();
    ledger.compare("scan of the shear", "bare call");
}
