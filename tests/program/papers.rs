//! `docs/papers.md`, row by row: each command does what it says, each test is there, no figure is missing.

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};

use crate::typed::{begun, copied, scenario, typed};

/// What must have a row of its own.
const FIGURES: [(&str, &[&str]); 5] = [
    (
        "## [SDSP]",
        &[
            "Fig. 1",
            "Fig. 2",
            "Fig. 3",
            "Fig. 4",
            "Fig. 5",
            "Fig. 6",
            "Fig. 7",
            "Fig. 8",
            "Fig. 9",
            "Fig. 10",
            "Fig. 11",
            "Fig. 12",
            "Fig. 13",
            "Fig. 14",
            "Fig. 15",
            "Appendix",
            "Sec. III-A",
            "Sec. III-B",
            "Sec. III-C",
            "sec. III-D",
            "sec. III-E",
            "sec. V-A",
            "sec. V-B",
            "Sec. V-C",
            "Sec. VI-A",
            "Sec. VII",
            "Sec. VIII",
        ],
    ),
    (
        "## [Sivtoft]",
        &[
            "Fig. 2.1",
            "Fig. 2.2",
            "Fig. 2.3",
            "Fig. 4.1",
            "Fig. 4.2",
            "Fig. 5.1",
            "Fig. 5.2",
            "Fig. 5.3",
            "Fig. 5.4",
            "Fig. 5.5",
            "Sec. 1.2",
            "Ch. 3",
            "Sec. 4.2.3",
            "Sec. 4.2.5",
            "Sec. 5.1",
            "Sec. 5.2",
            "Sec. 5.3",
            "Sec. 6.2",
            "Sec. 6.3",
        ],
    ),
    (
        "## [Nyyssönen]",
        &[
            "Ch. 2.1",
            "Sec. 2.3",
            "Sec. 3.1.1",
            "Secs. 3.1.1 to 3.1.4",
            "Sec. 3.2",
            "Sec. 3.3",
            "Tables 3 and 5",
            "Table 4",
            "Sec. 5.1",
            "Fig. 14",
            "Figs. 13, 17 and 18",
            "Figs. 19 to 21",
            "Figs. 22 to 24",
        ],
    ),
    (
        "## [Vergnano]",
        &["Figs. 1 and 7", "Figs. 2, 4 and 6", "Fig. 3", "Fig. 5", "Sec. 4", "Sec. 4.1", "Sec. 4.2", "Sec. 5"],
    ),
    (
        "## [Jacket]",
        &[
            "Ch. 2.2",
            "Chs. 3 and 15",
            "Ch. 7.2",
            "Ch. 11",
            "Ch. 13",
            "Ch. 14",
            "Ch. 14.1",
            "Ch. 14.2",
            "Appendix 1",
            "Appendix 2",
        ],
    ),
];

/// A row of one of the page's tables.
struct Row {
    paper: String,
    here: String,
    command: String,
    test: String,
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a workspace").to_owned()
}

fn page() -> String {
    std::fs::read_to_string(repository().join("docs/papers.md")).expect("the page")
}

fn rows(text: &str) -> Vec<Row> {
    let cells = |line: &str| -> Option<[String; 4]> {
        let inner = line.strip_prefix("| ")?.strip_suffix('|')?;
        let cells: Vec<String> = inner.split('|').map(|cell| cell.trim().trim_matches('`').to_owned()).collect();
        Some(cells.try_into().unwrap_or_else(|_| panic!("four cells: {line}")))
    };
    let all = text.lines().filter(|line| !line.starts_with("|---")).filter_map(cells);
    let rows = all.filter(|[paper, ..]| paper != "paper");
    rows.map(|[paper, here, command, test]| Row { paper, here, command, test }).collect()
}

#[test]
fn no_figure_and_no_requirement_is_missing() {
    let page = page();
    for (heading, wanted) in FIGURES {
        let from = page.find(heading).unwrap_or_else(|| panic!("{heading}"));
        let part = &page[from..];
        let part = &part[..part[1..].find("\n## ").map_or(part.len(), |end| end + 1)];
        let papers: Vec<String> = rows(part).into_iter().map(|row| row.paper).collect();
        let names = |paper: &String, figure: &str| {
            paper.match_indices(figure).any(|(at, _)| {
                let next = paper[at + figure.len()..].chars().next();
                !next.is_some_and(|next| next.is_ascii_digit() || next == '-')
            })
        };
        for figure in wanted {
            assert!(papers.iter().any(|paper| names(paper, figure)), "{heading} has no row for {figure}");
        }
    }
}

