//! Drives on joints feel what they move: forces, pressures and stops at 100 µs, 1 ms and 10 ms.

use crate::bench::Bench;

const PERIODS_US: [u64; 3] = [100, 1_000, 10_000];

/// A body of so many kilograms on a vertical slide, moved by a component.
fn lift(kg: f64, component: &str) -> String {
    format!(
        r#"
        version = 1
        [[body]]
        name = "load"
        kind = "dynamic"
        shape = "box"
        size_m = [0.3, 0.3, 0.3]
        mass_kg = {kg:?}
        [[joint]]
        name = "slide"
        kind = "prismatic"
        parent = "ground"
        child = "load"
        axis = [0.0, 0.0, 1.0]
        [[component]]
        name = "drive"
        joint = "slide"
        {component}
        "#
    )
}

/// A cylinder on a horizontal slide with a plate of 5 kg and 0.1 m; what stands in its way is the rest.
fn push(component: &str, rest: &str) -> String {
    format!(
        r#"
        version = 1
        [[body]]
        name = "plate"
        kind = "dynamic"
        shape = "box"
        size_m = [0.1, 0.1, 0.1]
        mass_kg = 5.0
        friction = 0.0
        [[joint]]
        name = "slide"
        kind = "prismatic"
        parent = "ground"
        child = "plate"
        axis = [1.0, 0.0, 0.0]
        [[component]]
        name = "drive"
        joint = "slide"
        position_m_signal = "Way"
        cap_bar_signal = "Cap"
        rod_bar_signal = "Rod"
        {component}
        {rest}
        "#
    )
}

const HYDRAULIC: &str = "kind = \"hydraulic_cylinder\"\ncommand_signal = \"Command\"";
const PNEUMATIC: &str = "kind = \"pneumatic_cylinder\"\nextend_signal = \"Extend\"";

const ANVIL: &str = r#"
    [[body]]
    name = "anvil"
    kind = "fixed"
    shape = "box"
    size_m = [0.1, 0.4, 0.4]
    position_m = [0.2, 0.0, 0.0]
"#;

#[test]
fn a_press_builds_its_pressure_whatever_the_step() {
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&push(HYDRAULIC, ANVIL), period_us);
        bench.command("Command", 1.0);
        bench.run_us(3_000_000);
        let (cap_bar, rod_bar): (f64, f64) = (bench.read("Cap"), bench.read("Rod"));
        // supply and tank; flow below 0.1 bar is laminar and dies out exponentially
        assert!((cap_bar - 160.0).abs() < 0.1 && rod_bar < 0.1, "{period_us}: {cap_bar} {rod_bar}");
        // 50 kN press a plate of 5 kg: the engine's contacts give way a little
        let way_m: f64 = bench.read("Way");
        assert!((way_m - 0.1).abs() < 1e-3, "{period_us}: {way_m}");
    }
}

#[test]
fn a_pneumatic_cylinder_presses_with_all_of_its_pressure() {
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&push(PNEUMATIC, ANVIL), period_us);
        bench.command("Extend", true);
        bench.run_us(3_000_000);
        let cap_bar: f64 = bench.read("Cap");
        assert!((cap_bar - 6.0).abs() < 1e-3, "{period_us}: {cap_bar}");
    }
}

#[test]
fn a_cylinder_pushes_what_its_force_can_push() {
    // 6 bar on 50 mm are 1178 N; friction of box and floor is half of the weight, of plate and box none
    for (kg, moves) in [(200.0, true), (400.0, false)] {
        for period_us in PERIODS_US {
            let rest = format!(
                r#"
                [[body]]
                name = "floor"
                kind = "fixed"
                shape = "box"
                size_m = [4.0, 1.0, 0.1]
                position_m = [0.0, 0.0, -0.25]
                friction = 1.0
                [[body]]
                name = "box"
                kind = "dynamic"
                shape = "box"
                size_m = [0.4, 0.4, 0.4]
                mass_kg = {kg:?}
                position_m = [0.3, 0.0, 0.0]
                friction = 0.0
                "#
            );
            let mut bench = Bench::at_us(&push(PNEUMATIC, &rest), period_us);
            bench.command("Extend", true);
            bench.run_us(3_000_000);
            let way_m: f64 = bench.read("Way");
            assert!((way_m > 0.19) == moves, "{kg} kg at {period_us} us: {way_m}");
        }
    }
}

