//! The scanner of the rotary kiln: what is lost on its line, how often it is asked, and a scanner of another make.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::typed::{copied, digests, edit, is_the_same_over_tcp_and_resumed, onescan, scenario, typed};

/// Lines of what is said that report the PLC's end.
fn fault(folder: &Path, words: &[&str]) -> String {
    let said = typed(folder, words);
    assert_eq!(said.code, Some(3), "{said:?}");
    let all = format!("{}\n{}", said.out, said.err);
    let reported: Vec<&str> = all.lines().map(str::trim).filter(|line| line.contains("PLC fault")).collect();
    reported.first().copied().unwrap_or_else(|| panic!("{all}")).to_owned()
}

/// What is watched, at the end of a run that meets what is expected.
fn watched(file: &str, case: &str, variable: &str) -> String {
    let words = ["run", file, "--case", case, "--watch", variable];
    let said = typed(&scenario("rotary-kiln"), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let value = said.out.lines().find_map(|line| line.split_once(&format!("{variable} = ")));
    value.unwrap_or_else(|| panic!("{said:?}")).1.trim().to_owned()
}

#[test]
fn without_its_guard_the_program_stops_at_the_first_edge_of_the_shell() {
    let reported = fault(&scenario("rotary-kiln"), &["run", "unguarded.toml"]);
    insta::assert_snapshot!(reported);
    let guarded = typed(&scenario("rotary-kiln"), &["run", ".", "--until", "30s"]);
    assert_eq!(guarded.code, Some(0), "{guarded:?}");
}

/// The program of the thesis waits within a scan, whether the scanner is silent or not; the mended one gives the line up.
#[test]
fn a_silent_scanner_is_reported_and_never_a_hang() {
    let folder = copied("rotary-kiln");
    let case = "version = 1\n[[case]]\nname = \"silent\"\n[[case.disturbance]]\nsignal = \"From_scanner\"\nkind = \"silent\"\n\
                from = \"1s\"\n";
    fs::write(folder.path().join("thesis-serial.cases.toml"), case).expect("a file");
    insta::assert_snapshot!(fault(folder.path(), &["run", "thesis-serial.toml", "--case", "silent"]));
    assert_eq!(watched("serial.toml", "silent", "GV_Timeouts"), "3");
}

/// The thesis: a revolution may have one line more. Its rule leaves out one, where there may be 28.
#[test]
fn the_rule_of_the_thesis_leaves_lines_over() {
    let thesis = typed(&scenario("rotary-kiln"), &["run", "thesis-rates.toml"]);
    assert_eq!(thesis.code, Some(1), "{thesis:?}");
    assert!(thesis.out.contains("Rows = 513"), "{thesis:?}");
    for (file, case, orders) in [
        ("thesis-rates.toml", "default", "514"),
        ("thesis-rates.toml", "thousand", "1028"),
        ("rates.toml", "default", "514"),
        ("rates.toml", "quick,GV_Samples_per_rev=100", "100"),
    ] {
        let reported = watched(file, case, "GV_Orders_before");
        assert_eq!(reported, orders, "{file} {case}");
    }
}

/// Where a revolution's lines are all equal, it does not matter when they are taken, nor over what they come.
#[test]
fn both_links_give_the_same_matrix_of_a_shell_that_is_the_same_all_round() {
    assert_eq!(watched("tcp.toml", "even", "GV_Sum"), watched("serial.toml", "even", "GV_Sum"));
    assert_eq!(watched("tcp-cut.toml", "default", "GV_Timeouts"), "0");
}

fn package() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../clients/python/src")
}

/// The scenarios with the scanner in another process. `serial.toml` takes it from its base, `tcp.toml`.
fn with_peer(link: &str) -> tempfile::TempDir {
    let file = "tcp.toml";
    let folder = copied("rotary-kiln");
    let peer = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/scanner.py");
    fs::copy(peer, folder.path().join("scanner.py")).expect("a file");
    let scene = fs::read_to_string(folder.path().join("kiln.toml")).expect("a scene");
    let (kiln, _) = scene.split_once("[[component]]\nname = \"scanner\"").expect("a scanner, the last one");
    fs::write(folder.path().join("kiln.toml"), kiln).expect("a file");
    for signal in ["From_scanner", "Scanner_lines", "Accepted", "Refused"] {
        let ty = if signal == "From_scanner" { "BYTES[512]" } else { "DINT" };
        let line = |writer: &str| format!("{signal} = {{ type = \"{ty}\", writer = \"{writer}\" }}");
        edit(folder.path(), file, &line("plant"), &line("scanner"));
    }
    let command = format!(
        "[clients.scanner]\nkind = \"external\"\ncommand = [\"python3\", \"-B\", \"scanner.py\", \"--link\", \"{link}\", \"--server\", \"{{server}}\"]\n\n[clients.plant]"
    );
    edit(folder.path(), file, "[clients.plant]", &command);
    if link == "tcp" {
        edit(folder.path(), file, "set.scanner.link = \"tcp\"\n", "");
    }
    folder
}

/// The same signals with the same values: neither the digest nor the PLC's matrix says who wrote them.
#[test]
fn a_scanner_of_another_make_in_a_process_of_its_own_gives_the_same_matrix_and_the_same_digest() {
    for (file, link) in [("serial.toml", "serial"), ("tcp.toml", "tcp")] {
        let run = |folder: &Path| {
            let maps = folder.join("maps");
            let words = ["run", file, "--case", "fast", "--until", "33s", "--format", "json", "--map"];
            let output = onescan(folder).args(words).arg(&maps).env("PYTHONPATH", package()).output().expect("it runs");
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let report: Value = serde_json::from_slice(&output.stdout).expect("a report");
            (fs::read_to_string(maps.join("plc.csv")).expect("a map"), digests(&[report]))
        };
        let (own, peer) = (copied("rotary-kiln"), with_peer(link));
        let (matrix, digest) = run(own.path());
        let (other_matrix, other_digest) = run(peer.path());
        assert!(matrix.lines().count() > 20, "{matrix}");
        assert_eq!(matrix, other_matrix, "{file}");
        assert_eq!(digest, other_digest, "{file}");
    }
}

#[test]
fn transport_and_checkpoints_do_not_matter() {
    // in the middle of a line that is cut, of a shifted row, of a revolution that is counted
    is_the_same_over_tcp_and_resumed("rotary-kiln", "tcp-cut.toml", "25s", "18.4s");
    is_the_same_over_tcp_and_resumed("rotary-kiln", "resync.toml", "20s", "17.1s");
    is_the_same_over_tcp_and_resumed("rotary-kiln", "rates.toml", "20s", "17s");
}
