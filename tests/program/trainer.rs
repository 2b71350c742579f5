//! What a trainer does by hand while a lesson runs: sensors and links that fail, views for the trainee; and what the trainee
//! opens. All of it that changes anything is in the recording, and is repeated.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::sitter::Sitter;
use crate::training::{Lesson, SECOND_NS, record_of, train};
use crate::typed::{copied, edit, scenario, typed, utf8};

/// The events of a recording.
fn events(run: &Path) -> Vec<Value> {
    let text = fs::read_to_string(run.join("events.jsonl")).expect("events");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// Every lesson has an expert, who passes it, and whose recording is repeated to its digest.
#[test]
fn experts_pass_all_lessons() {
    let folder = tempfile::tempdir().expect("a folder");
    for lesson in ["three-malfunctions", "cave-in", "tap", "blind", "link-lost"] {
        let session = folder.path().join(lesson);
        let expert = format!("experts/{lesson}.jsonl");
        let first = train(folder.path(), &[lesson, "--replay-operator", &expert, "--record", utf8(&session)]);
        assert_eq!(first.code, Some(0), "{first:?}");
        let first = record_of(&first);
        assert_eq!(first["attempts"][0]["score"], first["expert"]["score"], "{lesson}: the expert is the lesson's");
        let again = record_of(&train(folder.path(), &[lesson, "--replay-operator", utf8(&session)]));
        assert_eq!(again["attempts"], first["attempts"], "{lesson}");
    }
}

/// The trainer cuts the link of the PLCs: all of its signals at one boundary. The trainee opens the right page, puts out the
/// arcs by hand, and gets the link back. Digest and score are those of every repetition.
#[test]
fn a_link_is_lost_and_found_by_hand() {
    const LINK: [&str; 5] = ["Power_release", "Lower_release", "Programme", "Regulation_fault", "Fault_kind"];
    let folder = tempfile::tempdir().expect("a folder");
    let (starts, session) = (folder.path().join("starts"), folder.path().join("session"));
    let lesson = Lesson::begin(&["link-lost", "--starts", utf8(&starts), "--record", utf8(&session), "--pace", "4"]);
    let seen = ["Breaker_closed", "Current[1]", "Current[2]", "Current[3]", "Electrode_automatic", "Page", "Automatic"];
    let mut trainee = Sitter::at(&lesson.pages[0], "pulpit", &seen);
    let mut trainer = Sitter::at(&lesson.pages[1], "malfunctions", &["Page", "Power_release"]);
    trainee.ask(&json!({"type": "disturb", "disturbance": 0, "active": true}));
    assert!(
        trainee.received("error")["message"].as_str().is_some_and(|message| message.contains("trainer's business"))
    );
    trainer.ask(&json!({"type": "disturb", "disturbance": 99, "active": true}));
    assert_eq!(trainer.received("error")["message"], "there is no disturbance 99");

    let link = trainer.disturb("Link of the PLCs lost", true);
    let at_work = |status: &Value| status["disturbed"].as_array().is_some_and(|all| all.contains(&json!(link)));
    while !at_work(&trainer.received("status")) {}
    trainee.write("Automatic", 0.0);
    trainee.until(|trainee| trainee.value("Automatic") == 0.0);
    assert!(trainee.value("Breaker_closed") == 1.0, "nobody takes the power off");
    assert_eq!(trainee.status.get("disturbed"), None, "the trainee does not see what it is");
    trainee.write("Page", 3.0);
    trainer.until(|trainer| trainer.value("Page") == 3.0);
    trainee.write("Electrode_automatic", 0.0);
    for lever in ["Lever[1]", "Lever[2]", "Lever[3]"] {
        trainee.write(lever, 1.0);
    }
    let is_out =
        |trainee: &Sitter| ["Current[1]", "Current[2]", "Current[3]"].iter().all(|one| trainee.value(one) < 1e3);
    trainee.until(|trainee| trainee.value("Electrode_automatic") == 0.0 && is_out(trainee));
    trainer.disturb("Link of the PLCs lost", false);
    while at_work(&trainer.received("status")) {}
    trainer.until(|trainer| trainer.value("Power_release") == 0.0);
    trainee.until(|trainee| trainee.value("Breaker_closed") == 0.0);
    trainer.ask(&json!({"type": "operate", "operation": "stop"}));
    let held = lesson.record();

    let malfunction = &held["attempts"][0]["score"]["malfunctions"][0];
    for response in ["identified", "acted"] {
        assert!(
            malfunction[response]["after_ns"].as_u64().is_some_and(|after| after < 120 * SECOND_NS),
            "{malfunction}"
        );
    }
    let events = events(&session.join("run-1"));
    let steps = |action: &str| {
        let of = events.iter().filter(|event| event["action"] == action && event["event"] == "operator");
        let (steps, signals): (Vec<&Value>, Vec<&str>) =
            of.map(|event| (&event["step"], event["signal"].as_str().expect("a signal"))).unzip();
        assert_eq!(signals, LINK, "{action}");
        assert!(steps.iter().all(|step| *step == steps[0]), "{action} at one boundary: {steps:?}");
    };
    steps("disturb");
    steps("mend");
    // It is identified with the image in which the page is open.
    let opened = events.iter().find(|event| event["signal"] == "Page").expect("recorded");
    let image_ns = opened["t_v_ns"].as_u64().expect("a time") + 20_000_000;
    assert_eq!(malfunction["identified"]["at_ns"], json!(image_ns));

    let digest = &held["attempts"][0]["digest"];
    for source in [session.join("run-1"), session] {
        let again = record_of(&train(&starts, &["link-lost", "--replay-operator", utf8(&source)]));
        let (again, before) = (&again["attempts"][0]["score"]["malfunctions"], &again["attempts"][0]["digest"]);
        assert_eq!(again[0], *malfunction);
        // A recording alone goes on to the end of the lesson, where the session had been stopped.
        assert!(before == digest || source.ends_with("run-1"), "{before} {digest}");
    }
}

/// A view that the trainer calls is shown on the trainee's page, and leaves no trace.
#[test]
fn a_view_is_for_the_eye_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let (starts, session) = (folder.path().join("starts"), folder.path().join("session"));
    let lesson = Lesson::begin(&["cave-in", "--starts", utf8(&starts), "--record", utf8(&session), "--pace", "20"]);
    let mut trainee = Sitter::at(&lesson.pages[0], "pulpit", &["Page"]);
    let mut trainer = Sitter::at(&lesson.pages[1], "malfunctions", &["Page"]);
    // the lesson begins with a view of its own
    assert_eq!(
        (&trainee.received("view")["view"], &trainer.received("view")["view"]),
        (&json!("bath"), &json!("bath"))
    );
    trainee.ask(&json!({"type": "view", "view": "front"}));
    assert!(
        trainee.received("error")["message"].as_str().is_some_and(|message| message.contains("trainer's business"))
    );
    trainer.ask(&json!({"type": "view", "view": "nowhere"}));
    assert_eq!(trainer.received("error")["message"], "there is no view `nowhere`");
    trainer.ask(&json!({"type": "view", "view": "front"}));
    assert_eq!(
        (&trainee.received("view")["view"], &trainer.received("view")["view"]),
        (&json!("front"), &json!("front"))
    );
    trainer.until(|trainer| trainer.t_ns > 790 * SECOND_NS);
    let held = {
        // to the end of the lesson
        let record = lesson.record();
        record["attempts"][0].clone()
    };
    assert!(events(&session.join("run-1")).iter().all(|event| event["event"] != "operator"), "no trace");
    let nothing = folder.path().join("nothing.jsonl");
    fs::write(&nothing, "").expect("writable");
    let unseen = record_of(&train(&starts, &["cave-in", "--replay-operator", utf8(&nothing)]));
    assert_eq!(unseen["attempts"][0]["digest"], held["digest"]);
}

