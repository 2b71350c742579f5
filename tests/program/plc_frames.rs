//! A peeling line's links ([Nyyssönen] ch. 3.1 and 4.1): two PLCs that are TCP clients, frames of 360, 134, 390 and
//! 130 bytes without a header, and no byte added for the handshake.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use onescan_links::gateway::Exchange;
use onescan_links::gateway::exchange::{Feed, Words};
use onescan_links::gateway::tcp::{Declaration, Layouts};
use onescan_server::signal::{Port, SignalName, SignalType};

use crate::plc::Plc;
use crate::typed::{Said, begun, digests, edit, onescan, scenario, typed};

const TYPES: &str = "
TYPE
    AxisCommand : STRUCT
        Execute, Tracking, TorqueControl, SpeedControl, Enable : BOOL;
        TargetPosition, TargetSpeed, TargetAcceleration, TargetDeceleration, TargetTorque : REAL;
    END_STRUCT;
    AxisFeedback : STRUCT
        Enabled, InPosition : BOOL;
        ActualPosition, ActualSpeed : REAL;
    END_STRUCT;
END_TYPE
";

/// A command is held for 500 ms; the next one follows when the axis is there.
const MOVER: &str = "
FUNCTION_BLOCK Mover
VAR_INPUT Target : REAL; Feedback : AxisFeedback; END_VAR
VAR_OUTPUT Command : AxisCommand; END_VAR
VAR Hold : TP; Moving, Out : BOOL; END_VAR
    Command.Enable := TRUE;
    Command.TargetSpeed := 8000.0;
    Command.TargetAcceleration := 15000.0;
    Command.TargetDeceleration := 15000.0;
    IF NOT Moving AND Feedback.Enabled THEN
        Moving := TRUE;
        Out := NOT Out;
        IF Out THEN Command.TargetPosition := Target; ELSE Command.TargetPosition := 0.0; END_IF;
    END_IF;
    Hold(IN := Moving, PT := T#500ms);
    Command.Execute := Hold.Q;
    IF Moving AND NOT Hold.Q AND Feedback.InPosition THEN Moving := FALSE; END_IF;
END_FUNCTION_BLOCK
";

const AXIS: &str = "
FUNCTION_BLOCK Axis
VAR_INPUT Command : AxisCommand; END_VAR
VAR_OUTPUT Feedback : AxisFeedback; END_VAR
VAR Edge : R_TRIG; Moving : BOOL; Target, Speed, Rest, Way : REAL; END_VAR
VAR CONSTANT Cycle : REAL := 0.01; END_VAR
    Feedback.Enabled := Command.Enable;
    Edge(CLK := Command.Execute AND Command.Enable);
    IF Edge.Q THEN
        Moving := TRUE;
        Feedback.InPosition := FALSE;
        Target := Command.TargetPosition;
    END_IF;
    IF Moving THEN
        Rest := ABS(Target - Feedback.ActualPosition);
        IF Speed * Speed >= 2.0 * Command.TargetDeceleration * Rest THEN
            Speed := MAX(Speed - Command.TargetDeceleration * Cycle, 10.0);
        ELSE
            Speed := MIN(Speed + Command.TargetAcceleration * Cycle, Command.TargetSpeed);
        END_IF;
        Way := MIN(Speed * Cycle, Rest);
        IF Target < Feedback.ActualPosition THEN Way := -Way; END_IF;
        Feedback.ActualPosition := Feedback.ActualPosition + Way;
        IF Rest <= 0.1 THEN
            Moving := FALSE;
            Speed := 0.0;
            Feedback.ActualPosition := Target;
            Feedback.InPosition := TRUE;
        END_IF;
    END_IF;
    Feedback.ActualSpeed := Speed;
END_FUNCTION_BLOCK
";

const PLANT: &str = "
PROGRAM Plant
VAR
    C : ARRAY[1..12] OF AxisCommand;
    F : ARRAY[1..12] OF AxisFeedback;
    K : ARRAY[1..13] OF AxisCommand;
    G : ARRAY[1..13] OF AxisFeedback;
    Charger : ARRAY[1..12] OF Axis;
    Lathe : ARRAY[1..13] OF Axis;
    I : INT;
END_VAR
VAR_OUTPUT Increments : WORD; Left, Right, SimulationTime : REAL; END_VAR
    FOR I := 1 TO 12 DO Charger[I](Command := C[I]); F[I] := Charger[I].Feedback; END_FOR;
    FOR I := 1 TO 13 DO Lathe[I](Command := K[I]); G[I] := Lathe[I].Feedback; END_FOR;
    SimulationTime := SimulationTime + 0.01;
    Left := 112.5;
    Right := 112.25;
    Increments := SHL(WORD#1, REAL_TO_INT(SimulationTime) MOD 16);
END_PROGRAM
";

/// What a machine's PLC is: its client, its axes, and the letters of its commands and feedback.
struct Machine {
    name: &'static str,
    axes: usize,
    letters: [&'static str; 2],
    /// Fields behind the feedback of the axes.
    tail: &'static str,
    /// Bytes from the PLC and to it.
    bytes: [usize; 2],
}

const CHARGER: Machine = Machine {
    name: "charger",
    axes: 12,
    letters: ["C", "F"],
    tail: ", \"Increments: WORD\", \"Left: REAL\", \"Right: REAL\", \"SimulationTime: REAL\"",
    bytes: [360, 134],
};
const LATHE: Machine = Machine { name: "lathe", axes: 13, letters: ["K", "G"], tail: "", bytes: [390, 130] };

impl Machine {
    fn program(&self) -> String {
        let Self { name, axes, letters: [command, feedback], .. } = self;
        format!(
            "PROGRAM {name}_program\nVAR\n    {command} : ARRAY[1..{axes}] OF AxisCommand;\n    {feedback} : \
             ARRAY[1..{axes}] OF AxisFeedback;\n    M : ARRAY[1..{axes}] OF Mover;\n    I : INT;\nEND_VAR\n    FOR I := 1 \
             TO {axes} DO\n        M[I](Target := 500.0 * INT_TO_REAL(I), Feedback := {feedback}[I]);\n        \
             {command}[I] := M[I].Command;\n    END_FOR;\nEND_PROGRAM\n"
        )
    }

    fn client(&self, url: &str, handshake: &str) -> String {
        let Self { name, axes, letters: [command, feedback], tail, .. } = self;
        let fields = |letter: &str, ty: &str| {
            let field = |axis| format!("\"{letter}[{axis}]: {ty}\"");
            (1..=*axes).map(field).collect::<Vec<_>>().join(", ")
        };
        let (to, from) = (fields(feedback, "AxisFeedback"), fields(command, "AxisCommand"));
        let words = if handshake == "words" { WORDS } else { "" };
        format!(
            r#"
[clients.{name}]
kind = "soft-plc"
sources = ["types.st", "mover.st", "{name}.st"]
tasks = [{{ name = "main", interval = "10ms", programs = ["{name}_program"] }}]
bind = {{ "{command}[*" = "{name}_program.{command}[*", "{feedback}[*" = "{name}_program.{feedback}[*" }}

[clients.{name}.gateway]
url = "{url}"
handshake = "{handshake}"

[clients.{name}.gateway.layout]
reserve_zero = true
from_plc = [{from}]
to_plc = [{to}{tail}]

[clients.{name}.gateway.layout.structures]
AxisCommand = ["Execute: BOOL", "Tracking: BOOL", "TorqueControl: BOOL", "SpeedControl: BOOL", "Enable: BOOL",
    "_: BOOL", "_: BOOL", "_: BOOL", "_: BYTE", "TargetPosition: REAL", "TargetSpeed: REAL",
    "TargetAcceleration: REAL", "TargetDeceleration: REAL", "TargetTorque: REAL", "_: REAL", "_: REAL"]
AxisFeedback = ["Enabled: BOOL", "InPosition: BOOL", "ActualPosition: REAL", "ActualSpeed: REAL"]

[clients.{name}.gateway.map]
{words}"#
        )
    }
}

/// The words in what the frames have to spare: byte 1 of twelve axes and six bits of byte 0 to the PLC, two REALs of two
/// axes from it.
const WORDS: &str = r#"
SDSP_Session = "1+11+21+31"
SDSP_Limit = "41+51+61+71"
SDSP_Grant = "81+91+101+111"
SDSP_TV = "0.2-7+10.2-7+20.2-7+30.2-7+40.2-7+50.2-7+60.2-7+70.2-7+80.2-7+90.2-7+100.2-5"
SDSP_Joined = "22"
SDSP_Done = "26"
SDSP_Answer = "52"
SDSP_Layout = "56"
"#;

/// The line in a folder of its own, whose gateways are at these URLs.
fn line(urls: [&str; 2], handshake: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
    write("types.st", TYPES);
    write("mover.st", MOVER);
    write("axis.st", AXIS);
    write("plant.st", PLANT);
    let mut text = "version = 1\ntitle = \"Frames\"\nstep = \"10ms\"\nuntil = \"3s\"\n\n[signals]\n".to_owned();
    for machine in [CHARGER, LATHE] {
        write(&format!("{}.st", machine.name), &machine.program());
        let Machine { name, axes, letters: [command, feedback], .. } = machine;
        let mut signal = |letter: &str, field: &str, ty: &str, writer: &str| {
            let line = format!("\"{letter}[1..{axes}].{field}\" = {{ type = \"{ty}\", writer = \"{writer}\" }}");
            writeln!(text, "{line}").expect("a text");
        };
        for field in ["Execute", "Tracking", "TorqueControl", "SpeedControl", "Enable"] {
            signal(command, field, "BOOL", name);
        }
        for field in ["TargetPosition", "TargetSpeed", "TargetAcceleration", "TargetDeceleration", "TargetTorque"] {
            signal(command, field, "REAL", name);
        }
        for (field, ty) in
            [("Enabled", "BOOL"), ("InPosition", "BOOL"), ("ActualPosition", "REAL"), ("ActualSpeed", "REAL")]
        {
            signal(feedback, field, ty, "plant");
        }
    }
    for (name, ty) in [("Increments", "WORD"), ("Left", "REAL"), ("Right", "REAL"), ("SimulationTime", "REAL")] {
        writeln!(text, "{name} = {{ type = \"{ty}\", writer = \"plant\" }}").expect("a text");
    }
    text += r#"
[clients.plant]
kind = "soft-plc"
sources = ["types.st", "axis.st", "plant.st"]
tasks = [{ name = "main", interval = "10ms", programs = ["Plant"] }]
bind = { "C[*" = "Plant.C[*", "F[*" = "Plant.F[*", "K[*" = "Plant.K[*", "G[*" = "Plant.G[*" }
"#;
    text += &CHARGER.client(urls[0], handshake);
    text += &LATHE.client(urls[1], handshake);
    // The charger reads what lies behind its axes, and has no variables for it.
    text = text.replace("\"F[*\" = \"charger_program.F[*\"", TAIL);
    write("scenario.toml", &text);
    let program = CHARGER.program().replace("    I : INT;", "    I : INT; Bits : WORD; L, R, T : REAL;");
    write("charger.st", &program);
    folder
}

const TAIL: &str = r#""F[*" = "charger_program.F[*", Increments = "charger_program.Bits", Left = "charger_program.L", Right = "charger_program.R", SimulationTime = "charger_program.T""#;

/// An address at which nobody listens now.
fn free() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    listener.local_addr().expect("an address")
}

/// What went from a PLC and to it.
type Wire = Arc<Mutex<[Vec<u8>; 2]>>;

/// What is done, once, with the bytes of a PLC.
#[derive(Clone, Copy)]
enum Trouble {
    None,
    /// The connection is closed after so many.
    Closed(usize),
    /// After so many, so many are left out.
    LeftOut(usize, usize),
}

/// Stands between a PLC that connects here and a gateway that listens at `gateway`, and writes down what passes.
fn between(gateway: SocketAddr, trouble: Trouble) -> (SocketAddr, Wire) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let (address, wire) = (listener.local_addr().expect("an address"), Wire::default());
    let noted = Arc::clone(&wire);
    std::thread::spawn(move || {
        let mut trouble = trouble;
        while let Ok((plc, _)) = listener.accept() {
            let server = loop {
                match TcpStream::connect(gateway) {
                    Ok(server) => break server,
                    Err(_) => std::thread::sleep(Duration::from_millis(5)),
                }
            };
            for side in [&plc, &server] {
                side.set_nodelay(true).expect("a socket");
            }
            let now = std::mem::replace(&mut trouble, Trouble::None);
            let (a, b, one, two) =
                (plc.try_clone().unwrap(), server.try_clone().unwrap(), Arc::clone(&noted), Arc::clone(&noted));
            let up = std::thread::spawn(move || carry(&a, &b, now, |bytes| one.lock().unwrap()[0].extend(bytes)));
            std::thread::spawn(move || {
                carry(&server, &plc, Trouble::None, |bytes| two.lock().unwrap()[1].extend(bytes));
            });
            up.join().expect("it carries");
        }
    });
    (address, wire)
}

fn carry(mut from: &TcpStream, mut to: &TcpStream, mut trouble: Trouble, note: impl Fn(&[u8])) {
    let (mut buffer, mut seen) = (vec![0; 64 * 1024], 0);
    while let Ok(count @ 1..) = from.read(&mut buffer) {
        let mut bytes = buffer[..count].to_vec();
        match trouble {
            Trouble::Closed(after) if seen + count > after => {
                bytes.truncate(after - seen);
                // The gateway may be gone already.
                let _ = to.write_all(&bytes);
                break;
            }
            Trouble::LeftOut(after, missing) if seen + count > after => {
                let start = after.saturating_sub(seen);
                bytes.drain(start..(start + missing).min(count));
                trouble = Trouble::None;
            }
            Trouble::None | Trouble::Closed(_) | Trouble::LeftOut(..) => {}
        }
        seen += count;
        note(&bytes);
        if to.write_all(&bytes).is_err() {
            break;
        }
    }
    // Either may be gone already.
    let _ = from.shutdown(Shutdown::Both);
    let _ = to.shutdown(Shutdown::Both);
}

/// The line with both PLCs as TCP clients; how their PLCs are started, and what is in the way of the lathe's.
fn run_line(until: &str, plc: &[&str], trouble: Trouble) -> (String, Said, [Vec<Vec<u8>>; 2]) {
    let gateways = [free(), free()];
    let urls = gateways.map(|address| format!("tcp-listen://{address}"));
    let folder = line([&urls[0], &urls[1]], "words");
    let run = begun(
        folder.path(),
        &["run", ".", "--format", "json", "--until", until, "--gateway", "charger", "--gateway", "lathe"],
    );
    let (charger, first) = between(gateways[0], Trouble::None);
    let (lathe, second) = between(gateways[1], trouble);
    let connected = |name: &str, address: SocketAddr| {
        let address = address.to_string();
        Plc::start(folder.path(), &[&["--client", name, "--tcp-connect", &address], plc].concat())
    };
    let _plcs = [connected("charger", charger), connected("lathe", lathe)];
    let said = Said::from(run.wait_with_output().expect("it ends"));
    assert_eq!(said.code, Some(0), "{said:?}");
    let report = serde_json::from_str(said.out.trim()).expect("a report");
    let frames = |wire: &Wire, machine: &Machine| {
        let noted = wire.lock().unwrap();
        [0, 1].map(|way| noted[way].chunks(machine.bytes[way]).map(<[u8]>::to_vec).collect::<Vec<_>>()).concat()
    };
    let frames = [frames(&first, &CHARGER), frames(&second, &LATHE)];
    (digests(&[report]).remove(0), said, frames)
}

fn in_process(until: &str) -> String {
    let folder = line(["tcp-listen://127.0.0.1:0"; 2], "words");
    let said = typed(folder.path(), &["run", ".", "--format", "json", "--until", until]);
    assert_eq!(said.code, Some(0), "{said:?}");
    digests(&[serde_json::from_str(said.out.trim()).expect("a report")]).remove(0)
}

/// 25 axes in lockstep, with every word in the reserve: the digest is that of one process, and each frame has the length
/// that the thesis gives.
#[test]
fn lockstep_needs_no_byte_more() {
    let expected = in_process("3s");
    let (digest, said, frames) = run_line("3s", &[], Trouble::None);
    assert_eq!(digest, expected, "{said:?}");
    for (frames, machine) in frames.iter().zip([CHARGER, LATHE]) {
        assert!(frames.len() > 600, "{}", frames.len());
        // The last ones may be under way when the run ends.
        let odd = frames.iter().filter(|frame| !machine.bytes.contains(&frame.len())).count();
        assert_eq!(odd, 0, "{}", machine.name);
    }
}

/// A PLC that sends every 10 ms, asked or not.
#[test]
fn a_plc_may_push() {
    let expected = in_process("500ms");
    let (digest, said, _) = run_line("500ms", &["--push", "10ms"], Trouble::None);
    assert_eq!(digest, expected, "{said:?}");
}

#[test]
fn a_plc_may_connect_again() {
    let expected = in_process("500ms");
    let (digest, said, _) = run_line("500ms", &[], Trouble::Closed(390 * 20 + 17));
    assert_eq!(digest, expected, "{said:?}");
    assert!(said.err.contains("closed after 17 of the 390 bytes of a block"), "{said:?}");
    assert!(said.err.contains("connection back"), "{said:?}");
}

/// Bytes are missing in mid-stream: it is reported, and nothing of it reaches the plant.
#[test]
fn a_stream_that_is_cut_wrongly_is_reported() {
    let expected = in_process("500ms");
    let (digest, said, _) = run_line("500ms", &[], Trouble::LeftOut(390 * 20 + 5, 7));
    assert_eq!(digest, expected, "{said:?}");
    assert!(said.err.contains("bits are set in the reserve, the first in byte"), "{said:?}");
    assert!(said.err.contains("the stream is cut in the wrong place"), "{said:?}");
}

/// A scenario whose gateways listen at these ports, and a peer in Python that connects to them.
fn with_peer(
    peer: &str,
    arguments: &[&str],
    ports: [SocketAddr; 2],
    folder: &Path,
    scenario: &str,
    until: &str,
) -> (Said, Said) {
    let peer = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/plc").join(peer);
    let words = ports.map(|address| address.port().to_string());
    let mut python = Command::new("python3");
    python.arg("-B").arg(peer).args(["--ports", &words[0], &words[1]]).args(arguments);
    let peer = python.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn();
    let gateways = ["charger", "lathe"].map(|plc| plc.to_owned() + "=tcp-listen://");
    let [charger, lathe] = [0, 1].map(|plc| format!("{}{}", gateways[plc], ports[plc]));
    let run = ["run", scenario, "--format", "json", "--until", until, "--gateway", &charger, "--gateway", &lathe];
    let said = typed(folder, &run);
    let peer = Said::from(peer.expect("Python is on the machine").wait_with_output().expect("it ends"));
    assert_eq!((said.code, peer.code), (Some(0), Some(0)), "{said:?} {peer:?}");
    (said, peer)
}

/// A peer that knows nothing of onescan but the thesis' frames drives both machines, a step for each of its frames.
#[test]
fn a_plc_that_is_not_instrumented_is_counted() {
    let ports = [free(), free()];
    let urls = ports.map(|address| format!("tcp-listen://{address}"));
    let folder = line([&urls[0], &urls[1]], "frames");
    let (said, peer) = with_peer("frames_plc.py", &[], ports, folder.path(), ".", "3s");
    assert!(said.err.contains("blocks counted: 300 steps, 300 blocks used"), "{said:?}");
    assert!(peer.out.contains("charger: axis 2 in position at 6300.0"), "{peer:?}");
    assert!(peer.out.contains("lathe: axis 6 in position at 2000.0"), "{peer:?}");
}

/// Two PLCs in Python, written from the thesis alone, drive the whole line: blocks come, are centred, peeled to their
/// cores, and nothing meets anything. They push every 4 ms of the wall clock, whatever has come.
#[test]
fn a_peer_drives_the_whole_line() {
    let ports = [free(), free()];
    let (said, peer) =
        with_peer("peeling_line_plcs.py", &["--push", "4"], ports, &scenario("peeling-line"), "frames.toml", "25s");
    assert!(said.err.contains("blocks counted: 2500 steps, 2500 blocks used"), "{said:?}");
    assert!(peer.out.contains("lathe: 1 peeled"), "{peer:?}");
    let run: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    let verdicts = run["expectations"].as_array().expect("expectations");
    assert_eq!(verdicts.len(), 4, "{said:?}");
}

/// The simulator pushes by its own clock, asked or not, and whoever watches the live link gets a frame for each of its steps.
/// How old what is known gets is the machine's business.
#[test]
fn the_live_link_is_watched() {
    let ports = [free(), free()];
    let [charger, lathe] = [("charger", 0), ("lathe", 1)].map(|(plc, at)| format!("{plc}=tcp-listen://{}", ports[at]));
    let words = ["run", "link-live.toml", "--mode", "freewheel", "--format", "json", "--until", "1s"];
    let run = begun(
        &scenario("peeling-line"),
        &[&words[..], &["--gateway", charger.as_str(), "--gateway", lathe.as_str()]].concat(),
    );
    let mut python = Command::new("python3");
    python.arg("-B").arg(scenario("peeling-line").join("link/live.py")).arg("--ports");
    let peer =
        Said::from(python.args(ports.map(|port| port.port().to_string())).output().expect("Python is on the machine"));
    let said = Said::from(run.wait_with_output().expect("it ends"));
    assert_eq!((said.code, peer.code), (Some(0), Some(0)), "{said:?} {peer:?}");
    let report: serde_json::Value = serde_json::from_str(said.out.trim()).expect("a report");
    let steps = report["steps"].as_u64().expect("steps");
    for plc in ["charger", "lathe"] {
        let row: Vec<&str> =
            peer.out.lines().find(|line| line.starts_with(plc)).expect("a row").split_whitespace().collect();
        let frames: u64 = row[1].parse().expect("a number");
        // The last ones may be under way when the run ends.
        assert!(frames.abs_diff(steps) <= 2, "{steps} steps: {peer:?}");
    }
}

/// The codec against `struct`: no difference in 10,000 frames of each kind, there and back.
#[test]
fn the_frames_are_those_of_the_standard_library_of_python() {
    let peer = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/plc/frames_plc.py");
    let output = Command::new("python3").arg("-B").arg(peer).args(["--print", "10000"]).output();
    let said = Said::from(output.expect("Python is on the machine"));
    assert_eq!(said.code, Some(0), "{said:?}");
    let text = std::fs::read_to_string(line(["tcp-listen://127.0.0.1:0"; 2], "frames").path().join("scenario.toml"));
    let table: toml::Table = text.expect("a scenario").parse().expect("TOML");
    let declared = table["clients"]["lathe"]["gateway"]["layout"].clone();
    let mut declaration: Declaration = declared.try_into().expect("a layout");
    (declaration.from_plc, declaration.to_plc) = (vec!["A: AxisCommand".into()], vec!["A: AxisFeedback".into()]);
    let feed = |field: &&str, ty| Feed::whole(&Port { name: SignalName::new(format!("A.{field}")).unwrap(), ty }, None);
    let feeds = |bits: &[&str], reals: &[&str]| -> Vec<Feed> {
        let bits = bits.iter().map(|field| feed(field, SignalType::BOOL));
        bits.chain(reals.iter().map(|field| feed(field, SignalType::REAL))).collect()
    };
    let commands = feeds(
        &["Execute", "Tracking", "TorqueControl", "SpeedControl", "Enable"],
        &["TargetPosition", "TargetSpeed", "TargetAcceleration", "TargetDeceleration", "TargetTorque"],
    );
    let feedback = feeds(&["Enabled", "InPosition"], &["ActualPosition", "ActualSpeed"]);
    let exchange = Exchange::new(&feedback, &commands, Words::Absent, &BTreeMap::new());
    let layouts = Layouts::new(&declaration, &exchange).expect("it fits");
    let mut compared = 0;
    for line in said.out.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let layout = if words[0] == "command" { &layouts.from_plc } else { &layouts.to_plc };
        let (frame, values) = (bytes(words[1]), bytes(words[2]));
        let (mut ours, mut back) = (vec![0; layout.size()], vec![0; values.len()]);
        layout.encode(&values, &mut ours);
        layout.decode(&frame, &mut back);
        assert_eq!((ours, back), (frame, values), "{line}");
        compared += 1;
    }
    assert_eq!(compared, 20_000);
}

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).expect("hexadecimal")).collect()
}

