//! Programs in the standard's text, for TIA Portal: what is written in SCL does what they do.

use std::path::Path;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Task, TaskPlan};
use onescan_iec_project::instrument::{InstrumentError, Options, Project, Target, instrument};
use onescan_iec_run::{Application, SoftPlc};

use super::abreast::Abreast;
use super::corpus::cases;
use super::driver::{Tasks, original, own_plan};
use super::random::{statements, two_programs};
use crate::rig::{MS, task};

fn ported(files: &[(&str, &str)], tasks: Option<Vec<Task>>) -> Result<Project, InstrumentError> {
    let inputs: Vec<_> = files.iter().map(|(name, text)| Input::from_text(name, SourceKind::Text, *text)).collect();
    instrument(&inputs, &Options { target: Target::Scl, tasks, ..Options::default() })
}

fn scenario(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name);
    std::fs::read_to_string(path).expect("a source")
}

fn written(project: &Project) -> String {
    project.program().next().and_then(|file| file.text.as_deref()).unwrap_or("").to_owned()
}

#[test]
fn the_shear_in_scl() {
    let [shear, alignment] = ["shear/plc/shear.st", "shear/plc/alignment.st"].map(scenario);
    let project = ported(&[("shear.st", &shear), ("alignment.st", &alignment)], None)
        .unwrap_or_else(|refused| panic!("{refused}"));
    insta::assert_snapshot!("scl_port_shear", written(&project));
}

#[test]
fn the_filling_machine_in_scl() {
    let [machine, arm] = ["filling-machine/plc/machine.st", "filling-machine/plc/grip_arm.st"].map(scenario);
    let project =
        ported(&[("machine.st", &machine), ("grip_arm.st", &arm)], None).unwrap_or_else(|refused| panic!("{refused}"));
    insta::assert_snapshot!("scl_port_filling_machine", written(&project));
}

#[test]
fn the_gantry_robot_in_scl() {
    let [robot, servo] = ["gantry-robot/plc/robot.st", "gantry-robot/plc/servo.st"].map(scenario);
    let project =
        ported(&[("robot.st", &robot), ("servo.st", &servo)], None).unwrap_or_else(|refused| panic!("{refused}"));
    let text = written(&project);
    let own = text.find("DATA_BLOCK \"Globals\"").unwrap_or(0);
    insta::assert_snapshot!("scl_port_gantry_robot", &text[own..]);
}

/// The elementary variables of the original's programs by their paths, with their bytes.
fn outputs(plc: &SoftPlc) -> Vec<(String, Vec<u8>)> {
    let variables = plc.application().programs().flat_map(|program| [program.inputs, program.outputs].concat());
    let elementary = variables.filter(|variable| variable.ty.is_some());
    elementary.map(|variable| (variable.path.clone(), variable.bytes(plc.memory()))).collect()
}

fn same_in(project: &Project, plc: &SoftPlc, wanted: &[(String, Vec<u8>)]) -> Vec<(String, Vec<u8>)> {
    let value = |path: &String| {
        let variable = plc.variable(&project.path(path)).unwrap_or_else(|unknown| panic!("{unknown}"));
        (path.clone(), variable.bytes(plc.memory()))
    };
    wanted.iter().map(|(path, _)| value(path)).collect()
}

/// Runs the original, the translation without and with grants side by side, and compares all inputs and outputs of
/// programs after every step.
fn assert_equal(name: &str, text: &str, tasks: &[Task], inputs: &[&str], project: &Project) {
    let shimmed = Application::from_sources([("sdsp.scl", written(project))]).unwrap_or_else(|found| panic!("{found}"));
    let own = project.tasks.clone().expect("tasks of its own");
    let free = TaskPlan::new([vec![task("sdsp", 1, 0, &["SDSP_Scheduler"])], own.clone()].concat());
    for form in [Tasks::Kept, Tasks::Moved] {
        let mut plcs = Abreast::new_in("SDSP.", original(text, tasks), &shimmed, &free, &own_plan(&own, form));
        for step in 1..120 {
            let now = step * 5 * MS;
            plcs.step_where(step, now, inputs, &|path| project.path(path));
            let wanted = outputs(&plcs.plain);
            // Axes have no clock of the PLC's own to move by.
            if !text.contains("AXIS_REF") {
                assert_eq!(wanted, same_in(project, &plcs.inert, &wanted), "{name}: not simulated, t_v = {now}");
            }
            assert_eq!(wanted, same_in(project, plcs.granted(), &wanted), "{name}: granted, {form:?}, t_v = {now}");
        }
    }
}

