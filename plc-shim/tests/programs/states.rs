use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TaskPlan, TimeSpan, VirtualTime};
use onescan_iec_run::{Application, Builder, CodePolicy, RestoreError, SoftPlc};

use crate::rig::{MS, Rig, application, task};

const TEXT: &str = "
PROGRAM P
VAR t : TON; p : TP; c : CTU; x : LREAL := 0.3; i : DINT; log : ARRAY [0..9] OF LREAL; END_VAR
    t(IN := NOT t.Q, PT := T#30ms); p(IN := t.Q, PT := T#15ms); c(CU := p.Q, PV := 3);
    x := SIN(x * 3.7) + 1.1; i := i + 1; log[i MOD 10] := x;
END_PROGRAM";

#[test]
fn a_restored_plc_goes_on_to_the_last_bit_from_every_scan() {
    let application = application(TEXT);
    let plan = application.single_task(TimeSpan::millis::<10>());
    let mut whole = Rig::with_plan(&application, &plan);
    let mut states = vec![whole.plc.save()];
    for _ in 0..40 {
        whole.scan().expect("no fault");
        states.push(whole.plc.save());
    }
    for (scan, state) in states.iter().enumerate() {
        let mut other = Rig::with_plan(&application, &plan);
        other.plc.restore(state).expect("its own state");
        assert_eq!(&other.plc.save(), state);
        other.now_ns = scan as u64 * 10 * MS;
        for later in &states[scan + 1..] {
            other.scan().expect("no fault");
            assert_eq!(&other.plc.save(), later, "from scan {scan}");
        }
    }
}

#[test]
fn a_fault_is_part_of_the_state() {
    let text = "PROGRAM P VAR n, r : INT; END_VAR r := 1 / n; END_PROGRAM";
    let mut rig = Rig::new(text);
    let fault = rig.scan().expect_err("n is 0");
    let state = rig.plc.save();
    let mut other = Rig::new(text);
    other.plc.restore(&state).expect("its own state");
    assert_eq!(other.plc.fault(), Some(&fault));
    assert_eq!(other.plc.scan(VirtualTime::from_nanos(1)), Err(fault));
    other.plc.cold_start();
    assert_eq!(other.plc.fault(), None);
}

#[test]
fn damaged_states_are_refused_and_change_nothing() {
    let mut rig = Rig::new(TEXT);
    rig.scan().expect("no fault");
    let state = rig.plc.save();
    let mut long = state.clone();
    long.push(0);
    for bytes in [&state[..0], &state[..7], b"OSPLC\0\0\x01........"] {
        assert_eq!(rig.plc.restore(bytes), Err(RestoreError::NotAState));
    }
    assert_eq!(rig.plc.restore(&long), Err(RestoreError::Damaged));
    for length in 8..state.len() {
        assert_eq!(rig.plc.restore(&state[..length]), Err(RestoreError::Damaged), "{length} bytes");
    }
    for at in 8..state.len() {
        let mut other = state.clone();
        other[at] ^= 0x55;
        // It may be a state of other memory or an error, nothing else.
        rig.plc.restore(&other).ok();
    }
    rig.plc.restore(&state).expect("its own state");
    assert_eq!(rig.plc.save(), state);
}

/// All builds of a program: plain, covered, traced.
fn builds(text: &str) -> [Application; 3] {
    let builder = || Application::builder().input(Input::from_text("p.st", SourceKind::Text, text));
    [builder(), builder().covered(), builder().traced()].map(built)
}

fn built(builder: Builder) -> Application {
    builder.build().unwrap_or_else(|error| panic!("{error}"))
}

/// A PLC with one task of 10 ms; a traced one watches something.
fn plc(application: &Application) -> SoftPlc {
    let mut plc = SoftPlc::new(application, &application.single_task(TimeSpan::millis::<10>())).expect("a plan");
    plc.watch([(64..68, None)]);
    plc
}

fn scan(plc: &mut SoftPlc, scans: std::ops::RangeInclusive<u64>) {
    for number in scans {
        plc.scan(VirtualTime::from_nanos(number * 10 * MS)).expect("no fault");
    }
}

#[test]
fn plain_covered_and_traced_builds_take_each_others_states() {
    let builds = builds(TEXT);
    let mut whole = plc(&builds[0]);
    scan(&mut whole, 1..=40);
    for from in &builds {
        let mut first = plc(from);
        scan(&mut first, 1..=17);
        let state = first.save();
        for to in &builds {
            let mut second = plc(to);
            second.restore(&state).expect("the same sources");
            assert_eq!(second.save(), state);
            scan(&mut second, 18..=40);
            assert_eq!(second.save(), whole.save());
            assert_eq!(second.memory(), whole.memory());
        }
    }
}

#[test]
fn restoring_twice_and_into_a_running_plc_gives_the_same_bits() {
    for application in builds(TEXT) {
        let mut plc = plc(&application);
        plc.force("P.i", "7").expect("a DINT");
        scan(&mut plc, 1..=9);
        let early = plc.save();
        plc.unforce("P.i").expect("a variable");
        scan(&mut plc, 10..=30);
        let late = plc.save();
        for _ in 0..2 {
            plc.restore(&early).expect("its own state");
            assert_eq!(plc.save(), early);
            plc.restore(&early).expect("its own state");
            assert_eq!((plc.save(), plc.forced().len()), (early.clone(), 1));
            plc.unforce("P.i").expect("a variable");
            scan(&mut plc, 10..=30);
            assert_eq!(plc.save(), late);
        }
    }
}

/// What the PLC of `text` says to a state of the PLC of [`BEFORE`].
fn refusal(text: &str) -> String {
    let state = Rig::new(BEFORE).plc.save();
    Rig::new(text).plc.restore(&state).expect_err(text).to_string()
}

const BEFORE: &str = "
TYPE Colour : (Red, Green); Pair : STRUCT a : INT; b : INT; END_STRUCT END_TYPE
FUNCTION_BLOCK Shear VAR_INPUT Go : BOOL; END_VAR VAR Strokes : DINT; END_VAR Strokes := Strokes + 1; END_FUNCTION_BLOCK
PROGRAM P VAR limit : INT; colour : Colour; pairs : ARRAY [1..3] OF Pair; s : Shear; END_VAR s(Go := TRUE); END_PROGRAM";

#[test]
fn refusals_say_what_differs() {
    let mut said = Vec::new();
    for (before, after) in [
        ("VAR Strokes : DINT;", "VAR Strokes, Strokes2 : DINT;"),
        ("limit : INT; ", ""),
        ("limit : INT;", "limit : DINT;"),
        ("b : INT;", "b : UINT;"),
        ("[1..3]", "[1..4]"),
        ("(Red, Green)", "(Red, Blue)"),
        ("limit : INT; colour : Colour;", "colour : Colour; limit : INT;"),
        ("Strokes + 1", "Strokes + 2"),
    ] {
        assert!(BEFORE.contains(before), "{before}");
        said.push(refusal(&BEFORE.replace(before, after)));
    }
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn refusals_say_which_task_differs() {
    let application =
        application("PROGRAM P VAR go : BOOL; END_VAR END_PROGRAM PROGRAM Q VAR go : BOOL; END_VAR END_PROGRAM");
    let plan = |tasks| TaskPlan::new(tasks);
    let before = plan(vec![task("main", 20, 1, &["P"]), task("slow", 100, 2, &["Q"])]);
    let state = Rig::with_plan(&application, &before).plc.save();
    let mut triggered = before.clone();
    triggered.tasks[0].single = Some("P.go".to_owned());
    let mut cheap = before.clone();
    cheap.fuel_per_task = 1000;
    let mut background = plan(vec![task("main", 20, 1, &["P"]), task("slow", 100, 2, &[])]);
    background.background.push("Q".to_owned());
    let mut said = Vec::new();
    for other in [
        plan(vec![task("main", 10, 1, &["P"]), task("slow", 100, 2, &["Q"])]),
        plan(vec![task("main", 20, 1, &["P"]), task("slow", 100, 3, &["Q"])]),
        plan(vec![task("main", 20, 1, &["P", "Q"]), task("slow", 100, 2, &[])]),
        plan(vec![task("slow", 100, 2, &["Q"]), task("main", 20, 1, &["P"])]),
        plan(vec![task("main", 20, 1, &["P"]), task("fast", 100, 2, &["Q"])]),
        plan(vec![task("main", 20, 1, &["P"])]),
        triggered,
        background,
        cheap,
    ] {
        said.push(Rig::with_plan(&application, &other).plc.restore(&state).expect_err("another plan").to_string());
    }
    let mut same = before;
    same.tasks[0].name = "MAIN".to_owned();
    Rig::with_plan(&application, &same).plc.restore(&state).expect("names have no case");
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn comments_and_white_space_leave_a_state_valid() {
    let mut before = Rig::new(BEFORE);
    before.scan().expect("no fault");
    let state = before.plc.save();
    let other =
        BEFORE.replace("PROGRAM P", "(* The line. *)\n  Program  p // all of it\n").replace("Strokes +", "STROKES+");
    let mut rig = Rig::new(&other);
    rig.plc.restore(&state).expect("the same code");
    assert_eq!(rig.plc.memory(), before.plc.memory());
}

const COUNTER: &str = "FUNCTION_BLOCK Step
    VAR CONSTANT pace : INT := 1; END_VAR VAR_INPUT on : BOOL R_EDGE; END_VAR VAR n : INT; name : STRING[8]; END_VAR
    n := n + pace; name := 'first'; END_FUNCTION_BLOCK
PROGRAM P VAR steps : ARRAY [1..2] OF Step; limit : INT := 100; t : REF_TO INT; END_VAR
    t := REF(limit); steps[1](on := TRUE); steps[2](on := TRUE); t^ := t^ - 1; END_PROGRAM";

#[test]
fn other_code_takes_a_state_if_it_is_asked_to() {
    let mut rig = Rig::new(COUNTER);
    (0..3).for_each(|_| rig.scan().expect("no fault"));
    let state = rig.plc.save();
    let other =
        COUNTER.replace("pace : INT := 1", "pace : INT := 10").replace("'first'", "'second'").replace("- 1;", "- 2;");
    let mut other = Rig::new(&other);
    let before = other.plc.save();
    assert!(matches!(other.plc.restore(&state), Err(RestoreError::OtherCode(_))));
    assert_eq!(other.plc.save(), before, "nothing has changed");
    other.plc.restore_with(&state, CodePolicy::AnyCode).expect("the same variables");
    let read =
        |rig: &Rig| ["P.steps[2].n", "P.limit", "P.steps[1].name"].map(|path| rig.plc.read(path).expect("it is"));
    assert_eq!(read(&other), ["3", "97", "'first'"]);
    assert_eq!(other.plc.read("P.steps[1].pace").as_deref(), Ok("10"), "a constant is code");
    other.now_ns = rig.now_ns;
    other.scan().expect("no fault");
    assert_eq!(read(&other), ["13", "95", "'second'"]);
    // Of other variables it takes none, whatever it is asked.
    let mut narrow = Rig::new(&COUNTER.replace("limit : INT", "limit : INT := 5; more : INT"));
    let error = narrow.plc.restore_with(&state, CodePolicy::AnyCode).expect_err("another layout");
    assert_eq!(error.to_string(), "the saved state has no variable `P.more`");
}

#[test]
fn what_has_changed_in_the_sources_is_said_by_file() {
    let text = "PROGRAM P VAR CONSTANT k : INT := 1; END_VAR VAR x : INT; END_VAR x := F(k); END_PROGRAM";
    let function = |body: &str| format!("FUNCTION F : INT VAR_INPUT a : INT; END_VAR {body} END_FUNCTION");
    let files = |main: &'static str, other: &'static str, body: &str| {
        let input = |name: &str, text: &str| Input::from_text(name, SourceKind::Text, text);
        Application::builder().input(input(main, text)).input(input(other, &function(body)))
    };
    let state = plc(&built(files("main.st", "shear.st", "F := a;"))).save();
    let mut said = Vec::new();
    for (application, is_same) in [
        (files("main.st", "shear.st", "F := a + 1;"), false),
        (files("main.st", "drive.st", "F := a + 1;"), false),
        (files("main.st", "drive.st", "F := a; (* still *)"), true),
        (files("main.st", "shear.st", "F := a;").constant("p.K", "2"), false),
    ] {
        let restored = plc(&built(application)).restore(&state);
        assert_eq!(restored.is_ok(), is_same);
        said.extend(restored.err().map(|error| error.to_string()));
    }
    insta::assert_snapshot!(said.join("\n"));
}
