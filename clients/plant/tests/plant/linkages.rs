//! Closed loops: linkages as exact as trees.

use onescan_server::client::Client;

use crate::bench::Bench;
use crate::mechanism::{bar, pin};

/// A four-bar linkage whose crank goes all the way round: where its pins are in the scene's pose, x and z, m.
const CRANK: [f64; 2] = [0.0, 0.0];
const ROCKER: [f64; 2] = [1.0, 0.0];
const CRANK_M: f64 = 0.3;
const COUPLER_M: f64 = 0.9;
const ROCKER_M: f64 = 0.6;
/// Masses of crank, coupler and rocker.
const KG: [f64; 3] = [1.0, 2.0, 1.5];
/// Where the crank stands at the start.
const START_RAD: f64 = 1.0;
/// What a bar of square section adds to the inertia of a thin one, m².
const THICK_M2: f64 = 0.05 * 0.05 / 12.0;

/// The pins at the ends of the coupler, from the crank's angle, counted from x towards z.
fn pins(crank_rad: f64) -> [[f64; 2]; 2] {
    let (sine, cosine) = crank_rad.sin_cos();
    let a = [CRANK_M * cosine, CRANK_M * sine];
    let (dx, dz) = (ROCKER[0] - a[0], ROCKER[1] - a[1]);
    let apart = dx.hypot(dz);
    let along = (COUPLER_M * COUPLER_M - ROCKER_M * ROCKER_M + apart * apart) / (2.0 * apart);
    let beside = (COUPLER_M * COUPLER_M - along * along).sqrt();
    let b = [a[0] + (along * dx - beside * dz) / apart, a[1] + (along * dz + beside * dx) / apart];
    [a, b]
}

fn four_bar(more: &str) -> String {
    let [a, b] = pins(START_RAD);
    let bars = bar("crank", CRANK, a, KG[0]) + &bar("coupler", a, b, KG[1]) + &bar("rocker", b, ROCKER, KG[2]);
    let pins = pin("drive", "ground", "crank", CRANK) + &pin("left", "crank", "coupler", a);
    let pins = pins + &pin("right", "coupler", "rocker", b) + &pin("foot", "ground", "rocker", ROCKER);
    format!("version = 1\n{bars}{pins}{more}")
}

/// What the linkage's motion costs, `½ I(φ) φ'²`, and its height: `I` and the potential energy at a crank's angle, both
/// from how its pins move with the angle.
fn energies(crank_rad: f64) -> [f64; 2] {
    const BY: f64 = 1e-5;
    let middles = |rad: f64| {
        let [a, b] = pins(rad);
        let half = |one: [f64; 2], other: [f64; 2]| [0.5 * (one[0] + other[0]), 0.5 * (one[1] + other[1])];
        let turned = |one: [f64; 2], other: [f64; 2]| (other[1] - one[1]).atan2(other[0] - one[0]);
        [(half(CRANK, a), turned(CRANK, a)), (half(a, b), turned(a, b)), (half(b, ROCKER), turned(b, ROCKER))]
    };
    let inertia = |kg: f64, length_m: f64| kg * (length_m * length_m / 12.0 + THICK_M2);
    let lengths = [CRANK_M, COUPLER_M, ROCKER_M];
    let (before, now, after) = (middles(crank_rad - BY), middles(crank_rad), middles(crank_rad + BY));
    let (mut moved, mut lifted) = (0.0, 0.0);
    for index in 0..3 {
        let ([x0, z0], turn0) = before[index];
        let ([x1, z1], turn1) = after[index];
        let turn = (turn1 - turn0 + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let [dx, dz, turn] = [x1 - x0, z1 - z0, turn].map(|change| change / (2.0 * BY));
        moved += KG[index] * (dx * dx + dz * dz) + inertia(KG[index], lengths[index]) * turn * turn;
        lifted += KG[index] * 9.81 * now[index].0[1];
    }
    [moved, lifted]
}

/// The crank's angle after a time from rest, by `I φ'' = -½ I' φ'² - V'` in steps of 0.1 ms.
fn exact(time_s: f64) -> f64 {
    const STEP_S: f64 = 1e-4;
    const BY: f64 = 1e-4;
    let acceleration = |rad: f64, rad_s: f64| {
        let ([before, low], [after, high]) = (energies(rad - BY), energies(rad + BY));
        let [inertia, _] = energies(rad);
        -(0.5 * (after - before) * rad_s * rad_s + (high - low)) / (2.0 * BY * inertia)
    };
    let (mut rad, mut rad_s) = (START_RAD, 0.0);
    for _ in 0..(time_s / STEP_S).round() as u32 {
        let mut slopes = [[0.0; 2]; 4];
        for stage in 0..4 {
            let way = if stage == 3 { STEP_S } else { 0.5 * STEP_S };
            let [dr, dv] = if stage == 0 { [0.0; 2] } else { slopes[stage - 1] };
            let (r, v) = (rad + way * dr, rad_s + way * dv);
            slopes[stage] = [v, acceleration(r, v)];
        }
        let sum = |k: usize| slopes[0][k] + 2.0 * (slopes[1][k] + slopes[2][k]) + slopes[3][k];
        (rad, rad_s) = (rad + STEP_S / 6.0 * sum(0), rad_s + STEP_S / 6.0 * sum(1));
    }
    rad
}

/// Where the crank's far end is, as an angle, and how far the coupler is from its pins.
fn seen(bench: &Bench) -> [f64; 2] {
    let ends = |name: usize, length_m: f64| {
        let pose = bench.plant.poses().nth(name).expect("a bar");
        let [x, y, z, w] = pose.rotation_xyzw;
        // the bar's own x axis
        let axis = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * z - w * y)];
        let half = 0.5 * length_m;
        let at = [pose.position_m[0], pose.position_m[2]];
        [-half, half].map(|along| [at[0] + along * axis[0], at[1] + along * axis[1]])
    };
    let ([_, a], [from, to], [b, foot]) = (ends(0, CRANK_M), ends(1, COUPLER_M), ends(2, ROCKER_M));
    let apart = |one: [f64; 2], other: [f64; 2]| (one[0] - other[0]).hypot(one[1] - other[1]);
    [a[1].atan2(a[0]), apart(a, from).max(apart(to, b)).max(apart(foot, ROCKER))]
}

