//! Hydraulic cylinders and units.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::scenes::{G, bench, crossings, cube, joint, out_after, when};
use super::{Line, curves};

const JELALI: &str = "Jelali, Kroll, *Hydraulic Servo-systems*, ch. 4";
const FINDEISEN: &str = "Findeisen, *Ölhydraulik*, ch. 4";
const SUPPLY_PA: f64 = 160e5;

/// The cylinder's areas and the valve's gain, open.
fn sizes() -> (f64, f64, f64) {
    let cap_m2 = FRAC_PI_4 * 0.063 * 0.063;
    (cap_m2, cap_m2 - FRAC_PI_4 * 0.036 * 0.036, gain(40.0))
}

/// `Q_N/√Δp_N` of a flow at 35 bar.
fn gain(l_min: f64) -> f64 {
    l_min / 60_000.0 / 35e5_f64.sqrt()
}

/// A cylinder without dry friction on a slide along an axis, which moves so many kilograms.
fn cylinder(kg: f64, axis: &str, keys: &str, body: &str, slide: &str) -> String {
    let viscous = if keys.contains("viscous") { "" } else { "viscous_n_s_m = 0.0\n" };
    format!(
        "{}{}[[component]]\nname = \"c\"\njoint = \"j\"\nkind = \"hydraulic_cylinder\"\nfriction_n = 0.0\n{viscous}\
         moving_kg = 1.0\n{keys}\n",
        cube("a", [0.0; 3], kg, body),
        joint("j", "prismatic", "a", axis, slide)
    )
}

pub(super) fn lines() -> Vec<Line> {
    let mut lines = steady();
    lines.extend(valves());
    lines.extend(swings());
    lines.extend(cycles());
    lines
}

fn steady() -> Vec<Line> {
    let (cap_m2, ring_m2, k) = sizes();
    let (phi, opening) = (cap_m2 / ring_m2, 0.4 * k);
    let rod_pa = (SUPPLY_PA * cap_m2 - 200.0 * G) / (phi * phi * cap_m2 + ring_m2);
    let cap_pa = SUPPLY_PA - phi * phi * rod_pa;
    let lifts = |signal: &'static str| {
        move |step_us: u64| {
            let keys = format!("stroke_m = 2.0\ncommand_constant = 0.4\n{signal}_signal = \"Out\"");
            out_after(&cylinder(200.0, "[0, 0, 1]", &keys, "", ""), 1_500_000, step_us)
        }
    };
    let back_pa = SUPPLY_PA / (phi + 1.0 / (phi * phi));
    let back = |step_us: u64| {
        let keys = "stroke_m = 2.0\ncommand_constant = -0.4\nvelocity_m_s_signal = \"Out\"";
        -out_after(&cylinder(200.0, "[1, 0, 0]", keys, "", "initial_m = 1.5"), 800_000, step_us)
    };
    let led = |step_us: u64| {
        let keys = "stroke_m = 2.0\ncommand = \"velocity\"\ncommand_constant = 0.1\nvelocity_m_s_signal = \"Out\"";
        out_after(&cylinder(200.0, "[1, 0, 0]", keys, "", ""), 1_000_000, step_us)
    };
    vec![
        Line::new(
            "cylinder that lifts 200 kg, spool at 0.4: velocity",
            (opening * rod_pa.sqrt() / ring_m2, "m/s"),
            JELALI,
            lifts("velocity_m_s"),
        ),
        Line::new("the same: pressure of the cap", (1e-5 * cap_pa, "bar"), JELALI, lifts("cap_bar")),
        Line::new("the same: pressure of the rod's side", (1e-5 * rod_pa, "bar"), JELALI, lifts("rod_bar")),
        Line::new(
            "cylinder without load on its way in, spool at -0.4: velocity",
            (opening * back_pa.sqrt() / cap_m2, "m/s"),
            JELALI,
            back,
        ),
        Line::new(
            "cylinder with a command of 0.1 m/s: velocity",
            (0.1, "m/s"),
            "fed forward by the valve's equation",
            led,
        ),
        Line::new("cylinder that stands at its end: pressure of the cap", (160.0, "bar"), "p_P", |step_us| {
            let keys = "stroke_m = 0.05\ncommand_constant = 1.0\ncap_bar_signal = \"Out\"";
            out_after(&cylinder(200.0, "[1, 0, 0]", keys, "", ""), 800_000, step_us)
        }),
    ]
}

