//! Where in a scenario's text something stands whose place is lost when the text is read.
//!
//! The entries of a client's table lose their places because its kind is one of its keys; a key that stands twice is reported
//! where it stands the second time.

use std::ops::Range;

use onescan_server::signal::ClientName;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The line of `key` in the mapping of client `name`.
pub(crate) fn of_mapping(root: &DeTable<'_>, name: &ClientName, key: &str) -> Option<Range<usize>> {
    let table = below(root, &["clients", name.as_str(), "gateway", "map"])?;
    table.get_key_value(key).map(|(known, value)| known.span().start..value.span().end)
}

/// What of a task is meant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfTask<'t> {
    /// The task by its name.
    pub(crate) task: &'t str,
    pub(crate) key: &'t str,
    /// One of the programs that the key lists.
    pub(crate) program: Option<&'t str>,
}

/// The value of a key of a task of client `name`; the task where it has not that key. Nothing if the task is not written there.
pub(crate) fn of_task(root: &DeTable<'_>, name: &ClientName, of: OfTask<'_>) -> Option<Range<usize>> {
    let tasks = below(root, &["clients", name.as_str()])?.get("tasks")?.get_ref().as_array()?;
    let task = tasks.iter().find(|task| text_at(task, "name") == Some(of.task))?;
    let Some(value) = task.get_ref().as_table()?.get(of.key) else { return Some(task.span()) };
    let is_meant = |entry: &&Spanned<DeValue<'_>>| {
        entry.get_ref().as_str().zip(of.program).is_some_and(|(text, program)| text.eq_ignore_ascii_case(program))
    };
    let named = value.get_ref().as_array().and_then(|programs| programs.iter().find(is_meant));
    Some(named.unwrap_or(value).span())
}

fn below<'r, 't>(root: &'r DeTable<'t>, steps: &[&str]) -> Option<&'r DeTable<'t>> {
    let mut table = root;
    for step in steps {
        table = table.get(*step)?.get_ref().as_table()?;
    }
    Some(table)
}

fn text_at<'e>(entry: &'e Spanned<DeValue<'_>>, key: &str) -> Option<&'e str> {
    entry.get_ref().as_table()?.get(key)?.get_ref().as_str()
}

/// Where a key that stands a second time at `second` stands first: in the same table above it, or as the same header.
pub(crate) fn first_of(text: &str, second: &Range<usize>) -> Option<usize> {
    let key = text.get(second.clone())?.trim();
    let own_line = text.get(..second.start)?.rfind('\n').map_or(0, |at| at + 1);
    let own = text.get(own_line..)?.lines().next()?.trim();
    let (mut first, mut at) = (None, 0);
    for line in text.get(..own_line)?.split_inclusive('\n') {
        let written = line.trim_start();
        let place = at + line.len() - written.len();
        at += line.len();
        if written.starts_with('[') && !own.starts_with('[') {
            // Another table begins, with keys of its own.
            first = None;
        }
        let is_same = if own.starts_with('[') {
            written.trim_end() == own
        } else {
            written.strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with(['=', '.']))
        };
        if is_same && first.is_none() {
            first = Some(place);
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(text: &str, key: &str) -> Option<usize> {
        let second = text.rfind(key).expect("it is there");
        first_of(text, &(second..second + key.len()))
    }

    #[test]
    fn a_key_stands_first_in_its_own_table() {
        let text = "[a]\nPush = 1\n[signals]\nPushed = 2\n Push = 3\nx = 4\nPush = 5\n";
        assert_eq!(first(text, "Push").map(|at| &text[at..at + 8]), Some("Push = 3"));
        assert_eq!(first("a = 1\n[b]\na = 2\n", "a"), None);
        let headers = "[plot]\nx = 1\n[a]\n[plot]\n";
        assert_eq!(first(headers, "plot"), Some(0));
    }

    #[test]
    fn a_task_is_found_by_its_name() {
        let text = "[clients.plc]\ntasks = [{ name = \"fast\", programs = [\"A\", \"B\"] }, { name = \"slow\", interval = \"1s\" }]\n";
        let root = DeTable::parse(text).expect("TOML");
        let plc: ClientName = ClientName::new("plc").expect("a name");
        let found =
            |task, key, program| of_task(root.get_ref(), &plc, OfTask { task, key, program }).map(|place| &text[place]);
        assert_eq!(found("fast", "programs", Some("b")), Some("\"B\""));
        assert_eq!(found("fast", "programs", Some("C")), Some("[\"A\", \"B\"]"));
        assert_eq!(found("slow", "interval", None), Some("\"1s\""));
        assert_eq!(found("slow", "single", None), Some("{ name = \"slow\", interval = \"1s\" }"));
        assert_eq!(found("none", "interval", None), None);
    }
}
