//! `[[campaign]]` of `cases.toml` as it is written.

use std::num::NonZeroU32;
use std::ops::Range;

use onescan_iec_project::mutate::MutantKind;
use onescan_links::gateway::settings::Text;
use onescan_server::signal::SignalName;
use onescan_server::time::{TimeSpan, VirtualTime};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;
use toml::de::DeTable;

use super::file::{CodeFile, DisturbanceFile, FaultFile, ForceFile, ParameterFile, VariableFile};
use crate::form::{CaseName, Matrix, MutantWord, Name, Ordinal, Time, from_optional_text};

/// One `[[campaign]]`: every fault is tried with every activation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CampaignFile {
    /// Its name: letters, digits, `-`, `_` and `.`; unique, without regard to case.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// What it is about, in one line.
    pub about: Option<String>,
    /// The case to which the faults come; the scenario as it is if absent.
    #[schemars(with = "Option<String>")]
    pub case: Option<Spanned<String>>,
    /// Virtual time at which a run is complete; that of the case if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub until: Option<VirtualTime>,
    /// Lists of values by path, or `seed`: all faults and activations for each combination.
    #[serde(default)]
    #[schemars(with = "Matrix")]
    pub matrix: toml::Table,
    /// Programs that are tried beside that of the scenario: all faults and activations with each of them.
    #[serde(default)]
    #[schemars(with = "Vec<ProgramFile>")]
    pub program: Vec<Spanned<ProgramFile>>,
    /// Programs with one small mistake each, tried as those of `program` are.
    #[schemars(with = "Option<MutantsFile>")]
    pub mutants: Option<Spanned<MutantsFile>>,
    /// What fails.
    #[serde(default, rename = "fault")]
    #[schemars(with = "Vec<CampaignFaultFile>")]
    pub faults: Vec<Spanned<CampaignFaultFile>>,
    /// When it fails, and for how long.
    #[serde(default, rename = "activation")]
    #[schemars(with = "Vec<ActivationFile>")]
    pub activations: Vec<Spanned<ActivationFile>>,
    /// The signals in which a fault shows its effect; all if empty. Ranges are allowed.
    #[serde(default)]
    #[schemars(with = "Vec<Name>")]
    pub readouts: Vec<Spanned<SignalName>>,
    /// The control has detected the fault: `eventually` with a window, or `within`, from the activation on.
    #[serde(alias = "told")]
    #[schemars(with = "Option<String>")]
    pub detected: Option<Spanned<String>>,
    /// The machine is safe: a formula, from the activation on.
    #[schemars(with = "Option<String>")]
    pub safe: Option<Spanned<String>>,
    /// Something has come to harm: a formula, from the activation on.
    #[schemars(with = "Option<String>")]
    pub collision: Option<Spanned<String>>,
    /// The verdicts with which the campaign is passed; `detected`, `safe`, `no-effect` and `not-activated` if absent.
    pub accept: Option<Vec<CampaignVerdict>>,
}

/// One program of a campaign: what `[[case]]` has as `code`, with a name.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProgramFile {
    /// Its name: letters, digits, `-`, `_` and `.`.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// What it is, in one line.
    pub about: Option<String>,
    /// What is another in it than in that of the scenario.
    #[schemars(with = "Vec<CodeFile>")]
    pub code: Vec<Spanned<CodeFile>>,
}

/// The mutants of a campaign: small mistakes in the programs of its soft PLCs, as `onescan mutate` makes them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MutantsFile {
    /// The soft PLC; all if absent.
    #[schemars(with = "Option<Name>")]
    pub client: Option<Spanned<String>>,
    /// What is changed: operators, constants, conditions, statements that are left out, timers and other standard blocks;
    /// everything if empty.
    #[serde(default)]
    #[schemars(with = "Vec<MutantWord>")]
    pub kinds: Vec<Text<MutantKind>>,
    /// So many of them, drawn by `seed`; all if absent.
    #[schemars(with = "Option<Ordinal>")]
    pub each: Option<NonZeroU32>,
    /// By what they are drawn.
    #[serde(default)]
    pub seed: u64,
}

/// One fault of a campaign: exactly one of `fault`, `force`, `disturbance`, `parameter` and `variable`, without times.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CampaignFaultFile {
    /// Its name: letters, digits, `-`, `_` and `.`.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// By which method it is brought in.
    pub kind: FaultKind,
    /// What it is, in one line.
    pub about: Option<String>,
    /// A component that fails, as in `[[case.fault]]`.
    #[schemars(with = "Option<FaultFile>")]
    pub fault: Option<Spanned<FaultFile>>,
    /// A signal that is held, as in `[[case.force]]`.
    #[schemars(with = "Option<ForceFile>")]
    pub force: Option<Spanned<ForceFile>>,
    /// Signals that do not arrive as they were sent, as in `[[case.disturbance]]`.
    #[schemars(with = "Option<DisturbanceFile>")]
    pub disturbance: Option<Spanned<DisturbanceFile>>,
    /// A parameter of a plant that changes, as in `[[case.parameter]]`.
    #[schemars(with = "Option<ParameterFile>")]
    pub parameter: Option<Spanned<ParameterFile>>,
    /// A variable of a PLC that is forced, as in `[[case.variable]]`.
    #[schemars(with = "Option<VariableFile>")]
    pub variable: Option<Spanned<VariableFile>>,
}

