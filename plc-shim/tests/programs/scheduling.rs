use onescan_iec::{TaskPlan, TimeSpan, VirtualTime};
use onescan_iec_run::{RunError, SoftPlc};

use crate::rig::{MS, Rig, application, task};

const TEXT: &str = "
VAR_GLOBAL order : DINT; END_VAR
VAR_GLOBAL RETAIN kept : INT := 1; END_VAR
FUNCTION_BLOCK Hours VAR RETAIN h : INT; END_VAR VAR n : INT; END_VAR
    h := h + 1; n := n + 1;
END_FUNCTION_BLOCK
PROGRAM Slow VAR_EXTERNAL order : DINT; END_VAR order := order * 10 + 1; END_PROGRAM
PROGRAM Fast VAR_EXTERNAL order : DINT; kept : INT; END_VAR VAR n : INT; h : ARRAY [0..1] OF Hours; END_VAR
    order := order * 10 + 2; n := n + 1; kept := kept + 1; h[1]();
END_PROGRAM
PROGRAM Urgent VAR_EXTERNAL order : DINT; ONESCAN_TV : TIME; END_VAR VAR t : TIME; END_VAR
    order := order * 10 + 3; t := ONESCAN_TV;
END_PROGRAM";

#[test]
fn tasks_run_by_priority_and_see_virtual_time() {
    let application = application(TEXT);
    let plan = TaskPlan::new(vec![
        task("slow", 20, 2, &["Slow"]),
        task("fast", 10, 2, &["fast"]),
        task("urgent", 20, 1, &["Urgent"]),
    ]);
    let mut rig = Rig::with_plan(&application, &plan);
    assert_eq!(rig.plc.period(), TimeSpan::from_millis(10));
    assert_eq!(rig.plc.next_due(), Some(VirtualTime::from_nanos(10 * MS)));
    rig.scan().expect("no fault");
    assert_eq!(rig.int("order"), 2);
    rig.scan().expect("no fault");
    // At 20 ms all are due: the urgent one, then the first declared of the others.
    assert_eq!(rig.int("order"), 2312);
    assert_eq!(rig.int("Urgent.t"), 20 * MS as i64);
}

#[test]
fn a_warm_start_keeps_what_is_retained() {
    let application = application(TEXT);
    let plan = TaskPlan::new(vec![task("fast", 10, 0, &["Fast"])]);
    let mut rig = Rig::with_plan(&application, &plan);
    for _ in 0..5 {
        rig.scan().expect("no fault");
    }
    let values = |rig: &Rig| ["Fast.n", "kept", "Fast.h[1].h", "Fast.h[1].n"].map(|path| rig.int(path));
    assert_eq!(values(&rig), [5, 6, 5, 5]);
    rig.plc.warm_start();
    assert_eq!(values(&rig), [0, 6, 5, 0]);
    assert_eq!(rig.plc.next_due(), Some(VirtualTime::from_nanos(60 * MS)));
    rig.plc.cold_start();
    assert_eq!(values(&rig), [0, 1, 0, 0]);
    assert_eq!(rig.plc.next_due(), Some(VirtualTime::from_nanos(10 * MS)));
}

#[test]
fn wrong_plans_are_refused() {
    let application = application(TEXT);
    let refused = |tasks| {
        let error: RunError = SoftPlc::new(&application, &TaskPlan::new(tasks)).expect_err("wrong");
        error.to_string()
    };
    insta::assert_snapshot!(refused(vec![]), @"the plan has no tasks");
    insta::assert_snapshot!(
        refused(vec![task("a", 1, 0, &["Fsat"])]),
        @"task `a` runs program `Fsat`, which is not declared (did you mean `Fast`?)"
    );
    insta::assert_snapshot!(refused(vec![task("a", 0, 0, &[])]), @"task `a` has neither an interval nor a trigger");
    insta::assert_snapshot!(
        refused(vec![task("a", 1, 0, &[]), task("A", 1, 0, &[])]),
        @"there are two tasks `A`"
    );
    insta::assert_snapshot!(
        refused(vec![task("a", 1, 0, &["Fast"]), task("b", 1, 0, &["FAST"])]),
        @"program `FAST` runs in two tasks, `b` is the second"
    );
}
