//! All submissions for CI servers: a suite a submission, a test an expectation.

use std::time::Duration;

use onescan_report::junit::{Case, Ended, Suite, Tests, Trouble};
use onescan_server::client::SourcePlace;

use super::marks::{Graded, Marked, Standing};
use super::summary::{missed, of_item};
use super::task::{Item, Task};

/// The report as XML.
pub(super) fn text(task: &Task, all: &[Graded], wall_time: Duration) -> String {
    let suite = |graded: &Graded| {
        let pairs = task.items.iter().zip(&graded.marked);
        let tests = pairs.map(|(item, marked)| of_expectation(task, graded, item, marked));
        let cases = std::iter::once(program(task, graded)).chain(tests).collect();
        Suite { name: graded.submission.name.clone(), cases }
    };
    Tests { suites: all.iter().map(suite).collect(), wall_time }.to_xml()
}

/// Whether there is a program, and it was run to the end of every case.
fn program(task: &Task, graded: &Graded) -> Case {
    let (mut place, mut lines) = (None, Vec::from_iter(graded.standing.why().map(str::to_owned)));
    if let Standing::Refused(refused) = &graded.standing {
        place = refused.errors.shown.first().map(|remark| &remark.place);
        lines.extend(missed(task, graded));
    }
    for (case, ran) in graded.faults(task) {
        place = place.or(ran.place.as_ref());
        lines.push(format!("case {case}: {}", ran.error.as_deref().unwrap_or("it ended with a fault")));
    }
    let trouble = || Trouble { word: graded.standing.word(), lines: lines.clone() };
    let ended = if lines.is_empty() { Ended::Well } else { Ended::Error(trouble()) };
    Case { wall_time: Some(graded.wall_time), ..case("the program", place, ended) }
}

fn of_expectation(task: &Task, graded: &Graded, item: &Item, marked: &Marked) -> Case {
    let place = marked.missed.iter().find_map(|missed| missed.place.as_ref());
    let ended = match &graded.standing {
        // The test of the program says why.
        Standing::Refused(_) | Standing::Broken(_) => Ended::Skipped,
        Standing::Graded | Standing::Stopped(_) if marked.missed.is_empty() => Ended::Well,
        Standing::Graded | Standing::Stopped(_) => {
            let word = if item.worth.is_safety { "safety" } else { "missed" };
            Ended::Failure(Trouble { word, lines: of_item(task, item, marked) })
        }
    };
    case(&item.title(), place, ended)
}

fn case(name: &str, place: Option<&SourcePlace>, ended: Ended) -> Case {
    let place = place.map(|place| (place.file.clone(), place.line));
    Case { class: None, name: name.to_owned(), virtual_time_ns: 0, wall_time: None, place, ended }
}
