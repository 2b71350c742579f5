use onescan_server::signal::{Port, SignalName};
use proptest::prelude::*;

use super::*;
use crate::gateway::exchange::{Feed, Words};

fn declaration(text: &str) -> Declaration {
    toml::from_str(text).unwrap()
}

/// `[Nyyssönen]` Fig. 18 (commands) and ch. 3.1.3 (feedback).
const AXIS: &str = r#"
to_plc = ["Sync: ToPlc", "Step_Feeder: AxisFeedback", "Linear_Loader: AxisFeedback"]
from_plc = ["Step_Feeder: AxisCommand", "Linear_Loader: AxisCommand", "Sync: FromPlc"]

[structures]
AxisCommand = ["Execute: BOOL", "Tracking: BOOL", "TorqueControl: BOOL", "SpeedControl: BOOL", "Enable: BOOL",
    "_: BOOL", "_: BOOL", "_: BOOL", "_: BYTE",
    "TargetPosition: REAL", "TargetSpeed: REAL", "TargetAcceleration: REAL", "TargetDeceleration: REAL",
    "TargetTorque: REAL", "_: REAL", "_: REAL"]
AxisFeedback = ["Enabled: BOOL", "InPosition: BOOL", "ActualPosition: REAL", "ActualSpeed: REAL"]
ToPlc = ["Session: UDINT", "Limit: UDINT", "TV: LINT", "Grant: UDINT"]
FromPlc = ["Joined: UDINT", "Done: UDINT", "Answer: INT", "Layout: UDINT"]
"#;

fn axis_exchange() -> Exchange {
    let port = |name: &str, ty| Feed::whole(&Port { name: SignalName::new(name).unwrap(), ty }, None);
    let inputs =
        [port("Step_Feeder.InPosition", SignalType::BOOL), port("Linear_Loader.ActualPosition", SignalType::REAL)];
    let outputs = [
        port("Step_Feeder.Enable", SignalType::BOOL),
        port("Step_Feeder.TargetPosition", SignalType::REAL),
        port("Linear_Loader.Execute", SignalType::BOOL),
    ];
    let words = ["Session", "Limit", "TV", "Grant", "Joined", "Done", "Answer", "Layout"];
    let addresses = words.iter().map(|word| (format!("SDSP_{word}"), format!("Sync.{word}"))).collect();
    Exchange::new(&inputs, &outputs, Words::Handshake, &addresses)
}

#[test]
fn an_axis_is_thirty_bytes_and_its_feedback_ten() {
    let layouts = Layouts::new(&declaration(AXIS), &axis_exchange()).unwrap();
    assert_eq!(layouts.from_plc.size(), 30 + 30 + 14);
    assert_eq!(layouts.to_plc.size(), 20 + 10 + 10);
    let exchange = axis_exchange();
    let mut packed = vec![0; exchange.size(crate::gateway::Direction::FromPlc)];
    let outputs = exchange.outputs();
    packed[outputs.start] = 1;
    packed[outputs.start + 1..outputs.start + 5].copy_from_slice(&1.5_f32.to_le_bytes());
    packed[outputs.start + 5] = 1;
    let mut block = vec![0; 74];
    layouts.from_plc.encode(&packed, &mut block);
    // Fig. 18: Enable is bit 0.4, TargetPosition lies at 2.0, big-endian.
    assert_eq!(block[..6], [0b1_0000, 0, 0x3f, 0xc0, 0, 0]);
    assert_eq!(block[30], 1);
    let mut back = vec![0; packed.len()];
    layouts.from_plc.decode(&block, &mut back);
    assert_eq!(back, packed);
}

