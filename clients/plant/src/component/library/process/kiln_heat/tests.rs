//! The heat of a kiln, compared with closed forms.

use super::*;
use crate::component::tests::Rig;

const ON: Inputs = Inputs { burner_pct: 100.0, ambient_degc: 20.0, angle_rad: 0.0 };
const DAY_S: f64 = 86400.0;

fn rig(p: Parameters) -> Rig<KilnHeat> {
    Rig::new(KilnHeat::new(p))
}

/// A kiln that is the same all along, whose brick lets through just what a shell of 300 °C loses.
fn by_hand() -> Parameters {
    let kelvin = |degc: f64| degc + 273.15;
    let loss = 15.0 * 280.0 + 0.85 * 5.670_374_419e-8 * (kelvin(300.0).powi(4) - kelvin(20.0).powi(4));
    let brick_m = (((1000.0 - 300.0) / loss) - 1.0 / 150.0) * 3.0;
    let p = Parameters::default();
    Parameters { ends_degc: 1000.0, flame_degc: 1000.0, coating_m: 0.0, coating_start_m: 0.0, brick_m, ..p }
}

#[test]
fn the_steady_state_is_the_closed_form_whatever_the_step() {
    for (dt_s, turns) in [(10.0, 50_000), (3600.0, 200), (30.0 * DAY_S, 12)] {
        for start_degc in [-300.0, 20.0, 900.0] {
            let mut rig = rig(Parameters { start_degc, ..by_hand() });
            let out = rig.run(ON, dt_s, turns);
            assert!((out.hottest_degc - 300.0).abs() < 1e-6, "{dt_s} {start_degc} {out:?}");
            assert!((out.coldest_degc - 300.0).abs() < 1e-6, "{dt_s} {start_degc} {out:?}");
        }
    }
    // 4 m by 60 m of shell, each m² as computed
    let out = rig(by_hand()).run(ON, 1.0, 1);
    assert!((out.loss_w / (PI * 240.0) - (1000.0 - 300.0) / (by_hand().brick_m / 3.0 + 1.0 / 150.0)).abs() < 1e-6);
}

#[test]
fn without_radiation_a_step_of_any_length_is_exact() {
    let p = Parameters { emissivity_pct: 0.0, start_degc: 20.0, ..by_hand() };
    let (g, h) = (1.0 / (p.brick_m / 3.0 + 1.0 / 150.0), 15.0);
    let (end, tau) = ((g * 1000.0 + h * 20.0) / (g + h), p.heat_j_m2_k / (g + h));
    for (dt_s, turns) in [(1.0, 7200), (7200.0, 1)] {
        let out = rig(p.clone()).run(ON, dt_s, turns);
        let exact = end + (20.0 - end) * libm::exp(-7200.0 / tau);
        assert!((out.hottest_degc - exact).abs() < 1e-7, "{dt_s}: {} {exact}", out.hottest_degc);
    }
}

#[test]
fn half_the_step_leaves_a_quarter_of_the_error() {
    let after = |turns: u32| {
        let mut rig = rig(Parameters { start_degc: 20.0, ..Parameters::default() });
        rig.run(ON, 14_400.0 / f64::from(turns), turns).hottest_degc
    };
    let exact = after(50_000);
    let errors = [8, 16, 32].map(|turns| (after(turns) - exact).abs());
    assert!(errors[0] / errors[1] > 3.5 && errors[1] / errors[2] > 3.5, "{errors:?}");
}

#[test]
fn a_flame_makes_its_place_hottest_and_a_ring_makes_its_place_cold() {
    let mut kiln = rig(Parameters::default());
    let out = kiln.run(ON, 60.0, 1);
    assert!((out.hottest_m - 15.0).abs() < 2.0 && (250.0..400.0).contains(&out.hottest_degc), "{out:?}");
    let field = kiln.component.effect(&kiln.state);
    let mut ringed = rig(Parameters::default()).failing(Failure::RingGrowing);
    let out = ringed.run(ON, 3600.0, 5 * 24);
    // five days at 1 µm/s; the middles of the nearest zones are 1.25 m aside
    let thickest = 0.1 + 0.432 * libm::exp(-0.5 * (1.25_f64 / 1.5).powi(2));
    assert!((out.coating_most_m - thickest).abs() < 1e-9, "{out:?}");
    let colder = field.at(40.0, 0.0) - ringed.component.effect(&ringed.state).at(40.0, 0.0);
    assert!(colder > 40.0, "{colder}");
}

