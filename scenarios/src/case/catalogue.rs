//! `cases.toml` read: all cases of a scenario, those of matrices one by one.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

use onescan_server::signal::did_you_mean;
use serde::Deserialize;
use toml::de::{DeTable, DeValue, Deserializer};
use toml::{Spanned, Table, Value};

use super::campaign::{self, Campaign};
use super::campaign_file::{self, CampaignFile, MutantsFile, ProgramFile};
use super::cases_file::{CasesFile, SnapshotFile, VERSION};
use super::file::CaseFile;
use super::matrix::{Axis, COMBINATIONS_MAX, combinations};
use super::{Case, DEFAULT, Setting};
use crate::arrays::{self, Wrong};
use crate::error::ScenarioError;
use crate::expectations::place_within;
use crate::permission;
use crate::texts::Texts;

/// All cases of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    texts: Texts,
    file: CasesFile,
    cases: Vec<Case>,
    campaigns: Vec<Campaign>,
    tables: Tables,
}

/// The entries of the file as tables: of a case what it does and must show, of a campaign its faults and activations. Paths that
/// are set stand in the cases themselves.
#[derive(Clone, Debug, Default)]
pub(super) struct Tables {
    pub(super) cases: Vec<Table>,
    pub(super) campaigns: Vec<Table>,
}

/// Who makes the mutants that a campaign asks for.
pub(crate) type Mutants<'m> = dyn Fn(&Spanned<MutantsFile>) -> Result<Vec<Spanned<ProgramFile>>, NoMutants> + 'm;

/// Why there are none.
pub(crate) enum NoMutants {
    /// The scenario says why.
    Scenario(ScenarioError),
    /// What is wrong with what is asked for.
    Wrong(Wrong),
}

impl From<ScenarioError> for NoMutants {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(error)
    }
}

impl Catalogue {
    /// The cases of the scenario in `scenario`, a folder or a file. Its campaigns are without their mutants, which only a
    /// [scenario](crate::Scenario::catalogue) knows.
    ///
    /// # Errors
    /// `cases.toml` cannot be read or is wrong, each with its place.
    pub fn load(scenario: &Path) -> Result<Self, ScenarioError> {
        Self::load_with(scenario, &|_| Ok(Vec::new()))
    }