#[test]
fn a_program_of_the_corpus_gives_the_same_or_is_refused() {
    let reported = cases().into_iter().map(|case| match ported(&[("test.st", case.text)], Some(case.tasks.clone())) {
        Err(refused) => format!("{}: refused: {}", case.name, refused.to_string().replace('\n', "\n    ")),
        Ok(project) => {
            assert_equal(case.name, case.text, &case.tasks, case.inputs, &project);
            format!("{}: the same", case.name)
        }
    });
    insta::assert_snapshot!(reported.collect::<Vec<_>>().join("\n"));
}

const LANGUAGE: &str = "
TYPE
    Colour : (Red := 3, Green, Blue) := Blue;
    Percent : INT (0..100) := 50;
    Row : ARRAY [1..3] OF DINT := [1, 2, 3];
    Inner : STRUCT x : REAL := 1.5; c : Colour; END_STRUCT;
    Outer : STRUCT
        low, high : INT := 7;   // both
        inner : ARRAY [0..1] OF Inner := [(x := 2.5), (x := 3.5, c := Green)];
        name : STRING[12] := 'it$'s';
    END_STRUCT;
END_TYPE
VAR_GLOBAL CONSTANT LIMIT_HIGH : INT := 5 * 2; SIZE : INT := 3; END_VAR
VAR_GLOBAL
    total : DINT := 100;   (* of all *)
    shared : Outer := (low := 1, name := 'shared');
    counter : Count;
END_VAR
VAR_GLOBAL RETAIN kept : LINT := 5; END_VAR
/* a function with everything */
FUNCTION Scale : LREAL
VAR_INPUT value : DINT; factor : LREAL := 2.0; rising : BOOL; END_VAR
VAR_IN_OUT sum : DINT; END_VAR
VAR_OUTPUT parity : BOOL; END_VAR
VAR k : INT; start : DINT := 4; mode : Colour := Green; END_VAR
    FOR k := 1 TO 10 BY 2 DO
        IF k = 9 THEN EXIT; ELSIF k = 3 THEN CONTINUE; END_IF;
        start := start + k;
    END_FOR;
    sum := sum + start;
    parity := (sum MOD 2) = 0 XOR rising;
    CASE mode OF
        Colour#Red, Blue: Scale := 0.0;
        Green: Scale := value * factor;
    END_CASE;
    IF value > 1000 THEN RETURN; END_IF;
    Scale := Scale + 0.5;
END_FUNCTION
FUNCTION Reset VAR_IN_OUT row : Row; END_VAR VAR i : INT; END_VAR
    i := 1;
    WHILE i <= SIZE DO row[i] := 0; i := i + 1; END_WHILE;
END_FUNCTION
FUNCTION_BLOCK Count
VAR_INPUT go : BOOL R_EDGE; back : BOOL F_EDGE; step : INT := 2; END_VAR
VAR_OUTPUT n : INT; END_VAR
VAR_TEMP next : INT := 1; END_VAR
VAR begin : INT; END_VAR
VAR CONSTANT MOST : INT := LIMIT_HIGH * 100; END_VAR
    IF go THEN next := next + step; n := MIN(n + next, MOST); END_IF;
    IF back THEN begin := begin + 1; END_IF;
END_FUNCTION_BLOCK
PROGRAM Main
VAR_INPUT i, j : BOOL; END_VAR
VAR_OUTPUT
    r : LREAL; d, e : DINT; b, p : BOOL; n, m : INT; t : TIME; s : STRING; c, f : INT; w : WORD; q : REAL; l : LINT;
    pc : Percent;
END_VAR
VAR
    row : Row; rows : ARRAY [1..2, 0..1] OF INT := [4, 5, 2(6)]; counts : ARRAY [0..1] OF Count;
    bits : WORD := 16#00F0; colour : Colour; both : SR; out : Outer; on : TON := (PT := T#15ms);
