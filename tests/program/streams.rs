//! A program of TwinCAT's on a serial line to a device in Python, and its files.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::typed::{digests, onescan, typed};

const SCENARIO: &str = r#"version = 1
step = "2ms"
until = "1200ms"

[signals]
Ask = { type = "BYTES[64]", writer = "plc" }
Answer = { type = "BYTES[64]", writer = "scale" }
Got = { type = "DINT", writer = "plc" }
Last = { type = "BYTE", writer = "plc" }

[clients.plc]
kind = "soft-plc"
sources = ["main.st"]
dialect = "twincat"
tasks = [
    { name = "fast", interval = "2ms", priority = 0, programs = ["Fast"] },
    { name = "main", interval = "10ms", priority = 1, programs = ["Main"] },
]

[clients.plc.ports.scale]
receive = "Answer"
transmit = "Ask"
serial = { input = "comIn", output = "comOut" }

[clients.scale]
kind = "external"
command = ["python3", "-B", "scale.py", "--server", "{server}"]

[[expect]]
name = "the whole line is received"
formula = "eventually[0s, 1s] Got = 258"
"#;

/// The command is the first line of a file; the answer is 258 bytes.
const PROGRAM: &str = "VAR_GLOBAL tx, rx : ComBuffer; comIn : KL6inData22B; comOut : KL6outData22B; END_VAR
PROGRAM Fast
VAR line : SerialLineControl; END_VAR
    line(Mode := SERIALLINEMODE_EL6_22B, pComIn := ADR(comIn), pComOut := ADR(comOut), SizeComIn := SIZEOF(comIn),
        TxBuffer := tx, RxBuffer := rx);
END_PROGRAM
PROGRAM Main
VAR_OUTPUT Got : DINT; Last : BYTE; END_VAR
VAR open : FB_FileOpen; line : FB_FileGets; send : SendString255; get : ReceiveByte; sent : BOOL; END_VAR
    open(sPathName := 'C:\\TwinCAT\\commands.txt', nMode := FOPEN_MODEREAD OR FOPEN_MODETEXT, bExecute := TRUE);
    line(hFile := open.hFile, bExecute := open.hFile <> 0);
    IF line.sLine <> '' AND NOT sent THEN
        send(SendString := line.sLine, TxBuffer := tx);
        sent := NOT send.Busy;
    END_IF
    WHILE rx.Count > 0 DO
        get(RxBuffer := rx);
        Last := get.ReceivedByte;
        Got := Got + 1;
    END_WHILE
END_PROGRAM
";

const SCALE: &str = r#"from onescan_client import Input, Output, SerialPort, Simulation


class Scale(Simulation):
    Ask: Input[str] = Input("BYTES[64]")
    Answer: Output[str] = Output("BYTES[64]")

    def start(self) -> None:
        self.port = {}

    def step(self) -> None:
        port = SerialPort(self.port, 64)
        port.arrive(self.t_ns, self.Ask)
        if port.received.endswith(b"W\n"):
            port.take(2)
            port.send(bytes(number % 256 for number in range(258)))
        self.Answer = port.depart(self.t_ns, self.Ask)


Scale("scale").main()
"#;

fn scenario() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("files")).expect("a folder");
    let files = [
        ("scenario.toml", SCENARIO),
        ("main.st", PROGRAM),
        ("scale.py", SCALE),
        ("files/commands.txt", "W\r\nignored\r\n"),
    ];
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

fn package() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../clients/python/src")
}

#[test]
fn a_device_in_python_answers_a_program_that_knows_its_vendor_s_blocks_alone() {
    let folder = scenario();
    let run = |more: &[&str]| {
        let words = ["run", ".", "--format", "json"];
        let output =
            onescan(folder.path()).args(words).args(more).env("PYTHONPATH", package()).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let lines = String::from_utf8(output.stdout).expect("text");
        digests(&lines.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect::<Vec<Value>>())
    };
    let whole = run(&[]);
    assert_eq!(run(&["--runs", "2"])[0], whole[0]);
    run(&["--until", "336ms", "--save-at", "334ms", "--save", "half"]);
    assert_eq!(run(&["--resume", "half"]), whole);
}

