//! Continuous Function Charts of TwinCAT whose user did not order them: the flow of the data does, then the position.

use crate::drawings::{findings, rig};

const PIN: &str = "<v n=\"Negated\">false</v><v n=\"SetReset\" t=\"SetReset\">None</v><v n=\"SetResetRef\" t=\"SetResetRef\">None</v>";

/// An element with its text, and pins `id` and `id + 1`, at a place from the left and from the top.
fn element(kind: &str, text: &str, id: u32, (left, top): (i32, i32)) -> String {
    let pin = |id: u32| format!("{PIN}<v n=\"Id\">{id}L</v>");
    let texts = |texts: &[&str]| -> String {
        texts.iter().map(|text| format!("<o><v n=\"Text\">\"{text}\"</v></o>")).collect()
    };
    let content = match kind {
        "Box" => format!(
            "<o n=\"Inputs\" t=\"CFCItemList\"><l2 n=\"InnerList\" cet=\"CFCInputPin\"><o>{}</o></l2></o>\
             <o n=\"Outputs\" t=\"CFCItemList\"><l2 n=\"InnerList\" cet=\"CFCOutputPin\"><o>{}</o></l2></o>\
             <o n=\"Texts\" t=\"CFCItemList\"><l2 n=\"InnerList\" cet=\"CFCText\">{}</l2></o>\
             <o n=\"Parameters\" t=\"CFCItemList\"><l2 n=\"InnerList\" /></o><v n=\"EnEno\">false</v>\
             <v n=\"KindOfCall\" t=\"KindOfCall\">Operator</v>",
            pin(id),
            pin(id + 1),
            texts(&["", "", text, ""])
        ),
        "Output" => format!("<o n=\"Input\" t=\"CFCInputPinWithSetReset\">{}</o>", pin(id)),
        _ => format!("<o n=\"Output\" t=\"CFCOutputPin\">{}</o>", pin(id)),
    };
    let own = if kind == "Box" {
        String::new()
    } else {
        format!("<o n=\"Text\" t=\"CFCText\"><v n=\"Text\">\"{text}\"</v></o>")
    };
    format!(
        "<o t=\"CFC{kind}Element\">{content}{own}<v n=\"Bounds\">\"{left}, {top}, 0, 0\"</v><v n=\"Id\">{}L</v></o>",
        id + 100
    )
}

fn line(from: u32, to: u32) -> String {
    let id = 1000 + from * 50 + to;
    format!(
        "<o t=\"CFCConnection\"><v n=\"SourcePinId\">{from}L</v><v n=\"DestPinId\">{to}L</v><v n=\"Id\">{id}L</v></o>"
    )
}

fn chart(items: &[String], is_explicit: bool) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?><TcPlcObject Version=\"1.1.0.1\"><POU Name=\"P\" SpecialFunc=\"None\">\
         <Declaration><![CDATA[PROGRAM P VAR first : INT := 5; middle, last, size : INT; END_VAR]]></Declaration>\
         <Implementation><CFC><XmlArchive><Data><o xml:space=\"preserve\" t=\"CFCImplementationObject\">\
         <o n=\"Items\" t=\"CFCItemList\"><l2 n=\"InnerList\">{}</l2></o></o></Data></XmlArchive></CFC></Implementation>\
         <ObjectProperties><XmlArchive><Data><o xml:space=\"preserve\" t=\"CFCProperty\">\
         <v n=\"UseExplicitExecutionOrder\">{is_explicit}</v></o></Data></XmlArchive></ObjectProperties></POU></TcPlcObject>",
        items.concat()
    )
}

/// What hands `middle` on stands below what gives it its value, and before it in the archive.
fn two_networks() -> Vec<String> {
    vec![
        element("Input", "middle", 1, (0, 20)),
        element("Output", "last", 3, (9, 20)),
        line(1, 3),
        element("Output", "middle", 7, (20, 0)),
        element("Box", "ABS", 9, (10, 2)),
        element("Input", "first", 5, (0, 4)),
        line(10, 7),
        line(5, 9),
    ]
}

#[test]
fn networks_come_from_top_to_bottom_and_elements_behind_their_sources() {
    let mut flow = rig(&chart(&two_networks(), false));
    flow.scan().expect("no fault");
    assert_eq!((flow.int("P.middle"), flow.int("P.last")), (5, 5));
    assert!(findings(&chart(&two_networks(), true)).contains("G1104"), "in the order of the archive the box is late");
}

#[test]
fn side_by_side_the_left_one_comes_first() {
    let mut items = two_networks();
    // Now it stands at the same height, on the left.
    items[0] = element("Input", "middle", 1, (-5, 0));
    let mut left = rig(&chart(&items, false));
    left.scan().expect("no fault");
    assert_eq!((left.int("P.middle"), left.int("P.last")), (5, 0));
}

#[test]
fn a_loop_leaves_the_order_open() {
    let items = [element("Box", "ABS", 1, (0, 0)), element("Box", "ABS", 3, (9, 0)), line(2, 3), line(4, 1)];
    let reported = findings(&chart(&items, false));
    assert!(reported.contains("L0501") && reported.contains("a loop or a jump"), "{reported}");
}
