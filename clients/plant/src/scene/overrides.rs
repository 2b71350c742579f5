//! Values that take the place of those in a scene's file, or of its defaults: how a case changes a
//! plant.
//!
//! They are put into the parsed document, before its form and its values are checked. So what may be
//! set, and to what, is said once, by the format itself; no text is edited, and the file is read once.

use std::ops::Range;

use onescan_base::did_you_mean;
use toml::Spanned;
use toml::de::{DeArray, DeString, DeTable, DeValue};

use super::error::SceneFaultKind;
use super::faults::Faults;

/// Tables of a scene whose entries have names.
const SECTIONS: [&str; 9] =
    ["body", "joint", "fitting", "coupling", "axis", "sensor", "component", "signal", "failure"];

/// A value for one key of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    path: String,
    /// The value as TOML writes it: documents keep numbers as text until somebody asks for them.
    value: String,
}

impl Override {
    /// The value of a key: `NAME.KEY` of a thing that has a name, `SECTION.NAME.KEY` where several
    /// sorts of things have that name, or `KEY` of the scene itself.
    pub fn new(path: impl Into<String>, value: &toml::Value) -> Self {
        Self { path: path.into(), value: value.to_string() }
    }
}

/// Where override `index` is said to stand: behind the text of the file, a byte for each.
fn span_of(index: usize, text: &str) -> Range<usize> {
    let at = text.len() + 1 + index;
    at..at + 1
}

/// Puts `overrides` into a document.
pub(super) fn apply<'i>(root: &mut DeTable<'i>, overrides: &'i [Override], faults: &mut Faults<'_>) {
    for (index, Override { path, value }) in overrides.iter().enumerate() {
        let span = span_of(index, faults.text());
        let (table, key) = match path.rsplit_once('.') {
            None => (&mut *root, path.as_str()),
            Some((owner, key)) => {
                condition_signal(root, owner, &span);
                match find(root, owner, &span, faults) {
                    Some((section, position)) => match entry(root, section, position) {
                        Some(table) => (table, key),
                        // `find` has just seen it.
                        None => continue,
                    },
                    None => continue,
                }
            }
        };
        let Some(value) = DeValue::parse(value).ok().and_then(|value| placed(value.into_inner(), &span)) else {
            let wanted = "a number, a truth value, a text or a list of these";
            faults.add(span, SceneFaultKind::Text { key: key.to_owned(), wanted });
            continue;
        };
        // The key comes along, so that an unknown one is the override's fault.
        table.remove(key);
        table.insert(Spanned::new(span.clone(), DeString::from(key.to_owned())), Spanned::new(span, value));
    }
}

/// Adds the `[[signal]]` of `signal.NAME` if there is none yet: what a signal is conditioned with can be set whether or
/// not the scene's own conditions name it. A name that is not a signal's is found with the other conditions'.
fn condition_signal<'i>(root: &mut DeTable<'i>, owner: &'i str, span: &Range<usize>) {
    let Some(signal) = owner.strip_prefix("signal.") else { return };
    if names(root).any(|(section, _, name)| section == "signal" && name == signal) {
        return;
    }
    let at = |value: DeValue<'i>| Spanned::new(span.clone(), value);
    let key = |text: &'static str| Spanned::new(span.clone(), DeString::from(text));
    let table: DeTable<'i> = [(key("name"), at(DeValue::String(DeString::from(signal))))].into_iter().collect();
    let section = root.entry(key("signal")).or_insert_with(|| at(DeValue::Array(DeArray::new())));
    if let DeValue::Array(entries) = section.get_mut() {
        entries.push(at(DeValue::Table(table)));
    }
}

/// Section and position of the entry called `owner`, or `SECTION.NAME`.
fn find(
    root: &DeTable<'_>,
    owner: &str,
    span: &Range<usize>,
    faults: &mut Faults<'_>,
) -> Option<(&'static str, usize)> {
    let named = names(root).filter(|(section, _, name)| *name == owner || format!("{section}.{name}") == owner);
    let found: Vec<_> = named.collect();
    match found[..] {
        [(section, position, _)] => Some((section, position)),
        [] => {
            let hint = did_you_mean(owner, names(root).map(|(_, _, name)| name));
            faults.add_hinted(span.clone(), SceneFaultKind::Nothing(owner.to_owned()), hint);
            None
        }
        [(one, ..), (other, ..), ..] => {
            let hint = Some(format!("write `{one}.{owner}` or `{other}.{owner}`"));
            faults.add_hinted(span.clone(), SceneFaultKind::Ambiguous { name: owner.to_owned(), one, other }, hint);
            None
        }
    }
}

