//! An infrared line scanner over a shell that turns: it answers commands on a line of bytes, and sends lines of points.
//!
//! # Equations
//! - point `i` of `n` looks at `α_i = −45° + 90°·(i + ½)/n`, and sees `x = x_0 + d·tan α_i`, `x_0` the middle of its field;
//! - where the shell is bent, that point meets it at `x = x_0 + (d − r)·tan α_i` and at the angle `φ − asin(e·sin ψ/R)`: the
//!   surface moves to the scanner and away from it, and aside, as the shell turns (see [`Bend`](crate::bend::Bend));
//! - `D = 255·(T − T_min)/(T_max − T_min)`, to the nearest whole number from 0 to 255;
//! - a line begins with SYN, then its points and the internal temperature: `n + 2` bytes, no check sum;
//! - a scanner that is set to another emissivity than the surface's shows what Wien's law says at 3.9 µm.
//!
//! It looks at one moment a line; its mirror sweeps in some 10 ms, in which a kiln turns by less than 0.3°. A command is
//! heard and answered in the turn in which its last byte has come.
//!
//! # Source
//! Closed form; protocol of the MP50 and MP150, *Jacket*, 2009, ch. 13.

use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};

use crate::bend::Standpoint;
use crate::component::behaviour::{Component, Start, Talk, Turn};
use crate::component::declare::{Line, choice, failures, own_types, parameters, signals};
use crate::coupling::SeesHeat;
use crate::scanner::optics::{Optics, quantised, shown_degc};
use crate::scanner::protocol::{ACK, Answer, Device, NAK, SYN};
use crate::temperature_field::TemperatureField;
use onescan_stream::connection::{Cuts, Role};
use onescan_stream::serial::Rate;
use onescan_stream::{Form, Port};

/// Bits of a byte with its start and stop bit: 8N1.
const BITS: NonZeroU32 = NonZeroU32::new(10).expect("not zero");

choice! {
    /// How it is connected.
    Link {
        /// RS-485, 8N1
        Serial = "serial",
        /// Ethernet: it listens, and the host connects
        Tcp = "tcp",
    }
}

parameters! {
    /// How it is mounted, and what it looks at.
    Parameters {
        /// the place along the shell that the middle of its field sees
        middle_m: f64 = 30.0 => -300.0, 600.0;
        /// from the scanner to the shell
        distance_m: f64 = 30.0 => 0.1, 300.0;
        /// by how much it is mounted out of the square
        off_square_deg: f64 = 0.0 => -44.0, 44.0;
        /// by how much it is out of the square when somebody has knocked at it
        knocked_deg: f64 = 2.0 => -44.0, 44.0;
        /// part of the radiation that a dirty window lets through
        dirty_pct: f64 = 60.0 => 1.0, 100.0;
        /// of the surface that it looks at
        emissivity_pct: f64 = 95.0 => 5.0, 100.0;
        /// points of a line when it is new, as 64·2^(d-1): 3 is 256, 5 is 1024
        point_mode: u32 = 3 => 1.0, 5.0;
        /// from line to line in a burst, at least; a turn of the mirror at 48 Hz
        line_s: f64 = 0.0208 => 0.001, 10.0;
        /// its interface: RS-485, or Ethernet, on which the host connects
        link: Link = Link::Serial;
        /// bits a second of the serial line
        baud: u32 = 9600 => 300.0, 1_000_000.0;
        /// Ethernet: what it sends at once is cut once behind so many bytes; 0 is nowhere
        cut_behind: u32 = 0 => 0.0, 65_535.0;
        /// Ethernet: segments have so many bytes at most; 0 is not a limit
        segment: u32 = 0 => 0.0, 65_535.0;
        /// Ethernet: each message is cut once, a byte further on than the one before; goes before the two above
        cut_onwards: bool = false;
        /// by how much it is warmer inside than the air around the shell
        inside_more_degc: f64 = 6.0 => -100.0, 200.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// its trigger, which it reports in a line if it is set to
        trigger: bool,
        /// what the host sends
        rx: Line,
    }
}

