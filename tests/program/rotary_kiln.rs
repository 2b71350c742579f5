//! The rotary kiln: two clocks of rotation, and the slip between ring and shell.

use crate::typed::{is_the_same_over_tcp_and_resumed, scenario, typed};

/// The slip of the mended program is `1 + δ/D`; that of the thesis is short by cams and scans, as derived.
#[test]
fn the_slip_is_right_once_the_clocks_are_mended() {
    let told = |file: &str, code: i32| {
        let said = typed(&scenario("rotary-kiln"), &["run", file]);
        assert_eq!(said.code, Some(code), "{said:?}");
        said.out
    };
    assert!(told(".", 0).contains("`the slip is the lag of the shell` met"));
    let thesis = told("thesis.toml", 1);
    assert!(thesis.contains("Ring_time = 58990"), "{thesis}");
    assert!(thesis.contains("Slip = 1.0125"), "{thesis}");
}

#[test]
fn transport_and_checkpoints_do_not_matter() {
    // The second revolution of the shell has just been taken, that of the ring goes on.
    is_the_same_over_tcp_and_resumed("rotary-kiln", ".", "100s", "70.3s");
}

/// Scenarios in one folder are told apart by their files, and so are their recordings.
#[test]
fn a_comparison_names_the_flip_flop_of_the_thesis() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = |file: &str| {
        let target = folder.path().join(file).to_str().expect("UTF-8").to_owned();
        let said = typed(&scenario("rotary-kiln"), &["run", file, "--until", "20s", "--record", &target]);
        assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
        target
    };
    let (thesis, mended) = (record("thesis.toml"), record("scenario.toml"));
    let said = typed(folder.path(), &["diff", &thesis, &mended]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.out.contains("thesis/timer1.st:12 in PRG_Timer1: GV_Timer1(IN := V_RS.Q1"), "{said:?}");
}
