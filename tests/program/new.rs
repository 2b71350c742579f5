//! `onescan new`: what it writes runs green at once, is clean, and is never written over anything.

use std::path::Path;

use crate::typed::{Said, onescan, scenario, typed};

/// Types a command where Python finds the package `onescan_client`.
fn with_python(folder: &Path, words: &[&str]) -> Said {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../clients/python/src");
    onescan(folder).args(words).env("PYTHONPATH", package).output().expect("the program starts").into()
}

#[test]
fn every_template_runs_green_at_once() {
    for template in ["cell", "tank", "python", "blank"] {
        let folder = tempfile::tempdir().unwrap();
        let said = typed(folder.path(), &["new", "my-cell", "--template", template]);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{template}");
        let said = with_python(folder.path(), &["run", "my-cell", "--runs", "2", "--plot", "run.svg"]);
        assert_eq!(said.code, Some(0), "{template}: {said:?}");
        assert!(!said.out.contains("violated") && folder.path().join("run.svg").exists(), "{template}: {said:?}");
        let said = typed(folder.path(), &["check", "my-cell", "--deny-warnings"]);
        assert_eq!(said.code, Some(0), "{template}: {said:?}");
        let said = typed(folder.path(), &["wiring", "my-cell"]);
        assert_eq!(said.code, Some(0), "{template}: {said:?}");
        for file in ["scenario.toml", "README.md", "plc/main.st"] {
            let text = std::fs::read_to_string(folder.path().join("my-cell").join(file)).unwrap();
            assert!(text.contains("my-cell") && !text.contains("{name}"), "{template}: {file}");
        }
    }
}

/// Where Python does not find its package, the plant says what to type.
#[test]
fn a_plant_in_python_says_what_it_needs() {
    let folder = tempfile::tempdir().unwrap();
    let said = typed(folder.path(), &["new", "my-plant", "--template", "python"]);
    assert!(
        said.out.ends_with("      onescan run my-plant\n") && said.out.contains("next: pip install onescan"),
        "{said:?}"
    );
    let missing = "raise ModuleNotFoundError(name='onescan_client')\n";
    std::fs::write(folder.path().join("onescan_client.py"), missing).unwrap();
    let mut run = onescan(folder.path());
    run.args(["run", "my-plant", "--until", "1s"]).env("PYTHONPATH", folder.path());
    let said: Said = run.output().expect("the program starts").into();
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(
        said.err.contains("onescan_client: type `pip install onescan`") && !said.err.contains("Traceback"),
        "{said:?}"
    );
}

#[test]
fn it_says_what_it_wrote_and_what_comes_next() {
    let folder = tempfile::tempdir().unwrap();
    insta::assert_snapshot!("new_cell", typed(folder.path(), &["new", "my-cell"]).out);
}

#[test]
fn what_is_there_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    let said = typed(folder.path(), &["new", "mine"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("mine is there already"), "{said:?}");
    assert_eq!(std::fs::read_dir(folder.path().join("mine")).unwrap().count(), 0);
    let said = typed(folder.path(), &["new", "my cell"]);
    assert!(said.code == Some(2) && said.err.contains("`my cell` cannot name a scenario"), "{said:?}");
}

