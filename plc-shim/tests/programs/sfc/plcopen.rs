//! Charts of PLCopen XML (TC6 2.01).

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan, inspect};
use onescan_iec_run::Application;

use super::drawn::{Step, Transition, chart, condition};
use crate::plcopen::{block, coil, contact, input, pou, project, rail};
use crate::rig::Rig;

const MIXER: &str = include_str!("../../inputs/mixer.xml");

fn mixer(text: &str) -> Input {
    Input::from_text("mixer.xml", SourceKind::PlcOpen, text)
}

#[test]
fn elements_become_steps_and_transitions() {
    insta::assert_snapshot!(mixer(MIXER).file().text());
}

#[test]
fn a_chart_of_xml_runs() {
    let application = Application::from_inputs([mixer(MIXER)]).unwrap_or_else(|found| panic!("{found}"));
    let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
    let steps = ["Idle", "Fill", "Stir", "Heat", "Soak", "Done"];
    let mut seen = Vec::new();
    for scan in 1..=12 {
        rig.set("Mixer.start", i64::from((2..=9).contains(&scan)));
        rig.set("Mixer.level", if scan >= 5 { 90 } else { 0 });
        rig.scan().expect("no fault");
        let active = steps.iter().filter(|step| rig.bool(&format!("Mixer.{step}.X")));
        let on = ["valve", "motor", "heater"].iter().filter(|name| rig.bool(&format!("Mixer.{name}")));
        let list = |names: Vec<&&str>| names.into_iter().copied().collect::<Vec<_>>().join("+");
        seen.push(format!(
            "{:2} {:12} {:14} {}",
            scan,
            list(active.collect()),
            list(on.collect()),
            rig.int("Mixer.batches")
        ));
    }
    insta::assert_snapshot!(seen.join("\n"));
}

/// 2nd ed. Table 42, feature 4: both charts use the transition `ready` of the unit, and the inner one has statements in
/// a step.
pub(crate) fn chart_in_an_action() -> String {
    let text = |text: &str| format!("<ST><p xmlns=\"http://www.w3.org/1999/xhtml\">{text}</p></ST>");
    let go = |from: usize, to: usize, name: &str| Transition {
        from: vec![from],
        to: vec![to],
        priority: None,
        condition: condition(&format!("<reference name=\"{name}\"/>")),
        elements: String::new(),
    };
    let action = |qualifier, does: &str| (qualifier, String::new(), does.to_owned());
    let count = format!("<inline>{}</inline>", text("n := n + 1;"));
    let inner = chart(
        &[Step { name: "Soak", actions: vec![] }, Step { name: "Spin", actions: vec![action("N", &count)] }],
        &[go(0, 1, "ready"), go(1, 0, "ready")],
    );
    let outer = chart(
        &[Step { name: "Idle", actions: vec![] }, Step { name: "Wash", actions: vec![action("N", "Turn")] }],
        &[go(0, 1, "ready"), go(1, 0, "stop")],
    );
    let parts = format!(
        "</interface><actions><action name=\"Turn\"><body><SFC>{inner}</SFC></body></action></actions>\
         <transitions><transition name=\"ready\"><body>{}</body></transition></transitions>",
        text("i")
    );
    project(
        &pou("program", "P", "in i : BOOL, stop : BOOL; out n : INT", "SFC", &outer).replace("</interface>", &parts),
    )
}

#[test]
fn a_chart_of_xml_is_the_body_of_an_action() {
    let mut rig = crate::plcopen::rig(&chart_in_an_action());
    let mut seen = Vec::new();
    for (i, stop) in [(1, 0), (1, 0), (1, 0), (0, 0), (1, 1), (0, 0), (1, 0)] {
        rig.set("P.i", i);
        rig.set("P.stop", stop);
        rig.scan().expect("no fault");
        let steps = ["Idle", "Wash", "Soak", "Spin"].into_iter().filter(|step| rig.bool(&format!("P.{step}.X")));
        seen.push(format!("{}{}", steps.collect::<Vec<_>>().join("+"), rig.int("P.n")));
    }
    let expected = "Idle+Soak0 Wash+Soak0 Wash+Spin1 Wash+Spin2 Idle+Soak3 Idle+Soak3 Wash+Spin4";
    assert_eq!(seen.join(" "), expected);
}

#[test]
fn what_is_wrong_with_a_chart_of_xml_is_reported_in_its_place() {
    let changes = [
        ("an unknown step", "targetName=\"Idle\"", "targetName=\"Idel\""),
        ("an unknown action", "name=\"heater\"/></action>", "name=\"heatr\"/></action>"),
        ("a wrong condition", "NOT start", "NOT level"),
        ("no condition", "<condition><reference name=\"start\"/></condition>", ""),
        ("a lost connection", "<connection refLocalId=\"13\"/>", "<connection refLocalId=\"99\"/>"),
        ("two transitions in a row", "<connection refLocalId=\"14\"/>", "<connection refLocalId=\"2\"/>"),
        ("an unsafe chart", "<connectionPointIn><connection refLocalId=\"12\"/></connectionPointIn>", ""),
        ("a missing time", "duration=\"T#20ms\"", ""),
    ];
    let report = changes.iter().map(|(what, from, to)| {
        assert!(MIXER.contains(from), "{what}");
        let found = inspect([mixer(&MIXER.replacen(from, to, 1))], None);
        format!("{what}\n{found}")
    });
    insta::assert_snapshot!(report.collect::<Vec<_>>().join("\n\n"));
}

