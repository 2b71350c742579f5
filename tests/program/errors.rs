//! Wrong input: one clear error with file, line and what to do, exit code 2, and nothing half-written.

use crate::typed::{copied_shear, edit, typed};

/// What is said of a shear that was changed at one place.
fn said_of(file: &str, from: &str, to: &str) -> String {
    let folder = copied_shear();
    edit(folder.path(), file, from, to);
    let said = typed(folder.path(), &["run", ".", "--record", "record", "--plot", "plot.svg"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
    assert!(!folder.path().join("plot.svg").exists());
    said.err
}

macro_rules! error_snapshot {
    ($name:ident, $file:literal, $from:literal, $to:literal) => {
        #[test]
        fn $name() {
            insta::assert_snapshot!(said_of($file, $from, $to));
        }
    };
}

error_snapshot!(misspelt_key, "scenario.toml", "until = ", "untill = ");
error_snapshot!(
    misspelt_key_of_what_is_set_in_a_scene,
    "scenario.toml",
    "scene = \"plant.toml\"",
    "scene = \"plant.toml\"\nset.actuator_1.speed_ms = 1.0"
);
error_snapshot!(misspelt_kind, "scenario.toml", "kind = \"soft-plc\"", "kind = \"soft-plv\"");
error_snapshot!(
    misspelt_writer,
    "scenario.toml",
    "Sensor_1 = { type = \"BOOL\", writer = \"plant\"",
    "Sensor_1 = { type = \"BOOL\", writer = \"plnat\""
);
error_snapshot!(misspelt_plotted_signal, "scenario.toml", "signals = [\"Position_1\"", "signals = [\"Positon_1\"");
error_snapshot!(misspelt_program, "scenario.toml", "\"Shear\", \"Alignment\"", "\"Shaer\", \"Alignment\"");
error_snapshot!(
    unknown_type,
    "scenario.toml",
    "type = \"LREAL\", writer = \"plant\", unit = \"m\", about = \"actuator 1",
    "type = \"FLOAT\", writer = \"plant\", unit = \"m\", about = \"actuator 1"
);
error_snapshot!(wrong_type_for_the_plc, "scenario.toml", "Strokes = { type = \"DINT\"", "Strokes = { type = \"INT\"");
error_snapshot!(signal_that_no_program_writes, "scenario.toml", "Strokes = {", "Stroke = {");
error_snapshot!(time_without_unit, "scenario.toml", "step = \"10ms\"", "step = \"10\"");
error_snapshot!(missing_source, "scenario.toml", "plc/alignment.st", "plc/alignement.st");
error_snapshot!(error_in_the_plc_source, "plc/alignment.st", "a.Q AND b.Q", "a.Q AND bb.Q");
error_snapshot!(interval_that_is_no_multiple, "scenario.toml", "interval = \"10ms\"", "interval = \"15ms\"");
error_snapshot!(statement_without_an_end, "plc/shear.st", "END_IF;", "");
error_snapshot!(signal_declared_twice, "scenario.toml", "Sensor_2 = {", "Sensor_1 = {");
error_snapshot!(misspelt_joint_in_the_scene, "plant.toml", "joint = \"guide_1\"", "joint = \"gudie_1\"");
error_snapshot!(misspelt_signal_in_the_scene, "plant.toml", "signal = \"Sensor_1\"", "signal = \"Senosr_1\"");

/// What stops a run is what a terminal shows: of warnings it says how many there are.
#[test]
fn run_shows_the_error_and_the_number_of_warnings() {
    let folder = copied_shear();
    edit(folder.path(), "plc/alignment.st", "a.Q AND b.Q", "a.Q AND bb.Q");
    let path = folder.path().join("plc/alignment.st");
    let own = "    given := 1;\n".repeat(72);
    let block = format!("\nFUNCTION_BLOCK Idle\nVAR_INPUT given : INT; END_VAR\n{own}END_FUNCTION_BLOCK\n");
    let text = std::fs::read_to_string(&path).unwrap();
    // The block stands before what is wrong and behind it.
    std::fs::write(&path, format!("{}{text}{block}", block.replace("Idle", "First"))).unwrap();
    let said = typed(folder.path(), &["run", ".", "--until", "50ms"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
    let of = |code: &str| said.err.match_indices(code).map(|(at, _)| at).collect::<Vec<_>>();
    let (warnings, errors) = (of("Warning: D0402"), of("Error: N0101"));
    assert_eq!((warnings.len(), errors.len()), (0, 1), "{said:?}");
    let end = "1 error, 144 warnings; `onescan check` shows the warnings";
    assert!(said.err.trim_end().ends_with(end), "{}", said.err);
}

#[test]
fn a_file_cut_in_half_is_an_error_and_never_a_panic() {
    for file in ["scenario.toml", "plant.toml", "plc/shear.st", "plc/alignment.st"] {
        let whole = std::fs::read(crate::typed::scenario("shear").join(file)).unwrap();
        for part in 1..8 {
            let folder = copied_shear();
            std::fs::write(folder.path().join(file), &whole[..whole.len() * part / 8]).unwrap();
            let said = typed(folder.path(), &["run", ".", "--until", "50ms"]);
            assert!(matches!(said.code, Some(0 | 2)), "{file} cut at {part}/8: {said:?}");
            assert!(!said.err.contains("panicked"), "{said:?}");
        }
    }
}

#[test]
fn options_that_are_wrong_are_reported() {
    let folder = copied_shear();
    let cases = [
        (&["run", ".", "--until", "5"][..], "is not a time"),
        (&["run", ".", "--pace", "0"], "write `max` or a factor over 0"),
        (&["run", ".", "--runs", "0"], "0 is not in 1..=10000"),
        (&["run", ".", "--signals", "Position_1"], "--plot <FILE>"),
        (&["run", ".", "--plot", "x.svg", "--signals", "Positon_1"], "did you mean `Position_1`?"),
        (&["run", ".", "--save-at", "1s"], "--save <FILE>"),
        (&["run", ".", "--save-at", "9s", "--save", "x"], "is not before the end of the run"),
        (&["run", ".", "--resume", "plant.toml"], "not a checkpoint of onescan"),
        (&["run", ".", "--plot", "no/such/folder/x.svg"], "no/such/folder/x.svg"),
        (&["join", ".", "plnat", "--server", "127.0.0.1:1"], "did you mean `plant`?"),
        (&["run", "."], ""),
    ];
    for (words, message) in cases {
        let said = typed(folder.path(), words);
        let expected = if message.is_empty() { 0 } else { 2 };
        assert_eq!(said.code, Some(expected), "{words:?} {said:?}");
        assert!(said.err.contains(message), "{words:?} {said:?}");
    }
}
