//! Closed loops: linkages as exact as trees.

use onescan_server::client::Client;

use crate::bench::Bench;
use crate::four_bar::{FourBar, within_half_a_turn};
use crate::mechanism::{THICK_M, bar, parallelogram, pin};

/// A linkage whose crank goes all the way round.
const LINKAGE: FourBar = FourBar { crank_m: 0.3, coupler_m: 0.9, rocker_m: 0.6, apart_m: 1.0, start_rad: 1.0 };

fn four_bar(more: &str) -> String {
    format!("version = 1\n{}{more}", LINKAGE.parts())
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
    let ([_, a], [from, to], [b, foot]) =
        (ends(0, LINKAGE.crank_m), ends(1, LINKAGE.coupler_m), ends(2, LINKAGE.rocker_m));
    let apart = |one: [f64; 2], other: [f64; 2]| (one[0] - other[0]).hypot(one[1] - other[1]);
    [a[1].atan2(a[0]), apart(a, from).max(apart(to, b)).max(apart(foot, [LINKAGE.apart_m, 0.0]))]
}

#[test]
fn a_four_bar_linkage_falls_as_its_own_equation_says() {
    for time_us in [300_000, 700_000] {
        let wanted = LINKAGE.falls(time_us as f64 * 1e-6);
        for (period_us, off) in [(100, 1e-7), (1_000, 1e-7), (10_000, 1e-4)] {
            let mut bench = Bench::at_us(&four_bar(""), period_us);
            bench.run_us(time_us);
            let [crank_rad, open_m] = seen(&bench);
            let missing = within_half_a_turn(crank_rad - wanted);
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
                *widest = widest.max((crank_rad - LINKAGE.start_rad).abs());
                assert!(open_m < 1e-11, "{period_us} us, half {half}: {open_m}");
            }
        }
        // a sub-step of a loop with friction in it is of second order; the widest place falls between two turns
        assert!(widest[1] <= widest[0] * (1.0 + 1e-3), "{period_us} us: {widest:?}");
        assert!(widest[1] > widest[0] * 0.99, "{period_us} us: {widest:?}");
    }
}

#[test]
fn a_linkage_with_friction_at_each_pin_speeds_up_as_its_closed_form_says() {
    // two equal cranks carry a beam that stays level: all pins turn as fast as the cranks
    let rub = |name: &str, more: &str| {
        format!("[[fitting]]\nname = \"rub_{name}\"\njoint = \"{name}\"\nfriction_nm = 0.1\n{more}")
    };
    let fittings = rub("drive", "balance_nm = 1.2\n") + &rub("left", "") + &rub("right", "") + &rub("foot", "");
    let scene = format!("version = 1\ngravity_m_s2 = [0, 0, 0]\n{}{fittings}", parallelogram(1.0));
    // each crank about its pin, and the beam, which only slides
    let inertia = 2.0 * (1.0 / 12.0 * (0.25 + THICK_M * THICK_M) + 0.25 * 0.25) + 2.0 * 0.25;
    let wanted_rad = 0.5 * (1.2 - 4.0 * 0.1) / inertia;
    for period_us in [100, 1_000, 10_000] {
        let mut bench = Bench::at_us(&scene, period_us);
        bench.run_us(1_000_000);
        let pose = bench.plant.poses().nth(1).expect("a beam");
        let out_m = [pose.position_m[0] - 0.5, pose.position_m[2]];
        let crank_rad = out_m[0].atan2(out_m[1]);
        assert!((crank_rad - wanted_rad).abs() < 1e-5, "{period_us} us: {crank_rad} {wanted_rad}");
        assert!((out_m[0].hypot(out_m[1]) - 0.5).abs() < 1e-11, "{period_us} us: the beam is off its cranks");
        assert!(pose.rotation_xyzw[..3].iter().all(|part| part.abs() < 1e-11), "{period_us} us: {pose:?}");
    }
}

/// A slider on x that a position drive moves, a rod and a crank; they stretch at 0.4 m.
fn slider_crank() -> String {
    let (crank, rod) = ([[0.0, 0.0], [0.0, 0.3]], [[0.0, 0.3], [0.4, 0.0]]);
    let bars = bar("crank", crank[0], crank[1], 1.0) + &bar("rod", rod[0], rod[1], 1.0);
    let slider = "[[body]]\nname = \"slider\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\n\
                  mass_kg = 2.0\nposition_m = [0.4, 0.0, 0.0]\ngroup = \"bars\"\n";
    let guide = "[[joint]]\nname = \"guide\"\nkind = \"prismatic\"\nparent = \"ground\"\nchild = \"slider\"\n\
                 anchor_m = [0.4, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\n";
    let pins = pin("foot", "ground", "crank", crank[0]) + &pin("knee", "crank", "rod", crank[1]);
    format!(
        "version = 1\n{bars}{slider}{guide}{pins}{}[[axis]]\nname = \"drive\"\njoint = \"guide\"\ndrive = \"position\"\n\
         command_signal = \"To\"\nposition_signal = \"Is\"\nspeed_m_s = 0.2\nacceleration_m_s2 = 1.0\n",
        pin("head", "rod", "slider", rod[1])
    )
}

#[test]
fn a_slider_that_is_driven_moves_its_crank_to_a_dead_centre_and_no_farther() {
    let scene = slider_crank();
    for period_us in [100, 1_000, 10_000] {
        // beyond it, the drive is stuck where it was when a millisecond more was too much
        for (to_m, reached_m, off_m) in [(0.3, 0.3, 1e-9), (0.4 - 1e-9, 0.4, 1e-6), (0.45, 0.4, 2.1e-4)] {
            let mut bench = Bench::at_us(&scene, period_us);
            bench.command("To", to_m);
            bench.run_us(3_000_000);
            let is_m = bench.read::<f64>("Is");
            assert!((is_m - reached_m).abs() < off_m, "{period_us} us: to {to_m}, at {is_m}");
            let [crank, rod] = [0, 1].map(|index| bench.plant.poses().nth(index).expect("a bar"));
            let knee_m = [2.0 * crank.position_m[0], 2.0 * crank.position_m[2]];
            let [from_m, head_m] = [knee_m, [0.4 + is_m, 0.0]];
            let middle = [0.5 * (from_m[0] + head_m[0]), 0.5 * (from_m[1] + head_m[1])];
            let open_m = (rod.position_m[0] - middle[0]).hypot(rod.position_m[2] - middle[1]);
            assert!(open_m < 1e-9, "{period_us} us: to {to_m}, open by {open_m} m");
            bench.command("To", 0.2);
            bench.run_us(3_000_000);
            let back_m = bench.read::<f64>("Is");
            assert!((back_m - 0.2).abs() < 1e-9, "{period_us} us: back from {to_m}, at {back_m}");
        }
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