fn entry<'r, 'i>(root: &'r mut DeTable<'i>, section: &str, position: usize) -> Option<&'r mut DeTable<'i>> {
    match root.get_mut(section)?.get_mut() {
        DeValue::Array(entries) => match entries.get_mut(position)?.get_mut() {
            DeValue::Table(table) => Some(table),
            _ => None,
        },
        _ => None,
    }
}

/// Section, position and name of everything in a scene that has a name.
fn names<'r>(root: &'r DeTable<'_>) -> impl Iterator<Item = (&'static str, usize, &'r str)> {
    SECTIONS.iter().flat_map(move |section| {
        let entries = root.get(*section).and_then(|entries| entries.get_ref().as_array());
        let named = entries.into_iter().flat_map(|entries| entries.iter().enumerate());
        named.filter_map(move |(position, entry)| {
            Some((*section, position, entry.get_ref().as_table()?.get("name")?.get_ref().as_str()?))
        })
    })
}

/// A value with all of it at one place; nothing for a table, which no key of a scene takes.
fn placed<'i>(value: DeValue<'i>, span: &Range<usize>) -> Option<DeValue<'i>> {
    Some(match value {
        DeValue::Table(_) => return None,
        DeValue::Array(values) => {
            let inner = values.into_iter().map(|value| placed(value.into_inner(), span));
            let placed: Option<Vec<_>> = inner.collect();
            DeValue::Array(placed?.into_iter().map(|value| Spanned::new(span.clone(), value)).collect::<DeArray<'_>>())
        }
        plain => plain,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use onescan_base::regular::Within;
    use toml::Value;

    const SCENE: &str = "version = 1\nextent_m = 5.0\n[[body]]\nname = \"base\"\nkind = \"fixed\"\nfriction = 0.5\n\
        [[component]]\nname = \"air\"\nkind = \"tank\"\nlevel_m_signal = \"Level\"\n\
        [[component]]\nname = \"base\"\nkind = \"tank\"\nlevel_m_signal = \"Other\"\n";

    fn with(path: &str, value: impl Into<Value>) -> Result<Scene, String> {
        let overrides = [Override::new(path, &value.into())];
        Scene::parse_with(SCENE, "", &overrides, &Within::anywhere()).map_err(|error| {
            let fault = &error.faults()[0];
            assert_eq!(fault.overridden, Some(0), "{fault:?}");
            format!("{}; {}", fault.kind, fault.hint.clone().unwrap_or_default())
        })
    }

    #[test]
    fn a_value_takes_the_place_of_another_or_of_the_default() {
        assert_eq!(with("extent_m", 50.0).unwrap().extent_m, 50.0);
        assert_eq!(with("substeps", 3).unwrap().substeps, 3);
        let scene = with("body.base.friction", 0.25).unwrap();
        assert_ne!(scene, Scene::parse(SCENE, "").unwrap());
        assert_eq!(scene, Scene::parse(&SCENE.replace("0.5\n", "0.25\n"), "").unwrap());
    }

    #[test]
    fn a_signal_is_conditioned_without_a_table_of_its_own() {
        let scene = with("signal.Level.delay_s", 0.5).unwrap();
        let conditioned = format!("{SCENE}[[signal]]\nname = \"Level\"\ndelay_s = 0.5\n");
        assert_eq!(scene, Scene::parse(&conditioned, "").unwrap());
        let delayed = conditioned.replace("delay_s = 0.5", "delay_s = 0.25");
        let twice = [("signal.Level.delay_s", 0.5), ("signal.Level.jitter_s", 0.1)];
        let twice = twice.map(|(path, value)| Override::new(path, &Value::from(value)));
        let scene = Scene::parse_with(&delayed, "", &twice, &Within::anywhere()).unwrap();
        assert_eq!(scene, Scene::parse(&format!("{conditioned}jitter_s = 0.1\n"), "").unwrap());
        let unknown = with("signal.Lvel.delay_s", 0.5).expect_err("refused");
        assert_eq!(unknown, "the plant neither reads nor writes a signal `Lvel`; did you mean `Level`?");
    }

    #[test]
    fn what_does_not_suit_is_the_fault_of_the_override() {
        insta::assert_snapshot!(
            [
                with("bsae.friction", 1.0),
                with("base.friction", 1.0),
                with("body.base.friction", -1.0),
                with("body.base.frction", 1.0),
                with("body.base.friction", "much"),
                with("body.base", 1.0),
            ]
            .map(|result| result.expect_err("refused"))
            .join("\n")
        );
    }
}
