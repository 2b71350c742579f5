//! A case as one table that runs by itself: its matrix and its campaign resolved, and its entries one by one, so that
//! some of them can be left out or changed.

use std::fmt::Write as _;

use onescan_server::time::VirtualTime;
use toml::{Table, Value};

use super::file::{
    CaseFile, CodeFile, DisturbanceFile, FaultFile, ForceFile, InputFile, ParameterFile, TaskFile, VariableFile,
};
use super::{Case, Catalogue};
use crate::keys::keys_of;

/// A list of a case in which an entry stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum List {
    /// Parameters of plants and initial values of PLCs, which are set before the run.
    Set,
    /// An operator's inputs.
    Input,
    /// Components that fail.
    Fault,
    /// Signals that are held.
    Force,
    /// Signals that do not arrive as they were sent.
    Disturbance,
    /// Parameters of plants that change while it runs.
    Parameter,
    /// Variables of PLCs that are forced or written.
    Variable,
    /// Tasks of PLCs that run late.
    Task,
    /// Other programs in PLCs.
    Code,
}

/// The lists with their keys in `[[case]]` and the entries of each.
macro_rules! lists {
    ($( $list:ident $key:literal $entry:ty, )*) => {
        impl List {
            /// The key of `[[case]]` that holds it.
            pub fn key(self) -> &'static str {
                match self { $( Self::$list => $key, )* }
            }

            /// The list that a key of `[[case]]` holds, if it holds one.
            fn of(key: &str) -> Option<Self> {
                match key { $( $key => Some(Self::$list), )* _ => None }
            }

            /// The keys of its entries, in the order in which people write them; of what is set, keys are paths.
            fn keys(self) -> &'static [&'static str] {
                match self { $( Self::$list => keys_of::<$entry>(), )* }
            }
        }
    };
}

lists! {
    Set "set" toml::Table,
    Input "input" InputFile,
    Fault "fault" FaultFile,
    Force "force" ForceFile,
    Disturbance "disturbance" DisturbanceFile,
    Parameter "parameter" ParameterFile,
    Variable "variable" VariableFile,
    Task "task" TaskFile,
    Code "code" CodeFile,
}

impl List {
    /// All of them, in the order in which a case is written.
    fn all() -> impl Iterator<Item = Self> {
        keys_of::<CaseFile>().iter().filter_map(|key| Self::of(key))
    }
}

/// The tables of a case that are written as they stand, `code` and `set` not: matrices and campaigns add to those.
fn is_own(list: List) -> bool {
    !matches!(list, List::Set | List::Code)
}

/// One entry of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Where it stands.
    pub list: List,
    /// Its keys; of what is set, the path and the value.
    pub keys: Table,
}

impl Entry {
    /// The time that a key says.
    pub fn time(&self, key: &str) -> Option<VirtualTime> {
        self.keys.get(key)?.as_str()?.parse().ok()
    }

    /// From when on it can make a difference. What is set does so before the run, and what waits for a condition from
    /// when on that counts.
    pub fn begin(&self) -> VirtualTime {
        self.time("at").or_else(|| self.time("from")).unwrap_or_default()
    }
}

/// A case in pieces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Written {
    /// What it is about.
    pub about: Option<String>,
    /// Seed of all randomness, if it is not that of the scenario.
    pub seed: Option<u64>,
    /// When its run is complete, if not when the scenario says.
    pub until: Option<VirtualTime>,
    /// What is expected of it beside, and what is not.
    judged: Table,
    /// What it does, in the order of the file.
    pub entries: Vec<Entry>,
}

impl Catalogue {
    /// A case of this catalogue in pieces.
    pub fn written(&self, case: &Case) -> Written {
        let own = case.entry.and_then(|index| self.tables().cases.get(index));
        let mut written =
            Written { about: case.about.clone(), seed: case.seed, until: case.until, ..Written::default() };
        for key in ["waive", "expect"] {
            if let Some(value) = own.and_then(|own| own.get(key)) {
                written.judged.insert(key.to_owned(), value.clone());
            }
        }
        for setting in &case.settings {
            let keys = [(setting.path.clone(), setting.value.clone())].into_iter().collect();
            written.entries.push(Entry { list: List::Set, keys });
        }
        // Programs are also those of a campaign's.
        let code = case.code.iter().map(|code| Entry { list: List::Code, keys: code.get_ref().keys() });
        written.entries.extend(code);
        for list in List::all().filter(|list| is_own(*list)) {
            let entries = own.and_then(|own| own.get(list.key())?.as_array()).into_iter().flatten();
            let tables = entries.filter_map(Value::as_table).cloned();
            written.entries.extend(tables.map(|keys| Entry { list, keys }));
        }
        if let Some(injection) = &case.injection {
            let [campaign, fault, activation] = injection.place;
            let campaign = self.tables().campaigns.get(campaign);
            let part = |list: &str, index: usize| campaign?.get(list)?.as_array()?.get(index)?.as_table();
            written.entries.extend(part("fault", fault).zip(part("activation", activation)).and_then(injected));
        }
        written
    }
}

