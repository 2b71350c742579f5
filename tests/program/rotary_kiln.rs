//! The rotary kiln: two clocks of rotation, and the slip between ring and shell.

use crate::typed::{digests, is_the_same_over_tcp_and_resumed, scenario, typed};

/// The slip of the mended program is `1 + δ/D`; that of the thesis is short by cams and scans, as derived.
#[test]
fn the_slip_is_right_once_the_clocks_are_mended() {
    let reported = |file: &str, code: i32| {
        let said = typed(&scenario("rotary-kiln"), &["run", file]);
        assert_eq!(said.code, Some(code), "{said:?}");
        said.out
    };
    assert!(reported(".", 0).contains("`the slip is the lag of the shell` met"));
    let thesis = reported("thesis.toml", 1);
    assert!(thesis.contains("Ring_time = 58990"), "{thesis}");
    assert!(thesis.contains("Slip = 1.0125"), "{thesis}");
}

#[test]
fn transport_and_checkpoints_do_not_matter() {
    // The second revolution of the shell has just been taken, that of the ring goes on.
    is_the_same_over_tcp_and_resumed("rotary-kiln", ".", "100s", "70.3s");
}

/// Scenarios in one folder are distinguished by their files, and so are their recordings.
#[test]
fn a_comparison_names_the_flip_flop_of_the_thesis() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = |file: &str| {
        let target = folder.path().join(file).to_str().expect("UTF-8").to_owned();
        let said = typed(&scenario("rotary-kiln"), &["run", file, "--until", "20s", "--record", &target]);
        assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
        target
    };
    let (thesis, mended) = (record("thesis.toml"), record("scenario.toml"));
    let said = typed(folder.path(), &["diff", &thesis, &mended]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.out.contains("thesis/timer1.st:12 in PRG_Timer1: GV_Timer1(IN := V_RS.Q1"), "{said:?}");
}

/// Nearly all steps are gone over at once; gone through one by one, in other processes or from a checkpoint they are the same.
#[test]
fn a_month_of_sleep_leaves_no_trace() {
    is_the_same_over_tcp_and_resumed("rotary-kiln", "month.toml", "2h", "50min");
    let digest = |words: &[&str]| {
        let all = [&["run", "month.toml", "--format", "json", "--until", "2h"], words].concat();
        let said = typed(&scenario("rotary-kiln"), &all);
        let report: serde_json::Value = serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{said:?}"));
        digests(&[report])
    };
    // at a pace that holds nothing back every state of every step is entered
    assert_eq!(digest(&["--pace", "1000000000"]), digest(&[]));
}

#[test]
fn a_map_has_the_shell_as_a_picture_and_as_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let maps = folder.path().join("maps");
    let target = maps.to_str().expect("UTF-8");
    let said = typed(&scenario("rotary-kiln"), &["run", "month.toml", "--until", "2h", "--maps", target]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let svg = std::fs::read_to_string(maps.join("month.svg")).expect("a picture");
    assert!(svg.contains("The shell after a month") && svg.contains("angle (°)"), "{svg}");
    let text = std::fs::read_to_string(maps.join("month.csv")).expect("a table");
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let places = lines.next().expect("a head");
    let first: Vec<f64> =
        lines.next().expect("a row")[1..].iter().map(|cell| cell.parse().expect("a number")).collect();
    assert_eq!((first.len(), lines.count()), (240, 119));
    // the middles of the two zones beside the flame at 15 m are 1.25 m from it
    let hottest = (0..first.len()).max_by(|a, b| first[*a].total_cmp(&first[*b])).expect("some");
    let at_m: f64 = places[hottest + 1].parse().expect("a number");
    let from_flame_m = (at_m - 15.0).abs();
    assert!((from_flame_m - 1.25).abs() < 0.5, "{at_m} m");
    assert!((first[hottest] - 285.0).abs() < 1.0, "{} °C", first[hottest]);
}

#[test]
fn a_page_shows_the_maps_of_a_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("page.html");
    let words = ["run", "month.toml", "--until", "2h", "--html", page.to_str().expect("UTF-8")];
    let said = typed(&scenario("rotary-kiln"), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let page = std::fs::read_to_string(page).expect("a page");
    assert!(page.contains("map at the end") && page.contains("The shell after a month"), "no map");
}

#[test]
fn a_scenario_without_maps_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = typed(&scenario("rotary-kiln"), &["run", ".", "--maps", folder.path().to_str().expect("UTF-8")]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("--maps: there is nothing to be drawn"), "{said:?}");
}

/// What a run of the scanner says, with variables of the PLC at the end.
fn scanned(file: &str, until: &str, watched: &[&str]) -> crate::typed::Said {
    let watched = watched.iter().flat_map(|path| ["--watch", path]);
    let words: Vec<&str> = ["run", file, "--until", until].into_iter().chain(watched).collect();
    typed(&scenario("rotary-kiln"), &words)
}

#[test]
fn a_revolution_has_its_lines_over_ethernet_and_over_a_serial_line() {
    for file in ["tcp.toml", "serial.toml"] {
        let said = scanned(file, "200s", &["GV_Rows", "GV_Orders_before"]);
        assert_eq!(said.code, Some(0), "{file}: {said:?}");
        assert!(said.out.contains("GV_Rows = 100") && said.out.contains("GV_Orders_before = 100"), "{file}: {said:?}");
    }
    is_the_same_over_tcp_and_resumed("rotary-kiln", "tcp.toml", "140s", "131s");
}

#[test]
fn the_check_byte_of_the_thesis_is_refused() {
    let right = scanned("serial.toml", "5s", &["GV_Params_ok", "GV_Refused"]);
    assert!(right.out.contains("GV_Params_ok = 7") && right.out.contains("GV_Refused = 0"), "{right:?}");
    let thesis = scanned("thesis-frame.toml", "5s", &["GV_Params_ok", "GV_Refused"]);
    assert!(thesis.out.contains("GV_Params_ok = 4") && thesis.out.contains("GV_Refused = 9"), "{thesis:?}");
}

#[test]
fn a_loop_that_waits_within_a_scan_is_reported() {
    let said = scanned("thesis-serial.toml", "200s", &[]);
    assert_eq!(said.code, Some(3), "{said:?}");
    let reported = format!("{}{}", said.out, said.err);
    assert!(
        reported.contains("endless or very long loop in PRG_Measure_serial at thesis/measure_serial.st:16:13"),
        "{reported}"
    );
}
