//! Lines of bytes between a device and a soft PLC whose program uses its vendor's blocks, unchanged.

use std::collections::BTreeMap;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, Task, TaskPlan};
use onescan_iec_run::Application;
use onescan_server::checkpoint::Checkpoint;
use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::operation::{Operation, SignalFault};
use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::random::Random;
use onescan_server::signal::{SignalName, SignalType};
use onescan_server::time::VirtualTime;
use onescan_server::timeline::{Scheduled, Timeline, When};
use onescan_soft_plc::ports::{PlcPort, PlcWay, TerminalKind};
use onescan_soft_plc::{SoftPlcClient, bind};
use onescan_stream::connection::{Cuts, Role};
use onescan_stream::serial::Rate;
use onescan_stream::{Form, Port, PortState};
use onescan_tests::run::{PATIENCE, in_process, over_tcp, run};
use onescan_tests::{at_ms, client, plan, port, span_ms};

const WINDOW: u16 = 2048;
const LINE: SignalType = SignalType::Bytes(WINDOW);

/// What a device does with what it receives.
#[derive(Clone, Copy)]
pub(crate) enum Habit {
    /// It sends it back.
    Echo,
    /// It sends so many bytes at an instant, ms.
    Burst { count: usize, at_ms: u64 },
}

/// A device at the other end of a line.
pub(crate) struct Device {
    port: Port,
    habit: Habit,
}

impl Device {
    pub(crate) fn boxed(form: Form, habit: Habit) -> Box<dyn Client> {
        Box::new(Self { port: Port::new(form, [WINDOW; 2], 3), habit })
    }
}

impl Client for Device {
    fn join(&self) -> JoinRequest {
        let (reads, writes) = (vec![port("ask", LINE)], vec![port("answer", LINE)]);
        JoinRequest { name: client("device"), period: span_ms(2), reads, writes }
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.port = Port::new(self.port.form(), [WINDOW; 2], 3);
        self.port.show(outputs);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.port.arrive(t_v.as_nanos(), inputs);
        let got = self.port.take(usize::MAX);
        match self.habit {
            Habit::Echo if !got.is_empty() => {
                self.port.send(&got);
            }
            Habit::Burst { count, at_ms: ms } if t_v == at_ms(ms) => {
                self.port.send(&vec![0x55; count]);
            }
            Habit::Echo | Habit::Burst { .. } => {}
        }
        self.port.depart(t_v.as_nanos(), inputs, outputs);
        Ok(Wake::NextPeriod)
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        serde_json::to_vec(self.port.state()).map_err(|error| StateError::Corrupt(error.to_string()))
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        let state: PortState = serde_json::from_slice(state).map_err(|error| StateError::Corrupt(error.to_string()))?;
        self.port.restore(state).map_err(|error| StateError::Corrupt(error.to_string()))
    }
}

const SERIAL: &str = "
VAR_GLOBAL tx, rx : ComBuffer; comIn : KL6inData22B; comOut : KL6outData22B; END_VAR
PROGRAM Fast
VAR line : SerialLineControl; END_VAR
    line(Mode := SERIALLINEMODE_KL6_22B_STANDARD, pComIn := ADR(comIn), pComOut := ADR(comOut),
        SizeComIn := SIZEOF(comIn), TxBuffer := tx, RxBuffer := rx);
END_PROGRAM
PROGRAM Main
VAR_OUTPUT got, right : DINT; END_VAR
VAR send : SendData; get : ReceiveByte; bytes : ARRAY [0..1099] OF BYTE; i : INT; scans : INT; sent : BOOL; asks : BOOL := TRUE; END_VAR
    IF scans = 0 THEN
        FOR i := 0 TO 1025 DO bytes[i] := INT_TO_BYTE((i * 7) MOD 251); END_FOR
    END_IF
    scans := scans + 1;
    IF scans > 10 AND asks AND NOT sent THEN
        send(pSendData := ADR(bytes), Length := 1026, TxBuffer := tx);
        sent := NOT send.Busy;
    END_IF
    WHILE rx.Count > 0 DO
        get(RxBuffer := rx);
        IF get.ReceivedByte = bytes[got] THEN right := right + 1; END_IF
        got := got + 1;
    END_WHILE