/// Going back to a moment at which a sensor was stuck, the trainer's panel shows that it is, and can mend it.
#[test]
fn what_was_at_work_is_at_work_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let lesson = Lesson::begin(&["cave-in", "--starts", utf8(folder.path()), "--pace", "20"]);
    let mut trainer = Sitter::at(&lesson.pages[1], "malfunctions", &["Page"]);
    let stuck = trainer.disturb("Wall pressure stuck", true);
    let at_work = |status: &Value| status["disturbed"].as_array().is_some_and(|all| all.contains(&json!(stuck)));
    while !at_work(&trainer.received("status")) {}
    let begun_ns = trainer.t_ns;
    trainer.until(|trainer| trainer.t_ns > begun_ns + 10 * SECOND_NS);
    trainer.disturb("Wall pressure stuck", false);
    while at_work(&trainer.received("status")) {}
    trainer.ask(&json!({"type": "train", "turn": "back", "t_ns": (begun_ns + 5 * SECOND_NS) as f64}));
    while !at_work(&trainer.received("status")) {}
    trainer.ask(&json!({"type": "operate", "operation": "go"}));
    trainer.disturb("Wall pressure stuck", false);
    while at_work(&trainer.received("status")) {}
    trainer.ask(&json!({"type": "operate", "operation": "stop"}));
    assert_eq!(lesson.record()["attempts"].as_array().map(Vec::len), Some(2));
}

