//! Tanks, heat, instruments.

use super::Line;
use super::curves::runge_kutta;
use super::scenes::{G, bench, cube, joint, out_after};

const LAG: &str = "lag of first order";
/// What a tank's open valve takes, m³/s from 1 m: flow coefficient, cross-section, √(2 g).
const VALVE: f64 = 0.62 * 0.001 * 4.428_690_551_393_267;

pub(super) fn lines() -> Vec<Line> {
    let mut lines = tanks();
    lines.extend(heat());
    lines.extend(instruments());
    lines
}

/// Three tanks of 0.05 m², each of which runs into the next.
fn three(first: &str) -> String {
    let tank = |name: &str, more: &str| {
        format!(
            "[[component]]\nname = \"{name}\"\nkind = \"tank\"\nvalve = 1.0\nstroke_s = 0.0\narea_m2 = 0.05\n{more}\n"
        )
    };
    tank("a", first)
        + &tank("b", "inflow_m3_s_from = \"a.drained_m3_s\"")
        + &tank("c", "inflow_m3_s_from = \"b.drained_m3_s\"\nlevel_m_signal = \"Out\"")
}

/// Rates of the levels of three such tanks with an inflow.
fn levels(inflow_m3_s: f64, [a, b, c]: [f64; 3]) -> [f64; 3] {
    let out = |level: f64| VALVE * level.max(0.0).sqrt();
    [inflow_m3_s - out(a), out(a) - out(b), out(b) - out(c)].map(|rate| rate / 0.05)
}

/// A level controller that looks each 100 ms: the command of the pump, from the sum of what was missing.
fn controlled(level_m: f64, sum: &mut f64) -> f64 {
    let missing = 0.3 - level_m;
    *sum += 0.1 * missing;
    (2.0 * missing + 0.1 * *sum).clamp(0.0, 1.0)
}

fn tanks() -> Vec<Line> {
    let runs = |step_us: u64| out_after(&three("initial_m = 1.0"), 10_000_000, step_us);
    let regulated = |step_us: u64| {
        let mut bench = bench(&three("pump_s = 0.5\npump_signal = \"Pump\""), step_us);
        let mut sum = 0.0;
        for _ in 0..150 {
            let pump = controlled(bench.read("Out"), &mut sum);
            bench.command("Pump", pump);
            bench.run_us(100_000);
        }
        bench.read("Out")
    };
    let (mut state, mut sum) = ([0.0; 4], 0.0);
    for _ in 0..150 {
        let pump = controlled(state[2], &mut sum);
        state = runge_kutta(state, 0.1, 1_000, |_, y| {
            let [a, b, c] = levels(0.01 * y[3], [y[0], y[1], y[2]]);
            [a, b, c, (pump - y[3]) / 0.5]
        });
    }
    let filled = |step_us: u64| {
        let parts = "[[component]]\nname = \"t\"\nkind = \"tank\"\npump = 1.0\nlevel_m_signal = \"Out\"\n";
        out_after(parts, 10_000_000, step_us)
    };
    let [.., third] = runge_kutta([1.0, 0.0, 0.0], 10.0, 100_000, |_, y| levels(0.0, *y));
    vec![
        Line::new(
            "three tanks of 0.05 m² in series, the first with 1 m: level of the third after 10 s",
            (third, "m"),
            "Torricelli, own integration",
            runs,
        ),
        Line::new(
            "the same with a pump and a controller at 100 ms, from empty: level of the third after 15 s",
            (state[2], "m"),
            "own integration, sampled alike",
            regulated,
        ),
        Line::new(
            "tank of 1 m² and a pump of 10 l/s with a lag of 0.5 s: level after 10 s",
            (0.01 * (10.0 - 0.5 * (1.0 - libm::exp(-20.0))), "m"),
            LAG,
            filled,
        ),
    ]
}