    /// The same with the mutants that `mutants` makes.
    pub(crate) fn load_with(scenario: &Path, mutants: &Mutants<'_>) -> Result<Self, ScenarioError> {
        let path = super::beside(scenario)?;
        match permission::granted().read_text(path.parent().unwrap_or(Path::new("")), &path)? {
            Ok(text) => Self::parse_with(path, text, mutants),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                Ok(Self { texts: Texts::of(path, String::new()), cases: vec![default_case()], ..Self::default() })
            }
            Err(source) => Err(ScenarioError::Unreadable { path, source, help: None }),
        }
    }

    /// The cases of a text, which would stand in the file `path`.
    ///
    /// # Errors
    /// The text is wrong, with the place.
    pub fn parse(path: PathBuf, text: String) -> Result<Self, ScenarioError> {
        Self::parse_with(path, text, &|_| Ok(Vec::new()))
    }

    fn parse_with(path: PathBuf, text: String, mutants: &Mutants<'_>) -> Result<Self, ScenarioError> {
        let this = Self { texts: Texts::of(path, text), ..Self::default() };
        let form = |e: toml::de::Error| this.wrong(e.message().trim().to_owned(), e.span(), None);
        let root = DeTable::parse(this.texts.text()).map_err(form)?;
        let mut file = CasesFile::deserialize(Deserializer::from(root.clone())).map_err(form)?;
        this.expand(&mut file)?;
        if file.version != VERSION {
            let message = format!("version {} of the format of cases is not known", file.version);
            return Err(this.wrong(message, None, Some(format!("write `version = {VERSION}`"))));
        }
        for place in campaign_file::old_words(root.get_ref()) {
            let place = this.texts.line_and_column(place.start);
            tracing::warn!("{place}: `told` is called `detected` now; write that, later versions read nothing else");
        }
        let tables = Tables {
            cases: this.tables_of(root.get_ref(), "case", |key| !matches!(key, "seed" | "set" | "matrix"))?,
            campaigns: this.tables_of(root.get_ref(), "campaign", |key| matches!(key, "fault" | "activation"))?,
        };
        let places = Places { root };
        let mut seen = BTreeSet::new();
        let mut cases = Vec::new();
        for (index, entry) in file.cases.iter().enumerate() {
            for case in this.expanded(index, entry, &places)? {
                // Snapshots are files, whose names some systems compare without case.
                if !seen.insert(case.name.to_lowercase()) {
                    let message = format!("two cases are called `{}`", case.name);
                    return Err(this.wrong(message, Some(entry.get_ref().name.span()), None));
                }
                cases.push(case);
            }
        }
        if cases.is_empty() {
            cases.push(default_case());
        }
        let mut campaigns: Vec<Campaign> = Vec::new();
        for (number, entry) in file.campaigns.iter().enumerate() {
            let name = &entry.name;
            if !campaign::is_name(name.get_ref()) {
                let help = "letters, digits, `-`, `_` and `.`".to_owned();
                let message = format!("`{}` is not a name of a campaign", name.get_ref());
                return Err(this.wrong(message, Some(name.span()), Some(help)));
            }
            if campaigns.iter().any(|other| other.name.eq_ignore_ascii_case(name.get_ref())) {
                let message = format!("two campaigns are called `{}`", name.get_ref());
                return Err(this.wrong(message, Some(name.span()), None));
            }
            let base = this.base(entry, &cases)?;
            let programs = this.programs(entry, mutants)?;
            let axes = this.axes(places.leaves("campaign", number, "matrix"))?;
            let variants = this.variants(entry, base, &axes, &programs)?;
            let expanded = campaign::expanded(entry, variants, &programs, number);
            campaigns.push(expanded.map_err(|found| this.wrong(found.message, found.place, found.help))?);
        }
        Ok(Self { file, cases, campaigns, tables, ..this })
    }

    /// The case to which the faults of a campaign come.
    fn base(&self, campaign: &CampaignFile, cases: &[Case]) -> Result<Case, ScenarioError> {
        let Some(named) = &campaign.case else { return Ok(default_case()) };
        cases.iter().find(|case| case.name == *named.get_ref()).cloned().ok_or_else(|| {
            let help = did_you_mean(named.get_ref(), cases.iter().map(|case| case.name.as_str()));
            self.wrong(format!("there is no case `{}`", named.get_ref()), Some(named.span()), help)
        })
    }

    /// The programs that a campaign tries beside that of the scenario: those that are written, then the mutants.
    fn programs(
        &self,
        campaign: &CampaignFile,
        mutants: &Mutants<'_>,
    ) -> Result<Vec<Spanned<ProgramFile>>, ScenarioError> {
        let mut programs = campaign.program.clone();
        if let Some(wanted) = &campaign.mutants {
            programs.extend(mutants(wanted).map_err(|none| match none {
                NoMutants::Scenario(error) => error,
                NoMutants::Wrong(found) => self.wrong(found.message, found.place, found.help),
            })?);
        }
        Ok(programs)
    }

    /// The case to which the faults of a campaign come with each combination of its matrix, and what that adds to names.
    fn variants(
        &self,
        campaign: &CampaignFile,
        mut base: Case,
        axes: &[Axis],
        others: &[Spanned<ProgramFile>],
    ) -> Result<Vec<(String, Case)>, ScenarioError> {
        base.until = campaign.until.or(base.until);
        let Some(combinations) = combinations(axes) else {
            let message =
                format!("the matrix of `{}` has more than {COMBINATIONS_MAX} combinations", campaign.name.get_ref());
            return Err(self.wrong(message, Some(campaign.name.span()), None));
        };
        let mut programs = vec![(String::new(), Vec::new())];
        for program in others.iter().map(Spanned::get_ref) {
            programs.push((format!(",program={}", program.name.get_ref()), program.code.clone()));
        }
        let mut variants = Vec::with_capacity(combinations.len() * programs.len());
        for (suffix, settings) in combinations {
            let mut case = base.clone();
            settings.into_iter().try_for_each(|setting| self.put(&mut case, setting))?;
            for (program, code) in &programs {
                let mut changed = case.clone();
                changed.code.extend(code.iter().cloned());
                variants.push((format!("{suffix}{program}"), changed));
            }
        }
        Ok(variants)
    }

    /// Expands the arrays among the signals of snapshots.
    fn expand(&self, file: &mut CasesFile) -> Result<(), ScenarioError> {
        let mut all = Vec::new();
        for signal in &file.snapshot.signals {
            let names = arrays::names(signal.get_ref().as_str(), signal.span());
            let names = names.map_err(|found| self.wrong(found.message, found.place, found.help))?;
            all.extend(names.into_iter().map(|name| Spanned::new(signal.span(), name)));
        }
        file.snapshot.signals = all;
        Ok(())
    }

    /// The cases of one entry.
    fn expanded(
        &self,
        index: usize,
        entry: &Spanned<CaseFile>,
        places: &Places<'_>,
    ) -> Result<Vec<Case>, ScenarioError> {
        let file = entry.get_ref();
        let name = file.name.get_ref();
        if !campaign::is_name(name) {
            let help = "letters, digits, `-`, `_` and `.`: its snapshot is a file of that name".to_owned();
            return Err(self.wrong(format!("`{name}` is not a name of a case"), Some(file.name.span()), Some(help)));
        }
        let axes = self.axes(places.leaves("case", index, "matrix"))?;
        let Some(combinations) = combinations(&axes) else {
            let message = format!("the matrix of `{name}` has more than {COMBINATIONS_MAX} combinations");
            return Err(self.wrong(message, Some(file.name.span()), None));
        };
        let own: Vec<Setting> = places.leaves("case", index, "set");
        let case = |(suffix, more): (String, Vec<Setting>)| {
            let mut case = Case {
                name: format!("{name}{suffix}"),
                about: file.about.clone(),
                tags: file.tags.clone(),
                seed: file.seed,
                until: file.until,
                settings: Vec::new(),
                code: file.code.clone(),
                entry: Some(index),
                injection: None,
            };
            for setting in own.iter().cloned().chain(more) {
                self.put(&mut case, setting)?;
            }
            Ok(case)
        };
        combinations.into_iter().map(case).collect()
    }

    /// Sets a value; the seed is the session's own.
    fn put(&self, case: &mut Case, setting: Setting) -> Result<(), ScenarioError> {
        if setting.path == "seed" {
            let seed = setting.value.as_integer().and_then(|seed| u64::try_from(seed).ok());
            let wanted = || self.wrong("a seed is a whole number from 0".to_owned(), Some(setting.place.clone()), None);
            case.seed = Some(seed.ok_or_else(wanted)?);
            return Ok(());
        }
        if !setting.path.contains('.') {
            let message = format!("`{}` names nothing that can be set", setting.path);
            let help = "write the client first: `plant.ram.speed_m_s`, `plc.Main.limit`; or `seed`".to_owned();
            return Err(self.wrong(message, Some(setting.place), Some(help)));
        }
        case.settings.retain(|other| other.path != setting.path);
        case.settings.push(setting);
        Ok(())
    }

    fn axes(&self, lists: Vec<Setting>) -> Result<Vec<Axis>, ScenarioError> {
        let axis = |Setting { path, value, place }: Setting| match value {
            Value::Array(values) if !values.is_empty() => Ok(Axis { path, values, place }),
            Value::String(text) if path == "seed" => {
                if let Some(values) = range(&text) {
                    Ok(Axis { path, values, place })
                } else {
                    let message = format!("`{text}` is not a range of at most {COMBINATIONS_MAX} seeds");
                    Err(self.wrong(message, Some(place), Some("as in `seed = \"1..20\"`, with both ends".to_owned())))
                }
            }
            _ => {
                let message = format!("`{path}` of a matrix is a list of values");
                Err(self.wrong(message, Some(place), Some("as in `seed = [1, 2, 3]`".to_owned())))
            }
        };
        lists.into_iter().map(axis).collect()
    }

    /// None, of a file that is not one of cases: errors have their places there.
    pub(crate) fn without_cases(texts: Texts) -> Self {
        Self { texts, ..Self::default() }
    }

    /// One case alone, which stands in another file.
    pub(crate) fn of_lesson(path: PathBuf, text: String, entry: CaseFile, case: Case) -> Self {
        let file = CasesFile { version: VERSION, cases: vec![Spanned::new(0..0, entry)], ..CasesFile::default() };
        Self { texts: Texts::of(path, text), file, cases: vec![case], ..Self::default() }
    }

    /// Sets in all cases what `other` sets, as if it stood at `place`.
    pub(crate) fn set_of(&mut self, other: &Case, place: Range<usize>) {
        for case in &mut self.cases {
            case.seed = other.seed;
            case.settings.clone_from(&other.settings);
            case.settings.iter_mut().for_each(|setting| setting.place = place.clone());
            let of_other = other.code.iter();
            case.code = of_other.map(|code| Spanned::new(place.clone(), code.get_ref().clone())).collect();
        }
    }

    /// All cases, in the order of the file.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// All campaigns, in the order of the file.
    pub fn campaigns(&self) -> &[Campaign] {
        &self.campaigns
    }

    /// The same without the fault of a campaign.
    pub(crate) fn healthy_entry(&self, case: &Case) -> Option<&CaseFile> {
        self.file.cases.get(case.entry?).map(Spanned::get_ref)
    }

    /// What snapshots hold.
    pub fn snapshot(&self) -> &SnapshotFile {
        &self.file.snapshot
    }

    /// The case of this name, also one of a campaign, as `CAMPAIGN/FAULT/ACTIVATION`.
    pub fn find(&self, name: &str) -> Option<&Case> {
        let of_campaigns = self.campaigns.iter().flat_map(|campaign| &campaign.cases);
        self.cases.iter().chain(of_campaigns).find(|case| case.name == name)
    }

    /// What a case does, as it is written; with the fault, if it is one of a campaign.
    ///
    /// # Errors
    /// None for a case of this catalogue, which was checked when it was read.
    pub(crate) fn entry(&self, case: &Case) -> Result<Option<Cow<'_, CaseFile>>, ScenarioError> {
        let own = self.healthy_entry(case);
        let Some(injection) = &case.injection else { return Ok(own.map(Cow::Borrowed)) };
        let Some(campaign) = self.campaigns.get(injection.place[0]) else { return Ok(own.map(Cow::Borrowed)) };
        let entry = campaign.entry(own, injection);
        entry.map(|entry| Some(Cow::Owned(entry))).map_err(|found| self.wrong(found.message, found.place, found.help))
    }

    /// The entries as tables.
    pub(super) fn tables(&self) -> &Tables {
        &self.tables
    }

    /// The tables of a list with those of their keys that are wanted.
    fn tables_of(
        &self,
        root: &DeTable<'_>,
        list: &str,
        is_wanted: impl Fn(&str) -> bool,
    ) -> Result<Vec<Table>, ScenarioError> {
        let list = root.get(list).and_then(|list| list.get_ref().as_array());
        let tables = list.into_iter().flat_map(|list| list.iter()).filter_map(|entry| entry.get_ref().as_table());
        let pair = |(key, value): (&Spanned<Cow<'_, str>>, &Spanned<DeValue<'_>>)| -> Result<_, ScenarioError> {
            let no_room =
                || self.wrong(format!("`{}` has too large a number", key.get_ref()), Some(value.span()), None);
            Ok((key.get_ref().to_string(), plain(value.get_ref()).ok_or_else(no_room)?))
        };
        tables.map(|table| table.iter().filter(|(key, _)| is_wanted(key.get_ref())).map(pair).collect()).collect()
    }

    /// The file's name and text.
    pub(crate) fn source(&self) -> (String, String) {
        let path = self.texts.paths().next().map(|path| path.display().to_string());
        (path.unwrap_or_default(), self.texts.text().to_owned())
    }

    /// The place of a part of a formula.
    pub(crate) fn place_within(&self, formula: &Spanned<String>, part: &Range<usize>) -> Range<usize> {
        place_within(formula, self.texts.text(), part)
    }

    /// An error at a place of the file.
    pub fn wrong(&self, message: String, place: Option<Range<usize>>, help: Option<String>) -> ScenarioError {
        self.texts.wrong(message, place, help)
    }
}

