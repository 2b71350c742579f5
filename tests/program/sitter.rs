//! Somebody at a panel of a page: a script that sees what the page is shown, and writes what the panel can write.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::TcpStream;

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use crate::web::{ask, view};

/// What of a session does not change while it runs, as its page at `address` is given it.
pub(crate) fn structure(address: &str) -> Value {
    let mut stream = TcpStream::connect(address).expect("served");
    let request = format!("GET /api/session HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).expect("writable");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("an answer");
    let answer = String::from_utf8_lossy(&answer).into_owned();
    serde_json::from_str(answer.split_once("\r\n\r\n").expect("a head").1).expect("JSON")
}

/// Somebody with the seat of a panel.
pub(crate) struct Sitter {
    viewer: WebSocket<TcpStream>,
    structure: Value,
    places: BTreeMap<String, usize>,
    values: BTreeMap<usize, f64>,
    /// The time of the last picture, ns.
    pub(crate) t_ns: u64,
    /// The texts that nobody has looked at yet.
    texts: Vec<Value>,
    /// The newest status; it comes when it has changed.
    pub(crate) status: Value,
    /// The connection has ended. An attempt of a lesson may be over and the next one not have begun.
    is_over: bool,
    /// How many values were written.
    pub(crate) written: usize,
}

impl Sitter {
    /// Takes the seat of `panel`, and looks at these signals.
    pub(crate) fn at(address: &str, panel: &str, signals: &[&str]) -> Self {
        let structure = structure(address);
        let named = structure["signals"].as_array().expect("a list").iter().enumerate();
        let places = named.map(|(place, one)| (one["name"].as_str().expect("a name").to_owned(), place)).collect();
        let (viewer, values) = (view(address), BTreeMap::new());
        let mut this = Self {
            viewer,
            structure,
            places,
            values,
            t_ns: 0,
            texts: Vec::new(),
            status: Value::Null,
            written: 0,
            is_over: false,
        };
        this.ask(&json!({"type": "seat", "panel": panel, "take": true}));
        while this.received("status")["seat"][panel] != "mine" {}
        let places: Vec<usize> = signals.iter().map(|name| this.places[*name]).collect();
        this.ask(&json!({"type": "subscribe", "signals": places}));
        this.until(|this| signals.iter().all(|name| !this.value(name).is_nan()));
        this
    }

    pub(crate) fn ask(&mut self, what: &Value) {
        ask(&mut self.viewer, what);
    }

    /// Writes a signal.
    pub(crate) fn write(&mut self, name: &str, value: f64) {
        let place = self.places[name];
        self.written += 1;
        self.ask(&json!({"type": "write", "signal": place, "value": value}));
    }

    /// Puts in the fault of the switch with this label, or takes it away.
    pub(crate) fn disturb(&mut self, label: &str, active: bool) -> usize {
        let panels = self.structure["panels"].as_array().expect("panels").iter();
        let mut elements = panels.flat_map(|panel| panel["elements"].as_array().expect("elements"));
        let element = elements.find(|element| element["label"] == label).expect("a switch");
        let number = element["disturbance"].as_u64().expect("a disturbance");
        self.ask(&json!({"type": "disturb", "disturbance": number, "active": active}));
        usize::try_from(number).expect("small")
    }

    /// The value that was shown last; NaN if none was.
    pub(crate) fn value(&self, name: &str) -> f64 {
        self.values.get(&self.places[name]).copied().unwrap_or(f64::NAN)
    }

    /// Takes what comes next.
    fn hear(&mut self) {
        match self.viewer.read() {
            Ok(Message::Binary(bytes)) => self.see(&bytes),
            Ok(Message::Text(text)) => {
                let received: Value = serde_json::from_str(&text).expect("JSON");
                if received["type"] == "status" {
                    self.status.clone_from(&received);
                }
                self.texts.push(received);
            }
            Ok(_) => {}
            Err(_) => self.is_over = true,
        }
    }

    fn see(&mut self, bytes: &[u8]) {
        let word = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes"));
        self.t_ns = word(16);
        for number in 0..usize::from(u16::from_le_bytes([bytes[2], bytes[3]])) {
            let at = 24 + 16 * number;
            self.values.insert(word(at) as u32 as usize, f64::from_bits(word(at + 8)));
        }
    }

    /// Looks until something is so. Nothing may be refused on the way.
    pub(crate) fn until(&mut self, is_so: impl Fn(&Self) -> bool) {
        while !is_so(self) {
            let refused = self.texts.iter().find(|received| received["type"] == "error");
            assert!(refused.is_none(), "{refused:?}");
            assert!(!self.is_over, "the session is over at {} ns; {:?}", self.t_ns, self.texts.last());
            self.hear();
        }
    }

    /// The first text that says this and that nobody has looked at yet.
    pub(crate) fn received(&mut self, kind: &str) -> Value {
        loop {
            if let Some(place) = self.texts.iter().position(|received| received["type"] == kind) {
                return self.texts.remove(place);
            }
            assert!(!self.is_over, "nothing says `{kind}`");
            self.hear();
        }
    }
}
