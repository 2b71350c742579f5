//! A hall of fifty belts with 500 light barriers and 1,000 parcels in steps of 10 ms, with and without `sleeping`, beside
//! the filling machine in the same run: machines differ by a factor of two, so what counts is the ratio.
//!
//! `cargo bench -p onescan-tests --bench hall`

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use onescan_plant::Plant;
use onescan_scenario::Scenario;
use onescan_server::client::Client;
use onescan_server::signal::PortLayout;
use onescan_server::time::VirtualTime;
use onescan_tests::bench::session_of;
use onescan_tests::{client, span_ms};

const STEP_MS: u64 = 10;
const BELTS: usize = 50;
const PARCELS: usize = 20;
const BARRIERS: usize = 10;
/// Virtual time of a run of the hall.
const HALL_S: u64 = 10;
/// Virtual time of a run of the filling machine.
const FILLING_S: u64 = 60;
/// What the filling machine's hour takes on the machine that figures are stated for.
const FILLING_HOUR_S: f64 = 18.0;

/// Belts of 30 m side by side; every second one ends at a stop, so that its parcels queue.
fn hall(sleeping: bool) -> String {
    let mut scene = format!(
        "version = 1\nsleeping = {sleeping}\n[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\n\
         size_m = [100, 200, 1]\nposition_m = [10, 0, -1.0]\n"
    );
    for belt in 0..BELTS {
        let y = belt as f64 * 1.5 - 37.5;
        let bodies = format!(
            "[[body]]\nname = \"belt_{belt}\"\nkind = \"kinematic\"\nshape = \"box\"\nsize_m = [30, 0.6, 0.1]\n\
             position_m = [10, {y}, -0.05]\nfriction = 0.6\n\
             [[body]]\nname = \"parcel_{belt}[0..{last}]\"\nkind = \"dynamic\"\nshape = \"box\"\n\
             size_m = [0.4, 0.3, 0.3]\nmass_kg = 2.0\nposition_m = [-4, {y}, 0.151]\nstep_m = [0.8, 0, 0]\n\
             [[component]]\nname = \"conveyor_{belt}\"\nkind = \"conveyor\"\nbelt = \"belt_{belt}\"\n\
             direction = [1, 0, 0]\nspeed_m_s = 0.5\nrun_signal = \"run\"\n",
            last = PARCELS - 1
        );
        scene.push_str(&bodies);
        if belt % 2 == 1 {
            // A string takes all.
            let _ = writeln!(
                scene,
                "[[body]]\nname = \"stop_{belt}\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 0.6, 0.3]\n\
                 position_m = [14, {y}, 0.16]"
            );
        }
        for barrier in 0..BARRIERS {
            let x = barrier as f64 * 2.0 - 3.0;
            let _ = writeln!(
                scene,
                "[[component]]\nname = \"eye_{belt}_{barrier}\"\nkind = \"light_barrier\"\n\
                 point_m = [{x}, {from}, 0.1]\ndirection = [0, 1, 0]\nrange_m = 1.0\n\
                 detected_signal = \"eye_{belt}_{barrier}\"",
                from = y - 0.5
            );
        }
    }
    scene
}

/// Seconds for a virtual second of the hall.
fn hall_s(sleeping: bool) -> f64 {
    let scene = hall(sleeping);
    let mut plant = Plant::parse(&scene, "hall.toml", client("plant"), span_ms(STEP_MS)).expect("a scene");
    let join = plant.join();
    let (reads, writes) = (PortLayout::new(join.reads), PortLayout::new(join.writes));
    let (mut inputs, mut outputs) = (vec![0; reads.size()], vec![0; writes.size()]);
    reads.slot::<bool>("run").expect("an input").set(&mut inputs, true);
    plant.setup(&mut outputs).expect("a set-up");
    let started = Instant::now();
    for step in 1..=HALL_S * 1000 / STEP_MS {
        plant.turn(VirtualTime::from_nanos(step * STEP_MS * 1_000_000), &inputs, &mut outputs).expect("a turn");
    }
    started.elapsed().as_secs_f64() / HALL_S as f64
}

/// Seconds for an hour of the filling machine.
fn filling_hour_s() -> f64 {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/filling-machine");
    let scenario = Scenario::load(&folder).expect("a scenario");
    let mut lockstep = session_of(&scenario, FILLING_S);
    let started = Instant::now();
    lockstep.run().expect("nothing is recorded");
    started.elapsed().as_secs_f64() * 3600.0 / FILLING_S as f64
}

fn main() {
    let mut hours: Vec<f64> = Vec::new();
    let mut halls: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    // in turns, so that whatever else the machine does burdens all alike
    for _ in 0..3 {
        hours.push(filling_hour_s());
        for (sleeping, times) in [false, true].into_iter().zip(&mut halls) {
            times.push(hall_s(sleeping));
        }
    }
    let least = |times: &[f64]| times.iter().copied().fold(f64::INFINITY, f64::min);
    let hour_s = least(&hours);
    println!("an hour of the filling machine: {hour_s:.1} s");
    for (what, times) in ["awake", "sleeping"].into_iter().zip(&halls) {
        let second_s = least(times);
        let stated = hour_s / FILLING_HOUR_S / second_s;
        println!(
            "{BELTS} belts, {} light barriers, {} parcels, {what}: {:.2} ms a step, {:.1} x real time; {stated:.1} x \
             where the filling machine's hour takes {FILLING_HOUR_S} s",
            BELTS * BARRIERS,
            BELTS * PARCELS,
            second_s * STEP_MS as f64,
            second_s.recip()
        );
    }
}