/// The commented-out failure of the cell is one that the library has, and it shows.
#[test]
fn what_the_readme_says_to_try_can_be_tried() {
    let folder = tempfile::tempdir().unwrap();
    typed(folder.path(), &["new", "my-cell"]);
    let file = folder.path().join("my-cell/plant.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let failing = text.replace("# [[failure]]", "[[failure]]").replace("# component", "component");
    let failing =
        failing.replace("# mode = \"leaking\"", "mode = \"jammed\"").replace("# from_s = 10.0", "from_s = 1.0");
    std::fs::write(&file, failing).unwrap();
    let said = typed(folder.path(), &["run", "my-cell"]);
    assert!(said.code == Some(1) && said.out.contains("`boxes are pushed off` violated"), "{said:?}");
}

/// A sensor more, as the cell's README describes: the error names the line to write, and with it the run is green.
#[test]
fn a_sensor_is_added_by_what_the_program_says() {
    let folder = tempfile::tempdir().unwrap();
    typed(folder.path(), &["new", "my-cell"]);
    let file = |name: &str| folder.path().join("my-cell").join(name);
    let text = std::fs::read_to_string(file("plant.toml")).unwrap();
    let barrier = text.split("[[component]]").find(|part| part.contains("name = \"barrier\"")).expect("it has one");
    let another = barrier.replace("\"barrier\"", "\"end\"").replace("Box_There", "Box_At_End").replace("0.36,", "0.9,");
    std::fs::write(file("plant.toml"), format!("{text}\n[[component]]{another}")).unwrap();
    let said = typed(folder.path(), &["run", "my-cell"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    insta::assert_snapshot!("a_signal_that_is_not_declared", said.err);
    let line = said.err.split_once("under [signals]:").expect("a help").1;
    let line = line.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let text = std::fs::read_to_string(file("scenario.toml")).unwrap();
    std::fs::write(file("scenario.toml"), text.replace("[signals]\n", &format!("[signals]\n{}\n", line.trim())))
        .unwrap();
    let said = typed(folder.path(), &["run", "my-cell", "--signals", "Box_At_End", "--plot", "end.svg"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
}

/// The lists that the readers' own tests have.
fn list(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cli/program/src/io_list/fixtures");
    folder.join(name).canonicalize().expect("a fixture").display().to_string()
}

/// What was said, without where the lists are.
fn placeless(text: &str) -> String {
    let folder = list("press.st").replace("press.st", "");
    text.replace(&folder, "").replace(folder.trim_end_matches('/'), "lists")
}

#[test]
fn a_scenario_made_of_a_list_runs_and_checks_at_once() {
    let lists =
        ["press.tsproj", "term.xti", "press.tmc", "press-eni.xml", "press-tags.xml", "press.sdf", "press-tags.csv"];
    for name in lists.into_iter().chain(["press-mapping.csv", "press.st", "press-plcopen.xml"]) {
        let folder = tempfile::tempdir().unwrap();
        let said = typed(folder.path(), &["new", "press", "--from", &list(name)]);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{name}");
        insta::assert_snapshot!(format!("new_from_{name}"), placeless(&said.out));
        // What comes next says what it takes to read sources that are elsewhere.
        let next = said.out.rsplit_once("next: onescan run press").expect("what comes next").1.to_owned();
        let allowed: Vec<&str> = next.split_whitespace().collect();
        let said = typed(folder.path(), &[&["run", "press", "--until", "100ms", "--runs", "2"], &allowed[..]].concat());
        assert_eq!(said.code, Some(0), "{name}: {said:?}");
        let said = typed(folder.path(), &[&["check", "press"], &allowed[..]].concat());
        assert_eq!(said.code, Some(0), "{name}: {said:?}");
        let said = typed(folder.path(), &[&["wiring", "press"], &allowed[..]].concat());
        assert_eq!(said.code, Some(0), "{name}: {said:?}");
        let again = typed(folder.path(), &["new", "press", "--from", &list(name)]);
        assert_eq!(again.code, Some(2), "{name}: {again:?}");
    }
}

/// A PLC that is browsed gives the same signals over both links, and its words are none of them.
#[test]
fn a_scenario_made_of_a_browsed_plc_runs_at_once() {
    let plc = crate::plc::Plc::start(&scenario("shear"), &[]);
    let folder = tempfile::tempdir().unwrap();
    let made = ["opc.tcp://", "ads://"].map(|scheme| {
        let url = plc.gateway(scheme).trim_start_matches("plc=").to_owned();
        let name = scheme.split([':', '.']).next().expect("a name");
        let said = typed(folder.path(), &["new", name, "--from", &url]);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{url}");
        assert!(said.out.contains("13 signals of "), "{}", said.out);
        let said = typed(folder.path(), &["run", name, "--until", "100ms", "--runs", "2"]);
        assert_eq!(said.code, Some(0), "{said:?}");
        let text = std::fs::read_to_string(folder.path().join(name).join("scenario.toml")).unwrap();
        assert!(text.contains(&format!("url = \"{url}\"\nsystem_words = true\n")), "{text}");
        text
    });
    let signals = made.map(|text| {
        let signals = text.split("[signals]\n").nth(1).and_then(|rest| rest.split("\n\n").next()).map(str::to_owned);
        signals.expect("signals")
    });
    assert_eq!(signals[0], signals[1]);
    insta::assert_snapshot!("new_from_browsed_signals", signals[0]);
}

#[test]
fn the_files_made_of_a_list_are_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    typed(folder.path(), &["new", "press", "--from", &list("press.tsproj")]);
    let read = |file: &str| std::fs::read_to_string(folder.path().join("press").join(file)).unwrap();
    let files =
        ["scenario.toml", "plant.toml", "plc/main.st", "README.md"].map(|file| format!("==== {file}\n{}", read(file)));
    insta::assert_snapshot!("new_from_list_files", files.concat());
    let said = typed(folder.path(), &["check", "press", "--deny-warnings"]);
    assert_eq!(said.code, Some(0), "{said:?}");
}

/// Sources run themselves: an input of the list reaches the program.
#[test]
fn sources_that_a_list_was_read_from_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::copy(list("press-plcopen.xml"), folder.join("press.xml")).unwrap();
    typed(folder, &["new", "line/press", "--from", "press.xml"]);
    let file = folder.join("line/press/scenario.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("press.xml\"") && text.contains("step = \"4ms\""), "{text}");
    let expect = "[[expect]]\nname = \"speed\"\nformula = \"always[20ms,90ms] Press.Speed == 7\"\n";
    let plant = "kind = \"operator\"\ninitial = { \"GVL.Guard\" = true }";
    let text =
        text.replace("kind = \"operator\"", plant).replace("[clients.plant]", &format!("{expect}\n[clients.plant]"));
    std::fs::write(&file, text).unwrap();
    let said = typed(folder, &["run", "line/press", "--until", "100ms"]);
    assert_eq!((said.code, said.err.contains("--allow-path")), (Some(2), true), "the sources are outside: {said:?}");
    let said = typed(folder, &["run", "line/press", "--until", "100ms", "--allow-path", "."]);
    assert_eq!(said.code, Some(0), "{said:?}");
}

#[test]
fn a_list_for_machines_is_one_object() {
    let folder = tempfile::tempdir().unwrap();
    let said = typed(folder.path(), &["new", "press", "--from", &list("press-tags.xml"), "--format", "json"]);
    let report: serde_json::Value = serde_json::from_str(&said.out).expect("one JSON object");
    assert_eq!((report["inputs"].as_u64(), report["outputs"].as_u64()), (Some(1), Some(1)), "{report}");
    assert_eq!(report["signals"][0]["signal"], "Guard_closed");
    assert_eq!(report["signals"][0]["name"], "Guard closed");
    assert_eq!(report["signals"][0]["address"], "%I0.0");
    assert_eq!(report["left_out"][1]["name"], "Drive");
    assert_eq!(report["left_out"][1]["line"], 42);
}

#[test]
fn what_is_not_a_list_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("cut.tsproj", "<TcSmProject><Project>");
    write("none.tsproj", "<TcSmProject/>");
    write("picture.png", "png");
    write("book.xlsx", "no book");
    write("wrong.st", "PROGRAM P x := 1; END_PROGRAM");
    write("devices.csv", "#Device;Channel;Type;Variable;Address\nEL1008;Channel 1;BOOL;Start;%IX0.0\n");
    let mut all = String::new();
    for words in [
        &["new", "n", "--from", "missing.tsproj"][..],
        &["new", "n", "--from", "cut.tsproj"],
        &["new", "n", "--from", "none.tsproj"],
        &["new", "n", "--from", "picture.png"],
        &["new", "n", "--from", "devices.csv"],
        &["new", "n", "--from", "book.xlsx"],
        &["new", "n", "--from", "wrong.st"],
        &["new", "n", "--from", "none.tsproj", "--plc", "Press"],
        &["new", "n", "--as", "eni"],
    ] {
        let said = typed(folder.path(), words);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}");
        all.extend([format!("$ onescan {}\n{}\n", words.join(" "), said.err)]);
    }
    assert!(!folder.path().join("n").exists());
    insta::assert_snapshot!("new_from_no_list", all);
}
