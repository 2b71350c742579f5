//! A file that takes in another one: tables key by key, lists of named tables entry by entry, and everything else in the
//! place of what was there.
//!
//! For files whose values have the same types this is associative, and an empty file changes nothing.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// A file's table with all places.
pub(crate) type Tree<'t> = DeTable<'t>;

/// The key that names the entries of a list.
const NAME: &str = "name";

/// `base` with everything of `own` in it. What both state is where `own` states it.
pub(crate) fn merged<'t>(base: Tree<'t>, own: Tree<'t>) -> Tree<'t> {
    let mut all = base;
    for (key, value) in own {
        // Taken out first: a map keeps the key that it had, with its place.
        let value = match all.remove(&**key.get_ref()) {
            Some(before) => merged_value(before, value),
            None => value,
        };
        all.insert(key, value);
    }
    all
}

fn merged_value<'t>(base: Spanned<DeValue<'t>>, own: Spanned<DeValue<'t>>) -> Spanned<DeValue<'t>> {
    let place = own.span();
    let value = match (base.into_inner(), own.into_inner()) {
        (DeValue::Table(base), DeValue::Table(own)) => DeValue::Table(merged(base, own)),
        (DeValue::Array(base), DeValue::Array(own)) if are_named(&base) && are_named(&own) => {
            DeValue::Array(by_name(base, own))
        }
        (_, own) => own,
    };
    Spanned::new(place, value)
}

/// Whether all entries of a list are tables with a name. Those of an empty one are, so that an empty list is not another list.
fn are_named(list: &DeArray<'_>) -> bool {
    list.iter().all(|entry| name_of(entry).is_some())
}

fn name_of<'e>(entry: &'e Spanned<DeValue<'_>>) -> Option<&'e str> {
    entry.get_ref().as_table()?.get(NAME)?.get_ref().as_str()
}

