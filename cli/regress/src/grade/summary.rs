//! The report for people.

use std::io::{self, Write};

use onescan_base::foreign::one_line;
use onescan_iec::diagnostic::counted;
use onescan_report::number::short;
use onescan_report::table;
use onescan_runner::run::coverage::share;
use onescan_server::time::VirtualTime;

use super::alike;
use super::config::Detail;
use super::line::Suspect;
use super::marks::{Graded, How, Marked, Missed, Standing, percent};
use super::task::{Item, Task};

/// Cases that are shown of an expectation; what is missed in more of them is counted.
const CASES_SHOWN: usize = 3;
/// Findings in sources that are shown of a submission.
const REMARKS_SHOWN: usize = 10;

/// Writes what came of all submissions.
///
/// # Errors
/// Those of `out`.
pub(super) fn write(task: &Task, all: &[Graded], detail: Detail, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{}", headline(task))?;
    table::write(&rows(task, all), out)?;
    alike_lines(all).iter().try_for_each(|line| writeln!(out, "{line}"))?;
    if detail == Detail::Full || all.len() == 1 {
        for graded in all {
            writeln!(out, "\n{}: {}", graded.submission.name, standing(task, graded))?;
            details(task, graded).iter().try_for_each(|line| writeln!(out, "  {line}"))?;
        }
    }
    out.flush()
}

/// What is judged, in a line.
pub(super) fn headline(task: &Task) -> String {
    let hidden = match task.cases.iter().filter(|case| case.is_hidden).count() {
        0 => String::new(),
        hidden => format!(", {hidden} of them hidden"),
    };
    let (items, cases) = (counted(task.items.len(), "expectation"), counted(task.cases.len(), "case"));
    format!("{}: {} marks for {items} in {cases}{hidden}", task.scenario.name(), task.marks())
}

/// The head of the table of all submissions.
pub(super) const HEAD: [&str; 4] = ["submission", "marks", "%", "what is to be looked at"];

/// The cells of a submission, below that head.
pub(super) fn cells(task: &Task, graded: &Graded) -> [String; 4] {
    let (given, all) = (graded.given(), task.marks());
    [graded.submission.name.clone(), format!("{given} of {all}"), percent(given, all), remark(task, graded)]
}

fn rows(task: &Task, all: &[Graded]) -> Vec<Vec<String>> {
    let head = HEAD.map(str::to_owned).to_vec();
    std::iter::once(head).chain(all.iter().map(|graded| cells(task, graded).to_vec())).collect()
}

/// What is to be looked at first.
fn remark(task: &Task, graded: &Graded) -> String {
    let mut parts = Vec::new();
    match (&graded.standing, graded.safety_violations(task)) {
        (Standing::Graded, 0) => {}
        (Standing::Graded, 1) => parts.push("1 violation of safety".to_owned()),
        (Standing::Graded, more) => parts.push(format!("{more} violations of safety")),
        (other, _) => parts.extend(other.why().map(str::to_owned)),
    }
    if let Standing::Refused(refused) = &graded.standing {
        parts.extend(refused.errors.lines(1).into_iter().next());
    }
    match graded.faults(task).count() {
        0 => {}
        faults => parts.push(format!("{} ended with a fault", counted(faults, "case"))),
    }
    if graded.read.as_ref().is_some_and(|read| read.is_as_handed_out) {
        parts.push("as it was handed out".to_owned());
    }
    parts.join("; ")
}

/// Which submissions are equal, a line each.
pub(super) fn alike_lines(all: &[Graded]) -> Vec<String> {
    let line = |group: Vec<usize>| {
        let names: Vec<&str> = group.iter().map(|number| all[*number].submission.name.as_str()).collect();
        format!("equal in structure and in every run: {}", names.join(", "))
    };
    alike::groups(all).into_iter().map(line).collect()
}

/// Which others a submission is equal to, if there are any.
pub(super) fn alike_line(graded: &Graded) -> Option<String> {
    let others = (!graded.alike.is_empty()).then(|| graded.alike.join(", "))?;
    Some(format!("equal in structure and in every run to {others}"))
}

/// The marks of a submission in words.
pub(super) fn standing(task: &Task, graded: &Graded) -> String {
    let (given, all) = (graded.given(), task.marks());
    let why = graded.standing.why().map(|why| format!(", {why}")).unwrap_or_default();
    format!("{given} of {all} marks ({} %){why}", percent(given, all))
}