fn valves() -> Vec<Line> {
    let (cap_m2, ring_m2, k) = sizes();
    // out of the rod's side through two orifices, one behind the other
    let slowed = |out: f64| {
        let both = k * out / k.hypot(out);
        (SUPPLY_PA / ((cap_m2 / k).powi(2) + (ring_m2 / both).powi(2) * ring_m2 / cap_m2)).sqrt()
    };
    let out = |keys: &'static str, time_us: u64| {
        move |step_us: u64| {
            let keys = format!("command_constant = 1.0\nvelocity_m_s_signal = \"Out\"\n{keys}");
            out_after(&cylinder(50.0, "[1, 0, 0]", &keys, "", ""), time_us, step_us)
        }
    };
    // down with 500 kg: what the counterbalance valve lets pass, by halving
    let balance = |v: f64| {
        let rod_pa = SUPPLY_PA - (ring_m2 * v / (0.2 * k)).powi(2);
        let cap_pa = (500.0 * G + rod_pa * ring_m2 - 5000.0 * v) / cap_m2;
        0.001e-8 * (cap_pa + 3.0 * rod_pa - 350e5) - cap_m2 * v
    };
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if balance(middle) > 0.0 { low = middle } else { high = middle }
    }
    let lowers = |step_us: u64| {
        let keys = "stroke_m = 2.0\ncommand_constant = -0.2\ncounterbalance = \"cap\"\ncounterbalance_bar = 350.0\n\
                    counterbalance_l_s_bar = 0.001\nviscous_n_s_m = 5000.0\nvelocity_m_s_signal = \"Out\"";
        -out_after(&cylinder(500.0, "[0, 0, 1]", keys, "", "initial_m = 1.9"), 2_000_000, step_us)
    };
    let holds = |step_us: u64| {
        let keys = "stroke_m = 2.0\ncommand_constant = 0.0\ncounterbalance = \"cap\"\nviscous_n_s_m = 400000.0\ncap_bar_signal = \"Out\"";
        out_after(&cylinder(500.0, "[0, 0, 1]", keys, "", "initial_m = 0.2"), 2_000_000, step_us)
    };
    vec![
        Line::new(
            "cylinder with a one-way throttle of 20 l/min, spool open: velocity",
            (slowed(gain(20.0)), "m/s"),
            FINDEISEN,
            out("stroke_m = 2.0\nthrottle_l_min = 20.0", 1_000_000),
        ),
        Line::new(
            "cylinder in an end cushion of 2 l/min, spool open: velocity",
            (slowed(gain(2.0)), "m/s"),
            FINDEISEN,
            out("stroke_m = 1.0\ncushion_m = 0.9", 1_000_000),
        ),
        Line::new(
            "counterbalance valve of 350 bar, pilot 3, that lets 500 kg down: velocity",
            (low, "m/s"),
            FINDEISEN,
            lowers,
        ),
        Line::new(
            "counterbalance valve that holds 500 kg: pressure of the cap",
            (1e-5 * 500.0 * G / cap_m2, "bar"),
            "m g/A",
            holds,
        ),
    ]
}

fn swings() -> Vec<Line> {
    let (cap_m2, ring_m2, _) = sizes();
    // in the middle of 0.5 m, with 100 cm³ at each end
    let stiff = 1.2e9 * (cap_m2 * cap_m2 / (1e-4 + 0.25 * cap_m2) + ring_m2 * ring_m2 / (1e-4 + 0.25 * ring_m2));
    // a little spool first, for pressure in both chambers, then it shuts
    let frequency = |step_us: u64| {
        let keys = "spool_s = 0.0\ncommand_signal = \"Spool\"\nvelocity_m_s_signal = \"Out\"";
        let text = cylinder(2000.0, "[1, 0, 0]", keys, "", "initial_m = 0.24");
        let mut bench = bench(&format!("gravity_m_s2 = [0, 0, 0]\n{text}"), step_us);
        bench.command("Spool", 0.05);
        bench.run_us(500_000);
        bench.command("Spool", 0.0);
        10.0 / crossings(&mut bench, step_us, 11, |bench| bench.read("Out"))
    };
    vec![Line::new(
        "cylinder in the middle, valve shut, with 2000 kg: natural frequency",
        ((stiff / 2000.0).sqrt() / TAU, "Hz"),
        JELALI,
        frequency,
    )]
}

