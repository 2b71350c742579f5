//! Springs, dampers, friction, counterweights and brakes of joints against their closed forms.

use crate::bench::Bench;
use onescan_plant::Scene;

const PERIODS_US: [u64; 3] = [100, 1_000, 10_000];

/// A block of 2 kg on a slide, from `initial_m`, with a fitting; `vertical` or not.
fn block(vertical: bool, initial_m: f64, fitting: &str) -> String {
    let axis = if vertical { "[0.0, 0.0, 1.0]" } else { "[1.0, 0.0, 0.0]" };
    let [x_m, z_m] = if vertical { [0.0, initial_m] } else { [initial_m, 0.0] };
    format!(
        r#"
        version = 1
        [[body]]
        name = "block"
        kind = "dynamic"
        shape = "box"
        size_m = [0.1, 0.1, 0.1]
        mass_kg = 2.0
        position_m = [{x_m:?}, 0.0, {z_m:?}]
        [[joint]]
        name = "slide"
        kind = "prismatic"
        parent = "ground"
        child = "block"
        axis = {axis}
        initial_m = {initial_m:?}
        [[fitting]]
        name = "fitting"
        joint = "slide"
        {fitting}
        "#
    )
}

fn way(bench: &Bench) -> f64 {
    let [x, _, z] = bench.plant.poses().next().expect("a block").position_m;
    x + z
}

#[test]
fn a_spring_swings_by_its_closed_form() {
    // ω² = 200/2, δ = 4/(2·2): x = x0 e^(-δt) (cos ωd t + δ/ωd sin ωd t) about rest at 0.1
    for period_us in PERIODS_US {
        let mut bench =
            Bench::at_us(&block(false, 0.2, "spring_n_m = 200.0\nrest_m = 0.1\ndamping_n_s_m = 4.0"), period_us);
        bench.run_us(700_000);
        let (decay, t) = (1.0_f64, 0.7_f64);
        let turns = (100.0 - decay * decay).sqrt();
        let exact = 0.1 + 0.1 * (-decay * t).exp() * ((turns * t).cos() + decay / turns * (turns * t).sin());
        // the fourth order leaves (ωh)⁵/120 of a step, times the steps
        assert!((way(&bench) - exact).abs() < 1e-6, "{period_us}: {} {exact}", way(&bench));
    }
}

/// The greatest way that a block of 2 kg on a spring of 800 N/m, which has 20 rad/s, is from its rest in the twentieth
/// second after it was let go at 50 mm.
fn swings_m(fitting: &str, period_us: u64) -> f64 {
    let mut bench = Bench::at_us(&block(false, 0.05, &format!("spring_n_m = 800.0\n{fitting}")), period_us);
    bench.run_us(19_000_000);
    let mut greatest_m = 0.0_f64;
    for _ in 0..1_000_000 / period_us {
        bench.turn();
        greatest_m = greatest_m.max(way(&bench).abs());
    }
    greatest_m
}

#[test]
fn a_spring_beside_friction_swings_as_far_as_without() {
    for period_us in [1_000, 10_000] {
        let far_m = swings_m("friction_n = 2e-6", period_us);
        // looked at each 0.2 rad it is seen within 0.5 % of its greatest way
        assert!((0.0497..=0.05).contains(&far_m), "{period_us}: {far_m}");
        // friction takes 4 F/k a swing, which ends within F/k of rest
        let rests_m = swings_m("friction_n = 0.2", period_us);
        assert!(rests_m < 0.2 / 800.0, "{period_us}: {rests_m}");
        // δ = 0.8/(2·2), from the beginning of that second on
        let damped_m = swings_m("friction_n = 2e-6\ndamping_n_s_m = 0.8", period_us);
        let exact_m = 0.05 * libm::exp(-0.2 * 19.0);
        assert!((damped_m / exact_m - 1.0).abs() < 0.03, "{period_us}: {damped_m} {exact_m}");
    }
}

#[test]
fn a_released_brake_adds_nothing_to_a_spring() {
    for period_us in [1_000, 10_000] {
        let scene = block(false, 0.05, "spring_n_m = 800.0\nbrake_n = 100.0\nrelease_signal = \"Release\"");
        let mut bench = Bench::at_us(&scene, period_us);
        bench.command("Release", true);
        let mut greatest_m = 0.0_f64;
        for _ in 0..20_000_000 / period_us {
            bench.turn();
            greatest_m = greatest_m.max(way(&bench).abs());
        }
        assert!((0.0497..=0.05 + 1e-9).contains(&greatest_m), "{period_us}: {greatest_m}");
    }
}

