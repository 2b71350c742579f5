//! A belt: a driven surface that stays where it is.

use crate::bench::Bench;

/// A parcel on a belt of 4 m, a photo eye across it, both ends of the belt free.
const SCENE: &str = r#"
    version = 1
    [[body]]
    name = "belt"
    kind = "kinematic"
    shape = "box"
    size_m = [4.0, 0.5, 0.1]
    position_m = [0.0, 0.0, -0.05]
    friction = 1.0
    [[body]]
    name = "parcel"
    kind = "dynamic"
    shape = "box"
    size_m = [0.3, 0.2, 0.2]
    mass_kg = 3.0
    position_m = [-1.5, 0.0, 0.1]
    friction = 1.0
    [[axis]]
    name = "conveyor"
    belt = "belt"
    direction = [1.0, 0.0, 0.0]
    drive = "bidirectional"
    forward_signal = "run"
    reverse_signal = "run_back"
    speed_m_s = 0.5
    acceleration_m_s2 = 1.0
    position_signal = "travel"
    velocity_signal = "speed"
    [[sensor]]
    name = "eye"
    kind = "proximity"
    signal = "eye"
    point_m = [0.0, -1.0, 0.1]
    direction = [0.0, 1.0, 0.0]
    range_m = 2.0
"#;

fn parcel_m(bench: &Bench) -> f64 {
    bench.plant.poses().nth(1).expect("a parcel").position_m[0]
}

#[test]
fn a_belt_runs_and_stays_where_it_is() {
    let mut bench = Bench::new(SCENE);
    let place = bench.plant.poses().next();
    let place = place.map(|pose| (pose.position_m, pose.rotation_xyzw));
    bench.command("run", true);
    for k in 1..=200 {
        bench.turn();
        let t_s = f64::from(k) * 0.01;
        let exact_m = if t_s < 0.5 { 0.5 * t_s * t_s } else { 0.125 + 0.5 * (t_s - 0.5) };
        // nothing slows a belt: rounding alone
        assert!((bench.read::<f64>("travel") - exact_m).abs() < 1e-12, "{k}");
        let now = bench.plant.poses().next().map(|pose| (pose.position_m, pose.rotation_xyzw));
        assert_eq!(now, place);
    }
    assert!((bench.read::<f64>("speed") - 0.5).abs() < 1e-12);
}

#[test]
fn a_parcel_lies_still_on_a_belt_that_moves_it() {
    let mut bench = Bench::new(SCENE);
    bench.command("run", true);
    for _ in 0..100 {
        bench.turn();
    }
    let (parcel, travel) = (parcel_m(&bench), bench.read::<f64>("travel"));
    for _ in 0..100 {
        bench.turn();
    }
    let moved_m = parcel_m(&bench) - parcel;
    let ran_m = bench.read::<f64>("travel") - travel;
    // friction of contacts is solved in sweeps; what slips is below a tenth of a millimetre a metre
    assert!((moved_m - ran_m).abs() < 1e-4 * ran_m, "{moved_m} {ran_m}");
}

#[test]
fn a_standing_belt_wakes_what_lies_on_it() {
    let mut bench = Bench::new(SCENE);
    for _ in 0..500 {
        bench.turn();
    }
    let settled_m = parcel_m(&bench);
    assert!((settled_m + 1.5).abs() < 1e-4, "it settles into the contact: {settled_m}");
    for _ in 0..500 {
        bench.turn();
    }
    assert_eq!(parcel_m(&bench), settled_m, "and does not creep");
    bench.command("run_back", true);
    for _ in 0..50 {
        bench.turn();
    }
    assert!(parcel_m(&bench) < -1.6);
}

#[test]
fn a_photo_eye_sees_the_parcel_pass() {
    let mut bench = Bench::new(SCENE);
    bench.command("run", true);
    let mut seen_m = Vec::new();
    for _ in 0..500 {
        bench.turn();
        if bench.read::<bool>("eye") {
            seen_m.push(parcel_m(&bench));
        }
    }
    let (first_m, last_m) = (seen_m[0], seen_m[seen_m.len() - 1]);
    // the parcel is 0.3 m long and moves 5 mm a turn
    assert!((-0.15..-0.145 + 1e-9).contains(&first_m), "{first_m}");
    assert!((0.145..0.15).contains(&last_m), "{last_m}");
}