END_PROGRAM";

const TCP: &str = "
PROGRAM Fast
END_PROGRAM
PROGRAM Main
VAR_OUTPUT got, right : DINT; END_VAR
VAR
    connect : FB_SocketConnect; send : FB_SocketSend; receive : FB_SocketReceive; close : FB_SocketClose;
    bytes, body : ARRAY [0..1099] OF BYTE; i : UDINT; step : INT; failed : UDINT;
END_VAR
    CASE step OF
        0:
            FOR i := 0 TO 1025 DO bytes[i] := UDINT_TO_BYTE((i * 7) MOD 251); END_FOR
            step := 1;
        1:
            connect(sRemoteHost := '192.168.42.30', nRemotePort := 2727, bExecute := TRUE);
            IF NOT connect.bBusy THEN step := 2; failed := failed + connect.nErrId; END_IF
        2:
            send(hSocket := connect.hSocket, cbLen := 1026, pSrc := ADR(bytes), bExecute := TRUE);
            IF NOT send.bBusy THEN step := 3; failed := failed + send.nErrId; END_IF
        3:
            receive(hSocket := connect.hSocket, cbLen := 1100, pDest := ADR(body), bExecute := NOT receive.bBusy);
            receive(bExecute := TRUE);
            IF NOT receive.bBusy AND receive.nRecBytes > 0 THEN
                FOR i := 0 TO receive.nRecBytes - 1 DO
                    IF body[i] = bytes[got] THEN right := right + 1; END_IF
                    got := got + 1;
                END_FOR
            END_IF
            receive(bExecute := FALSE);
            IF got >= 1026 THEN step := 4; END_IF
        4:
            close(hSocket := connect.hSocket, bExecute := TRUE);
            IF NOT close.bBusy THEN step := 5; END_IF
    END_CASE
END_PROGRAM";

fn signals() -> [(&'static str, SignalType, &'static str); 4] {
    let dint = SignalType::DINT;
    [("answer", LINE, "device"), ("ask", LINE, "plc"), ("got", dint, "plc"), ("right", dint, "plc")]
}

pub(crate) fn session_plan() -> SessionPlan {
    plan(span_ms(2), &Coupling::Parallel, &signals(), &["device", "plc"])
}

fn soft_plc(text: &str, fast_ms: u64, way: PlcWay) -> SoftPlcClient {
    soft_plc_in(Dialect::TwinCat, text, fast_ms, way)
}

