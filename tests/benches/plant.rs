//! A plant with 300 dynamic bodies, each in contact and none asleep, beside bare Rapier with the same
//! bodies and options in the same run; both stand in the same pose at the end.
//!
//! `cargo bench -p onescan-tests --bench plant`

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;
use onescan_plant::Plant;
use onescan_server::client::Client;
use onescan_server::time::VirtualTime;
use onescan_tests::bench::Ledger;
use onescan_tests::{client, span_ms};
use rapier3d::math::Vector;
use rapier3d::prelude::*;

const STEP_MS: u64 = 10;
/// Until the boxes rest on each other.
const WARM_UP: u64 = 100;
/// A hundred stacks of three.
const SIDE: usize = 10;
const LAYERS: usize = 3;
const EDGE_M: f64 = 0.1;
const GAP_M: f64 = 0.15;

const FLOOR: &str = r#"
version = 1
[[body]]
name = "floor"
kind = "fixed"
shape = "box"
size_m = [10, 10, 1]
position_m = [0, 0, -0.5]
"#;

fn scene() -> String {
    let row = |(row, layer): (usize, usize)| {
        let [x, y, z] = place(0, row, layer);
        format!(
            "[[body]]\nname = \"box_{row}_{layer}[0..{}]\"\nkind = \"dynamic\"\nshape = \"box\"\nmass_kg = 1.0\n\
             size_m = [{EDGE_M}, {EDGE_M}, {EDGE_M}]\nposition_m = [{x}, {y}, {z}]\nstep_m = [{GAP_M}, 0, 0]\n",
            SIDE - 1
        )
    };
    let boxes: Vec<String> = rows().map(row).collect();
    format!("{FLOOR}{}", boxes.concat())
}

fn rows() -> impl Iterator<Item = (usize, usize)> {
    (0..LAYERS).flat_map(|layer| (0..SIDE).map(move |row| (row, layer)))
}

/// Where a box begins: a little above what it will rest on.
fn place(column: usize, row: usize, layer: usize) -> [f64; 3] {
    [column as f64 * GAP_M, row as f64 * GAP_M, 0.051 + layer as f64 * 0.101]
}

/// The same world, built by hand as a plant builds it.
fn bare() -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let mut physics = PhysicsWorld::new();
    physics.gravity = Vector::new(0.0, 0.0, -9.81);
    let dt = STEP_MS as f64 * 1e-3;
    let firm = |usual: SpringCoefficients<f64>, hertz: f64| SpringCoefficients {
        natural_frequency: hertz.max(usual.natural_frequency),
        ..usual
    };
    physics.integration_parameters = IntegrationParameters {
        dt,
        contact_softness: firm(SpringCoefficients::contact_defaults(), 1.0 / dt),
        static_contact_softness: firm(SpringCoefficients::contact_static_defaults(), 8.0 / (0.6 * dt)),
        contact_recycling: false,
        num_solver_iterations: 8,
        num_internal_pgs_iterations: 1,
        warmstart_joints: true,
        ..IntegrationParameters::default()
    };
    physics.insert_body(RigidBodyBuilder::fixed());
    let collider =
        |edges: [f64; 3]| ColliderBuilder::cuboid(edges[0] * 0.5, edges[1] * 0.5, edges[2] * 0.5).friction(0.5);
    let floor = RigidBodyBuilder::fixed().translation(Vector::new(0.0, 0.0, -0.5)).can_sleep(false);
    physics.insert(floor, collider([10.0, 10.0, 1.0]).mass(0.0));
    let mut boxes = Vec::new();
    for (row, layer) in rows() {
        for column in 0..SIDE {
            let body =
                RigidBodyBuilder::dynamic().translation(Vector::from_array(place(column, row, layer))).can_sleep(false);
            boxes.push(physics.insert(body, collider([EDGE_M; 3]).mass(1.0)).0);
        }
    }
    (physics, boxes)
}

/// A plant that has been set up, and the number of its next step.
struct Turning {
    plant: Plant,
    step: u64,
}

impl Turning {
    fn new() -> Self {
        let mut plant = Plant::parse(&scene(), "boxes.toml", client("plant"), span_ms(STEP_MS)).expect("a scene");
        plant.setup(&mut []).expect("a set-up");
        Self { plant, step: 0 }
    }

    fn turns(&mut self, count: u64) -> Duration {
        let started = Instant::now();
        for _ in 0..count {
            self.step += 1;
            let t_v = VirtualTime::from_nanos(self.step * STEP_MS * 1_000_000);
            black_box(self.plant.turn(t_v, &[], &mut [])).expect("a turn");
        }
        started.elapsed()
    }
}

fn steps(physics: &mut PhysicsWorld, count: u64) -> Duration {
    let started = Instant::now();
    for _ in 0..count {
        black_box(&mut *physics).step();
    }
    started.elapsed()
}

fn main() {
    let ledger = Ledger::default();
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    let (mut physics, boxes) = bare();
    let mut turning = Turning::new();
    turning.turns(WARM_UP);
    steps(&mut physics, WARM_UP);
    let poses = turning.plant.poses().skip(1).map(|pose| pose.position_m);
    // the plant asks friction to follow what turns, which moves boxes by some micrometres until they rest
    let apart_m = |pose: [f64; 3], body: RigidBodyHandle| {
        let there = physics.bodies[body].translation().to_array();
        (0..3).map(|axis| (pose[axis] - there[axis]).abs()).fold(0.0, f64::max)
    };
    let most_m = poses.zip(&boxes).map(|(pose, body)| apart_m(pose, *body)).fold(0.0, f64::max);
    assert!(most_m < 1e-4, "the two worlds are one, but for {most_m} m");
    let mut group = criterion.benchmark_group("300 bodies");
    group.bench_function("bare rapier", |bencher| {
        bencher.iter_custom(|count| {
            let time = steps(&mut physics, count);
            ledger.note("bare rapier", time, count);
            time
        });
    });
    group.bench_function("plant", |bencher| {
        bencher.iter_custom(|count| {
            let time = turning.turns(count);
            ledger.note("plant", time, count);
            time
        });
    });
    group.finish();
    // in turns, so that whatever else the machine does burdens both alike
    for _ in 0..20 {
        ledger.note("plant, in turns", turning.turns(20), 20);
        ledger.note("bare rapier, in turns", steps(&mut physics, 20), 20);
    }
    println!();
    ledger.compare("plant", "bare rapier");
    ledger.compare("plant, in turns", "bare rapier, in turns");
    criterion.final_summary();
}