/// Where a fault is brought in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// In the model of the machine.
    Model,
    /// In the software of the control.
    Software,
    /// In its wiring, its inputs and outputs, its links.
    Hardware,
}

impl FaultKind {
    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Software => "software",
            Self::Hardware => "hardware",
        }
    }
}

/// When the faults of a campaign come: `at` a time, or `when` a condition comes true.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ActivationFile {
    /// Its name: letters, digits, `-`, `_` and `.`.
    #[schemars(with = "CaseName")]
    pub name: Spanned<String>,
    /// What it is, in one line.
    pub about: Option<String>,
    /// At this time.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub at: Option<VirtualTime>,
    /// A condition on signals, now and in the past: in the step after it has come true.
    #[schemars(with = "Option<String>")]
    pub when: Option<Spanned<String>>,
    /// Which time that the condition comes true; the first if absent.
    #[schemars(with = "Option<Ordinal>")]
    pub nth: Option<Spanned<u32>>,
    /// From when on the condition counts.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub from: Option<VirtualTime>,
    /// How long the fault lasts; to the end if absent.
    #[serde(default, rename = "for", deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub lasting: Option<TimeSpan>,
}

/// What came of a fault. Exactly one of these holds; the first in this order counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CampaignVerdict {
    /// Its run came to no end in the time that it had, or its process was lost.
    Unfinished,
    /// Its activation did not come.
    NotActivated,
    /// A PLC stopped on a fault.
    PlcFault,
    /// The readouts are those of the run without faults.
    NoEffect,
    /// Something came to harm.
    Collision,
    /// The control detected it.
    #[serde(alias = "told")]
    Detected,
    /// The control did not detect it, but the machine was safe.
    Safe,
    /// None of these.
    Missed,
}

impl CampaignVerdict {
    /// All of them, in the order in which they count.
    pub const ALL: [Self; 8] = [
        Self::Unfinished,
        Self::NotActivated,
        Self::PlcFault,
        Self::NoEffect,
        Self::Collision,
        Self::Detected,
        Self::Safe,
        Self::Missed,
    ];

    /// As it is shown.
    pub fn word(self) -> &'static str {
        match self {
            Self::Unfinished => "unfinished",
            Self::NotActivated => "not activated",
            Self::PlcFault => "plc fault",
            Self::NoEffect => "no effect",
            Self::Collision => "collision",
            Self::Detected => "detected",
            Self::Safe => "safe",
            Self::Missed => "missed",
        }
    }
}

/// Where campaigns still have `told`, which is `detected` now: as a key, or as a verdict of `accept`. The version after
/// this one no longer reads it.
pub(super) fn old_words(root: &DeTable<'_>) -> Vec<Range<usize>> {
    const OLD: &str = "told";
    let campaigns = root.get("campaign").and_then(|list| list.get_ref().as_array());
    let tables = campaigns.into_iter().flat_map(|list| list.iter()).filter_map(|entry| entry.get_ref().as_table());
    let mut places = Vec::new();
    for table in tables {
        places.extend(table.keys().filter(|key| key.get_ref() == OLD).map(Spanned::span));
        let accepted = table.get("accept").and_then(|list| list.get_ref().as_array());
        let verdicts = accepted.into_iter().flat_map(|list| list.iter());
        places.extend(verdicts.filter(|verdict| verdict.get_ref().as_str() == Some(OLD)).map(Spanned::span));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Campaign, Catalogue};
    use crate::texts::Texts;

    #[test]
    fn an_old_word_is_read_and_has_a_place() {
        let campaign = |word: &str| {
            format!(
                "version = 1\n\n[[campaign]]\nname = \"a\"\n{word} = \"within 2s x\"\naccept = [\"safe\", \"{word}\"]\n\
                 fault = [{{ name = \"f\", kind = \"model\", force = {{ signal = \"x\", value = true }} }}]\n\
                 activation = [{{ name = \"at\", at = \"1s\" }}]\n"
            )
        };
        let places = |text: &str| {
            let texts = Texts::of("cases.toml".into(), text.to_owned());
            let places = old_words(DeTable::parse(text).unwrap().get_ref());
            places.into_iter().map(|place| texts.line_and_column(place.start)).collect::<Vec<_>>()
        };
        assert_eq!(places(&campaign("told")), ["cases.toml:5:1", "cases.toml:6:19"]);
        assert!(places(&campaign("detected")).is_empty());
        let read = |word| Catalogue::parse("cases.toml".into(), campaign(word)).unwrap().campaigns()[0].clone();
        let (old, new) = (read("told"), read("detected"));
        assert_eq!(old.accepted, new.accepted);
        let formula = |campaign: &Campaign| campaign.file.detected.as_ref().map(|formula| formula.get_ref().clone());
        assert_eq!((formula(&old), formula(&new)), (Some("within 2s x".to_owned()), Some("within 2s x".to_owned())));
    }
}
