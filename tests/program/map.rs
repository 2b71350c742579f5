//! `onescan map`, and mappings that do not reach what they must: every variable of a real PLC has an address of its own.

use std::path::Path;

use crate::plc::Plc;
use crate::typed::{Said, copied_shear, digests, edit, run_shear, scenario, typed};

const LINKS: [&str; 5] = [
    "tcp://192.168.0.1:2000",
    "s7://192.168.0.1",
    "modbus://192.168.0.1",
    "ads://192.168.0.1",
    "opc.tcp://192.168.0.1:4840",
];

/// The mappings of a scenario of the project, over every link.
fn mapped(name: &str) -> String {
    let reported = LINKS.map(|url| {
        let said = typed(&scenario(name), &["map", ".", "--gateway", &format!("plc={url}")]);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{url}");
        said.out
    });
    reported.join("\n")
}

#[test]
fn the_shear_is_mapped() {
    insta::assert_snapshot!(mapped("shear"));
}

#[test]
fn the_filling_machine_is_mapped() {
    insta::assert_snapshot!(mapped("filling-machine"));
}

#[test]
fn the_gantry_robot_is_mapped() {
    insta::assert_snapshot!(mapped("gantry-robot"));
}

/// The number that `onescan map` says.
fn layout(folder: &Path, gateway: &str) -> u64 {
    let said = typed(folder, &["map", ".", "--gateway", gateway, "--format", "json"]);
    let map: serde_json::Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
    map["layout"].as_u64().expect("a number")
}

/// What is written out says the same as what is left to the link, over every link, and in the PLC's program.
#[test]
fn a_mapping_that_is_written_out_is_the_same_mapping() {
    let folder = copied_shear();
    let number = layout(folder.path(), "plc");
    let said = typed(folder.path(), &["instrument", ".", "-o", "out"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let shim = std::fs::read_to_string(folder.path().join("out/plc/sdsp.st")).unwrap();
    assert!(shim.contains(&format!("SDSP_Layout : UDINT := {number};")), "{shim}");
    for url in LINKS {
        let folder = copied_shear();
        let gateway = format!("plc={url}");
        let said = typed(folder.path(), &["map", ".", "--gateway", &gateway, "-o", "map.toml"]);
        assert_eq!(said.code, Some(0), "{said:?}");
        let fragment = std::fs::read_to_string(folder.path().join("map.toml")).unwrap();
        let link = "[clients.plc.gateway]\nurl = \"tcp://127.0.0.1:2000\"\nsystem_words = true\n";
        edit(folder.path(), "scenario.toml", link, &fragment);
        assert_eq!(layout(folder.path(), "plc"), number, "{fragment}");
        if url.starts_with("modbus") {
            insta::assert_snapshot!(fragment);
        }
    }
}

/// A shear whose mapping is this, over Modbus.
fn with_map(map: &str) -> tempfile::TempDir {
    let folder = copied_shear();
    edit(
        folder.path(),
        "scenario.toml",
        "system_words = true",
        &format!("system_words = true\n[clients.plc.gateway.map]\n{map}"),
    );
    folder
}

fn run_with(folder: &Path, gateway: &str) -> Said {
    typed(folder, &["run", ".", "--format", "json", "--until", "1s", "--gateway", gateway])
}

/// Each program has its own inputs at addresses of their own; the digest is that of one process.
#[test]
fn every_program_has_its_own_inputs() {
    let (reports, _) = run_shear(&["--until", "1s"]);
    let folder = with_map(
        "Sensor_1 = [\"hr:300\", \"hr:310.3\"]\nSensor_2 = { \"Shear.Sensor_2\" = \"coil:5\", \"Alignment.Sensor_2\" = \"coil:9\" }\n",
    );
    let plc = Plc::start(folder.path(), &["--modbus", "127.0.0.1:0"]);
    let said = run_with(folder.path(), &plc.gateway("modbus://"));
    let report = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
    assert_eq!(digests(&[report]), digests(&reports));
}

/// Before anything has begun: the signal, the variable, the line of the mapping, and what mends it.
#[test]
fn a_variable_that_is_left_out_is_reported_at_its_line() {
    let wrong = [
        "Sensor_1 = \"hr:300\"",
        "Strokes = \"hr:1200\"\nSensor_1 = [\"hr:300\"]",
        "Sensor_1 = { \"Shear.Sensor_1\" = \"hr:300\" }",
        "Sensor_1 = [\"hr:300\", \"hr:300\"]",
        "Sensor_1 = { \"Shear.Sensor_1\" = \"hr:300\", \"Alignment.Sensro_1\" = \"hr:301\" }",
        "Sensor_1 = [\"hr:300\", \"hr:10\"]",
        "Sensor_1 = 300",
        "Strokes = \"4x100\"",
    ];
    let reported = wrong.map(|map| {
        // Nothing listens there: the mapping is looked at first.
        let said = run_with(with_map(map).path(), "plc=modbus://127.0.0.1:1");
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{map}: {said:?}");
        said.err
    });
    insta::assert_snapshot!(reported.join("----\n"));
}

/// Two signals of one type that have changed places would run to the end, with another digest.
#[test]
fn a_program_that_was_made_for_another_mapping_is_refused() {
    let there = with_map("Aligned = \"hr:1200\"\nActuator_1_Up = \"hr:1201\"\n");
    let here = with_map("Aligned = \"hr:1201\"\nActuator_1_Up = \"hr:1200\"\n");
    let plc = Plc::start(there.path(), &["--modbus", "127.0.0.1:0"]);
    let gateway = plc.gateway("modbus://");
    let said = run_with(here.path(), &gateway);
    assert_eq!(said.code, Some(3), "{said:?}");
    let [found, expected] = [&there, &here].map(|folder| layout(folder.path(), &gateway));
    assert!(said.out.contains(&format!("SDSP_Layout is {found}, that of this scenario is {expected}")), "{said:?}");
    assert_eq!(run_with(there.path(), &gateway).code, Some(0));
}

#[test]
fn what_cannot_be_mapped_is_reported() {
    let gantry = typed(&scenario("gantry-robot"), &["map", "."]);
    let unknown = typed(&scenario("shear"), &["map", ".", "--client", "plx"]);
    let all = [gantry, unknown];
    assert!(all.iter().all(|said| said.code == Some(2) && said.out.is_empty()), "{all:?}");
    insta::assert_snapshot!(all.map(|said| said.err).join("----\n"));
}