signals! {
    /// What it gives beside its bytes.
    Outputs {
        /// lines that it has begun to send
        lines: i32,
        /// commands that it has acknowledged
        accepted: i32,
        /// commands that it has refused
        refused: i32,
        /// its internal temperature
        inside_degc: f64,
        /// what it sends
        tx: Line,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it says nothing
        Silent = "silent",
        /// its internal test has failed: ETB to every command until `AR` after the repair
        TestFailed = "test_failed",
        /// it understands nothing: NAK to every command
        Deaf = "deaf",
        /// somebody has knocked at it: it looks aside
        OffSquare = "off_square",
        /// its window is dirty: it sees less
        Dirty = "dirty",
        /// it has no supply, and forgets what it has not stored
        Unpowered = "unpowered",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    device: Device,
    lines: i32,
    accepted: i32,
    refused: i32,
    /// Since the last line of a burst began.
    since_line_s: f64,
}

/// A scanner by its parameters.
pub(crate) struct InfraredScanner {
    p: Parameters,
}

impl InfraredScanner {
    /// What it sees now, as bytes of a line.
    fn line(&self, device: &Device, trigger: bool, turn: &Turn<TemperatureField>) -> Vec<u8> {
        let (p, settings, field) = (&self.p, device.settings(), &turn.seen);
        let knocked = if turn.failed.has(Failure::OffSquare) { p.knocked_deg } else { 0.0 };
        let optics =
            Optics { middle_m: p.middle_m, distance_m: p.distance_m, off_square_deg: p.off_square_deg + knocked };
        let from = Standpoint { beside_m: p.middle_m, distance_m: p.distance_m };
        let clear = if turn.failed.has(Failure::Dirty) { p.dirty_pct / 100.0 } else { 1.0 };
        let (emissivity, set) = (p.emissivity_pct / 100.0 * clear, f64::from(settings.emissivity_pct) / 100.0);
        let points = settings.points();
        let mut line = Vec::with_capacity(settings.line_bytes());
        line.push(SYN);
        line.extend((0..points).map(|index| {
            let degc = optics.place_m(index, points).map_or(field.ambient_degc, |x_m| field.seen_from(from, x_m));
            quantised(shown_degc(degc, emissivity, set), settings.lower_degc, settings.upper_degc)
        }));
        line.push(quantised(self.inside_degc(field), 0, 255));
        if settings.has_sectors() {
            // outputs of sectors are not part of this scanner's work: none is on
            line.extend([0; 6]);
        }
        if settings.has_trigger() {
            line.push(u8::from(trigger));
        }
        line
    }

    fn inside_degc(&self, field: &TemperatureField) -> f64 {
        field.ambient_degc + self.p.inside_more_degc
    }

    /// Hears bytes, and puts what it says behind `said`.
    fn converse(
        &self,
        state: &mut State,
        heard: impl IntoIterator<Item = u8>,
        trigger: bool,
        turn: &Turn<TemperatureField>,
        said: &mut Vec<u8>,
    ) {
        if turn.failed.has(Failure::Unpowered) {
            state.device.restart();
            return;
        }
        if turn.failed.has(Failure::TestFailed) {
            state.device.fail_test();
        }
        state.since_line_s += turn.dt_s;
        let was_bursting = state.device.is_bursting();
        let mut answers = Vec::new();
        for byte in heard {
            match state.device.hear(byte) {
                None => {}
                Some(Answer::Line) => self.begin_line(state, trigger, turn, &mut answers),
                Some(Answer::Bytes(bytes)) => {
                    let bytes = if turn.failed.has(Failure::Deaf) { vec![NAK] } else { bytes };
                    let count = if bytes.first() == Some(&ACK) { &mut state.accepted } else { &mut state.refused };
                    *count = count.saturating_add(1);
                    answers.extend(bytes);
                }
            }
        }
        if was_bursting && state.device.is_bursting() && state.since_line_s >= self.p.line_s {
            self.begin_line(state, trigger, turn, &mut answers);
        }
        if !turn.failed.has(Failure::Silent) {
            said.extend(answers);
        }
    }

    fn begin_line(&self, state: &mut State, trigger: bool, turn: &Turn<TemperatureField>, said: &mut Vec<u8>) {
        said.extend(self.line(&state.device, trigger, turn));
        state.lines = state.lines.saturating_add(1);
        state.since_line_s = 0.0;
    }
}

impl Component for InfraredScanner {
    const NAME: &'static str = "infrared_scanner";
    const SUMMARY: &'static str = "infrared line scanner: temperatures along a shell, as bytes on request";
    const FORMULA: &'static [&'static str] = &[
        "x = x_0 + (d - r) tan(-45° + 90° (i + ½)/n), r by which a bent shell is nearer there",
        "D = 255 (T - T_min)/(T_max - T_min), rounded",
        "line: SYN, n points, internal temperature",
    ];
    const SOURCE: &'static str = "closed form; protocol of the MP50 and MP150; Jacket, 2009, ch. 13";
    own_types!(senses SeesHeat);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<TemperatureField>) -> State {
        let device = Device::new(u8::try_from(self.p.point_mode).unwrap_or(3));
        State { device, lines: 0, accepted: 0, refused: 0, since_line_s: 0.0 }
    }

    fn ports(&self) -> Vec<Form> {
        let cuts = match (self.p.cut_onwards, self.p.cut_behind, self.p.segment) {
            (true, ..) => Cuts::Onwards,
            (false, 0, 0) => Cuts::Nowhere,
            (false, 0, segment) => Cuts::Every(segment),
            (false, behind, _) => Cuts::Behind(behind),
        };
        let baud = NonZeroU32::new(self.p.baud).unwrap_or(NonZeroU32::MIN);
        vec![match self.p.link {
            Link::Serial => Form::Serial(Rate { baud, bits_per_byte: BITS }),
            Link::Tcp => Form::Connection(Role::Listens, cuts),
        }]
    }

    fn talk(&self, state: &mut State, inputs: &Inputs, turn: &Turn<TemperatureField>, talk: &mut Talk<'_>) {
        let Some(port) = talk.ports.first_mut() else { return };
        let mut said = Vec::new();
        let heard: Vec<u8> = std::iter::from_fn(|| port.receive()).collect();
        self.converse(state, heard, inputs.trigger, turn, &mut said);
        say(port, &said);
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<TemperatureField>) -> Outputs {
        Outputs {
            lines: state.lines,
            accepted: state.accepted,
            refused: state.refused,
            inside_degc: self.inside_degc(&turn.seen),
            tx: Line,
        }
    }
}

