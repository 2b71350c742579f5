//! `onescan control`: a session held, stepped and released from another terminal.

use std::io::{BufRead, BufReader};

use crate::typed::{begun, copied_shear, digests, edit, onescan, run_shear, scenario, typed};

#[test]
fn a_session_is_paused_stepped_reset_and_released_without_a_trace() {
    let folder = copied_shear();
    edit(folder.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", "kind = \"external\"");
    let words = ["run", ".", "--format", "json", "--until", "2s", "--pace", "1", "--listen", "127.0.0.1:0"];
    let mut server = begun(folder.path(), &words);
    let mut said = BufReader::new(server.stderr.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let address = line.split("waiting at ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap().to_owned();
    let here = scenario("shear");
    let ask = |wish: &str| -> serde_json::Value {
        let said = typed(&here, &["control", &address, wish, "--format", "json"]);
        serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"))
    };
    let mut plant = onescan(&here).args(["join", ".", "plant", "--server", &address]).spawn().unwrap();
    ask("pause");
    let before = ask("status");
    assert_eq!(before["held"], true);
    ask("step");
    let after = ask("status");
    assert_eq!(after["steps"].as_u64(), before["steps"].as_u64().map(|steps| steps + 1));
    ask("reset");
    assert_eq!(ask("status")["steps"], 0);
    let people = typed(&here, &["control", &address]);
    assert_eq!(people.out, "held in state initial-write after step 0, t_v = 0.000 s\n");
    ask("resume");
    let output = server.wait_with_output().unwrap();
    assert!(plant.wait().unwrap().success());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let (undisturbed, _) = run_shear(&["--until", "2s"]);
    assert_eq!(digests(&[report]), digests(&undisturbed));
}
