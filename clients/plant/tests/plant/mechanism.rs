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

/// How thick bars are.
pub(crate) const THICK_M: f64 = 0.05;

/// A bar between two joints, with a mass; turned about y.
pub(crate) fn bar(name: &str, [x0, z0]: [f64; 2], [x1, z1]: [f64; 2], kg: f64) -> String {
    let (dx, dz) = (x1 - x0, z1 - z0);
    let (length_m, pitch_deg) = (dx.hypot(dz), -dz.atan2(dx).to_degrees());
    format!(
        "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [{length_m:?}, {THICK_M}, {THICK_M}]\n\
         mass_kg = {kg:?}\nposition_m = [{:?}, 0.0, {:?}]\nrpy_deg = [0.0, {pitch_deg:?}, 0.0]\ngroup = \"bars\"\n",
        0.5 * (x0 + x1),
        0.5 * (z0 + z1)
    )
}

pub(crate) fn pin(name: &str, parent: &str, child: &str, [x, z]: [f64; 2]) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"{parent}\"\nchild = \"{child}\"\n\
         anchor_m = [{x:?}, 0.0, {z:?}]\naxis = [0.0, 1.0, 0.0]\n"
    )
}

/// Two equal cranks of 0.5 m and so many kg, upright 1 m apart, that carry a coupler of twice that mass.
pub(crate) fn parallelogram(crank_kg: f64) -> String {
    let [a, b, c, d] = [[0.0, 0.0], [0.0, 0.5], [1.0, 0.5], [1.0, 0.0]];
    let bars = bar("crank", a, b, crank_kg) + &bar("coupler", b, c, 2.0 * crank_kg) + &bar("rocker", d, c, crank_kg);
    let pins = pin("drive", "ground", "crank", a) + &pin("left", "crank", "coupler", b);
    bars + &pins + &pin("right", "coupler", "rocker", c) + &pin("foot", "ground", "rocker", d)
}

#[test]
fn a_position_drive_of_a_closed_loop_rests_on_its_target() {
    let scene = format!(
        "version = 1\n{}[[axis]]\nname = \"drive\"\njoint = \"drive\"\ndrive = \"position\"\n\
         command_signal = \"To\"\nposition_signal = \"Is\"\nspeed_rad_s = 1.0\nacceleration_rad_s2 = 4.0\n",
        parallelogram(2.0)
    );
    for period_us in [100, 1_000, 10_000] {
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
        assert!(worst < 1e-11 && rest < 1e-11, "{period_us}: {worst} {rest}");
    }
}

/// A bar that turns about z, and on it a block that slides down a slant: on a guide, or as a pin in a slot that goes through
/// the block's centre, so that nothing turns it.
fn slanted(joint: &str) -> String {
    format!(
        r#"
    version = 1
    [[body]]
    name = "bar"
    kind = "dynamic"
    shape = "box"
    size_m = [0.1, 0.1, 0.1]
    mass_kg = 1.0
    position_m = [0.3, 0.0, 0.0]
    [[body]]
    name = "block"
    kind = "dynamic"
    shape = "sphere"
    radius_m = 0.05
    mass_kg = 1.0
    position_m = [0.5, 0.1, 0.0]
    [[joint]]
    name = "axle"
    kind = "revolute"
    parent = "ground"
    child = "bar"
    anchor_m = [0.0, 0.0, 0.0]
    axis = [0.0, 0.0, 1.0]
    [[joint]]
    name = "slant"
    parent = "bar"
    child = "block"
    {joint}
    "#
    )
}

#[test]
fn a_pin_in_a_slot_weighs_nothing() {
    let slot = slanted("kind = \"slot\"\naxis = [0.0, 1.0, 0.0]\nslide = [0.6, 0.0, 0.8]");
    let guide = slanted("kind = \"prismatic\"\naxis = [0.6, 0.0, 0.8]");
    let [slot, guide] = [slot, guide].map(|scene| after(&scene, "block", 100_000, 1_000));
    let apart = slot.iter().zip(&guide).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
    // the ball turns with its guide and not with its slot, which is one part in a thousand of 4.3 mm;
    // a pin of 1 kg m2 leaves 3.2 mm of them out
    assert!(apart < 2e-5, "{slot:?} {guide:?}");
    let turned = slot[1] - 0.1;
    assert!((turned + 0.00345).abs() < 5e-4, "{slot:?}");
}

/// Two masses of 2 kg on one vertical guide: the lower one lies on its stop, the upper one is driven up from it by 40 N to a stop
/// 0.1 m above.
const HOPPER: &str = r#"
    version = 1
    [[body]]
    name = "foot"
    kind = "dynamic"
    shape = "box"
    size_m = [0.1, 0.1, 0.1]
    mass_kg = 2.0
    collides = false
    [[body]]
    name = "hammer"
    kind = "dynamic"
    shape = "box"
    size_m = [0.1, 0.1, 0.1]
    mass_kg = 2.0
    collides = false
    [[joint]]
    name = "guide"
    kind = "prismatic"
    parent = "ground"
    child = "foot"
    axis = [0.0, 0.0, 1.0]
    lower_m = 0.0
    [[joint]]
    name = "stroke"
    kind = "prismatic"
    parent = "foot"
    child = "hammer"
    axis = [0.0, 0.0, 1.0]
    upper_m = 0.1
    [[component]]
    name = "drive"
    kind = "force_drive"
    joint = "stroke"
    current_loop_s = 0.0
    command_n = 40.0
"#;

#[test]
fn what_stops_a_joint_moves_what_it_hangs_on() {
    // the hammer comes to its stop with v = sqrt(2 a s), half of which is left of both: they fly v^2/8g high
    let exact = (40.0 / 2.0 - 9.81) * 0.1 / (4.0 * 9.81);
    for period_us in [50, 100, 200, 250, 400, 500, 1_000] {
        let mut bench = Bench::at_us(HOPPER, period_us);
        let mut highest: f64 = 0.0;
        for _ in 0..300_000 / period_us {
            bench.turn();
            highest = highest.max(place(&bench, "foot")[2]);
        }
        // in the sub-step of the blow, 0.25 ms at the most, both go on by 0.7 mm/ms
        assert!((highest - exact).abs() < 4e-4, "{period_us} us: {highest} {exact}");
    }
}

#[test]
fn a_counterweight_beside_a_weak_spring_turns_a_closed_loop() {
    // two joints on one axis are a loop; as both have something fitted, the ball is halved
    let hinge = |name: &str, z_m: f64| {
        format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"ground\"\nchild = \"ball\"\n\
             anchor_m = [0.0, 0.0, {z_m:?}]\naxis = [0.0, 0.0, 1.0]\n"
        )
    };
    let stops = "lower_rad = -3.0\nupper_rad = 3.0\n".to_owned();
    let fitting = "[[fitting]]\nname = \"weak\"\njoint = \"lower\"\nspring_nm_rad = 0.08\nbalance_nm = 0.5\n";
    let ball = "version = 1\n[[body]]\nname = \"ball\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.1\n\
                mass_kg = 1.0\nposition_m = [0.5, 0.0, 0.0]\n";
    let scene = [ball.to_owned(), hinge("lower", 0.0), hinge("upper", 0.2), stops, fitting.to_owned()].concat();
    let [_, y, _] = after(&scene, "ball", 100_000, 1_000);
    // M t^2/2J with J = m (r^2 + 2/5 R^2), of which the spring takes less than 1 %
    let exact = 0.5 * 0.5 * 0.01 / (0.25 + 0.004) * 0.5;
    assert!((y / exact - 1.0).abs() < 0.03, "{y} {exact}");
}