pub(crate) fn soft_plc_in(dialect: Dialect, text: &str, fast_ms: u64, way: PlcWay) -> SoftPlcClient {
    let input = Input::from_text("device.st", SourceKind::Text, text).in_dialect(dialect);
    let application = Application::from_inputs([input]).unwrap_or_else(|error| panic!("{error}"));
    let task = |name: &str, interval_ms: u64, priority: u32, program: &str| Task {
        name: name.to_owned(),
        interval: Some(span_ms(interval_ms)),
        priority,
        programs: vec![program.to_owned()],
        ..Task::default()
    };
    let tasks = TaskPlan::new(vec![task("fast", fast_ms, 0, "Fast"), task("main", 10, 1, "Main")]);
    let decided = session_plan();
    let bindings = bind(&application, &client("plc"), decided.signals(), &BTreeMap::new()).expect("all bound");
    let name = |text: &str| SignalName::new(text).expect("a name");
    let port =
        PlcPort { name: "com".to_owned(), receive: (name("answer"), WINDOW), transmit: (name("ask"), WINDOW), way };
    let plc =
        SoftPlcClient::new(client("plc"), &application, &tasks, &bindings, span_ms(2)).expect("a plan that suits");
    plc.with_ports(&[port], 1).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn serial_rate() -> Rate {
    Rate::of(9600, 10).expect("not zero")
}

fn serial(terminal: TerminalKind) -> PlcWay {
    let (input, output) = ("comIn".to_owned(), "comOut".to_owned());
    PlcWay::Serial { rate: serial_rate(), terminal, receive_buffer: None, input, output }
}

pub(crate) fn tcp(cuts: Cuts) -> PlcWay {
    PlcWay::Tcp { host: "192.168.42.30".to_owned(), number: 2727, cuts }
}

/// A DINT that the PLC writes.
pub(crate) fn number(lockstep: &Lockstep, name: &str) -> i32 {
    let session = lockstep.session();
    let signal = session.signal_id(name).expect("a signal");
    let bytes = session.layout().bytes(signal, session.image());
    i32::from_le_bytes(bytes.try_into().expect("a DINT"))
}

/// The clients of a session in which the PLC sends 1,026 bytes and gets them back.
fn echo(is_serial: bool, cuts: Cuts) -> Vec<Box<dyn Client>> {
    if is_serial {
        let plc = soft_plc(SERIAL, 2, serial(TerminalKind::El60));
        vec![Device::boxed(Form::Serial(serial_rate()), Habit::Echo), Box::new(plc)]
    } else {
        let device = Device::boxed(Form::Connection(Role::Listens, cuts), Habit::Echo);
        vec![device, Box::new(soft_plc(TCP, 2, tcp(cuts)))]
    }
}

#[test]
fn what_is_sent_comes_back_whatever_the_line_and_its_cuts() {
    let ways = [(true, Cuts::Nowhere), (false, Cuts::Nowhere), (false, Cuts::Behind(500)), (false, Cuts::Every(37))];
    for (is_serial, cuts) in ways.into_iter().chain([(false, Cuts::Random)]) {
        let mut lockstep = in_process(session_plan(), echo(is_serial, cuts));
        assert_eq!(lockstep.run_to(at_ms(3_000)).expect("nothing is recorded"), Reached::Boundary);
        assert_eq!((number(&lockstep, "got"), number(&lockstep, "right")), (1026, 1026), "{is_serial} {cuts:?}");
    }
}

#[test]
fn neither_transport_nor_a_checkpoint_in_the_middle_of_a_byte_changes_a_bit() {
    for is_serial in [true, false] {
        no_way_changes_a_bit(|| echo(is_serial, Cuts::Every(100)));
    }
}

/// A session of these clients is the same again, over TCP, and gone on with from a checkpoint on the way.
pub(crate) fn no_way_changes_a_bit(clients: impl Fn() -> Vec<Box<dyn Client>>) {
    let whole = run(in_process(session_plan(), clients()), at_ms(2_000));
    assert_eq!(run(in_process(session_plan(), clients()), at_ms(2_000)), whole, "again");
    let (remote, _threads) = over_tcp(session_plan(), clients(), PATIENCE);
    assert_eq!(run(remote, at_ms(2_000)), whole, "over TCP");
    for saved_ms in [50, 334, 1_210] {
        let mut first = in_process(session_plan(), clients());
        first.run_to(at_ms(saved_ms)).expect("no fault");
        let bytes = first.checkpoint().expect("all save").to_bytes().expect("bytes");
        let mut second = in_process(session_plan(), clients());
        second.resume(&Checkpoint::from_bytes(&bytes).expect("a checkpoint")).expect("its own");
        assert_eq!(run(second, at_ms(2_000)), whole, "saved at {saved_ms} ms");
    }
}

/// How many of a burst of `count` bytes a program gets whose line control is called every `fast_ms`.
fn received(fast_ms: u64, terminal: TerminalKind, count: usize) -> i32 {
    let mut plc = soft_plc(SERIAL, fast_ms, serial(terminal));
    plc.preset("Main.asks", "FALSE").expect("a BOOL");
    let device = Device::boxed(Form::Serial(serial_rate()), Habit::Burst { count, at_ms: 1_000 });
    let mut lockstep = in_process(session_plan(), [device, Box::new(plc) as Box<dyn Client>]);
    assert_eq!(lockstep.run_to(at_ms(8_000)).expect("nothing is recorded"), Reached::Boundary);
    number(&lockstep, "got")
}

/// What docs/streams.md says is lost: the PLC sees at `t` what was over 2 ms before; the terminal fills its image at
/// 1,010 ms and then 10 ms after each call, with 22 bytes at most.
fn lost(buffer: i64, count: i64) -> i64 {
    let arrived = |t_ms: i64| count.min(((t_ms - 2 - 1_000) * 96 / 100).max(0));
    let first = arrived(1_010).min(22);
    let fills =
        (0..60).map(|j| (if j == 0 { 1_010 } else { 1_010 + 50 * j }, if j == 0 { 0 } else { first + 22 * (j - 1) }));
    fills.map(|(t_ms, taken)| arrived(t_ms) - taken - buffer).max().map_or(0, |most| most.max(0))
}

#[test]
fn a_line_control_that_is_called_too_seldom_loses_what_the_closed_form_says() {
    for (terminal, count) in [
        (TerminalKind::Kl60, 258_usize),
        (TerminalKind::Kl60, 1026),
        (TerminalKind::El60, 1026),
        (TerminalKind::El60, 3000),
        (TerminalKind::Kl6031, 1026),
    ] {
        let expected = lost(terminal.receive_buffer() as i64, count as i64);
        // the program has room for 1,026 bytes and compares no more
        if count <= 1026 {
            assert_eq!(i64::from(received(50, terminal, count)), count as i64 - expected, "{terminal:?} {count}");
            assert_eq!(received(2, terminal, count), count as i32, "{terminal:?} {count}, every 2 ms");
        } else {
            assert!(expected > 0, "{terminal:?} {count}");
        }
    }
    assert_eq!(lost(128, 1026), 440);
}

#[test]
fn no_sequence_of_faults_stops_a_session() {
    let mut random = Random::new(20_091);
    for sequence in 0..1_000 {
        let serial_line = sequence % 2 == 0;
        let form = |role| {
            if serial_line { Form::Serial(serial_rate()) } else { Form::Connection(role, Cuts::Random) }
        };
        let signals = [("answer", LINE, "device"), ("ask", LINE, "other")];
        let mut timeline = Vec::new();
        for _ in 0..random.bits() % 8 {
            let signal =
                SignalName::new(if random.bits().is_multiple_of(2) { "ask" } else { "answer" }).expect("a name");
            let rate = || "0.3".to_owned();
            let fault = match random.bits() % 6 {
                0 => SignalFault::Lost { rate: rate(), seed: sequence },
                1 => SignalFault::Flipped { rate: rate(), seed: sequence },
                2 => SignalFault::Silent,
                3 => SignalFault::Cut,
                4 => SignalFault::Stuck,
                _ => SignalFault::Late { by: span_ms(1 + random.bits() % 20) },
            };
            let from = 2 * (random.bits() % 100);
            let disturb = Operation::Disturb { signal: signal.clone(), fault };
            timeline.push(Scheduled { when: When::At(at_ms(from)), operation: disturb });
            let mend = Operation::Mend { signal };
            timeline.push(Scheduled { when: When::At(at_ms(from + 2 + 2 * (random.bits() % 20))), operation: mend });
        }
        let other = Talker { port: Port::new(form(Role::Connects), [WINDOW; 2], sequence) };
        let device = Device::boxed(form(Role::Listens), Habit::Echo);
        let decided = plan(span_ms(2), &Coupling::Parallel, &signals, &["device", "other"]);
        let mut lockstep = in_process(decided, [device, Box::new(other) as Box<dyn Client>]);
        let timeline = Timeline::new(timeline, lockstep.session()).expect("faults of lines");
        lockstep.set_timeline(timeline);
        assert_eq!(lockstep.run_to(at_ms(250)).expect("nothing is recorded"), Reached::Boundary, "sequence {sequence}");
    }
}

/// Sends a few bytes in every turn, over a connection if there is one.
struct Talker {
    port: Port,
}

impl Client for Talker {
    fn join(&self) -> JoinRequest {
        let (reads, writes) = (vec![port("answer", LINE)], vec![port("ask", LINE)]);
        JoinRequest { name: client("other"), period: span_ms(4), reads, writes }
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.port.show(outputs);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.port.arrive(t_v.as_nanos(), inputs);
        self.port.connect();
        self.port.send(&[1, 2, 3]);
        if t_v.as_nanos().is_multiple_of(40_000_000) {
            self.port.disconnect();
        }
        self.port.take(usize::MAX);
        self.port.depart(t_v.as_nanos(), inputs, outputs);
        Ok(Wake::NextPeriod)
    }
}
