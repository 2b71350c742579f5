//! Statement and branch coverage.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan, VirtualTime};
use onescan_iec_run::{Application, Coverage, SoftPlc};

const PROGRAM: &str = "FUNCTION_BLOCK Unused
VAR x : INT; END_VAR
  x := 1;
END_FUNCTION_BLOCK
FUNCTION Half : INT
VAR_INPUT x : INT; END_VAR
  IF x < 0 THEN
    Half := 0;
    RETURN;
  END_IF;
  Half := x / 2;
END_FUNCTION
PROGRAM P
VAR n, i, sum : INT; t : TON; never : Unused; END_VAR
  n := n + 1;
  IF n > 1 THEN
    sum := Half(n);
  ELSIF n > 100 THEN
    sum := 0;
  ELSE sum := 1; END_IF;
  CASE n OF
    1: sum := 5;
    2, 3: sum := 6;
    4: never();
  END_CASE;
  FOR i := 0 TO 3 DO
    IF i = n THEN EXIT; END_IF;
  END_FOR;
  WHILE i > 100 DO
    i := i - 1;
  END_WHILE;
  REPEAT i := i + 1; UNTIL i > 2 END_REPEAT;
  t(IN := TRUE, PT := T#1s);
END_PROGRAM
";

fn input(name: &str) -> Input {
    Input::from_text(name, SourceKind::Text, PROGRAM)
}

/// After so many scans; and the PLC's memory.
fn run(application: &Application, scans: u64) -> (Option<Coverage>, Vec<u8>) {
    let mut plc = SoftPlc::new(application, &application.single_task(TimeSpan::millis::<1>())).expect("it can run");
    for scan in 1..=scans {
        plc.scan(VirtualTime::from_nanos(scan * 1_000_000)).expect("no fault");
    }
    (plc.coverage(), plc.memory().to_vec())
}

fn covered(scans: u64) -> (Coverage, Vec<u8>) {
    let application = Application::from_inputs_with_coverage([input("plc.st")]).expect("a sound program");
    let (coverage, memory) = run(&application, scans);
    (coverage.expect("it was asked for"), memory)
}

#[test]
fn lcov_reports_units_lines_and_outcomes() {
    insta::assert_snapshot!(covered(2).0.to_lcov());
}

#[test]
fn cobertura_reports_the_same() {
    let (coverage, _) = covered(2);
    insta::assert_snapshot!(coverage.to_cobertura().expect("memory takes it"));
}

#[test]
fn the_program_computes_the_same() {
    let plain = Application::from_inputs([input("plc.st")]).expect("a sound program");
    for scans in [1, 2, 50] {
        let (nothing, memory) = run(&plain, scans);
        assert_eq!(nothing, None);
        assert_eq!(covered(scans).1, memory);
    }
}

#[test]
fn runs_are_merged_by_counting() {
    let (mut coverage, _) = covered(1);
    let (lines, first) = coverage.lines();
    coverage.merge(&covered(2).0);
    let (all, both) = coverage.lines();
    assert_eq!(all, lines);
    assert!(first < both && both < all);
    let text = coverage.to_lcov();
    assert!(text.contains("\nDA:15,2\n"), "executed in both runs: {text}");
    assert!(text.contains("\nDA:17,1\n"), "executed in the second: {text}");
    assert!(text.contains("\nDA:3,0\n"), "executed in none: {text}");
}

/// A place in a file that holds program text among other things is one of that file.
#[test]
fn lines_are_those_of_the_file() {
    let xml = "<?xml version=\"1.0\"?>
<TcPlcObject>
  <POU Name=\"P\">
    <Declaration><![CDATA[PROGRAM P
VAR n : INT; END_VAR]]></Declaration>
    <Implementation>
      <ST><![CDATA[n := n + 1;
IF n > 1 THEN
  n := 0;
END_IF;]]></ST>
    </Implementation>
  </POU>
</TcPlcObject>";
    let input = Input::from_text("P.TcPOU", SourceKind::TwinCat, xml);
    let application = Application::from_inputs_with_coverage([input]).unwrap_or_else(|found| panic!("{found}"));
    let (coverage, _) = run(&application, 1);
    let text = coverage.expect("it was asked for").to_lcov();
    for line in ["SF:P.TcPOU", "FN:4,P", "DA:7,1", "DA:8,1", "DA:9,0", "BRDA:8,0,0,0", "BRDA:8,0,1,1"] {
        assert!(text.lines().any(|found| found == line), "{line} in {text}");
    }
}

#[test]
fn a_resumed_run_is_counted_from_there_on() {
    let application = Application::from_inputs_with_coverage([input("plc.st")]).expect("a sound program");
    let new = || SoftPlc::new(&application, &application.single_task(TimeSpan::millis::<1>())).expect("it can run");
    let scan =
        |plc: &mut SoftPlc, number: u64| plc.scan(VirtualTime::from_nanos(number * 1_000_000)).expect("no fault");
    let mut first = new();
    (1..=4).for_each(|number| scan(&mut first, number));
    let state = first.save();
    let mut second = new();
    second.restore(&state).expect("the same program");
    (5..=9).for_each(|number| scan(&mut second, number));
    let resumed = second.coverage().expect("it was asked for");
    assert_eq!(resumed.counted_from().map(VirtualTime::as_nanos), Some(4_000_000));
    let text = resumed.to_lcov();
    assert!(text.starts_with("TN:counted_from_4000000_ns\n"), "{text}");
    assert!(text.contains("\nDA:24,0\n"), "executed before: {text}");
    // Whoever has scanned all that came before has not missed anything.
    first.restore(&state).expect("its own state");
    scan(&mut first, 5);
    let whole = first.coverage().expect("it was asked for");
    assert_eq!(whole.counted_from(), None);
    assert!(whole.to_lcov().starts_with("TN:\nSF:"));
    let mut both = whole.clone();
    both.merge(&resumed);
    assert_eq!(both.counted_from().map(VirtualTime::as_nanos), Some(4_000_000));
}
