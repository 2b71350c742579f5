//! What of a session does not change while it runs, as the page reads it.

use std::collections::BTreeMap;

use onescan_scenario::file::ClientFile;
use onescan_scenario::{Scenario, ScenarioError};
use schemars::JsonSchema;
use serde::Serialize;

use super::alarms::{self, Alarm};
use super::drawings::{self, Drawing};
use super::known::Known;
use super::looks::{self, Judge, Look, View};
use super::machine::{self, Body, Part};
use super::maps::{self, Map};
use super::online::{self, Online};
use super::panel::{self, Panel};
use super::signals::{self, Signal};
use super::sources::{self, Source};
use super::training::{Forgiven, Role, Training};

/// The version of the protocol, `web/PROTOCOL.md`.
const PROTOCOL: u32 = 1;

/// The parts of a session that do not change while it runs.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Session")]
pub(super) struct Structure {
    protocol: u32,
    title: String,
    scenario: String,
    step_ns: u64,
    #[schemars(with = "Option<u64>")]
    until_ns: u64,
    /// False for a recording: it is shown from its beginning, and nobody operates it.
    #[schemars(default = "yes")]
    pub(super) live: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    training: Option<Lesson>,
    signals: Vec<Signal>,
    #[schemars(default)]
    bodies: Vec<Body>,
    #[schemars(default)]
    components: Vec<Part>,
    #[schemars(default)]
    views: Vec<View>,
    #[schemars(default)]
    looks: Vec<Look>,
    #[schemars(default)]
    panels: Vec<Panel>,
    #[schemars(default)]
    expectations: Vec<Expectation>,
    /// The alarms of `[[report.alarm]]`.
    #[schemars(default)]
    alarms: Vec<Alarm>,
    #[schemars(default)]
    sources: Vec<Source>,
    #[schemars(default)]
    drawings: Vec<Drawing>,
    #[schemars(default)]
    plcs: Vec<online::Plc>,
    #[schemars(default)]
    maps: Vec<Map>,
    /// The scenario's own texts in other languages: by language, what each text is there.
    #[schemars(default)]
    translations: BTreeMap<String, BTreeMap<String, String>>,
    /// The signals of `[plot]`: the trends that the page begins with.
    #[schemars(default)]
    plot: Vec<usize>,
}

/// The lesson that a session is, on the page of one of its two people.
#[derive(Debug, Serialize, JsonSchema)]
struct Lesson {
    role: Role,
    #[serde(rename = "lesson")]
    name: String,
    about: Option<String>,
    /// Prepared states to jump to; none on the trainee's page.
    #[schemars(default)]
    starts: Vec<String>,
    /// What must hold to pass it, by the names of its expectations.
    #[schemars(default)]
    asked: Vec<String>,
    /// What must not be done more often than so.
    #[schemars(default)]
    mistakes: Vec<Forgiven>,
}

/// A session is live where it does not say otherwise.
fn yes() -> bool {
    true
}

impl Lesson {
    fn of(training: &Training) -> Self {
        let starts = if training.role == Role::Trainer { training.starts.clone() } else { Vec::new() };
        Self {
            role: training.role,
            name: training.lesson.clone(),
            about: training.about.clone(),
            starts,
            asked: training.asked.clone(),
            mistakes: training.mistakes.clone(),
        }
    }
}

/// An expectation of the scenario.
#[derive(Debug, Serialize, JsonSchema)]
struct Expectation {
    name: String,
    #[schemars(default)]
    text: String,
}

/// The structure of the scenario's sessions, and what the server needs beside it.
///
/// # Errors
/// A scene that cannot be read; it was read before, so it has just changed.
pub(super) fn of(scenario: &Scenario, training: Option<&Training>) -> Result<(Structure, Known), ScenarioError> {
    let file = scenario.file();
    let mut known = Known::default();
    let (mut bodies, mut components) = (Vec::new(), Vec::new());
    for (name, client) in &file.clients {
        if let ClientFile::Operator { .. } = client.get_ref() {
            known.operators.insert(name.clone());
        }
        if let ClientFile::Plant { scene, .. } = client.get_ref() {
            let scene = scenario.scene_of(name, scene)?;
            machine::add_bodies(&scene, &mut bodies, &mut known.stage);
            for component in &scene.components {
                known.plants.insert(component.name.clone(), name.clone());
                components.push(machine::part(component, &scene));
            }
        }
    }
    let (drawings, states) = drawings::of(scenario)?;
    known.states = states;
    let visible = looks::visible(&bodies, &components);
    let looks = looks::of(scenario, &mut bodies, &visible)?;
    known.looks = Judge::of(scenario);
    let alarms = alarms::of(scenario);
    known.alarms = alarms.len();
    known.disturbances = scenario.panel_disturbances()?;
    let (mut panels, pictures) = panel::of(scenario, &visible)?;
    known.pictures = pictures;
    known.panels = panels.iter().map(|panel| (panel.name.clone(), panel.written())).collect();
    known.trainers = panels.iter().filter(|panel| panel.is_trainers()).map(|panel| panel.name.clone()).collect();
    known.resetting = panels.iter().filter_map(|panel| Some((panel.name.clone(), panel.resets()?))).collect();
    known.by_hand = scenario.plan().clients().iter().filter(|name| scenario.starts_by_hand(name)).cloned().collect();
    let (plcs, looked_into) = Online::of(scenario)?;
    known.online = looked_into;
    known.maps.clone_from(&file.map);
    if let Some(Training { role: role @ Role::Trainee, .. }) = training {
        let hidden = panels.iter().filter(|panel| !role.sees(panel.seat));
        known.hidden = hidden.map(|panel| panel.name.clone()).collect();
        panels.retain(|panel| role.sees(panel.seat));
        for part in &mut components {
            part.failures.clear();
        }
    }
    let structure = Structure {
        protocol: PROTOCOL,
        title: file.title.clone(),
        scenario: scenario.name().to_owned(),
        step_ns: file.step.as_nanos(),
        until_ns: scenario.until().as_nanos(),
        live: true,
        training: training.map(Lesson::of),
        signals: signals::of(scenario),
        bodies,
        components,
        views: looks::views(scenario),
        looks,
        panels,
        expectations: file
            .expect
            .iter()
            .map(|expect| Expectation { name: expect.name.get_ref().clone(), text: expect.formula.get_ref().clone() })
            .collect(),
        alarms,
        sources: sources::of(scenario, &known.online),
        plcs,
        maps: maps::of(scenario),
        translations: file.translations.clone(),
        plot: signals::plotted(scenario),
        drawings,
    };
    Ok((structure, known))
}

#[cfg(test)]
mod tests {
    use onescan_page_types::Types;
    use onescan_page_types::published::{is_published, is_published_in};

    use super::*;
    use crate::web::ask::Ask;
    use crate::web::response::Response;

    #[test]
    fn the_page_has_the_types_of_this_server() {
        let types = Types::default().receive::<Structure>().receive::<Response>().send::<Ask>();
        is_published("src/generated/session.ts", &types.module(PROTOCOL));
        is_published_in("PROTOCOL.md", "asks", &types.table("Ask"));
        is_published_in("PROTOCOL.md", "messages", &types.table("Message"));
    }
}
