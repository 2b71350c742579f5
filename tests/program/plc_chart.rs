//! A chart that is drawn, in a PLC that is a process of its own: instrumented, under grants, with the digest of the
//! run in one process.

use crate::plc::Plc;
use crate::typed::{copied, digests, typed};

#[test]
fn a_drawn_chart_under_grants_has_the_digest_of_the_run_in_one_process() {
    let folder = copied("filling-machine");
    let text = std::fs::read_to_string(folder.path().join("sfc.toml")).unwrap();
    let link = "\n[clients.plc.gateway]\nurl = \"tcp://127.0.0.1:2000\"\nsystem_words = true\n";
    // The chart becomes the folder's scenario, and takes in the one that was.
    std::fs::rename(folder.path().join("scenario.toml"), folder.path().join("text.toml")).unwrap();
    let text = text.replace("base = \"scenario.toml\"", "base = \"text.toml\"");
    std::fs::write(folder.path().join("scenario.toml"), text + link).unwrap();
    let run = |words: &[&str]| {
        // Both wheels turn by then, in the second step of the chart.
        let said = typed(folder.path(), &[&["run", ".", "--format", "json", "--until", "1s"], words].concat());
        assert_eq!(said.code, Some(0), "{said:?}");
        digests(&[serde_json::from_str(said.out.trim()).expect("a report")])
    };
    let plc = Plc::start(folder.path(), &["--client", "plc"]);
    assert_eq!(run(&["--gateway", &plc.gateway("tcp://")]), run(&[]));
}