#[test]
fn a_hydraulic_lift_feels_its_load() {
    let component = "kind = \"hydraulic_cylinder\"\ncommand_signal = \"Command\"\nstroke_m = 2.0\n\
                     cap_bar_signal = \"Cap\"\nrod_bar_signal = \"Rod\"\nvelocity_m_s_signal = \"Speed\"";
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&lift(200.0, component), period_us);
        bench.command("Command", 0.5);
        bench.run_us(2_000_000);
        let [cap_bar, rod_bar, speed_m_s]: [f64; 3] = ["Cap", "Rod", "Speed"].map(|name| bench.read(name));
        // A p_A - a p_B = m g + F_c + d v, q_A = A v, q_B = a v
        let (area, ring) = (0.063_f64, 0.036_f64);
        let [cap_m2, ring_m2] =
            [area * area, area * area - ring * ring].map(|square| std::f64::consts::FRAC_PI_4 * square);
        let force_n = (cap_bar * cap_m2 - rod_bar * ring_m2) * 1e5;
        let exact_n = 200.0 * 9.81 + 100.0 + 500.0 * speed_m_s;
        // the chambers go on changing slowly with the stroke
        assert!((force_n / exact_n - 1.0).abs() < 2e-3, "{period_us}: {force_n} {exact_n}");
        let gain = 40.0 / 60_000.0 / 35e5_f64.sqrt();
        let flow = 0.5 * gain * ((160.0 - cap_bar) * 1e5).sqrt();
        assert!((flow / (cap_m2 * speed_m_s) - 1.0).abs() < 5e-3, "{period_us}: {speed_m_s}");
    }
}

#[test]
fn a_servo_axis_reports_what_it_lifts() {
    let component = "kind = \"servo_axis\"\nenable_signal = \"On\"\nexecute_signal = \"Go\"\ntarget_m_signal = \"To\"\n\
                     needs_homing = false\nfriction_n = 5.0\nforce_n_signal = \"Force\"\nposition_m_signal = \"Way\"\n\
                     following_m_signal = \"Lag\"\nbusy_signal = \"Busy\"";
    for period_us in PERIODS_US {
        for kg in [7.0, 52.0] {
            let mut bench = Bench::at_us(&lift(kg, component), period_us);
            bench.command("On", true);
            bench.run_us(200_000);
            bench.command("To", 0.4);
            bench.command("Go", true);
            let moving_n: f64 = {
                bench.run_us(700_000);
                assert!(bench.read::<bool>("Busy"));
                bench.read("Force")
            };
            // at constant speed weight and friction
            assert!((moving_n - kg * 9.81 - 5.0).abs() < 0.02 * kg * 9.81, "{kg} kg, {period_us}: {moving_n}");
            bench.run_us(1_500_000);
            let (rests_n, lag_m, way_m): (f64, f64, f64) = (bench.read("Force"), bench.read("Lag"), bench.read("Way"));
            // at rest the weight, less what friction takes of it
            assert!((rests_n - kg * 9.81).abs() < 5.1, "{kg} kg, {period_us}: {rests_n}");
            assert!(lag_m.abs() < 2e-5 && (way_m - 0.4).abs() < 2e-5, "{kg} kg, {period_us}: {lag_m} {way_m}");
        }
    }
}

#[test]
fn a_cylinder_that_is_too_weak_rests_on_its_bottom() {
    let component = "kind = \"pneumatic_cylinder\"\nextend_signal = \"Extend\"\nposition_m_signal = \"Way\"\n\
                     retracted_signal = \"Down\"";
    for period_us in PERIODS_US {
        for kg in [150.0, 500.0] {
            let mut bench = Bench::at_us(&lift(kg, component), period_us);
            bench.command("Extend", true);
            bench.run_us(3_000_000);
            assert_eq!(bench.read::<f64>("Way"), 0.0, "{kg} kg, {period_us}");
            assert!(bench.read::<bool>("Down"));
        }
        let mut bench = Bench::at_us(&lift(50.0, component), period_us);
        bench.command("Extend", true);
        bench.run_us(3_000_000);
        // to the rounding of the way in its pose
        assert!((bench.read::<f64>("Way") - 0.2).abs() < 1e-15, "{period_us}");
    }
}

#[test]
fn an_end_switch_has_one_edge() {
    for period_us in PERIODS_US {
        // a cushion that is open far enough not to throw the rod back
        let keys = "extended_signal = \"Out\"\ncushion_l_s_bar = 1.0";
        let mut bench = Bench::at_us(&push(&format!("{PNEUMATIC}\n{keys}"), ""), period_us);
        let (mut edges, mut before) = (0, false);
        bench.command("Extend", true);
        for _ in 0..1_000_000 / period_us {
            bench.turn();
            let now: bool = bench.read("Out");
            edges += u32::from(now != before);
            before = now;
            let way_m: f64 = bench.read("Way");
            // the stop is the stroke, to the rounding of a pose
            assert!((0.0..=0.2 + 1e-15).contains(&way_m), "{period_us}: {way_m}");
        }
        assert_eq!((edges, before), (1, true), "{period_us}");
    }
}

