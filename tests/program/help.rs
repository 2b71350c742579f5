//! What the program says of itself.

use crate::typed::{scenario, typed};

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
