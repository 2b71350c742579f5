//! A hydraulic cylinder against closed forms.

use super::*;
use crate::component::tests::Rig;

fn free() -> Parameters {
    Parameters { friction_n: 0.0, viscous_n_s_m: 0.0, stroke_m: 2.0, ..Parameters::default() }
}

fn rig(p: Parameters) -> Rig<HydraulicCylinder> {
    Rig::new(HydraulicCylinder::new(p))
}

fn spool(command: f64) -> Inputs {
    Inputs { enable: true, command, unit_bar: 0.0 }
}

/// Rod's velocity with no load: with `φ = A_A/A_B`, the flows `A_A v = K u √(p_s - p_A)` and
/// `A_B v = K u √p_B` and the balance `p_A φ = p_B` give `p_A = p_s / (1 + φ³)`.
fn exact_m_s(cylinder: &HydraulicCylinder, u: f64) -> f64 {
    let phi = cylinder.cap_m2 / cylinder.ring_m2;
    let cap_pa = 160.0 * BAR_PA / (1.0 + phi * phi * phi);
    cylinder.gain * u * (160.0 * BAR_PA - cap_pa).sqrt() / cylinder.cap_m2
}

#[test]
fn the_steady_velocity_is_that_of_the_orifice_equation() {
    for u in [0.1, 0.4] {
        let mut rig = rig(free());
        let out = rig.run(spool(u), 0.001, 2000);
        let exact = exact_m_s(&rig.component, u);
        // what is left of the start has decayed over two seconds; chambers change their volume
        // as the rod moves, which takes some 1e-4 of the flow
        assert!((out.velocity_m_s / exact - 1.0).abs() < 1e-3, "{u}: {} {exact}", out.velocity_m_s);
        let phi = rig.component.cap_m2 / rig.component.ring_m2;
        assert!((out.rod_bar / (phi * out.cap_bar) - 1.0).abs() < 1e-2, "forces balance: {out:?}");
    }
}

#[test]
fn a_fed_forward_velocity_is_met() {
    let mut rig = rig(Parameters { command: Command::Velocity, ..free() });
    for wanted in [0.1, 0.05, -0.1] {
        let out = rig.run(spool(wanted), 0.001, 700);
        // the lag of the spool and the oil's spring have decayed
        assert!((out.velocity_m_s - wanted).abs() < 2e-3, "{wanted}: {out:?}");
    }
}

#[test]
fn locked_oil_is_a_spring_of_its_bulk_modulus() {
    // the load is put on a closed valve: c = E (A_A²/V_A + A_B²/V_B)
    let load_n = 5000.0;
    let p = Parameters { initial_m: 0.25, friction_n: 0.0, viscous_n_s_m: 2e5, ..Parameters::default() };
    let mut rig = rig(p);
    rig.state.cap_pa = 80e5;
    rig.state.rod_pa = 80e5 * rig.component.cap_m2 / rig.component.ring_m2;
    rig.component.p.load_n = load_n;
    let out = rig.run(spool(0.0), 0.01, 500);
    let c = &rig.component;
    let volume = |area: f64| 100e-6 + area * 0.25;
    let stiffness = 1.2e9 * (c.cap_m2 * c.cap_m2 / volume(c.cap_m2) + c.ring_m2 * c.ring_m2 / volume(c.ring_m2));
    let exact = -load_n / stiffness;
    // the volumes change by the way itself, 1e-4 m of 0.25 m
    assert!(((out.position_m - 0.25) / exact - 1.0).abs() < 2e-3, "{} {exact}", out.position_m - 0.25);
}

#[test]
fn halving_the_step_halves_the_error() {
    let reached = |longest_s: f64| {
        let mut rig = rig(free());
        rig.component.longest_s = longest_s;
        rig.run(spool(0.5), 0.002, 20).position_m
    };
    let finest = reached(1e-6);
    let errors: Vec<_> = [100e-6, 50e-6, 25e-6].iter().map(|h| (reached(*h) - finest).abs()).collect();
    for pair in errors.windows(2) {
        // first order; the reference itself is off by a fiftieth of the coarsest
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.3, "{errors:?}");
    }
}

#[test]
fn a_locked_cylinder_holds_its_load_and_its_ends_are_seen() {
    let mut loaded = rig(Parameters { load_n: 10_000.0, initial_m: 0.2, ..Parameters::default() });
    let out = loaded.run(Inputs { enable: false, ..spool(1.0) }, 0.01, 100);
    assert!((out.position_m - 0.2).abs() < 1e-6 && out.spool == 0.0, "{out:?}");
    let out = loaded.run(spool(1.0), 0.01, 300);
    assert!(out.extended && out.position_m == 0.5, "{out:?}");
    let out = loaded.run(spool(-1.0), 0.01, 300);
    assert!(out.retracted && out.position_m == 0.0, "{out:?}");
}