#[test]
fn what_cannot_be_is_reported() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let [here, beyond] = [format!("tcp-listen://{}", taken.local_addr().unwrap()), "tcp-listen://0.0.0.0:0".to_owned()];
    let run = |urls: [&str; 2], handshake: &str, words: &[&str]| {
        let folder = line(urls, handshake);
        let path = folder.path().join("scenario.toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let text = text.replace("handshake = \"", "reconnect_timeout = \"1s\"\nhandshake = \"");
        std::fs::write(&path, text).unwrap();
        typed(folder.path(), &[&["run", ".", "--until", "1s"], words].concat())
    };
    let nobody = "tcp-listen://127.0.0.1:0";
    let all = [
        (run([&here, nobody], "words", &["--gateway", "charger"]), 3, "cannot listen on tcp-listen://127.0.0.1:"),
        (
            run([&beyond, nobody], "words", &["--gateway", "charger"]),
            2,
            "would let other machines connect to 0.0.0.0:0",
        ),
        (
            run([nobody, nobody], "frames", &["--gateway", "charger"]),
            3,
            "no PLC has connected to tcp-listen://127.0.0.1:",
        ),
        (run([nobody, nobody], "words", &["--gateway", "charger=tcp-listen://plc"]), 2, "it has no IP address and"),
        (run([nobody, nobody], "frames", &["--gateway", "charger=modbus://127.0.0.1"]), 2, "modbus has none"),
        (run([nobody, nobody], "words", &["--gateway", "charger=s7://127.0.0.1"]), 2, "`SDSP_Session` is in parts"),
    ];
    for (said, code, text) in all {
        assert_eq!(said.code, Some(code), "{said:?}");
        assert!(said.err.contains(text), "{text}: {said:?}");
    }
    let folder = line([nobody; 2], "frames");
    let said = typed(folder.path(), &["plc", ".", "--client", "lathe"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("the blocks of this PLC are counted"), "{said:?}");
}

/// The map has every part, and what it writes is read again.
#[test]
fn a_map_shows_words_in_parts() {
    let folder = line(["tcp-listen://127.0.0.1:2000", "tcp-listen://127.0.0.1:2001"], "words");
    let said = typed(folder.path(), &["map", ".", "--client", "charger"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.out.contains("81+91+101+111") && said.out.contains("134 bytes"), "{said:?}");
    edit(folder.path(), "scenario.toml", "\"81+91+101+111\"", "\"81+91+101+101\"");
    let said = onescan(folder.path()).args(["map", ".", "--client", "charger"]).output().unwrap().into();
    let Said { err, code, .. } = said;
    assert_eq!(code, Some(2), "{err}");
    assert!(err.contains("which has a bit twice"), "{err}");
}
