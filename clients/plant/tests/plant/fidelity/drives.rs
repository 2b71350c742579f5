//! Drives, cylinders, fluids.

use std::f64::consts::FRAC_PI_4;

use super::Line;
use super::scenes::{G, bench, cube, joint, out_after};

const JELALI: &str = "Jelali, Kroll, *Hydraulic Servo-systems*, ch. 4";

/// What a component on a slide with a load of so many kilograms writes to `Out` after a time.
fn slides(kg: f64, component: &'static str, time_us: u64) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let parts = format!(
            "gravity_m_s2 = [0, 0, 0]\n{}{}[[component]]\nname = \"c\"\njoint = \"j\"\n{component}\n",
            cube("a", [0.0; 3], kg, ""),
            joint("j", "prismatic", "a", "[1, 0, 0]", "")
        );
        out_after(&parts, time_us, step_us)
    }
}

fn wheel(step_us: u64) -> f64 {
    let parts = format!(
        "[[body]]\nname = \"w\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = 0.1\nlength_m = 0.05\nmass_kg = 2.0\n\
         {}[[component]]\nname = \"c\"\njoint = \"j\"\nkind = \"torque_drive\"\ncommand_nm = 0.5\ncurrent_loop_s = 0.0\n\
         velocity_rad_s_signal = \"Out\"\n",
        joint("j", "revolute", "w", "[0, 0, 1]", "")
    );
    out_after(&parts, 1_000_000, step_us)
}

fn holds(step_us: u64) -> f64 {
    let parts = format!(
        "{}{}[[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"position\"\ncommand_signal = \"At\"\nspeed_m_s = 1.0\n\
         acceleration_m_s2 = 1.0\nforce_signal = \"Out\"\n",
        cube("a", [0.0; 3], 2.0, ""),
        joint("j", "prismatic", "a", "[0, 0, 1]", "")
    );
    out_after(&parts, 500_000, step_us)
}

fn servo(step_us: u64) -> f64 {
    let parts = format!(
        "gravity_m_s2 = [0, 0, 0]\n{}{}[[component]]\nname = \"c\"\njoint = \"j\"\nkind = \"servo_axis\"\nenable = true\n\
         needs_homing = false\njerk_m_s3 = 0.0\nfeed_forward_ratio = 1.0\nfriction_n = 0.0\nexecute_signal = \"Go\"\n\
         target_m = 0.5\nlower_m = -0.1\nin_position_signal = \"There\"\n",
        cube("a", [0.0; 3], 20.0, ""),
        joint("j", "prismatic", "a", "[1, 0, 0]", "")
    );
    let mut bench = bench(&parts, step_us);
    bench.run_us(100_000);
    bench.command("Go", true);
    let mut turns = 0_u32;
    while !bench.read::<bool>("There") && turns < 100_000 {
        bench.turn();
        turns += 1;
    }
    f64::from(turns) * 1e-6 * step_us as f64
}

pub(super) fn electric() -> Vec<Line> {
    vec![
        Line::new(
            "50 N on 5 kg (`force_drive`), velocity after 0.5 s",
            (5.0, "m/s"),
            "F t/m",
            slides(
                5.0,
                "kind = \"force_drive\"\ncommand_n = 50.0\nspeed_max_m_s = 100.0\ncurrent_loop_s = 0.0\nvelocity_m_s_signal = \"Out\"",
                500_000,
            ),
        ),
        Line::new(
            "the same through a current loop of 10 ms",
            (10.0 * (0.5 - 0.01 * (1.0 - libm::exp(-50.0))), "m/s"),
            "F (t - T)/m",
            slides(
                5.0,
                "kind = \"force_drive\"\ncommand_n = 50.0\nspeed_max_m_s = 100.0\ncurrent_loop_s = 0.01\nvelocity_m_s_signal = \"Out\"",
                500_000,
            ),
        ),
        Line::new("0.5 N·m on a wheel of 0.01 kg·m² (`torque_drive`), after 1 s", (50.0, "rad/s"), "M t/J", wheel),
        Line::new("force that holds 2 kg", (2.0 * G, "N"), "m g", holds),
        Line::new(
            "servo axis, 0.5 m at 0.5 m/s and 2 m/s²: in position",
            (1.25, "s"),
            "s/v + v/a (drive sizing)",
            servo,
        ),
    ]
}

const STEADY: &str = "kind = \"hydraulic_cylinder\"\nstroke_m = 2.0\nfriction_n = 0.0\nviscous_n_s_m = 0.0\nmoving_kg = 1.0\n\
                      command_constant = 0.4\nvelocity_m_s_signal = \"Out\"";