/// How a press goes out over 0.3 m, stands, and from the second second on goes back: the time at which it has gone back to
/// 50 mm.
fn cycle_ode() -> f64 {
    let (cap_m2, ring_m2, open) = sizes();
    let step_s = 2e-6;
    let edge = |gain: f64, from: f64, to: f64| gain * (from - to).abs().sqrt().copysign(from - to);
    let next = |t: f64, [cap, rod, x, v, spool]: [f64; 5]| {
        let command = if t < 1.0 { 1.0 } else { -1.0 };
        let spool = spool + step_s * (command - spool) / 0.008;
        let gain = open * spool.abs();
        let (to_cap, to_rod) = if spool > 0.0 { (SUPPLY_PA, 0.0) } else { (0.0, SUPPLY_PA) };
        let cap_rate = 1.2e9 / (1e-4 + cap_m2 * x) * (edge(gain, to_cap, cap) - cap_m2 * v);
        let rod_rate = 1.2e9 / (1e-4 + ring_m2 * (0.3 - x)) * (edge(gain, to_rod, rod) + ring_m2 * v);
        let (cap, rod) = (cap + step_s * cap_rate, rod + step_s * rod_rate);
        let mut v = v + step_s * (cap * cap_m2 - rod * ring_m2 - 500.0 * v) / 200.0;
        let there = (x + step_s * v).clamp(0.0, 0.3);
        if there != x + step_s * v {
            v = 0.0;
        }
        [cap, rod, there, v, spool]
    };
    let mut state = [0.0; 5];
    for step in 0..500_000_u32 {
        state = next(step_s * f64::from(step), state);
    }
    1.0 + curves::rises(state, step_s, |t, state| next(1.0 + t, state), |state| 0.05 - state[2])
}

fn cycles() -> Vec<Line> {
    let press = |step_us: u64| {
        let parts = format!(
            "gravity_m_s2 = [0, 0, 0]\n{}",
            cylinder(
                200.0,
                "[1, 0, 0]",
                "stroke_m = 0.3\nviscous_n_s_m = 500.0\ncommand_signal = \"Spool\"\nposition_m_signal = \"Out\"",
                "",
                ""
            )
        );
        let mut bench = bench(&parts, step_us);
        bench.command("Spool", 1.0);
        bench.run_us(1_000_000);
        bench.command("Spool", -1.0);
        1.0 + when(&mut bench, step_us, 2.0, |bench| 0.05 - bench.read::<f64>("Out"))
    };
    let gas_l = |bar: f64| 10.0 * libm::pow(101.013_25 / (bar + 1.013_25), 1.0 / 1.2);
    let charged_l = gas_l(100.0) - gas_l(150.0) + 0.01 * 50.0 / 12_000.0;
    let charging = |step_us: u64| {
        let parts = "[[component]]\nname = \"u\"\nkind = \"hydraulic_unit\"\npump = true\ninitial_bar = 100.0\nline_l = 0.01\n\
                     pressure_bar_signal = \"Out\"\n";
        let mut bench = bench(parts, step_us);
        when(&mut bench, step_us, 20.0, |bench| bench.read::<f64>("Out") - 150.0)
    };
    vec![
        Line::new(
            "press, 0.3 m out, stands under pressure, from 1 s on back to 0.05 m: time",
            (cycle_ode(), "s"),
            "Jelali, Kroll, own integration",
            press,
        ),
        Line::new(
            "pump of 40 l/min and 0.2 s that charges 10 l from 100 to 150 bar: time",
            (charged_l / 40.0 * 60.0 + 0.2, "s"),
            "p Vⁿ constant, V/Q + T",
            charging,
        ),
    ]
}
