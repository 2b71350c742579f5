//! The keys of one `[[component]]`, as they are written.

use super::arrays::{listed, numbers};
use super::error::SceneFaultKind;
use super::faults::Faults;
use super::format::ComponentTable;
use super::placed::Placed;
use super::text;
use toml::Value;

/// One `[[component]]` with its name and kind.
pub(super) struct Keys<'f> {
    pub(super) table: &'f ComponentTable,
    pub(super) name: Placed<String>,
    pub(super) kind: Placed<String>,
}

impl<'f> Keys<'f> {
    pub(super) fn of(table: &'f Placed<ComponentTable>, faults: &mut Faults<'_>) -> Option<Self> {
        let mut named = |key: &'static str| {
            let found = table.get_ref().get(key);
            match found.map(|value| (value.span(), value.get_ref())) {
                Some((span, Value::String(name))) => return Some(Placed::new(span, name.clone())),
                Some((span, _)) => {
                    faults.add(span, SceneFaultKind::Text { key: key.to_owned(), wanted: "a text" });
                }
                None => faults.add(table.span(), SceneFaultKind::Missing { whose: "component".to_owned(), key }),
            }
            None
        };
        let (name, kind) = (named("name"), named("kind"));
        Some(Self { table: table.get_ref(), name: name?, kind: kind? })
    }

    /// What stands behind a key.
    pub(super) fn get(&self, key: &str) -> Option<&'f Placed<Value>> {
        self.table.get(key)
    }

    /// The component, in faults.
    pub(super) fn whose(&self) -> String {
        format!("{} `{}`", text(&self.kind), text(&self.name))
    }

    /// A name behind a key.
    pub(super) fn text(&self, key: &str, wanted: &'static str, faults: &mut Faults<'_>) -> Option<Placed<String>> {
        let value = self.get(key)?;
        if let Value::String(name) = value.get_ref() {
            return Some(Placed::new(value.span(), name.clone()));
        }
        faults.add(value.span(), SceneFaultKind::Text { key: key.to_owned(), wanted });
        None
    }

    /// Names behind a key; all at the place of the list.
    pub(super) fn texts(&self, key: &str, faults: &mut Faults<'_>) -> Option<Vec<Placed<String>>> {
        let value = self.get(key)?;
        let named = |value: &Value| value.as_str().map(str::to_owned);
        let names = value.get_ref().as_array().and_then(|list| list.iter().map(named).collect::<Option<Vec<_>>>());
        if names.is_none() {
            faults.add(value.span(), SceneFaultKind::Text { key: key.to_owned(), wanted: "a list of names" });
        }
        let names: Vec<_> = names?.into_iter().map(|name| Placed::new(value.span(), name)).collect();
        Some(listed(&names, faults))
    }

    /// Three numbers behind a key.
    pub(super) fn triple(&self, key: &str, faults: &mut Faults<'_>) -> Option<Placed<[f64; 3]>> {
        let value = self.get(key)?;
        let triple = numbers(value.get_ref());
        if triple.is_none() {
            faults.add(value.span(), SceneFaultKind::Text { key: key.to_owned(), wanted: "three numbers" });
        }
        triple.map(|triple| Placed::new(value.span(), triple))
    }
}
