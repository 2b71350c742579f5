//! An infrared scanner over the heated shell of a kiln, asked for lines by a host at the other end of a line of bytes, and
//! what it answers, compared with closed forms: places and temperatures, times on the wire, cuts of segments.

use onescan_plant::Plant;
use onescan_plant::scanner::protocol::{ACK, NAK, STX, SYN, command};
use onescan_plant::scanner::temperature_degc;
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, Port as Signal, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_stream::connection::{Cuts, Link, Role};
use onescan_stream::serial::Rate;
use onescan_stream::{Form, Port};

/// A turn of plant and host, ns, unless a test tries others.
const STEP_NS: u64 = 2_000_000;
/// Lines of a revolution in these tests.
const LINES: usize = 90;

/// The kiln with a hot spot of +60 °C at 22 m and 130°, and a scanner with these settings.
fn scene(kiln: &str, scanner: &str) -> String {
    format!(
        r#"
        version = 1

        [[body]]
        name = "shell"
        kind = "fixed"

        [[component]]
        name = "kiln"
        kind = "kiln_shell"
        body = "shell"
        {kiln}
        ring_start_deg = 0.0
        shell_start_deg = 0.0
        speed_turns_h_signal = "Speed"
        shell_rad_signal = "Angle"
        run_out_m_signal = "Run_out"

        [[component]]
        name = "heat"
        kind = "kiln_heat"
        body = "shell"
        spot_more_degc = 60.0
        angle_rad_from = "kiln.shell_rad"
        hottest_degc_signal = "Hottest"

        [[component]]
        name = "scanner"
        kind = "infrared_scanner"
        body = "shell"
        rx_signal = "To"
        tx_signal = "From"
        {scanner}
        "#
    )
}

/// A plant with a scanner, and a host at the other end of its line.
struct Rig {
    plant: Plant,
    host: Port,
    inputs: Vec<u8>,
    outputs: Vec<u8>,
    now_ns: u64,
    step_ns: u64,
}

/// Where a signal lies among the bytes of a port.
fn place(signals: &[Signal], name: &str) -> std::ops::Range<usize> {
    let mut end = 0;
    for signal in signals {
        let start = end;
        end += signal.ty.size();
        if signal.name.as_str() == name {
            return start..end;
        }
    }
    panic!("no signal {name}")
}

impl Rig {
    fn new(scanner: &str, form: Form) -> Self {
        Self::with_step(&scene("", scanner), form, STEP_NS)
    }

    fn with_step(scene: &str, form: Form, step_ns: u64) -> Self {
        let name = ClientName::new("plant").expect("whole");
        let step = TimeSpan::from_nanos(step_ns).expect("not zero");
        let mut plant = Plant::parse(scene, "kiln.toml", name, step).expect("whole");
        let size = |signals: &[Signal]| signals.iter().map(|signal| signal.ty.size()).sum();
        let request = plant.join();
        let (inputs, mut outputs) = (vec![0; size(&request.reads)], vec![0; size(&request.writes)]);
        plant.setup(&mut outputs).expect("whole");
        let window = |signals: &[Signal], name: &str| {
            let ty = signals.iter().find(|signal| signal.name.as_str() == name).expect("whole").ty;
            let SignalType::Bytes(window) = ty else { panic!("{name} is not a line") };
            window
        };
        let host = Port::new(form, [window(&request.writes, "From"), window(&request.reads, "To")], 1);
        Self { plant, host, inputs, outputs, now_ns: 0, step_ns }
    }

    fn serial(scanner: &str) -> Self {
        Self::new(scanner, Form::Serial(Rate::of(9600, 10).expect("whole")))
    }

    fn tcp(scanner: &str) -> Self {
        Self::new(&format!("link = \"tcp\"\n{scanner}"), Form::Connection(Role::Connects, Cuts::Nowhere))
    }

    fn turn_kiln(&mut self, turns_h: f64) {
        let speed = place(&self.plant.join().reads, "Speed");
        self.inputs[speed].copy_from_slice(&turns_h.to_le_bytes());
    }

    /// A value that the plant has written.
    fn value(&self, name: &str) -> f64 {
        let place = place(&self.plant.join().writes, name);
        f64::from_le_bytes(self.outputs[place].try_into().expect("an LREAL"))
    }

    /// One turn of both, which see each other's lines of the turn before.
    fn step(&mut self, act: impl FnOnce(&mut Port)) {
        self.now_ns += self.step_ns;
        let request = self.plant.join();
        let (from, to) = (place(&request.writes, "From"), place(&request.reads, "To"));
        let seen = self.outputs[from].to_vec();
        let mut said = self.inputs[to.clone()].to_vec();
        self.plant.turn(VirtualTime::from_nanos(self.now_ns), &self.inputs, &mut self.outputs).expect("whole");
        self.host.arrive(self.now_ns, &seen);
        act(&mut self.host);
        self.host.depart(self.now_ns, &seen, &mut said);
        self.inputs[to].copy_from_slice(&said);
    }

