//! Strangers at the doors of a session: however many come and say nothing, it goes on, and who speaks is served.
#![cfg(unix)]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::json;

use crate::typed::{digests, onescan, run_shear, scenario, typed};
use crate::web::{Served, ask, received};

/// `onescan` with so few descriptors that strangers could take them all.
fn with_few_descriptors(folder: &Path, words: &[&str]) -> std::process::Child {
    let plain = onescan(folder);
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -n 256 && exec \"$0\" \"$@\""]).arg(plain.get_program()).args(words);
    command.current_dir(folder).env_remove("ONESCAN_LOG").env("NO_COLOR", "1");
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// Strangers who say no more than this.
fn strangers(address: &str, count: usize, what: &[u8]) -> Vec<TcpStream> {
    let come = |_| {
        // One that is sent away again has been no harm.
        let mut stream = TcpStream::connect(address).ok()?;
        stream.write_all(what).ok()?;
        Some(stream)
    };
    (0..count).filter_map(come).collect()
}

#[test]
fn idle_strangers_neither_end_a_session_nor_keep_viewers_out() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let words =
        ["run", ".", "--format", "json", "--until", "1h", "--record", out.to_str().unwrap(), "--pace", "1", "--web"];
    let served = Served::of(with_few_descriptors(&scenario("shear"), &words));
    let mut first = served.view();
    let idle = strangers(&served.address, 400, b"");
    let halves = strangers(&served.address, 200, b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n");
    let bodies =
        strangers(&served.address, 200, b"POST /api/login HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\n\r\n");
    let (status, _) = served.get("/api/session", &[]);
    assert_eq!(status, "HTTP/1.1 200 OK");
    let mut second = served.view();
    for viewer in [&mut first, &mut second] {
        received(viewer, "status");
    }
    ask(&mut first, &json!({"type": "operate", "operation": "stop"}));
    drop((idle, halves, bodies));
    assert_eq!(served.report()["status"], "stopped");
    assert!(out.join("run-1/run.json").is_file(), "the recording is whole");
}

/// Whether anybody wants a picture is looked at before one is read.
#[test]
fn a_picture_that_nobody_wants_is_not_read() {
    let served = Served::begin("shear", &["--until", "1h"]);
    let mut stream = TcpStream::connect(&served.address).unwrap();
    stream.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
    let head = format!("POST /api/picture HTTP/1.1\r\nHost: {}\r\nContent-Length: 268435456\r\n\r\n", served.address);
    stream.write_all(head.as_bytes()).unwrap();
    let mut answer = [0; 64];
    let count = stream.read(&mut answer).unwrap();
    assert!(answer[..count].starts_with(b"HTTP/1.1 404 "), "{}", String::from_utf8_lossy(&answer[..count]));
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
}

/// A chunk that says nothing of OPC UA, or nothing at all, is no client; the PLC that speaks it is let in.
#[test]
fn strangers_do_not_keep_opc_ua_clients_out() {
    let words = [
        "run",
        ".",
        "--format",
        "json",
        "--until",
        "1s",
        "--opcua",
        "127.0.0.1:0",
        "--opcua-client",
        "plc",
        "--join-timeout",
        "2min",
    ];
    let mut program = with_few_descriptors(&scenario("shear"), &words);
    let mut said = std::io::BufReader::new(program.stderr.take().expect("piped"));
    let mut line = String::new();
    std::io::BufRead::read_line(&mut said, &mut line).expect("it speaks");
    let address = line.trim().rsplit("opc.tcp://").next().and_then(|rest| rest.split('/').next()).expect("an address");
    let idle = strangers(address, 400, b"");
    let hellos = strangers(address, 100, b"HELF\x40\0\0\0");
    // A whole HELLO: the server acknowledges it.
    let mut client = TcpStream::connect(address).expect("let in");
    client.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
    let url = format!("opc.tcp://{address}");
    let mut hello = b"HELF".to_vec();
    hello.extend(u32::try_from(32 + url.len()).unwrap().to_le_bytes());
    for number in [0_u32, 65_536, 65_536, 0, 0, u32::try_from(url.len()).unwrap()] {
        hello.extend(number.to_le_bytes());
    }
    hello.extend(url.as_bytes());
    client.write_all(&hello).unwrap();
    let mut kind = [0; 3];
    client.read_exact(&mut kind).expect("an answer");
    assert_eq!(&kind, b"ACK");
    drop((idle, hellos));
    program.kill().expect("it runs");
    program.wait().expect("it ends");
}

