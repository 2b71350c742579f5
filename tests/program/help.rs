//! What the program says of itself.

use crate::typed::{Said, copied_shear, onescan, scenario, typed};

#[test]
fn help_reads_well() {
    insta::assert_snapshot!("help", typed(&scenario("shear"), &["--help"]).out);
    insta::assert_snapshot!("help_run", typed(&scenario("shear"), &["run", "-h"]).out);
    insta::assert_snapshot!("help_test", typed(&scenario("shear"), &["test", "-h"]).out);
    insta::assert_snapshot!("help_review", typed(&scenario("shear"), &["review", "-h"]).out);
}

#[test]
fn help_on_a_topic_or_command_is_found_by_its_name() {
    let folder = scenario("shear");
    let help = |about: &str| typed(&folder, &["help", about]);
    assert_eq!(typed(&folder, &["help"]).out, typed(&folder, &["--help"]).out);
    assert_eq!(help("run").out, typed(&folder, &["run", "--help"]).out);
    for (topic, word) in [("exit-codes", "143"), ("environment", "ONESCAN_TOKEN"), ("files", "scenario.toml")] {
        let said = help(topic);
        assert!(said.code == Some(0) && said.out.contains(word), "{said:?}");
    }
    let said = help("runn");
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("`runn` is not a command or topic"), "{said:?}");
}

/// In a scenario's folder a command needs no more than its name.
#[test]
fn the_scenario_is_the_one_in_this_folder_unless_another_is_named() {
    let folder = copied_shear();
    for words in [&["run", "--until", "100ms"][..], &["wiring"], &["show"], &["describe"], &["map", "--gateway", "plc"]]
    {
        let said = typed(folder.path(), words);
        assert_eq!(said.code, Some(0), "{words:?}: {said:?}");
    }
    let words = ["run", "--web", "127.0.0.1:0", ".", "--until", "100ms", "--pace", "max"];
    let said = typed(folder.path(), &words);
    assert!(said.code == Some(0) && said.err.contains("http://127.0.0.1:"), "{said:?}");
}

#[test]
fn the_doctor_says_what_is_missing_and_what_does_not_work() {
    let folder = copied_shear();
    let asked = |variables: &[(&str, &str)], words: &[&str]| {
        let mut command = onescan(folder.path());
        command.arg("doctor").args(words).envs(variables.iter().copied());
        Said::from(command.output().expect("the program starts"))
    };
    let said = asked(&[("PATH", "/nowhere"), ("CHROMIUM", "")], &[]);
    assert_eq!(said.code, Some(0), "{said:?}");
    for line in ["missing  browser ", "missing  git ", "ok       OPC UA ", "ok       scenario          in this folder"]
    {
        assert!(said.out.contains(line), "{line}: {said:?}");
    }
    assert!(said.out.lines().all(|line| line.len() <= 200), "{said:?}");
    let said = asked(&[("TMPDIR", "/nowhere"), ("TMP", "/nowhere"), ("TEMP", "/nowhere")], &["--format", "json"]);
    let all: Vec<serde_json::Value> = serde_json::from_str(&said.out).expect("JSON");
    let folder = all.iter().find(|finding| finding["subject"] == "temporary folder").expect("it is looked at");
    assert_eq!((said.code, folder["state"].as_str()), (Some(3), Some("wrong")), "{folder}");
}
