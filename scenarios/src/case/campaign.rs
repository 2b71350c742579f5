//! Campaigns: every fault with every activation, each as a case that runs by itself.

use std::collections::BTreeSet;
use std::ops::Range;

use onescan_server::time::VirtualTime;
use toml::Spanned;

use super::Case;
use super::campaign_file::{ActivationFile, CampaignFaultFile, CampaignFile, CampaignVerdict, FaultKind, ProgramFile};
use super::file::CaseFile;
use super::matrix::COMBINATIONS_MAX;
use crate::arrays::Wrong;
use crate::timed::{Timed, Times};

/// The verdicts with which a campaign is passed unless it says otherwise.
const ACCEPTED: [CampaignVerdict; 4] =
    [CampaignVerdict::Detected, CampaignVerdict::Safe, CampaignVerdict::NoEffect, CampaignVerdict::NotActivated];

/// A campaign, its rows and columns checked.
#[derive(Clone, Debug)]
pub struct Campaign {
    pub name: String,
    /// What it is about.
    pub about: Option<String>,
    /// The faults, in the order of the file.
    pub faults: Vec<CampaignFault>,
    /// The names of the activations, in the order of the file.
    pub activations: Vec<String>,
    /// The run without faults for each combination of the matrix and each program, and what that adds to names; one
    /// without any. The program of the scenario comes first, before the others with the same combination.
    pub variants: Vec<(String, Case)>,
    /// The programs beside that of the scenario, in the order of the file, then mutants.
    pub programs: Vec<CampaignProgram>,
    /// A case for each fault, activation and variant: all of the first fault, then those of the second; the variant changes
    /// fastest.
    pub cases: Vec<Case>,
    /// The verdicts with which it is passed.
    pub accepted: Vec<CampaignVerdict>,
    pub(crate) file: CampaignFile,
}

/// A program of a campaign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CampaignProgram {
    pub name: String,
    pub about: Option<String>,
}

/// A fault of a campaign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CampaignFault {
    pub name: String,
    /// Where it is brought in.
    pub kind: FaultKind,
    pub about: Option<String>,
}

/// What the fault of a campaign is to its case.
#[derive(Clone, Debug, PartialEq)]
pub struct Injection {
    /// Its campaign, and the fault and the activation in that.
    pub(super) place: [usize; 3],
    /// When it comes, if that is by time, and where that is written.
    pub(crate) at: Option<(VirtualTime, Range<usize>)>,
}

/// Says that a name is that of a file on any system.
pub(crate) fn is_name(name: &str) -> bool {
    let allowed = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
    !name.is_empty() && !name.starts_with('.') && name.chars().all(allowed)
}

/// The campaign of `file`, which is the one of this number in its file, and whose faults come to these variants.
pub(super) fn expanded(
    file: &CampaignFile,
    variants: Vec<(String, Case)>,
    programs: &[Spanned<ProgramFile>],
    number: usize,
) -> Result<Campaign, Wrong> {
    names(file.faults.iter().map(|fault| &fault.get_ref().name), "faults")?;
    names(file.activations.iter().map(|activation| &activation.get_ref().name), "activations")?;
    names(programs.iter().map(|program| &program.get_ref().name), "programs")?;
    let place = file.name.span();
    if file.faults.is_empty() || file.activations.is_empty() {
        let what = if file.faults.is_empty() { "fault" } else { "activation" };
        let help = format!("write a `[[campaign.{what}]]` below it");
        return Err(wrong(format!("campaign `{}` has no {what}", file.name.get_ref()), place, &help));
    }
    let count = file.faults.len().saturating_mul(file.activations.len()).saturating_mul(variants.len());
    if count > COMBINATIONS_MAX {
        let message = format!("campaign `{}` has more than {COMBINATIONS_MAX} cases", file.name.get_ref());
        return Err(wrong(message, place, "make two of it"));
    }
    let mut cases = Vec::with_capacity(count);
    for (row, fault) in file.faults.iter().enumerate() {
        for (column, activation) in file.activations.iter().enumerate() {
            let (fault, activation) = (fault.get_ref(), activation.get_ref());
            // What is wrong is reported now; the entry itself is made when its case is asked for.
            let at = put(&mut CaseFile::empty(&file.name), fault, activation)?;
            let path = [&file.name, &fault.name, &activation.name].map(|name| name.get_ref().as_str());
            cases.extend(variants.iter().map(|(suffix, healthy)| Case {
                name: format!("{}{suffix}", path.join("/")),
                about: fault.about.clone(),
                injection: Some(Injection { place: [number, row, column], at: at.clone() }),
                ..healthy.clone()
            }));
        }
    }
    let program =
        |program: &ProgramFile| CampaignProgram { name: program.name.get_ref().clone(), about: program.about.clone() };
    let fault = |fault: &Spanned<CampaignFaultFile>| {
        let CampaignFaultFile { name, kind, about, .. } = fault.get_ref();
        CampaignFault { name: name.get_ref().clone(), kind: *kind, about: about.clone() }
    };
    Ok(Campaign {
        name: file.name.get_ref().clone(),
        about: file.about.clone(),
        faults: file.faults.iter().map(fault).collect(),
        activations: file.activations.iter().map(|one| one.get_ref().name.get_ref().clone()).collect(),
        variants,
        programs: programs.iter().map(|one| program(one.get_ref())).collect(),
        cases,
        accepted: file.accept.clone().unwrap_or_else(|| ACCEPTED.to_vec()),
        file: file.clone(),
    })
}

