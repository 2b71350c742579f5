//! Every command that a document shows can be typed: its words are the program's, each placeholder is a known one, and what
//! needs no other program runs as it stands. Those of `docs/papers.md` and of the tutorials have tests of their own.

use std::path::{Path, PathBuf};

use onescan::cli::args;

use crate::typed::{copied_from, scenario, typed};

/// Words that stand for the reader's own, and what is typed in their place. `docs/README.md` says what they mean.
const PLACEHOLDERS: &[(&str, &str)] = &[
    ("A", "before"),
    ("ADDRESS", "127.0.0.1:4850"),
    ("B", "after"),
    ("CASE", "even"),
    ("CODE", "N0101"),
    ("COMMAND", "run"),
    ("COMMIT", "v1.4"),
    ("DIR", "out"),
    ("FILE", "file"),
    ("FOLDER", "my-cell"),
    ("KIND", "light_barrier"),
    ("LIST", "list.csv"),
    ("MACHINE", "tank-level"),
    ("MODE", "halt"),
    ("NAME", "matiec"),
    ("PROJECT", "Plc.plcproj"),
    ("RECORDING", "out/run-1"),
    ("SCENARIO", "my-cell"),
    // of templates, and of Slurm
    ("{name}", "my-cell"),
    ("$SLURM_CPUS_ON_NODE", "8"),
    ("$SLURM_ARRAY_TASK_ID", "3"),
    ("...", "part7"),
];

/// Names of file formats that begin as a command does.
const FORMATS: &[&str] = &["trajectory", "state", "signals"];

/// Commands that ask another program, serve until they are ended, or take minutes: each has tests of its own, here its
/// words are looked at.
const READ: &[&str] = &[
    "bisect", "browse", "campaign", "control", "edit", "explore", "falsify", "grade", "join", "minimise", "mutate",
    "plc", "review", "shot", "test", "train", "view",
];

/// Options with which a command talks to another program.
const TO_OTHERS: &[&str] =
    &["--gateway", "--operator", "--opcua", "--opcua-client", "--ads", "--listen", "--web", "--pace"];

/// What commands would have made that are not run here, as a recording of somebody at the page or a case that was copied; and
/// scenarios that wait for PLCs.
const MADE_BEFORE: &[&str] = &[
    "out/heat/run-1",
    "out/shift",
    "sessions/ann",
    "mutant-7",
    "operated",
    "scenarios/peeling-line/frames.toml",
    "scenarios/peeling-line/link-live.toml",
];

/// A command as a document shows it.
struct Shown {
    document: PathBuf,
    words: Vec<String>,
    /// In a block to be typed, and not named in a sentence.
    stands_alone: bool,
}

impl Shown {
    fn text(&self) -> String {
        format!("{}: {}", self.document.display(), self.words.join(" "))
    }

    fn has(&self, option: &str) -> bool {
        self.words.iter().any(|word| word.split('=').next() == Some(option))
    }

    /// True if it runs by itself in the folder of a reader who has the repository's scenarios and `my-cell`.
    fn runs(&self) -> bool {
        let is_here = |word: &String| word.starts_with("scenarios/") || word.starts_with("my-cell");
        self.stands_alone
            && !READ.contains(&self.words[1].as_str())
            && !TO_OTHERS.iter().any(|option| self.has(option))
            && !self.words.iter().any(|word| MADE_BEFORE.contains(&word.as_str()))
            && self.words.iter().any(is_here)
    }
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a workspace").to_owned()
}