/// The whole numbers of a range as `1..20`, with both ends; nothing if it is none, or has too many.
fn range(text: &str) -> Option<Vec<Value>> {
    let (first, last) = text.split_once("..")?;
    let (first, last): (i64, i64) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
    let count = usize::try_from(last.checked_sub(first)?).ok()?.checked_add(1)?;
    (first >= 0 && count <= COMBINATIONS_MAX).then(|| (first..=last).map(Value::Integer).collect())
}

fn default_case() -> Case {
    Case { name: DEFAULT.to_owned(), ..Case::default() }
}

/// The tables of the file with the places of all their values, which serde does not give for tables
/// of any shape.
struct Places<'t> {
    root: Spanned<DeTable<'t>>,
}

impl Places<'_> {
    /// Every value below the table `key` of an entry of a list, by its path, in the order of the file.
    fn leaves(&self, list: &str, index: usize, key: &str) -> Vec<Setting> {
        let all = self.root.get_ref().get(list);
        let table = all.and_then(|all| all.get_ref().as_array()?.get(index)?.get_ref().as_table()?.get(key));
        let mut found = Vec::new();
        if let Some(table) = table.and_then(|table| table.get_ref().as_table()) {
            gather(table, "", &mut found);
        }
        found.sort_by_key(|setting| setting.place.start);
        found
    }
}

