//! What was found, or how near the search came.

use std::io::{self, Write};

use onescan_report::number::{counted, short};
use onescan_scenario::Scenario;
use serde_json::json;

use super::config::FalsifyConfig;
use super::search::Found;
use onescan_runner::format::Format;

/// The finding as a case that runs by itself.
pub(super) struct Case {
    pub(super) text: String,
    pub(super) digest: Option<String>,
}

/// Writes what came of a search.
pub(super) fn write(
    config: &FalsifyConfig,
    scenario: &Scenario,
    expect: Option<usize>,
    found: &Found,
    case: Option<&Case>,
    out: &mut dyn Write,
) -> io::Result<()> {
    match config.format {
        Format::Human => human(config, scenario, expect, found, case, out)?,
        Format::Json => {
            let branches = found.branches.map(|(taken, all)| json!({ "taken": taken, "all": all }));
            let statement = json!({ "scenario": scenario.name(), "falsified": found.best.is_finding(),
                "violated": found.best.violated, "failure": found.best.failure, "robustness": found.best.robustness,
                "simulations": found.simulations, "forked": found.forked, "branches": branches,
                "point": found.best.point, "optimiser": config.optimiser.word(), "objective": config.objective.word(),
                "seed": config.seed, "case": case.map(|case| &case.text), "digest": case.and_then(|case| case.digest.as_ref()),
                "version": env!("CARGO_PKG_VERSION") });
            writeln!(out, "{statement}")?;
        }
    }
    out.flush()
}

fn human(
    config: &FalsifyConfig,
    scenario: &Scenario,
    expect: Option<usize>,
    found: &Found,
    case: Option<&Case>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let named = &scenario.expectations().named;
    let one = expect.or_else(|| (named.len() == 1).then_some(0)).and_then(|number| named.get(number));
    let unit = one.and_then(|(_, expectation)| expectation.unit()).map(|unit| format!(" {unit}")).unwrap_or_default();
    let robustness = format!("robustness {}{unit}", short(found.best.robustness));
    let simulations = counted(found.simulations, "simulation");
    let how = format!("{}, seed {}", config.optimiser.word(), config.seed);
    if let Some(case) = case {
        let violated = found.best.violated.iter().map(|name| format!("`{name}`"));
        let what: Vec<String> = violated.chain(found.best.failure.clone()).collect();
        writeln!(out, "{}: {} does not hold with", scenario.name(), what.join(", "))?;
        for line in case.text.lines() {
            writeln!(out, "    {line}")?;
        }
        writeln!(out, "{}: found in {simulations} ({how}); {robustness}", scenario.name())?;
        if let Some(digest) = &case.digest {
            writeln!(out, "  digest {digest}")?;
        }
    } else {
        let what = one.map_or_else(|| "what is expected".to_owned(), |(name, _)| format!("`{name}`"));
        writeln!(out, "{}: {what} holds in all of {simulations} ({how}); least {robustness}", scenario.name())?;
    }
    if let Some((taken, all)) = found.branches {
        writeln!(out, "  branches {}", onescan_runner::run::coverage::share((all, taken)))?;
    }
    Ok(())
}