#[test]
fn a_four_bar_linkage_falls_as_its_own_equation_says() {
    for time_us in [300_000, 700_000] {
        let wanted = exact(time_us as f64 * 1e-6);
        for (period_us, off) in [(100, 1e-7), (1_000, 1e-7), (10_000, 1e-4)] {
            let mut bench = Bench::at_us(&four_bar(""), period_us);
            bench.run_us(time_us);
            let [crank_rad, open_m] = seen(&bench);
            let missing = (crank_rad - wanted + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
            let missing = missing - std::f64::consts::PI;
            assert!(missing.abs() < off, "{time_us} us at {period_us} us: {crank_rad} {wanted}");
            assert!(open_m < 1e-11, "{period_us}: {open_m}");
        }
    }
}

#[test]
fn a_linkage_of_more_bars_than_it_needs_keeps_its_energy() {
    // three equal cranks carry a beam: each pin of the third is implied by those of the others
    let beam_m = [[0.0, 0.4], [0.5, 0.4], [1.0, 0.4]];
    let mut scene = "version = 1\n".to_owned() + &bar("beam", beam_m[0], beam_m[2], 3.0);
    for (index, top) in beam_m.into_iter().enumerate() {
        let (name, foot) = (format!("crank_{index}"), [top[0] - 0.1, 0.0]);
        scene += &(bar(&name, foot, top, 0.5) + &pin(&format!("foot_{index}"), "ground", &name, foot));
        scene += &pin(&format!("top_{index}"), &name, "beam", top);
    }
    let mut bench = Bench::at_us(&scene, 1_000);
    let (lowest, highest) = (0..6_000).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), _| {
        bench.turn();
        let pose = bench.plant.poses().next().expect("a beam");
        // it stays level
        assert!(pose.rotation_xyzw[..3].iter().all(|part| part.abs() < 1e-9), "{:?}", pose.rotation_xyzw);
        (low.min(pose.position_m[2]), high.max(pose.position_m[2]))
    });
    // it swings through, down to where the cranks hang and up to where it began
    let length_m = 0.1_f64.hypot(0.4);
    assert!((lowest + length_m).abs() < 1e-4, "{lowest}");
    assert!(highest <= 0.4 + 1e-9, "{highest}");
}

#[test]
fn a_spring_in_a_loop_keeps_its_energy_beside_a_brake_that_is_released() {
    let spring = "[[fitting]]\nname = \"spring\"\njoint = \"foot\"\nspring_nm_rad = 40.0\nfriction_nm = 1e-9\n";
    let scene = four_bar("").replacen("version = 1", "version = 1\ngravity_m_s2 = [0, 0, 0]", 1);
    let scene = scene.replacen("name = \"foot\"\n", "name = \"foot\"\ninitial_rad = 0.3\n", 1) + spring;
    for period_us in [1_000, 5_000] {
        let mut bench = Bench::at_us(&scene, period_us);
        let mut widest = [0.0_f64; 2];
        for (half, widest) in widest.iter_mut().enumerate() {
            for _ in 0..2_000_000 / period_us {
                bench.turn();
                let [crank_rad, open_m] = seen(&bench);
                *widest = widest.max((crank_rad - START_RAD).abs());
                assert!(open_m < 1e-11, "{period_us} us, half {half}: {open_m}");
            }
        }
        // a sub-step of a loop with friction in it is of second order; the widest place falls between two turns
        assert!(widest[1] <= widest[0] * (1.0 + 1e-3), "{period_us} us: {widest:?}");
        assert!(widest[1] > widest[0] * 0.99, "{period_us} us: {widest:?}");
    }
}

