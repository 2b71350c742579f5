//! The conformance suite: one small program for each clause of the standard, with the trace that the
//! clause asks for.
//!
//! A case is a file in `cases/`, named by edition and clause. Adding one is all that is needed; the
//! table in `CONFORMANCE.md` must name it. It is a program like any other, with a comment that
//! says what its variables hold, one column per scan:
//!
//! ```text
//! (* TRACE
//!    Main.cu :=  .  #  .  #        written before the scan
//!    cv       =  0  1  1  2        held after the scan
//!    q        =  ...#              a BOOL may be drawn as levels
//! *)
//! ```
//!
//! | line | meaning |
//! |---|---|
//! | `a := 1 2 -` | values given before the scans; `-` leaves it as it is; one alone is given before the first |
//! | `a = 1 2 -` | values wanted after the scans; `-` is not looked at; one alone is wanted after each |
//! | `scans: 5` | how many scans; else as many as the longest line has values |
//! | `interval: 20ms` | interval of the task that runs the programs, if no configuration says it; else 10 ms |
//! | `dialect: codesys` | how the text is read; else as in the 3rd edition |
//! | `restart: - warm - cold` | starts before the scans |
//! | `fault: DivisionByZero` | the last scan, and only it, stops the PLC with this fault |
//! | `findings: T0201 W0703` | all that the compiler says, in the text's order; with an error nothing runs |
//!
//! | type | value |
//! |---|---|
//! | BOOL | `.` `#`, `FALSE` `TRUE`, `0` `1` |
//! | integers, bit strings, enumerations | `-5`, `16#FF` |
//! | reals | `1.5`, `1e20`, `inf`, `NaN` |
//! | durations | `1.5s`, `20ms`, in one unit of `d h m s ms us ns` |
//! | dates and times of day | `1994-06-15`, `15:36:55.36`, `1994-06-15-15:36:55.36` |
//! | strings, characters | `'as they are, without escapes'` |
//!
//! Names without a unit are those of the file's first program. `CASE=counters cargo test --test conformance`
//! runs the files whose names contain the word.

mod calendar;
mod case;
mod cell;
mod lockstep;
mod table;
mod trace;

use std::path::{Path, PathBuf};

use case::Case;
use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse};
use onescan_iec_run::Application;

/// The files in `cases/`, by name.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("conformance/cases");
    let entries = std::fs::read_dir(folder).expect("the folder exists");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files
}

/// The file's name without folder and extension.
fn stem(path: &Path) -> String {
    path.file_stem().expect("a name").to_string_lossy().into_owned()
}

fn check(path: &Path) -> Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    trace::run(&Case::parse(&text)?, &text)
}

/// The cases that fail, and why.
fn failing(paths: &[PathBuf]) -> Vec<String> {
    let why = |path: &PathBuf| check(path).err().map(|why| format!("{}: {why}", stem(path)));
    paths.iter().filter_map(why).collect()
}

#[test]
fn every_case_has_its_trace() {
    let wanted = std::env::var("CASE").unwrap_or_default();
    let files: Vec<_> = files().into_iter().filter(|path| stem(path).contains(&wanted)).collect();
    assert!(!files.is_empty(), "no case is named like `{wanted}`");
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let share = files.len().div_ceil(workers);
    let failures: Vec<String> = std::thread::scope(|scope| {
        let parts: Vec<_> = files.chunks(share).map(|part| scope.spawn(|| failing(part))).collect();
        parts.into_iter().flat_map(|part| part.join().expect("a worker does not panic")).collect()
    });
    assert!(failures.is_empty(), "{} of {} cases fail\n\n{}", failures.len(), files.len(), failures.join("\n\n"));
}

/// A printed tree is the tree: it prints alike, and compiles to the same code and memory.
#[test]
fn every_case_is_printed_as_what_it_is() {
    for path in files() {
        let (name, text) = (stem(&path), std::fs::read_to_string(&path).expect("a case"));
        let Ok(application) = Application::from_sources([("case.st", text.as_str())]) else {
            continue;
        };
        let print = |text: &str| print_unit(&parse(FileId(0), text).unit);
        let printed = print(&text);
        assert_eq!(print(&printed), printed, "{name}");
        let again = Application::from_sources([("case.st", printed.as_str())]);
        let again = again.unwrap_or_else(|found| panic!("{name}: {found}\n{printed}"));
        assert_eq!(application.wasm(), again.wasm(), "{name}");
        assert_eq!(application.initial_memory(), again.initial_memory(), "{name}");
    }
}

#[test]
fn names_say_edition_and_clause() {
    for path in files() {
        let name = stem(&path);
        let rest = name.strip_prefix("iec2_").or(name.strip_prefix("iec3_")).unwrap_or_default();
        assert!(rest.starts_with(|first: char| first.is_ascii_digit()) || rest.starts_with("annex_"), "{name}");
        assert_eq!(path.extension().and_then(|extension| extension.to_str()), Some("st"), "{name}");
    }
}
