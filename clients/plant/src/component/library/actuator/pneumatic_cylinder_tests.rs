//! A pneumatic cylinder against closed forms.

use super::*;
use crate::component::tests::Rig;

const OUT: Inputs = Inputs { extend: true, retract: false };
const IN: Inputs = Inputs { extend: false, retract: true };
const OFF: Inputs = Inputs { extend: false, retract: false };

fn rig(p: Parameters) -> Rig<PneumaticCylinder> {
    Rig::new(PneumaticCylinder::new(p))
}

#[test]
fn a_chamber_of_constant_volume_fills_as_a_straight_line_while_choked() {
    let p = Parameters { valve_delay_s: 0.0, dead_cm3: 1000.0, ..Parameters::default() };
    let mut rig = rig(p.clone()).failing(Failure::Jammed);
    let out = rig.run(OUT, 0.001, 50);
    // dp/dt = n R T C ρ0 p_s / V, up to b p_s = 2.1 bar absolute
    let supply_pa = ATMOSPHERE_PA + 6e5;
    let rate = 1.2 * AIR_J_KG_K * 293.15 * 2e-8 * 1.185 * supply_pa / 1e-3;
    let exact_bar = rate * 0.05 / BAR_PA;
    assert!(exact_bar + 1.0 < 0.3 * 7.0, "still choked");
    // a constant rate is integrated exactly; a thousand additions are rounded
    assert!((out.cap_bar / exact_bar - 1.0).abs() < 1e-10, "{} {exact_bar}", out.cap_bar);
}

#[test]
fn it_goes_to_either_end_and_its_switches_say_so() {
    let mut rig = rig(Parameters::default());
    let rest = rig.run(OFF, 0.01, 1);
    assert!(rest.retracted && !rest.extended);
    let out = rig.run(OUT, 0.01, 200);
    assert!(out.extended && !out.retracted && out.position_m == 0.2, "{out:?}");
    // at the stop the chambers stand at supply and atmosphere; the rest decays exponentially
    assert!((out.cap_bar - 6.0).abs() < 1e-6 && out.rod_bar.abs() < 1e-3, "{out:?}");
    let back = rig.run(OFF, 0.01, 200);
    assert!(back.retracted && back.position_m == 0.0, "the spring takes it back: {back:?}");
}

/// From the coil to the outer end, s.
fn stroke_s(rig: &mut Rig<PneumaticCylinder>, dt_s: f64) -> f64 {
    let turns = (1..20_000).find(|_| rig.run(OUT, dt_s, 1).position_m == 0.2);
    f64::from(turns.expect("it arrives")) * dt_s
}

#[test]
fn the_first_stroke_takes_as_long_as_all_others() {
    let mut fine = rig(Parameters::default());
    fine.component.longest_s = 2e-6;
    let fine_s = stroke_s(&mut fine, 1e-4);
    for dt_s in [1e-4, 1e-3, 1e-2] {
        let mut rig = rig(Parameters::default());
        assert_eq!(rig.run(OFF, 0.0, 1).rod_bar, 6.0, "the air is on at the set-up");
        let first_s = stroke_s(&mut rig, dt_s);
        rig.run(OFF, dt_s, (3.0 / dt_s) as u32);
        let second_s = stroke_s(&mut rig, dt_s);
        // what is left of the pressures' decay moves the end by less than a step
        assert!((first_s - second_s).abs() < 1.5 * dt_s, "{dt_s}: {first_s} {second_s}");
        // as with sub-steps of 2 µs, to the step in which it arrives and 1 % of the creep through the cushion
        assert!((first_s - fine_s).abs() < dt_s + 3e-3, "{dt_s}: {first_s} {fine_s}");
    }
}

#[test]
fn at_the_set_up_the_chambers_have_the_pressures_of_their_ports() {
    let bars = |valve: Valve| {
        let out = rig(Parameters { valve, ..Parameters::default() }).run(OFF, 0.0, 1);
        [out.cap_bar, out.rod_bar]
    };
    assert_eq!(bars(Valve::Impulse), [0.0, 6.0]);
    assert_eq!(bars(Valve::Pressurised), [6.0, 6.0]);
    assert_eq!((bars(Valve::Exhausted), bars(Valve::Closed)), ([0.0, 0.0], [0.0, 0.0]));
}

#[test]
fn a_cushion_takes_the_speed_out_of_the_end() {
    let fastest_into_the_end = |cushion_l_s_bar: f64| {
        let mut rig = rig(Parameters { cushion_l_s_bar, moving_kg: 2.0, ..Parameters::default() });
        let mut last = 0.0;
        for _ in 0..2000 {
            let out = rig.run(OUT, 0.001, 1);
            if out.position_m == 0.2 {
                break;
            }
            last = out.velocity_m_s;
        }
        last
    };
    let (cushioned, free) = (fastest_into_the_end(0.02), fastest_into_the_end(2.0));
    assert!(cushioned < 0.5 * free, "{cushioned} {free}");
}

