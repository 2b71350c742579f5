//! Processes that end when they must: those of a session with it, a test at its limit, a program that is interrupted.
#![cfg(unix)]

use std::io::Read as _;
use std::process::{Command, Stdio};

use crate::typed::{begun, copied_shear, edit, onescan, typed};

/// The shear with a PLC that is a command.
fn shear_with(command: &str) -> tempfile::TempDir {
    let folder = copied_shear();
    let text = std::fs::read_to_string(folder.path().join("scenario.toml")).unwrap();
    let (start, end) = (text.find("[clients.plc]").unwrap(), text.find("[[expect]]").unwrap());
    let plc = format!("[clients.plc]\nkind = \"external\"\ncommand = {command}\n\n");
    std::fs::write(folder.path().join("scenario.toml"), format!("{}{plc}{}", &text[..start], &text[end..])).unwrap();
    folder
}

/// Who hears of the session's end writes to its standard error, which is at its end when all of them have ended.
#[test]
fn when_a_session_is_killed_its_processes_end_and_theirs() {
    let folder = shear_with(r#"["sh", "-c", "sleep 300 & echo started >&2; sleep 300"]"#);
    let mut session = begun(folder.path(), &["run", ".", "--join-timeout", "1h"]);
    let mut said = session.stderr.take().unwrap();
    let (mut heard, mut piece) = (Vec::new(), [0; 256]);
    while !String::from_utf8_lossy(&heard).contains("started") {
        let count = said.read(&mut piece).unwrap();
        assert!(count > 0, "{}", String::from_utf8_lossy(&heard));
        heard.extend_from_slice(&piece[..count]);
    }
    session.kill().unwrap();
    session.wait().unwrap();
    said.read_to_end(&mut heard).unwrap();
}

#[test]
fn when_a_session_ends_the_processes_of_its_processes_end() {
    let folder = shear_with(r#"["sh", "-c", "sleep 300 & exec sleep 300"]"#);
    // The pipe of its standard error is at its end when nobody has it any more.
    let said = typed(folder.path(), &["run", ".", "--join-timeout", "100ms"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("did not join"), "{said:?}");
}

#[test]
fn a_test_ends_at_its_limit() {
    let folder = shear_with("[]");
    std::fs::remove_file(folder.path().join("cases.toml")).unwrap();
    let said = typed(folder.path(), &["test", ".", "--timeout", "1ms", "--junit", "junit.xml"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    let message = "not done within 1 ms, which is the limit: it was ended (see `--timeout`)";
    assert!(said.out.contains(message), "{said:?}");
    assert!(std::fs::read_to_string(folder.path().join("junit.xml")).unwrap().contains("not done within 1 ms"));
}

/// While there is no session yet, nobody else would hear of it.
#[test]
fn a_program_that_compiles_is_interrupted_at_once() {
    let folder = copied_shear();
    let statements = "n := n + SIN(n) * 1.1;\n".repeat(200_000);
    let more = format!("PROGRAM More VAR n : LREAL; END_VAR\n{statements}END_PROGRAM\n");
    std::fs::write(folder.path().join("plc/more.st"), more).unwrap();
    edit(folder.path(), "scenario.toml", "\"plc/alignment.st\"", "\"plc/alignment.st\", \"plc/more.st\"");
    let mut run = begun(folder.path(), &["run", "."]);
    let process = run.id().to_string();
    while run.try_wait().unwrap().is_none() {
        // It may have ended just now.
        let _ = Command::new("kill").args(["-INT", &process]).stderr(Stdio::null()).status().unwrap();
    }
    let said = crate::typed::Said::from(run.wait_with_output().unwrap());
    assert_eq!(said.out, "");
    assert!(matches!(said.code, Some(130) | None), "{said:?}");
}

#[test]
fn what_is_not_a_file_is_refused_at_once() {
    let folder = copied_shear();
    let path = folder.path().join("plc/alignment.st");
    std::fs::remove_file(&path).unwrap();
    assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
    let fifo = typed(folder.path(), &["run", "."]);
    assert_eq!(fifo.code, Some(2), "{fifo:?}");
    assert!(fifo.err.contains("it is a device or a pipe, not a file"), "{fifo:?}");
    std::fs::remove_file(&path).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
    for words in [&["run", "."][..], &["check", "plc/alignment.st"], &["test", "plc/alignment.st"]] {
        let device = typed(folder.path(), words);
        assert_eq!(device.code, Some(2), "{device:?}");
        let said = [&device.err, &device.out];
        let is_refused = |why: &str| said.iter().any(|text| text.contains(why));
        assert!(is_refused("a device or a pipe") || is_refused("outside of the scenario's folder"), "{device:?}");
    }
}

/// A limit of the shell's on the size of a file is like a disk that is full.
#[test]
fn a_recording_that_finds_no_room_says_what_is_kept() {
    let folder = copied_shear();
    let program = onescan(folder.path()).get_program().to_owned();
    let script = "trap '' XFSZ; ulimit -f 40; exec \"$0\" run . --until 1000s --record out --record-also csv";
    let mut shell = Command::new("bash");
    shell.current_dir(folder.path()).env("NO_COLOR", "1").args(["-c", script]).arg(program);
    let said = crate::typed::Said::from(shell.output().unwrap());
    assert_eq!(said.code, Some(3), "{said:?}");
    let words = said.err.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("cannot write out/run-1") && words.contains("steps 0 to "), "{said:?}");
}

#[test]
fn an_earlier_recording_is_replaced_only_if_that_is_asked_for() {
    let folder = copied_shear();
    let record = |until: &str, more: &[&str]| {
        typed(folder.path(), &[&["run", ".", "--until", until, "--record", "out"], more].concat())
    };
    assert_eq!(record("200ms", &[]).code, Some(0));
    let before = std::fs::read(folder.path().join("out/run-1/run.json")).unwrap();
    let refused = record("100ms", &[]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.err.contains("out/run-1 holds an earlier recording") && refused.err.contains("--overwrite"));
    assert_eq!(std::fs::read(folder.path().join("out/run-1/run.json")).unwrap(), before);
    assert_eq!(record("100ms", &["--overwrite"]).code, Some(0));
    assert_ne!(std::fs::read(folder.path().join("out/run-1/run.json")).unwrap(), before);
}