#[test]
fn a_lost_brick_grows_a_spot_by_its_lag_and_repair_lets_it_go() {
    let mut rig = rig(Parameters::default()).failing(Failure::BrickLost);
    let out = rig.run(ON, 60.0, 120);
    assert!((out.lost_degc - 150.0 * (1.0 - libm::exp(-1.0))).abs() < 1e-9, "{out:?}");
    let field = rig.component.effect(&rig.state);
    let angle = 250_f64.to_radians();
    assert!((field.at(18.0, angle) - field.at(18.0, angle + PI) - out.lost_degc).abs() < 1e-9);
}

#[test]
fn a_blockage_leaves_the_draught_and_the_heat_of_the_closed_form() {
    let p = Parameters { emissivity_pct: 0.0, start_degc: 20.0, coating_start_m: 0.1, ..Parameters::default() };
    // 10 % of the cross section is open: 5 % of the loss a hundred times
    let left = 1.0 / (1.0 + 0.05 * 99.0);
    let flow = f64::sqrt(left);
    let excess = |zone: usize| 850.0 * (-0.5 * ((2.5 * zone as f64 + 1.25 - 15.0) / 18.0).powi(2)).exp();
    let (before, behind): (f64, f64) = ((0..12).map(excess).sum(), (12..24).map(excess).sum());
    let g = 1.0 / (1.0 / 150.0 + 0.1 / 1.5 + 0.2 / 3.0);
    for (dt_s, turns) in [(600.0, 2000), (86_400.0, 40)] {
        let mut rig = rig(p.clone()).failing(Failure::Blocked);
        let out = rig.run(ON, dt_s, turns);
        assert!((out.flow_pct - 100.0 * flow).abs() < 1e-9, "{out:?}");
        assert!((out.hood_pa - 20.0 * left).abs() < 1e-9 && (out.across_pa - 200.0 * (1.0 - left)).abs() < 1e-9);
        for (zone, degc) in rig.state.zones_degc.iter().enumerate() {
            let share = if zone < 12 { 1.0 + (1.0 - flow) * behind / before } else { flow };
            let steady = (g * (600.0 + share * excess(zone)) + 15.0 * 20.0) / (g + 15.0);
            assert!((degc - steady).abs() < 1e-6, "{dt_s} {zone}: {degc} {steady}");
        }
    }
    let open = rig(p).run(ON, 86_400.0, 40);
    assert_eq!((open.flow_pct, open.hood_pa, open.across_pa), (100.0, 20.0, 0.0));
}

#[test]
fn the_eighths_have_their_zones_and_spots() {
    let mut rig = rig(Parameters { spot_more_degc: 60.0, ..Parameters::default() });
    let out = rig.run(ON, 60.0, 1);
    let zones = rig.state.zones_degc;
    assert_eq!(out.zone_1_degc, zones[..3].iter().copied().fold(0.0, f64::max));
    assert_eq!(out.zone_8_degc, zones[21..].iter().copied().fold(0.0, f64::max));
    // 22 m of 60 m are in the third
    let spot = rig.component.effect(&rig.state).at(22.0, 130_f64.to_radians());
    assert_eq!(out.zone_3_degc, spot);
}

#[test]
fn months_wear_the_brick_and_warm_the_shell() {
    let mut rig = rig(Parameters { wear_m_s: 2e-9, ..Parameters::default() });
    let new = rig.run(ON, 60.0, 1).hottest_degc;
    let worn = rig.run(ON, 3600.0, 24 * 365);
    assert!((worn.brick_least_m - (0.2 - 2e-9 * (365.0 * DAY_S + 60.0))).abs() < 1e-9, "{worn:?}");
    assert!(worn.hottest_degc > new + 20.0, "{new} {worn:?}");
}

#[test]
fn each_other_failure_has_its_effect() {
    let whole = rig(Parameters::default()).run(ON, 3600.0, 48).hottest_degc;
    let out = rig(Parameters::default()).failing(Failure::BurnerOut).run(ON, 3600.0, 48);
    assert!(out.hottest_degc < whole - 50.0, "{whole} {out:?}");
    let bare = rig(Parameters::default()).failing(Failure::CoatingFalls).run(ON, 3600.0, 480);
    assert!(bare.coating_most_m < 1e-3 && bare.hottest_degc > whole + 20.0, "{whole} {bare:?}");
}
