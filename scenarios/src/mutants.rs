//! The cases of a scenario with the mutants of its campaigns: programs with one small mistake each, as `onescan mutate` makes them,
//! tried like any other program.

use onescan_iec::source::LineColumn;
use onescan_server::random::seed_for;
use onescan_server::signal::{ClientName, did_you_mean};
use toml::Spanned;

use crate::arrays::Wrong;
use crate::case::Catalogue;
use crate::case::campaign_file::{MutantsFile, ProgramFile};
use crate::case::catalogue::NoMutants;
use crate::case::file::CodeFile;
use crate::error::ScenarioError;
use crate::load::Scenario;
use crate::mistake::Mistake;

impl Scenario {
    /// All of its cases, and its campaigns with their mutants.
    ///
    /// # Errors
    /// `cases.toml` or a source cannot be read or is wrong, each with its place.
    pub fn catalogue(&self) -> Result<Catalogue, ScenarioError> {
        Catalogue::load_with(self.path(), &|wanted| programs(self, wanted))
    }
}

/// The programs that a campaign asks for. A mistake with which the PLC could not take part is none.
fn programs(scenario: &Scenario, wanted: &Spanned<MutantsFile>) -> Result<Vec<Spanned<ProgramFile>>, NoMutants> {
    let (place, asked) = (wanted.span(), wanted.get_ref());
    let only = asked.client.as_ref().map(|client| named(scenario, client)).transpose()?;
    let is_wanted =
        |mistake: &Mistake| asked.kinds.is_empty() || asked.kinds.iter().any(|kind| kind.0 == mistake.mutant.kind);
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
        return Err(NoMutants::Wrong(Wrong { message, place: Some(place), help: None }));
    }
    drawn.sort_by_key(|(number, _)| *number);
    let spanned = |(number, mistake)| Spanned::new(place.clone(), program(number, mistake, wanted));
    Ok(drawn.into_iter().map(spanned).collect())
}

fn named(scenario: &Scenario, client: &Spanned<String>) -> Result<ClientName, NoMutants> {
    let known = scenario.file().clients.keys();
    known.clone().find(|name| name.as_str() == client.get_ref()).cloned().ok_or_else(|| {
        let help = did_you_mean(client.get_ref(), known.map(ClientName::as_str));
        let message = format!("there is no client `{}`", client.get_ref());
        NoMutants::Wrong(Wrong { message, place: Some(client.span()), help })
    })
}

/// The program with a mistake.
fn program(number: usize, mistake: &Mistake, wanted: &Spanned<MutantsFile>) -> ProgramFile {
    let Mistake { client, source, mutant } = mistake;
    let LineColumn { line, column } = mutant.place;
    let text = |text: &str| Spanned::new(wanted.span(), text.to_owned());
    let name = format!("mutant-{number}");
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
