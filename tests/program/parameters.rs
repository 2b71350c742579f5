//! Parameters of components that change while a session runs: the same over every way, from every checkpoint, in a campaign.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::typed::{copied, digests, typed, utf8};

const CASES: &str = r#"version = 1
[[case]]
name = "slow-belt"
until = "14s"
waive = ["what comes in goes out"]
parameter = [{ component = "conveyor", parameter = "speed_m_s", value = 0.3, from = "9s", for = "2s" }]

[[case]]
name = "slow-wheel"
until = "14s"
waive = ["what comes in goes out"]
[[case.parameter]]
component = "large_motor"
parameter = "speed_rad_s"
value = 0.3
when = "rose(IN_LW_CONTAINER_READY)"
nth = 2

[[campaign]]
name = "wear"
until = "14s"
fault = [
    { name = "belt", kind = "model", parameter = { component = "conveyor", parameter = "speed_m_s", value = 0.3 } },
    { name = "same", kind = "model", parameter = { component = "conveyor", parameter = "speed_m_s", value = 0.5 } },
]
activation = [{ name = "later", at = "9s", for = "2s" }]
"#;

fn with_cases(cases: &str) -> tempfile::TempDir {
    let folder = copied("filling-machine");
    fs::write(folder.path().join("cases.toml"), cases).expect("writable");
    folder
}

fn run(folder: &Path, words: &[&str]) -> String {
    let said = typed(folder, &[&["run", ".", "--until", "14s", "--format", "json"], words].concat());
    let reports: Vec<Value> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(reports.len(), 1, "{words:?}: {said:?}");
    digests(&reports).remove(0)
}

#[test]
fn a_change_is_the_same_over_every_way_and_from_every_checkpoint() {
    let folder = with_cases(CASES);
    let at = |name: &str| folder.path().join(name);
    let plain = run(folder.path(), &["--save-at", "8s", "--save", utf8(&at("healthy"))]);
    for case in ["slow-belt", "slow-wheel"] {
        let own = at(case);
        // in the middle of it
        let whole = run(folder.path(), &["--case", case, "--save-at", "10s", "--save", utf8(&own)]);
        assert_ne!(whole, plain, "{case}");
        assert_eq!(run(folder.path(), &["--case", case, "--transport", "tcp"]), whole, "{case} over TCP");
        assert_eq!(run(folder.path(), &["--case", case, "--resume", utf8(&own)]), whole, "{case} resumed");
        if case == "slow-belt" {
            let forked = run(folder.path(), &["--case", case, "--resume", utf8(&at("healthy"))]);
            assert_eq!(forked, whole, "{case} from the healthy machine");
        }
    }
}

#[test]
fn a_campaign_changes_parameters() {
    let folder = with_cases(CASES);
    let said = typed(folder.path(), &["campaign", ".", "--format", "json", "--jobs", "2"]);
    let rows: Vec<Value> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(rows.len(), 2 + 1, "{said:?}");
    assert_eq!(rows[0]["digest"], run(folder.path(), &["--case", "slow-belt"]), "a case of its own");
    assert_eq!(rows[0]["digest"], run(folder.path(), &["--case", "wear/belt/later"]));
    assert_eq!((&rows[1]["verdict"], &rows[1]["digest"]), (&"no-effect".into(), &rows[2]["healthy_digest"]));
}

#[test]
fn what_cannot_change_is_reported_before_anything_runs() {
    let reported = [
        r#"component = "conveyer", parameter = "speed_m_s", value = 1.0"#,
        r#"component = "conveyor", parameter = "speed", value = 1.0"#,
        r#"component = "conveyor", parameter = "speed_m_s", value = "fast""#,
        r#"component = "conveyor", parameter = "speed_m_s", value = -1e9"#,
        r#"component = "conveyor", parameter = "speed_m_s", value = [1.0]"#,
        r#"client = "plc", component = "conveyor", parameter = "speed_m_s", value = 1.0"#,
        r#"component = "sw_offers[0]", parameter = "inputs", value = 1"#,
        r#"component = "conveyor", parameter = "speed_m_s", value = 1.0, until = "1s", for = "1s""#,
    ]
    .map(|keys| {
        let folder = with_cases(&format!("version = 1\n[[case]]\nname = \"worn\"\nparameter = [{{ {keys} }}]\n"));
        let said = typed(folder.path(), &["run", ".", "--case", "worn", "--until", "1s"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{keys}: {said:?}");
        said.err.replace(&folder.path().display().to_string(), ".")
    });
    insta::assert_snapshot!(reported.join("\n"));
}