/// Sends what a scanner says; to nobody, if the host has gone meanwhile.
fn say(port: &mut Port, said: &[u8]) {
    if !said.is_empty() && !port.send(said) {
        port.purge();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;
    use crate::scanner::protocol::{ETB, STX, command};
    use crate::scanner::temperature_degc;
    use crate::temperature_field::{Spot, ZONES};

    const IDLE: Inputs = Inputs { trigger: false, rx: Line };

    fn shell(angle_deg: f64) -> TemperatureField {
        let spot = Spot { more_k: 60.0, at_m: 22.0, at_rad: 130_f64.to_radians(), along_m: 0.8, around_m: 0.8 };
        TemperatureField {
            zones_degc: [300.0; ZONES],
            spots: [spot, Spot::default()],
            length_m: 60.0,
            radius_m: 2.0,
            angle_rad: angle_deg.to_radians(),
            ..TemperatureField::default()
        }
    }

    /// What a scanner says to these bytes, over a shell at an angle.
    fn said(rig: &mut Rig<InfraredScanner>, bytes: &[u8], angle_deg: f64) -> Vec<u8> {
        rig.seen = shell(angle_deg);
        let turn = Turn { dt_s: 0.01, seen: rig.seen, failed: rig.failed };
        let mut said = Vec::new();
        rig.component.converse(&mut rig.state, bytes.iter().copied(), IDLE.trigger, &turn, &mut said);
        said
    }

    fn rig(p: Parameters) -> Rig<InfraredScanner> {
        Rig::new(InfraredScanner::new(p))
    }

    #[test]
    fn a_hot_spot_is_in_the_column_and_at_the_angle_of_the_closed_form() {
        for (point_mode, points) in [(3, 256_usize), (5, 1024)] {
            let mut rig = rig(Parameters { point_mode, ..Parameters::default() });
            let lines: Vec<Vec<u8>> = (0..360).map(|angle| said(&mut rig, &[STX], f64::from(angle))).collect();
            assert!(lines.iter().all(|line| line.len() == points + 2 && line[0] == SYN && line[points + 1] == 26));
            let bytes = lines.iter().enumerate().flat_map(|(row, line)| {
                line[1..=points].iter().enumerate().map(move |(column, byte)| (*byte, row, column))
            });
            let (hottest, row, column) =
                bytes.max_by_key(|(byte, row, column)| (*byte, 360 - row, points - column)).unwrap();
            // α = atan((22 - 30)/30) = -14.93°
            let wanted = ((libm::atan(-8.0 / 30.0).to_degrees() + 45.0) / 90.0 * points as f64) as usize;
            assert!(column.abs_diff(wanted) <= 1 + points / 256, "{points}: column {column}, not {wanted}");
            assert!(row.abs_diff(130) <= 4, "{points}: row {row}");
            assert!((temperature_degc(hottest, 0, 500) - 360.0).abs() <= 500.0 / 255.0, "{hottest}");
        }
    }

    #[test]
    fn each_failure_has_its_effect() {
        let commands = [command(b"PM3"), command(b"XX")].concat();
        assert_eq!(said(&mut rig(Parameters::default()), &commands, 0.0), [ACK, NAK]);
        let failing = |mode| rig(Parameters::default()).failing(mode);
        assert!(said(&mut failing(Failure::Silent), &[&commands[..], &[STX]].concat(), 0.0).is_empty());
        assert_eq!(said(&mut failing(Failure::Deaf), &commands, 0.0), [NAK, NAK]);
        assert_eq!(said(&mut failing(Failure::TestFailed), &commands, 0.0), [ETB, ETB]);
        assert!(said(&mut failing(Failure::Unpowered), &commands, 0.0).is_empty());
        let whole = said(&mut rig(Parameters::default()), &[STX], 130.0);
        let dirty = said(&mut failing(Failure::Dirty), &[STX], 130.0);
        assert!(dirty.iter().zip(&whole).skip(1).take(256).all(|(dirty, whole)| dirty < whole));
        let aside = said(&mut failing(Failure::OffSquare), &[STX], 130.0);
        let hottest = |line: &[u8]| (1..=256).max_by_key(|index| line[*index]).unwrap();
        // 2° of 90° are some 6 points of 256
        assert!((4..=8).contains(&hottest(&whole).abs_diff(hottest(&aside))));
    }

    #[test]
    fn a_burst_sends_lines_at_the_rate_of_the_mirror() {
        let mut rig = rig(Parameters::default());
        said(&mut rig, &[command(b"RMB"), vec![STX]].concat(), 0.0);
        for _ in 0..100 {
            said(&mut rig, &[], 0.0);
        }
        // a line every three turns of 10 ms, which is the first multiple of it after 20.8 ms
        assert_eq!(rig.state.lines, 1 + 33);
        said(&mut rig, &[0x1b], 0.0);
        assert!(said(&mut rig, &[], 0.0).is_empty());
    }
}
