//! What the check of a scenario finds, each with its place: the same errors that every command reports.

use miette::Diagnostic;
use schemars::JsonSchema;
use serde::Serialize;

use super::change::Texts;
use super::document::Document;
use super::wire;
use crate::wiring::{Map, Trouble};

/// Something that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(super) struct Finding {
    /// Whether a session could not start.
    is_error: bool,
    /// What is wrong.
    message: String,
    /// What to do.
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
    /// The file.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// Its line, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
}

/// An error and all that it brings along.
pub(super) fn of_error(error: &dyn Diagnostic, found: &mut Vec<Finding>) {
    let place = error.labels().and_then(|mut labels| labels.next()).and_then(|label| {
        let contents = error.source_code()?.read_span(label.inner(), 0, 0).ok()?;
        let file = contents.name().map(|name| name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned());
        Some((file, contents.line() + 1))
    });
    let related: Vec<&dyn Diagnostic> = error.related().into_iter().flatten().collect();
    // what only heads a list has no place
    if place.is_some() || related.is_empty() {
        let (file, line) = place.map_or((None, None), |(file, line)| (file, Some(line)));
        let help = error.help().map(|help| help.to_string());
        found.push(Finding { is_error: true, message: error.to_string(), help, file, line });
    }
    for one in related {
        of_error(one, found);
    }
}

/// What is wrong with the wiring: at the signal's line in the scenario, or at the one that names it in a scene.
pub(super) fn of_map(map: &Map, texts: &Texts) -> Vec<Finding> {
    let scenario = Document::parse(wire::FILE, &texts.scenario).ok();
    let place = |signal: &str| {
        let declared = scenario.as_ref().and_then(|document| wire::line_of(document, signal));
        declared.or_else(|| {
            let scenes = texts.scenes.iter().filter_map(|(file, text)| Document::parse(file, text).ok());
            scenes.flat_map(|scene| super::reference::to_signal(&scene, signal)).map(|found| found.place).next()
        })
    };
    let finding = |trouble: &Trouble| {
        let place = place(&trouble.signal);
        Finding {
            is_error: trouble.is_error(),
            message: format!("{} {}: {}", trouble.signal, trouble.kind.title(), trouble.message),
            help: None,
            line: place.as_ref().map(|place| place.line),
            file: place.map(|place| place.file),
        }
    };
    let undriven = map.undriven.iter().map(|input| Finding {
        is_error: false,
        message: format!("{}: {}", input.client, input.message),
        help: None,
        line: Some(input.line as usize),
        file: Some(input.file.clone()),
    });
    map.troubles.iter().map(finding).chain(undriven).collect()
}