/// All there is to say of a submission: what endangers somebody first, then what else is missed, what is met, and its style.
pub(super) fn details(task: &Task, graded: &Graded) -> Vec<String> {
    let mut lines = missed(task, graded);
    let met = task.items.iter().zip(&graded.marked).filter(|(_, marked)| is_met(graded, marked));
    lines.extend(met.map(|(item, marked)| format!("met     {}: {}", item.title(), of_marks(item, marked))));
    if let Some(read) = &graded.read {
        let coverage = &graded.coverage;
        let (executed, branches) = (share(coverage.lines()), share(coverage.branches()));
        lines.push(format!("executed: lines {executed}, branches {branches}"));
        if read.warnings.all > 0 {
            lines.push(format!("style: {}", counted(read.warnings.all, "warning")));
            lines.extend(read.warnings.lines(REMARKS_SHOWN).into_iter().map(|line| format!("  {line}")));
        }
    }
    lines.extend(alike_line(graded));
    lines
}

/// What went wrong: why it could not be graded, faults, what is missed, and which lines are to be looked at for it.
pub(super) fn missed(task: &Task, graded: &Graded) -> Vec<String> {
    let mut lines = Vec::new();
    if let Standing::Refused(refused) = &graded.standing {
        lines.extend(refused.errors.lines(REMARKS_SHOWN));
    }
    for (case, ran) in graded.faults(task) {
        let error = ran.error.as_deref().map(one_line).unwrap_or_default();
        lines.push(format!("fault   case {case}: {error}"));
    }
    for (item, marked) in ordered(task, graded) {
        lines.extend(of_item(task, item, marked));
    }
    let look = |Suspect { file, line, why }: &Suspect| format!("look at {file}:{line}: {why}");
    lines.extend(graded.suspects.iter().map(look));
    lines
}

/// The expectations that are missed, violations of safety first.
fn ordered<'g>(task: &'g Task, graded: &'g Graded) -> Vec<(&'g Item, &'g Marked)> {
    let pairs = task.items.iter().zip(&graded.marked).filter(|(_, marked)| !marked.missed.is_empty());
    let mut pairs: Vec<_> = pairs.collect();
    pairs.sort_by_key(|(item, marked)| !marked.endangers(item));
    pairs
}

fn is_met(graded: &Graded, marked: &Marked) -> bool {
    marked.missed.is_empty() && !matches!(graded.standing, Standing::Refused(_) | Standing::Broken(_))
}

fn of_marks(item: &Item, marked: &Marked) -> String {
    format!("{} of {}", marked.given, counted(item.worth.marks as usize, "mark"))
}

/// An expectation that is missed, with when and by which statements.
pub(super) fn of_item(task: &Task, item: &Item, marked: &Marked) -> Vec<String> {
    let word = if marked.endangers(item) { "SAFETY" } else { "missed" };
    let about = item.worth.about.as_ref().map(|about| format!(" ({about})")).unwrap_or_default();
    let mut lines = vec![format!("{word}  {}{about}: {}", item.title(), of_marks(item, marked))];
    // Violations before cases that were not run to their end, which say nothing of it.
    let mut missed: Vec<&Missed> = marked.missed.iter().collect();
    missed.sort_by_key(|missed| !matches!(missed.how, How::Violated { .. }));
    for one in missed.iter().take(CASES_SHOWN) {
        lines.push(format!("        case {}: {}", task.cases[one.case].name, how(&one.how)));
        lines.extend(one.statements.iter().map(|line| format!("          {line}")));
    }
    if let Some(more @ 1..) = missed.len().checked_sub(CASES_SHOWN) {
        lines.push(format!("        and {more} more case{}", if more == 1 { "" } else { "s" }));
    }
    lines
}

/// How an expectation was missed, in words.
pub(super) fn how(how: &How) -> String {
    match how {
        How::Violated { at_ns, values } => {
            let at = VirtualTime::from_nanos(*at_ns);
            if values.is_empty() { format!("violated at {at}") } else { format!("violated at {at}: {}", shown(values)) }
        }
        How::Ended => "it ended with a fault".to_owned(),
        How::NotRun => "it was not run".to_owned(),
    }
}

/// Values of signals, as in `Push = 1, Level = 0.42`.
pub(super) fn shown(values: &[(String, f64)]) -> String {
    values.iter().map(|(signal, value)| format!("{signal} = {}", short(*value))).collect::<Vec<_>>().join(", ")
}
