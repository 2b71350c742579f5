//! Parameters and failures of a case, written into the text of a scene.
//!
//! The scene is then read like any other: what may be set, and to what, is said once, by the scene's
//! own format.

use std::fmt::Write as _;
use std::ops::Range;

use onescan_clients::plant::Scene;
use onescan_server::signal::did_you_mean;
use onescan_server::time::VirtualTime;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{FailureAt, Setting};

/// Tables of a scene whose entries have names.
const SECTIONS: [&str; 7] = ["body", "joint", "axis", "sensor", "component", "signal", "failure"];

/// A setting or a failure that does not suit the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused {
    /// What is wrong.
    pub message: String,
    /// Where it stands in `cases.toml`.
    pub place: Range<usize>,
    /// What to do.
    pub help: Option<String>,
}

/// The scene of `text`, which is in `file`, with the settings, whose paths begin with the plant's name, and the failures.
///
/// # Errors
/// A path that names nothing of the scene, a value that is not allowed.
pub fn edited(text: &str, file: &str, settings: &[&Setting], failures: &[&FailureAt]) -> Result<String, Refused> {
    let whole = written(text, settings, failures)?;
    if Scene::parse(&whole, file).is_ok() {
        return Ok(whole);
    }
    // One of them is to blame; alone it is wrong as well, unless they are wrong together.
    for setting in settings {
        judge(&written(text, &[setting], &[])?, file, &setting.place)?;
    }
    for failure in failures {
        judge(&written(text, &[], &[failure])?, file, &failure.place)?;
    }
    let last = failures.last().map(|failure| &failure.place).or(settings.last().map(|setting| &setting.place));
    judge(&whole, file, &last.cloned().unwrap_or_default())?;
    Ok(whole)
}

fn judge(text: &str, file: &str, place: &Range<usize>) -> Result<(), Refused> {
    let Err(error) = Scene::parse(text, file) else { return Ok(()) };
    let (message, help) = match error.faults().first() {
        Some(fault) => (fault.kind.to_string(), fault.hint.clone()),
        None => (error.to_string(), None),
    };
    Err(Refused { message, place: place.clone(), help })
}

/// A piece of text that takes the place of another.
struct Edit {
    at: Range<usize>,
    with: String,
}

fn written(text: &str, settings: &[&Setting], failures: &[&FailureAt]) -> Result<String, Refused> {
    // The scene has been read without the case before.
    let Ok(root) = DeTable::parse(text) else { return Ok(text.to_owned()) };
    let edits = settings.iter().map(|setting| edit(text, root.get_ref(), setting));
    let mut edits = edits.collect::<Result<Vec<_>, _>>()?;
    edits.sort_by_key(|edit| edit.at.start);
    let mut result = text.to_owned();
    for Edit { at, with } in edits.into_iter().rev() {
        result.replace_range(at, &with);
    }
    for FailureAt { component, mode, from, until, .. } in failures {
        let (component, mode) = (toml::Value::from(component.as_str()), toml::Value::from(mode.as_str()));
        // Writing to a string cannot fail.
        let _ = write!(result, "\n[[failure]]\ncomponent = {component}\nmode = {mode}\nfrom_s = {}\n", seconds(*from));
        if let Some(until) = until {
            let _ = writeln!(result, "until_s = {}", seconds(*until));
        }
    }
    Ok(result)
}