#[test]
fn each_failure_has_its_effect() {
    let moved = |mode: Failure| rig(Parameters::default()).failing(mode).run(spool(0.5), 0.01, 100);
    assert_eq!(moved(Failure::SpoolStuck).spool, 0.0);
    assert_eq!(moved(Failure::NoSupply).position_m, 0.0);
    assert_eq!(moved(Failure::Jammed).position_m, 0.0);
    let sinking = |rig: Rig<HydraulicCylinder>| {
        let mut rig = rig;
        rig.run(spool(0.0), 0.01, 200).position_m
    };
    let p = Parameters { load_n: 20_000.0, initial_m: 0.3, ..Parameters::default() };
    assert!(sinking(rig(p.clone()).failing(Failure::Leaking)) < sinking(rig(p)) - 0.01);
}

/// A flow control lets as much out as it is set to: `v = Q / A_B`.
#[test]
fn a_flow_control_sets_the_velocity_whatever_the_load() {
    for (load_n, dt_s, turns) in [(0.0, 1e-4, 20_000), (0.0, 1e-3, 2000), (0.0, 1e-2, 200), (15_000.0, 1e-3, 2000)] {
        let mut rig = rig(Parameters { flow_control_l_min: 6.0, load_n, ..free() });
        let out = rig.run(spool(1.0), dt_s, turns);
        let exact = 1e-4 / rig.component.ring_m2;
        assert!((out.velocity_m_s / exact - 1.0).abs() < 2e-3, "{load_n} {dt_s}: {out:?} {exact}");
        let drawn = exact * rig.component.cap_m2 * 60_000.0;
        assert!((out.drawn_l_min / drawn - 1.0).abs() < 5e-3, "{out:?} {drawn}");
    }
}

/// With a pushing load and the valve in its port the rod is driven in, and goes as the supply fills the other side:
/// `K (p_A + R p_B - p_set) = A_A v`, `A_B v = k u √(p_s - p_B)`, `p_A A_A = F + p_B A_B`.
#[test]
fn a_counterbalance_valve_lets_a_load_down_as_the_supply_drives_it() {
    let p = || Parameters {
        counterbalance: Balanced::Cap,
        counterbalance_l_s_bar: 0.0003,
        load_n: 30_000.0,
        initial_m: 1.8,
        viscous_n_s_m: 5000.0,
        ..free()
    };
    for (dt_s, turns) in [(1e-4, 20_000), (1e-3, 2000), (1e-2, 200)] {
        let mut rig = rig(p());
        let out = rig.run(spool(-0.2), dt_s, turns);
        let c = &rig.component;
        let v = -out.velocity_m_s;
        let wanted_pa = 160e5 - (c.ring_m2 * v / (0.2 * c.gain)).powi(2);
        assert!(v > 0.01 && out.position_m > 0.1, "{out:?}");
        assert!((out.rod_bar * 1e5 / wanted_pa - 1.0).abs() < 0.01, "{out:?} {wanted_pa}");
        let opened = out.cap_bar + 3.0 * out.rod_bar - 200.0;
        assert!((c.cap_m2 * v / (0.0003e-3 * opened) - 1.0).abs() < 0.01, "{out:?}");
    }
    // it holds while nobody drives the rod in, but not if it stays open
    let held = rig(p()).run(spool(0.0), 1e-3, 1000);
    assert!((held.position_m - 1.8).abs() < 0.01, "{held:?}");
    let open = rig(p()).failing(Failure::CounterbalanceOpen).run(spool(-0.2), 1e-3, 1000);
    let braked = rig(p()).run(spool(-0.2), 1e-3, 1000);
    assert!(open.velocity_m_s < 1.2 * braked.velocity_m_s, "it runs ahead: {open:?} {braked:?}");
}

/// In the cushion the rod goes as its screw lets it: `A_B v = k_c √(p_B)` with both chambers in balance.
#[test]
fn a_cushion_slows_the_rod_before_its_end() {
    let mut rig = rig(Parameters { cushion_m: 0.1, ..free() });
    let mut fastest: f64 = 0.0;
    let mut last: f64 = 0.0;
    for _ in 0..20_000 {
        let out = rig.run(spool(1.0), 1e-3, 1);
        fastest = fastest.max(out.velocity_m_s);
        if out.position_m < 1.999 {
            last = out.velocity_m_s;
        }
    }
    let c = &rig.component;
    let series = |one: f64, other: f64| one * other / (one * one + other * other).sqrt();
    let screw = series(c.gain, 2.0 / 60_000.0 / (35.0 * BAR_PA).sqrt());
    // (160 bar - p_A) and p_B drive the two flows: A_A v = k √(p_s - p_A), A_B v = k_c √p_B, p_A A_A = p_B A_B
    let phi = c.cap_m2 / c.ring_m2;
    let exact = (160.0 * BAR_PA / ((c.cap_m2 / c.gain).powi(2) + (c.ring_m2 / screw).powi(2) / phi)).sqrt();
    assert!(fastest > 5.0 * exact && (last / exact - 1.0).abs() < 0.02, "{fastest} {last} {exact}");
}

#[test]
fn a_unit_that_gives_nothing_moves_nothing() {
    let mut rig = rig(Parameters { supply: Supply::Unit, ..free() });
    assert_eq!(rig.run(spool(1.0), 1e-3, 500).position_m, 0.0);
    let out = rig.run(Inputs { unit_bar: 160.0, ..spool(1.0) }, 1e-3, 500);
    assert!(out.position_m > 0.1, "{out:?}");
}
