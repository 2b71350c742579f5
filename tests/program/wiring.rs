//! `onescan wiring` as it is typed.

use serde_json::Value;

use crate::typed::{copied_shear, edit, scenario, typed};

#[test]
fn every_signal_is_described_from_end_to_end() {
    let said = typed(&scenario("filling-machine"), &["wiring", "."]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    insta::assert_snapshot!("filling_machine_wired", said.out);
}

#[test]
fn the_map_is_drawn_and_written_for_machines() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wiring.svg");
    let words = ["wiring", ".", "--format", "json", "--svg", file.to_str().unwrap()];
    let said = typed(&scenario("shear"), &words);
    let map: Value = serde_json::from_str(&said.out).expect("JSON");
    let mut signals = map["signals"].as_array().expect("a list").iter();
    let position = signals.find(|signal| signal["name"] == "Position_1").expect("declared");
    assert_eq!(position["writer"]["at"][0], "actuator_1.position");
    assert_eq!(position["readers"][0]["at"][0], "Shear.Position_1");
    insta::assert_snapshot!("shear_wiring_drawn", std::fs::read_to_string(file).unwrap());
}

#[test]
fn a_port_of_a_plc_is_an_end_of_its_lines() {
    let said = typed(&scenario("rotary-kiln"), &["wiring", "thesis-serial.toml"]);
    assert!(said.code == Some(0) && !said.out.contains("unconnected"), "{said:?}");
    assert!(said.out.contains("port "), "{said:?}");
}

/// One of each: nobody writes it, two write it, its ends differ, nothing declares it.
#[test]
fn all_that_is_wrong_is_reported_at_once() {
    let shear = copied_shear();
    let file = "scenario.toml";
    edit(
        shear.path(),
        file,
        "Strokes = { type = \"DINT\"",
        "Stroke = { type = \"DINT\", writer = \"plc\" }\nStrokes = { type = \"INT\"",
    );
    edit(
        shear.path(),
        file,
        "Sensor_1 = { type = \"BOOL\", writer = \"plant\"",
        "Sensor_1 = { type = \"BOOL\", writer = \"plc\"",
    );
    edit(shear.path(), "plant.toml", "position_signal = \"Position_2\"", "position_signal = \"Positoin_2\"");
    let said = typed(shear.path(), &["wiring", "."]);
    assert_eq!((said.code, said.err.as_str()), (Some(2), ""));
    insta::assert_snapshot!("shear_wired_wrongly", said.out);
}

#[test]
fn an_external_client_is_not_known_before_it_joins() {
    let shear = copied_shear();
    edit(shear.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", "kind = \"external\"");
    let said = typed(shear.path(), &["wiring", "."]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.out.contains("plant: external, whose signals are not known before it joins"), "{}", said.out);
    assert!(said.out.contains("plc -> nobody that is known"), "{}", said.out);
}

/// What `bind` says wrongly is reported with its client.
#[test]
fn a_wrong_bind_is_reported() {
    let shear = copied_shear();
    edit(
        shear.path(),
        "scenario.toml",
        "[clients.plc]\n",
        "[clients.plc]\nbind = { \"Strokse\" = \"Shear.Strokes\" }\n",
    );
    let said = typed(shear.path(), &["wiring", "."]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("`bind` names a signal `Strokse` that is not declared"), "{said:?}");
    assert!(said.err.contains("did you mean `Strokes`?"), "{said:?}");
}