    /// Says something, and takes what is answered: so many bytes, if they come within so many steps.
    fn ask(&mut self, bytes: &[u8], answer: usize, patience: usize) -> Vec<u8> {
        if self.host.link() != Link::Open {
            self.step(Port::connect);
            while self.host.link() != Link::Open {
                self.step(|_| ());
            }
        }
        self.step(|host| assert!(host.send(bytes)));
        let mut answered = Vec::new();
        for _ in 0..patience {
            self.step(|host| answered.extend(std::iter::from_fn(|| host.receive())));
            if answered.len() >= answer {
                break;
            }
        }
        answered
    }

    /// A line of so many bytes, and what these signals were as it was taken; the kiln goes on for a while after it.
    fn line_with<const N: usize>(&mut self, bytes: usize, signals: [&str; N]) -> (Vec<u8>, [f64; N]) {
        let taken = |rig: &Self| {
            let place = place(&rig.plant.join().writes, "Lines");
            i32::from_le_bytes(rig.outputs[place].try_into().expect("a DINT"))
        };
        if self.host.link() != Link::Open {
            self.step(Port::connect);
            while self.host.link() != Link::Open {
                self.step(|_| ());
            }
        }
        let before = taken(self);
        self.step(|host| assert!(host.send(&[STX])));
        let (mut line, mut seen) = (Vec::new(), None);
        while line.len() < bytes {
            self.step(|host| line.extend(std::iter::from_fn(|| host.receive())));
            if taken(self) > before && seen.is_none() {
                seen = Some(signals.map(|name| self.value(name)));
            }
            assert!(self.now_ns < 600_000_000_000, "no line comes");
        }
        (0..250_000_000 / self.step_ns).for_each(|_| self.step(|_| ()));
        (line, seen.expect("a line was taken"))
    }

    /// A revolution, line by line; the kiln stands while a line is asked for, so that all links see it at the same angles.
    fn matrix(&mut self, points: usize) -> Vec<Vec<u8>> {
        let step_turns = STEP_NS as f64 / 3.6e12;
        (0..LINES)
            .map(|_| {
                let line = self.ask(&[STX], points + 2, 2_000);
                assert_eq!((line.len(), line[0], line[points + 1]), (points + 2, SYN, 26));
                // 100 steps to the next line
                self.turn_kiln(1.004 / LINES as f64 / 100.0 / step_turns);
                (0..100).for_each(|_| self.step(|_| ()));
                self.turn_kiln(0.0);
                line
            })
            .collect()
    }
}

#[test]
fn a_scanner_takes_commands_with_the_check_byte_of_its_manufacturer() {
    let mut rig = Rig::serial("");
    for text in ["AR", "SB0100", "ST0500", "ES095"] {
        let right = command(text.as_bytes());
        assert_eq!(rig.ask(&right, 1, 50), [ACK], "{text}");
        // the thesis' plain sum is the same where it has the highest bit anyway, as that of AR
        let mut plain = right.clone();
        let sum = right[..right.len() - 1].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        *plain.last_mut().expect("whole") = sum;
        let wanted = if text == "AR" { ACK } else { NAK };
        assert_eq!(rig.ask(&plain, 1, 50), [wanted], "{text}");
    }
}

#[test]
fn a_line_is_as_long_on_the_wire_as_its_bytes() {
    for (mode, points, line_ns) in [(3, 256, 268_750_000_u64), (5, 1024, 1_068_750_000)] {
        let mut rig = Rig::serial(&format!("point_mode = {mode}"));
        let before = rig.now_ns;
        let line = rig.ask(&[STX], points + 2, 2_000);
        assert_eq!(line.len(), points + 2);
        // asked for in one step, 1.04 ms to the scanner, which answers in its turn; then each way a step
        let took = rig.now_ns - before;
        assert!(took >= line_ns && took <= line_ns + 5 * STEP_NS, "{took} {line_ns}");
    }
}

