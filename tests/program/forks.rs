//! A checkpoint of one case taken up by another: the run up to an instant is paid once.

use std::path::PathBuf;

use onescan_scenario::Scenario;
use onescan_scenario::case::Catalogue;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::When;

use crate::typed::{Said, copied, digests, edit, scenario, typed};

/// A step that both cases have behind them, ms: where there is nothing that differs it is in the middle.
const BEFORE_ANYTHING_MS: u64 = 500;

/// Every scenario of the project, with its cases.
fn all() -> Vec<(PathBuf, Scenario, Catalogue)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(scenario(".")).expect("the scenarios") {
        let path = entry.expect("an entry").path();
        if path.join("scenario.toml").is_file() {
            let loaded = Scenario::load(&path).expect("a scenario");
            let catalogue = Catalogue::load(&path).expect("its cases");
            found.push((path, loaded, catalogue));
        }
    }
    assert!(found.len() >= 3, "the project has scenarios");
    found
}

fn run(path: &std::path::Path, words: &[&str]) -> (Vec<serde_json::Value>, Said) {
    let said = typed(path, &[&["run", ".", "--format", "json"], words].concat());
    (said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect(), said)
}

/// Virtual time of the last boundary at which nothing of the case has happened, if it has a time.
fn last_boundary_before(case: &Scenario) -> VirtualTime {
    let first =
        case.timeline().iter().filter_map(|one| if let When::At(at) = one.when { Some(at) } else { None }).min();
    let step = case.plan().step();
    first.map_or(VirtualTime::from_nanos(BEFORE_ANYTHING_MS * 1_000_000), |at| at.saturating_sub(step))
}

#[test]
fn every_case_goes_on_from_the_checkpoint_of_the_scenario_as_it_is() {
    let (mut forked, mut refused) = (0, 0);
    for (path, plain, catalogue) in all() {
        let folder = tempfile::tempdir().unwrap();
        for case in catalogue.cases() {
            let applied = plain.clone().with_case(&catalogue, case).expect("a case");
            let at = last_boundary_before(&applied);
            let file = folder.path().join(format!("{}.checkpoint", case.name));
            let file = file.to_str().unwrap();
            let (saved, said) = run(
                &path,
                &["--save-at", &at.to_string(), "--save", file, "--until", &(at + plain.plan().step()).to_string()],
            );
            assert_eq!(saved.len(), 1, "{said:?}");
            let (resumed, said) = run(&path, &["--case", &case.name, "--resume", file]);
            // messages are broken at the width of a terminal
            let reported = crate::typed::flat(&said.err);
            if at == VirtualTime::ZERO && reported.contains("before the checkpoint at 0.000 s") {
                // What happens in the set-up has no boundary before it.
                refused += 1;
            } else if case.settings.is_empty() && case.seed.is_none() {
                let (whole, _) = run(&path, &["--case", &case.name]);
                assert_eq!(digests(&resumed), digests(&whole), "{} {}: {said:?}", plain.name(), case.name);
                forked += 1;
            } else {
                // Another parameter has been there from the start: the error names it.
                assert_eq!(said.code, Some(2), "{said:?}");
                assert!(reported.contains(&format!("case `{}` has another `", case.name)), "{reported}");
                refused += 1;
            }
        }
    }
    assert!(forked >= 5 && refused >= 2, "{forked} forked, {refused} refused");
}

#[test]
fn what_happened_before_the_checkpoint_must_have_happened_in_both() {
    let shear = scenario("shear");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.checkpoint");
    let file = file.to_str().unwrap();
    run(&shear, &["--save-at", "1.5s", "--save", file, "--until", "1.6s"]);
    let (_, late) = run(&shear, &["--case", "sensor-lost", "--resume", file]);
    run(&shear, &["--case", "sensor-lost", "--save-at", "1.5s", "--save", file, "--until", "1.6s"]);
    let (_, other) = run(&shear, &["--resume", file]);
    let (own, said) = run(&shear, &["--case", "sensor-lost", "--resume", file]);
    let (whole, _) = run(&shear, &["--case", "sensor-lost"]);
    assert_eq!(digests(&own), digests(&whole), "{said:?}");
    assert_eq!((late.code, other.code), (Some(2), Some(2)));
    let reported = |said: &Said| said.err.replace(file, "FILE");
    insta::assert_snapshot!(format!("{}\n{}", reported(&late), reported(&other)));
}

