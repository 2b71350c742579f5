//! Gears, racks, screws, differentials and cams between joints.

use crate::bench::Bench;
use onescan_plant::Scene;

const PERIODS_US: [u64; 3] = [100, 1_000, 10_000];

/// Two wheels about x, of 2 and 8 kg m² about their axes, at z = 0 and z = 3, and a slide along y.
const WHEELS: &str = r#"
version = 1
[[body]]
name = "one"
kind = "dynamic"
shape = "sphere"
radius_m = 0.1
mass_kg = 500.0
collides = false
[[body]]
name = "other"
kind = "dynamic"
shape = "sphere"
radius_m = 0.1
mass_kg = 2000.0
position_m = [0.0, 0.0, 3.0]
collides = false
[[body]]
name = "carriage"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 10.0
position_m = [2.0, 0.0, 0.0]
collides = false
[[joint]]
name = "one"
kind = "revolute"
parent = "ground"
child = "one"
axis = [1.0, 0.0, 0.0]
[[joint]]
name = "other"
kind = "revolute"
parent = "ground"
child = "other"
axis = [1.0, 0.0, 0.0]
[[joint]]
name = "slide"
kind = "prismatic"
parent = "ground"
child = "carriage"
axis = [0.0, 0.0, 1.0]
"#;

fn height(bench: &Bench) -> f64 {
    bench.plant.poses().find(|pose| pose.name == "carriage").expect("a carriage").position_m[2]
}

/// Angle of a wheel about x, from its rotation.
fn angle(bench: &Bench, wheel: &str) -> f64 {
    let [x, _, _, w] = bench.plant.poses().find(|pose| pose.name == wheel).expect("a wheel").rotation_xyzw;
    2.0 * x.atan2(w)
}

#[test]
fn a_rack_turns_its_wheel_as_it_falls() {
    // r = 0.5 m: a = m g / (m + J/r²) = 10 g / (10 + 2/0.25)
    let scene = format!("{WHEELS}[[coupling]]\nname = \"rack\"\njoint = \"slide\"\nof = [\"one\"]\nratio = [0.5]\n");
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&scene, period_us);
        bench.run_us(500_000);
        let (fallen, exact) = (height(&bench), -0.5 * 9.81 * 10.0 / 18.0 * 0.25);
        // of first order in sub-steps of at most 1 ms
        assert!((fallen / exact - 1.0).abs() < 3e-3, "{period_us}: {fallen} {exact}");
        assert!((angle(&bench, "one") - fallen / 0.5).abs() < 1e-12, "{period_us}: it does not slip");
    }
}

#[test]
fn a_differential_divides_force_and_adds_ways() {
    // slide = 0.5 one + 0.5 other: both wheels get half of the force, by their inertia 2 and 8
    let scene = format!(
        "{WHEELS}[[coupling]]\nname = \"differential\"\njoint = \"slide\"\nof = [\"one\", \"other\"]\nratio = [0.5, 0.5]\n"
    );
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&scene, period_us);
        bench.run_us(500_000);
        let [one, other] = ["one", "other"].map(|wheel| angle(&bench, wheel));
        assert!((one / other - 4.0).abs() < 1e-9, "{period_us}: {one} {other}");
        assert!((height(&bench) - 0.5 * (one + other)).abs() < 1e-12, "{period_us}");
    }
}

