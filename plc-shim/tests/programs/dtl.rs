//! Siemens' DTL: a structure with literals and conversions.

use onescan_iec::Dialect;

use crate::rig::{Rig, findings_in};

#[test]
fn dtl_has_parts_literals_and_conversions() {
    let text = "
FUNCTION_BLOCK \"Clock\"
VAR_INPUT moment : DTL; END_VAR
VAR_OUTPUT late : Bool; minute : USInt; END_VAR
BEGIN
	#late := #moment.HOUR >= 22;
	#minute := #moment.MINUTE;
END_FUNCTION_BLOCK
ORGANIZATION_BLOCK \"Main\"
VAR
	a : DTL := DTL#2024-05-06-07:08:09.123456789;
	b, c, e, start : DTL;
	list : Array[0..1] of DTL := [DTL#1999-12-31-23:59:59, DTL#2000-01-01-00:00:00];
	d : Date; t : Time_Of_Day; lt : LTOD; dt : LDT; same : Bool; clock : \"Clock\";
END_VAR
BEGIN
	#b := DTL#2262-04-11-23:47:16.854775807;
	#d := DTL_TO_DATE(#a); #t := DTL_TO_TOD(#a); #lt := DTL_TO_LTOD(#a); #dt := DTL_TO_LDT(#a);
	#c := LDT_TO_DTL(#dt);
	#same := DTL_TO_LDT(#c) = #dt AND LDT_TO_DTL(DTL_TO_LDT(#b)).NANOSECOND = 854775807;
	#e := #a; #e.YEAR := 2030; #e := DATE_TO_DTL(DTL_TO_DATE(#e));
	#clock(moment := DTL#2024-05-06-22:30:00);
END_ORGANIZATION_BLOCK
";
    let mut rig = Rig::in_dialect(Dialect::SiemensScl, text);
    rig.scan().expect("no fault");
    let read = |name: &str| rig.plc.read(&format!("Main.{name}")).expect("it exists");
    let parts = "(YEAR := 2024, MONTH := 5, DAY := 6, WEEKDAY := 2, HOUR := 7, MINUTE := 8, SECOND := 9, NANOSECOND := 123456789)";
    assert_eq!((read("a"), read("c")), (parts.to_owned(), parts.to_owned()));
    assert_eq!(read("d"), "D#2024-05-06");
    assert_eq!((read("t"), read("lt")), ("TOD#07:08:09.123456789".to_owned(), "LTOD#07:08:09.123456789".to_owned()));
    assert_eq!((read("dt"), read("same")), ("LDT#2024-05-06-07:08:09.123456789".to_owned(), "TRUE".to_owned()));
    assert_eq!(
        [read("b.YEAR"), read("b.WEEKDAY"), read("e.YEAR"), read("e.WEEKDAY"), read("e.HOUR")],
        ["2262", "6", "2030", "2", "0"]
    );
    assert_eq!(
        [read("start.YEAR"), read("start.WEEKDAY"), read("list[0].SECOND"), read("list[1].WEEKDAY")],
        ["1970", "5", "59", "7"]
    );
    assert_eq!((read("clock.late"), read("clock.minute")), ("TRUE".to_owned(), "30".to_owned()));
    assert_eq!(rig.variable("Main.a").size, 12);
}

#[test]
fn wrong_uses_of_dtl_are_reported() {
    let reported = |declarations: &str, statement: &str| {
        let text = format!("PROGRAM P VAR {declarations} END_VAR\n{statement}\nEND_PROGRAM");
        findings_in(Dialect::SiemensScl, &text).to_string()
    };
    let all = [
        reported("a : DTL;", "a := DTL#1969-12-31-00:00:00;"),
        reported("a : DTL;", "a := DTL#2024-02-30-00:00:00;"),
        reported("a : DTL;", "a := LDT#2024-02-03-00:00:00;"),
        reported("a : DTL; b : LDT;", "b := a;"),
        reported("a : INT := DTL#2024-02-03-00:00:00;", "a := a + 1;"),
    ];
    insta::assert_snapshot!(all.join("\n"));
}