END_VAR
VAR_EXTERNAL total : DINT; END_VAR
    r := Scale(value := total, sum := total, parity => b);
    total := total - 7;
    d := row[1] + row[SIZE] + rows[2, 0];
    IF i AND j THEN Reset(row); END_IF;
    counter(go := i, back := j);
    counts[1](go := j);
    n := counter.n + counts[1].n;
    m := SEL(i, n, LIMIT(0, n, LIMIT_HIGH)) + MAX(1, 2, 3) + MUX(2, 4, 5, 6);
    t := T#1.5s + T#20ms * 3;
    s := CONCAT(shared.name, out.name);
    f := LEN(s) + TO_INT(out.inner[1].x);
    colour := out.inner[1].c;
    CASE colour OF Green: c := 1; Blue: c := 2; ELSE c := 9; END_CASE;
    bits.%X0 := i; bits.3 := j;
    w := SHL(bits, 2) OR 16#1000;
    q := EXPT(out.inner[0].x, 2.0) / INT_TO_REAL(shared.low + out.high);
    both(S1 := i, R := j); p := both.Q1;
    on(IN := i); e := TIME_TO_DINT(on.ET); kept := kept + TO_LINT(n); l := kept;
    pc := pc + 0;
    REPEAT d := d + 1; UNTIL d > 20 END_REPEAT;
END_PROGRAM";

#[test]
fn all_of_the_language_that_scl_has() {
    let tasks = [task("main", 5, 0, &["Main"])];
    let project = ported(&[("test.st", LANGUAGE)], Some(tasks.to_vec())).unwrap_or_else(|refused| panic!("{refused}"));
    let text = written(&project);
    insta::assert_snapshot!("scl_port_language", &text[text.find("TYPE \"Inner\"").unwrap_or(0)..]);
    assert_equal("language", LANGUAGE, &tasks, &["Main.i", "Main.j"], &project);
}

#[test]
fn what_scl_has_not_is_reported_with_its_place() {
    let refused = |text: &str| ported(&[("test.st", text)], None).expect_err("refused").to_string();
    let program = |declared: &str, body: &str| refused(&format!("PROGRAM P\n{declared}\n{body}\nEND_PROGRAM"));
    let reported = [
        program("VAR p : REF_TO INT; x : INT; END_VAR", "p := REF(x);"),
        program("VAR x AT %QX0.0 : BOOL; END_VAR", "x := %IX0.1;"),
        program("VAR t : TIME := T#500us; END_VAR", "t := T#1us + T#30d;"),
        program("VAR x : LREAL; d : DT; l : LDATE; END_VAR", "x := LOG(10.0) + ATAN2(1.0, 2.0);"),
        program("VAR e : (A, B); END_VAR", "e := A;"),
        program("VAR clock : RTC; END_VAR", "clock(IN := TRUE, PDT := DT#2012-01-15-10:00:00);"),
        program("VAR x : INT; END_VAR", "x := TO_INT(5);"),
        program("VAR t : TON; END_VAR", "t(EN := TRUE, IN := TRUE); t(IN := TRUE, NOT Q => x);").replace('\n', " "),
        refused(
            "FUNCTION_BLOCK F METHOD m END_METHOD END_FUNCTION_BLOCK PROGRAM P VAR f : F; END_VAR f.m(); END_PROGRAM",
        ),
        refused(
            "NAMESPACE N FUNCTION_BLOCK F END_FUNCTION_BLOCK END_NAMESPACE PROGRAM P VAR f : N.F; END_VAR f(); END_PROGRAM",
        ),
        refused("PROGRAM P INITIAL_STEP A: END_STEP TRANSITION FROM A TO A := TRUE; END_TRANSITION END_PROGRAM"),
        refused(
            "TYPE S : STRUCT t : TON; END_STRUCT; END_TYPE PROGRAM P VAR s : S; END_VAR s.t(IN := TRUE); END_PROGRAM",
        ),
        refused("FUNCTION_BLOCK P_Program END_FUNCTION_BLOCK PROGRAM P VAR f : P_Program; END_VAR f(); END_PROGRAM"),
        refused("PROGRAM P VAR x : INT; END_VAR x := ; END_PROGRAM"),
    ];
    insta::assert_snapshot!(reported.join("\n"));
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 6, ..Default::default() })]

    #[test]
    fn random_programs_do_in_scl_what_they_do_in_text(first in statements(), second in statements()) {
        let text = two_programs(&first, &second);
        let tasks = [task("slow", 15, 1, &["First"]), task("fast", 5, 0, &["Second"])];
        let project = ported(&[("test.st", &text)], Some(tasks.to_vec())).unwrap_or_else(|refused| panic!("{refused}"));
        assert_equal("random", &text, &tasks, &["First.i", "First.j", "Second.i", "Second.j"], &project);
    }
}
