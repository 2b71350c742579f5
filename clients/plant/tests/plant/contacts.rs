//! Contacts of bodies that move: what lies on a turntable, and what passes an edge.

use crate::bench::Bench;

/// A box on a table that turns with 1 rad/s, 0.3 m from its axis.
const TURNTABLE: &str = r#"
        version = 1
        [[body]]
        name = "table"
        kind = "dynamic"
        shape = "cylinder"
        radius_m = 0.5
        length_m = 0.1
        mass_kg = 20.0
        position_m = [0.0, 0.0, -0.05]
        [[body]]
        name = "part"
        kind = "dynamic"
        shape = "box"
        size_m = [0.05, 0.05, 0.05]
        mass_kg = 0.3
        position_m = [0.3, 0.0, 0.025]
        [[joint]]
        name = "bearing"
        kind = "revolute"
        parent = "ground"
        child = "table"
        axis = [0.0, 0.0, 1.0]
        [[component]]
        name = "motor"
        kind = "turntable"
        joint = "bearing"
        speed_rad_s = 1.0
        run_signal = "Run"
    "#;

fn place(bench: &Bench, name: &str) -> [f64; 3] {
    bench.plant.poses().find(|pose| pose.name == name).expect("a body").position_m
}

#[test]
fn what_lies_on_a_turntable_stays_where_it_lies() {
    for (period_us, time_us) in [(100, 1_000_000), (1_000, 5_000_000), (10_000, 5_000_000)] {
        let mut bench = Bench::at_us(TURNTABLE, period_us);
        bench.command("Run", true);
        bench.run_us(time_us);
        let [x, y, _] = place(&bench, "part");
        // it would slip from 4.2 rad/s on. Measured: 10, 25 and 54 µm off; by the tangent alone 0.7 mm at 1 ms
        assert!((x.hypot(y) - 0.3).abs() < 1e-4, "{period_us}: {}", x.hypot(y));
    }
}

#[test]
fn what_passes_an_edge_with_clearance_does_not_touch_it() {
    // the engine foresees contacts within 2 mm, and within the 10 mm that the pusher moves in a step of 10 ms
    for (period_us, clearances_mm) in
        [(100, &[2.0, 5.0, 10.0][..]), (1_000, &[2.0, 5.0, 10.0]), (10_000, &[10.0, 15.0])]
    {
        for clearance_mm in clearances_mm {
            let scene = format!(
                r#"
                version = 1
                gravity_m_s2 = [0.0, 0.0, 0.0]
                [[body]]
                name = "belt"
                kind = "fixed"
                shape = "box"
                size_m = [1.0, 0.4, 0.1]
                position_m = [0.0, 0.2, -0.05]
                [[body]]
                name = "pusher"
                kind = "dynamic"
                shape = "box"
                size_m = [0.3, 0.02, 0.08]
                mass_kg = 1.0
                velocity_m_s = [0.0, 1.0, 0.0]
                position_m = [0.0, -0.27, {z:?}]
                "#,
                z = 0.04 + 1e-3 * clearance_mm
            );
            let mut bench = Bench::at_us(&scene, period_us);
            bench.run_us(300_000);
            let [_, y, z] = place(&bench, "pusher");
            // roundings of 3000 steps
            assert!((y - 0.03).abs() < 1e-12, "{period_us} {clearance_mm}: {y}");
            assert!((z - 0.04 - 1e-3 * clearance_mm).abs() < 1e-12, "{period_us} {clearance_mm}: {z}");
        }
    }
}
