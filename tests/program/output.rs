//! Where output goes: readers that leave early, disks that are full.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::File;
use std::io::pipe;
use std::process::Stdio;

use crate::typed::{Said, WROTE, begun, copied_shear, onescan, scenario, typed};

#[test]
fn a_reader_that_has_left_is_not_a_failure() {
    for words in [&["explain", "--list"][..], &["run", ".", "--until", "100ms"], &["run", ".", "--format", "json"]] {
        let (reader, writer) = pipe().expect("a pipe");
        drop(reader);
        let output = onescan(&scenario("shear")).args(words).stdout(writer).output().expect("the program starts");
        let said = Said::from(output);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{words:?}");
    }
}

/// Whoever reads the first lines only, or none, does not make a verdict a better one.
#[test]
fn a_verdict_stays_what_it_is_when_the_reader_has_left() {
    let folder = copied_shear();
    let code = |words: &[&str]| {
        let (reader, writer) = pipe().expect("a pipe");
        drop(reader);
        let output = onescan(folder.path()).args(words).stdout(writer).output().expect("the program starts");
        Said::from(output).code
    };
    let path = folder.path().join("scenario.toml");
    let violated = "\n[[expect]]\nname = \"no strokes\"\nformula = \"always (Strokes < 0)\"\n";
    std::fs::write(&path, std::fs::read_to_string(&path).expect("a file") + violated).expect("a file");
    for words in [&["test", "."][..], &["test", ".", "--format", "json"], &["run", "."]] {
        assert_eq!((typed(folder.path(), words).code, code(words)), (Some(1), Some(1)), "{words:?}");
    }
    std::fs::write(folder.path().join("wrong.st"), "PROGRAM Main\nx := 1;\nEND_PROGRAM\n").expect("a file");
    for words in [&["check", "wrong.st"][..], &["test", "wrong.st"]] {
        let read = typed(folder.path(), words).code;
        assert_ne!(read, Some(0), "{words:?}");
        assert_eq!(code(words), read, "{words:?}");
    }
}

