//! What comes over sockets.

use std::path::Path;

use bytes::BytesMut;
use onescan_links::gateway::Exchange;
use onescan_links::gateway::ads::frame::{Bytes, Frame as AdsFrame};
use onescan_links::gateway::ads::symbol::Symbol;
use onescan_links::gateway::exchange::{Direction, Feed, Words};
use onescan_links::gateway::s7::{iso, pdu};
use onescan_links::gateway::tcp::{BlockCodec, Declaration, Layouts};
use onescan_plant::scanner::protocol::{ACK, command};
use onescan_plant::scanner::{Answer, Device};
use onescan_server::signal::{Port, SignalName, SignalType};
use onescan_server::wire::frame::to_json;
use onescan_server::wire::{ClientMessage, Endpoint, Frame, FrameCodec, HANDSHAKE_FRAME_BYTES_MAX, ServerMessage};
use tokio_util::codec::Decoder;

use super::Prepared;

fn framed(json: &str) -> Vec<u8> {
    let mut frame = (json.len() as u32 + 1).to_le_bytes().to_vec();
    frame.push(b'J');
    frame.extend_from_slice(json.as_bytes());
    frame
}

/// Bytes of a session: what clients say, and what a server says to a client.
pub(super) fn session(_: &Path) -> Prepared {
    let client = [
        r#"{"hello":{"protocol":{"min":1,"max":1},"role":"client","agent":"fuzz","token":"abc"}}"#,
        r#"{"join":{"name":"plc","period_ns":10000000,"reads":[{"name":"A","type":"BOOL"}],"writes":[{"name":"B","type":"STRING[20]"}]}}"#,
        r#"{"done":{"outputs":"00"}}"#,
        r#"{"fault":{"message":"no"}}"#,
        r#"{"operate":{"write":{"signal":"A","value":"01"}}}"#,
        r#"{"control":"pause"}"#,
    ];
    let server = [
        r#"{"setup":{"operations":[]}}"#,
        r#"{"operate":{"fail":{"component":"a","mode":"b"}}}"#,
        r#"{"save":{}}"#,
        r#"{"end":"completed"}"#,
        r#"{"restore":{"t_v":10000000,"steps":1}}"#,
    ];
    let turn = |kind: u8, words: &[u64]| {
        let mut frame = (8 * words.len() as u32 + 3).to_le_bytes().to_vec();
        frame.push(kind);
        for word in words {
            frame.extend_from_slice(&word.to_le_bytes());
        }
        frame.extend_from_slice(&[1, 0]);
        frame
    };
    let grant = [framed(server[0]), turn(b'G', &[1, 10_000_000]), turn(b'T', &[1, 10_000_000, 0])].concat();
    let restored = [framed(server[4]), b"\x03\0\0\0S12".to_vec(), framed(server[2])].concat();
    let mut seeds: Vec<Vec<u8>> = client.iter().chain(&server).map(|json| framed(json)).collect();
    seeds.extend([seeds[..4].concat(), grant, restored]);
    let mut prepared = Prepared::new(seeds, |input| {
        let (mut source, mut codec) = (BytesMut::from(input), FrameCodec::new(HANDSHAKE_FRAME_BYTES_MAX));
        let mut endpoint = Endpoint::new(2);
        let mut understood = 0;
        while let Ok(Some(frame)) = codec.decode_eof(&mut source) {
            if let Frame::Json(text) = &frame {
                let client: Option<ClientMessage> = serde_json::from_slice(text).ok();
                let server: Option<ServerMessage> = serde_json::from_slice(text).ok();
                // What was understood is said in one way, and understood so again.
                if let Some(message) = client {
                    let said = to_json(&message).expect("a message");
                    let again: ClientMessage = serde_json::from_slice(&said).expect("what we say ourselves");
                    assert_eq!(to_json(&again).expect("a message"), said);
                    understood += 1;
                }
                if let Some(message) = server {
                    let said = to_json(&message).expect("a message");
                    assert!(serde_json::from_slice::<ServerMessage>(&said).is_ok(), "what we say ourselves");
                    understood += 1;
                }
            }
            if endpoint.receive(frame).is_ok() {
                endpoint.answered();
                understood += 1;
            }
        }
        understood > 0
    });
    prepared.mend = whole_frames;
    prepared
}

