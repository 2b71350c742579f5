//! Bodies at rest that sleep: nothing that one measures is otherwise.

use std::fmt::Write as _;

use onescan_server::client::Client;
use proptest::prelude::*;

use crate::bench::Bench;

/// A parcel may be off by so much where it sleeps: it is at rest within 0.1 mm/s for some steps before.
const OFF_M: f64 = 5e-4;

/// Height of the middle of a parcel that stands on a belt or on the ground.
const STANDING_M: f64 = 0.1;

/// Parcels on a belt of 4 m with a stop after it, one that a pusher meets on the floor, one that stands there alone.
fn scene(gaps_m: &[f64], sleeping: bool) -> String {
    let mut scene = format!(
        r#"
        version = 1
        sleeping = {sleeping}
        [[body]]
        name = "floor"
        kind = "fixed"
        shape = "box"
        size_m = [20.0, 20.0, 1.0]
        position_m = [0.0, 0.0, -1.5]
        [[body]]
        name = "belt"
        kind = "kinematic"
        shape = "box"
        size_m = [4.0, 0.5, 0.1]
        position_m = [0.0, 0.0, -0.05]
        friction = 0.6
        [[body]]
        name = "pusher"
        kind = "dynamic"
        shape = "box"
        size_m = [0.1, 0.3, 0.2]
        position_m = [3.0, 3.0, -0.85]
        mass_kg = 5.0
        [[body]]
        name = "pushed"
        kind = "dynamic"
        shape = "box"
        size_m = [0.3, 0.3, 0.2]
        position_m = [3.4, 3.0, -0.9]
        mass_kg = 2.0
        [[body]]
        name = "alone"
        kind = "dynamic"
        shape = "cylinder"
        radius_m = 0.1
        length_m = 0.2
        position_m = [-3.0, 3.0, -0.9]
        mass_kg = 2.0
        [[joint]]
        name = "slide"
        kind = "prismatic"
        parent = "ground"
        child = "pusher"
        axis = [1.0, 0.0, 0.0]
        [[axis]]
        name = "push"
        joint = "slide"
        drive = "bidirectional"
        forward_signal = "push"
        reverse_signal = "pull"
        speed_m_s = 0.4
        acceleration_m_s2 = 2.0
        [[axis]]
        name = "conveyor"
        belt = "belt"
        direction = [1.0, 0.0, 0.0]
        drive = "bidirectional"
        forward_signal = "run"
        reverse_signal = "run_back"
        speed_m_s = 0.5
        acceleration_m_s2 = 1.0
        [[sensor]]
        name = "eye"
        kind = "proximity"
        signal = "eye"
        point_m = [0.5, -1.0, 0.1]
        direction = [0.0, 1.0, 0.0]
        range_m = 2.0
        [[body]]
        name = "stop"
        kind = "fixed"
        shape = "box"
        size_m = [0.1, 0.5, 0.2]
        position_m = [1.5, 0.0, 0.11]
        "#
    );
    let mut place_m = -1.8;
    for (index, gap_m) in gaps_m.iter().enumerate() {
        place_m += gap_m + 0.2;
        write!(
            scene,
            "[[body]]\nname = \"parcel_{index}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.2, 0.2, 0.2]\n\
             mass_kg = 3.0\nposition_m = [{place_m}, 0.0, {STANDING_M}]\n"
        )
        .expect("a string takes all");
    }
    scene
}

fn places(bench: &Bench) -> Vec<[f64; 3]> {
    bench.plant.poses().map(|pose| pose.position_m).collect()
}

/// Commands of turn `k`: the belt as `runs` has it in each half second, the pusher from 1 s on.
fn command(bench: &mut Bench, runs: &[i8], k: usize) {
    let way = runs.get(k / 50).copied().unwrap_or(0);
    bench.command("run", way > 0);
    bench.command("run_back", way < 0);
    bench.command("push", k > 100);
    bench.command("pull", false);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn what_sleeps_is_where_it_would_be(
        gaps_m in proptest::collection::vec(prop_oneof![0.0..0.02_f64, 0.02..0.4], 1..6),
        runs in proptest::collection::vec(-1..=1_i8, 10),
    ) {
        let mut awake = Bench::new(&scene(&gaps_m, false));
        let mut asleep = Bench::new(&scene(&gaps_m, true));
        let (mut edges, mut seen) = ([0_u32; 2], [false; 2]);
        for k in 0..500 {
            for (at, bench) in [&mut awake, &mut asleep].into_iter().enumerate() {
                command(bench, &runs, k);
                bench.turn();
                let eye = bench.read::<bool>("eye");
                edges[at] += u32::from(eye != seen[at]);
                seen[at] = eye;
            }
            for (body, (one, other)) in places(&awake).iter().zip(&places(&asleep)).enumerate() {
                if one[2] < STANDING_M - 0.001 && body > 4 {
                    // It tips over the end of its belt, or has left it: how it tumbles is chance.
                    continue;
                }
                let off_m = (0..3).map(|axis| (one[axis] - other[axis]).abs()).fold(0.0, f64::max);
                prop_assert!(off_m < OFF_M, "body {body} in turn {k}: {one:?} {other:?}");
            }
        }
        prop_assert_eq!(edges[0], edges[1]);
    }
}

#[test]
fn a_state_in_which_bodies_sleep_goes_on_to_the_bit() {
    let runs = [1, 1, 0, 1, -1, -1, 0, 1, 1, 1];
    let text = scene(&[0.05, 0.1, 0.3], true);
    let mut whole = Bench::new(&text);
    for k in 0..430 {
        command(&mut whole, &runs, k);
        whole.turn();
        if k % 60 != 40 {
            continue;
        }
        let state = whole.plant.save().expect("a state");
        let mut other = Bench::new(&text);
        other.plant.restore(&state).expect("it is this plant's");
        other.t_v = whole.t_v;
        let mut ahead = Bench::new(&text);
        ahead.plant.restore(&state).expect("it is this plant's");
        ahead.t_v = whole.t_v;
        for later in k + 1..k + 90 {
            for bench in [&mut other, &mut ahead] {
                command(bench, &runs, later);
                bench.turn();
            }
        }
        assert_eq!(other.plant.save().expect("a state"), ahead.plant.save().expect("a state"), "turn {k}");
        let mut straight = Bench::new(&text);
        for turn in 0..k + 90 {
            command(&mut straight, &runs, turn);
            straight.turn();
        }
        assert_eq!(places(&straight), places(&other), "turn {k}");
    }
}

#[test]
fn what_leaves_its_belt_falls() {
    let mut bench = Bench::new(&scene(&[0.3], true));
    for _ in 0..900 {
        bench.command("run_back", true);
        bench.turn();
    }
    let parcel = places(&bench).last().copied().expect("a parcel");
    assert!(parcel[2] < -0.5 && parcel[0] < -2.0, "{parcel:?}");
}