/// A signal ends what has no end of its own to report: one line says how far it has got.
#[cfg(unix)]
#[test]
fn who_is_interrupted_says_how_far_it_has_got() {
    let interrupted = |words: &[&str], until: &dyn Fn(&mut dyn std::io::Read)| {
        let mut child = begun(&scenario("shear"), words);
        let mut err = child.stderr.take().expect("piped");
        until(&mut err);
        let id = child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().expect("kill").success());
        let mut said = String::new();
        std::io::Read::read_to_string(&mut err, &mut said).expect("text");
        (child.wait().expect("it ends").code(), said)
    };
    let line = |err: &mut dyn std::io::Read| {
        let mut byte = [0];
        while err.read(&mut byte).expect("text") == 1 && byte[0] != b'\n' {}
    };
    let (code, said) = interrupted(&["edit", "."], &line);
    assert_eq!((code, said.as_str()), (Some(130), "stopped after 0 changes in its files\n"));
    let soon = |_: &mut dyn std::io::Read| std::thread::sleep(std::time::Duration::from_secs(1));
    // It may not have come to its first run.
    let (code, said) =
        interrupted(&["explore", "race.toml", "--until", "10min", "--all", "--bound", "3", "--no-merge"], &soon);
    assert!(code == Some(130) && said.contains("stopped after ") && said.contains(" run"), "{code:?} {said}");
    let folder = tempfile::tempdir().expect("a folder");
    let endless =
        "PROGRAM TEST_long\nVAR n : DINT; END_VAR\nVAR_OUTPUT Done : BOOL; END_VAR\nn := n + 1;\nEND_PROGRAM\n";
    let path = folder.path().join("long.st");
    std::fs::write(&path, endless).expect("a file");
    let words = ["test", path.to_str().expect("UTF-8"), "--scan", "1us", "--until", "100h"];
    let (code, said) = interrupted(&words, &soon);
    assert_eq!(code, Some(130), "{said}");
    assert!(said.lines().last().is_some_and(|line| line == "stopped after 0 of 1 test"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_fault_and_not_wrong_input() {
    for words in [&["explain", "--list"][..], &["explain", "N0101"], &["run", ".", "--until", "100ms"]] {
        let full = File::options().write(true).open("/dev/full").expect("Linux has it");
        let output = onescan(&scenario("shear")).args(words).stdout(full).output().expect("the program starts");
        let said = Said::from(output);
        assert_eq!(said.code, Some(3), "{words:?}: {said:?}");
        assert!(said.err.contains("cannot write the report: No space left on device"), "{said:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_picture_that_cannot_be_written_is_a_fault_and_leaves_nothing() {
    let folder = copied_shear();
    let names = || -> BTreeSet<OsString> {
        std::fs::read_dir(folder.path()).expect("a folder").flatten().map(|entry| entry.file_name()).collect()
    };
    let before = names();
    // No file may grow, as on a full disk; the signal that comes with it is not taken.
    let program = onescan(folder.path());
    let limited = format!(
        "trap '' XFSZ; ulimit -f 0; exec '{}' run . --until 100ms --plot plot.svg",
        program.get_program().to_string_lossy()
    );
    let output = std::process::Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", &limited])
        .env("NO_COLOR", "1")
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    let said = Said::from(output);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("plot.svg: File too large"), "{said:?}");
    assert_eq!(names(), before);
}

/// Nobody waits for a run whose report has no place: what is to be written is looked at before.
#[test]
fn a_path_that_cannot_be_is_wrong_input_before_anything_runs() {
    let folder = copied_shear();
    std::fs::write(folder.path().join("file"), "").expect("written");
    for (words, message) in [
        (
            &["run", "--plot", "no/such/plot.svg"][..],
            "no/such/plot.svg: `no/such` is not there, make this folder first",
        ),
        (&["run", "--html", "plc"], "plc: this is a folder, name a file in it"),
        (&["run", "--coverage", "file/x.xml"], "file/x.xml: `file` is not a folder"),
        (&["run", "--maps", "file/maps"], "file/maps: `file` is not a folder"),
        (&["test", "--junit", "no/junit.xml"], "no/junit.xml: `no` is not there"),
        (&["compare", "--plot", "no/plot.svg"], "no/plot.svg: `no` is not there"),
        (&["campaign", "--html", "no/page.html"], "no/page.html: `no` is not there"),
        (&["falsify", "--cases", "no/cases.toml"], "no/cases.toml: `no` is not there"),
    ] {
        let said = Said::from(onescan(folder.path()).args(words).output().expect("the program starts"));
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}: {said:?}");
        assert!(said.err.contains(message), "{words:?}: {said:?}");
    }
}

/// Each file that was asked for is named when it is there, in the order in which they are written.
#[test]
fn what_was_written_is_said() {
    let folder = copied_shear();
    let written = |words: &[&str]| -> Vec<String> {
        let output = onescan(folder.path()).args(words).output().expect("the program starts");
        let err = String::from_utf8(output.stderr).expect("text");
        err.lines().filter_map(|line| line.strip_prefix(WROTE)).map(str::to_owned).collect()
    };
    let run = [
        "run",
        "--until",
        "100ms",
        "--plot",
        "run.svg",
        "--html",
        "run.html",
        "--record",
        "out",
        "--coverage",
        "c.xml",
    ];
    assert_eq!(written(&run), ["c.xml", "run.svg", "run.html", "out"]);
    assert_eq!(written(&["export", "out/run-1", "-o", "out.csv"]), ["out.csv"]);
    assert_eq!(written(&["describe", "plant.toml", "--svg", "plant.svg"]), ["plant.svg"]);
    assert_eq!(written(&["wiring", "--svg", "wiring.svg"]), ["wiring.svg"]);
    assert_eq!(written(&["run", "--until", "100ms"]), Vec::<String>::new());
    for name in ["c.xml", "run.svg", "run.html", "out", "out.csv", "plant.svg", "wiring.svg"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
}

/// A device, a pipe and a link stay what they are.
#[cfg(unix)]
#[test]
fn what_is_not_a_file_takes_the_bytes() {
    use std::os::unix::fs::FileTypeExt as _;
    let folder = copied_shear();
    let link = folder.path().join("link.svg");
    std::fs::write(folder.path().join("real.svg"), "").expect("written");
    std::os::unix::fs::symlink("real.svg", &link).expect("a link");
    let said = typed(folder.path(), &["run", "--until", "100ms", "--plot", "link.svg", "--html", "/dev/null"]);
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
    assert!(link.symlink_metadata().expect("there").is_symlink());
    assert!(std::fs::read_to_string(folder.path().join("real.svg")).expect("a picture").contains("<svg"));
    assert!(std::fs::metadata("/dev/null").expect("there").file_type().is_char_device());
    let said = typed(folder.path(), &["run", "--until", "100ms", "--plot", "/dev/full"]);
    assert_eq!((said.code, said.err.contains("/dev/full")), (Some(3), true), "{said:?}");
    let said = typed(folder.path(), &["run", "--until", "100ms", "--plot", "-"]);
    assert_eq!((said.code, said.err.contains("/dev/stdout")), (Some(2), true), "{said:?}");
}