/// Beyond this machine anybody could read and write.
#[test]
fn open_opc_ua_beyond_this_machine_is_said() {
    let words = ["run", ".", "--until", "20ms", "--opcua", "0.0.0.0:0"];
    let said = typed(&scenario("shear"), &words);
    assert!(said.code == Some(0) && said.err.contains("is open to anybody who reaches this machine"), "{said:?}");
    let own = typed(&scenario("shear"), &["run", ".", "--until", "20ms", "--opcua", "127.0.0.1:0"]);
    assert!(own.code == Some(0) && !own.err.contains("is open to anybody"), "{own:?}");
}

/// `onescan plc` whose standard error nobody reads, and where it serves.
struct Unread {
    plc: std::process::Child,
    urls: Vec<String>,
}

impl Unread {
    fn start(words: &[&str]) -> Self {
        let mut command = onescan(&scenario("shear"));
        command.args(["plc", "."]).args(words);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut plc = command.spawn().expect("the program starts");
        let said = std::io::BufReader::new(plc.stdout.as_mut().expect("piped"));
        let lines = std::io::BufRead::lines(said).map(|line| line.expect("it speaks"));
        let urls = lines.map_while(|line| line.strip_prefix("serving ").map(str::to_owned)).collect();
        Self { plc, urls }
    }

    fn url(&self, scheme: &str) -> &str {
        self.urls.iter().find(|url| url.starts_with(scheme)).expect("it serves this")
    }

    fn address(&self, scheme: &str) -> &str {
        self.url(scheme).rsplit("://").next().expect("an address")
    }

    /// The digest of a run of a second with this PLC.
    fn digest(&self, scheme: &str) -> String {
        let gateway = format!("plc={}", self.url(scheme));
        let (reports, said) = run_shear(&["--until", "1s", "--gateway", &gateway]);
        assert_eq!(said.code, Some(0), "{scheme} {said:?}");
        digests(&reports).remove(0)
    }

    /// Ends it and gives what it said of those who came.
    fn log(mut self) -> String {
        self.plc.kill().expect("it runs");
        let mut log = String::new();
        self.plc.stderr.take().expect("piped").read_to_string(&mut log).expect("text");
        self.plc.wait().expect("it ends");
        log
    }
}

/// However many connect to a PLC and say nothing, the gateway has it, also while it drives the PLC.
#[test]
fn strangers_do_not_keep_a_gateway_from_its_plc() {
    let expected = digests(&run_shear(&["--until", "1s"]).0).remove(0);
    let plc = Unread::start(&[]);
    for scheme in ["tcp://", "s7://", "modbus://", "ads://"] {
        let address = plc.address(scheme).to_owned();
        let before = strangers(&address, 100, b"");
        let during = std::thread::spawn(move || strangers(&address, 200, b""));
        assert_eq!(plc.digest(scheme), expected, "{scheme}");
        drop((before, during.join().expect("strangers")));
    }
    drop(plc.log());
}

/// Nobody reads its log, which each connection would fill with a line.
#[test]
fn a_log_that_nobody_reads_does_not_end_a_plc() {
    let plc = Unread::start(&["--tcp", "127.0.0.1:0"]);
    for _ in 0..1_500 {
        drop(strangers(plc.address("tcp://"), 1, b"x"));
    }
    plc.digest("tcp://");
    let log = plc.log();
    assert!(log.lines().count() < 30, "{log}");
    assert!(log.contains("closed after 1 of the") && log.contains("reported again after"), "{log}");
}

/// The system has no thread to give: an error says so, and what the exit code is. A stack of this size can be had nowhere.
#[test]
fn where_there_are_no_threads_an_error_names_them() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("out");
    let commands: [&[&str]; 5] = [
        &["plc", ".", "--s7", "127.0.0.1:0"],
        &["test", "."],
        &["run", ".", "--until", "20ms", "--record", record.to_str().unwrap()],
        &["run", ".", "--until", "20ms", "--listen", "127.0.0.1:0"],
        &["run", ".", "--until", "20ms", "--web"],
    ];
    for words in commands {
        let mut command = onescan(&scenario("shear"));
        let said = command.args(words).env("RUST_MIN_STACK", (1_u64 << 60).to_string()).output().unwrap();
        let said = crate::typed::Said::from(said);
        assert_eq!(said.code, Some(3), "{words:?} {said:?}");
        // A long line is broken.
        let all = format!("{}{}", said.out, said.err).replace("\n  │ ", " ");
        assert!(all.contains("cannot start the thread `") && !all.contains("panicked"), "{words:?} {said:?}");
    }
}

