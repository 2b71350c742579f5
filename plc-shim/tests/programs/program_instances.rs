//! Programs as the global instances that they are in CODESYS and TwinCAT.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, Severity, TimeSpan};
use onescan_iec_run::Application;

use crate::rig::{Rig, application_in, findings_in};

const VENDORS: [Dialect; 2] = [Dialect::Codesys, Dialect::TwinCat];

/// The usual project: MAIN calls all others and reads what they give.
const CELL: &str = "
    PROGRAM MAIN
    VAR seen, own, kept : INT; t : TON; END_VAR
    VAR_OUTPUT Total : INT; END_VAR
        Cell(i := 2);
        Cell(i := 3, o => seen);
        Cell.Report();
        own := own + MAIN.own + 1;
        kept := Cell.n;
        Total := Cell.o + Sum();
    END_PROGRAM

    PROGRAM Cell
    VAR_INPUT i : INT; END_VAR
    VAR_OUTPUT o : INT; END_VAR
    VAR n, reported : INT; END_VAR
        n := n + 1;
        o := 10 * i + n;
        ACTION Report: reported := n; END_ACTION
    END_PROGRAM

    FUNCTION Sum : INT
        Sum := Cell.i;
    END_FUNCTION";

#[test]
fn a_program_is_called_and_read_by_its_name() {
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, CELL);
        for scan in 1..=2 {
            rig.scan().expect("no fault");
            // Twice in each scan, and never by itself.
            let n = 2 * scan;
            assert_eq!(rig.int("Cell.n"), n, "{dialect}");
            assert_eq!(["MAIN.seen", "MAIN.kept", "Cell.reported"].map(|path| rig.int(path)), [30 + n, n, n]);
            assert_eq!(rig.int("MAIN.Total"), 30 + n + 3);
        }
        assert_eq!(rig.int("MAIN.own"), 3);
    }
}

#[test]
fn a_program_that_another_calls_has_no_task_of_its_own() {
    let application = application_in(Dialect::TwinCat, CELL);
    let plan = application.single_task(TimeSpan::millis::<10>());
    assert_eq!(plan.tasks[0].programs, ["MAIN"]);
}

#[test]
fn the_instance_is_the_one_of_the_configuration() {
    let text = "PROGRAM Cell VAR n : INT; END_VAR n := n + 1; END_PROGRAM
        PROGRAM MAIN VAR x : INT; END_VAR x := Cell.n; END_PROGRAM
        CONFIGURATION C RESOURCE R ON PLC TASK T (INTERVAL := T#10ms, PRIORITY := 1);
        PROGRAM Line WITH T : Cell; PROGRAM MAIN WITH T : MAIN; END_RESOURCE END_CONFIGURATION";
    let application = application_in(Dialect::TwinCat, text);
    let plan = application.configured_tasks().expect("there is a configuration");
    let mut rig = Rig::with_plan(&application, &plan);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("Line.n"), rig.int("MAIN.x")), (1, 1));
    let twice = text.replace("PROGRAM Line WITH T : Cell;", "PROGRAM L1 WITH T : Cell; PROGRAM L2 WITH T : Cell;");
    insta::assert_snapshot!(findings_in(Dialect::TwinCat, &twice));
}

#[test]
fn what_is_wrong_with_a_program_as_an_instance_is_reported() {
    let wrong = "PROGRAM MAIN VAR x : INT; END_VAR Cell(k := 1); Cell.n := 2; Cell.o := 3; x := Cell.m; Cell.i := 4; END_PROGRAM
        PROGRAM Cell VAR_INPUT i : INT; END_VAR VAR_OUTPUT o : INT; END_VAR VAR n : INT; END_VAR o := n + i; MAIN(); END_PROGRAM";
    insta::assert_snapshot!(findings_in(Dialect::Codesys, wrong));
    let standard = "PROGRAM Q VAR_INPUT i : INT; END_VAR i := i; END_PROGRAM PROGRAM P Q(i := 1); END_PROGRAM";
    insta::assert_snapshot!(findings_in(Dialect::Iec3, standard));
}

#[test]
fn an_address_of_a_program_is_known_before_it_is_placed() {
    let text = "VAR_GLOBAL where_ : POINTER TO INT := ADR(Cell.n); END_VAR
        PROGRAM MAIN where_^ := 7; Cell(); END_PROGRAM
        PROGRAM Cell VAR n : INT; END_VAR n := n + 1; END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("Cell.n"), 8);
}

#[test]
fn programs_in_several_files_see_one_another() {
    let file = |name: &str, text: &str| Input::from_text(name, SourceKind::Text, text).in_dialect(Dialect::TwinCat);
    let application = Application::from_inputs([
        file("main.st", "PROGRAM MAIN Cell.Start(); END_PROGRAM"),
        file("cell.st", "PROGRAM Cell VAR on : BOOL; END_VAR ACTION Start: on := TRUE; END_ACTION END_PROGRAM"),
    ]);
    let application = application.expect("it checks");
    assert!(application.warnings().iter().all(|found| found.severity != Severity::Error));
}
