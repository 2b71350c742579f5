use std::collections::BTreeMap;

use onescan_server::signal::{Port, SignalName, SignalType};
use proptest::prelude::*;

use super::*;
use crate::gateway::Exchange;
use crate::gateway::exchange::{Direction, Feed, Words};
use crate::gateway::tcp::Layouts;

/// The frames of `[Nyyssönen]` Figs. 13, 17 and 18.
const STRUCTURES: &str = r#"
reserve_zero = true
to_plc = ["Axis: AxisFeedback"]
from_plc = ["Axis: AxisCommand"]

[structures]
AxisCommand = ["Execute: BOOL", "Tracking: BOOL", "TorqueControl: BOOL", "SpeedControl: BOOL", "Enable: BOOL",
    "_: BOOL", "_: BOOL", "_: BOOL", "_: BYTE",
    "TargetPosition: REAL", "TargetSpeed: REAL", "TargetAcceleration: REAL", "TargetDeceleration: REAL",
    "TargetTorque: REAL", "_: REAL", "_: REAL"]
AxisFeedback = ["Enabled: BOOL", "InPosition: BOOL", "ActualPosition: REAL", "ActualSpeed: REAL"]
"#;

const COMMAND: [(&str, SignalType); 10] = [
    ("Execute", SignalType::BOOL),
    ("Tracking", SignalType::BOOL),
    ("TorqueControl", SignalType::BOOL),
    ("SpeedControl", SignalType::BOOL),
    ("Enable", SignalType::BOOL),
    ("TargetPosition", SignalType::REAL),
    ("TargetSpeed", SignalType::REAL),
    ("TargetAcceleration", SignalType::REAL),
    ("TargetDeceleration", SignalType::REAL),
    ("TargetTorque", SignalType::REAL),
];
const FEEDBACK: [(&str, SignalType); 4] = [
    ("Enabled", SignalType::BOOL),
    ("InPosition", SignalType::BOOL),
    ("ActualPosition", SignalType::REAL),
    ("ActualSpeed", SignalType::REAL),
];

/// The blocks of so many axes, all of whose fields are points.
fn axes(count: usize) -> (Layouts, Exchange) {
    let name = |axis: usize| if count == 1 { "Axis".to_owned() } else { format!("Axis_{axis}") };
    let feeds = |fields: &[(&str, SignalType)]| -> Vec<Feed> {
        let of = |axis| {
            fields.iter().map(move |(field, ty)| {
                let name = SignalName::new(format!("{}.{field}", name(axis))).unwrap();
                Feed::whole(&Port { name, ty: *ty }, None)
            })
        };
        (0..count).flat_map(of).collect()
    };
    let exchange = Exchange::new(&feeds(&FEEDBACK), &feeds(&COMMAND), Words::Absent, &BTreeMap::new());
    let mut declaration: crate::gateway::tcp::Declaration = toml::from_str(STRUCTURES).unwrap();
    declaration.to_plc = (0..count).map(|axis| format!("{}: AxisFeedback", name(axis))).collect();
    declaration.from_plc = (0..count).map(|axis| format!("{}: AxisCommand", name(axis))).collect();
    (Layouts::new(&declaration, &exchange).unwrap(), exchange)
}

fn bytes(hex: &str) -> Vec<u8> {
    let digits: Vec<char> = hex.chars().filter(|digit| !digit.is_whitespace()).collect();
    digits.chunks(2).map(|pair| u8::from_str_radix(&pair.iter().collect::<String>(), 16).unwrap()).collect()
}

/// Packed values: bits, then REALs.
fn packed(bits: &[bool], reals: &[f32]) -> Vec<u8> {
    let bits = bits.iter().map(|bit| u8::from(*bit));
    bits.chain(reals.iter().flat_map(|real| real.to_le_bytes())).collect()
}

/// `[Nyyssönen]` Fig. 22, worked out by hand.
#[test]
fn the_worked_frames_come_out_byte_by_byte() {
    let (layouts, _) = axes(1);
    let rest = "00000000 00000000 00000000 00000000";
    let commands = [
        (
            "1100 45c4e000 45fa0000 466a6000 466a6000 00000000 00000000 00000000".to_owned(),
            packed(&[true, false, false, false, true], &[6300.0, 8000.0, 15_000.0, 15_000.0, 0.0]),
        ),
        (
            format!("1400 {rest} 42c80000 00000000 00000000"),
            packed(&[false, false, true, false, true], &[0.0, 0.0, 0.0, 0.0, 100.0]),
        ),
        (
            format!("1200 {rest} 42c80000 00000000 00000000"),
            packed(&[false, true, false, false, true], &[0.0, 0.0, 0.0, 0.0, 100.0]),
        ),
    ];
    for (frame, values) in commands {
        there_and_back(&layouts.from_plc, &bytes(&frame), &values);
    }
    let feedback = packed(&[true, true], &[6300.0, 0.0]);
    there_and_back(&layouts.to_plc, &bytes("0300 45c4e000 00000000"), &feedback);
}

fn there_and_back(layout: &Layout, frame: &[u8], values: &[u8]) {
    let mut block = vec![0; layout.size()];
    layout.encode(values, &mut block);
    assert_eq!(block, frame);
    let mut back = vec![0xff; values.len()];
    layout.decode(frame, &mut back);
    assert_eq!(back, values);
}

/// `[Nyyssönen]` ch. 4.1: 12 axes of the charger and 13 of the lathe.
#[test]
fn frames_are_as_long_as_the_thesis_has_them() {
    let sizes = |count| {
        let (Layouts { to_plc, from_plc }, _) = axes(count);
        (from_plc.size(), to_plc.size())
    };
    assert_eq!((sizes(12), sizes(13)), ((360, 120), (390, 130)));
}

