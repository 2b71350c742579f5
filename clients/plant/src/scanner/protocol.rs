//! Commands and answers, a byte at a time. Any bytes may come; none makes the device anything but answer or wait.
//!
//! | heard | answered |
//! |---|---|
//! | `SOH opcode [sector][parameter] EOT BCC` | ACK: done; NAK: not understood, or the check byte is wrong, and nothing has changed; ETB: an internal test has failed |
//! | `SOH G opcode EOT BCC` | ACK, then `SOH opcode value EOT BCC`, which is not acknowledged |
//! | STX | a line; in burst mode one after another |
//! | ESC | the end of a burst |
//!
//! A control byte within a command is the beginning of something else: what the host lost does not hold the device up.

use serde::{Deserialize, Serialize};

use super::settings::{Mode, Settings};

/// Start of a command.
pub const SOH: u8 = 0x01;
/// Asks for a line.
pub const STX: u8 = 0x02;
/// End of a command; the check byte follows.
pub const EOT: u8 = 0x04;
pub const ACK: u8 = 0x06;
/// Not understood, and nothing changed.
pub const NAK: u8 = 0x15;
/// Start of a line.
pub const SYN: u8 = 0x16;
/// An internal test has failed.
pub const ETB: u8 = 0x17;
pub const ESC: u8 = 0x1b;

/// Bytes of a command between SOH and EOT, at most; none that there is has more than eight.
const COMMAND_BYTES_MAX: usize = 32;

/// The check byte of a message: the sum of all its bytes, with the highest bit set.
pub fn check_byte(message: &[u8]) -> u8 {
    message.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte)) | 0x80
}

/// A command, or the answer to a query, as it goes over the line.
pub fn command(text: &[u8]) -> Vec<u8> {
    let mut message = Vec::with_capacity(text.len() + 3);
    message.push(SOH);
    message.extend_from_slice(text);
    message.push(EOT);
    message.push(check_byte(&message));
    message
}

/// What a device says to what it has heard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    Bytes(Vec<u8>),
    /// A line, as the settings want it.
    Line,
}

/// Where a device is in what it hears.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum Hearing {
    #[default]
    Nothing,
    /// Within a command, behind SOH.
    Command(Vec<u8>),
    Check(Vec<u8>),
}

/// A scanner's side of the protocol.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Device {
    settings: Settings,
    stored: Settings,
    hearing: Hearing,
    bursting: bool,
    /// An internal test has failed since the alarms were last reset.
    test_failed: bool,
}

impl Device {
    /// A new one, whose lines have 64·2^(d−1) points by their point mode `d`, 1 to 5.
    pub fn new(point_mode: u8) -> Self {
        let settings = Settings { point_mode: point_mode.clamp(1, 5), ..Settings::default() };
        Self { stored: settings.clone(), settings, ..Self::default() }
    }

    /// What it is set to.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// True while it sends lines of its own accord.
    pub fn is_bursting(&self) -> bool {
        self.bursting
    }

    /// An internal test fails: until `AR`, commands are answered with ETB.
    pub fn fail_test(&mut self) {
        self.test_failed = true;
    }

    /// Its supply has gone and come back: what was not stored is forgotten.
    pub fn restart(&mut self) {
        *self = Self { settings: self.stored.clone(), stored: self.stored.clone(), ..Self::default() };
    }

    /// Hears a byte.
    pub fn hear(&mut self, byte: u8) -> Option<Answer> {
        match (std::mem::take(&mut self.hearing), byte) {
            (Hearing::Check(text), check) => Some(self.obey(&text, check)),
            (Hearing::Command(text), EOT) => {
                self.hearing = Hearing::Check(text);
                None
            }
            (Hearing::Command(mut text), b' '..=b'~') => {
                // beyond the longest command it is none, and stays none
                if text.len() <= COMMAND_BYTES_MAX {
                    text.push(byte);
                }
                self.hearing = Hearing::Command(text);
                None
            }
            (Hearing::Nothing | Hearing::Command(_), byte) => self.begin(byte),
        }
    }

    fn begin(&mut self, byte: u8) -> Option<Answer> {
        match byte {
            SOH => {
                self.hearing = Hearing::Command(Vec::new());
                None
            }
            STX => {
                self.bursting = self.settings.mode == Mode::Burst;
                Some(Answer::Line)
            }
            ESC => {
                self.bursting = false;
                None
            }
            // noise between messages
            _ => None,
        }
    }

    fn obey(&mut self, text: &[u8], check: u8) -> Answer {
        let message = command(text);
        let whole = text.len() <= COMMAND_BYTES_MAX && message.last() == Some(&check);
        let answer = match text {
            _ if !whole => None,
            b"AR" => {
                self.test_failed = false;
                Some(vec![ACK])
            }
            _ if self.test_failed => Some(vec![ETB]),
            b"PS" => {
                self.stored = self.settings.clone();
                Some(vec![ACK])
            }
            [b'G', first, second] => self.answer_query([*first, *second]),
            [first, second, parameter @ ..] => self.settings.with([*first, *second], parameter).map(|new| {
                self.bursting &= new.mode == Mode::Burst;
                self.settings = new;
                vec![ACK]
            }),
            _ => None,
        };
        Answer::Bytes(answer.unwrap_or_else(|| vec![NAK]))
    }