/// With all nanoseconds, so that the scene reads the same instant back.
fn seconds(t_v: VirtualTime) -> String {
    let ns = t_v.as_nanos();
    format!("{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
}

fn edit(text: &str, root: &DeTable<'_>, setting: &Setting) -> Result<Edit, Refused> {
    let path = setting.path.split_once('.').map_or("", |(_, rest)| rest);
    let Some((owner, key)) = path.rsplit_once('.') else {
        return Ok(match root.get(path) {
            Some(value) => Edit { at: value.span(), with: setting.value.to_string() },
            None => Edit { at: 0..0, with: format!("{path} = {}\n", setting.value) },
        });
    };
    let table = entry(root, owner, setting)?;
    if let Some(value) = table.get(key) {
        return Ok(Edit { at: value.span(), with: setting.value.to_string() });
    }
    let end = table.get("name").map_or(0, |name| name.span().end);
    let is_inline = text[end..].trim_start_matches([' ', '\t']).starts_with([',', '}']);
    let with = if is_inline { format!(", {key} = {}", setting.value) } else { format!("\n{key} = {}", setting.value) };
    Ok(Edit { at: end..end, with })
}

/// The entry called `owner`, or `SECTION.NAME` where several sorts of things have one name.
fn entry<'s>(root: &'s DeTable<'s>, owner: &str, setting: &Setting) -> Result<&'s DeTable<'s>, Refused> {
    let refused = |message, help| Refused { message, place: setting.place.clone(), help };
    let named = entries(root).filter(|(section, name, _)| *name == owner || format!("{section}.{name}") == owner);
    let found: Vec<_> = named.collect();
    match found[..] {
        [(_, _, table)] => Ok(table),
        [] => {
            let help = did_you_mean(owner, entries(root).map(|(_, name, _)| name));
            Err(refused(format!("the scene has nothing called `{owner}`"), help))
        }
        [(one, ..), (other, ..), ..] => {
            let help = format!("write `{one}.{owner}` or `{other}.{owner}`");
            Err(refused(format!("`{owner}` may be a {one} or a {other} of the scene"), Some(help)))
        }
    }
}

/// Section, name and table of everything in a scene that has a name.
fn entries<'s>(root: &'s DeTable<'s>) -> impl Iterator<Item = (&'static str, &'s str, &'s DeTable<'s>)> {
    SECTIONS.iter().flat_map(move |section| {
        let list = root.get(*section).and_then(|list| list.get_ref().as_array());
        let tables = list.into_iter().flatten().filter_map(|entry: &Spanned<DeValue<'s>>| entry.get_ref().as_table());
        tables.filter_map(move |table| Some((*section, table.get("name")?.get_ref().as_str()?, table)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use toml::Value;

    const SCENE: &str = "version = 1\n[[body]]\nname = \"base\"\nkind = \"fixed\"\n\
        [[component]]\nname = \"air\"\nkind = \"tank\"\n";

    fn setting(path: &str, value: impl Into<Value>) -> Setting {
        Setting { path: path.to_owned(), value: value.into(), place: 5..9 }
    }

    #[test]
    fn a_value_is_replaced_or_added() {
        let settings = [setting("plant.extent_m", 50.0), setting("plant.body.base.friction", 0.25)];
        let text = edited(SCENE, "", &settings.each_ref(), &[]).unwrap();
        assert!(text.starts_with("extent_m = 50.0\nversion = 1\n"), "{text}");
        assert!(text.contains("name = \"base\"\nfriction = 0.25\n"), "{text}");
        let again = edited(&text, "", &[&setting("plant.base.friction", 0.75)], &[]).unwrap();
        assert!(again.contains("friction = 0.75\n") && !again.contains("0.25"), "{again}");
    }

    #[test]
    fn what_does_not_suit_is_told_with_its_place() {
        let refused = edited(SCENE, "", &[&setting("plant.bsae.friction", 1.0)], &[]).unwrap_err();
        assert_eq!(refused.message, "the scene has nothing called `bsae`");
        assert_eq!((refused.help.as_deref(), refused.place), (Some("did you mean `base`?"), 5..9));
        let refused = edited(SCENE, "", &[&setting("plant.base.friction", -1.0)], &[]).unwrap_err();
        assert!(refused.message.contains("friction"), "{refused:?}");
        let failure = FailureAt {
            client: "plant".to_owned(),
            component: "air".to_owned(),
            mode: "stcuk".to_owned(),
            from: VirtualTime::ZERO,
            until: None,
            place: 1..2,
        };
        let refused = edited(SCENE, "", &[], &[&failure]).unwrap_err();
        assert!(refused.message.contains("stcuk") && refused.help.is_some(), "{refused:?}");
    }
}
