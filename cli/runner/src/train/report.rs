//! What came of a session, in words and as a page.

use std::io::{self, Write};

use onescan_report::number::short;
use onescan_report::page::{Event, Mood, Page, Section, Shown};
use onescan_report::{Table, Verdict};
use onescan_scenario::lesson::Lesson;

use super::record::{AttemptRecord, SessionRecord, to_text};
use super::score::{Expected, Handled, Made, Response, Score, Spent};
use crate::web::{Kept, LessonCost, LessonResult, Met, Slip, Timing};

/// Nothing to be said.
const NOTHING: &str = "–";

/// A response as `+3.200 s`, with what it should have been where it was not.
fn after(response: Option<&Response>) -> String {
    let Some(response) = response else { return NOTHING.to_owned() };
    let after = response.after_ns.map_or_else(|| "never".to_owned(), |after_ns| format!("+{}", to_text(after_ns)));
    match response.within_ns {
        Some(within_ns) if !response.is_timely() => format!("{after} (within {})", to_text(within_ns)),
        _ => after,
    }
}

fn spent(spent: &Spent) -> String {
    let unit = spent.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
    format!("{}{unit}", short(spent.value))
}

/// What the expert made of the same malfunction.
fn beside<'s>(expert: Option<&'s Score>, name: &str) -> Option<&'s Handled> {
    expert?.malfunctions.iter().find(|handled| handled.name == name)
}

fn malfunctions(score: &Score, expert: Option<&Score>) -> Table {
    let row = |handled: &Handled| {
        let theirs = beside(expert, &handled.name);
        vec![
            handled.name.clone(),
            handled.begun_ns.map_or_else(|| "did not come".to_owned(), to_text),
            after(handled.identified.as_ref()),
            after(theirs.and_then(|theirs| theirs.identified.as_ref())),
            after(handled.acted.as_ref()),
            after(theirs.and_then(|theirs| theirs.acted.as_ref())),
        ]
    };
    let head = ["begun", "identified", "expert", "acted", "expert"];
    Table {
        title: "malfunction",
        head: head.into_iter().map(Into::into).collect(),
        rows: score.malfunctions.iter().map(row).collect(),
        remarks: Vec::new(),
        is_folded: false,
    }
}

fn costs(score: &Score, expert: Option<&Score>) -> Table {
    let theirs = |name: &str| expert?.costs.iter().find(|cost| cost.name == name);
    let mut rows: Vec<Vec<String>> = score
        .costs
        .iter()
        .map(|cost| vec![cost.name.clone(), spent(cost), theirs(&cost.name).map_or(NOTHING.to_owned(), spent)])
        .collect();
    let lasted = expert.map_or(NOTHING.to_owned(), |expert| to_text(expert.lasted_ns()));
    rows.push(vec!["time".to_owned(), to_text(score.lasted_ns()), lasted]);
    let head = ["trainee", "expert"].into_iter().map(Into::into).collect();
    Table { title: "cost", head, rows, remarks: Vec::new(), is_folded: false }
}

/// What must not be done, and how often it was.
fn mistakes(score: &Score) -> Table {
    let row = |made: &Made| {
        let first = made.first_ns.map_or(NOTHING.to_owned(), to_text);
        vec![made.name.clone(), made.count.to_string(), made.at_most.to_string(), first]
    };
    let head = ["made", "forgiven", "first"].into_iter().map(Into::into).collect();
    let rows = score.mistakes.iter().map(row).collect();
    Table { title: "mistake", head, rows, remarks: Vec::new(), is_folded: false }
}

/// What came of an attempt, for its pages.
pub(super) fn result(score: &Score) -> LessonResult {
    let timing = |response: Response| Timing {
        after_ns: response.after_ns,
        within_ns: response.within_ns,
        timely: response.is_timely(),
    };
    let met = |handled: &Handled| Met {
        name: handled.name.clone(),
        came: handled.begun_ns.is_some(),
        identified: handled.identified.map(timing),
        acted: handled.acted.map(timing),
    };
    let kept = |expected: &Expected| Kept {
        name: expected.name.clone(),
        met: expected.verdict != Verdict::Violated,
        at_ns: expected.at_ns,
    };
    let slip = |made: &Made| Slip { name: made.name.clone(), count: made.count, at_most: made.at_most };
    let cost = |spent: &Spent| LessonCost { name: spent.name.clone(), value: spent.value, unit: spent.unit.clone() };
    LessonResult {
        passed: score.is_passed(),
        done: score.done,
        lasted_ns: score.lasted_ns(),
        malfunctions: score.malfunctions.iter().map(met).collect(),
        expectations: score.expectations.iter().map(kept).collect(),
        mistakes: score.mistakes.iter().map(slip).collect(),
        costs: score.costs.iter().map(cost).collect(),
    }
}

