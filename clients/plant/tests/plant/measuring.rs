//! Sensors for quantities of bodies and joints, against closed forms.

use crate::bench::Bench;

const G: f64 = 9.81;

/// A ball that falls beside a pendulum, over a floor; no axis and no motor.
const SCENE: &str = r#"
version = 1

[[body]]
name = "floor"
kind = "fixed"
shape = "box"
size_m = [10.0, 10.0, 0.2]
position_m = [0.0, 0.0, -0.1]

[[body]]
name = "ball"
kind = "dynamic"
shape = "sphere"
radius_m = 0.1
mass_kg = 1.0
position_m = [0.0, 0.0, 2.1]
velocity_m_s = [0.3, 0.0, 0.0]

[[body]]
name = "rod"
kind = "dynamic"
shape = "box"
size_m = [0.02, 0.02, 1.0]
mass_kg = 1.0
position_m = [3.0, 0.0, 2.5]

[[joint]]
name = "pivot"
kind = "revolute"
parent = "ground"
child = "rod"
anchor_m = [3.0, 0.0, 3.0]
axis = [0, 1, 0]

[[body]]
name = "crate"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.2]
mass_kg = 1.0
position_m = [-2.0, 1.0, 0.1]
rpy_deg = [0.0, 0.0, 30.0]

[[body]]
name = "view"
kind = "fixed"
shape = "box"
size_m = [1.0, 1.0, 0.5]
position_m = [-2.2, 0.8, 0.3]
collides = false

[[component]]
name = "tracker"
kind = "pose_sensor"
body = "ball"
x_m_signal = "X"
z_m_signal = "Z"
z_m_s_signal = "Falling"
speed_m_s_signal = "Speed"

[[component]]
name = "felt"
kind = "accelerometer"
body = "ball"
z_m_s2_signal = "Felt"

[[component]]
name = "rested"
kind = "accelerometer"
body = "crate"
lag_s = 0.0
z_m_s2_signal = "Rested"

[[component]]
name = "beam"
kind = "laser_distance"
point_m = [0.0, 0.0, 3.0]
direction = [0, 0, -1]
far_m = 5.0
lag_s = 0.0
targets = ["ball", "floor"]
distance_m_signal = "Distance"

[[component]]
name = "encoder"
kind = "axis_encoder"
joint = "pivot"
scale_ratio = 57.29577951308232
position_signal = "Angle"
velocity_signal = "Turning"

[[component]]
name = "level"
kind = "inclinometer"
body = "rod"
point_m = [3.0, 0.0, 3.0]
lag_s = 0.0
pitch_deg_signal = "Pitch"

[[component]]
name = "eye"
kind = "camera"
body = "view"
targets = ["ball", "crate"]
present_signal = "Present"
count_signal = "Seen"
x_m_signal = "Crate_X"
y_m_signal = "Crate_Y"
angle_deg_signal = "Crate_Angle"
"#;

fn after(period_us: u64, seconds: f64) -> Bench {
    let mut bench = Bench::at_us(SCENE, period_us);
    bench.run_us((seconds * 1e6) as u64);
    bench
}

#[test]
fn a_falling_ball_is_tracked_feels_nothing_and_is_measured_by_a_beam() {
    for period_us in [100, 1_000, 10_000] {
        let (bench, t) = (after(period_us, 0.5), 0.5);
        let read = |signal: &str| bench.read::<f64>(signal);
        // the engine's fall is of first order: at most g t dt/2 ahead
        let ahead_m = 0.5 * G * t * 1e-6 * period_us as f64;
        assert!((read("Z") - (2.1 - 0.5 * G * t * t)).abs() <= ahead_m + 1e-9, "{}", read("Z"));
        assert!((read("X") - 0.3 * t).abs() < 1e-9 && (read("Falling") + G * t).abs() < 1e-9);
        assert!((read("Speed") - (0.09 + G * G * t * t).sqrt()).abs() < 1e-9);
        assert!(read("Felt").abs() < 1e-6, "in free fall: {}", read("Felt"));
        // 0.15 m beside its middle the beam passes the ball of 0.1 m, and meets the floor
        assert!((read("Distance") - 3.0).abs() < 1e-9, "{}", read("Distance"));
    }
    let bench = after(1_000, 0.1);
    let read = |signal: &str| bench.read::<f64>(signal);
    // on the sphere's surface, 0.03 m beside its middle
    let top_m = read("Z") + (0.01_f64 - 0.03 * 0.03).sqrt();
    assert!((read("Distance") - (3.0 - top_m)).abs() < 1e-9, "{}", read("Distance"));
}

