//! Pneumatic cylinders.

use std::f64::consts::FRAC_PI_4;

use super::scenes::{bench, cube, joint, when};
use super::{Line, curves};

/// `ρ₀ R T` of the reference atmosphere of ISO 6358-1.
const FLOW_PA: f64 = 1.185 * 287.05 * 293.15;
const ATMOSPHERE_PA: f64 = 101_325.0;

pub(super) fn lines() -> Vec<Line> {
    let mut lines = forces();
    lines.extend(chambers());
    lines.extend(strokes());
    lines
}

/// A cylinder on a slide along x with 5 kg, and a wall so far from its load.
fn cylinder(wall_m: f64, kg: f64, component: &str) -> String {
    format!(
        "gravity_m_s2 = [0, 0, 0]\n[[body]]\nname = \"wall\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 1.0, 1.0]\n\
         position_m = [{:?}, 0.0, 0.0]\n{}{}[[component]]\nname = \"c\"\njoint = \"j\"\nkind = \"pneumatic_cylinder\"\n{component}\n",
        0.1 + wall_m,
        cube("a", [0.0; 3], kg, ""),
        joint("j", "prismatic", "a", "[1, 0, 0]", "")
    )
}

/// The force on the piston of a cylinder at 6 bar: out against a wall, or in at its end.
fn force(bore_mm: f64, rod_mm: f64, out: bool) -> impl Fn(u64) -> f64 {
    move |step_us| {
        let (bore_m, rod_m) = (1e-3 * bore_mm, 1e-3 * rod_mm);
        let (signal, ring) = if out { ("cap", 0.0) } else { ("rod", rod_m * rod_m) };
        let keys = format!("bore_m = {bore_m:?}\nrod_m = {rod_m:?}\nextend = {out}\n{signal}_bar_signal = \"Out\"");
        let mut bench = bench(&cylinder(0.02, 5.0, &keys), step_us);
        bench.run_us(600_000);
        FRAC_PI_4 * (bore_m * bore_m - ring) * 1e5 * bench.read::<f64>("Out")
    }
}

fn forces() -> Vec<Line> {
    let catalogue = "catalogues (ISO 15552)";
    vec![
        Line::new("cylinder of 32 mm at 6 bar, pulling", (415.0, "N"), catalogue, force(32.0, 12.0, false)),
        Line::new("cylinder of 50 mm at 6 bar, pressing on a wall", (1178.0, "N"), catalogue, force(50.0, 20.0, true)),
        Line::new("the same, pulling", (990.0, "N"), catalogue, force(50.0, 20.0, false)),
        Line::new("cylinder of 63 mm at 6 bar, pressing on a wall", (1870.0, "N"), catalogue, force(63.0, 20.0, true)),
        Line::new("the same, pulling", (1682.0, "N"), catalogue, force(63.0, 20.0, false)),
        Line::new(
            "cylinder of 100 mm at 6 bar, pressing on a wall",
            (4712.0, "N"),
            catalogue,
            force(100.0, 25.0, true),
        ),
        Line::new("the same, pulling", (4418.0, "N"), catalogue, force(100.0, 25.0, false)),
    ]
}

fn chambers() -> Vec<Line> {
    // the wall touches the load: nothing moves while one chamber fills and the other one empties
    let blocked = |signal: &'static str| {
        move |step_us: u64| {
            let keys = format!(
                "dead_cm3 = 1000.0\nconductance_l_s_bar = 0.2\npolytropic = 1.0\nvalve_delay_s = 0.0\ncushion_m = 0.0\nextend = true\n\
                 {signal}_bar_signal = \"Out\""
            );
            let mut bench = bench(&cylinder(0.0, 5.0, &keys), step_us);
            bench.run_us(500_000);
            bench.read("Out")
        }
    };
    let full_pa = 6e5 + ATMOSPHERE_PA;
    let flow = 0.2e-8 * FLOW_PA;
    let ring_m3 = 1e-3 + 0.2 * FRAC_PI_4 * (0.05 * 0.05 - 0.02 * 0.02);
    let emptied = full_pa * libm::exp(-0.5 * flow / ring_m3) - ATMOSPHERE_PA;
    let back = |step_us: u64| {
        let keys = "stroke_m = 1.0\ndead_cm3 = 0.1\nfriction_n = 0.0\nviscous_n_s_m = 0.0\npolytropic = 1.0\nthrottle_in_l_s_bar = 0.2\n\
                    extend_signal = \"Go\"\nvelocity_m_s_signal = \"Out\"";
        let mut bench = bench(&cylinder(1.5, 1.0, keys), step_us);
        bench.command("Go", true);
        bench.run_us(800_000);
        bench.command("Go", false);
        bench.run_us(1_500_000);
        -bench.read::<f64>("Out")
    };
    let cap_m2 = FRAC_PI_4 * 0.05 * 0.05;
    vec![
        Line::new(
            "1000 cm³ behind 0.2 l/(s·bar), from 6 bar: pressure after 0.5 s",
            (1e-5 * 0.5 * flow * full_pa / 1e-3, "bar"),
            "ISO 6358-1, choked",
            blocked("cap"),
        ),
        Line::new(
            "1330 cm³ that empty so from 6 bar: pressure after 0.5 s",
            (1e-5 * emptied, "bar"),
            "ISO 6358-1, choked",
            blocked("rod"),
        ),
        Line::new(
            "cylinder with a one-way throttle of 0.2 l/(s·bar), on its way in: velocity",
            (flow / cap_m2, "m/s"),
            "C ρ₀ R T/A (ISO 6358-1, choked)",
            back,
        ),
    ]
}

