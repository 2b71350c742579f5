//! `onescan grade`: programs that were handed in are marked, each by itself, and a hostile one harms nobody else.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::typed::{Said, onescan, scenario, typed};

/// A way to push boxes off the belt that meets everything.
const RIGHT: &str = "\
PROGRAM Main
VAR_INPUT
    Box_There, Cylinder_Out, Cylinder_In : BOOL;
END_VAR
VAR_OUTPUT
    Belt_On, Push : BOOL;
    Pushed : DINT;
END_VAR
VAR
    waiting : BOOL := TRUE;     (* for a box *)
END_VAR
    IF waiting AND Box_There AND Cylinder_In THEN
        waiting := FALSE;
        Push := TRUE;
        Pushed := Pushed + 1;
    ELSIF Cylinder_Out THEN
        Push := FALSE;
        waiting := TRUE;
    END_IF;
    Belt_On := waiting AND Cylinder_In AND NOT Push;
END_PROGRAM
";

const CASES: &str = "\
version = 1
[[case]]
name = \"default\"
[[case]]
name = \"slow\"
tags = [\"advanced\"]
set.plant.conveyor.speed_m_s = 0.2
[[case.expect]]
name = \"it counts\"
formula = \"eventually Pushed >= 2\"
marks = 30
";

const HIDDEN: &str = "\
version = 1
[[case]]
name = \"jam\"
until = \"30s\"
[[case.fault]]
component = \"cylinder\"
mode = \"jammed\"
from = \"4s\"
until = \"8s\"
[[case.expect]]
name = \"it goes on after a jam\"
formula = \"eventually Boxes_Out >= 2\"
marks = 10
";

/// A folder with a task made of the template `cell`, which runs for so long, its solution, and `class` for submissions.
fn task(until: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let template = scenario("templates/cell");
    let read = |name: &str| std::fs::read_to_string(template.join(name)).unwrap().replace("{name}", "belt");
    let worth = [("boxes are pushed off", "marks = 40"), ("the belt stands while", "marks = 30\nsafety = true")];
    let mut text = read("scenario.toml").replace("until = \"30s\"", &format!("until = {until:?}"));
    for (name, keys) in worth {
        text = text.replace(&format!("name = \"{name}"), &format!("{keys}\nname = \"{name}"));
    }
    // A task is handed out with a program that does nothing.
    let empty = RIGHT.split_once("\nVAR\n").unwrap().0.to_owned() + "    ;\nEND_PROGRAM\n";
    let variant = "version = 1\nbase = \"scenario.toml\"\n[clients.plc]\nsources = [\"solutions/main.st\"]\n";
    for (name, text) in [
        ("belt/scenario.toml", text.replace("plc/main.st", "skeleton/main.st")),
        ("belt/plant.toml", read("plant.toml")),
        ("belt/README.md", "# Belt\n".to_owned()),
        ("belt/cases.toml", CASES.to_owned()),
        ("belt/skeleton/main.st", empty),
        ("belt/solution-st.toml", variant.to_owned()),
        ("belt/solution-st.cases.toml", CASES.to_owned()),
        ("belt/solutions/main.st", RIGHT.to_owned()),
        ("belt/solutions/hidden.toml", HIDDEN.to_owned()),
    ] {
        write(folder.path(), name, &text);
    }
    folder
}

fn write(folder: &Path, name: &str, text: &str) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

/// What is said of each submission, then of all.
fn graded(folder: &Path, words: &[&str]) -> (Vec<Value>, Value, Said) {
    let said = typed(folder, &[&["grade", "belt", "class/*", "--format", "json"], words].concat());
    let mut lines: Vec<Value> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect();
    let all = lines.pop().unwrap_or_else(|| panic!("{said:?}"));
    (lines, all, said)
}

fn marks(submissions: &[Value]) -> Vec<(String, u64)> {
    let of = |one: &Value| (one["submission"].as_str().unwrap().to_owned(), one["marks"].as_u64().unwrap());
    submissions.iter().map(of).collect()
}

/// The body of the solution with another text in a place of it.
fn with(was: &str, is: &str) -> String {
    assert!(RIGHT.contains(was), "{was}");
    RIGHT.replace(was, is)
}

#[test]
fn full_marks_none_and_what_lies_between() {
    let folder = task("15s");
    let folder = folder.path();
    write(folder, "class/anna/main.st", RIGHT);
    write(folder, "class/ben.st", &with("Belt_On := waiting AND Cylinder_In AND NOT Push;", "Belt_On := TRUE;"));
    write(
        folder,
        "class/carl.st",
        &with("    IF waiting", "    Push := TRUE; Belt_On := TRUE; RETURN;\n    IF waiting"),
    );
    write(folder, "class/dora.st", &with("NOT Push;", "NOT Pusch;"));
    write(
        folder,
        "class/emil/skeleton/main.st",
        &std::fs::read_to_string(folder.join("belt/skeleton/main.st")).unwrap(),
    );
    let said =
        typed(folder, &["grade", "belt", "class/anna", "class/ben.st", "class/carl.st", "class/dora.st", "class/emil"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    insta::assert_snapshot!("class", said.out);
    for name in ["ben.st", "dora.st"] {
        let said = typed(folder, &["grade", "belt", &format!("class/{name}")]);
        assert_eq!(said.code, Some(0), "{said:?}");
        insta::assert_snapshot!(format!("one_{name}"), said.out);
    }
    let (all, statement, _) = graded(folder, &[]);
    assert_eq!(statement["of"], 100);
    let given = marks(&all);
    assert_eq!((given[0].1, given[2].1, given[3].1), (100, 0, 0), "{given:?}");
    assert!(given[1].1 < 100 && all[1]["safety_violations"] == 1, "{}", all[1]);
    assert_eq!((all[4]["as_handed_out"].as_bool(), given[4].1), (Some(true), 30), "it endangers nobody");
}

/// The statement that is wrong, by the solution that the program is like; without one, who wrote the signals.
#[test]
fn the_statement_that_is_wrong_is_named() {
    let folder = task("15s");
    let folder = folder.path();
    let line = |text: &str| 1 + RIGHT.lines().position(|line| line.contains(text)).unwrap();
    let wrongs = [
        ("Belt_On := waiting AND Cylinder_In AND NOT Push;", "Belt_On := TRUE;", line("Belt_On :=")),
        ("        Push := FALSE;", "        Push := TRUE;", line("        Push := FALSE;")),
        ("Pushed := Pushed + 1;", "Pushed := Pushed - 1;", line("Pushed := Pushed + 1")),
        ("IF waiting AND Box_There", "IF waiting AND NOT Box_There", line("IF waiting")),
    ];
    for (was, is, line) in wrongs {
        write(folder, "class/one.st", &with(was, is));
        let (all, ..) = graded(folder, &[]);
        assert!(all[0]["marks"].as_u64().unwrap() < 100, "{is}: {}", all[0]);
        let places = |of: &Value| -> Vec<Value> {
            let expectations = of["expectations"].as_array().unwrap().iter();
            expectations
                .flat_map(|one| one["missed"].as_array().unwrap().clone())
                .map(|one| one["place"].clone())
                .collect()
        };
        let found = places(&all[0]);
        assert!(found.iter().any(|place| place["line"] == line), "{is}: {line} {found:?}");
        assert!(found.iter().all(|place| place.is_null() || place["file"] == "class/one.st"), "{found:?}");
    }
    std::fs::remove_file(folder.join("belt/solution-st.toml")).unwrap();
    let (was, is, line) = &wrongs[0];
    write(folder, "class/one.st", &with(was, is));
    let said = typed(folder, &["grade", "belt", "class/one.st"]);
    let wanted = format!("by class/one.st:{line}: Belt_On := TRUE");
    assert!(said.out.contains(&wanted) && !said.out.contains("the solution"), "{said:?}");
}

#[test]
fn hidden_cases_and_tags_change_what_is_marked() {
    let folder = task("15s");
    let folder = folder.path();
    write(folder, "class/anna.st", RIGHT);
    let (all, statement, _) = graded(folder, &["--hidden", "belt/solutions/hidden.toml"]);
    assert_eq!((statement["of"].as_u64(), statement["cases"].as_u64()), (Some(110), Some(3)));
    assert_eq!(marks(&all)[0].1, 110, "{}", all[0]);
    let hidden: Vec<&Value> =
        all[0]["expectations"].as_array().unwrap().iter().filter(|one| one["hidden"] == true).collect();
    assert_eq!((hidden.len(), &hidden[0]["case"]), (1, &Value::from("jam")));
    let (_, of_folder, _) = graded(folder, &["--hidden", "belt/solutions"]);
    assert_eq!(of_folder["of"], 110);
    let (_, beginner, _) = graded(folder, &["--skip-tag", "advanced"]);
    assert_eq!((beginner["of"].as_u64(), beginner["cases"].as_u64()), (Some(70), Some(1)));
    for (words, text) in [
        (&["--hidden", "belt/cases.toml"][..], "two cases are called `default`"),
        (&["--tag", "nobody"], "none of the cases of the task is chosen"),
        (&["--client", "plant"], "the task has no soft PLC `plant`"),
        (&["--solution", "belt/none.toml"], "none.toml"),
    ] {
        let said = typed(folder, &[&["grade", "belt", "class/anna.st"], words].concat());
        assert!(said.code == Some(2) && said.err.contains(text) && said.out.is_empty(), "{words:?}: {said:?}");
    }
    let said = typed(folder, &["grade", "belt", "class/nobody"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    let pass = |percent: &str| {
        typed(folder, &["grade", "belt", "class/anna.st", "belt/skeleton/main.st", "--pass", percent]).code
    };
    assert_eq!([pass("30"), pass("31")], [Some(0), Some(1)]);
    write(
        folder,
        "belt/cases.toml",
        &CASES.replace("tags =", "code = [{ source = \"skeleton/main.st\", by = \"x.st\" }]\ntags ="),
    );
    let said = typed(folder, &["grade", "belt", "class/anna.st"]);
    assert!(said.code == Some(2) && said.err.contains("has a program of its own"), "{said:?}");
    write(folder, "belt/cases.toml", "version = 1\n");
    let text = std::fs::read_to_string(folder.join("belt/scenario.toml")).unwrap();
    write(folder, "belt/scenario.toml", &text.replace("marks = 40", "").replace("marks = 30", ""));
    let said = typed(folder, &["grade", "belt", "class/anna.st"]);
    assert!(said.code == Some(2) && said.err.contains("no expectation of the task has marks"), "{said:?}");
}

/// What takes all time, memory or room is ended by itself; all others have the marks that they have without it.
#[test]
fn a_hostile_submission_loses_nobody_elses_marks() {
    let folder = task("60s");
    let folder = folder.path();
    write(folder, "class/anna.st", RIGHT);
    let before = graded(folder, &[]).0;
    let own = |text: &str| with("    IF waiting", &format!("    {text}\n    IF waiting"));
    write(folder, "class/endless.st", &own("WHILE TRUE DO ; END_WHILE;"));
    write(folder, "class/divided.st", &own("Pushed := Pushed / (Pushed - Pushed);"));
    // Below what ends a scan, at each scan.
    let slow = "FOR i := 0 TO 1000000 DO x := SIN(x + 1.0); END_FOR;";
    write(
        folder,
        "class/slow.st",
        &own(slow).replace("waiting : BOOL := TRUE;", "waiting : BOOL := TRUE; i : DINT; x : LREAL;"),
    );
    let large = "waiting : BOOL := TRUE; a : ARRAY[0..250_000_000] OF LREAL;";
    write(folder, "class/large.st", &RIGHT.replace("waiting : BOOL := TRUE;", large));
    let line = "    Pushed := Pushed + 0;\n";
    write(folder, "class/lines.st", &own(&line.repeat(1_000_000)));
    write(folder, "class/nothing/notes.txt", "I have lost it");
    write(folder, "secret.st", RIGHT);
    write(folder, "class/outside/scenario.toml", &outside(folder));
    #[cfg(unix)]
    {
        std::fs::create_dir(folder.join("class/link")).unwrap();
        std::os::unix::fs::symlink(folder.join("secret.st"), folder.join("class/link/main.st")).unwrap();
    }
    let (all, _, said) = graded(folder, &["--time-limit", "30s", "--memory-limit", "512"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let of =
        |name: &str| all.iter().find(|one| one["submission"] == name).unwrap_or_else(|| panic!("{name}: {said:?}"));
    assert_eq!(of("anna"), &before[0]);
    let error =
        |name: &str| of(name)["cases"][0]["error"].as_str().unwrap_or_else(|| panic!("{}", of(name))).to_owned();
    assert!(
        error("endless").contains("endless") && error("endless").contains("class/endless.st:12"),
        "{}",
        error("endless")
    );
    assert!(error("divided").contains("class/divided.st:12"), "{}", error("divided"));
    assert_eq!(of("slow")["status"], "stopped", "{}", of("slow"));
    assert!(of("slow")["why"].as_str().unwrap().contains("within 30 s"));
    for name in ["large", "lines", "nothing", "outside"] {
        assert_eq!(of(name)["status"], "refused", "{}", of(name));
    }
    assert!(of("lines")["why"].as_str().unwrap().contains("bytes"), "{}", of("lines"));
    if cfg!(unix) {
        assert!(of("link")["why"].as_str().unwrap().contains("outside of the folder"), "{}", of("link"));
    }
    for name in ["endless", "divided", "slow", "large", "lines", "nothing", "outside"] {
        assert_eq!(of(name)["marks"], 0, "{name}");
    }
    assert!(!folder.join("started").exists(), "no program was started");
}

/// A scenario that names a source outside of its folder, and a program to start.
fn outside(folder: &Path) -> String {
    let text = std::fs::read_to_string(folder.join("belt/scenario.toml")).unwrap();
    let text = text
        .replace("skeleton/main.st", "../../secret.st")
        .replace("scene = \"plant.toml\"", "command = [\"touch\", \"started\"]");
    text.replace("kind = \"plant\"", "kind = \"external\"")
}

/// A process that needs more memory than its limit is ended, and that is said.
#[cfg(target_os = "linux")]
#[test]
fn memory_is_limited() {
    let folder = task("2s");
    let folder = folder.path();
    write(folder, "class/anna.st", RIGHT);
    write(folder, "class/bomb.st", &bomb());
    let (all, _, said) = graded(folder, &["--memory-limit", "192"]);
    assert_eq!((said.code, all[0]["status"].as_str()), (Some(0), Some("graded")), "{said:?}");
    assert_eq!((all[1]["marks"].as_u64(), all[1]["status"].as_str()), (Some(0), Some("stopped")), "{}", all[1]);
    assert!(all[1]["why"].as_str().unwrap().contains("192 MiB"), "{}", all[1]);
}

/// A small program that is large once it is compiled: each type has a hundred of the one before.
fn bomb() -> String {
    let mut types = String::from("TYPE T0 : STRUCT a : INT := 1; b : STRING[200] := 'x'; END_STRUCT;\n");
    for level in 1..=3 {
        write!(types, "T{level} : STRUCT ").unwrap();
        for member in 0..60 {
            write!(types, "m{member} : T{}; ", level - 1).unwrap();
        }
        types += "END_STRUCT;\n";
    }
    types + "END_TYPE\n" + &with("waiting : BOOL := TRUE;", "waiting : BOOL := TRUE; all : T3;")
}

/// Equal in what they do and in what they are like: names and comments aside. One of its own, and one as it was handed out,
/// are in no pair.
#[test]
fn pairs_are_listed() {
    let folder = task("5s");
    let folder = folder.path();
    write(folder, "class/anna.st", RIGHT);
    write(
        folder,
        "class/ben.st",
        &RIGHT.replace("waiting", "idle").replace("(* for a box *)", "").replace("    ", "\t"),
    );
    write(
        folder,
        "class/carl.st",
        &with("waiting AND Box_There AND Cylinder_In", "Box_There AND Cylinder_In AND waiting"),
    );
    let skeleton = std::fs::read_to_string(folder.join("belt/skeleton/main.st")).unwrap();
    write(folder, "class/dora.st", &skeleton);
    write(folder, "class/emil.st", &skeleton);
    let (all, statement, _) = graded(folder, &[]);
    assert_eq!(statement["alike"], serde_json::json!([["anna", "ben"]]), "{all:?}");
    assert_eq!((&all[0]["alike"], &all[2]["alike"]), (&serde_json::json!(["ben"]), &serde_json::json!([])));
    let digests = |one: &Value| -> Vec<Value> {
        one["cases"].as_array().unwrap().iter().map(|case| case["digest"].clone()).collect()
    };
    assert_eq!(digests(&all[0]), digests(&all[2]), "carl does the same, written another way");
}

#[test]
fn reports_are_written_and_do_not_depend_on_the_number_at_a_time() {
    let folder = task("5s");
    let folder = folder.path();
    write(folder, "class/anna.st", RIGHT);
    write(folder, "class/=ben.st", &with("NOT Push;", "TRUE;"));
    write(folder, "class/carl.st", &with("NOT Push;", "NOT Pusch;"));
    write(
        folder,
        "class/dora.st",
        &with("    IF waiting", "    Pushed := Pushed / (Pushed - Pushed);\n    IF waiting"),
    );
    let reported = |jobs: &str| {
        let words = [
            "grade", "belt", "class/*", "-v", "--jobs", jobs, "--html", "a.html", "--csv", "a.csv", "--junit", "a.xml",
        ];
        let said = Said::from(onescan(folder).args(words).env("ONESCAN_LOG", "error").output().unwrap());
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
        let [html, csv, junit] =
            ["a.html", "a.csv", "a.xml"].map(|file| std::fs::read_to_string(folder.join(file)).unwrap());
        (said.out, html, csv, junit)
    };
    let (out, html, csv, junit) = reported("1");
    let (other, other_html, other_csv, _) = reported("4");
    assert_eq!((&out, &html, &csv), (&other, &other_html, &other_csv));
    insta::assert_snapshot!("csv", csv.replace('\r', ""));
    assert!(html.contains("<a href=\"#t0\">") && html.contains(">safety<"), "{html}");
    let suites = ["=ben", "anna", "carl", "dora"].map(|name| format!("<testsuite name=\"{name}\""));
    assert!(suites.iter().all(|suite| junit.contains(suite)), "{junit}");
    assert!(
        junit.contains("type=\"safety\"")
            && junit.contains("type=\"refused\"")
            && junit.contains("file=\"class/carl.st\""),
        "{junit}"
    );
}

/// A class of a hundred: each is graded, and has what it has alone.
#[test]
fn a_hundred_are_graded() {
    let folder = task("1s");
    let folder = folder.path();
    let text = std::fs::read_to_string(folder.join("belt/scenario.toml")).unwrap();
    write(folder, "belt/scenario.toml", &text.replace("eventually Boxes_Out >= 3", "eventually[0,1s] Boxes_In >= 1"));
    write(folder, "belt/cases.toml", "version = 1\n");
    for number in 0..100 {
        let text = match number % 4 {
            0 => RIGHT.to_owned(),
            1 => with("NOT Push;", "TRUE;"),
            2 => with("NOT Push;", "NOT Pusch;"),
            _ => with("    IF waiting", "    WHILE TRUE DO ; END_WHILE;\n    IF waiting"),
        };
        write(folder, &format!("class/s{number:02}.st"), &text);
    }
    let (all, statement, said) = graded(folder, &[]);
    assert_eq!((said.code, statement["submissions"].as_u64(), all.len()), (Some(0), Some(100), 100), "{said:?}");
    let given = marks(&all);
    for (number, (name, marks)) in given.iter().enumerate() {
        assert_eq!((name, marks), (&format!("s{number:02}"), &given[number % 4].1));
    }
    assert_eq!([given[0].1, given[2].1, given[3].1], [70, 0, 0]);
}

/// What is handed out runs at once, and gives nothing away; a folder that somebody worked in is graded by its scenario.
#[test]
fn a_task_is_handed_out_without_its_solutions() {
    let folder = task("2s");
    let folder = folder.path();
    let said = typed(folder, &["new", "mine", "--task", "belt"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    insta::assert_snapshot!("new_task", said.out);
    for gone in ["solutions", "solution-st.toml", "solution-st.cases.toml"] {
        assert!(!folder.join("mine").join(gone).exists(), "{gone}");
    }
    assert_eq!(typed(folder, &["check", "mine"]).code, Some(0));
    assert!(matches!(typed(folder, &["run", "mine"]).code, Some(0 | 1)));
    write(folder, "mine/skeleton/main.st", RIGHT);
    // A second program beside the one that the scenario names is not handed in.
    write(folder, "mine/skeleton/other.st", RIGHT);
    let said = typed(folder, &["grade", "belt", "mine"]);
    assert!(said.code == Some(0) && !said.out.contains("compile"), "{said:?}");
    // The sheet's commands name the folder that it is in.
    assert_eq!(typed(folder, &["new", "first", "--task", "lift"]).code, Some(0));
    let sheet = std::fs::read_to_string(folder.join("first/README.md")).expect("a sheet");
    assert!(sheet.contains("onescan check first ") && !sheet.contains("scenarios/learn"), "{sheet}");
    let said = typed(folder, &["new", "other", "--task", "lifft"]);
    assert!(said.code == Some(2) && said.err.contains("onescan has no task `lifft`"), "{said:?}");
}

#[test]
fn templates_are_listed() {
    let here = scenario("shear");
    let said = typed(&here, &["templates"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    for name in ["cell", "tank", "python", "blank"] {
        assert!(said.out.lines().any(|line| line.trim_start().starts_with(name)), "{said:?}");
    }
    let listed: Value = serde_json::from_str(&typed(&here, &["templates", "--format", "json"]).out).unwrap();
    assert_eq!(listed["templates"].as_array().unwrap().len(), 4);
    // Each task of the program can be begun, and its folder is one of the repository.
    for task in listed["tasks"].as_array().unwrap() {
        let name = task["name"].as_str().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let said = typed(folder.path(), &["new", "mine", "--task", name]);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{name}: {said:?}");
        assert_eq!(typed(folder.path(), &["check", "mine"]).code, Some(0), "{name}");
        assert!(scenario("learn").join(name).is_dir());
    }
}