    fn answer_query(&self, opcode: [u8; 2]) -> Option<Vec<u8>> {
        let value = self.settings.value_of(opcode)?;
        let text: Vec<u8> = opcode.into_iter().chain(value.into_bytes()).collect();
        Some([vec![ACK], command(&text)].concat())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// All that a device says to these bytes; a line is an L.
    fn said(device: &mut Device, bytes: &[u8]) -> Vec<u8> {
        let answers = bytes.iter().filter_map(|byte| device.hear(*byte));
        let bytes = answers.flat_map(|answer| match answer {
            Answer::Bytes(bytes) => bytes,
            Answer::Line => vec![b'L'],
        });
        bytes.collect()
    }

    /// A command with the check byte of the thesis: the plain sum.
    fn by_the_thesis(text: &[u8]) -> Vec<u8> {
        let mut message = command(text);
        let rest = &message[..message.len() - 1];
        let sum = rest.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        message.pop();
        message.push(sum);
        message
    }

    #[test]
    fn the_example_of_the_thesis_hides_that_its_rule_is_another() {
        assert_eq!(command(b"AR"), [0x01, 0x41, 0x52, 0x04, 0x98]);
        assert_eq!(by_the_thesis(b"AR"), command(b"AR"));
        for (text, sum, check) in [("SB0100", 0x5b, 0xdb), ("ST0500", 0x71, 0xf1), ("ES095", 0x3b, 0xbb)] {
            let mut device = Device::default();
            assert_eq!(command(text.as_bytes()).last(), Some(&check), "{text}");
            assert_eq!(by_the_thesis(text.as_bytes()).last(), Some(&sum), "{text}");
            assert_eq!(said(&mut device, &by_the_thesis(text.as_bytes())), [NAK], "{text}");
            assert_eq!(device, Device::default(), "nothing has changed");
            assert_eq!(said(&mut device, &command(text.as_bytes())), [ACK], "{text}");
        }
    }

    #[test]
    fn commands_set_and_queries_tell() {
        let mut device = Device::default();
        for text in ["PM5", "SB0100", "ST0500", "ES080", "RMH", "DMB", "LM3"] {
            assert_eq!(said(&mut device, &command(text.as_bytes())), [ACK], "{text}");
        }
        let settings = device.settings();
        assert_eq!((settings.points(), settings.line_bytes()), (1024, 1033));
        assert_eq!((settings.lower_degc, settings.upper_degc, settings.emissivity_pct), (100, 500, 80));
        assert_eq!(said(&mut device, &command(b"GST")), [vec![ACK], command(b"ST00500")].concat());
        for text in ["", "A", "XX", "PM6", "PM", "SB0600", "SB1100", "ES005", "ST0", "ST012345", "LC000", "GXX", "AR1"]
        {
            let before = device.clone();
            assert_eq!(said(&mut device, &command(text.as_bytes())), [NAK], "{text}");
            assert_eq!(device, before, "{text}");
        }
    }

    #[test]
    fn a_burst_goes_from_stx_to_esc_and_needs_whole_lines() {
        let mut device = Device::default();
        assert_eq!(said(&mut device, &[STX]), b"L");
        assert!(!device.is_bursting(), "in host mode");
        assert_eq!(said(&mut device, &[command(b"LC004"), command(b"RMB")].concat()), [ACK, NAK]);
        assert_eq!(said(&mut device, &[command(b"LC001"), command(b"RMB"), vec![STX]].concat()), [ACK, ACK, b'L']);
        assert!(device.is_bursting());
        device.hear(ESC);
        assert!(!device.is_bursting());
    }

    #[test]
    fn a_failed_test_is_answered_with_etb_until_the_alarms_are_reset() {
        let mut device = Device::default();
        device.fail_test();
        assert_eq!(said(&mut device, &command(b"PM3")), [ETB]);
        assert_eq!(said(&mut device, &[command(b"AR"), command(b"PM3")].concat()), [ACK, ACK]);
    }

    #[test]
    fn what_was_stored_is_there_after_a_restart() {
        let mut device = Device::default();
        said(&mut device, &[command(b"PM5"), command(b"PS"), command(b"ES050")].concat());
        device.restart();
        assert_eq!((device.settings().points(), device.settings().emissivity_pct), (1024, 95));
    }

    #[test]
    fn a_byte_lost_holds_nothing_up() {
        let mut device = Device::default();
        let without_eot = &command(b"PM5")[..4];
        assert_eq!(said(&mut device, &[without_eot, &command(b"PM4")].concat()), [ACK], "the second one");
        assert_eq!(device.settings().points(), 512);
        assert_eq!(said(&mut device, &[&[SOH, b'P'][..], &[STX]].concat()), b"L");
    }

    proptest! {
        #[test]
        fn any_bytes_are_answered_and_commands_are_heard_after_them(bytes: Vec<u8>, long in 0..200_usize) {
            let mut device = Device::default();
            said(&mut device, &bytes);
            said(&mut device, &vec![b'x'; long]);
            // behind an EOT the next byte is a check byte, whatever it is
            said(&mut device, &[EOT, 0]);
            let lower = device.settings().lower_degc < device.settings().upper_degc;
            prop_assert!(lower && (64..=1024).contains(&device.settings().points()));
            let answered = said(&mut device, &command(b"AR"));
            prop_assert_eq!(answered, [ACK]);
        }
    }
}
