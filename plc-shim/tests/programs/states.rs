use onescan_plc_shim::{RestoreError, SoftPlc, TaskPlan, TimeSpan, VirtualTime};

use crate::rig::{MS, Rig, application};

const TEXT: &str = "
PROGRAM P
VAR t : TON; p : TP; c : CTU; x : LREAL := 0.3; i : DINT; log : ARRAY [0..9] OF LREAL; END_VAR
    t(IN := NOT t.Q, PT := T#30ms); p(IN := t.Q, PT := T#15ms); c(CU := p.Q, PV := 3);
    x := SIN(x * 3.7) + 1.1; i := i + 1; log[i MOD 10] := x;
END_PROGRAM";

#[test]
fn a_restored_plc_goes_on_to_the_last_bit_from_every_scan() {
    let application = application(TEXT);
    let plan = TaskPlan::single(&application, TimeSpan::millis::<10>());
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
    for bytes in [&long[..], &state[..state.len() - 1], &state[..20], &state[..30]] {
        assert_eq!(rig.plc.restore(bytes), Err(RestoreError::Damaged));
    }
    let other = application("PROGRAM P VAR x : INT; END_VAR x := 1; END_PROGRAM");
    let mut other = SoftPlc::new(&other, &TaskPlan::single(&other, TimeSpan::millis::<10>())).expect("a plan");
    assert_eq!(other.restore(&state), Err(RestoreError::OtherApplication));
    assert_eq!(rig.plc.save(), state);
}
