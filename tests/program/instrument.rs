//! `instrument` as it is typed: projects made to run in lockstep, and back.

use std::collections::BTreeMap;
use std::path::Path;

use crate::typed::{Said, copied_shear, digests, scenario, typed};

fn instrumented(folder: &Path, words: &[&str]) -> Said {
    let mut all = vec!["instrument"];
    all.extend_from_slice(words);
    let said = typed(folder, &all);
    assert!(!said.err.contains("panicked"), "{said:?}");
    said
}

/// Every file below a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.insert(name, std::fs::read(&path).unwrap());
        }
    }
    found
}

/// `MatIEC` lets a project declare a function of the standard's own name. The shim for it uses that function, so the two do
/// not go together: what would be written does not check.
#[test]
fn nothing_is_written_if_what_is_made_does_not_check() {
    const PROJECT: &str = "{dialect 'matiec'}
FUNCTION TIME_TO_LINT : LINT
VAR_INPUT whole : TIME; part : INT; END_VAR
    TIME_TO_LINT := part;
END_FUNCTION

PROGRAM P
VAR t : TON; n : LINT; END_VAR
    t(IN := TRUE, PT := T#1s);
    n := TIME_TO_LINT(t.ET, 3);
END_PROGRAM
";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("p.st"), PROJECT).unwrap();
    assert_eq!(typed(folder.path(), &["check", "p.st"]).code, Some(0), "the project is right without the shim");
    let before = files(folder.path());
    for diff in [&[][..], &["--diff"]] {
        let words = [&["p.st", "--target", "openplc", "-o", "out"], diff].concat();
        let said = instrumented(folder.path(), &words);
        assert_eq!(said.code, Some(2), "{words:?}: {said:?}");
        assert!(said.out.contains("TIME_TO_LINT"), "the finding names it: {said:?}");
        assert!(said.err.contains("would not check") && said.err.contains("nothing was written"), "{said:?}");
        assert_eq!(files(folder.path()), before, "{words:?}");
    }
    // With another name it goes.
    std::fs::write(folder.path().join("p.st"), PROJECT.replace("TIME_TO_LINT", "Whole_part")).unwrap();
    assert_eq!(instrumented(folder.path(), &["p.st", "--target", "openplc", "-o", "out"]).code, Some(0));
    assert!(files(folder.path()).len() > before.len());
}

#[test]
fn a_scenario_is_instrumented_and_comes_back() {
    let folder = copied_shear();
    let before = files(folder.path());
    let said = instrumented(folder.path(), &[".", "--in-place"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    insta::assert_snapshot!(said.out);
    let after = files(folder.path());
    assert_ne!(after, before);
    // Once more changes nothing.
    let said = instrumented(folder.path(), &[".", "--in-place"]);
    assert!(said.code == Some(0) && !said.out.contains("changed"), "{said:?}");
    assert_eq!(files(folder.path()), after);
    // The result is a program without errors.
    assert_eq!(typed(folder.path(), &["check", "plc"]).code, Some(0));
    let said = instrumented(folder.path(), &[".", "--in-place", "--remove"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(files(folder.path()), before);
}

/// For CODESYS a project in text becomes one file; the project's own stay as they are.
#[test]
fn a_scenario_becomes_plcopen_xml_and_comes_back() {
    let folder = copied_shear();
    let before = files(folder.path());
    let said = instrumented(folder.path(), &[".", "--target", "codesys", "-o", "out"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    insta::assert_snapshot!(said.out);
    let out = files(&folder.path().join("out"));
    let mut made = out.clone();
    let xml = made.remove("plc/sdsp.xml").expect("the whole project");
    assert!(made.remove("gateway.toml").is_some(), "the mapping that goes with it");
    assert!(made.iter().all(|(name, bytes)| before.get(name) == Some(bytes)) && made.len() == 2, "{:?}", made.keys());
    // Both the file alone, and the folder in which the sources are, are a program without errors.
    for path in ["out/plc/sdsp.xml", "out"] {
        let said = typed(folder.path(), &["check", path]);
        assert_eq!(said.code, Some(0), "{said:?}");
    }
    std::fs::remove_dir_all(folder.path().join("out")).unwrap();
    // In place, and once more.
    for change in ["new", "same"] {
        let said = instrumented(folder.path(), &[".", "--target", "codesys", "--in-place"]);
        assert!(said.code == Some(0) && said.out.contains(&format!("{change:<8} plc/sdsp.xml")), "{said:?}");
    }
    let after = files(folder.path());
    assert_eq!(after.get("plc/sdsp.xml"), Some(&xml));
    assert_eq!(after.len(), before.len() + 2);
    let said = instrumented(folder.path(), &[".", "--in-place", "--remove"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(files(folder.path()), before);
}

#[test]
fn changes_are_shown_and_nothing_is_written() {
    let folder = copied_shear();
    let before = files(folder.path());
    let said = instrumented(folder.path(), &["plc/shear.st", "--diff", "--task", "main:10ms:0=Shear"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let (diff, _) = said.out.split_once("--- /dev/null").unwrap();
    insta::assert_snapshot!(diff);
    assert_eq!(files(folder.path()), before);
}

#[test]
fn bytes_stay_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        b"(* F\xf6rderband *)\r\nPROGRAM P\r\nVAR t : TON; END_VAR\r\n\tt(IN := TRUE, PT := T#1s);\r\nEND_PROGRAM";
    std::fs::write(folder.path().join("p.st"), text).unwrap();
    let said = instrumented(folder.path(), &["p.st", "-o", "out"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(std::fs::read(folder.path().join("p.st")).unwrap(), text);
    let out = std::fs::read(folder.path().join("out/p.st")).unwrap();
    assert!(
        out.starts_with(b"(* F\xf6rderband *)\r\nPROGRAM P\r\n") && out.windows(9).any(|part| part == b"SDSP_TON(")
    );
    assert_eq!(out.split(|byte| *byte == b'\n').count() - 1, out.windows(2).filter(|two| two == b"\r\n").count());
    let said = instrumented(folder.path(), &["out", "--remove", "-o", "back"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(files(&folder.path().join("back")), BTreeMap::from([("p.st".to_owned(), text.to_vec())]));
}

#[test]
fn machines_read_json() {
    let said = instrumented(&scenario("shear"), &[".", "--target", "twincat", "--diff", "--format", "json"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let report: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let names: Vec<_> =
        report["files"].as_array().unwrap().iter().map(|file| (&file["file"], &file["change"])).collect();
    insta::assert_snapshot!(serde_json::to_string_pretty(&names).unwrap());
    assert!(report["files"][0]["lines"].as_array().unwrap().len() > 60);
}

/// Structured Text for TIA Portal: one file to import, and the text as it was.
#[test]
fn text_becomes_a_source_of_tia_portal_and_goes_again() {
    let folder = copied_shear();
    let before = files(folder.path());
    let said = instrumented(folder.path(), &[".", "--target", "scl", "--in-place"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    insta::assert_snapshot!("shear_for_tia_portal", said.out);
    let mut after = files(folder.path());
    assert_eq!(typed(folder.path(), &["check", "plc/sdsp.scl"]).code, Some(0));
    let said = instrumented(folder.path(), &[".", "--target", "scl", "--in-place"]);
    assert!(said.code == Some(0) && !said.out.contains("changed"), "{said:?}");
    assert_eq!(files(folder.path()), after);
    // Another target takes its place, and gives it back.
    let said = instrumented(folder.path(), &[".", "--in-place", "--remove"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(files(folder.path()), before);
    assert!(after.remove("plc/sdsp.scl").is_some() && after.remove("plc/gateway.toml").is_some());
    assert_eq!(after, before);
}

/// A file of the user's with the mapping's name is neither written over nor deleted.
#[test]
fn a_mapping_of_somebody_else_is_left_as_it_is() {
    let folder = copied_shear();
    let own = folder.path().join("plc/gateway.toml");
    std::fs::write(&own, "mine = true\n").unwrap();
    let said = instrumented(folder.path(), &[".", "--target", "scl", "--in-place"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    insta::assert_snapshot!(said.err);
    assert!(!folder.path().join("plc/sdsp.scl").exists(), "nothing is written");
    let said = instrumented(folder.path(), &[".", "--target", "iec", "--in-place"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let said = instrumented(folder.path(), &[".", "--in-place", "--remove"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(std::fs::read_to_string(&own).unwrap(), "mine = true\n");
}

/// PLCs with symbols: TwinCAT's, and nodes of CODESYS, where global variables are in lists.
#[test]
fn a_mapping_of_symbols_goes_with_the_shim() {
    for (name, target) in [("shear", "twincat"), ("gantry-robot", "codesys")] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().expect("text");
        let said = typed(&scenario(name), &["instrument", ".", "--target", target, "--output", out]);
        assert_eq!(said.code, Some(0), "{said:?}");
        let mapping = std::fs::read_to_string(folder.path().join("gateway.toml")).unwrap();
        insta::assert_snapshot!(format!("mapping_for_{target}"), mapping);
        if target == "twincat" {
            let plc = crate::plc::Plc::start(&scenario(name), &[]);
            let url = plc.gateway("ads://");
            let mapping = mapping.replace("ads://127.0.0.1", url.trim_start_matches("plc="));
            std::fs::write(folder.path().join("gateway.toml"), mapping).unwrap();
            let gateway = format!("plc={out}/gateway.toml");
            let words = ["run", ".", "--format", "json", "--until", "1s"];
            let soft = typed(&scenario(name), &words);
            let real = typed(&scenario(name), &[&words[..], &["--gateway", &gateway]].concat());
            let digest = |said: &Said| {
                let report: serde_json::Value = serde_json::from_str(&said.out).expect("a report");
                report["digest"].as_str().expect("a digest").to_owned()
            };
            assert_eq!(digest(&soft), digest(&real), "{real:?}");
        }
    }
}

/// What SCL does not have is reported, and nothing is written.
#[test]
fn what_has_no_form_in_scl_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        "PROGRAM P\nVAR\n    t : TIME := T#500us;\n    r : REF_TO TIME;\nEND_VAR\n    r := REF(t);\nEND_PROGRAM\n";
    std::fs::write(folder.path().join("p.st"), text).unwrap();
    let said = instrumented(folder.path(), &["p.st", "--target", "scl", "-o", "out"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(!folder.path().join("out").exists());
    insta::assert_snapshot!("refused_for_tia_portal", said.out);
}

#[test]
fn what_is_wrong_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("clock.st", "PROGRAM P VAR m : MC_Phasing; END_VAR m(); END_PROGRAM\n");
    write("class.st", "CLASS C END_CLASS PROGRAM P VAR x : REAL; END_VAR x := x ** 2.0; END_PROGRAM\n");
    write("none.st", "FUNCTION_BLOCK F END_FUNCTION_BLOCK\n");
    write("line.L5X", "<RSLogix5000Content/>");
    write("wrong.st", "PROGRAM P x := ; END_PROGRAM\n");
    write("own.st", "(*@sdsp file*)\nPROGRAM SDSP_Scheduler ; END_PROGRAM\n");
    let say = |words: &[&str]| {
        let said = instrumented(folder.path(), words);
        format!("{:?}\n{}{}", said.code, said.out, said.err)
    };
    let all = [
        say(&["clock.st", "-o", "out"]),
        say(&["clock.st", "-o", "no", "--deny-warnings"]),
        say(&["none.st", "--diff"]),
        say(&["wrong.st", "--diff"]),
        say(&["clock.st", "--diff", "--task", "a:1ms:0=Q"]),
        say(&["clock.st", "--diff", "--task", "a:1ms=P"]),
        say(&["clock.st"]),
        say(&["line.L5X", "--diff"]),
        say(&["clock.st", "--diff", "--target", "l5x"]),
        say(&["own.st", "--diff"]),
        say(&["clock.st", "--diff", "--target", "scl"]),
        say(&["class.st", "--target", "codesys", "-o", "no"]),
    ];
    assert!(!folder.path().join("no").exists());
    insta::assert_snapshot!(all.join("----\n"));
}

/// The shear makes its strokes to the last bit as it does without the shim; see the test of the same name
/// below for the instrumented program under grants.
#[test]
fn an_instrumented_scenario_that_is_not_simulated_has_the_same_digest() {
    let folder = copied_shear();
    let run = || {
        let said = typed(folder.path(), &["run", ".", "--format", "json", "--until", "2s"]);
        digests(&[serde_json::from_str(said.out.trim()).expect("a report")])
    };
    let plain = run();
    assert_eq!(instrumented(folder.path(), &[".", "--in-place"]).code, Some(0));
    crate::typed::edit(folder.path(), "plc/sdsp.st", "SDSP_Simulated : BOOL := TRUE", "SDSP_Simulated : BOOL := FALSE");
    crate::typed::edit(
        folder.path(),
        "scenario.toml",
        "\"plc/alignment.st\"]",
        "\"plc/alignment.st\", \"plc/sdsp.st\"]",
    );
    assert_eq!(run(), plain);
}

/// Inputs at addresses are taken over when that is asked for, and come back.
#[test]
fn inputs_at_addresses_are_taken_over_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let text = "PROGRAM Main\nVAR\n    Guard AT %IX0.0 : BOOL;\n    Seen : BOOL;\nEND_VAR\n    Seen := Guard AND %IX0.1;\nEND_PROGRAM\n";
    std::fs::write(folder.path().join("main.st"), text).unwrap();
    let said = instrumented(folder.path(), &[".", "--diff", "--take-inputs"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    for line in ["+    SDSP_IN_Guard AT %IX0.0 : BOOL;", "SDSP_IX0_1(*@sdsp was %IX0.1*)", "Guard := SDSP_IN_Guard;"] {
        assert!(said.out.contains(line), "{line}: {}", said.out);
    }
    let said = instrumented(folder.path(), &[".", "--in-place", "--take-inputs"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let said = instrumented(folder.path(), &[".", "--in-place", "--remove"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(std::fs::read_to_string(folder.path().join("main.st")).unwrap(), text);
    let said = instrumented(folder.path(), &[".", "--diff", "--take-inputs", "--target", "scl"]);
    assert!(said.code == Some(2) && said.out.contains("not in PLCopen XML or SCL"), "{said:?}");
}
