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

#[test]
fn a_stack_of_boxes_stands_as_high_as_its_boxes() {
    let boxed = |number: usize| {
        format!(
            "[[body]]\nname = \"box{number}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.2, 0.2, 0.2]\n\
             mass_kg = 5.0\nposition_m = [0.0, 0.0, {z:?}]\n",
            z = 0.1 + 0.2 * number as f64
        )
    };
    // With contacts of 30 Hz between the boxes, 20 of them were 105 mm too low, or fell.
    for (period_us, time_us, count, lower_m) in [(1_000, 5_000_000, 20, 3e-4), (10_000, 20_000_000, 12, 5e-3)] {
        let boxes: String = (0..count).map(boxed).collect();
        let floor = "version = 1\n[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\n\
                     size_m = [9.0, 9.0, 0.1]\nposition_m = [0.0, 0.0, -0.05]\n";
        let mut bench = Bench::at_us(&format!("{floor}{boxes}"), period_us);
        bench.run_us(time_us);
        let [x, y, z] = place(&bench, &format!("box{}", count - 1));
        let height_m = 0.1 + 0.2 * (count - 1) as f64;
        assert!(x.hypot(y) < 5e-3, "{period_us}: it leans by {} m", x.hypot(y));
        assert!((height_m - z).abs() < lower_m, "{period_us}: {z} in place of {height_m}");
    }
}