#[test]
fn what_is_wrong_with_a_port_is_said_at_its_client() {
    let wrong = [
        ("receive = \"Answer\"", "receive = \"Answr\""),
        ("receive = \"Answer\"", "receive = \"Got\""),
        ("transmit = \"Ask\"", "transmit = \"Answer\""),
        ("input = \"comIn\"", "input = \"comInn\""),
        ("input = \"comIn\"", "input = \"tx\""),
        ("{ input", "{ baud = 921600, input"),
        ("{ input", "{ terminal = \"EL1008\", input"),
        ("serial = { input = \"comIn\", output = \"comOut\" }", "tcp = { address = \"here\" }"),
        ("serial = { input = \"comIn\", output = \"comOut\" }", "tcp = { address = \"10.0.0.1:2727\" }"),
        ("serial = { input = \"comIn\", output = \"comOut\" }", ""),
    ];
    let reported = wrong.map(|(from, to)| {
        let folder = scenario();
        std::fs::write(folder.path().join("scenario.toml"), SCENARIO.replacen(from, to, 1)).expect("a file");
        let said = typed(folder.path(), &["run", "."]);
        assert_eq!(said.code, Some(2), "{to}: {}", said.err);
        said.err
    });
    insta::assert_snapshot!(reported.join("\n"));
}

#[test]
fn a_line_can_be_silent_and_a_number_cannot() {
    let folder = scenario();
    let case = |signal: &str, kind: &str| {
        let case =
            format!("version = 1\n[[case]]\nname = \"quiet\"\n[[case.disturbance]]\nsignal = \"{signal}\"\n{kind}\n");
        std::fs::write(folder.path().join("cases.toml"), case).expect("a file");
        let words = ["run", ".", "--case", "quiet"];
        let output = onescan(folder.path()).args(words).env("PYTHONPATH", package()).output().expect("it runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(
        case("Answer", "kind = \"silent\"\nfrom = \"200ms\"\nfor = \"5ms\"").0,
        Some(1),
        "a line is short of bytes"
    );
    assert_eq!(case("Answer", "kind = \"lost\"\nrate = 0.01").0, Some(1));
    assert_eq!(case("Answer", "kind = \"flipped\"\nrate = 0.5").0, Some(0), "bytes are wrong and none is missing");
    let (code, said) = case("Got", "kind = \"silent\"");
    assert_eq!(code, Some(2));
    assert!(said.contains("`Got` is DINT, which cannot be silent"), "{said}");
}

#[test]
fn files_that_a_program_has_written_are_there_after_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = "version = 1
step = \"10ms\"
until = \"1s\"
[signals]
Steps = { type = \"INT\", writer = \"plc\" }
[clients.plc]
kind = \"soft-plc\"
dialect = \"twincat\"
sources = [\"main.st\"]
tasks = [{ name = \"main\", interval = \"10ms\", programs = [\"Main\"] }]
";
    let program = "PROGRAM Main
VAR_OUTPUT Steps : INT; END_VAR
VAR open : FB_FileOpen; put : FB_FilePuts; close : FB_FileClose; END_VAR
    Steps := Steps + 1;
    open(sPathName := 'C:\\TwinCAT\\log.txt', nMode := FOPEN_MODEWRITE OR FOPEN_MODETEXT, bExecute := Steps >= 2);
    put(hFile := open.hFile, sLine := 'first$Nsecond$N', bExecute := Steps >= 5);
    close(hFile := open.hFile, bExecute := Steps >= 8);
END_PROGRAM
";
    for (name, text) in [("scenario.toml", scenario), ("main.st", program)] {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let said = typed(folder.path(), &["run", ".", "--files", "out"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let log = std::fs::read_to_string(folder.path().join("out/plc/log.txt")).expect("a file");
    assert_eq!(log, "first\r\nsecond\r\n");
    let far = typed(folder.path(), &["run", ".", "--files", "far", "--transport", "tcp"]);
    assert_eq!(far.code, Some(2), "{far:?}");
    assert!(far.err.contains("`plc` showed no memory"), "{far:?}");
}