#[test]
fn a_cylinder_with_a_joint_moves_as_one_without() {
    // the body of the joint has the mass that the cylinder has by itself
    for period_us in PERIODS_US {
        let jointed = push(PNEUMATIC, "");
        let mut bodies = Bench::at_us(&jointed, period_us);
        let mut alone = Bench::at_us(&jointed.replace("joint = \"slide\"", ""), period_us);
        for extend in [true, false] {
            for bench in [&mut bodies, &mut alone] {
                bench.command("Extend", extend);
            }
            for k in 0..600_000 / period_us {
                bodies.turn();
                alone.turn();
                let [one, other]: [f64; 2] = [bodies.read("Way"), alone.read("Way")];
                // both of first order with sub-steps of 50 us; the joint gives way 50 us earlier
                assert!((one - other).abs() < 2e-4, "{period_us} {extend} {k}: {one} {other}");
            }
        }
    }
}

#[test]
fn what_lies_on_a_lift_is_lifted_and_reported() {
    // 10 kg on the slide, 5 kg lying on it: in contact all the time
    let scene = r#"
        version = 1
        [[body]]
        name = "table"
        kind = "dynamic"
        shape = "box"
        size_m = [0.5, 0.5, 0.1]
        mass_kg = 10.0
        [[body]]
        name = "part"
        kind = "dynamic"
        shape = "box"
        size_m = [0.2, 0.2, 0.2]
        mass_kg = 5.0
        position_m = [0.0, 0.0, 0.15]
        [[joint]]
        name = "slide"
        kind = "prismatic"
        parent = "ground"
        child = "table"
        axis = [0.0, 0.0, 1.0]
        [[axis]]
        name = "lift"
        joint = "slide"
        drive = "position"
        command_signal = "To"
        speed_m_s = 0.5
        acceleration_m_s2 = 2.0
        force_max_n = 500.0
        position_signal = "Way"
        force_signal = "Force"
        limit_signal = "Limit"
    "#;
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(scene, period_us);
        bench.command("To", 0.3);
        bench.run_us(1_500_000);
        let (force_n, way_m): (f64, f64) = (bench.read("Force"), bench.read("Way"));
        assert!((force_n - 15.0 * 9.81).abs() < 0.5, "{period_us}: {force_n}");
        assert!((way_m - 0.3).abs() < 1e-5 && !bench.read::<bool>("Limit"), "{period_us}: {way_m}");
    }
}

/// A carriage with 50 N runs to the stop of its joint, or to a post, and its switch is let go.
#[test]
fn a_drive_that_is_to_stand_does_not_press_on_what_stopped_it() {
    let post = "[[body]]\nname = \"post\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 0.3, 0.3]\n\
                position_m = [0.4, 0.0, 0.0]\n";
    for (upper_m, more, end_m) in [(0.2, "", 0.2), (1.0, post, 0.25)] {
        let scene = format!(
            "version = 1\n[[body]]\nname = \"car\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.2, 0.2, 0.2]\n\
             mass_kg = 5.0\n[[joint]]\nname = \"j\"\nkind = \"prismatic\"\nparent = \"ground\"\nchild = \"car\"\n\
             axis = [1.0, 0.0, 0.0]\nlower_m = 0.0\nupper_m = {upper_m:?}\n[[axis]]\nname = \"a\"\njoint = \"j\"\n\
             drive = \"bidirectional\"\nforward_signal = \"On\"\nreverse_signal = \"Back\"\nspeed_m_s = 0.5\n\
             acceleration_m_s2 = 2.0\nforce_max_n = 50.0\nposition_signal = \"Way\"\nforce_signal = \"Force\"\n\
             limit_signal = \"Limit\"\n{more}"
        );
        for period_us in PERIODS_US {
            let mut bench = Bench::at_us(&scene, period_us);
            let seen = |bench: &Bench| (bench.read::<f64>("Force"), bench.read::<bool>("Limit"));
            bench.command("On", true);
            bench.run_us(1_000_000);
            let way_m: f64 = bench.read("Way");
            assert!((way_m - end_m).abs() < 1e-6, "{period_us}: {way_m}");
            bench.command("On", false);
            bench.run_us(300_000);
            let (force_n, limit) = seen(&bench);
            assert!(force_n.abs() < 1e-3 && !limit, "{period_us}, {end_m} m: {force_n} {limit}");
            let way_m: f64 = bench.read("Way");
            assert!((way_m - end_m).abs() < 1e-6, "{period_us}: {way_m}");
        }
    }
}
