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
            let words = ["run", file, "--case", "fast", "--until", "33s", "--format", "json", "--maps"];
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

/// A map as a table: its places, and its rows, each with its angle or number in front.
fn map(path: &Path) -> (Vec<f64>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).expect("a map");
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    let mut lines = text.lines();
    let places = lines.next().expect("a head").split(',').skip(1).map(number).collect();
    (places, lines.map(|line| line.split(',').map(number).collect()).collect())
}

/// What a map of the machine has at a place and an angle, straight between its cells.
fn between((places, rows): &(Vec<f64>, Vec<Vec<f64>>), at_m: f64, at_deg: f64) -> f64 {
    let right = places.partition_point(|place| *place < at_m).clamp(1, places.len() - 1);
    let along = ((at_m - places[right - 1]) / (places[right] - places[right - 1])).clamp(0.0, 1.0);
    let above = rows.partition_point(|row| row[0] < at_deg);
    let (above, below) = (&rows[above % rows.len()], &rows[(above + rows.len() - 1) % rows.len()]);
    let around = (at_deg - below[0]).rem_euclid(360.0) / (above[0] - below[0]).rem_euclid(360.0);
    // the first cell of a row is its angle
    let at = |row: &[f64]| row[right] * (1.0 - along) + row[right + 1] * along;
    at(below) * (1.0 - around) + at(above) * around
}

/// Ch. 15: the structure is for several scanners. Both maps are the machine's, to a step of a byte.
#[test]
fn two_scanners_have_the_shell_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = ["run", "scanners.toml", "--until", "132s", "--maps", folder.path().to_str().expect("UTF-8")];
    let said = typed(&scenario("rotary-kiln"), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let machine = map(&folder.path().join("machine.csv"));
    for name in ["inlet-half", "outlet-half"] {
        let (places, rows) = map(&folder.path().join(name).with_extension("csv"));
        assert_eq!((places.len(), rows.len()), (256, 100), "{name}");
        let apart = |row: &[f64], column: usize| {
            let machine = between(&machine, places[column], row[0] * 3.6);
            (row[column + 1] - machine).abs()
        };
        let most = rows.iter().flat_map(|row| (0..256).map(|column| apart(row, column))).fold(0.0, f64::max);
        assert!(most < 500.0 / 255.0, "{name}: {most} °C");
    }
}