#[test]
fn what_is_wrong_with_a_layout_is_reported() {
    let reported = |from: &str, to: &str| {
        let text = AXIS.replacen(from, to, 1);
        let fault = Layouts::new(&declaration(&text), &axis_exchange()).unwrap_err();
        format!("{fault} {}", fault.help.as_deref().unwrap_or_default())
    };
    let all = [
        reported("InPosition: BOOL", "InPositoin: BOOL"),
        reported("InPosition: BOOL", "InPosition: INT"),
        reported("Sync: ToPlc", "Sync: ToPcl"),
        reported("Sync: ToPlc", "Sync"),
        reported("Sync: ToPlc", "Sync: ToPlc\", \"Sync: ToPlc"),
        reported("ToPlc = [", "ToPlc = [\"Again: ToPlc\", "),
        reported("InPosition: BOOL", "InPosition: STRING[8]"),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn points_may_lie_at_offsets() {
    let port = Port { name: SignalName::new("Valve").unwrap(), ty: SignalType::BOOL };
    let at = |address: &str| {
        let feed = Feed::whole(&port, Some(address.to_owned()));
        let exchange = Exchange::new(&[feed], &[], Words::Handshake, &BTreeMap::new());
        Layouts::new(&Declaration::default(), &exchange).map(|layouts| layouts.to_plc.moves[0].place.clone())
    };
    assert_eq!(at("0.3").unwrap(), Place::bit(0, 3));
    assert!(at("900.0").is_err() && at("4").is_err());
}

#[test]
fn two_points_share_no_place() {
    let feed = |name: &str, address: &str| {
        let port = Port { name: SignalName::new(name).unwrap(), ty: SignalType::BOOL };
        Feed::whole(&port, Some(address.to_owned()))
    };
    let reported = |a: &str, b: &str| {
        let exchange = Exchange::new(&[feed("a", a), feed("b", b)], &[], Words::Handshake, &BTreeMap::new());
        Layouts::new(&Declaration::default(), &exchange).map_or_else(|fault| fault.to_string(), |_| "fine".to_owned())
    };
    assert_eq!(reported("0.1", "0.0"), "fine");
    assert_eq!(reported("0.1", "0.1"), "`a` and `b` are both mapped to 0.1 of `to_plc`");
    assert_eq!(reported("0.1", "2.0"), "`b` and `SDSP_Session` are both mapped to 2 of `to_plc`");
}

#[test]
fn a_variable_is_the_field_of_its_path() {
    let target = |path: &str| crate::gateway::exchange::Target { variable: Some(path.to_owned()), address: None };
    let port = Port { name: SignalName::new("go").unwrap(), ty: SignalType::BOOL };
    let feed = Feed { port, targets: vec![target("P.go"), target("Q.go")] };
    let exchange = Exchange::new(&[feed], &[], Words::Handshake, &BTreeMap::new());
    let words = "\"SDSP_Session: UDINT\", \"SDSP_Limit: UDINT\", \"SDSP_TV: LINT\", \"SDSP_Grant: UDINT\"";
    let places = |fields: &str| {
        let text = format!("to_plc = [{fields}, {words}]\n[structures]\nIn = [\"go: BOOL\"]\n");
        Layouts::new(&declaration(&text), &exchange).map(|layouts| layouts.places()[0][..2].to_vec())
    };
    assert_eq!(places("\"Q: In\", \"P: In\"").unwrap(), ["2.0", "0.0"]);
    assert_eq!(
        places("\"go: BOOL\"").unwrap_err().to_string(),
        "`go` at `P.go` is mapped to `P.go`, which is not a field of `to_plc`"
    );
}

proptest! {
    /// Whatever types lie beside each other: no two share a bit, and values come back as they were.
    #[test]
    fn values_come_back(types in prop::collection::vec(0..6_usize, 0..40), seed in any::<u64>()) {
        const TYPES: [SignalType; 6] = [SignalType::BOOL, SignalType::BYTE, SignalType::INT,
            SignalType::REAL, SignalType::LREAL, SignalType::BOOL];
        let port = |(i, ty): (usize, &usize)| {
            Feed::whole(&Port { name: SignalName::new(format!("s{i}")).unwrap(), ty: TYPES[*ty] }, None)
        };
        let ports: Vec<Feed> = types.iter().enumerate().map(port).collect();
        let exchange = Exchange::new(&ports, &[], Words::WithSystem, &BTreeMap::new());
        let layouts = Layouts::new(&Declaration::default(), &exchange).unwrap();
        let mut state = seed;
        let mut packed = Vec::new();
        for point in exchange.to_plc() {
            for _ in 0..point.ty.size() {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                packed.push(if point.ty == SignalType::BOOL { (state >> 60) as u8 & 1 } else { (state >> 33) as u8 });
            }
        }
        let mut block = vec![0; layouts.to_plc.size()];
        layouts.to_plc.encode(&packed, &mut block);
        let mut back = vec![0; packed.len()];
        layouts.to_plc.decode(&block, &mut back);
        prop_assert_eq!(back, packed);
    }
}
