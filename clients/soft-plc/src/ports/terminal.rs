//! A serial terminal with a process image of 22 bytes each way, and its handshake.
//!
//! Both images are a word and 22 bytes. The low byte of the control word has the bits TR, RA and IR, that of the status word
//! TA, RR, IA and `BUF_F`; the high byte is a count of bytes. A change of TR says that bytes are to be sent, and TA follows
//! when they are taken. A change of RR says that bytes have arrived, and RA follows when the program has read them. While IR
//! is on the terminal forgets everything and IA is on.
//!
//! The image is exchanged in each turn of the PLC, before its scan. So one call of `SerialLineControl` moves 22 bytes at
//! most each way, and bytes that arrive while the receive buffer is full are lost.
//!
//! # Source
//! Beckhoff: EL6001, EL6021 and KL6031, KL6041, "Control and status word", "Technical data", "Data transfer".

use std::ops::Range;

use serde::{Deserialize, Serialize};

use onescan_stream::Port;

/// Bytes of either image with its word.
pub(super) const IMAGE_BYTES: usize = 24;

/// Bytes of an image without its word.
const DATA_BYTES: usize = 22;

const TRANSMIT: u8 = 1;
const RECEIVE: u8 = 1 << 1;
const INITIALISE: u8 = 1 << 2;
const BUFFER_FULL: u8 = 1 << 3;

/// A terminal, by its buffers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TerminalKind {
    /// EL6001, EL6021: 864 bytes received, 128 to send.
    #[default]
    El60,
    /// KL6001, KL6011, KL6021: 128 bytes received, 16 to send.
    Kl60,
    /// KL6031, KL6041: 1024 bytes received, 128 to send.
    Kl6031,
}

impl TerminalKind {
    /// The terminal of this name, in capitals.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "EL6001" | "EL6021" => Self::El60,
            "KL6001" | "KL6011" | "KL6021" => Self::Kl60,
            "KL6031" | "KL6041" => Self::Kl6031,
            _ => return None,
        })
    }

    /// The names of all terminals.
    pub const NAMES: [&str; 7] = ["EL6001", "EL6021", "KL6001", "KL6011", "KL6021", "KL6031", "KL6041"];

    /// Bytes that it keeps until the program takes them.
    #[must_use]
    pub const fn receive_buffer(self) -> usize {
        match self {
            Self::El60 => 864,
            Self::Kl60 => 128,
            Self::Kl6031 => 1024,
        }
    }

    /// Bytes that it keeps until they are sent.
    #[must_use]
    pub const fn send_buffer(self) -> usize {
        match self {
            Self::El60 | Self::Kl6031 => 128,
            // one image at a time, where the buffer is smaller than that
            Self::Kl60 => DATA_BYTES,
        }
    }
}

/// A terminal with the places of its images in the PLC's memory.
pub(super) struct Terminal {
    kind: TerminalKind,
    input: Range<usize>,
    output: Range<usize>,
    state: TerminalState,
}

/// What a terminal remembers beside its buffers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct TerminalState {
    /// The low byte of the status word.
    status: u8,
    /// Bytes in the input image, and how many of them count.
    data: [u8; DATA_BYTES],
    length: u8,
    /// The buffer was full, and bytes were lost.
    lost: u64,
}

impl Terminal {
    pub(super) fn new(kind: TerminalKind, input: Range<usize>, output: Range<usize>) -> Self {
        Self { kind, input, output, state: TerminalState::default() }
    }

    pub(super) fn begin(&mut self) {
        self.state = TerminalState::default();
    }

    pub(super) fn state(&self) -> TerminalState {
        self.state.clone()
    }

    pub(super) fn restore(&mut self, state: TerminalState) {
        self.state = state;
    }

    /// Takes the output image as the last scan left it and gives the input image for the next one.
    pub(super) fn exchange(&mut self, port: &mut Port, memory: &mut [u8]) {
        let Some([control, count, data @ ..]) = memory.get(self.output.clone()) else { return };
        let state = &mut self.state;
        if control & INITIALISE != 0 {
            port.purge();
            *state = TerminalState { status: INITIALISE, lost: port.losses().buffer, ..TerminalState::default() };
        } else {
            state.status &= !INITIALISE;
            let count = usize::from(*count).min(DATA_BYTES);
            let has_room = port.pending() + count <= self.kind.send_buffer();
            if (control ^ state.status) & TRANSMIT != 0 && has_room {
                // a serial line takes whatever is sent
                port.send(data.get(..count).unwrap_or_default());
                state.status ^= TRANSMIT;
            }
            if (control ^ state.status) & RECEIVE == 0 && port.available() > 0 {
                let arrived = port.take(DATA_BYTES);
                state.data[..arrived.len()].copy_from_slice(&arrived);
                state.length = arrived.len() as u8;
                state.status ^= RECEIVE;
            }
            let lost = port.losses().buffer;
            state.status &= !BUFFER_FULL;
            state.status |= BUFFER_FULL * u8::from(lost > state.lost);
            state.lost = lost;
        }
        if let Some([status, length, data @ ..]) = memory.get_mut(self.input.clone()) {
            (*status, *length) = (self.state.status, self.state.length);
            data.copy_from_slice(&self.state.data);
        }
    }
}
