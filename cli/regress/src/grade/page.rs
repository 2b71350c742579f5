//! The page about a class: a table of all, then each submission.

use std::borrow::Cow;

use onescan_iec::diagnostic::counted;
use onescan_report::Table;
use onescan_report::page::{Mood, Page, Section};
use onescan_runner::run::page::covered;

use super::marks::{Graded, How, Marked};
use super::summary::{HEAD, alike_line, alike_lines, cells, headline, how, missed, standing};
use super::task::{Item, Task};

/// The page.
pub(super) fn of_class(task: &Task, all: &[Graded]) -> Page {
    let rows = all.iter().map(|graded| cells(task, graded).to_vec()).collect();
    let head = HEAD.iter().skip(1).map(|head| Cow::Borrowed(*head)).collect();
    let contents = Table { title: HEAD[0], head, rows, remarks: Vec::new(), is_folded: false };
    Page {
        title: task.scenario.name().to_owned(),
        totals: format!("{}; {}", counted(all.len(), "submission"), headline(task)),
        summary: alike_lines(all),
        sections: all.iter().map(|graded| section(task, graded)).collect(),
        contents: Some(contents),
        ..Page::default()
    }
}

fn section(task: &Task, graded: &Graded) -> Section {
    let mood = match graded.given() {
        given if given == task.marks() => Mood::Good,
        _ if graded.safety_violations(task) > 0 || graded.standing.why().is_some() => Mood::Bad,
        _ => Mood::Open,
    };
    let mut tables = vec![marks(task, graded)];
    tables.extend(runs(task, graded));
    tables.extend(executed(graded));
    tables.extend(style(graded));
    let mut lines = missed(task, graded);
    lines.extend(alike_line(graded));
    Section {
        title: graded.submission.name.clone(),
        status: standing(task, graded),
        mood,
        lines,
        tables,
        ..Section::default()
    }
}

/// What each expectation gave.
fn marks(task: &Task, graded: &Graded) -> Table {
    let row = |(item, marked): (&Item, &Marked)| {
        let seen = marked.missed.iter().find(|one| matches!(one.how, How::Violated { .. })).or(marked.missed.first());
        let (case, seen) = seen.map(|one| (task.cases[one.case].name.clone(), how(&one.how))).unwrap_or_default();
        let safety = if item.worth.is_safety { "safety" } else { "" };
        let of = format!("{} of {}", marked.given, item.worth.marks);
        vec![item.title(), of, safety.to_owned(), case, seen]
    };
    Table {
        title: "expectation",
        head: ["marks", "", "case", "missed"].map(Cow::Borrowed).to_vec(),
        rows: task.items.iter().zip(&graded.marked).map(row).collect(),
        ..Table::default()
    }
}

/// What came of each case.
fn runs(task: &Task, graded: &Graded) -> Option<Table> {
    graded.read.as_ref()?;
    let row = |(case, ran): (&super::task::TaskCase, &Option<crate::regress::ran::Ran>)| {
        let hidden = if case.is_hidden { "hidden" } else { "" };
        let status = ran.as_ref().map_or("not run", |ran| ran.status.word());
        let digest = ran.as_ref().and_then(|ran| ran.digest.clone()).unwrap_or_default();
        vec![case.name.clone(), hidden.to_owned(), status.to_owned(), digest]
    };
    Some(Table {
        title: "case",
        head: ["", "run", "digest"].map(Cow::Borrowed).to_vec(),
        rows: task.cases.iter().zip(&graded.ran).map(row).collect(),
        is_folded: true,
        ..Table::default()
    })
}

/// What was executed of each file.
fn executed(graded: &Graded) -> Option<Table> {
    let files = covered(&graded.coverage);
    let missed = |lines: &[u32]| lines.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
    let rows = files
        .iter()
        .map(|file| vec![file.file.clone(), file.lines.clone(), file.branches.clone(), missed(&file.missed)]);
    (!files.is_empty()).then(|| Table {
        title: "file",
        head: ["lines executed", "branches", "lines never executed"].map(Cow::Borrowed).to_vec(),
        rows: rows.collect(),
        ..Table::default()
    })
}

/// What the linter finds.
fn style(graded: &Graded) -> Option<Table> {
    let warnings = &graded.read.as_ref()?.warnings;
    let row = |remark: &super::line::Remark| vec![remark.place.to_string(), remark.code.clone(), remark.text.clone()];
    let more = warnings.all.saturating_sub(warnings.shown.len());
    (warnings.all > 0).then(|| Table {
        title: "style",
        head: ["code", "warning"].map(Cow::Borrowed).to_vec(),
        rows: warnings.shown.iter().map(row).collect(),
        remarks: Vec::from_iter((more > 0).then(|| format!("... and {more} more"))),
        is_folded: true,
    })
}