#[test]
fn a_page_coverage_and_watches_begin_at_a_checkpoint_of_the_plain_run() {
    let shear = scenario("shear");
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let file = path("a.checkpoint");
    run(&shear, &["--save-at", "2s", "--save", &file, "--until", "3s"]);
    let (whole, _) = run(&shear, &["--until", "3s"]);
    for more in [
        vec!["--html".to_owned(), path("p.html")],
        vec!["--coverage".to_owned(), path("l.info")],
        vec!["--watch".to_owned(), "Shear.Strokes".to_owned()],
    ] {
        let mut words = vec!["--until", "3s", "--resume", &file];
        words.extend(more.iter().map(String::as_str));
        let (resumed, said) = run(&shear, &words);
        assert_eq!(digests(&resumed), digests(&whole), "{more:?}: {said:?}");
    }
}

/// A force of a case and an operator's force at the same boundary are one thing.
#[test]
fn an_operator_and_a_case_do_the_same() {
    let folder = copied("shear");
    let events = folder.path().join("events.jsonl");
    // The last boundary before 1.2 s: after step 119, t_v = 1.19 s; let go before the step that ends at 2.4 s.
    let input = |step: u64, what: &str| {
        format!("{{\"step\":{step},\"t_v_ns\":{},\"event\":\"operator\",{what}}}\n", step * 10_000_000)
    };
    let force = input(119, "\"action\":\"force\",\"signal\":\"Sensor_1\",\"value\":\"0\"");
    let release = input(239, "\"action\":\"release\",\"signal\":\"Sensor_1\"");
    let began = "{\"step\":0,\"t_v_ns\":0,\"event\":\"began\"}\n";
    std::fs::write(&events, format!("{began}{force}{release}")).unwrap();
    let (operated, said) = run(folder.path(), &["--until", "4s", "--replay-operator", "events.jsonl"]);
    let (case, _) = run(folder.path(), &["--case", "sensor-lost"]);
    assert_eq!(digests(&operated), digests(&case), "{said:?}");
}

/// Conditions, faults of signals, variables: each does something, over both transports alike.
#[test]
fn operations_by_condition_are_repeatable() {
    let folder = copied("shear");
    let more = "\n[[case]]\nname = \"by-condition\"\nuntil = \"3s\"\nwaive = [\"both sides at once\"]\n\
        [[case.force]]\nsignal = \"Sensor_1\"\nvalue = false\nwhen = \"Position_1 < -0.05\"\nfor = \"200ms\"\n\
        [[case.disturbance]]\nsignal = \"Position_2\"\nkind = \"offset\"\nby = 0.01\nfrom = \"500ms\"\nuntil = \"700ms\"\n\
        [[case.disturbance]]\nsignal = \"Sensor_2\"\nkind = \"late\"\nby = \"30ms\"\n\
        [[case.variable]]\nvariable = \"Shear.Strokes\"\nvalue = 40\nat = \"1s\"\n";
    let cases = std::fs::read_to_string(folder.path().join("cases.toml")).unwrap();
    std::fs::write(folder.path().join("cases.toml"), cases + more).unwrap();
    let (inproc, said) = run(folder.path(), &["--case", "by-condition"]);
    let (tcp, _) = run(folder.path(), &["--case", "by-condition", "--transport", "tcp"]);
    let (plain, _) = run(folder.path(), &["--until", "3s"]);
    assert_eq!(digests(&inproc), digests(&tcp), "{said:?}");
    assert_ne!(digests(&inproc), digests(&plain));
    edit(folder.path(), "cases.toml", "Position_1 < -0.05", "eventually Sensor_1");
    let (_, wrong) = run(folder.path(), &["--case", "by-condition"]);
    assert_eq!(wrong.code, Some(2));
    insta::assert_snapshot!(wrong.err.replace(folder.path().to_str().unwrap(), "FOLDER"));
}