/// The fault of a campaign with the times of an activation.
fn injected((fault, activation): (&Table, &Table)) -> Option<Entry> {
    let list = List::all().find(|list| fault.contains_key(list.key()))?;
    let mut keys = fault.get(list.key())?.as_table()?.clone();
    for (key, value) in activation {
        let key = if key == "at" { "from" } else { key.as_str() };
        // the activation's name is not the fault's
        if list.keys().contains(&key) {
            keys.insert(key.to_owned(), value.clone());
        }
    }
    Some(Entry { list, keys })
}

impl Written {
    /// The same with these entries only, as a `[[case]]` called `name`.
    pub fn to_toml(&self, name: &str, entries: &[Entry]) -> String {
        let mut text = format!("[[case]]\nname = {}\n", Value::from(name));
        let about = self.about.as_ref().map(|about| ("about", Value::from(about.as_str())));
        let seed = self.seed.and_then(|seed| i64::try_from(seed).ok()).map(|seed| ("seed", Value::from(seed)));
        let until = self.until.map(|until| ("until", Value::from(to_text(until))));
        for (key, value) in [about, seed, until].into_iter().flatten() {
            line(&mut text, key, &value);
        }
        for (key, value) in &self.judged {
            line(&mut text, key, value);
        }
        for entry in entries.iter().filter(|entry| entry.list == List::Set) {
            for (path, value) in &entry.keys {
                line(&mut text, &format!("set.{}", Value::from(path.as_str())), value);
            }
        }
        for list in List::all().filter(|list| *list != List::Set) {
            let of_list: Vec<&Entry> = entries.iter().filter(|entry| entry.list == list).collect();
            if of_list.is_empty() {
                continue;
            }
            text.push_str(list.key());
            text.push_str(" = [\n");
            for entry in of_list {
                text.push_str("    { ");
                text.push_str(&inline(entry));
                text.push_str(" },\n");
            }
            text.push_str("]\n");
        }
        text
    }
}

/// A time as files have it, exactly.
pub fn to_text(t_v: VirtualTime) -> String {
    let ns = t_v.as_nanos();
    if ns.is_multiple_of(1_000_000) { format!("{}ms", ns / 1_000_000) } else { format!("{ns}ns") }
}

fn line(text: &mut String, key: &str, value: &Value) {
    // Writing to a text cannot fail.
    let _ = writeln!(text, "{key} = {value}");
}

/// The keys of an entry on one line.
fn inline(entry: &Entry) -> String {
    let known = entry.list.keys().iter().filter_map(|key| entry.keys.get_key_value(*key));
    known.map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    const CASES: &str = r#"version = 1

[[case]]
name = "worn"
about = "a \"worn\" ram"
until = "1500ms"
set.plc.Main.limit = 3
waive = ["fast"]
input = [{ at = "10ms", signal = "Start", value = true }]
[case.matrix]
seed = [1, 2]
"plant.ram.speed_m_s" = [0.25]
[[case.force]]
signal = "Level"
value = 2.5
when = "rose(Start)"
for = "200ms"
[[case.expect]]
name = "slow"
formula = "eventually Start"

[[campaign]]
name = "faults"
case = "worn,seed=2,speed_m_s=0.25"
fault = [{ name = "stuck", kind = "model", disturbance = { signal = "Start", kind = "stuck" } }]
activation = [{ name = "early", at = "1ns", for = "20ms" }]
"#;

    #[test]
    fn every_list_is_one_of_a_case_and_has_keys() {
        assert_eq!(List::all().count(), 9);
        for list in List::all().filter(|list| *list != List::Set) {
            assert!(!list.keys().is_empty(), "{list:?}");
        }
        assert_eq!(List::Input.keys(), ["signal", "value", "at"]);
        assert_eq!(List::Task.keys(), ["client", "task", "by", "from", "until", "when", "nth", "for"]);
    }

    /// What is written of a case is the case, also that of a matrix and of a campaign.
    #[test]
    fn a_case_in_pieces_is_the_case() {
        let catalogue = Catalogue::parse(PathBuf::from("cases.toml"), CASES.to_owned()).unwrap();
        let written = catalogue.written(catalogue.find("faults/stuck/early").unwrap());
        let text = written.to_toml("alone", &written.entries);
        insta::assert_snapshot!(text);
        let again = Catalogue::parse(PathBuf::from("again.toml"), format!("version = 1\n{text}")).unwrap();
        let alone = again.find("alone").unwrap();
        assert_eq!(again.written(alone).entries, written.entries);
        assert_eq!((alone.seed, alone.until), (Some(2), Some(VirtualTime::from_nanos(1_500_000_000))));
        let begins: Vec<u64> = written.entries.iter().map(|entry| entry.begin().as_nanos()).collect();
        assert_eq!(begins, [0, 0, 10_000_000, 0, 1]);
    }
}
