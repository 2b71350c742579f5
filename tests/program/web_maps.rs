//! Maps on the page: the tables that a run writes at its end are those that its last viewer was shown, and leave no trace.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tungstenite::Message;

use crate::typed::{scenario, typed, utf8};
use crate::web::{Served, ask, received};

const UNTIL: &str = "70s";

/// The values of a map as `run --maps` writes it.
fn written(folder: &Path, name: &str) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(folder.join(format!("{name}.csv"))).expect("a map");
    let number = |cell: &str| cell.parse().expect("a number");
    text.lines().skip(1).map(|row| row.split(',').skip(1).map(number).collect()).collect()
}

/// The number, columns, rows and values of a message that is a map.
fn map_of(bytes: &[u8]) -> Option<(usize, usize, usize, Vec<f32>)> {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
    let values = || bytes[16..].as_chunks().0.iter().map(|value| f32::from_le_bytes(*value)).collect();
    (bytes[0] == 2).then(|| (word(4), word(8), word(12), values()))
}

#[test]
fn the_last_map_on_the_page_is_that_of_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = ["run", "serial.toml", "--format", "json", "--until", UNTIL, "--maps", utf8(folder.path())];
    let plain = typed(&scenario("rotary-kiln"), &words);
    let plain: Value = serde_json::from_str(&plain.out).expect("a report");

    let served = Served::begin("rotary-kiln/serial.toml", &["--until", UNTIL, "--pace", "100", "--await-viewer"]);
    let session: Value = serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON");
    assert_eq!((&session["maps"][0]["name"], &session["maps"][1]["unit"]), (&json!("plc"), &json!("°C")));
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "maps", "maps": [2]}));
    assert_eq!(received(&mut viewer, "error")["message"], "there is no map 2");
    ask(&mut viewer, &json!({"type": "maps", "maps": [0, 1]}));
    let (mut cells, mut shown) = ([Value::Null, Value::Null], [None, None]);
    while let Ok(message) = viewer.read() {
        match message {
            Message::Text(text) => {
                let received: Value = serde_json::from_str(&text).expect("JSON");
                if received["type"] == "map" {
                    let map = usize::try_from(received["map"].as_u64().expect("a number")).expect("a map");
                    cells[map] = received;
                }
            }
            Message::Binary(bytes) => {
                if let Some((map, columns, rows, values)) = map_of(&bytes) {
                    assert!(
                        cells[map]["across"]["edges"].is_array(),
                        "where cells lie is reported before their values"
                    );
                    shown[map] = Some((columns, rows, values));
                }
            }
            _ => {}
        }
    }
    assert_eq!(served.report()["digest"], plain["digest"], "who looks at maps leaves no trace");
    for (name, shown, cells) in [("plc", &shown[0], &cells[0]), ("machine", &shown[1], &cells[1])] {
        let (columns, rows, values) = shown.as_ref().expect("the map was shown");
        let file = written(folder.path(), name);
        assert_eq!((*rows, *columns), (file.len(), file[0].len()), "{name}");
        assert_eq!(cells["across"]["edges"].as_array().map(Vec::len), Some(columns + 1), "{name}");
        assert_eq!(cells["down"]["edges"].as_array().map(Vec::len), Some(rows + 1), "{name}");
        let is_same = |(shown, file): (&f32, &f64)| (f64::from(*shown) - file).abs() < 1e-4;
        assert!(values.iter().zip(file.iter().flatten()).all(is_same), "{name}");
    }
}
