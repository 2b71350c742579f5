//! Without lockstep no two runs are equal, and the alignment check of `[SDSP]` Figs. 5 and 6 fails.

use std::collections::BTreeSet;

use crate::typed::{ROUNDS, digests, run_shear, scenario, typed};

/// Alignments seen and levellings made in the recording of a run.
fn alignments(csv: &str) -> (u64, usize) {
    let mut rows = csv.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (count, one, two) = (column("AlignedCount"), column("Sensor_1"), column("Sensor_2"));
    let rows: Vec<_> = rows.collect();
    let level = |row: &Vec<&str>| row[one] == "1" && row[two] == "1";
    let levelled = rows.windows(2).filter(|pair| !level(&pair[0]) && level(&pair[1])).count();
    (rows.last().unwrap()[count].parse().unwrap(), levelled)
}

fn recorded(words: &[&str], runs: usize) -> (Vec<String>, Vec<(u64, usize)>) {
    let folder = tempfile::tempdir().unwrap();
    let (reports, said) =
        run_shear(&[words, &["--record-also", "csv", "--record", folder.path().to_str().unwrap()]].concat());
    // 1: what the scenario expects is what lockstep gives, and free-wheeling loses.
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
    let read = |run| std::fs::read_to_string(folder.path().join(format!("run-{run}/trajectory.csv"))).unwrap();
    (digests(&reports), (1..=runs).map(|run| alignments(&read(run))).collect())
}

/// Two runs may be equal and lose nothing by chance, so there are more until both has been seen.
#[test]
fn free_wheeling_runs_differ_and_lose_alignments() {
    let (mut distinct, mut lost) = (BTreeSet::new(), false);
    for _ in 0..ROUNDS {
        let (digests, alignments) = recorded(&["--mode", "freewheel", "--runs", "3"], 3);
        distinct.extend(digests);
        lost |= alignments.iter().any(|(seen, levelled)| *seen < *levelled as u64);
        if distinct.len() > 1 && lost {
            return;
        }
    }
    panic!("runs without lockstep: {} different, an alignment was lost: {lost}", distinct.len());
}

/// [SDSP] Fig. 4: six runs, six trajectories; by a seed the same six on every machine, and none is that of lockstep.
#[test]
fn runs_of_a_seed_differ_from_each_other_and_are_the_same_everywhere() {
    let lockstep = digests(&run_shear(&[]).0);
    let mut all = Vec::new();
    for mode in ["freewheel", "halt", "follow"] {
        let words = ["--mode", mode, "--runs", "6", "--seed", "1"];
        let found = digests(&run_shear(&words).0);
        assert_eq!(found, digests(&run_shear(&words).0), "{mode}");
        let distinct: BTreeSet<&String> = found.iter().chain(&lockstep).collect();
        assert_eq!(distinct.len(), 7, "{mode}: {found:?}");
        let other = digests(&run_shear(&["--mode", mode, "--seed", "2"]).0);
        assert_ne!(found[0], other[0], "{mode}");
        all.push(format!("{mode}: {}", found[0]));
    }
    // Pinned: whoever runs this elsewhere has these.
    insta::assert_snapshot!(all.join("\n"));
}

/// Fig. 6: of one seed's runs, some see the alignment and some do not.
#[test]
fn the_race_is_won_and_lost_by_seed() {
    let words = ["run", "race.toml", "--mode", "freewheel", "--runs", "4", "--seed", "2", "--format", "json"];
    let said = typed(&scenario("shear"), &words);
    let met = said.out.matches(r#""verdict":"met""#).count();
    assert!((1..4).contains(&met), "{met} of 4: {said:?}");
}

#[test]
fn a_seed_is_for_computed_clocks_only() {
    let (_, said) = run_shear(&["--seed", "1"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("--seed means nothing with --mode lockstep"), "{said:?}");
    let (_, said) = run_shear(&["--mode", "halt", "--seed", "1", "--gateway", "plc=tcp://127.0.0.1:1"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("--seed means nothing with --gateway plc"), "{said:?}");
}

#[test]
fn in_lockstep_every_levelling_is_seen() {
    let (_, alignments) = recorded(&["--runs", "2"], 2);
    assert_eq!(alignments, [(5, 5), (5, 5)]);
}

#[test]
fn what_means_nothing_without_a_server_is_refused() {
    for words in [&["--transport", "tcp"][..], &["--pace", "1"], &["--listen", "127.0.0.1:0"], &["--resume", "x"]] {
        let (_, said) = run_shear(&[&["--mode", "freewheel"], words].concat());
        assert_eq!(said.code, Some(2), "{said:?}");
        assert!(said.err.contains("means nothing with --mode freewheel"), "{said:?}");
    }
}