fn heat() -> Vec<Line> {
    let heated = |step_us: u64| {
        let parts = "[[component]]\nname = \"h\"\nkind = \"heater\"\non = true\ncapacity_j_k = 50.0\ntemperature_degc_signal = \"Out\"\n";
        out_after(parts, 5_000_000, step_us)
    };
    let sensor = |keys: &'static str, time_us: u64| {
        move |step_us: u64| {
            out_after(
                &format!("[[component]]\nname = \"s\"\nkind = \"temperature_sensor\"\n{keys}\n"),
                time_us,
                step_us,
            )
        }
    };
    vec![
        Line::new(
            "heater of 2000 W, 50 J/K and 10 W/K: temperature after 5 s",
            (20.0 + 200.0 * (1.0 - libm::exp(-1.0)), "°C"),
            "Newton's law of cooling",
            heated,
        ),
        Line::new(
            "thermometer with a lag of 1 s in 100 °C, after 1 s",
            (20.0 + 80.0 * (1.0 - libm::exp(-1.0)), "°C"),
            LAG,
            sensor("temperature_degc = 100.0\nlag_s = 1.0\nmeasured_degc_signal = \"Out\"", 1_000_000),
        ),
        Line::new(
            "Pt100 at 100 °C",
            (138.505_5, "Ω"),
            "table of IEC 60751",
            sensor("temperature_degc = 100.0\nlag_s = 0.0\nresistance_ohm_signal = \"Out\"", 100_000),
        ),
        Line::new(
            "Pt100 at -100 °C",
            (60.255_8, "Ω"),
            "table of IEC 60751",
            sensor("temperature_degc = -100.0\nlag_s = 0.0\nresistance_ohm_signal = \"Out\"", 100_000),
        ),
    ]
}

fn instruments() -> Vec<Line> {
    let pressure = |keys: &'static str, time_us: u64| {
        move |step_us: u64| {
            out_after(
                &format!("[[component]]\nname = \"s\"\nkind = \"pressure_sensor\"\npressure_bar = 4.0\n{keys}\n"),
                time_us,
                step_us,
            )
        }
    };
    let felt = |step_us: u64| {
        let parts = format!(
            "{}{}[[component]]\nname = \"m\"\nkind = \"turntable\"\njoint = \"j\"\nspeed_rad_s = 2.0\nrun = true\n\
             [[component]]\nname = \"s\"\nkind = \"accelerometer\"\nbody = \"t\"\npoint_m = [0.3, 0.0, 0.0]\nx_m_s2_signal = \"Out\"\n",
            cube("t", [0.0; 3], 5.0, ""),
            joint("j", "revolute", "t", "[0, 0, 1]", "")
        );
        out_after(&parts, 1_000_000, step_us)
    };
    let tilted = |step_us: u64| {
        let parts = format!(
            "{}[[component]]\nname = \"s\"\nkind = \"inclinometer\"\nbody = \"t\"\npitch_deg_signal = \"Out\"\n\
             [[joint]]\nname = \"j\"\nkind = \"fixed\"\nparent = \"ground\"\nchild = \"t\"\n",
            cube("t", [0.0; 3], 5.0, "rpy_deg = [0.0, 30.0, 0.0]")
        );
        out_after(&parts, 1_000_000, step_us)
    };
    let weighs = |step_us: u64| {
        let parts = format!(
            "{}[[component]]\nname = \"s\"\nkind = \"accelerometer\"\nbody = \"t\"\nz_m_s2_signal = \"Out\"\n{}",
            cube("t", [0.0; 3], 5.0, ""),
            "[[joint]]\nname = \"j\"\nkind = \"fixed\"\nparent = \"ground\"\nchild = \"t\"\n"
        );
        out_after(&parts, 200_000, step_us)
    };
    let cup = |step_us: u64| {
        let parts = format!(
            "gravity_m_s2 = [0, 0, 0]\n{}{}{}[[component]]\nname = \"v\"\nkind = \"vacuum_cup\"\nbody = \"t\"\ntargets = [\"u\"]\non = true\n\
             vacuum_bar_signal = \"Out\"\n",
            cube("t", [0.0; 3], 5.0, "collides = false"),
            cube("u", [0.09, 0.0, 0.0], 5.0, ""),
            joint("j", "prismatic", "t", "[1, 0, 0]", "")
        );
        out_after(&parts, 50_000, step_us)
    };
    vec![
        Line::new(
            "pressure transmitter of 0 to 10 bar at 4 bar: current",
            (10.4, "mA"),
            "IEC 60381-1",
            pressure("current_ma_signal = \"Out\"", 500_000),
        ),
        Line::new(
            "the same with a lag of 50 ms, after 50 ms",
            (4.0 * (1.0 - libm::exp(-1.0)), "bar"),
            LAG,
            pressure("lag_s = 0.05\nmeasured_bar_signal = \"Out\"", 50_000),
        ),
        Line::new(
            "vacuum of 0.8 bar with a time constant of 50 ms, after 50 ms",
            (0.8 * (1.0 - libm::exp(-1.0)), "bar"),
            LAG,
            cup,
        ),
        Line::new(
            "accelerometer 0.3 m from the axis of a table at 2 rad/s, along the radius",
            (-1.2, "m/s²"),
            "ω² r",
            felt,
        ),
        Line::new("accelerometer that stands, upwards", (G, "m/s²"), "g", weighs),
        Line::new("inclinometer on a body with a pitch of 30°", (30.0, "°"), "geometry", tilted),
    ]
}