/// Contacts and blocks in the chart itself that lead to a transition.
#[test]
fn conditions_are_wired_to_elements_of_the_chart() {
    let start = "<condition><reference name=\"start\"/></condition>";
    let wired = |id: u32, pin: &str| {
        format!("<condition><connectionPointIn><connection refLocalId=\"{id}\"{pin}/></connectionPointIn></condition>")
    };
    let with = |condition: &str, elements: &str| {
        MIXER
            .replace(start, condition)
            .replace("<transition localId=\"2\">", &format!("{elements}<transition localId=\"2\">"))
    };
    let rung = rail(40) + &contact(41, (0, 0), "40", "start", "edge=\"rising\"");
    let compare =
        input(42, (0, 0), "level") + &input(43, (0, 20), "50") + &block(44, (40, 0), "GE", "IN1=42 IN2=43", "OUT", "");
    let begins_at = |text: &str| {
        let application = Application::from_inputs([mixer(text)]).unwrap_or_else(|found| panic!("{found}"));
        let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
        (1..=8).find(|scan| {
            // The edge is seen in scan 4 only, the level from scan 6.
            rig.set("Mixer.start", i64::from(*scan == 4));
            rig.set("Mixer.level", if *scan >= 6 { 60 } else { 0 });
            rig.scan().expect("no fault");
            rig.bool("Mixer.Fill.X")
        })
    };
    assert_eq!(begins_at(&with(&wired(41, ""), &rung)), Some(4));
    assert_eq!(begins_at(&with(&wired(44, " formalParameter=\"OUT\""), &compare)), Some(6));
    assert_eq!(
        begins_at(&with(&wired(44, "").replace("<condition>", "<condition negated=\"true\">"), &compare)),
        Some(2)
    );
    let wrong = [
        ("nothing leads there", with("<condition><connectionPointIn/></condition>", "")),
        ("it leads to nothing", with(&wired(99, ""), "")),
        ("a contact without its left", with(&wired(41, ""), &contact(41, (0, 0), "", "start", ""))),
        ("no BOOL", with(&wired(42, ""), &input(42, (0, 0), "level"))),
        ("an element of its own", with(start, &(rail(40) + &coil(41, (0, 0), "40", "valve", "")))),
    ];
    let report = wrong.iter().map(|(what, text)| format!("{what}\n{}", inspect([mixer(text)], None)));
    insta::assert_snapshot!(report.collect::<Vec<_>>().join("\n\n"));
}

/// Conditions in other languages: a network assigns to the transition's name, instructions leave their result.
#[test]
fn conditions_of_xml_are_networks_too() {
    let st = "<ST><xhtml:p>level &gt;= 80</xhtml:p></ST>";
    let fbd = "<FBD><inVariable localId=\"1\"><connectionPointOut/><expression>level</expression></inVariable>
        <inVariable localId=\"2\"><connectionPointOut/><expression>80</expression></inVariable>
        <block localId=\"3\" typeName=\"GE\"><inputVariables>
        <variable formalParameter=\"IN1\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn></variable>
        <variable formalParameter=\"IN2\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn></variable>
        </inputVariables><inOutVariables/><outputVariables><variable formalParameter=\"OUT\"><connectionPointOut/></variable>
        </outputVariables></block>
        <outVariable localId=\"4\"><connectionPointIn><connection refLocalId=\"3\" formalParameter=\"OUT\"/>
        </connectionPointIn><expression>full</expression></outVariable></FBD>";
    let il = "<IL><xhtml:p>LD level</xhtml:p><xhtml:p>GE 80</xhtml:p></IL>";
    let steps_after = |body: &str| {
        let input = mixer(&MIXER.replace(st, body));
        let application = Application::from_inputs([input]).unwrap_or_else(|found| panic!("{found}"));
        let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
        let mut seen = Vec::new();
        for scan in 1..=5 {
            rig.set("Mixer.start", 1);
            rig.set("Mixer.level", if scan >= 4 { 90 } else { 0 });
            rig.scan().expect("no fault");
            seen.push((rig.bool("Mixer.Fill.X"), rig.bool("Mixer.Stir.X")));
        }
        seen
    };
    let wanted = [(false, false), (true, false), (true, false), (false, true), (false, true)];
    for body in [st, fbd, il] {
        assert_eq!(steps_after(body), wanted, "{body}");
    }
}
