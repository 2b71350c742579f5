//! The report for machines: a JSON object a submission, and one for all. A contract: fields are added, never changed.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::alike;
use super::line::{Remark, Remarks, Suspect};
use super::marks::{Graded, How, Marked, Missed, Standing};
use super::task::{Item, Task};
use crate::regress::plan::shown;
use crate::regress::ran::Ran;

/// An object a line: each submission, then all of them together.
///
/// # Errors
/// Those of `out`.
pub(super) fn write(task: &Task, all: &[Graded], out: &mut dyn Write) -> io::Result<()> {
    for graded in all {
        writeln!(out, "{}", submission(task, graded))?;
    }
    let name = |number: &usize| all[*number].submission.name.clone();
    let alike: Vec<Vec<String>> = alike::groups(all).iter().map(|group| group.iter().map(name).collect()).collect();
    let statement = json!({ "task": task.scenario.name(), "submissions": all.len(), "of": task.marks(),
        "expectations": task.items.len(), "cases": task.cases.len(), "alike": alike,
        "version": env!("CARGO_PKG_VERSION") });
    writeln!(out, "{statement}")?;
    out.flush()
}

fn submission(task: &Task, graded: &Graded) -> Value {
    let errors = if let Standing::Refused(refused) = &graded.standing { Some(&refused.errors) } else { None };
    let [lines, branches] = [graded.coverage.lines(), graded.coverage.branches()].map(|(all, some)| json!([some, all]));
    let read = graded.read.as_ref();
    json!({
        "submission": graded.submission.name,
        "path": shown(&graded.submission.path),
        "status": graded.standing.word(),
        "why": graded.standing.why(),
        "marks": graded.given(),
        "of": task.marks(),
        "safety_violations": graded.safety_violations(task),
        "expectations": task.items.iter().zip(&graded.marked).map(|(item, marked)| expectation(task, item, marked))
            .collect::<Vec<_>>(),
        "cases": task.cases.iter().zip(&graded.ran)
            .map(|(case, ran)| of_case(&case.name, case.is_hidden, ran.as_ref())).collect::<Vec<_>>(),
        "suspects": graded.suspects.iter().map(suspect).collect::<Vec<_>>(),
        "errors": errors.map(remarks),
        "warnings": read.map(|read| remarks(&read.warnings)),
        "executed_lines": lines,
        "executed_branches": branches,
        "as_handed_out": read.is_some_and(|read| read.is_as_handed_out),
        "structure": read.map(|read| &read.structure),
        "alike": graded.alike,
    })
}

fn expectation(task: &Task, item: &Item, marked: &Marked) -> Value {
    json!({ "name": item.name, "case": item.case, "hidden": item.is_hidden, "safety": item.worth.is_safety,
        "marks": marked.given, "of": item.worth.marks,
        "missed": marked.missed.iter().map(|one| missed(task, one)).collect::<Vec<_>>() })
}

fn missed(task: &Task, Missed { case, how, place, statements }: &Missed) -> Value {
    let (word, at_ns, values) = match how {
        How::Violated { at_ns, values } => ("violated", Some(at_ns), Some(values)),
        How::Ended => ("ended", None, None),
        How::NotRun => ("not-run", None, None),
    };
    json!({ "case": task.cases[*case].name, "how": word, "at_ns": at_ns, "values": values, "place": place,
        "statements": statements })
}

fn suspect(Suspect { file, line, why }: &Suspect) -> Value {
    json!({ "file": file, "line": line, "why": why })
}

fn of_case(name: &str, is_hidden: bool, ran: Option<&Ran>) -> Value {
    let status = ran.map_or("not-run", |ran| ran.status.word());
    json!({ "name": name, "hidden": is_hidden, "status": status,
        "digest": ran.and_then(|ran| ran.digest.as_ref()),
        "steps": ran.map(|ran| ran.steps), "virtual_time_ns": ran.map(|ran| ran.virtual_time_ns),
        "error": ran.and_then(|ran| ran.error.as_ref()), "place": ran.and_then(|ran| ran.place.as_ref()) })
}

fn remarks(Remarks { shown, all }: &Remarks) -> Value {
    let one = |Remark { code, place, text }: &Remark| json!({ "code": code, "file": place.file, "line": place.line, "column": place.column, "message": text });
    json!({ "all": all, "shown": shown.iter().map(one).collect::<Vec<_>>() })
}
