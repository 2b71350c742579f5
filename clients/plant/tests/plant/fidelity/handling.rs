//! Many parts: stacks, rows, sorters, layers.

use super::Line;
use super::contacts::FLOOR;
use super::scenes::{G, bench, cube, joint, place};

pub(super) fn lines() -> Vec<Line> {
    vec![
        Line::new("top of a stack of 20 boxes of 5 kg after 1 s", (2.0, "m"), "20 · 0.1 m", stack).coarse(),
        Line::new(
            "30 boxes of 2 kg that a belt pushes against a stopper: length of the row",
            (3.0, "m"),
            "30 · 0.1 m",
            row,
        )
        .coarse(),
        Line::new(
            "sorter with 200 parcels on a belt of 1 m/s, friction 0.5: mean way in 0.5 s",
            (0.5 - 1.0 / G, "m"),
            "v t - v²/(2 µ g)",
            sorter,
        )
        .coarse(),
        Line::new(
            "layer of a palletiser, 3 rows of 4 boxes that a pusher moves by 0.4 m: middle of the last row",
            (0.4 + 0.35, "m"),
            "geometry",
            layer,
        )
        .coarse(),
        Line::new(
            "conveyor that stops at 1 m/s² from 0.5 m/s: way of a box on it, with the start",
            (0.5, "m"),
            "v t",
            stops,
        ),
        Line::new("source of parcels each 0.8 s on a belt of 0.5 m/s: distance of two", (0.4, "m"), "v t", distance),
    ]
}

fn stack(step_us: u64) -> f64 {
    let boxes: String =
        (0..20).map(|k| cube(&format!("b{k}"), [0.0, 0.0, 0.05 + 0.1 * f64::from(k)], 5.0, "")).collect();
    let mut bench = bench(&format!("{FLOOR}{boxes}"), step_us);
    bench.run_us(1_000_000);
    place(&bench, "b19")[2] + 0.05
}

/// A belt along x whose surface is at z = 0.
fn belt(acceleration_m_s2: f64) -> String {
    format!(
        "[[body]]\nname = \"belt\"\nkind = \"kinematic\"\nshape = \"box\"\nsize_m = [60.0, 30.0, 0.1]\nposition_m = [0.0, 0.0, -0.05]\n\
         [[axis]]\nname = \"m\"\nbelt = \"belt\"\ndirection = [1, 0, 0]\ndrive = \"velocity\"\ncommand_signal = \"V\"\nspeed_m_s = 2.0\n\
         acceleration_m_s2 = {acceleration_m_s2:?}\n"
    )
}

fn row(step_us: u64) -> f64 {
    // 1 mm between two, which the belt closes
    let boxes: String =
        (0..30).map(|k| cube(&format!("b{k}"), [-0.05 - 0.101 * f64::from(k), 0.0, 0.05], 2.0, "")).collect();
    let stopper = "[[body]]\nname = \"stopper\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 1.0, 0.2]\nposition_m = [0.05, 0.0, 0.1]\n";
    let mut bench = bench(&format!("{}{stopper}{boxes}", belt(1e6)), step_us);
    bench.command("V", 0.5);
    bench.run_us(1_000_000);
    0.05 - place(&bench, "b29")[0]
}

fn sorter(step_us: u64) -> f64 {
    let at = |k: u32| (0.3 * f64::from(k % 20), 0.3 * f64::from(k / 20));
    let boxes: String = (0..200)
        .map(|k| {
            let (x, y) = at(k);
            cube(&format!("b{k}"), [x, y, 0.05], 2.0, "")
        })
        .collect();
    let mut bench = bench(&format!("{}{boxes}", belt(1e6)), step_us);
    bench.command("V", 1.0);
    bench.run_us(500_000);
    (0..200).map(|k| place(&bench, &format!("b{k}"))[0] - at(k).0).sum::<f64>() / 200.0
}

fn layer(step_us: u64) -> f64 {
    // the pusher's face is at 0 at the start
    let boxes: String = (0..12)
        .map(|k| cube(&format!("b{k}"), [0.05 + 0.1 * f64::from(k / 4) + 0.05, 0.11 * f64::from(k % 4), 0.05], 2.0, ""))
        .collect();
    let pusher = "[[body]]\nname = \"pusher\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.6, 0.06]\nmass_kg = 5.0\n\
                  position_m = [-0.05, 0.165, 0.05]\n";
    let motor = "[[axis]]\nname = \"m\"\njoint = \"j\"\ndrive = \"position\"\ncommand_signal = \"At\"\nspeed_m_s = 0.5\nacceleration_m_s2 = 1.0\n";
    let mut bench =
        bench(&format!("{FLOOR}{pusher}{}{motor}{boxes}", joint("j", "prismatic", "pusher", "[1, 0, 0]", "")), step_us);
    bench.command("At", 0.5);
    bench.run_us(1_800_000);
    (8..12).map(|k| place(&bench, &format!("b{k}"))[0]).sum::<f64>() / 4.0
}

fn stops(step_us: u64) -> f64 {
    let mut bench = bench(&format!("{}{}", belt(1.0), cube("a", [0.0, 0.0, 0.05], 1.0, "")), step_us);
    bench.command("V", 0.5);
    bench.run_us(1_000_000);
    bench.command("V", 0.0);
    bench.run_us(800_000);
    place(&bench, "a")[0]
}

fn distance(step_us: u64) -> f64 {
    let parts = format!(
        "{}[[body]]\nname = \"mark\"\nkind = \"fixed\"\nposition_m = [0.0, 0.0, 0.05]\n{}{}[[component]]\nname = \"s\"\nkind = \"workpiece_source\"\n\
         body = \"mark\"\ntargets = [\"a\", \"b\"]\ninterval_s = 0.8\nenable = true\n",
        belt(1e6),
        cube("a", [5.0, 5.0, 0.05], 1.0, ""),
        cube("b", [5.0, 6.0, 0.05], 1.0, "")
    );
    let mut bench = bench(&parts, step_us);
    bench.command("V", 0.5);
    bench.run_us(2_400_000);
    place(&bench, "a")[0] - place(&bench, "b")[0]
}