#[test]
fn a_hot_spot_is_where_the_closed_form_says_on_every_link() {
    for (mode, points) in [(3, 256_usize), (5, 1024)] {
        let point_mode = format!("point_mode = {mode}");
        let serial = Rig::serial(&point_mode).matrix(points);
        let tcp = Rig::tcp(&point_mode).matrix(points);
        assert_eq!(serial, tcp, "{points} points");
        let bytes = serial.iter().enumerate();
        let cells = bytes.flat_map(|(row, line)| (1..=points).map(move |cell| (line[cell], row, cell - 1)));
        // by how much a point is hotter than its column on the other side of the shell
        let more = |(byte, row, column): (u8, usize, usize)| {
            let opposite = serial[(row + LINES / 2) % LINES][column + 1];
            (i32::from(byte) - i32::from(opposite), row, column)
        };
        let most = cells.map(more).max_by_key(|(more, ..)| *more).expect("whole");
        // α = atan((22 - 30)/30), and 130° of 360° in lines of 4°
        let column = ((libm::atan(-8.0 / 30.0).to_degrees() + 45.0) / 90.0 * points as f64) as usize;
        let row = (130.0 / 360.0 * LINES as f64).round() as usize;
        assert!(most.1.abs_diff(row) <= 1, "row {} not {row}", most.1);
        assert!(most.2.abs_diff(column) <= points / 128, "column {} not {column}", most.2);
        let quantum = temperature_degc(1, 0, 500);
        assert!((f64::from(most.0) * quantum - 60.0).abs() <= 1.5 * quantum, "{} K", f64::from(most.0) * quantum);
    }
}

#[test]
fn a_line_cut_anywhere_is_the_same_line() {
    let whole = Rig::tcp("point_mode = 5").ask(&[STX], 1026, 2_000);
    assert_eq!(whole.len(), 1026);
    for at in 1..1026 {
        let cut = Rig::tcp(&format!("point_mode = 5\ncut_behind = {at}")).ask(&[STX], 1026, 2_000);
        assert!(cut == whole, "cut behind {at}");
    }
    for most in [1, 7, 536, 1460] {
        let cut = Rig::tcp(&format!("point_mode = 5\nsegment = {most}")).ask(&[STX], 1026, 5_000);
        assert!(cut == whole, "segments of {most}");
    }
}

#[test]
fn a_scanner_goes_on_from_its_state_in_the_middle_of_a_line() {
    let asked = |interrupted: bool| {
        let mut rig = Rig::serial("");
        rig.step(|host| assert!(host.send(&[STX])));
        let mut line = Vec::new();
        for step in 0..200 {
            if interrupted && step == 60 {
                let state = rig.plant.save().expect("whole");
                let outputs = rig.outputs.clone();
                let fresh = Rig::serial("");
                rig.plant = fresh.plant;
                rig.plant.restore(&state).expect("whole");
                rig.outputs = outputs;
            }
            rig.step(|host| line.extend(std::iter::from_fn(|| host.receive())));
        }
        line
    };
    let line = asked(false);
    assert_eq!(line.len(), 258);
    assert_eq!(line, asked(true));
}

/// The outlet of a shell whose axis is off by 30 cm all along, towards 70 degrees, seen from 34 m beside its middle: by how
/// much it is nearer, and which point of 1,024 is the last that sees it.
fn outlet(angle_rad: f64) -> (f64, usize) {
    let behind = 70_f64.to_radians() - angle_rad;
    let nearer_m = 0.3 * behind.cos() + (4.0 - (0.3 * behind.sin()).powi(2)).sqrt() - 2.0;
    // point i looks at -45° + 90° (i + ½)/1024
    let end_deg = (30.0 / (34.0 - nearer_m)).atan().to_degrees();
    (nearer_m, ((end_deg + 45.0) / 90.0 * 1024.0 - 0.5).floor() as usize)
}

#[test]
fn the_outlet_of_a_bent_shell_is_where_the_closed_form_says_at_1_ms_and_at_10_ms() {
    let bent = "bend_m = 0.1\nbent_more_m = 0.2\nbend_at_m = 60.0\nbend_at_deg = 70.0\nbend_width_m = 300.0";
    let far = "link = \"tcp\"\npoint_mode = 5\ndistance_m = 34.0\nlines_signal = \"Lines\"";
    let failing = "[[failure]]\ncomponent = \"kiln\"\nmode = \"bent\"\n";
    for step_ns in [1_000_000, 10_000_000] {
        let scene = format!("{}\n{failing}", scene(bent, far));
        let mut rig = Rig::with_step(&scene, Form::Connection(Role::Connects, Cuts::Nowhere), step_ns);
        rig.turn_kiln(250.0);
        let mut ends = std::collections::BTreeSet::new();
        for _ in 0..60 {
            let (line, [angle_rad, run_out_m]) = rig.line_with(1026, ["Angle", "Run_out"]);
            let (nearer_m, last) = outlet(angle_rad);
            assert!((run_out_m - nearer_m).abs() < 1e-9, "{step_ns}: {run_out_m} {nearer_m}");
            let end = line[1..=1024].iter().rposition(|byte| temperature_degc(*byte, 0, 500) > 100.0);
            assert_eq!(end, Some(last), "{step_ns} at {angle_rad}");
            ends.insert(last);
        }
        // 30 cm to and fro are three points each way
        assert!(ends.len() >= 5, "{ends:?}");
    }
}
