//! The shear saved at every step of a short run, and on the command line.

use std::path::Path;

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::checkpoint::Checkpoint;
use onescan_server::formation::Formation;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_tests::at_ms;
use onescan_tests::run::run;

use crate::typed::{Said, copied_shear, digests, edit, run_shear, scenario, typed};

fn shear() -> Lockstep {
    let scenario = Scenario::load(&scenario("shear")).unwrap();
    let mut formation = Formation::new(scenario.plan().clone());
    for name in scenario.plan().clients() {
        match scenario.member(name).unwrap() {
            Member::Plant(client) | Member::Plc(client) | Member::Gateway(client) => formation.join(client).unwrap(),
            Member::External(_) | Member::Seated { .. } => panic!("the shear has none"),
        };
    }
    formation.start().unwrap()
}

/// 60 steps: levelling, the first alignment and the rest before the first stroke.
#[test]
fn saved_at_any_step_it_ends_with_the_same_digest() {
    const STEPS: u64 = 60;
    let whole = run(shear(), at_ms(10 * STEPS));
    for step in 0..STEPS {
        let mut first = shear();
        assert_eq!(first.run_to(at_ms(10 * step)).unwrap(), Reached::Boundary);
        let bytes = first.checkpoint().unwrap().to_bytes().unwrap();
        let mut second = shear();
        second.resume(&Checkpoint::from_bytes(&bytes).unwrap()).unwrap();
        assert_eq!(run(second, at_ms(10 * STEPS)), whole, "saved after step {step}");
    }
}

#[test]
fn a_checkpoint_file_goes_on_over_either_transport() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("shear.checkpoint");
    let file = file.to_str().unwrap();
    let (whole, _) = run_shear(&["--until", "2s"]);
    for save_over in ["inproc", "tcp"] {
        let words = ["--until", "2s", "--save-at", "770ms", "--save", file, "--transport", save_over];
        let (saved, said) = run_shear(&words);
        assert_eq!(digests(&saved), digests(&whole), "saving changes nothing: {said:?}");
        for resume_over in ["inproc", "tcp"] {
            let (resumed, said) = run_shear(&["--until", "2s", "--resume", file, "--transport", resume_over]);
            assert_eq!(digests(&resumed), digests(&whole), "{save_over} to {resume_over}: {said:?}");
        }
        std::fs::remove_file(Path::new(file)).unwrap();
    }
}

#[test]
fn a_cut_checkpoint_is_wrong_input() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("shear.checkpoint");
    run_shear(&["--until", "1s", "--save-at", "500ms", "--save", file.to_str().unwrap()]);
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    let (_, said) = run_shear(&["--resume", file.to_str().unwrap()]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("damaged: its check sum does not fit its bytes"), "{said:?}");
}

/// A checkpoint that cannot be written takes nothing from the run: it is reported, and then why there is none.
#[test]
fn a_run_that_cannot_be_saved_is_reported_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    // No system takes such a name, and that shows only when the file gets it.
    let (file, record) = (folder.path().join("x".repeat(300)), folder.path().join("out"));
    let words =
        ["run", ".", "--format", "json", "--until", "1s", "--save-at", "500ms", "--save", file.to_str().unwrap()];
    let said = typed(&scenario("shear"), &[&words[..], &["--record", record.to_str().unwrap()]].concat());
    assert_eq!(said.code, Some(2), "a name that is too long: {said:?}");
    let report: serde_json::Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
    let (undisturbed, _) = run_shear(&["--until", "1s"]);
    assert_eq!(digests(&[report]), digests(&undisturbed));
    assert!(record.join("run-1/run.json").is_file() && said.err.contains("xxx"), "{said:?}");
}

/// The machine stands where it stood, and another program goes on with it.
#[test]
fn other_code_of_equal_layout_goes_on_where_it_is_asked_for() {
    let folder = copied_shear();
    let run =
        |words: &[&str]| typed(folder.path(), &[&["run", ".", "--until", "2s", "--format", "json"], words].concat());
    let reports = |said: &Said| -> Vec<serde_json::Value> {
        said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
    };
    let whole = run(&["--save-at", "1s", "--save", "s.ckpt"]);
    assert_eq!(whole.code, Some(0), "{whole:?}");
    let resume = ["--resume", "s.ckpt"];
    let accept = ["--resume", "s.ckpt", "--accept-code"];
    // The same code is accepted anyhow, to the same digest.
    assert_eq!(digests(&reports(&run(&accept))), digests(&reports(&whole)));
    let cases = "version = 1\n\n[[case]]\nname = \"rest\"\nset.plc.Shear.Rest = \"T#30ms\"\n\n\
                 [[case]]\nname = \"strokes\"\nset.plc.Shear.Strokes = 4\n\n\
                 [[case]]\nname = \"speed\"\nset.plant.actuator_1.speed_m_s = 0.2\n";
    std::fs::write(folder.path().join("cases.toml"), cases).expect("written");
    let rest = run(&[&accept[..], &["--case", "rest"]].concat());
    assert_eq!(rest.code, Some(0), "{rest:?}");
    assert_ne!(digests(&reports(&rest)), digests(&reports(&whole)), "it rests for a shorter time from there on");
    let again = run(&[&accept[..], &["--case", "rest"]].concat());
    assert_eq!(digests(&reports(&rest)), digests(&reports(&again)));
    let reported = |words: &[&str]| {
        let said = run(words);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}: {said:?}");
        said.err
    };
    let mut all = vec![
        reported(&[&resume[..], &["--case", "rest"]].concat()),
        reported(&[&accept[..], &["--case", "strokes"]].concat()),
        reported(&[&accept[..], &["--case", "speed"]].concat()),
        reported(&[&accept[..], &["--transport", "tcp"]].concat()),
    ];
    edit(folder.path(), "plc/shear.st", "Rest : TIME := T#100ms;", "Rest : TIME := T#90ms;");
    all.push(reported(&resume));
    let edited = run(&accept);
    assert_eq!(edited.code, Some(0), "{edited:?}");
    edit(folder.path(), "plc/shear.st", "VAR CONSTANT", "VAR more : INT; END_VAR\nVAR CONSTANT");
    all.push(reported(&accept));
    insta::assert_snapshot!(all.join("\n"));
}
