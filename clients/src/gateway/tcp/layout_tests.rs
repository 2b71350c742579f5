use onescan_server::signal::{Port, SignalName};
use proptest::prelude::*;

use super::*;
use crate::gateway::exchange::SystemWords;

fn declaration(text: &str) -> Declaration {
    toml::from_str(text).unwrap()
}

/// Seed: Nyyssönen 2018, Fig. 18 (commands) and ch. 3.1.3 (feedback).
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
FromPlc = ["Joined: UDINT", "Done: UDINT", "Answer: INT"]
"#;

fn axis_exchange() -> Exchange {
    let port = |name: &str, ty| Port { name: SignalName::new(name).unwrap(), ty };
    let inputs =
        [port("Step_Feeder.InPosition", SignalType::BOOL), port("Linear_Loader.ActualPosition", SignalType::REAL)];
    let outputs = [
        port("Step_Feeder.Enable", SignalType::BOOL),
        port("Step_Feeder.TargetPosition", SignalType::REAL),
        port("Linear_Loader.Execute", SignalType::BOOL),
    ];
    let words = ["Session", "Limit", "TV", "Grant", "Joined", "Done", "Answer"];
    let addresses = words.iter().map(|word| (format!("SDSP_{word}"), format!("Sync.{word}"))).collect();
    Exchange::new(&inputs, &outputs, SystemWords::Absent, &addresses)
}

#[test]
fn an_axis_is_thirty_bytes_and_its_feedback_ten() {
    let layouts = Layouts::new(&declaration(AXIS), &axis_exchange()).unwrap();
    assert_eq!(layouts.from_plc.size(), 30 + 30 + 10);
    assert_eq!(layouts.to_plc.size(), 20 + 10 + 10);
    let exchange = axis_exchange();
    let mut packed = vec![0; exchange.size(crate::gateway::Direction::FromPlc)];
    let outputs = exchange.outputs();
    packed[outputs.start] = 1;
    packed[outputs.start + 1..outputs.start + 5].copy_from_slice(&1.5_f32.to_le_bytes());
    packed[outputs.start + 5] = 1;
    let mut block = vec![0; 70];
    layouts.from_plc.encode(&packed, &mut block);
    // Fig. 18: Enable is bit 0.4, TargetPosition lies at 2.0, big-endian.
    assert_eq!(block[..6], [0b1_0000, 0, 0x3f, 0xc0, 0, 0]);
    assert_eq!(block[30], 1);
    let mut back = vec![0; packed.len()];
    layouts.from_plc.decode(&block, &mut back);
    assert_eq!(back, packed);
}

#[test]
fn what_is_wrong_with_a_layout_is_told() {
    let told = |from: &str, to: &str| {
        let text = AXIS.replacen(from, to, 1);
        let fault = Layouts::new(&declaration(&text), &axis_exchange()).unwrap_err();
        format!("{fault} {}", fault.help.as_deref().unwrap_or_default())
    };
    let all = [
        told("InPosition: BOOL", "InPositoin: BOOL"),
        told("InPosition: BOOL", "InPosition: INT"),
        told("Sync: ToPlc", "Sync: ToPcl"),
        told("Sync: ToPlc", "Sync"),
        told("Sync: ToPlc", "Sync: ToPlc\", \"Sync: ToPlc"),
        told("ToPlc = [", "ToPlc = [\"Again: ToPlc\", "),
        told("InPosition: BOOL", "InPosition: STRING[8]"),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn points_may_lie_at_offsets() {
    let port = Port { name: SignalName::new("Valve").unwrap(), ty: SignalType::BOOL };
    let at = |address: &str| {
        let addresses = [("Valve".to_owned(), address.to_owned())].into();
        let exchange = Exchange::new(std::slice::from_ref(&port), &[], SystemWords::Absent, &addresses);
        Layouts::new(&Declaration::default(), &exchange).map(|layouts| layouts.to_plc.moves[0].place)
    };
    assert_eq!(at("0.3").unwrap(), Place { byte: 0, bit: 3, ty: SignalType::BOOL });
    assert!(at("900.0").is_err() && at("4").is_err());
}

proptest! {
    /// Whatever types lie beside each other: no two share a bit, and values come back as they were.
    #[test]
    fn values_come_back(types in prop::collection::vec(0..6_usize, 0..40), seed in any::<u64>()) {
        const TYPES: [SignalType; 6] = [SignalType::BOOL, SignalType::BYTE, SignalType::INT,
            SignalType::REAL, SignalType::LREAL, SignalType::BOOL];
        let port = |(i, ty): (usize, &usize)| Port { name: SignalName::new(format!("s{i}")).unwrap(), ty: TYPES[*ty] };
        let ports: Vec<Port> = types.iter().enumerate().map(port).collect();
        let exchange = Exchange::new(&ports, &[], SystemWords::Present, &BTreeMap::new());
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