/// Where an attempt begins, in words.
fn origin(attempt: &AttemptRecord) -> String {
    match attempt.fork {
        None => format!("from `{}`", attempt.start),
        Some(fork) => format!("back to {} of attempt {}", to_text(fork.t_v_ns), fork.attempt),
    }
}

fn verdict(passed: bool) -> &'static str {
    if passed { "passed" } else { "not passed" }
}

/// Writes a session for people.
pub(super) fn write(record: &SessionRecord, unequal: &[String], out: &mut dyn Write) -> io::Result<()> {
    let SessionRecord { scenario, lesson, trainee, passed, .. } = record;
    writeln!(out, "lesson `{lesson}` of {scenario}, {trainee}: {}", verdict(*passed))?;
    let expert = record.expert.as_ref().map(|expert| &expert.score);
    for attempt in &record.attempts {
        let score = &attempt.score;
        writeln!(
            out,
            "attempt {}, {}: {}, {}, {} steps, digest {}",
            attempt.number,
            origin(attempt),
            attempt.end,
            verdict(score.is_passed()),
            attempt.steps,
            attempt.digest
        )?;
        if let Some(failure) = &attempt.failure {
            writeln!(out, "  {failure}")?;
        }
        if score.done == Some(false) {
            writeln!(out, "  it was not brought to its end")?;
        }
        if !score.malfunctions.is_empty() {
            malfunctions(score, expert).write(out)?;
        }
        if !score.mistakes.is_empty() {
            mistakes(score).write(out)?;
        }
        for expected in &score.expectations {
            let at = expected.at_ns.map(|at_ns| format!(" at {}", to_text(at_ns))).unwrap_or_default();
            let unit = expected.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
            let margin = expected.margin.map(|margin| format!(" (margin {}{unit})", short(margin))).unwrap_or_default();
            writeln!(out, "  expectation `{}` {}{at}{margin}", expected.name, expected.verdict.word())?;
        }
        costs(score, expert).write(out)?;
    }
    unequal.iter().try_for_each(|one| writeln!(out, "not repeated: {one}"))
}

/// The page of a session.
pub(super) fn page(record: &SessionRecord, lesson: &Lesson) -> Page {
    let expert = record.expert.as_ref().map(|expert| &expert.score);
    Page {
        title: format!("{}: lesson {}", record.scenario, record.lesson),
        totals: format!("{}, {}", record.trainee, verdict(record.passed)),
        wall: lesson.about.clone().unwrap_or_default(),
        sections: record.attempts.iter().map(|attempt| section(attempt, expert)).collect(),
        ..Page::default()
    }
}

fn section(attempt: &AttemptRecord, expert: Option<&Score>) -> Section {
    let score = &attempt.score;
    let passed = score.is_passed() && attempt.failure.is_none();
    let shown = |expected: &Expected| Shown {
        name: expected.name.clone(),
        verdict: expected.verdict,
        at: expected.at_ns.map(to_text).unwrap_or_default(),
        values: Vec::new(),
        margin: expected.margin,
        unit: expected.unit.clone(),
    };
    Section {
        title: format!("attempt {}, {}", attempt.number, origin(attempt)),
        status: format!("{}, {}", attempt.end, verdict(passed)),
        mood: if passed { Mood::Good } else { Mood::Bad },
        steps: Some(attempt.steps),
        virtual_time: to_text(score.end_ns),
        facts: vec![
            ("begun at", to_text(score.begin_ns)),
            ("digest at the start", attempt.begin_digest.clone()),
            ("digest", attempt.digest.clone()),
        ],
        lines: attempt.failure.iter().cloned().collect(),
        expectations: score.expectations.iter().map(shown).collect(),
        tables: vec![malfunctions(score, expert), mistakes(score), costs(score, expert)],
        events: events(score),
        pictures: Vec::new(),
    }
}

/// What happened, in the order of time.
fn events(score: &Score) -> Vec<Event> {
    let mut all: Vec<(u64, String)> = Vec::new();
    for handled in &score.malfunctions {
        let name = &handled.name;
        all.extend(handled.begun_ns.map(|at_ns| (at_ns, format!("{name} begins"))));
        let at = |response: &Option<Response>| response.and_then(|response| response.at_ns);
        all.extend(at(&handled.identified).map(|at_ns| (at_ns, format!("{name} is identified"))));
        all.extend(at(&handled.acted).map(|at_ns| (at_ns, format!("{name}: the right thing is done"))));
    }
    for expected in &score.expectations {
        all.extend(expected.at_ns.map(|at_ns| (at_ns, format!("expectation `{}` violated", expected.name))));
    }
    all.sort();
    all.into_iter().map(|(at_ns, what)| Event { at: to_text(at_ns), what }).collect()
}