#[test]
fn a_gear_with_backlash_takes_along_after_its_play() {
    let scene = format!(
        "{WHEELS}[[coupling]]\nname = \"gear\"\njoint = \"other\"\nof = [\"one\"]\nratio = [0.25]\nbacklash_rad = 0.02\n\
         [[axis]]\nname = \"motor\"\njoint = \"one\"\ndrive = \"position\"\ncommand_signal = \"To\"\nspeed_rad_s = 2.0\n\
         acceleration_rad_s2 = 5.0\nposition_signal = \"At\"\n\
         [[fitting]]\nname = \"bearing\"\njoint = \"other\"\nfriction_nm = 50.0\n"
    );
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&scene, period_us);
        for (to, rests) in [(1.0, 0.25 - 0.01), (0.0, 0.01), (1.0, 0.25 - 0.01)] {
            bench.command("To", to);
            bench.run_us(2_000_000);
            assert!((bench.read::<f64>("At") - to).abs() < 1e-9);
            let at = angle(&bench, "other");
            // the wheel leaves the flank as the motor brakes, and friction stops it within its play
            assert!((at - rests).abs() < 0.02, "{period_us}: {at} {rests}");
            assert!((at - 0.25 * to).abs() < 0.01 + 1e-9, "{period_us}: {at}: within the play");
        }
    }
}

#[test]
fn a_cam_leads_its_follower() {
    let scene = format!(
        "{WHEELS}[[coupling]]\nname = \"cam\"\njoint = \"slide\"\nof = [\"one\"]\n\
         cam = [[0.0, 0.0], [1.0, 0.1], [2.0, 0.3], [3.0, 0.1]]\n\
         [[axis]]\nname = \"motor\"\njoint = \"one\"\ndrive = \"position\"\ncommand_signal = \"To\"\nspeed_rad_s = 2.0\n\
         acceleration_rad_s2 = 5.0\ntorque_signal = \"Torque\"\n"
    );
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&scene, period_us);
        bench.command("To", 2.0);
        bench.run_us(2_500_000);
        assert!((height(&bench) - 0.3).abs() < 1e-9, "{period_us}: {}", height(&bench));
        bench.command("To", 1.0);
        bench.run_us(2_500_000);
        assert!((height(&bench) - 0.1).abs() < 1e-9, "{period_us}: {}", height(&bench));
        // the slope at 1 rad is that of the parabola, 0.15 m/rad, and it bears 10 kg
        let torque_nm: f64 = bench.read("Torque");
        assert!((torque_nm - 10.0 * 9.81 * 0.15).abs() < 1e-3, "{period_us}: {torque_nm}");
    }
}

#[test]
fn a_cam_that_repeats_is_an_indexer() {
    // in each turn of the motor it dwells, then lifts by 0.1 m
    let scene = format!(
        "{WHEELS}[[coupling]]\nname = \"cam\"\njoint = \"slide\"\nof = [\"one\"]\n\
         cam = [[-2.0, 0.0], [0.0, 0.0], [1.0, 0.0], [3.0, 0.1], [4.0, 0.1]]\ncam_repeats = true\n\
         [[axis]]\nname = \"motor\"\njoint = \"one\"\ndrive = \"position\"\ncommand_signal = \"To\"\nspeed_rad_s = 8.0\n\
         acceleration_rad_s2 = 20.0\n"
    );
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&scene, period_us);
        for (to, height_m) in [(0.5, 0.0), (3.5, 0.1), (6.5, 0.1), (9.5, 0.2), (21.5, 0.4), (-2.5, 0.0), (-8.5, -0.1)] {
            bench.command("To", to);
            bench.run_us(5_000_000);
            let over = height(&bench) - height_m;
            // the curve through its points is not flat between them, but stays below this
            assert!(over.abs() < 0.006, "{period_us}: {to} {}", height(&bench));
        }
    }
}

#[test]
fn a_coupling_holds_in_contact_too() {
    // the carriage comes to lie on a floor; the wheel stops with it
    let scene = WHEELS.replace("position_m = [2.0, 0.0, 0.0]\ncollides = false", "position_m = [2.0, 0.0, 0.0]")
        + "[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [1.0, 1.0, 0.1]\n\
           position_m = [2.0, 0.0, -0.2]\n\
           [[coupling]]\nname = \"rack\"\njoint = \"slide\"\nof = [\"one\"]\nratio = [0.5]\n";
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&scene, period_us);
        bench.run_us(2_000_000);
        let at = height(&bench);
        assert!((at + 0.1).abs() < 5e-3, "{period_us}: {at}");
        assert!((angle(&bench, "one") - at / 0.5).abs() < 1e-9, "{period_us}");
    }
}

