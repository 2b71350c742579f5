//! Mechanisms that nothing touches, against closed forms and by halving the step.

use crate::bench::Bench;
use crate::motion::BALL;

/// A pendulum of 1 m from the horizontal, measured by an encoder of 31 bits.
fn pendulum() -> String {
    r#"
    version = 1
    [[body]]
    name = "bob"
    kind = "dynamic"
    shape = "sphere"
    radius_m = 0.05
    mass_kg = 2.0
    position_m = [1.0, 0.0, 0.0]
    [[joint]]
    name = "pin"
    kind = "revolute"
    parent = "ground"
    child = "bob"
    anchor_m = [0.0, 0.0, 0.0]
    axis = [0.0, 1.0, 0.0]
    "#
    .to_owned()
}

/// Two bars of 1 m and 1 kg, let go from the horizontal.
fn double_pendulum() -> String {
    let bar = |name: &str, x_m: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [1.0, 0.05, 0.05]\n\
             mass_kg = 1.0\nposition_m = [{x_m}, 0.0, 0.0]\n"
        )
    };
    let pin = |name: &str, parent: &str, child: &str, x_m: f64| {
        format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"{parent}\"\nchild = \"{child}\"\n\
             anchor_m = [{x_m}, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\n"
        )
    };
    [
        "version = 1\n".to_owned(),
        bar("upper", 0.5),
        bar("lower", 1.5),
        pin("shoulder", "ground", "upper", 0.0),
        pin("elbow", "upper", "lower", 1.0),
    ]
    .concat()
}

/// Where a body is after so long, with turns of so many microseconds.
fn after(scene: &str, body: &str, time_us: u64, period_us: u64) -> [f64; 3] {
    let mut bench = Bench::at_us(scene, period_us);
    bench.run_us(time_us);
    place(&bench, body)
}

fn place(bench: &Bench, body: &str) -> [f64; 3] {
    bench.plant.poses().find(|pose| pose.name == body).expect("a body").position_m
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

#[test]
fn a_pendulum_keeps_its_energy() {
    let mut bench = Bench::new(&pendulum());
    let mut highest_m = f64::NEG_INFINITY;
    for k in 0..5600 {
        bench.turn();
        let [x, y, z] = place(&bench, "bob");
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-12, "{k}: the joint is exact");
        if k > 5300 {
            highest_m = highest_m.max(z);
        }
    }
    // it comes back to its first height within half a step's way; the energy is that of the height
    assert!(highest_m.abs() < 1e-3, "{highest_m}");
}

#[test]
fn a_double_pendulum_converges_by_the_fourth_power_of_the_step() {
    let scene = double_pendulum();
    let at = |period_us| after(&scene, "lower", 1_000_000, period_us);
    let exact = at(250);
    let errors = [10_000, 5_000, 2_500].map(|period_us| apart(at(period_us), exact));
    for pair in errors.windows(2) {
        assert!((10.0..24.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    assert!(apart(at(1_000), exact) < 1e-8, "{errors:?}");
}

#[test]
fn a_ball_keeps_energy_and_spin() {
    let mut bench = Bench::new(BALL);
    let mut last = place(&bench, "bob");
    for k in 0..1000 {
        bench.turn();
        let now = place(&bench, "bob");
        assert!((apart(now, [0.0; 3]) - 1.0).abs() < 1e-12, "{k}");
        // the vertical part of x × v stays that of the start, m² / s, to the second order of the step
        let spin = ((last[0] + now[0]) * (now[1] - last[1]) - (last[1] + now[1]) * (now[0] - last[0])) / 0.02;
        assert!((spin - 1.0).abs() < 2e-2, "{k}: {spin}");
        last = now;
    }
}

#[test]
fn a_pendulum_stops_at_its_limit_and_stays() {
    let scene = format!("{}\nlower_rad = -0.1\nupper_rad = 1.0\n", pendulum());
    for period_us in [100, 1_000, 10_000] {
        let [x, _, z] = after(&scene, "bob", 3_000_000, period_us);
        assert!((x - f64::cos(1.0)).abs() < 1e-12 && (z + f64::sin(1.0)).abs() < 1e-12, "{period_us}: {x} {z}");
    }
}