/// What the system has no more of is not the mistake of who typed the command.
#[test]
fn too_many_open_files_are_a_fault() {
    let folder = scenario("shear");
    let program = onescan(&folder);
    let mut codes = std::collections::BTreeSet::new();
    for descriptors in 4..24 {
        let mut command = Command::new("sh");
        let limited = format!("ulimit -n {descriptors} && exec \"$0\" \"$@\"");
        command.args(["-c", &limited]).arg(program.get_program()).args(["run", ".", "--until", "20ms"]);
        command.args(["--listen", "127.0.0.1:0", "--web", "--join-timeout", "1s"]).current_dir(&folder);
        let said = crate::typed::Said::from(command.env("NO_COLOR", "1").output().unwrap());
        let all = format!("{}{}", said.out, said.err);
        assert!(!all.contains("panicked"), "{descriptors}: {said:?}");
        assert!(!all.contains("Too many open files") || said.code != Some(2), "{descriptors}: {said:?}");
        codes.insert(said.code);
    }
    assert!(codes.contains(&Some(3)), "none of them was short of descriptors: {codes:?}");
}

/// A task of a long interval sleeps, and hears that the program is to end.
#[test]
fn a_long_sleep_of_a_free_wheeling_plc_hears_a_signal() {
    let folder = crate::typed::copied_shear();
    crate::typed::edit(folder.path(), "scenario.toml", "interval = \"10ms\"", "interval = \"1000000000s\"");
    let mut run = crate::typed::begun(folder.path(), &["run", ".", "--mode", "freewheel", "--until", "20ms"]);
    std::thread::sleep(Duration::from_secs(2));
    assert!(run.try_wait().unwrap().is_none(), "it sleeps");
    assert!(Command::new("kill").args(["-TERM", &run.id().to_string()]).status().unwrap().success());
    let began = std::time::Instant::now();
    let said = crate::typed::Said::from(run.wait_with_output().unwrap());
    assert_eq!(said.code, Some(143), "{said:?}");
    assert!(began.elapsed() < Duration::from_secs(30), "it has heard it");
}

/// Who connects where a PLC is expected and says nothing gives its seat to the PLC.
#[test]
fn a_silent_stranger_does_not_keep_a_plc_out() {
    let listening = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listening.local_addr().unwrap().to_string();
    drop(listening);
    let gateway = format!("plc=tcp-listen://{address}");
    let words = ["run", ".", "--format", "json", "--until", "1s", "--gateway", &gateway];
    let run = crate::typed::begun(&scenario("shear"), &words);
    let began = std::time::Instant::now();
    let stranger = loop {
        if let Ok(stranger) = TcpStream::connect(&address) {
            break stranger;
        }
        assert!(began.elapsed() < Duration::from_mins(1), "it listens");
        std::thread::sleep(Duration::from_millis(20));
    };
    let plc = crate::plc::Plc::start(&scenario("shear"), &["--tcp-connect", &address]);
    let said = crate::typed::Said::from(run.wait_with_output().unwrap());
    assert_eq!(said.code, Some(0), "{said:?}");
    drop((stranger, plc));
}

/// Each fork is a process of its own.
#[test]
fn a_viewer_has_so_many_forks_and_no_more() {
    let served = Served::begin("shear", &["--until", "1h", "--pace", "50", "--forks", "2"]);
    let mut viewer = served.view();
    let mut answers = Vec::new();
    while answers.len() < 3 {
        ask(&mut viewer, &json!({"type": "fork", "t_ns": 500_000_000}));
        let answer = loop {
            let Ok(tungstenite::Message::Text(text)) = viewer.read() else { continue };
            let answer: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            if answer["type"] == "forked" || answer["type"] == "error" {
                break answer.to_string();
            }
        };
        // The session may not have come so far yet.
        if !answer.contains("not a moment of the past") {
            answers.push(answer);
        }
    }
    assert!(answers[..2].iter().all(|answer| answer.contains("forked")), "{answers:?}");
    assert!(answers[2].contains("2 forks of this session run already"), "{answers:?}");
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
}

/// A step that somebody mistyped would run for days without a word.
#[test]
fn a_run_of_days_is_announced() {
    let folder = crate::typed::copied_shear();
    crate::typed::edit(folder.path(), "scenario.toml", "step = \"10ms\"", "step = \"1ns\"");
    let mut run = crate::typed::begun(folder.path(), &["run", ".", "--until", "1h"]);
    let mut said = std::io::BufReader::new(run.stderr.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("this run has 3600000000000 steps of 1 ns") {
        line.clear();
        assert_ne!(std::io::BufRead::read_line(&mut said, &mut line).expect("text"), 0, "it is not said");
    }
    run.kill().expect("it runs");
    run.wait().expect("it ends");
}