pub(super) fn oil() -> Vec<Line> {
    let (cap_m2, ring_m2) = (FRAC_PI_4 * 0.063 * 0.063, FRAC_PI_4 * (0.063 * 0.063 - 0.036 * 0.036));
    let phi = cap_m2 / ring_m2;
    let gain = 40.0 / 60_000.0 / 35e5_f64.sqrt();
    let steady = gain * 0.4 * (160e5 - 160e5 / (1.0 + phi * phi * phi)).sqrt() / cap_m2;
    let unit = |step_us: u64| {
        let parts = "[[component]]\nname = \"u\"\nkind = \"hydraulic_unit\"\npump = false\ninitial_bar = 150.0\n\
                     line_l = 0.01\ndrawn_l_min = 60.0\npressure_bar_signal = \"Out\"\n";
        out_after(parts, 2_000_000, step_us)
    };
    let gas = |bar: f64| 10.0 * libm::pow(101.013_25 / (bar + 1.013_25), 1.0 / 1.2);
    let expanded = 101.013_25 * libm::pow(10.0 / (gas(150.0) + 2.0), 1.2) - 1.013_25;
    let relief = |step_us: u64| {
        let parts = "[[component]]\nname = \"u\"\nkind = \"hydraulic_unit\"\npump = true\naccumulator_l = 0.0\n\
                     pressure_bar_signal = \"Out\"\n";
        out_after(parts, 3_000_000, step_us)
    };
    vec![
        Line::new(
            "hydraulic cylinder without load, spool at 0.4: velocity",
            (steady, "m/s"),
            JELALI,
            slides(200.0, STEADY, 1_500_000),
        ),
        Line::new(
            "the same with a flow control of 6 l/min, spool open",
            (1e-4 / ring_m2, "m/s"),
            "v = Q/A",
            slides(
                200.0,
                "kind = \"hydraulic_cylinder\"\nstroke_m = 2.0\nfriction_n = 0.0\nviscous_n_s_m = 0.0\ncommand_constant = 1.0\n\
                 flow_control_l_min = 6.0\nvelocity_m_s_signal = \"Out\"",
                2_000_000,
            ),
        ),
        Line::new(
            "accumulator of 10 l, 100 bar: pressure after 2 l of 150 bar",
            (expanded, "bar"),
            "p Vⁿ constant, n = 1.2",
            unit,
        ),
        Line::new(
            "pump of 40 l/min over its relief valve of 160 bar",
            (160.0 + 40.0 / 6.0, "bar"),
            "p_R + Q/k",
            relief,
        ),
    ]
}

pub(super) fn air() -> Vec<Line> {
    let ring_m2 = FRAC_PI_4 * (0.05 * 0.05 - 0.02 * 0.02);
    let choked = 0.2e-8 * 1.185 * 287.05 * 293.15 / ring_m2;
    let force = |step_us: u64| FRAC_PI_4 * 0.032 * 0.032 * 1e5 * stalled(step_us);
    vec![
        Line::new(
            "pneumatic cylinder with a one-way throttle of 0.2 l/(s·bar): velocity",
            (choked, "m/s"),
            "C ρ₀ R T/A (ISO 6358-1, choked)",
            slides(
                1.0,
                "kind = \"pneumatic_cylinder\"\nstroke_m = 1.0\ndead_cm3 = 0.1\nfriction_n = 0.0\nviscous_n_s_m = 0.0\n\
                 polytropic = 1.0\nthrottle_out_l_s_bar = 0.2\nextend = true\nvelocity_m_s_signal = \"Out\"",
                1_500_000,
            ),
        ),
        Line::new(
            "pneumatic cylinder of 32 mm at 6 bar, stalled: force on the piston",
            (483.0, "N"),
            "catalogues (ISO 15552)",
            force,
        ),
    ]
}

pub(super) fn water() -> Vec<Line> {
    let tank = |step_us: u64| {
        let parts = "[[component]]\nname = \"t\"\nkind = \"tank\"\nvalve = 1.0\nstroke_s = 0.0\ninitial_m = 1.0\narea_m2 = 0.02\n\
                     level_m_signal = \"Out\"\n";
        out_after(parts, 10_000_000, step_us)
    };
    let rate = 0.62 * 0.001 * (2.0 * 9.806_65_f64).sqrt() / (2.0 * 0.02);
    vec![Line::new(
        "tank of 0.02 m² that empties from 1 m: level after 10 s",
        ((1.0 - 10.0 * rate).powi(2), "m"),
        "Torricelli",
        tank,
    )]
}

/// The pressure of a cylinder that a wall has stopped.
fn stalled(step_us: u64) -> f64 {
    let wall = "[[body]]\nname = \"wall\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 1.0, 1.0]\nposition_m = [0.15, 0.0, 0.0]\n";
    let parts = format!(
        "gravity_m_s2 = [0, 0, 0]\n{}{wall}{}[[component]]\nname = \"c\"\njoint = \"j\"\nkind = \"pneumatic_cylinder\"\n\
         bore_m = 0.032\nrod_m = 0.012\nextend = true\ncap_bar_signal = \"Out\"\n",
        cube("a", [0.0; 3], 5.0, ""),
        joint("j", "prismatic", "a", "[1, 0, 0]", "")
    );
    out_after(&parts, 1_500_000, step_us)
}
