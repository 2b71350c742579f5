//! How much memory the variables of a PLC may take.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, MemoryLimit, TimeSpan, inspect, inspect_within};
use onescan_iec_run::Application;

use crate::rig::Rig;

const TEXT: &str = "TYPE Buffer : STRUCT bytes : ARRAY[1..30000000] OF USINT; used : DINT; END_STRUCT END_TYPE
VAR_GLOBAL log : Buffer; END_VAR
FUNCTION_BLOCK Store VAR list : Buffer; END_VAR
VAR_INPUT value : USINT; END_VAR VAR_OUTPUT last : USINT; END_VAR
  list.bytes[30000000] := value; last := list.bytes[30000000];
END_FUNCTION_BLOCK
PROGRAM Main
VAR_EXTERNAL log : Buffer; END_VAR
VAR first, second : Store; x : USINT; END_VAR
  first(value := 1); second(value := 2); log.bytes[1] := 3;
  x := first.last + second.last + log.bytes[1];
END_PROGRAM";

fn input() -> Input {
    Input::from_text("big.st", SourceKind::Text, TEXT)
}

#[test]
fn what_does_not_fit_is_one_finding_that_names_the_greatest() {
    insta::assert_snapshot!(inspect([input()], None));
}

#[test]
fn a_higher_limit_gives_room() {
    let limit = MemoryLimit::of_mib(100).expect("a limit");
    assert_eq!(inspect_within(limit, [input()], None).to_string(), "");
    let application = Application::builder().input(input()).memory_limit(limit).build();
    let application = application.unwrap_or_else(|error| panic!("{error}"));
    let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
    rig.scan().expect("a scan");
    assert_eq!(rig.int("Main.x"), 6);
}

#[test]
fn a_lower_limit_is_kept_to() {
    let text = "PROGRAM P VAR a : ARRAY[1..2000000] OF BYTE; END_VAR a[1] := 1; END_PROGRAM";
    let found = |mib| {
        let input = Input::from_text("small.st", SourceKind::Text, text);
        inspect_within(MemoryLimit::of_mib(mib).expect("a limit"), [input], None).to_string()
    };
    assert_eq!(found(2), "");
    insta::assert_snapshot!(found(1));
}
