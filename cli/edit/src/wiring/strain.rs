//! What scenes ask of plants: bodies that overlap at the start, loops that the engine moves, and what is beyond a plant
//! at its step.

use std::io::{self, Write};

use onescan_scenario::file::ClientFile;
use onescan_scenario::{Scenario, ScenarioError};
use serde::Serialize;

/// Something of a plant's scene that the plant shows otherwise than the machine does.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Strain {
    /// The name of the plant among the scenario's clients.
    client: String,
    /// What it is, with names and figures, for people.
    message: String,
}

/// All of the plants of a scenario, plant by plant.
pub(super) fn of(scenario: &Scenario) -> Result<Vec<Strain>, ScenarioError> {
    let mut found = Vec::new();
    for (name, client) in &scenario.file().clients {
        let ClientFile::Plant { scene, period, .. } = client.get_ref() else { continue };
        let scene = scenario.scene_of(name, scene)?;
        let (loops, overlaps) = (scene.loops(), scene.overlaps());
        let excesses = scene.excesses(period.unwrap_or(scenario.file().step));
        let texts = loops
            .iter()
            .filter(|one| one.by_engine)
            .map(ToString::to_string)
            .chain(overlaps.iter().map(ToString::to_string));
        let texts = texts.chain(excesses.iter().map(ToString::to_string));
        found.extend(texts.map(|message| Strain { client: name.to_string(), message }));
    }
    Ok(found)
}

/// The same for people.
pub(super) fn write(found: &[Strain], out: &mut dyn Write) -> io::Result<()> {
    if !found.is_empty() {
        writeln!(out, "\nin scenes, inexact or costly ({})", found.len())?;
    }
    found.iter().try_for_each(|strain| writeln!(out, "  {}: {}", strain.client, strain.message))
}
