//! The mutants of a campaign: programs with one small mistake each, as `onescan mutate` makes them, tried like any other program.

use std::path::Path;

use onescan_plc_shim::source::LineColumn;
use onescan_server::random::seed_for;
use onescan_server::signal::{ClientName, did_you_mean};
use toml::Spanned;

use super::campaign::is_name;
use super::campaign_file::{MutantsFile, ProgramFile};
use super::file::CodeFile;
use crate::error::ScenarioError;
use crate::load::Scenario;
use crate::mistake::Mistake;

/// Why there are none: in words, the place, and what to do.
pub(super) enum NoMutants {
    Scenario(ScenarioError),
    Wrong(String, std::ops::Range<usize>, Option<String>),
}

impl From<ScenarioError> for NoMutants {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(error)
    }
}

/// The programs that `wanted` asks for, of the scenario at `path`. A mistake with which the PLC could not take part is none.
pub(super) fn programs(wanted: &Spanned<MutantsFile>, path: &Path) -> Result<Vec<Spanned<ProgramFile>>, NoMutants> {
    let (place, asked) = (wanted.span(), wanted.get_ref());
    let scenario = Scenario::load(path)?;
    let only = asked.client.as_ref().map(|client| named(&scenario, client)).transpose()?;
    let is_wanted = |mistake: &Mistake| {
        let is_kind = |kind: &Spanned<super::campaign_file::MutantWord>| kind.get_ref().kind() == mistake.mutant.kind;
        asked.kinds.is_empty() || asked.kinds.iter().any(is_kind)
    };
    // Numbers are those among all mistakes, so that a draw of more has those of a draw of fewer.
    let all = scenario.mistakes(only.as_ref())?;
    let mut numbered: Vec<(usize, &Mistake)> = (1..).zip(&all).filter(|(_, mistake)| is_wanted(mistake)).collect();
    numbered.sort_by_key(|(number, _)| (seed_for(asked.seed, "mutant", &number.to_string()), *number));
    let is_sound = |mistake: &Mistake| scenario.with_mistake(mistake.clone()).member(&mistake.client).is_ok();
    let sound = numbered.into_iter().filter(|(_, mistake)| is_sound(mistake));
    let mut drawn: Vec<(usize, &Mistake)> =
        sound.take(asked.each.map_or(usize::MAX, |each| each.get() as usize)).collect();
    if drawn.is_empty() {
        let message = "there is no soft PLC in whose program such a mistake could be".to_owned();
        return Err(NoMutants::Wrong(message, place, None));
    }
    drawn.sort_by_key(|(number, _)| *number);
    Ok(drawn
        .into_iter()
        .map(|(number, mistake)| Spanned::new(place.clone(), program(number, mistake, wanted)))
        .collect())
}

fn named(scenario: &Scenario, client: &Spanned<String>) -> Result<ClientName, NoMutants> {
    let known = scenario.file().clients.keys();
    known.clone().find(|name| name.as_str() == client.get_ref()).cloned().ok_or_else(|| {
        let help = did_you_mean(client.get_ref(), known.map(ClientName::as_str));
        NoMutants::Wrong(format!("there is no client `{}`", client.get_ref()), client.span(), help)
    })
}

/// The program with a mistake.
fn program(number: usize, mistake: &Mistake, wanted: &Spanned<MutantsFile>) -> ProgramFile {
    let Mistake { client, source, mutant } = mistake;
    let LineColumn { line, column } = mutant.place;
    let text = |text: &str| Spanned::new(wanted.span(), text.to_owned());
    let name = format!("mutant-{number}");
    debug_assert!(is_name(&name));
    let code = CodeFile {
        client: Some(text(client.as_str())),
        source: text(source),
        by: None,
        line: Some(line),
        column: Some(column),
        was: Some(mutant.was.clone()),
        is: Some(mutant.replacement.clone()),
    };
    ProgramFile {
        name: text(&name),
        about: Some(format!("{source}:{line}:{column} {mutant}")),
        code: vec![Spanned::new(wanted.span(), code)],
    }
}
