//! The sheet metal shear of `scenarios/shear` (`[SDSP]` sec. III).

use onescan_plant::Plant;

use crate::bench::Bench;

pub(crate) const SHEAR: &str = include_str!("../../../../scenarios/shear/plant.toml");

/// Commands both actuators alike: up for positive, down for negative.
fn command_both(bench: &mut Bench, direction: i32) {
    command(bench, 1, direction);
    command(bench, 2, direction);
}

fn command(bench: &mut Bench, actuator: u32, direction: i32) {
    bench.command(&format!("Actuator_{actuator}_Up"), direction > 0);
    bench.command(&format!("Actuator_{actuator}_Down"), direction < 0);
}

fn positions(bench: &Bench) -> [f64; 2] {
    [bench.read("Position_1"), bench.read("Position_2")]
}

fn blade_rotation(plant: &Plant) -> [f64; 4] {
    plant.poses().find(|pose| pose.name == "blade").expect("a blade").rotation_xyzw
}

#[test]
fn the_blade_is_found_below_the_sensors() {
    let bench = Bench::new(SHEAR);
    assert_eq!(positions(&bench), [-0.05, -0.05]);
    assert!(!bench.read::<bool>("Sensor_1") && !bench.read::<bool>("Sensor_2"));
}

#[test]
fn both_sensors_rise_in_the_same_step() {
    let mut bench = Bench::new(SHEAR);
    command_both(&mut bench, 1);
    let rise = (1..100).find(|_| {
        bench.turn();
        bench.read::<bool>("Sensor_1") || bench.read::<bool>("Sensor_2")
    });
    // ten periods of ramp for 12.5 mm, then 2.5 mm a period up to the first position above -2.06 mm
    assert_eq!(rise, Some(25));
    assert!(bench.read::<bool>("Sensor_1") && bench.read::<bool>("Sensor_2"));
    let [first, second] = positions(&bench);
    // the sensors switch 2 mm below and the position before was 0.4 mm lower than that
    assert!((first - second).abs() < 1e-9 && first.abs() < 1e-6, "{first} {second}");
}

#[test]
fn equal_commands_keep_the_blade_level() {
    let mut bench = Bench::new(SHEAR);
    for k in 0..1000 {
        command_both(&mut bench, [1, 0, -1, -1, 0, 1][k / 10 % 6]);
        bench.turn();
        let [first, second] = positions(&bench);
        assert!((first - second).abs() < 1e-9, "{k}: {first} {second}");
    }
}

#[test]
fn the_commanded_speed_is_followed() {
    let mut bench = Bench::new(SHEAR);
    command_both(&mut bench, -1);
    let mut before = [-0.05; 2];
    for k in 1..=80 {
        bench.turn();
        let now = positions(&bench);
        for (now, before) in now.iter().zip(before) {
            let speed_m_s = (now - before) / 0.01;
            // the ramp takes ten periods; 1 % is what the shear promises, the drive keeps far less
            assert!(k <= 10 || (speed_m_s + 0.25).abs() < 0.25e-4, "{k}: {speed_m_s}");
        }
        before = now;
    }
}

#[test]
fn a_stopped_blade_does_not_sag() {
    let mut bench = Bench::new(SHEAR);
    for _ in 0..100 {
        bench.turn();
    }
    for position in positions(&bench) {
        // 0.1 mm a second is what the shear promises
        assert!((position + 0.05).abs() < 1e-8, "{position}");
    }
}

#[test]
fn one_actuator_alone_tilts_the_blade() {
    let mut bench = Bench::new(SHEAR);
    command(&mut bench, 1, -1);
    for _ in 0..50 {
        bench.turn();
    }
    command(&mut bench, 1, 0);
    for _ in 0..50 {
        bench.turn();
    }
    let [first, second] = positions(&bench);
    assert!((second + 0.05).abs() < 1e-5, "the other one holds: {second}");
    // both pins are 1 m from the middle; left down is a turn about -y
    let half_angle = libm::atan2(second - first, 2.0) / 2.0;
    let [x, y, z, _] = blade_rotation(&bench.plant);
    // the joints, solved in sweeps, give by some micrometres under 150 kg each
    assert!((y + libm::sin(half_angle)).abs() < 1e-5, "{y} for {half_angle}");
    assert!(x.abs() < 1e-9 && z.abs() < 1e-9, "{x} {z}");
}

#[test]
fn the_end_of_the_stroke_stops_the_rams() {
    let mut bench = Bench::new(SHEAR);
    command_both(&mut bench, -1);
    for _ in 0..300 {
        bench.turn();
    }
    for position in positions(&bench) {
        assert!((position + 0.31).abs() < 1e-4, "{position}");
    }
}
