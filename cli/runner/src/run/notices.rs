//! What the scenario cannot carry or leaves open, said once as the first run begins.

use onescan_base::notice::NOTICE;
use onescan_scenario::Scenario;

use super::error::RunError;

/// Says which bodies are in each other, and which inputs of PLCs nobody drives.
///
/// # Errors
/// A client's files are wrong.
pub(crate) fn warn(scenario: &Scenario) -> Result<(), RunError> {
    for (plant, overlaps) in scenario.overlaps()? {
        for overlap in overlaps {
            tracing::warn!(
                target: NOTICE,
                "plant `{plant}`: at the start {overlap}, and the contact presses them apart: move one of them by as \
                 much, or give both the same `group` if they are never to touch"
            );
        }
    }
    for (plc, warnings) in scenario.undriven_inputs()? {
        for finding in warnings.findings() {
            let (warning, place) = (finding.diagnostic(), finding.start());
            let help = warning.help.as_ref().map(|help| format!(" ({help})")).unwrap_or_default();
            let (file, line, code) = (finding.file(), place.line, warning.code);
            tracing::warn!(target: NOTICE, "PLC `{plc}`: {file}:{line}: {code}: {}{help}", warning.message);
        }
    }
    Ok(())
}
