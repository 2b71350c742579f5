//! What commands set in a scanner, and queries return.

use serde::{Deserialize, Serialize};

/// Who begins a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// The host, with each STX.
    #[default]
    Host,
    /// The scanner, line after line from STX to ESC.
    Burst,
}

/// The settings of a scanner. Those that are stored survive a restart.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    pub mode: Mode,
    /// `PMd`: points of a line are 64·2^(d−1), d from 1 to 5.
    pub point_mode: u8,
    /// `SB0t`: the temperature of a point byte of 0, °C.
    pub lower_degc: u16,
    /// `ST0t`: the temperature of a point byte of 255, °C; above the lower one.
    pub upper_degc: u16,
    /// `ESeee`: emissivity of the target, %.
    pub emissivity_pct: u8,
    /// `LMd`: what a line ends with; bit 0 the sectors' outputs, bit 1 the trigger.
    pub line_mode: u8,
    /// `LCnnn`: lines that one line sent is the mean of; a burst needs 1.
    pub line_count: u16,
    /// `ZMnn`: zoom; a burst needs 0.
    pub zoom: u8,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            mode: Mode::Host,
            point_mode: 3,
            lower_degc: 0,
            upper_degc: 500,
            emissivity_pct: 95,
            line_mode: 0,
            line_count: 1,
            zoom: 0,
        }
    }
}

impl Settings {
    /// Points of a line.
    pub fn points(&self) -> usize {
        32 << self.point_mode.clamp(1, 5)
    }

    /// Bytes of a line: SYN, the points, the internal temperature, and what the line mode adds.
    pub fn line_bytes(&self) -> usize {
        let sectors = if self.has_sectors() { 6 } else { 0 };
        self.points() + 2 + sectors + usize::from(self.has_trigger())
    }

    /// Whether a line ends with the outputs of its three sectors, two bytes each.
    pub fn has_sectors(&self) -> bool {
        self.line_mode & 1 != 0
    }

    /// Whether a line ends with a byte for the trigger.
    pub fn has_trigger(&self) -> bool {
        self.line_mode & 2 != 0
    }

    /// What a command of two letters and a parameter makes of these; nothing if it is none, or means what cannot be.
    pub(super) fn with(&self, opcode: [u8; 2], parameter: &[u8]) -> Option<Self> {
        let mut new = self.clone();
        match (&opcode, parameter) {
            (b"RM", b"H") => new.mode = Mode::Host,
            (b"RM", b"B") if self.line_count == 1 && self.zoom == 0 => new.mode = Mode::Burst,
            (b"PM", [digit @ b'1'..=b'5']) => new.point_mode = digit - b'0',
            // one byte a point is all that this scanner sends
            (b"DM", b"B") => {}
            // the sector 0 is the whole line
            (b"SB", [b'0', degrees @ ..]) => new.lower_degc = number(degrees, 4)?,
            (b"ST", [b'0', degrees @ ..]) => new.upper_degc = number(degrees, 4)?,
            (b"ES", percent) => new.emissivity_pct = u8::try_from(number(percent, 3)?).ok()?,
            (b"LM", [digit @ b'0'..=b'3']) => new.line_mode = digit - b'0',
            (b"LC", count) => new.line_count = number(count, 3)?,
            (b"ZM", zoom) => new.zoom = u8::try_from(number(zoom, 2)?).ok()?,
            _ => return None,
        }
        let in_order = new.lower_degc < new.upper_degc;
        let emits = (10..=100).contains(&new.emissivity_pct);
        (in_order && emits && new.line_count > 0).then_some(new)
    }

    /// What a query of two letters is answered with.
    pub(super) fn value_of(&self, opcode: [u8; 2]) -> Option<String> {
        Some(match &opcode {
            b"RM" => String::from(if self.mode == Mode::Host { "H" } else { "B" }),
            b"PM" => format!("{}", self.point_mode),
            b"DM" => "B".to_owned(),
            b"SB" => format!("0{:04}", self.lower_degc),
            b"ST" => format!("0{:04}", self.upper_degc),
            b"ES" => format!("{:03}", self.emissivity_pct),
            b"LM" => format!("{}", self.line_mode),
            b"LC" => format!("{:03}", self.line_count),
            b"ZM" => format!("{:02}", self.zoom),
            _ => return None,
        })
    }
}

/// A number of so many decimal digits at most, at least one.
fn number(text: &[u8], digits: usize) -> Option<u16> {
    let decimal = !text.is_empty() && text.len() <= digits && text.iter().all(u8::is_ascii_digit);
    decimal.then(|| text.iter().fold(0, |number, digit| number * 10 + u16::from(digit - b'0')))
}
