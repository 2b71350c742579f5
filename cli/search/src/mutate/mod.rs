//! `onescan mutate`: small mistakes in the PLC's program, one at a time, and whether any expectation notices.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | `trial` | all cases run with a mistake |
//! | `tally` | how many of which kind were noticed |
//! | `report` | for people and as JSON |
//!
//! **Invariants.** What is said of a mistake depends on its runs alone, not on how many went at a time. An expectation that
//! the program without mistakes does not meet notices nothing.

pub mod config;
mod report;
mod tally;
mod trial;

use std::io::Write;

use onescan_iec::source::LineColumn;
use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::case::written::{Entry, List};
use onescan_scenario::case::{Case, Catalogue};
use onescan_scenario::mistake::Mistake;
use onescan_server::signal::{ClientName, did_you_mean};
use toml::Value;

pub use config::MutateConfig;
use tally::Tally;
use trial::{Trial, Verdict};

use crate::forest::each;
use onescan_runner::error::{ExitCode, Usage};
use onescan_runner::run::SearchError;

/// A mistake, and what came of it.
struct Judged {
    mistake: Mistake,
    verdict: Verdict,
}

/// Tries all mistakes that `config` asks for, and writes what came of them to `out`.
///
/// # Errors
/// The scenario is wrong, has no soft PLC, or fails without any mistake.
pub fn run(config: &MutateConfig, out: &mut dyn Write) -> Result<ExitCode, SearchError> {
    let scenario = Scenario::load(&config.scenario)?;
    let catalogue = Catalogue::load(scenario.path())?;
    let cases = chosen(&scenario, &catalogue, &config.cases)?;
    let mut mistakes = scenario.mistakes(config.client.as_ref())?;
    mistakes.retain(|mistake| config.kinds.is_empty() || config.kinds.contains(&mistake.mutant.kind));
    if mistakes.is_empty() {
        return Err(nothing(&scenario, config.client.as_ref()).into());
    }
    let trial = Trial::new(&scenario, &catalogue, cases)?;
    let verdicts = each(config.jobs, &mistakes, (config.progress, "mutants"), |mistake| trial.verdict(mistake))?;
    let judged: Vec<Judged> =
        mistakes.into_iter().zip(verdicts).map(|(mistake, verdict)| Judged { mistake, verdict }).collect();
    let tally = Tally::of(&judged);
    if let Some(path) = &config.written {
        file::write_output(path, survivors(&scenario, &catalogue, &judged)?.as_bytes())?;
    }
    report::write(config, &scenario, &judged, &tally, out).map_err(OutputError)?;
    let enough = config.at_least.is_none_or(|wanted| tally.all().score_pct() >= f64::from(wanted));
    Ok(if enough { ExitCode::Ok } else { ExitCode::Unmet })
}

/// The cases of these names; all if none is named.
fn chosen<'c>(scenario: &Scenario, catalogue: &'c Catalogue, names: &[String]) -> Result<Vec<&'c Case>, SearchError> {
    if names.is_empty() {
        return Ok(catalogue.cases().iter().collect());
    }
    names.iter().map(|name| Ok(catalogue.named(scenario, name)?)).collect()
}

/// Those that survived as a `cases.toml`, each on top of the case in which a signal was another one: `onescan run` shows
/// it, and `onescan diff` names what it did.
fn survivors(scenario: &Scenario, catalogue: &Catalogue, judged: &[Judged]) -> Result<String, SearchError> {
    let mut text = String::from("version = 1\n");
    for (number, Judged { mistake, verdict }) in (1..).zip(judged) {
        let Verdict::Survived { case } = verdict else { continue };
        let mut written = catalogue.written(catalogue.named(scenario, case)?);
        let Mistake { client, source, mutant } = mistake;
        let LineColumn { line, column } = mutant.place;
        written.about = Some(format!("{source}:{line}:{column} {mutant}, as it shows in case {case}"));
        let keys = [
            ("client", Value::from(client.as_str())),
            ("source", Value::from(source.as_str())),
            ("line", Value::from(i64::from(line))),
            ("column", Value::from(i64::from(column))),
            ("was", Value::from(mutant.was.as_str())),
            ("is", Value::from(mutant.replacement.as_str())),
        ];
        let keys = keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        written.entries.push(Entry { list: List::Code, keys });
        text.push('\n');
        text.push_str(&written.to_toml(&format!("mutant-{number}"), &written.entries));
    }
    Ok(text)
}

/// Why there is no mistake that could be made.
fn nothing(scenario: &Scenario, client: Option<&ClientName>) -> Usage {
    let Some(client) = client else {
        return Usage::new("the scenario has no soft PLC in whose program a mistake could be", None);
    };
    let names = scenario.file().clients.keys().map(ClientName::as_str);
    let message = format!("the scenario has no soft PLC `{client}` in whose program a mistake could be");
    Usage::new(message, did_you_mean(client.as_str(), names))
}