/// A cylinder by the equations of ISO 6358-1 and of its chambers.
struct Stroke {
    bore_m: f64,
    rod_m: f64,
    length_m: f64,
    kg: f64,
    /// Up to where its way is timed.
    to_m: f64,
    /// Where its cushion begins before the end, and its conductance, m³/(s·Pa).
    cushion: Option<(f64, f64)>,
}

/// Flow through a conductance, kg/s, of the reference atmosphere.
fn flow_kg_s(conductance: f64, up_pa: f64, down_pa: f64) -> f64 {
    if down_pa > up_pa {
        return -flow_kg_s(conductance, down_pa, up_pa);
    }
    let beyond = ((down_pa / up_pa - 0.3) / 0.7).max(0.0);
    conductance * 1.185 * up_pa * (1.0 - beyond * beyond).max(0.0).sqrt()
}

impl Stroke {
    /// The time from the coil's current until the piston is there, by steps of 1 µs.
    fn time_s(&self) -> f64 {
        let cap_m2 = FRAC_PI_4 * self.bore_m * self.bore_m;
        let ring_m2 = cap_m2 - FRAC_PI_4 * self.rod_m * self.rod_m;
        let (supply_pa, wide, heat, delay_s, step_s) = (6e5 + ATMOSPHERE_PA, 2e-8, 287.05 * 293.15, 0.015, 1e-6);
        let next = |t: f64, [cap, rod, x, v]: [f64; 4]| {
            if t < delay_s {
                return [cap, rod, x, v];
            }
            let narrow = self.cushion.filter(|(before_m, _)| self.length_m - x < *before_m);
            let out = narrow.map_or(wide, |(_, conductance)| conductance);
            let (cap_m3, rod_m3) = (20e-6 + cap_m2 * x, 20e-6 + ring_m2 * (self.length_m - x));
            let fills = 1.2 / cap_m3 * (heat * flow_kg_s(wide, supply_pa, cap) - cap * cap_m2 * v);
            let empties = 1.2 / rod_m3 * (heat * flow_kg_s(out, ATMOSPHERE_PA, rod) + rod * ring_m2 * v);
            let push = cap * cap_m2 - rod * ring_m2 - ATMOSPHERE_PA * (cap_m2 - ring_m2) - 50.0 * v;
            let dry = if v > 0.0 { 20.0 } else { push.clamp(-20.0, 20.0) };
            let moved = (v + step_s * (push - dry) / self.kg).max(if x <= 0.0 { 0.0 } else { f64::NEG_INFINITY });
            [cap + step_s * fills, rod + step_s * empties, (x + step_s * moved).max(0.0), moved]
        };
        let start = [ATMOSPHERE_PA, supply_pa, 0.0, 0.0];
        curves::rises(start, step_s, next, |y| y[2] - self.to_m)
    }

    /// The plant's.
    fn ours(&self) -> impl Fn(u64) -> f64 + 'static {
        let (length_m, screw) = self.cushion.unwrap_or((0.0, 0.05e-8));
        let keys = format!(
            "bore_m = {:?}\nrod_m = {:?}\nstroke_m = {:?}\ncushion_m = {length_m:?}\ncushion_l_s_bar = {:?}\nextend = true\n\
             position_m_signal = \"Out\"",
            self.bore_m,
            self.rod_m,
            self.length_m,
            1e8 * screw
        );
        let (parts, most_m) = (cylinder(2.0, self.kg, &keys), self.to_m);
        move |step_us| {
            let mut bench = bench(&parts, step_us);
            when(&mut bench, step_us, 2.0, |bench| bench.read::<f64>("Out") - most_m)
        }
    }
}

fn strokes() -> Vec<Line> {
    let small = Stroke { bore_m: 0.032, rod_m: 0.012, length_m: 0.1, kg: 2.0, to_m: 0.099, cushion: None };
    let large = Stroke { bore_m: 0.063, rod_m: 0.02, length_m: 0.2, kg: 20.0, to_m: 0.199, cushion: None };
    let cushioned = Stroke { cushion: Some((0.02, 0.1e-8)), to_m: 0.19, ..large };
    let source = "ISO 6358-1, Beater ch. 5, own integration";
    vec![
        Line::new("stroke of 99 of 100 mm, 32 mm, 2 kg, 6 bar: time", (small.time_s(), "s"), source, small.ours()),
        Line::new("stroke of 199 of 200 mm, 63 mm, 20 kg, 6 bar: time", (large.time_s(), "s"), source, large.ours()),
        Line::new(
            "the same with an end cushion of 20 mm and 0.1 l/(s·bar), 190 mm",
            (cushioned.time_s(), "s"),
            source,
            cushioned.ours(),
        ),
    ]
}
