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

/// A bar between two joints, with a mass; turned about y.
fn bar(name: &str, [x0, z0]: [f64; 2], [x1, z1]: [f64; 2], kg: f64) -> String {
    let (dx, dz) = (x1 - x0, z1 - z0);
    let (length_m, pitch_deg) = (dx.hypot(dz), -dz.atan2(dx).to_degrees());
    format!(
        "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [{length_m:?}, 0.05, 0.05]\n\
         mass_kg = {kg:?}\nposition_m = [{:?}, 0.0, {:?}]\nrpy_deg = [0.0, {pitch_deg:?}, 0.0]\ngroup = \"bars\"\n",
        0.5 * (x0 + x1),
        0.5 * (z0 + z1)
    )
}

fn pin(name: &str, parent: &str, child: &str, [x, z]: [f64; 2]) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"{parent}\"\nchild = \"{child}\"\n\
         anchor_m = [{x:?}, 0.0, {z:?}]\naxis = [0.0, 1.0, 0.0]\n"
    )
}

#[test]
fn a_position_drive_of_a_closed_loop_rests_on_its_target() {
    let [a, b, c, d] = [[0.0, 0.0], [0.0, 0.5], [1.0, 0.5], [1.0, 0.0]];
    let bars = bar("crank", a, b, 2.0) + &bar("coupler", b, c, 4.0) + &bar("rocker", d, c, 2.0);
    let pins = pin("drive", "ground", "crank", a) + &pin("left", "crank", "coupler", b);
    let pins = pins + &pin("right", "coupler", "rocker", c) + &pin("foot", "ground", "rocker", d);
    let scene = format!(
        "version = 1\n{bars}{pins}[[axis]]\nname = \"drive\"\njoint = \"drive\"\ndrive = \"position\"\n\
         command_signal = \"To\"\nposition_signal = \"Is\"\nspeed_rad_s = 1.0\nacceleration_rad_s2 = 4.0\n"
    );
    // what an engine's step leaves over, moving and at rest, rad: it grows with the square of the step
    for (period_us, moving, resting) in [(100, 4e-7, 3e-7), (1_000, 4e-5, 3e-5), (10_000, 4e-3, 3e-3)] {
        let mut bench = Bench::at_us(&scene, period_us);
        bench.command("To", 0.8);
        let mut worst = 0.0_f64;
        for turn in 1..=1_000_000 / period_us {
            bench.turn();
            // a quarter of a second at 4 rad/s², then 1 rad/s, and the same backwards from 0.8 s on
            let t_s = (turn * period_us) as f64 * 1e-6;
            let ramp = |s: f64| if s < 0.25 { 2.0 * s * s } else { s - 0.125 };
            let path = if t_s < 0.8 { ramp(t_s) } else { 0.8 - ramp((1.05 - t_s).max(0.0)) };
            worst = worst.max((bench.read::<f64>("Is") - path).abs());
        }
        bench.run_us(1_000_000);
        let rest = (bench.read::<f64>("Is") - 0.8).abs();
        assert!(worst < moving && rest < resting, "{period_us}: {worst} {rest}");
    }
}
