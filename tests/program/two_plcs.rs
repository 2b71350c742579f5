//! Plants with two PLCs: either is instrumented, and both run in processes of their own.

use std::path::Path;

use crate::plc::Plc;
use crate::typed::{Said, copied, digests, scenario, typed, utf8};

/// The plants, with the PLCs of each.
const PLANTS: [(&str, [&str; 2]); 2] =
    [("arc-furnace", ["process", "functions"]), ("peeling-line", ["charger", "lathe"])];

fn digest(folder: &Path, words: &[&str]) -> (String, Said) {
    let said = typed(folder, &[&["run", ".", "--format", "json", "--until", "2s"], words].concat());
    let reports: Vec<_> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect();
    (digests(&reports).remove(0), said)
}

/// Charts and networks in PLCopen XML beside text, text alone, and SCL: each in a process of its own, over S7.
#[test]
fn both_plcs_are_real_and_the_digest_is_that_in_one_process() {
    for (name, plcs) in PLANTS {
        let folder = scenario(name);
        let started = plcs.map(|plc| Plc::start(&folder, &["--client", plc, "--s7", "127.0.0.1:0"]));
        let gateways: Vec<String> =
            plcs.iter().zip(&started).map(|(plc, real)| real.gateway_of(plc, "s7://")).collect();
        let words: Vec<&str> = gateways.iter().flat_map(|gateway| ["--gateway", gateway]).collect();
        let (real, said) = digest(&folder, &words);
        assert_eq!(real, digest(&folder, &[]).0, "{name}: {said:?}");
    }
}

/// Without grants each goes by its own clock.
#[test]
fn every_plc_free_wheels() {
    for (name, plcs) in PLANTS {
        let folder = copied(name);
        for plc in plcs {
            let mut real = Plc::start(folder.path(), &["--client", plc, "--mode", "freewheel"]);
            assert!(real.say("status").starts_with("RUN, start 1"), "{name}, {plc}");
        }
    }
}

/// What stands where when a project of PLCopen XML and text has been instrumented, and that it comes back.
#[test]
fn a_project_of_drawings_and_text_is_instrumented_and_comes_back() {
    let mut reported = Vec::new();
    for (name, plc) in [("arc-furnace", "functions"), ("peeling-line", "lathe")] {
        for target in ["iec", "codesys", "twincat"] {
            let folder = copied(name);
            let sources = folder.path().join(plc);
            let before = read(&sources);
            let words = ["instrument", ".", "--client", plc, "--in-place"];
            let said = typed(folder.path(), &[&words[..], &["--target", target]].concat());
            assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{name}, {target}: {said:?}");
            reported.push(format!("{name}, {target}\n{}", said.out.replace("same     ", "         ")));
            assert_eq!(typed(folder.path(), &["check", utf8(&sources)]).code, Some(0), "{name}, {target}");
            let said = typed(folder.path(), &[&words[..], &["--remove"]].concat());
            assert_eq!(said.code, Some(0), "{said:?}");
            assert_eq!(read(&sources), before, "{name}, {target}");
        }
    }
    insta::assert_snapshot!(reported.join("\n"));
}

/// The files of a folder that are sources, by name.
fn read(folder: &Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let named =
        files.map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), std::fs::read(&path).unwrap()));
    named.collect()
}