#[test]
fn a_spring_that_is_stiff_for_its_step_stays_in_its_bounds() {
    // 2000 rad/s
    for (friction, period_us) in [("friction_n = 0.001", 1_000), ("friction_n = 0.001", 10_000), ("", 10_000)] {
        let mut bench = Bench::at_us(&block(false, 0.05, &format!("spring_n_m = 8e6\n{friction}")), period_us);
        for _ in 0..2_000_000 / period_us {
            bench.turn();
            assert!(way(&bench).abs() <= 0.05 + 1e-9, "{period_us}: {}", way(&bench));
        }
    }
}

#[test]
fn a_counterweight_balances() {
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&block(true, 0.0, &format!("balance_n = {:?}", 2.0 * 9.81)), period_us);
        bench.run_us(1_000_000);
        assert!(way(&bench).abs() < 1e-12, "{period_us}: {}", way(&bench));
    }
}

#[test]
fn dry_friction_holds_what_it_can_and_brakes_the_rest() {
    for period_us in PERIODS_US {
        let mut held = Bench::at_us(&block(true, 0.0, "friction_n = 20.0"), period_us);
        held.run_us(1_000_000);
        assert_eq!(way(&held), 0.0, "{period_us}");
        // 2 kg · 9.81 m/s² less 10 N
        let mut slides = Bench::at_us(&block(true, 0.0, "friction_n = 10.0"), period_us);
        slides.run_us(1_000_000);
        let exact = -0.5 * (9.81 - 5.0);
        // of first order in sub-steps of at most 1 ms
        assert!((way(&slides) - exact).abs() < 3e-3, "{period_us}: {} {exact}", way(&slides));
    }
}

#[test]
fn it_breaks_away_from_its_stiction_and_then_slides() {
    for period_us in PERIODS_US {
        let at = |fitting: &str| {
            let mut bench = Bench::at_us(&block(true, 0.0, fitting), period_us);
            bench.run_us(500_000);
            way(&bench)
        };
        assert_eq!(at("friction_n = 5.0\nstiction_n = 20.0"), 0.0);
        let free = at("friction_n = 5.0\nstiction_n = 19.0\nstribeck_m_s = 0.001");
        let exact = -0.5 * (9.81 - 2.5) * 0.25;
        // it leaves its stiction, 0.62 N too weak, within some milliseconds
        assert!(free > exact && free < 0.9 * exact, "{period_us}: {free} {exact}");
    }
}

#[test]
fn a_brake_holds_until_it_is_released() {
    for period_us in PERIODS_US {
        let mut bench = Bench::at_us(&block(true, 0.0, "brake_n = 100.0\nrelease_signal = \"Release\""), period_us);
        bench.run_us(500_000);
        assert_eq!(way(&bench), 0.0);
        bench.command("Release", true);
        bench.run_us(100_000);
        let fallen = way(&bench);
        assert!((fallen + 0.5 * 9.81 * 0.01).abs() < 1e-3, "{period_us}: {fallen}");
        bench.command("Release", false);
        bench.run_us(500_000);
        // v² / 2a with a = 100/2 - 9.81
        let exact = fallen - 0.5 * (0.981 * 0.981) / (50.0 - 9.81);
        assert!((way(&bench) - exact).abs() < 1e-3, "{period_us}: {} {exact}", way(&bench));
    }
}

#[test]
fn a_fitting_acts_in_contact_too() {
    // the block falls on a floor 10 mm below it and is pressed there by a spring, or held by friction
    let scene = |fitting: &str| {
        block(true, 0.0, fitting)
            + "[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [1.0, 1.0, 0.1]\n\
               position_m = [0.0, 0.0, -0.105]\n"
    };
    for period_us in PERIODS_US {
        let at = |fitting: &str| {
            let mut bench = Bench::at_us(&scene(fitting), period_us);
            bench.run_us(1_000_000);
            way(&bench)
        };
        // a contact is looked for from 2 mm on; the floor's top is 5 mm below
        assert!((at("spring_n_m = 1000.0\nrest_m = 0.02") - (0.02 - 2.0 * 9.81 / 1000.0)).abs() < 2e-3);
        let on_floor = at("spring_n_m = 1000.0\nrest_m = -0.1");
        assert!((on_floor + 0.005).abs() < 1e-3, "{period_us}: {on_floor}");
    }
}

#[test]
fn a_fitting_that_is_wrong_is_refused_by_name() {
    let refusal =
        |fitting: &str| Scene::parse(&block(false, 0.0, fitting), "plant.toml").expect_err("a fault").to_string();
    assert!(refusal("friction_nm = 1.0").contains("write `friction_n`"), "{}", refusal("friction_nm = 1.0"));
    assert!(refusal("friction_n = 5.0\nstiction_n = 4.0").contains("stiction_n"));
    assert!(refusal("release_signal = \"R\"").contains("brake_n"), "{}", refusal("release_signal = \"R\""));
}