/// The parser bounds how deep tables lie in each other.
fn gather(table: &DeTable<'_>, path: &str, found: &mut Vec<Setting>) {
    for (key, value) in table {
        let dot = if path.is_empty() { "" } else { "." };
        let path = format!("{path}{dot}{}", key.get_ref());
        match value.get_ref() {
            DeValue::Table(inner) => gather(inner, &path, found),
            leaf => {
                let place = key.span().start..value.span().end.max(key.span().end);
                found.extend(plain(leaf).map(|value| Setting { path, value, place }));
            }
        }
    }
}

/// The value without its place; none for a number that TOML has no room for.
fn plain(value: &DeValue<'_>) -> Option<Value> {
    Some(match value {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Boolean(flag) => Value::Boolean(*flag),
        DeValue::Datetime(time) => Value::Datetime(*time),
        DeValue::Integer(whole) => Value::Integer(i64::from_str_radix(whole.as_str(), whole.radix()).ok()?),
        DeValue::Float(number) => Value::Float(number.as_str().parse().ok()?),
        DeValue::Array(values) => {
            Value::Array(values.iter().map(|value| plain(value.get_ref())).collect::<Option<_>>()?)
        }
        DeValue::Table(table) => Value::Table(
            table
                .iter()
                .map(|(key, value)| Some((key.get_ref().to_string(), plain(value.get_ref())?)))
                .collect::<Option<_>>()?,
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<Case>, String> {
        let parsed = Catalogue::parse(PathBuf::from("cases.toml"), format!("version = 1\n{text}"));
        parsed.map(|catalogue| catalogue.cases).map_err(|error| error.to_string())
    }

    #[test]
    fn a_matrix_makes_cases() {
        let cases = parsed(
            "[[case]]\nname = \"wear\"\nset.plc.Main.limit = 3\n\
             [case.matrix]\nseed = [1, 2]\n\"plant.ram.speed_m_s\" = [0.25]\n",
        );
        let cases = cases.unwrap();
        assert_eq!(cases.len(), 2);
        assert_eq!(cases[1].name, "wear,seed=2,speed_m_s=0.25");
        assert_eq!(cases[1].seed, Some(2));
        let paths: Vec<_> = cases[1].settings.iter().map(|setting| setting.path.as_str()).collect();
        assert_eq!(paths, ["plc.Main.limit", "plant.ram.speed_m_s"]);
    }

    #[test]
    fn without_cases_there_is_one() {
        assert_eq!(parsed("").unwrap(), [default_case()]);
    }

    #[test]
    fn wrong_cases_are_reported() {
        let two = "[[case]]\nname = \"a\"\n[[case]]\nname = \"A\"\n";
        assert_eq!(parsed(two).unwrap_err(), "two cases are called `A`");
        assert_eq!(parsed("[[case]]\nname = \"a/b\"\n").unwrap_err(), "`a/b` is not a name of a case");
        let matrix = "[[case]]\nname = \"a\"\nmatrix.seed = 3\n";
        assert_eq!(parsed(matrix).unwrap_err(), "`seed` of a matrix is a list of values");
        assert_eq!(parsed("[[case]]\nname = \"a\"\nset.x = 3\n").unwrap_err(), "`x` names nothing that can be set");
    }
}
