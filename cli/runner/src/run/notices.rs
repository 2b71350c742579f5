//! What the scenario cannot carry or leaves open, said once as the first run begins.

use onescan_base::notice::NOTICE;
use onescan_plant::Excess;
use onescan_scenario::Scenario;
use onescan_server::time::VirtualTime;

use super::error::RunError;

/// Steps that take days: whoever has more of them may have meant another step.
const STEPS_MANY: u64 = 1_000_000_000;

/// Says how many steps a run has that is to end at `end`, if they are very many.
pub(super) fn warn_of_length(scenario: &Scenario, end: VirtualTime) {
    let step = scenario.plan().step();
    let steps = end.as_nanos() / step.as_nanos();
    // A run without an end is stopped by whoever began it.
    if steps >= STEPS_MANY && end != VirtualTime::MAX {
        tracing::warn!(
            target: NOTICE,
            "this run has {steps} steps of {step} up to t_v = {end}, which takes days: choose a longer `step`, or an earlier \
             end with `--until`"
        );
    }
}

/// Says which bodies are in each other, what scenes ask for beyond what they can carry, and which inputs of PLCs
/// nobody drives.
///
/// # Errors
/// A client's files are wrong.
pub(crate) fn warn(scenario: &Scenario) -> Result<(), RunError> {
    warn_of_overlaps(scenario)?;
    warn_of_excesses(scenario)?;
    warn_of_undriven_inputs(scenario)
}

fn warn_of_overlaps(scenario: &Scenario) -> Result<(), RunError> {
    for (plant, overlaps) in scenario.overlaps()? {
        for overlap in overlaps {
            tracing::warn!(
                target: NOTICE,
                "plant `{plant}`: at the start {overlap}, and the contact presses them apart: move one of them by as \
                 much, or give both the same `group` if they are never to touch"
            );
        }
    }
    Ok(())
}

fn warn_of_excesses(scenario: &Scenario) -> Result<(), RunError> {
    for (plant, excesses) in scenario.excesses()? {
        for excess in excesses {
            let help = match &excess {
                Excess::Swing { .. } | Excess::TimeConstant { .. } => {
                    "set `substeps` in the scene, or a shorter `period` of the plant"
                }
                Excess::MassRatio { .. } => {
                    "contacts and loops between them are inexact: raise `solver_iterations`, or make the light one heavier"
                }
                Excess::Hull { .. } | Excess::Surface { .. } => {
                    "each of its contacts costs time: give it a simpler shape, or `collides = false`"
                }
            };
            tracing::warn!(target: NOTICE, "plant `{plant}`: {excess}: {help}");
        }
    }
    Ok(())
}

fn warn_of_undriven_inputs(scenario: &Scenario) -> Result<(), RunError> {
    for (plc, warnings) in scenario.undriven_inputs()? {
        for finding in warnings.findings() {
            let (warning, place) = (finding.diagnostic(), finding.start());
            let (file, line, code) = (finding.file(), place.line, warning.code);
            tracing::warn!(target: NOTICE, "PLC `{plc}`: {file}:{line}: {code}: {}", warning.with_its_help());
        }
    }
    Ok(())
}
