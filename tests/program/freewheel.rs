//! Without lockstep no two runs are equal, and the alignment check of `[SDSP]` Figs. 5 and 6 fails.

use std::collections::BTreeSet;

use crate::typed::{ROUNDS, digests, run_shear};

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