#[test]
fn each_row_has_a_command_and_a_test_or_says_why_not() {
    let rows = rows(&page());
    assert!(rows.len() > 60, "{}", rows.len());
    for Row { paper, here, command, test } in rows {
        if here.starts_with("Not here") {
            assert!(command.is_empty() && test.is_empty() && here.len() > 20, "{paper}: {here}");
            continue;
        }
        assert!(command.starts_with("onescan "), "{paper}: {command}");
        let (file, name) = test.split_once(": ").unwrap_or_else(|| panic!("{paper}: FILE: NAME, not {test}"));
        let source = std::fs::read_to_string(repository().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(source.contains("#[test]\n") && source.contains(&format!("fn {name}()")), "{paper}: {test}");
    }
}

/// Long runs end early: what is looked at here is that the row can be typed.
fn shortened(words: &mut Vec<&str>) {
    if words[1] == "campaign" {
        words.extend(["--keep", "out/keep", "--partition", "1/19"]);
    }
    let runs = ["run", "compare"].contains(&words[1]) && !words.contains(&"--help");
    if !runs {
        return;
    }
    match words.iter().position(|word| *word == "--until") {
        Some(at) => words[at + 1] = "50ms",
        None => words.extend(["--until", "50ms"]),
    }
    // the part that is enlarged comes later
    if let Some(at) = words.iter().position(|word| *word == "--enlarge") {
        words.drain(at..at + 2);
    }
}

/// A command that ends when its user ends it: its page is there.
fn serves(folder: &Path, words: &[&str]) {
    let mut child = begun(folder, words);
    let mut line = String::new();
    let errors = child.stderr.take().expect("a pipe");
    BufReader::new(errors).read_line(&mut line).expect("text");
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    assert!(line.contains("http://127.0.0.1:"), "{words:?}: {line}");
}

/// What a row says is to be seen: the help of a command and the description of a kind show nothing.
#[test]
fn each_command_shows_something() {
    for Row { paper, command, .. } in rows(&page()) {
        let is_shown = !command.contains("--help") && !command.starts_with("onescan components ");
        assert!(is_shown, "{paper}: {command}");
    }
}

#[test]
fn each_command_can_be_typed() {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = folder.path().join("scenarios");
    std::fs::create_dir(&scenarios).unwrap();
    for name in ["shear", "filling-machine", "gantry-robot", "robot-cell", "peeling-line", "arc-furnace", "rotary-kiln"]
    {
        std::fs::rename(copied(name).keep(), scenarios.join(name)).unwrap();
    }
    let mut commands: Vec<String> =
        rows(&page()).into_iter().map(|row| row.command).filter(|c| !c.is_empty()).collect();
    commands.sort();
    commands.dedup();
    for command in commands {
        let mut words: Vec<&str> = command.split_whitespace().collect();
        shortened(&mut words);
        if words[1] == "edit" {
            serves(folder.path(), &words[1..]);
            continue;
        }
        let said = typed(folder.path(), &words[1..]);
        // a run that is cut short, or that free-wheels, need not meet what is expected
        let judges = ["run", "falsify", "explore", "campaign"].contains(&words[1]);
        let fine = if judges { matches!(said.code, Some(0 | 1)) } else { said.code == Some(0) };
        assert!(fine, "{command}: {said:?}");
        let _ = std::fs::remove_dir_all(folder.path().join("out"));
    }
}

/// `[Sivtoft]` 4.2.3: 34 objects, of which five at the end of the conveyor are one sensor here.
#[test]
fn the_filling_machine_has_thirty_sensors() {
    let said = typed(&scenario("filling-machine"), &["describe", "plant.toml", "--format", "json"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let kinds = said.out.matches("\"contact_sensor\"").count();
    assert_eq!(kinds, 30, "{}", said.out);
}