/// The entries of `base`, each with what `own` says of it, then the other ones of `own`.
fn by_name<'t>(base: DeArray<'t>, own: DeArray<'t>) -> DeArray<'t> {
    let mut entries: Vec<_> = base.into_iter().map(|entry| (entry, false)).collect();
    let mut others = Vec::new();
    for entry in own {
        // Two of the same name in one file stay two, for whoever refuses that.
        let same = |(before, taken): &&mut (Spanned<DeValue<'_>>, bool)| !*taken && name_of(before) == name_of(&entry);
        match entries.iter_mut().find(same) {
            Some((before, taken)) => {
                let empty = Spanned::new(0..0, DeValue::Boolean(false));
                *before = merged_value(std::mem::replace(before, empty), entry);
                *taken = true;
            }
            None => others.push(entry),
        }
    }
    entries.into_iter().map(|(entry, _)| entry).chain(others).collect()
}

/// Takes out what `path` leads to; a list's entries are found by their names. False if nothing is there.
pub(crate) fn remove(table: &mut Tree<'_>, path: &[String]) -> bool {
    match path {
        [] => false,
        [last] => table.remove(last.as_str()).is_some(),
        [first, rest @ ..] => match table.get_mut(first.as_str()).map(Spanned::get_mut) {
            Some(DeValue::Table(inner)) => remove(inner, rest),
            Some(DeValue::Array(list)) => remove_entry(list, rest),
            _ => false,
        },
    }
}

fn remove_entry(list: &mut DeArray<'_>, path: &[String]) -> bool {
    let [name, rest @ ..] = path else { return false };
    let Some(index) = list.iter().position(|entry| name_of(entry) == Some(name.as_str())) else { return false };
    if !rest.is_empty() {
        return match list.get_mut(index).map(Spanned::get_mut) {
            Some(DeValue::Table(entry)) => remove(entry, rest),
            _ => false,
        };
    }
    let all = std::mem::replace(list, DeArray::new()).into_iter().enumerate();
    *list = all.filter(|(at, _)| *at != index).map(|(_, entry)| entry).collect();
    true
}

/// The same table with all places moved by `by`.
pub(crate) fn moved(table: Tree<'_>, by: usize) -> Tree<'_> {
    if by == 0 {
        return table;
    }
    let key_and_value = |(key, value): (Spanned<_>, _)| {
        let place = key.span();
        (Spanned::new(place.start + by..place.end + by, key.into_inner()), moved_value(value, by))
    };
    table.into_iter().map(key_and_value).collect()
}

fn moved_value(value: Spanned<DeValue<'_>>, by: usize) -> Spanned<DeValue<'_>> {
    let place = value.span();
    let value = match value.into_inner() {
        DeValue::Table(table) => DeValue::Table(moved(table, by)),
        DeValue::Array(list) => DeValue::Array(list.into_iter().map(|entry| moved_value(entry, by)).collect()),
        plain => plain,
    };
    Spanned::new(place.start + by..place.end + by, value)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde::Deserialize;
    use toml::de::Deserializer;

    use super::*;

    fn tree(text: &str) -> Tree<'_> {
        DeTable::parse(text).expect("TOML").into_inner()
    }

    fn values(tree: Tree<'_>) -> toml::Table {
        toml::Table::deserialize(Deserializer::from(Spanned::new(0..0, tree))).expect("values")
    }

    fn over(base: &str, own: &str) -> toml::Table {
        values(merged(tree(base), tree(own)))
    }

    /// A file with some keys of each sort: a value, a list, a table with a table in it, a list of named tables.
    fn file() -> impl Strategy<Value = String> {
        let number = || proptest::option::of(0..9_u8);
        let entry = (0..4_u8, number(), number());
        let entries = proptest::option::of(proptest::collection::vec(entry, 0..4));
        (number(), proptest::option::of(proptest::collection::vec(0..9_u8, 0..3)), number(), number(), entries)
            .prop_map(|(value, list, upper, inner, entries)| {
                let mut lines = Vec::new();
                lines.extend(value.map(|value| format!("value = {value}")));
                lines.extend(list.map(|list| format!("list = {list:?}")));
                lines.extend(upper.map(|upper| format!("table.upper = {upper}")));
                lines.extend(inner.map(|inner| format!("table.deep.inner = {inner}")));
                let mut seen = Vec::new();
                let entries = entries.map(|entries| {
                    let once = entries.into_iter().filter(|(name, ..)| {
                        let is_new = !seen.contains(name);
                        seen.push(*name);
                        is_new
                    });
                    let written = once.map(|(name, a, b)| {
                        let key = |key: &str, value: Option<u8>| value.map(|value| format!(", {key} = {value}"));
                        format!(
                            "{{ name = \"{name}\"{}{} }}",
                            key("a", a).unwrap_or_default(),
                            key("b", b).unwrap_or_default()
                        )
                    });
                    written.collect::<Vec<_>>().join(", ")
                });
                lines.extend(entries.map(|entries| format!("entry = [{entries}]")));
                lines.join("\n")
            })
    }

    proptest! {
        #[test]
        fn an_empty_file_changes_nothing(file in file()) {
            prop_assert_eq!(over(&file, ""), values(tree(&file)));
            prop_assert_eq!(over("", &file), values(tree(&file)));
            prop_assert_eq!(over(&file, &file), values(tree(&file)));
        }

        #[test]
        fn three_files_are_one_in_whatever_order_they_are_brought_together([a, b, c] in [file(), file(), file()]) {
            let first = merged(merged(tree(&a), tree(&b)), tree(&c));
            let last = merged(tree(&a), merged(tree(&b), tree(&c)));
            prop_assert_eq!(values(first), values(last));
        }

        #[test]
        fn what_is_moved_is_the_same(file in file(), by in 0..100_usize) {
            prop_assert_eq!(values(moved(tree(&file), by)), values(tree(&file)));
        }
    }

    #[test]
    fn named_tables_are_brought_together_and_other_lists_replaced() {
        let base =
            "expect = [{ name = \"a\", x = 1, y = 1 }, { name = \"b\" }]\nlook = [{ bodies = [\"b\"] }]\nl = [1, 2]\n";
        let own = "expect = [{ name = \"c\" }, { name = \"a\", x = 2 }]\nlook = [{ colour = \"red\" }]\nl = [3]\n";
        let expected = "expect = [{ name = \"a\", x = 2, y = 1 }, { name = \"b\" }, { name = \"c\" }]\n\
                        look = [{ colour = \"red\" }]\nl = [3]\n";
        assert_eq!(over(base, own), values(tree(expected)));
    }

    #[test]
    fn two_of_one_name_stay_two() {
        let twice = over("e = [{ name = \"a\", x = 1 }]", "e = [{ name = \"a\", y = 2 }, { name = \"a\", y = 3 }]");
        assert_eq!(twice, values(tree("e = [{ name = \"a\", x = 1, y = 2 }, { name = \"a\", y = 3 }]")));
    }

    #[test]
    fn tables_entries_and_what_is_in_them_can_be_taken_out() {
        let without = |path: &[&str]| {
            let mut all = tree("a = 1\nt = { b = 2, c = 3 }\ne = [{ name = \"x\", d = 4 }, { name = \"y\" }]\n");
            let path: Vec<String> = path.iter().map(|key| (*key).to_owned()).collect();
            remove(&mut all, &path).then(|| values(all))
        };
        let is = |text: &str| Some(values(tree(text)));
        assert_eq!(without(&["a"]), is("t = { b = 2, c = 3 }\ne = [{ name = \"x\", d = 4 }, { name = \"y\" }]\n"));
        assert_eq!(without(&["t", "b"]), is("a = 1\nt = { c = 3 }\ne = [{ name = \"x\", d = 4 }, { name = \"y\" }]\n"));
        assert_eq!(without(&["e", "x"]), is("a = 1\nt = { b = 2, c = 3 }\ne = [{ name = \"y\" }]\n"));
        assert_eq!(
            without(&["e", "x", "d"]),
            is("a = 1\nt = { b = 2, c = 3 }\ne = [{ name = \"x\" }, { name = \"y\" }]\n")
        );
        for nothing in [&["b"][..], &["t", "a"], &["e", "z"], &["a", "x"], &["e"], &[]] {
            assert_eq!(without(nothing).is_some(), nothing == ["e"], "{nothing:?}");
        }
    }
}