#[test]
fn a_loop_in_space_closes_with_balls() {
    // a crank about z, a rod with balls at both ends, a slider along x
    let scene = r#"
        version = 1
        gravity_m_s2 = [3.0, 1.0, 0.0]
        [[body]]
        name = "crank"
        kind = "dynamic"
        shape = "box"
        size_m = [0.2, 0.02, 0.02]
        mass_kg = 1.0
        position_m = [0.0, 0.1, 0.0]
        rpy_deg = [0.0, 0.0, 90.0]
        group = "bars"
        [[body]]
        name = "rod"
        kind = "dynamic"
        shape = "box"
        size_m = [0.5, 0.02, 0.02]
        mass_kg = 0.5
        position_m = [0.2, 0.1, 0.15]
        group = "bars"
        [[body]]
        name = "slider"
        kind = "dynamic"
        shape = "box"
        size_m = [0.1, 0.1, 0.1]
        mass_kg = 2.0
        position_m = [0.4, 0.0, 0.3]
        group = "bars"
        [[joint]]
        name = "turn"
        kind = "revolute"
        parent = "ground"
        child = "crank"
        anchor_m = [0.0, 0.0, 0.0]
        axis = [0, 0, 1]
        [[joint]]
        name = "near"
        kind = "ball"
        parent = "crank"
        child = "rod"
        anchor_m = [0.0, 0.2, 0.0]
        [[joint]]
        name = "slide"
        kind = "prismatic"
        parent = "ground"
        child = "slider"
        axis = [1, 0, 0]
        [[joint]]
        name = "far"
        kind = "ball"
        parent = "rod"
        child = "slider"
        anchor_m = [0.4, 0.0, 0.3]
        [[component]]
        name = "angle"
        kind = "axis_encoder"
        joint = "turn"
        position_signal = "Is"
    "#;
    let rod_m = (0.4_f64 * 0.4 + 0.2 * 0.2 + 0.3 * 0.3).sqrt();
    for (period_us, off_m) in [(1_000, 1e-9), (10_000, 1e-9)] {
        let mut bench = Bench::at_us(scene, period_us);
        for _ in 0..2_000_000 / period_us {
            bench.turn();
            let slider_m = bench.plant.poses().nth(2).expect("a slider").position_m;
            let (sine, cosine) = bench.read::<f64>("Is").sin_cos();
            let pin_m = [-0.2 * sine, 0.2 * cosine];
            let along = (rod_m * rod_m - pin_m[1] * pin_m[1] - 0.09).sqrt();
            let wanted_m = pin_m[0] + along;
            assert!((slider_m[0] - wanted_m).abs() < off_m, "{period_us} us: {slider_m:?} {wanted_m}");
        }
    }
}

#[test]
fn a_state_of_a_loop_goes_on_to_the_bit() {
    let scene = four_bar("[[fitting]]\nname = \"rub\"\njoint = \"drive\"\nfriction_nm = 0.3\n");
    let mut whole = Bench::at_us(&scene, 1_000);
    whole.run_us(400_000);
    let state = whole.plant.save().expect("a state");
    let mut other = Bench::at_us(&scene, 1_000);
    other.plant.restore(&state).expect("it is this plant's");
    other.t_v = whole.t_v;
    for bench in [&mut whole, &mut other] {
        bench.run_us(600_000);
    }
    assert_eq!(whole.plant.save().expect("a state"), other.plant.save().expect("a state"));
}

#[test]
fn a_linkage_that_meets_a_block_presses_on_it_and_stays_closed() {
    let block = "[[body]]\nname = \"block\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.2, 0.2, 0.2]\n\
                 position_m = [0.25, 0.0, -0.3]\n";
    for period_us in [1_000, 10_000] {
        let mut bench = Bench::at_us(&four_bar(block), period_us);
        let mut last = [0.0; 2];
        for turn in 0..4_000_000 / period_us {
            bench.turn();
            let [crank_rad, open_m] = seen(&bench);
            assert!(open_m < 1e-9, "{period_us} us, turn {turn}: {open_m}");
            last = [last[1], crank_rad];
        }
        // it has come to rest on the block
        assert!((last[1] - last[0]).abs() < 1e-6, "{period_us} us: {last:?}");
    }
}