#[test]
fn blocks_come_one_by_one_or_the_newest() {
    let layout = axes(1).0.to_plc;
    let frame = |position: f32| {
        let mut block = vec![0; 10];
        layout.encode(&packed(&[true, false], &[position, 0.0]), &mut block);
        block
    };
    let mut codec = BlockCodec::new(&layout);
    codec.take(&frame(1.0)[..7]);
    assert_eq!(codec.newest(), Ok(None));
    assert_eq!(codec.partial(), Some(Partial { got: 7, whole: 10 }));
    codec.take(&[&frame(1.0)[7..], &frame(2.0), &frame(3.0), &frame(4.0)[..4]].concat());
    assert_eq!(codec.next_block().unwrap().as_deref(), Some(&frame(1.0)[..]));
    assert_eq!(codec.newest().unwrap().as_deref(), Some(&frame(3.0)[..]));
    assert_eq!(codec.next_block(), Ok(None));
    assert_eq!(
        codec.end().unwrap_err().to_string(),
        "closed after 4 of the 10 bytes of a block: is the layout the same on both sides?"
    );
    codec.clear();
    assert_eq!((codec.end(), codec.partial()), (Ok(()), None));
}

#[test]
fn what_is_set_in_the_reserve_is_reported() {
    let mut codec = BlockCodec::new(&axes(1).0.from_plc);
    let good = bytes("1100 45c4e000 45fa0000 466a6000 466a6000 00000000 00000000 00000000");
    codec.take(&good);
    assert!(codec.next_block().unwrap().is_some());
    let mut wrong = good;
    (wrong[1], wrong[29]) = (0x81, 0x10);
    codec.take(&wrong);
    assert_eq!(
        codec.next_block().unwrap_err().to_string(),
        "3 bits are set in the reserve, the first in byte 1, of block 2: the stream is cut in the wrong place, or the \
         layouts differ"
    );
}

/// Some axes under way: every REAL is a number of the machine.
fn commands() -> impl Strategy<Value = Vec<u8>> {
    let real = || prop_oneof![Just(0.0_f32), 0.1_f32..65_000.0];
    let axis = (any::<[bool; 4]>(), real(), [0.1_f32..9000.0, 0.1..20_000.0, 0.1..20_000.0], 0.1_f32..100.0);
    prop::collection::vec(axis, 12).prop_map(|axes| {
        let values = axes.into_iter().flat_map(|([execute, tracking, torque, speed], position, motion, force)| {
            let reals = [&[position][..], &motion, &[force]].concat();
            packed(&[execute, tracking, torque, speed, true], &reals)
        });
        values.collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// However TCP cuts a stream, its blocks are the same.
    #[test]
    fn segments_do_not_matter(
        values in prop::collection::vec(commands(), 1..5), cuts in prop::collection::vec(1..500_usize, 1..20)
    ) {
        let layout = axes(12).0.from_plc;
        let mut stream = Vec::new();
        for packed in &values {
            let mut block = vec![0; 360];
            layout.encode(packed, &mut block);
            stream.extend(block);
        }
        let mut codec = BlockCodec::new(&layout);
        let (mut at, mut back, mut cuts) = (0, Vec::new(), cuts.iter().cycle());
        while at < stream.len() {
            let end = (at + cuts.next().unwrap()).min(stream.len());
            codec.take(&stream[at..end]);
            at = end;
            while let Some(block) = codec.next_block().unwrap() {
                let mut packed = vec![0; values[0].len()];
                layout.decode(&block, &mut packed);
                back.push(packed);
            }
        }
        prop_assert_eq!(back, values);
        prop_assert_eq!(codec.end(), Ok(()));
    }

    /// A stream from which bytes are missing is detected by the third block after them, wherever it is cut: a speed
    /// that is not 0 comes to lie where the layout has nothing.
    #[test]
    fn a_stream_that_is_cut_wrongly_is_reported(values in commands(), missing in 1..360_usize) {
        let layout = axes(12).0.from_plc;
        let mut block = vec![0; 360];
        layout.encode(&values, &mut block);
        let mut codec = BlockCodec::new(&layout);
        codec.take(&block[missing..]);
        codec.take(&block.repeat(2));
        let reported = (0..2).find_map(|_| codec.next_block().err());
        // By whole axes it is cut between two of them: what is wrong is which axis, and bits cannot show that.
        prop_assert_eq!(reported.is_some(), missing % 30 != 0, "{} bytes are missing", missing);
    }

    /// Whatever comes: it is reported, or it is taken and not a bit of it is left out.
    #[test]
    fn a_frame_is_taken_whole_or_reported(
        values in commands(), changes in prop::collection::vec((0..360_usize, any::<u8>()), 0..4)
    ) {
        let (layouts, exchange) = axes(12);
        let mut block = vec![0; 360];
        layouts.from_plc.encode(&values, &mut block);
        for (at, byte) in changes {
            block[at] = byte;
        }
        let mut codec = BlockCodec::new(&layouts.from_plc);
        codec.take(&block);
        if let Ok(Some(taken)) = codec.next_block() {
            let mut packed = vec![0; exchange.size(Direction::FromPlc)];
            layouts.from_plc.decode(&taken, &mut packed);
            let mut again = vec![0; 360];
            layouts.from_plc.encode(&packed, &mut again);
            prop_assert_eq!(again, block);
        }
    }
}