impl Campaign {
    /// The number of the variant to which the case of this number belongs.
    pub fn variant_of(&self, case: usize) -> usize {
        case % self.variants.len().max(1)
    }

    /// The number of the variant with the same combination of the matrix and the scenario's own program.
    pub fn own_program_of(&self, variant: usize) -> usize {
        variant - variant % (self.programs.len() + 1)
    }

    /// The name of a variant's program, if it is not the scenario's own.
    pub fn program_of(&self, variant: usize) -> Option<&str> {
        let number = (variant % (self.programs.len() + 1)).checked_sub(1)?;
        self.programs.get(number).map(|program| program.name.as_str())
    }

    /// The files of all programs, as they are named: relative to the scenario. Those of several variants come several times.
    pub fn program_files(&self) -> impl Iterator<Item = &str> {
        let codes = self.variants.iter().flat_map(|(_, case)| &case.code);
        codes.filter_map(|code| Some(code.get_ref().by.as_ref()?.get_ref().as_str()))
    }

    /// What the case of an injection does: what `base` does, and the fault.
    ///
    /// # Errors
    /// None for an injection of this campaign, which was checked when it was read.
    pub(super) fn entry(&self, base: Option<&CaseFile>, injection: &Injection) -> Result<CaseFile, Wrong> {
        let mut entry = base.cloned().unwrap_or_else(|| CaseFile::empty(&self.file.name));
        let [_, row, column] = injection.place;
        if let (Some(fault), Some(activation)) = (self.file.faults.get(row), self.file.activations.get(column)) {
            put(&mut entry, fault.get_ref(), activation.get_ref())?;
        }
        Ok(entry)
    }
}

fn wrong(message: String, place: Range<usize>, help: &str) -> Wrong {
    Wrong { message, place: Some(place), help: Some(help.to_owned()) }
}

fn names<'a>(all: impl Iterator<Item = &'a Spanned<String>>, what: &str) -> Result<(), Wrong> {
    let mut seen = BTreeSet::new();
    for name in all {
        if !is_name(name.get_ref()) {
            let message = format!("`{}` is not a name of one of the {what}", name.get_ref());
            return Err(wrong(message, name.span(), "letters, digits, `-`, `_` and `.`"));
        }
        if !seen.insert(name.get_ref().to_lowercase()) {
            let message = format!("two {what} of the campaign are called `{}`", name.get_ref());
            return Err(wrong(message, name.span(), "names differ, without regard to case"));
        }
    }
    Ok(())
}

/// A fault with the keys of an activation that say when.
fn timed<Fault: Timed + Clone>(fault: &Spanned<Fault>, activation: &ActivationFile) -> Result<Spanned<Fault>, Wrong> {
    let (place, mut entry) = (fault.span(), fault.get_ref().clone());
    if entry.says_when() {
        return Err(said_twice(place));
    }
    let ActivationFile { at, when, nth, from, lasting, .. } = activation.clone();
    entry.set_times(Times { from: at.or(from), until: None, when, nth, lasting });
    Ok(Spanned::new(place, entry))
}

fn said_twice(place: Range<usize>) -> Wrong {
    let help = "leave `at`, `from`, `until`, `when`, `nth` and `for` to `[[campaign.activation]]`";
    wrong("a fault of a campaign does not say when it comes".to_owned(), place, help)
}

/// Adds a fault at an activation to the entry of a case; gives the time if it comes by time.
fn put(
    entry: &mut CaseFile,
    fault: &CampaignFaultFile,
    activation: &ActivationFile,
) -> Result<Option<(VirtualTime, Range<usize>)>, Wrong> {
    let place = activation.name.span();
    let at = match (activation.at, &activation.when) {
        (Some(_), None) if activation.nth.is_some() || activation.from.is_some() => {
            let message = "`nth` and `from` belong to a condition".to_owned();
            return Err(wrong(message, place, "write `when`, or leave them out"));
        }
        (Some(at), None) => Some((at, place)),
        (None, Some(_)) => None,
        (Some(_), Some(_)) | (None, None) => {
            let message =
                format!("activation `{}` comes `at` a time or `when` a condition holds", activation.name.get_ref());
            return Err(wrong(message, place, "write one of them"));
        }
    };
    let CampaignFaultFile { fault: failure, force, disturbance, parameter, variable, .. } = fault;
    match (failure, force, disturbance, parameter, variable) {
        (Some(failure), None, None, None, None) => entry.faults.push(timed(failure, activation)?),
        (None, Some(force), None, None, None) => entry.forces.push(timed(force, activation)?),
        (None, None, Some(disturbance), None, None) => {
            entry.disturbances.push(timed(disturbance, activation)?);
        }
        (None, None, None, Some(parameter), None) => {
            entry.parameters.push(timed(parameter, activation)?);
        }
        (None, None, None, None, Some(variable)) if variable.get_ref().at.is_some() => {
            return Err(said_twice(variable.span()));
        }
        (None, None, None, None, Some(variable)) => entry.variables.push(timed(variable, activation)?),
        _ => {
            let message = format!("what fault `{}` does is not said, or said twice", fault.name.get_ref());
            let help = "write one of `fault`, `force`, `disturbance`, `parameter` and `variable`";
            return Err(wrong(message, fault.name.span(), help));
        }
    }
    Ok(at)
}
