//! What an operator does is data: recorded at step boundaries, and repeated to the same digest.

use std::io::{BufRead, BufReader};

use crate::typed::{begun, copied_shear, edit, typed};

#[test]
fn what_an_operator_did_is_repeated_to_the_same_digest() {
    let folder = copied_shear();
    let hour = ["run", ".", "--format", "json", "--until", "1h"];
    let words = ["--pace", "20", "--listen", "127.0.0.1:0", "--record", "live"];
    let mut server = begun(folder.path(), &[hour, words].concat());
    let mut said = BufReader::new(server.stderr.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let address = line.split("listening at ").nth(1).and_then(|rest| rest.split(' ').next()).expect("an address");
    let ask = |words: &[&str]| {
        let said = typed(folder.path(), &[&["control", address], words].concat());
        assert_eq!(said.code, Some(0), "{words:?} {said:?}");
    };
    ask(&["force", "Sensor_1", "TRUE"]);
    ask(&["reset"]);
    ask(&["pause"]);
    ask(&["write", "Strokes", "-5"]);
    ask(&["force", "Sensor_2", "1"]);
    for _ in 0..20 {
        ask(&["step"]);
    }
    ask(&["release", "Sensor_2"]);
    ask(&["resume"]);
    let refused = typed(folder.path(), &["control", address, "force", "Senosr_1", "TRUE"]);
    assert!(refused.err.contains("no signal `Senosr_1`; did you mean"), "{refused:?}");
    let refused = typed(folder.path(), &["control", address, "write", "Strokes", "many"]);
    assert!(refused.err.contains("`many` is not of type DINT"), "{refused:?}");
    ask(&["stop"]);
    let output = server.wait_with_output().unwrap();
    let live: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(live["status"], "stopped");
    for source in ["live", "live/run-1/events.jsonl"] {
        let words = ["--replay-operator", source, "--record", "again", "--overwrite"];
        let said = typed(folder.path(), &[&hour[..], &words].concat());
        let again: serde_json::Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
        assert_eq!((&again["digest"], &again["steps"]), (&live["digest"], &live["steps"]), "{source}");
    }
    let said = typed(folder.path(), &["diff", "live", "again"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let said = typed(folder.path(), &["run", ".", "--format", "json", "--until", "1s", "--record", "plain"]);
    assert!(said.code.is_some());
    assert_eq!(typed(folder.path(), &["diff", "live", "plain"]).code, Some(1), "what was done matters");
}

#[test]
fn inputs_can_be_written_by_hand() {
    let folder = copied_shear();
    let inputs = "{\"step\":5,\"t_v_ns\":50000000,\"event\":\"operator\",\"action\":\"force\",\"signal\":\"Sensor_1\",\"value\":\"TRUE\"}\n";
    std::fs::write(folder.path().join("inputs.jsonl"), inputs).unwrap();
    let words = [
        "run",
        ".",
        "--until",
        "200ms",
        "--replay-operator",
        "inputs.jsonl",
        "--record",
        "r",
        "--record-also",
        "csv",
        "--overwrite",
    ];
    assert!(typed(folder.path(), &words).code.is_some());
    let csv = std::fs::read_to_string(folder.path().join("r/run-1/trajectory.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|row| row.split(',').collect()).collect();
    let sensor = rows[0].iter().position(|name| *name == "Sensor_1").unwrap();
    let forced: Vec<&str> = rows[1..].iter().map(|row| row[sensor]).collect();
    assert_eq!((forced[5], forced[6], forced[20]), ("0", "1", "1"));
    edit(folder.path(), "inputs.jsonl", "\"force\"", "\"farce\"");
    let said = typed(folder.path(), &words);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("inputs.jsonl: line 1: unknown variant `farce`"), "{said:?}");
}

/// A switch that is turned stays turned, in either coupling and in whatever order clients run.
#[test]
fn what_is_written_to_an_operators_signal_stands() {
    let scenario = |coupling: &str| {
        format!(
            "version = 1\nstep = \"10ms\"\nuntil = \"200ms\"\ncoupling = {coupling}
[signals]\nlevel = {{ type = \"INT\", writer = \"hand\" }}\nseen = {{ type = \"INT\", writer = \"plc\" }}
[clients.hand]\nkind = \"operator\"\ninitial = {{ level = 1 }}
[clients.plc]\nkind = \"soft-plc\"\nsources = [\"main.st\"]
tasks = [{{ name = \"main\", interval = \"10ms\", programs = [\"Main\"] }}]\n"
        )
    };
    let write = |step: u64, value: &str| {
        let t_v_ns = step * 10_000_000;
        format!(
            "{{\"step\":{step},\"t_v_ns\":{t_v_ns},\"event\":\"operator\",\"action\":\"write\",\"signal\":\"level\",\"value\":\"{value}\"}}\n"
        )
    };
    let program =
        "PROGRAM Main VAR_INPUT level : INT; END_VAR VAR_OUTPUT seen : INT; END_VAR seen := level; END_PROGRAM";
    let orders =
        [("\"parallel\"", 1), ("{ sequential = [\"hand\", \"plc\"] }", 0), ("{ sequential = [\"plc\", \"hand\"] }", 1)];
    for (coupling, later) in orders {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        file("scenario.toml", &scenario(coupling));
        file("main.st", program);
        file("inputs.jsonl", &[write(0, "2"), write(5, "7"), write(12, "3")].concat());
        let words = ["run", ".", "--replay-operator", "inputs.jsonl", "--record", "r", "--record-also", "csv"];
        let said = typed(folder.path(), &words);
        assert_eq!(said.code, Some(0), "{said:?}");
        let csv = std::fs::read_to_string(folder.path().join("r/run-1/trajectory.csv")).unwrap();
        let rows: Vec<Vec<&str>> = csv.lines().map(|row| row.split(',').collect()).collect();
        let column = |name: &str| {
            let at = rows[0].iter().position(|known| *known == name).unwrap();
            rows[1..].iter().map(|row| row[at].to_owned()).collect::<Vec<_>>()
        };
        let steps = |values: &[(&str, usize)]| -> Vec<String> {
            values.iter().flat_map(|(value, count)| vec![(*value).to_owned(); *count]).collect()
        };
        assert_eq!(column("level"), steps(&[("1", 1), ("2", 5), ("7", 7), ("3", 8)]), "{coupling}");
        let seen = &column("seen")[1 + later..];
        assert_eq!(seen, &column("level")[1..=seen.len()], "{coupling}");
    }
}