/// Documents below a folder of the repository, in order.
fn documents(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![repository().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let is_elsewhere = ["papers.md", "tutorials", "site"].iter().any(|name| path.ends_with(name));
            if path.is_dir() && !is_elsewhere {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") && !is_elsewhere {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The words of a line as a shell has them: `"…"` is one word, what follows ` #` a comment.
fn words(line: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let (mut is_quoted, mut is_new) = (false, true);
    for character in line.chars() {
        match character {
            '"' => is_quoted = !is_quoted,
            '#' if is_new && !is_quoted => break,
            blank if blank.is_whitespace() && !is_quoted => is_new = true,
            other => {
                if std::mem::take(&mut is_new) {
                    words.push(String::new());
                }
                words.last_mut().expect("one has begun").push(other);
            }
        }
    }
    words
}

/// The commands of a line of a block, without what a shell does with them.
fn of_line(line: &str) -> Vec<Vec<String>> {
    let line = line.trim_start().strip_prefix("$ ").unwrap_or(line);
    let all = words(line);
    let commands = all.split(|word| word == "&&" || word == "&");
    commands.filter(|words| words.first().is_some_and(|word| word == "onescan")).map(<[String]>::to_vec).collect()
}

/// All commands of a document: of its blocks, and those named in its sentences.
fn shown(document: &Path) -> Vec<Shown> {
    let text = std::fs::read_to_string(document).expect("a document");
    let name = document.strip_prefix(repository()).expect("below it").to_owned();
    let mut shown = Vec::new();
    let mut push = |words, stands_alone| shown.push(Shown { document: name.clone(), words, stands_alone });
    for (index, part) in text.split("```").enumerate() {
        if index % 2 == 1 {
            let lines = part.replace("\\\n", " ");
            for words in lines.lines().skip(1).flat_map(of_line) {
                push(words, true);
            }
            continue;
        }
        for code in part.split('`').skip(1).step_by(2).filter(|code| code.starts_with("onescan ")) {
            let words = words(code);
            if !FORMATS.contains(&words[1].as_str()) {
                push(words, false);
            }
        }
    }
    shown
}

/// A word with what a reader puts in the place of its placeholders.
fn given(shown: &Shown, word: &str) -> String {
    let mut given = word.to_owned();
    for (placeholder, value) in PLACEHOLDERS {
        let is_part = |part: &str| part == *placeholder;
        if placeholder.starts_with(|c: char| c.is_ascii_uppercase()) {
            let parts: Vec<&str> = given.split('/').map(|part| if is_part(part) { value } else { part }).collect();
            given = parts.join("/");
        } else {
            given = given.replace(placeholder, value);
        }
    }
    let is_capital = |part: &str| part.len() > 1 && part.chars().all(|c| c.is_ascii_uppercase());
    let unknown = given.split(['/', '=', ':', ',']).find(|part| is_capital(part) && !is_name(part));
    assert_eq!(unknown, None, "{}: a placeholder that PLACEHOLDERS does not have", shown.text());
    given
}

/// Names in capitals that stand for themselves.
fn is_name(part: &str) -> bool {
    part.starts_with("AT") || part == "SDSP"
}

/// What is typed, after the placeholders are given.
fn given_words(shown: &Shown) -> Vec<String> {
    let words = shown.words.iter().map(|word| given(shown, word));
    // `...` in a list of what may follow
    words.filter(|word| word != "…").collect()
}

/// Refuses a command that the program would refuse for its words.
fn is_understood(shown: &Shown) {
    use clap::error::ErrorKind::{
        DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion, InvalidValue, MissingRequiredArgument,
    };
    if let Err(error) = args::program().try_get_matches_from(given_words(shown)) {
        let is_help = matches!(error.kind(), DisplayHelp | DisplayVersion);
        // An option that a sentence names stands without its value.
        let lacks_value = error.kind() == InvalidValue && error.to_string().contains("a value is required");
        let is_named =
            lacks_value || matches!(error.kind(), MissingRequiredArgument | DisplayHelpOnMissingArgumentOrSubcommand);
        assert!(is_help || is_named && !shown.stands_alone, "{}\n{error}", shown.text());
    }
}

/// Long runs end early: what is looked at is that the command can be typed.
fn shortened(words: &mut Vec<String>) {
    let at_its_time = words.iter().any(|word| ["--save-at", "--resume", "--maps"].contains(&word.as_str()));
    if !["run", "compare"].contains(&words[1].as_str()) || at_its_time {
        return;
    }
    match words.iter().position(|word| word == "--until") {
        Some(at) => "50ms".clone_into(&mut words[at + 1]),
        None => words.extend(["--until".to_owned(), "50ms".to_owned()]),
    }
    // the part that is enlarged comes later
    if let Some(at) = words.iter().position(|word| word == "--enlarge") {
        words.drain(at..at + 2);
    }
}

/// Types what a document shows, in its order, in the folder of a reader.
fn runs(documents: &[PathBuf]) {
    for document in documents {
        let all: Vec<Shown> = shown(document).into_iter().filter(Shown::runs).collect();
        if all.is_empty() {
            continue;
        }
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::rename(copied_from(&scenario("")).keep(), folder.path().join("scenarios")).expect("a folder");
        assert_eq!(typed(folder.path(), &["new", "my-cell"]).code, Some(0));
        for command in &all {
            let mut words = given_words(command);
            if words[1] == "new" && folder.path().join(&words[2]).exists() {
                std::fs::remove_dir_all(folder.path().join(&words[2])).expect("a folder");
            }
            shortened(&mut words);
            let words: Vec<&str> = words[1..].iter().map(String::as_str).collect();
            let said = typed(folder.path(), &words);
            // a run that is cut short, or that free-wheels, need not meet what is expected
            let fine = matches!(said.code, Some(0)) || matches!((words[0], said.code), ("run", Some(1)));
            assert!(fine, "{}: {said:?}", command.text());
        }
    }
}

#[test]
fn each_command_of_a_document_is_understood() {
    let folders = ["docs", "plc-shim", "clients", "scenarios", "web", "tests"];
    let mut all: Vec<PathBuf> = folders.iter().flat_map(|folder| documents(folder)).collect();
    all.extend(["README.md", "CONTRIBUTING.md", "ARCHITECTURE.md"].map(|name| repository().join(name)));
    let commands: Vec<Shown> = all.iter().flat_map(|document| shown(document)).collect();
    assert!(commands.len() > 300, "{}", commands.len());
    commands.iter().for_each(is_understood);
}

/// `docs/README.md` says what a word in capitals stands for.
#[test]
fn each_placeholder_is_explained() {
    let index = std::fs::read_to_string(repository().join("docs/README.md")).expect("the index");
    let capitals =
        PLACEHOLDERS.iter().map(|(name, _)| *name).filter(|name| name.starts_with(|c: char| c.is_ascii_uppercase()));
    for name in capitals {
        assert!(index.contains(&format!("`{name}`")), "{name}");
    }
}

#[test]
fn what_the_readme_shows_runs() {
    runs(&[repository().join("README.md")]);
}

#[test]
fn what_the_manuals_show_runs() {
    runs(&documents("docs"));
}

#[test]
fn what_the_scenarios_show_runs() {
    runs(&documents("scenarios"));
}

#[test]
fn a_line_has_the_words_that_a_shell_finds() {
    let commands = of_line("$ onescan new a && onescan run a --expect \"x y\"  # c # d");
    assert_eq!(commands, [vec!["onescan", "new", "a"], vec!["onescan", "run", "a", "--expect", "x y"]]);
    assert_eq!(of_line("onescan run a#b &"), [vec!["onescan", "run", "a#b"]]);
    assert!(of_line("cargo run -- run a").is_empty());
}