/// The air that a closed valve locks in: `p V^n` stays, whatever the rod does.
fn locked_error(longest_s: f64) -> f64 {
    let p = Parameters {
        valve: Valve::Closed,
        valve_delay_s: 0.0,
        cushion_m: 0.0,
        friction_n: 0.0,
        ..Parameters::default()
    };
    let mut rig = rig(p);
    rig.component.longest_s = longest_s;
    rig.run(OUT, 0.001, 60);
    let constant = |rig: &Rig<PneumaticCylinder>| {
        let volume = 20e-6 + rig.component.cap_m2 * rig.state.rod.position;
        rig.state.cap_pa * libm::pow(volume, 1.2)
    };
    let before = constant(&rig);
    rig.run(OFF, 0.001, 30);
    (constant(&rig) / before - 1.0).abs()
}

#[test]
fn locked_air_keeps_its_polytropic_and_halving_the_step_halves_the_error() {
    let errors = [locked_error(100e-6), locked_error(50e-6), locked_error(25e-6)];
    assert!(errors[1] < 2e-3, "{errors:?}");
    for pair in errors.windows(2) {
        // first order: the ratio tends to 2
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.3, "{errors:?}");
    }
}

#[test]
fn valves_differ_in_what_they_do_at_rest() {
    let after_stop = |valve: Valve| {
        let mut rig = rig(Parameters { valve, ..Parameters::default() });
        rig.run(OUT, 0.001, 80);
        rig.run(OFF, 0.01, 300)
    };
    assert_eq!(after_stop(Valve::Spring).position_m, 0.0);
    assert_eq!(after_stop(Valve::Impulse).position_m, 0.2);
    let closed = after_stop(Valve::Closed);
    assert!(closed.position_m > 0.0 && closed.position_m < 0.2 && closed.velocity_m_s == 0.0, "{closed:?}");
    let exhausted = after_stop(Valve::Exhausted);
    assert!(exhausted.cap_bar.abs() < 1e-3 && exhausted.rod_bar.abs() < 1e-3, "{exhausted:?}");
    let pressurised = after_stop(Valve::Pressurised);
    // the larger area wins
    assert!(pressurised.position_m == 0.2 && (pressurised.rod_bar - 6.0).abs() < 1e-3, "{pressurised:?}");
}

#[test]
fn each_failure_has_its_effect() {
    let ends = |mode: Failure| rig(Parameters::default()).failing(mode).run(OUT, 0.01, 300);
    assert_eq!(ends(Failure::Jammed).position_m, 0.0);
    assert_eq!(ends(Failure::NoSupply).position_m, 0.0);
    assert_eq!(ends(Failure::ValveStuck).position_m, 0.0);
    assert!(!ends(Failure::ExtendedDead).extended);
    let leaking = ends(Failure::Leaking);
    assert!(leaking.rod_bar > 0.02 && leaking.cap_bar < 5.999, "air runs through: {leaking:?}");
    let start = rig(Parameters::default()).failing(Failure::RetractedDead).run(IN, 0.01, 10);
    assert!(!start.retracted);
}

/// Air that leaves choked takes its density with it: `v = C ρ0 R T / A`, whatever pushes.
#[test]
fn a_throttled_rod_goes_as_fast_as_choked_air_leaves() {
    for (throttle, dt_s, turns) in [(0.2, 1e-4, 15_000), (0.2, 1e-3, 1500), (0.2, 1e-2, 150), (0.1, 1e-3, 3000)] {
        let p = Parameters {
            stroke_m: 1.0,
            dead_cm3: 0.1,
            friction_n: 0.0,
            viscous_n_s_m: 0.0,
            polytropic: 1.0,
            throttle_out_l_s_bar: throttle,
            ..Parameters::default()
        };
        let mut rig = Rig::new(PneumaticCylinder::new(p));
        let out = rig.run(Inputs { extend: true, retract: false }, dt_s, turns);
        let exact = throttle * CONDUCTANCE * 1.185 * AIR_J_KG_K * 293.15 / rig.component.ring_m2;
        assert!(out.position_m < 0.9 && (out.velocity_m_s / exact - 1.0).abs() < 0.01, "{throttle}: {out:?} {exact}");
    }
}

#[test]
fn open_throttles_throttle_nothing() {
    let p = || Parameters { throttle_out_l_s_bar: 0.1, stroke_m: 1.0, ..Parameters::default() };
    let on = Inputs { extend: true, retract: false };
    let slow = Rig::new(PneumaticCylinder::new(p())).run(on, 1e-3, 500);
    let fast = Rig::new(PneumaticCylinder::new(p())).failing(Failure::ThrottlesOpen).run(on, 1e-3, 500);
    assert!(fast.position_m > 3.0 * slow.position_m, "{slow:?} {fast:?}");
}

#[test]
fn check_valves_hold_a_load_whose_air_is_lost() {
    for (holds_air, least, most) in [(true, 0.05, 0.2), (false, 0.0, 1e-9)] {
        let p = Parameters { holds_air, load_n: 400.0, friction_n: 0.0, ..Parameters::default() };
        let mut rig = Rig::new(PneumaticCylinder::new(p));
        let on = Inputs { extend: true, retract: false };
        rig.run(on, 0.01, 300);
        let mut rig = rig.failing(Failure::NoSupply);
        let out = rig.run(on, 0.01, 1000);
        assert!((least..=most).contains(&out.position_m), "{holds_air}: {out:?}");
    }
}
