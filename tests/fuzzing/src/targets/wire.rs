//! What comes over sockets.

use std::path::Path;

use bytes::BytesMut;
use onescan_clients::gateway::ads::frame::{Bytes, Frame as AdsFrame};
use onescan_clients::gateway::ads::symbol::Symbol;
use onescan_clients::gateway::s7::{iso, pdu};
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
                    onescan_clients::gateway::ads::symbol::elementary(&symbol);
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
