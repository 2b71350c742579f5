//! `onescan run`: the same bits whatever is around the session.

use crate::load::under_load;

use crate::typed::{digests, run_shear, scenario, typed};

/// The digest of 2 s of the shear. It changes only with the scenario, the physics or the compiler's
/// semantics, each of which is worth a line in the changelog.
fn shear_digest() -> String {
    let (reports, said) = run_shear(&["--until", "2s"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    digests(&reports).remove(0)
}

#[test]
fn the_digest_of_the_shear_is_this() {
    insta::assert_snapshot!(shear_digest());
}

#[test]
fn six_runs_are_one() {
    let (reports, said) = run_shear(&["--runs", "6"]);
    assert_eq!((reports.len(), said.code), (6, Some(0)));
    let digests = digests(&reports);
    assert!(digests.iter().all(|digest| *digest == digests[0]), "{digests:?}");
}

#[test]
fn transport_and_pace_do_not_matter() {
    let expected = shear_digest();
    for words in
        [&["--transport", "tcp"][..], &["--pace", "1"], &["--pace", "max"], &["--transport", "tcp", "--pace", "1"]]
    {
        let (reports, said) = run_shear(&[&["--until", "2s"], words].concat());
        assert_eq!(digests(&reports).first(), Some(&expected), "{words:?} {said:?}");
    }
}

#[test]
fn load_does_not_matter() {
    let expected = shear_digest();
    let words = [&["--until", "2s"][..], &["--until", "2s", "--transport", "tcp"]];
    for (reports, said) in under_load(|| words.map(run_shear)) {
        assert_eq!(digests(&reports).first(), Some(&expected), "{said:?}");
    }
}

/// A source is the same program in any encoding, with any line ends.
#[test]
fn encoding_of_the_sources_does_not_matter() {
    let folder = crate::typed::copied_shear();
    let path = folder.path().join("plc/shear.st");
    let text = std::fs::read_to_string(&path).unwrap().replace('\n', "\r\n");
    let utf16: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    std::fs::write(&path, utf16).unwrap();
    let said = typed(folder.path(), &["run", ".", "--format", "json", "--until", "2s"]);
    let report = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
    assert_eq!(digests(&[report]), [shear_digest()]);
}

#[test]
fn log_level_recording_and_plot_do_not_matter() {
    let folder = tempfile::tempdir().unwrap();
    let (record, plot) = (folder.path().join("record"), folder.path().join("plot.svg"));
    let words = ["-vvv", "--until", "2s", "--record", record.to_str().unwrap(), "--plot", plot.to_str().unwrap()];
    let (reports, said) = run_shear(&words);
    assert_eq!(digests(&reports), [shear_digest()]);
    assert!(said.err.contains("INFO") || said.err.contains("TRACE") || said.err.is_empty());
    let svg = std::fs::read_to_string(plot).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("Position_1") && svg.trim_end().ends_with("</svg>"));
    let summary = std::fs::read_to_string(record.join("run-1/run.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["digest"], reports[0]["digest"]);
}

/// The trajectory itself, every 100 ms: what the blade does is reviewed here.
#[test]
fn the_trajectory_of_the_shear() {
    let folder = tempfile::tempdir().unwrap();
    let (_, said) = run_shear(&["--until", "3s", "--record", folder.path().to_str().unwrap(), "--record-also", "csv"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let text = std::fs::read_to_string(folder.path().join("run-1/trajectory.csv")).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!(rows.len(), 1 + 1 + 300);
    let table: Vec<&str> = std::iter::once(rows[0]).chain(rows[1..].iter().step_by(10).copied()).collect();
    insta::assert_snapshot!(table.join("\n"));
}

#[test]
fn the_machines_report_has_its_fields() {
    let (reports, _) = run_shear(&["--until", "1s"]);
    let report = reports[0].as_object().unwrap();
    let fields: Vec<&str> = report.keys().map(String::as_str).collect();
    insta::assert_snapshot!(fields.join(" "), @"digest expectations mode report run scenario status steps transport version virtual_time_ns wall_time_s");
    assert_eq!(report["steps"], 100);
    assert_eq!(report["virtual_time_ns"], 1_000_000_000);
    assert_eq!(report["status"], "completed");
}

#[test]
fn people_get_lines_and_nothing_on_standard_error() {
    let said = typed(&scenario("shear"), &["run", ".", "--runs", "2", "--until", "1s"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    let lines: Vec<&str> = said.out.lines().collect();
    assert_eq!(lines.len(), 17, "{said:?}");
    assert!(lines[0].starts_with("run 1/2: completed, 100 steps, 1.000 s virtual in "));
    assert!(lines[1].starts_with("  digest "));
    assert_eq!(
        lines[2..4],
        ["  expectation `both sides at once` met", "  expectation `strokes go on` open at the end of the run"]
    );
    assert_eq!(lines[4], "  report of 0.000 s to 1.000 s");
    // Equal runs are reported once.
    assert!(lines[15].starts_with("run 2/2: the same as run 1, in "), "{said:?}");
    assert_eq!(lines[16], "2 runs, all digests equal");
}