/// A length that says more than there is says what there is.
#[expect(clippy::ptr_arg, reason = "other formats mend by growing")]
fn whole_frames(input: &mut Vec<u8>) {
    let mut at = 0;
    while let Some(head) = input.get(at..at + 4) {
        let length = u32::from_le_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let left = input.len() - at - 4;
        if length > left {
            input[at..at + 4].copy_from_slice(&(left as u32).to_le_bytes());
            return;
        }
        at += 4 + length;
    }
}

/// Data blocks of three axes with the words in the reserve: the first byte says how TCP cuts the stream. Each block is
/// reported to be wrong, or taken without leaving out a bit of it.
pub(super) fn blocks(_: &Path) -> Prepared {
    let port = |name: String, ty| Feed::whole(&Port { name: SignalName::new(name).expect("a name"), ty }, None);
    let bits = ["Execute", "Tracking", "TorqueControl", "SpeedControl", "Enable"];
    let reals = ["TargetPosition", "TargetSpeed", "TargetAcceleration", "TargetDeceleration", "TargetTorque"];
    let axis = |axis: usize| {
        let named = |field: &&str| format!("A{axis}.{field}");
        let (bits, reals) = (bits.iter().map(named), reals.iter().map(named));
        let all: Vec<Feed> = bits.map(|name| port(name, SignalType::BOOL)).collect();
        all.into_iter().chain(reals.map(|name| port(name, SignalType::REAL)).collect::<Vec<_>>())
    };
    let words =
        [("SDSP_Joined", "1+31+61+22"), ("SDSP_Done", "23+24+25+0.5-7+30.5-7+60.5-6"), ("SDSP_Answer", "52+53")];
    let own =
        [("SDSP_Session", "0"), ("SDSP_Limit", "4"), ("SDSP_TV", "8"), ("SDSP_Grant", "16"), ("SDSP_Layout", "54")];
    let addresses = words.iter().chain(&own).map(|(word, place)| ((*word).to_owned(), (*place).to_owned())).collect();
    let outputs: Vec<Feed> = (0..3).flat_map(axis).collect();
    let exchange = Exchange::new(&[], &outputs, Words::Handshake, &addresses);
    let declaration: Declaration = toml::from_str(BLOCKS).expect("a layout");
    let layout = Layouts::new(&declaration, &exchange).expect("it fits").from_plc;
    let mut good = vec![0; layout.size()];
    let packed: Vec<u8> = (0..exchange.size(Direction::FromPlc)).map(|at| u8::from(at % 3 == 0)).collect();
    layout.encode(&packed, &mut good);
    let seeds = vec![[&[7], &good[..]].concat(), [&[90], &good.repeat(3)[..]].concat(), [&[255], &good[..40]].concat()];
    Prepared::new(seeds, move |input| {
        let Some((cut, stream)) = input.split_first() else { return false };
        let (mut codec, mut taken) = (BlockCodec::new(&layout), 0_usize);
        for segment in stream.chunks(usize::from(*cut).max(1)) {
            codec.take(segment);
            loop {
                match codec.next_block() {
                    Ok(Some(block)) => {
                        let (mut values, mut again) = (packed.clone(), vec![0; layout.size()]);
                        layout.decode(&block, &mut values);
                        layout.encode(&values, &mut again);
                        assert_eq!(&again[..], &block[..], "a bit of a block was left out");
                        taken += 1;
                    }
                    Ok(None) => break,
                    Err(fault) => assert!(!fault.to_string().is_empty()),
                }
            }
        }
        assert_eq!(codec.end().is_ok(), stream.len().is_multiple_of(layout.size()));
        taken > 0
    })
}

/// Commands of three axes, without a byte for the words.
const BLOCKS: &str = r#"
reserve_zero = true
from_plc = ["A0: Command", "A1: Command", "A2: Command"]
to_plc = ["_: LINT", "_: LINT", "_: DINT"]

