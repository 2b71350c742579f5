//! A loopback plug: sends back every byte that it receives, on a serial line or a connection.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Talk, Turn};
use crate::component::declare::{Line, choice, failures, own_types, parameters, signals};
use onescan_stream::Form;
use onescan_stream::connection::{Cuts, Role};
use onescan_stream::serial::Rate;

choice! {
    /// What kind of line it is plugged into.
    Way {
        /// Bytes one behind the other.
        Serial = "serial",
        /// A connection of TCP, which it takes.
        Connection = "connection",
    }
}

parameters! {
    /// The line.
    Parameters {
        /// what the line is: "serial" or "connection"
        way: Way = Way::Serial;
        /// bits in a second, of a serial line
        baud: u32 = 9600 => 1, 10_000_000;
        /// bits of a byte with start, parity and stop bits
        bits_per_byte: u32 = 10 => 7, 14;
    }
}

signals! {
    /// The line to it.
    Inputs {
        /// what it receives
        line_in: Line,
    }
}

signals! {
    /// The line from it.
    Outputs {
        /// what it sends
        line_out: Line,
        /// bytes that it has sent back
        returned: i32,
        /// time since it received the last one; from the start, if there was none
        quiet_s: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it sends nothing back
        Silent = "silent",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    returned: u32,
    /// When the last byte came, ns.
    last_ns: u64,
    quiet_s: f64,
}

/// A plug, by its parameters.
pub(crate) struct Loopback {
    p: Parameters,
}

impl Component for Loopback {
    const NAME: &'static str = "loopback";
    const SUMMARY: &'static str = "loopback plug: sends back every byte of a line";
    const FORMULA: &'static [&'static str] = &["line_out = line_in, byte by byte, a turn later"];
    const SOURCE: &'static str = "a plug with transmit and receive joined, as for trying serial ports";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn ports(&self) -> Vec<Form> {
        // bounds keep both numbers from 0
        let serial = Rate::of(self.p.baud, self.p.bits_per_byte).map(Form::Serial);
        match self.p.way {
            Way::Serial => serial.into_iter().collect(),
            Way::Connection => vec![Form::Connection(Role::Listens, Cuts::Nowhere)],
        }
    }

    fn talk(&self, state: &mut State, _: &Inputs, turn: &Turn, talk: &mut Talk<'_>) {
        let Some(port) = talk.ports.first_mut() else { return };
        let got = port.take(usize::MAX);
        if !got.is_empty() {
            state.last_ns = talk.now_ns;
        }
        state.quiet_s = talk.now_ns.saturating_sub(state.last_ns) as f64 / 1e9;
        if !turn.failed.has(Failure::Silent) && port.send(&got) {
            state.returned = state.returned.wrapping_add(got.len() as u32);
        }
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn) -> Outputs {
        let returned = i32::try_from(state.returned).unwrap_or(i32::MAX);
        Outputs { line_out: Line, returned, quiet_s: state.quiet_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::declare::{Failed, FailureSet};
    use onescan_stream::Port;

    /// Bytes that come back of ten, sent at 9600 baud in turns of 1 ms.
    fn returned(failed: Failed) -> Vec<u8> {
        let plug = Loopback::new(Parameters::default());
        let form = plug.ports().remove(0);
        let mut ports = [Port::new(form, [64; 2], 0)];
        let (mut own, mut lines) = (Port::new(form, [64; 2], 0), [vec![0; 100], vec![0; 100]]);
        let (mut state, mut back) = (State::default(), Vec::new());
        for step in 1..=60 {
            let (now_ns, before) = (step * 1_000_000, lines.clone());
            own.arrive(now_ns, &before[1]);
            if step == 1 {
                assert!(own.send(b"loopback 1"));
            }
            back.extend(own.take(usize::MAX));
            own.depart(now_ns, &before[1], &mut lines[0]);
            ports[0].arrive(now_ns, &before[0]);
            let turn = Turn { dt_s: 0.001, failed, ..Turn::default() };
            plug.talk(&mut state, &Inputs::default(), &turn, &mut Talk { now_ns, ports: &mut ports });
            ports[0].depart(now_ns, &before[0], &mut lines[1]);
        }
        assert_eq!(plug.sense(&mut state, &Inputs::default(), &Turn::default()).returned as usize, back.len());
        back
    }

    #[test]
    fn every_byte_comes_back_unless_it_is_silent() {
        assert_eq!(returned(Failed::default()), b"loopback 1");
        assert_eq!(returned(Failed::default().with(Failure::Silent.index() as usize)), b"");
    }
}