#[test]
fn a_body_at_rest_feels_its_support_and_a_camera_sees_where_it_lies() {
    let bench = after(10_000, 1.0);
    let read = |signal: &str| bench.read::<f64>(signal);
    assert!((read("Rested") - G).abs() < 1e-3, "{}", read("Rested"));
    assert!(bench.read::<bool>("Present") && bench.read::<i32>("Seen") == 1);
    assert!((read("Crate_X") - 0.2).abs() < 1e-3 && (read("Crate_Y") - 0.2).abs() < 1e-3);
    assert!((read("Crate_Angle") - 30.0).abs() < 0.1, "{}", read("Crate_Angle"));
}

/// Without a push the pendulum hangs still; pushed by a start 20° off, it swings.
#[test]
fn a_passive_joint_is_measured_without_a_motor() {
    let off =
        SCENE.replace("position_m = [3.0, 0.0, 2.5]", "position_m = [3.0, 0.0, 2.5]\nvelocity_m_s = [0.2, 0.0, 0.0]");
    let mut bench = Bench::at_us(&off, 1_000);
    let (mut most_deg, mut crossings, mut before) = (0.0_f64, Vec::new(), 0.0);
    for k in 1..=5_000_u32 {
        bench.turn();
        let (now, rate): (f64, f64) = (bench.read("Angle"), bench.read("Turning"));
        if k > 1 {
            assert!((rate - (now - before) / 1e-3).abs() < 1e-6, "the rate of what it shows");
        }
        if before < 0.0 && now >= 0.0 {
            crossings.push(1e-3 * (f64::from(k) - now / (now - before)));
        }
        most_deg = most_deg.max(now.abs());
        before = now;
    }
    // T = 2π √(2 l/(3 g)) for a rod of length l; its amplitude of some degrees adds less than 0.1 %
    let period_s = std::f64::consts::TAU * (2.0 / (3.0 * G)).sqrt();
    let measured_s = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    assert!((measured_s / period_s - 1.0).abs() < 2e-3, "{measured_s} {period_s}");
    // the joint turns a velocity of 0.2 m/s of the middle into (3/4) · 0.2 m/s / 0.5 m
    let amplitude_deg = (0.3 / (std::f64::consts::TAU / period_s)).to_degrees();
    assert!((most_deg / amplitude_deg - 1.0).abs() < 0.02, "{most_deg} {amplitude_deg}");
}

/// An inclinometer at the pivot, which does not accelerate, shows the angle of the joint.
#[test]
fn an_inclinometer_at_a_pivot_shows_the_joint_s_angle() {
    let off =
        SCENE.replace("position_m = [3.0, 0.0, 2.5]", "position_m = [3.0, 0.0, 2.5]\nvelocity_m_s = [0.2, 0.0, 0.0]");
    let mut bench = Bench::at_us(&off, 1_000);
    let mut most = 0.0_f64;
    for k in 0..1_000 {
        bench.turn();
        if k > 10 {
            most = most.max((bench.read::<f64>("Pitch") - bench.read::<f64>("Angle")).abs());
        }
    }
    // what the joint gives within a step accelerates the pivot a little
    assert!(most < 0.2, "{most}");
}
