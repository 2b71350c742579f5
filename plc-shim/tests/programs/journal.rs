//! The journal of a scan: what statements read, write and decide, in their order.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan, VirtualTime};
use onescan_iec_run::{Act, Application, SoftPlc};

const TEXT: &str = "
FUNCTION_BLOCK Step
VAR_INPUT on : BOOL; END_VAR
VAR_OUTPUT count : DINT; END_VAR
    IF NOT on THEN
        RETURN;
    END_IF;
    count := count + 1;
END_FUNCTION_BLOCK
PROGRAM P
VAR a : Step; t : TON; x : DINT; list : ARRAY [0..3] OF DINT; END_VAR
    a(on := x > 0);
    t(IN := a.count > 1, PT := T#20ms);
    x := x + 1;
    list[x MOD 4] := a.count;
END_PROGRAM";

/// A scan's acts, a line each, with paths in the place of addresses.
fn journal(plc: &SoftPlc) -> Vec<String> {
    let application = plc.application();
    let statements = application.statements();
    let ways = application.ways();
    let text = |id| statements.iter().find(|each| each.id == id).map(|each| each.text.clone()).expect("a statement");
    let path = |start: usize, end: usize| {
        let within = |each: &onescan_iec_run::Variable| {
            let at = each.offset as usize;
            at < end && start < at + each.size as usize
        };
        application.leaves().filter(within).map(|leaf| leaf.path).collect::<Vec<_>>().join(", ")
    };
    let line = |act: &Act| match act {
        Act::Unit => Some("unit".to_owned()),
        Act::Begin(id) => Some(format!("begin  {}", text(*id))),
        Act::End(id) => Some(format!("end    {}", text(*id))),
        Act::Choice(_, way) => Some(format!("choice {}", ways[way])),
        Act::Read(range) => Some(format!("read   {}", path(range.start as usize, range.end as usize))),
        Act::Wrote(wrote) => {
            let changed = wrote.changes.iter().map(|(at, bytes)| path(*at as usize, *at as usize + bytes.len()));
            let changed: Vec<String> = changed.filter(|paths| !paths.is_empty()).collect();
            let by = wrote.statement.map_or("from outside".to_owned(), text);
            (!changed.is_empty()).then(|| format!("wrote  {} by {by}", changed.join("; ")))
        }
    };
    plc.journal().iter().filter_map(line).collect()
}

#[test]
fn a_scan_is_reported_in_its_order() {
    let input = Input::from_text("test.st", SourceKind::Text, TEXT);
    let application = Application::builder().input(input).traced().build().expect("it compiles");
    let plan = application.single_task(TimeSpan::millis::<10>());
    let mut plc = SoftPlc::new(&application, &plan).expect("it runs");
    plc.watch([]);
    plc.keep_journal(true);
    let mut scans = Vec::new();
    for scan in 1..=3_u64 {
        plc.scan(VirtualTime::from_nanos(scan * 10_000_000)).expect("no fault");
        scans.push(format!("scan {scan}\n{}", journal(&plc).join("\n")));
    }
    insta::assert_snapshot!(scans.join("\n\n"));
    plc.keep_journal(false);
    plc.scan(VirtualTime::from_nanos(40_000_000)).expect("no fault");
    assert_eq!(plc.journal(), []);
}

/// What is noted changes nothing.
#[test]
fn a_journal_leaves_no_trace() {
    let state = |journal: bool| {
        let input = Input::from_text("test.st", SourceKind::Text, TEXT);
        let application = Application::builder().input(input).traced().build().expect("it compiles");
        let plan = application.single_task(TimeSpan::millis::<10>());
        let mut plc = SoftPlc::new(&application, &plan).expect("it runs");
        plc.watch([]);
        plc.keep_journal(journal);
        for scan in 1..=50_u64 {
            plc.scan(VirtualTime::from_nanos(scan * 10_000_000)).expect("no fault");
        }
        plc.save()
    };
    assert_eq!(state(true), state(false));
}