[structures]
Command = ["Execute: BOOL", "Tracking: BOOL", "TorqueControl: BOOL", "SpeedControl: BOOL", "Enable: BOOL",
    "_: BOOL", "_: BOOL", "_: BOOL", "_: BYTE", "TargetPosition: REAL", "TargetSpeed: REAL",
    "TargetAcceleration: REAL", "TargetDeceleration: REAL", "TargetTorque: REAL", "_: REAL", "_: REAL"]
"#;

/// Telegrams of PLCs, as a stream: the first byte says of which protocol.
pub(super) fn telegrams(_: &Path) -> Prepared {
    let item = |words: &[u8]| [b"s".to_vec(), iso::data(words)].concat();
    let mut ads = b"a".to_vec();
    ads.extend_from_slice(&[0, 0, 48, 0, 0, 0]);
    ads.extend_from_slice(&[
        127, 0, 0, 1, 1, 1, 0x53, 3, 127, 0, 0, 1, 1, 2, 0x20, 3, 2, 0, 5, 0, 16, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0,
    ]);
    ads.extend_from_slice(&[0, 0, 0, 0, 8, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8]);
    let mut symbol = b"t".to_vec();
    symbol.extend_from_slice(&[
        49, 0, 0, 0, 0x20, 0x40, 0, 0, 8, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 6, 0, 4, 0, 3, 0,
    ]);
    symbol.extend_from_slice(b"MAIN.a\0REAL\0pos\0");
    let seeds = vec![
        item(&pdu::setup(1, 480)),
        item(&pdu::set_up(1, 480)),
        item(&pdu::values(2, &[Ok(vec![1, 2, 3, 4]), Err(5)])),
        item(&pdu::written(3, &[0xff, 5])),
        item(&pdu::refused(4, 0x8104)),
        [b"s".to_vec(), iso::connect_request([3, 1]), iso::connect_confirm(2)].concat(),
        ads,
        symbol,
    ];
    Prepared::new(seeds, |input| {
        let Some((kind, bytes)) = input.split_first() else { return false };
        match kind {
            b's' => s7(bytes),
            b'a' => {
                let mut stream = bytes;
                let mut understood = false;
                while let Ok(Some(frame)) = AdsFrame::read(&mut stream) {
                    understood |= !frame.encoded().is_empty();
                }
                understood
            }
            b't' => {
                let mut table = Bytes(bytes);
                let mut understood = false;
                while let Some(symbol) = Symbol::take(&mut table) {
                    onescan_links::gateway::ads::symbol::elementary(&symbol);
                    understood = true;
                }
                understood
            }
            _ => false,
        }
    })
}

fn s7(bytes: &[u8]) -> bool {
    let mut telegrams = iso::Incoming::default();
    telegrams.take(bytes);
    let mut understood = false;
    while let Ok(Some(message)) = telegrams.next_message() {
        understood = true;
        if let iso::Message::Data(data) = message {
            understood |= pdu::answer(&data).is_some() | pdu::asked(&data).is_some();
        }
    }
    understood
}

/// What a host says to an infrared scanner: whatever it is, the scanner answers or waits, and hears the next command.
pub(super) fn scanner(_: &Path) -> Prepared {
    let texts =
        ["AR", "RMH", "RMB", "PM5", "DMB", "SB0100", "ST0500", "ES095", "LM3", "LC001", "ZM00", "PS", "GST", "GPM"];
    let mut seeds: Vec<Vec<u8>> = texts.iter().map(|text| command(text.as_bytes())).collect();
    seeds.push(vec![0x02, 0x1b]);
    seeds.push(seeds.concat());
    Prepared::new(seeds, |input| {
        let mut device = Device::default();
        let good =
            input.iter().filter(|byte| matches!(device.hear(**byte), Some(Answer::Bytes(bytes)) if bytes[0] == ACK));
        let good = good.count() > 0;
        // whatever came before: an EOT, and the byte behind it, end it
        for byte in [0x04, 0x00] {
            device.hear(byte);
        }
        let heard = command(b"AR").into_iter().filter_map(|byte| device.hear(byte)).last();
        assert_eq!(heard, Some(Answer::Bytes(vec![ACK])), "a command is heard after anything");
        assert!((66..=1033).contains(&device.settings().line_bytes()));
        good
    })
}
