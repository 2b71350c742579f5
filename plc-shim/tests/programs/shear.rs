use crate::rig::{Rig, application};

const SHEAR: &str = "
PROGRAM Shear
VAR_INPUT Sensor_1, Sensor_2 : BOOL; Position_1, Position_2 : LREAL; END_VAR
VAR_OUTPUT Drive_1, Drive_2 : LREAL; ixDown, ixUp : BOOL; Strokes : INT; END_VAR
VAR state : INT := 0; dwell : TON; a, b, c : R_TRIG; lower : LREAL := -0.25; END_VAR
a(CLK := Sensor_1); b(CLK := Sensor_2); c(CLK := a.Q AND b.Q);
dwell(IN := state = 2, PT := T#200ms);
CASE state OF
    0: IF Sensor_1 AND Sensor_2 THEN state := 1; END_IF;
    1: ixDown := TRUE; Drive_1 := lower;
       IF Position_1 < lower THEN state := 2; ixDown := FALSE; Drive_1 := 0.0; END_IF;
    2: IF dwell.Q THEN state := 3; Strokes := Strokes + 1; END_IF;
    3: ixUp := TRUE; IF Position_1 >= 0.0 THEN state := 0; ixUp := FALSE; END_IF;
END_CASE;
END_PROGRAM";

#[test]
fn the_reference_program_makes_its_strokes() {
    let mut rig = Rig::new(SHEAR);
    let mut trace = Vec::new();
    for scan in 1..=60_u32 {
        rig.set("Shear.Sensor_1", i64::from(scan >= 3));
        rig.set("Shear.Sensor_2", i64::from(scan >= 3));
        let position: f64 = if (10..40).contains(&scan) { -0.3 } else { 0.1 };
        rig.set_bytes("Shear.Position_1", &position.to_le_bytes());
        rig.scan().expect("no fault");
        let state = rig.int("Shear.state");
        if trace.last().is_none_or(|(_, last)| *last != state) {
            trace.push((scan, state));
        }
    }
    // The dwell timer first sees state 2 in scan 11, and 200 ms are 20 scans.
    assert_eq!(trace, [(1, 0), (3, 1), (10, 2), (31, 3), (40, 0), (41, 1)]);
    assert_eq!(rig.int("Shear.Strokes"), 1);
    assert_eq!(rig.real("Shear.Drive_1"), -0.25);
}

#[test]
fn a_program_lists_its_variables() {
    let application = application(SHEAR);
    let programs: Vec<_> = application.programs().collect();
    let names = |list: &[onescan_iec_run::Variable]| {
        let each = list.iter().map(|variable| format!("{}: {}", variable.path, variable.type_name));
        each.collect::<Vec<_>>().join(", ")
    };
    assert_eq!(programs.len(), 1);
    assert_eq!(
        names(&programs[0].inputs),
        "Shear.Sensor_1: BOOL, Shear.Sensor_2: BOOL, Shear.Position_1: LREAL, Shear.Position_2: LREAL"
    );
    assert_eq!(programs[0].outputs.len(), 5);
    assert_eq!(programs[0].locals[1].type_name, "TON");
    let unknown = application.variable("Shear.Sensor_3").expect_err("not declared");
    assert!(unknown.to_string().contains("did you mean `Sensor_"), "{unknown}");
}