#[test]
fn a_coupling_that_is_wrong_is_refused() {
    let refusal = |keys: &str| {
        let scene = format!("{WHEELS}[[coupling]]\nname = \"c\"\njoint = \"slide\"\n{keys}\n");
        Scene::parse(&scene, "plant.toml").expect_err("a fault").to_string()
    };
    for (keys, reported) in [
        ("of = [\"one\"]\nratio = [1.0, 2.0]", "1 numbers other than 0"),
        ("of = [\"slide\"]\nratio = [1.0]", "one or two other joints"),
        ("of = [\"nobody\"]\nratio = [1.0]", "nobody"),
        ("of = [\"one\"]", "ratio"),
        ("of = [\"one\"]\ncam = [[0.0, 0.5], [1.0, 1.0]]", "a curve with 0 at 0"),
        ("of = [\"one\"]\nratio = [1.0]\ncam_repeats = true", "cam_repeats"),
        ("of = [\"one\"]\nratio = [1.0]\nbacklash_rad = 0.1", "write `backlash_m`"),
    ] {
        assert!(refusal(keys).contains(reported), "{keys}: {}", refusal(keys));
    }
}

/// A carriage of 10 kg on a belt that slips at 5 N, led by a wheel of 0.5 m that at once goes with 2 rad/s: it follows
/// with 0.5 m/s² until it is as fast, after 2 s.
#[test]
fn a_belt_slips_beyond_its_force_and_holds_below_it() {
    let belt = "[[coupling]]\nname = \"belt\"\njoint = \"slide\"\nof = [\"one\"]\nratio = [0.5]\nslip_n = 5.0\n\
                [[axis]]\nname = \"motor\"\njoint = \"one\"\ndrive = \"velocity\"\ncommand_signal = \"V\"\n\
                speed_rad_s = 10.0\nacceleration_rad_s2 = 1e6\n";
    for period_us in PERIODS_US {
        let scene = format!("gravity_m_s2 = [0, 0, 0]\n{}{belt}", WHEELS.trim_start());
        let mut bench = Bench::at_us(
            &scene.replacen("gravity_m_s2 = [0, 0, 0]\nversion = 1", "version = 1\ngravity_m_s2 = [0, 0, 0]", 1),
            period_us,
        );
        bench.command("V", 2.0);
        bench.run_us(1_000_000);
        // a/2 t²; the first order of what is coupled is half of a sub-step of 1 ms at most
        assert!((height(&bench) - 0.25).abs() < 3e-4, "{period_us}: {}", height(&bench));
        bench.run_us(2_000_000);
        // v²/2a = 1 m until it is as fast, then 1 m/s for a second
        assert!((height(&bench) - 2.0).abs() < 2e-3, "{period_us}: {}", height(&bench));
        bench.run_us(1_000_000);
        let at = height(&bench);
        assert!((at - 3.0).abs() < 2e-3, "{period_us}: {at}");
    }
}

#[test]
fn what_slips_has_no_cam_and_no_play() {
    for (keys, wanted) in [
        ("cam = [[0.0, 0.0], [1.0, 1.0]]\nslip_n = 5.0", "coupling `belt` with a `cam`"),
        ("ratio = [1.0]\nbacklash_m = 0.1\nslip_n = 5.0", "coupling `belt` with backlash"),
        ("ratio = [1.0]\nslip_nm = 5.0", "slip_nm"),
        ("ratio = [1.0]\nslip_n = 0.0", "slip_n"),
    ] {
        let belt = format!("[[coupling]]\nname = \"belt\"\njoint = \"slide\"\nof = [\"one\"]\n{keys}\n");
        let refused = Scene::parse(&format!("{WHEELS}{belt}"), "plant.toml").expect_err("it is refused").to_string();
        assert!(refused.contains(wanted), "{keys}: {refused}");
    }
}
