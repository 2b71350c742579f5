//! The sheet metal shear beyond what its cases hold: the Ladder Diagram of `[SDSP]` Fig. 3, the race of Fig. 6, the
//! slow sampling of Fig. 7 and the jitter of sec. III-C.

use std::path::Path;

use crate::typed::{copied_shear, digests, edit, scenario, typed};

/// The digest of a run in which all that is expected is met.
fn digest(folder: &Path, words: &[&str]) -> String {
    let said = typed(folder, &[&["run"], words, &["--format", "json"]].concat());
    assert_eq!(said.code, Some(0), "{said:?}");
    digests(&[serde_json::from_str(&said.out).expect("JSON")]).remove(0)
}

/// The last value of a signal in a run.
fn last(words: &[&str], signal: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let record = ["--record-also", "csv", "--record", folder.path().to_str().unwrap()];
    let said = typed(&scenario("shear"), &[&["run"], words, &record].concat());
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
    let text = std::fs::read_to_string(folder.path().join("run-1/trajectory.csv")).expect("a recording");
    let (head, end) = (text.lines().next().expect("a head"), text.lines().last().expect("a row"));
    let column = head.split(',').position(|name| name == signal).expect("recorded");
    end.split(',').nth(column).expect("a value").to_owned()
}

/// The Ladder Diagram is the program in Structured Text to the bit; so is the one with the shim that is not simulated.
#[test]
fn the_ladder_diagram_gives_the_same_digest() {
    let shear = copied_shear();
    let text = digest(shear.path(), &["."]);
    assert_eq!(digest(shear.path(), &["ladder.toml"]), text);
    let drawn = shear.path().join("plc-ld/shear.xml");
    let before = std::fs::read(&drawn).unwrap();
    let said = typed(shear.path(), &["instrument", "plc-ld/shear.xml", "--in-place"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    let simulated = "<variable name=\"SDSP_Simulated\"><type><BOOL/></type><initialValue><simpleValue value=\"TRUE\"/>";
    edit(shear.path(), "plc-ld/shear.xml", simulated, &simulated.replace("TRUE", "FALSE"));
    assert_eq!(digest(shear.path(), &["ladder.toml"]), text);
    let said = typed(shear.path(), &["instrument", "plc-ld/shear.xml", "--in-place", "--remove"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(std::fs::read(&drawn).unwrap(), before);
}

/// Another contact is another machine, so that the comparison above can fail.
#[test]
fn another_contact_in_the_ladder_gives_another_digest() {
    let shear = copied_shear();
    let text = digest(shear.path(), &["."]);
    edit(shear.path(), "plc-ld/shear.xml", "<contact localId=\"31\" negated=\"true\"", "<contact localId=\"31\"");
    let said = typed(shear.path(), &["run", "ladder.toml", "--format", "json"]);
    assert!(!said.out.contains(&text), "{said:?}");
}

/// Fig. 6: in lockstep c comes with a and b; free-wheeling runs are drawn apart, a panel for each signal of each run.
#[test]
fn the_race_is_drawn_run_by_run() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("race.svg");
    let words = ["run", "race.toml", "--mode", "freewheel", "--runs", "2", "--apart", "--plot", plot.to_str().unwrap()];
    let said = typed(&scenario("shear"), &words);
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
    let svg = std::fs::read_to_string(plot).unwrap();
    for panel in ["run 1: a", "run 1: b", "run 1: c", "run 2: a", "run 2: b", "run 2: c"] {
        assert!(svg.contains(&format!(">{panel}<")), "{panel}");
    }
    assert_eq!(last(&["race.toml", "--until", "6s"], "AlignedCount"), "5");
    let said = typed(&scenario("shear"), &["run", ".", "--apart"]);
    assert_eq!(said.code, Some(2), "there is no plot: {said:?}");
}

/// Fig. 7: a change that is faster than the update rate is not recognised.
#[test]
fn pulses_shorter_than_the_update_rate_are_never_seen() {
    assert_eq!(["Marks", "Marks_seen"].map(|signal| last(&["slow.toml"], signal)), ["10", "2"]);
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("slow.svg");
    let said = typed(&scenario("shear"), &["run", "slow.toml", "--plot", plot.to_str().unwrap()]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(
        said.out.contains("`the client sees every pulse` violated at 0.650 s: Mark = 1, Mark_seen = 0"),
        "{said:?}"
    );
    let plot = std::fs::read_to_string(plot).expect("a plot");
    assert!(plot.contains("Mark") && plot.contains("Mark_seen"), "both are in one plot");
}

/// Sec. III-E: a machine that waits for its PLC is slowed down, and misses nothing: two strokes in place of five.
#[test]
fn slow_sampling_slows_the_machine_down() {
    assert_eq!([last(&["."], "Strokes"), last(&[".", "--case", "slow-sampling"], "Strokes")], ["5", "2"]);
}

/// Sec. III-C: jitter that is real follows the seed, and the alignment check suffers from it.
#[test]
fn normal_jitter_of_the_sensors_is_seen_and_follows_the_seed() {
    let run = |case: &str| digest(&scenario("shear"), &[".", "--case", case]);
    let [first, again, second] = ["seed=1", "seed=1", "seed=2"].map(|seed| run(&format!("sensor-jitter,{seed}")));
    assert_eq!(first, again);
    assert_ne!(first, second);
    let seen: i32 = last(&[".", "--case", "sensor-jitter,seed=1"], "AlignedCount").parse().expect("a number");
    assert!(seen < 5, "{seen}");
}