/// Lessons stand in several files; what is wrong in one of them, or on a panel, has its place there.
#[test]
fn lessons_in_a_folder_are_checked_at_their_places() {
    let listed = typed(&scenario("arc-furnace"), &["train", "."]);
    assert!(
        listed.code == Some(0) && listed.out.contains("\nblind\n") && listed.out.contains("\nlink-lost\n"),
        "{listed:?}"
    );
    for (file, from, to, reported) in [
        ("lessons/blind.toml", "\"melting\"", "\"meltin\"", "there is no start `meltin`"),
        ("lessons.toml", "view = \"bath\"", "view = \"bth\"", "there is no view `bth`"),
        ("lessons/blind.toml", "name = \"blind\"", "name = \"tap\"", "two lessons are called `tap`"),
        ("lessons/blind.toml", "\"water\"", "\"watr\"", "there is no page `watr`"),
        ("lessons/blind.toml", "identify_page = \"water\"", "identify_page = \"pulpit\"", "there is no page `pulpit`"),
        (
            "lessons/link-lost.toml",
            "kind = \"stuck\" }",
            "kind = \"stuck\", for = \"1s\" }",
            "comes by the trainer's hand",
        ),
        ("lessons/link-lost.toml", "\"Fault_kind\"", "\"Fault_kin\"", "the scenario has no signal `Fault_kin`"),
        (
            "scenario.toml",
            "\"Wall_water\", kind = \"stuck\"",
            "\"Wall_watr\", kind = \"stuck\"",
            "no signal `Wall_watr`",
        ),
        ("scenario.toml", "\"Wall_water\", kind = \"stuck\"", "\"Wall_water\", kind = \"inverted\"", "not BOOL"),
    ] {
        let folder = copied("arc-furnace");
        edit(folder.path(), file, from, to);
        let said = typed(folder.path(), &["train", "."]);
        assert!(said.code == Some(2) && said.err.contains(reported) && said.err.contains(file), "{said:?}");
    }
    let folder = copied("arc-furnace");
    fs::remove_file(folder.path().join("lessons.toml")).expect("removed");
    let alone = typed(folder.path(), &["train", "."]);
    assert!(alone.code == Some(2) && alone.err.contains("there is no start `melting`"), "{alone:?}");
    fs::remove_dir_all(folder.path().join("lessons")).expect("removed");
    let none = typed(folder.path(), &["train", "."]);
    assert!(none.code == Some(2) && none.err.contains("lessons stand in a `lessons.toml`"), "{none:?}");
}
