//! Strangers at the doors of a session: however many come and say nothing, it goes on, and who speaks is served.
#![cfg(unix)]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::json;

use crate::typed::{onescan, scenario, typed};
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
