//! For people and as JSON.

use std::io::{self, Write};

use onescan_report::number::counted;
use onescan_report::table;
use onescan_scenario::Scenario;
use serde_json::json;

use super::config::MutateConfig;
use super::tally::{Counts, Tally};
use super::trial::Verdict;
use super::{Judged, Mistake};
use onescan_runner::format::Format;

/// Writes what came of all mistakes.
pub(super) fn write(
    config: &MutateConfig,
    scenario: &Scenario,
    judged: &[Judged],
    tally: &Tally,
    out: &mut dyn Write,
) -> io::Result<()> {
    match config.format {
        Format::Human => human(scenario, judged, tally, out)?,
        Format::Json => {
            for one in judged {
                writeln!(out, "{}", object(one))?;
            }
            let all = tally.all();
            let kinds: serde_json::Map<String, serde_json::Value> =
                tally.kinds().map(|(kind, counts)| (kind.word().to_owned(), json!(counts))).collect();
            let statement = json!({ "scenario": scenario.name(), "mutants": all.mutants(), "score_pct": all.score_pct(),
                "all": all, "kinds": kinds, "version": env!("CARGO_PKG_VERSION") });
            writeln!(out, "{statement}")?;
        }
    }
    out.flush()
}

fn object(Judged { mistake, verdict }: &Judged) -> serde_json::Value {
    let Mistake { client, source, mutant } = mistake;
    let (word, case, by) = match verdict {
        Verdict::Killed { case, by } => ("killed", Some(case), Some(by)),
        Verdict::Survived { case } => ("survived", Some(case), None),
        Verdict::Unreached => ("unreached", None, None),
        Verdict::Equivalent => ("equivalent", None, None),
        Verdict::Refused { why } => ("refused", None, Some(why)),
    };
    json!({ "client": client, "file": source, "line": mutant.place.line, "column": mutant.place.column,
        "kind": mutant.kind.word(), "was": mutant.was, "is": mutant.replacement, "verdict": word, "case": case, "by": by })
}

fn human(scenario: &Scenario, judged: &[Judged], tally: &Tally, out: &mut dyn Write) -> io::Result<()> {
    let all = tally.all();
    let mutants = counted(all.mutants() as u64, "mutant");
    writeln!(
        out,
        "{}: {mutants}, {:.1} % of those that can be distinguished were noticed",
        scenario.name(),
        all.score_pct()
    )?;
    let head = ["", "killed", "survived", "unreached", "equivalent"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(tally.kinds().map(|(kind, counts)| row(kind.word(), counts)));
    rows.push(row("all", &all));
    table::write(&rows, out)?;
    if all.refused > 0 {
        writeln!(out, "  {} would not be a program", counted(all.refused as u64, "other"))?;
    }
    for (title, is_meant) in [
        ("survived: a signal was another one, and no expectation said so", is_survivor as fn(&Verdict) -> bool),
        ("unreached: no case executes the line", |verdict| *verdict == Verdict::Unreached),
    ] {
        let meant: Vec<&Judged> = judged.iter().filter(|one| is_meant(&one.verdict)).collect();
        if meant.is_empty() {
            continue;
        }
        writeln!(out, "\n{title}")?;
        for one in meant {
            writeln!(out, "  {}", description(scenario, one))?;
        }
    }
    Ok(())
}

fn is_survivor(verdict: &Verdict) -> bool {
    matches!(verdict, Verdict::Survived { .. })
}

fn row(name: &str, counts: &Counts) -> Vec<String> {
    let numbers = [counts.killed, counts.survived, counts.unreached, counts.equivalent];
    std::iter::once(name.to_owned()).chain(numbers.iter().map(ToString::to_string)).collect()
}

/// A mistake with its place, and the case in which it shows.
fn description(scenario: &Scenario, Judged { mistake, verdict }: &Judged) -> String {
    let Mistake { client, source, mutant } = mistake;
    let plcs = scenario.file().clients.values().filter(|each| each.get_ref().is_plc()).count();
    let whose = if plcs > 1 { format!("{client}: ") } else { String::new() };
    let case = if let Verdict::Survived { case } = verdict { format!(" (case {case})") } else { String::new() };
    format!("{whose}{source}:{}:{} {mutant}{case}", mutant.place.line, mutant.place.column)
}
