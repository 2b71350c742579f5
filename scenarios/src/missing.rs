//! What may have been meant by a file or a folder that is not there, or that is not a scenario.

use std::path::{Path, PathBuf};

use onescan_base::{did_you_mean, nearest};

use crate::file::FILE_NAME;

/// Entries of a folder that are looked at: a folder may have millions, and this is a hint.
const ENTRIES_MAX: usize = 1000;
/// Names that a hint lists: more are not read.
const LISTED: usize = 8;
/// Endings of files that engineering tools write programs and projects into.
const OF_PLCS: [&str; 10] = ["st", "exp", "scl", "xml", "tcpou", "tcgvl", "tcdut", "plcproj", "tsproj", "project"];

/// What to do where no scenario is at `path`.
pub(crate) fn help_for_scenario(path: &Path) -> String {
    let names_folder = path.file_name().is_none_or(|name| name != FILE_NAME);
    let (folder, wanted) = match (names_folder, path.parent(), path.file_name()) {
        (true, Some(parent), Some(name)) => (parent, name.to_string_lossy().into_owned()),
        (_, parent, _) => (parent.unwrap_or(Path::new("")), String::new()),
    };
    let here = if folder == Path::new("") { Path::new(".") } else { folder };
    if names_folder && is_own_name(here, &wanted) {
        return format!("you are in `{wanted}`: leave the name out");
    }
    let found = names_in(here, |path| path.join(FILE_NAME).is_file());
    let shown = |name: &str| folder.join(name).display().to_string();
    if let Some(name) = nearest(&wanted, found.iter().map(String::as_str)) {
        return format!("did you mean `{}`?", shown(name));
    }
    let general = format!("a scenario is a folder with a `{FILE_NAME}`; give the folder");
    let found: Vec<String> = found.iter().map(|name| shown(name)).collect();
    if found.is_empty() { general } else { format!("{general}; {}", listed("here are", &found)) }
}

/// What to do with a file that is read as a scenario and is something else; nothing for one that may be a scenario.
pub(crate) fn help_for_source(path: &Path) -> Option<String> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    let shown = path.display();
    OF_PLCS.contains(&ending.as_str()).then(|| {
        format!(
            "it belongs to a PLC: `onescan check {shown}` checks it, `onescan test {shown}` runs its tests, `onescan new \
             NAME --from {shown}` makes a scenario of it"
        )
    })
}

/// What to do about a file `name` that is not in `folder`.
pub(crate) fn help_for_file(folder: &Path, name: &str) -> Option<String> {
    let within = Path::new(name).parent().unwrap_or(Path::new(""));
    let found = names_in(&folder.join(within), |_| true);
    let found: Vec<String> = found.into_iter().map(|entry| within.join(entry).display().to_string()).collect();
    let nearest = did_you_mean(name, found.iter().map(String::as_str));
    nearest.or_else(|| (!found.is_empty()).then(|| listed("there are", &found)))
}

/// True if `folder` is a scenario's and is called so itself.
fn is_own_name(folder: &Path, wanted: &str) -> bool {
    let is_called = |path: PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy() == wanted);
    folder.join(FILE_NAME).is_file() && std::path::absolute(folder).is_ok_and(is_called)
}

/// The names of what is in a folder, in order; none of what begins with a dot. A folder that cannot be read gives no hint.
fn names_in(folder: &Path, is_wanted: impl Fn(&Path) -> bool) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().take(ENTRIES_MAX).filter_map(Result::ok);
    let wanted = entries.filter(|entry| is_wanted(&entry.path()));
    let mut names: Vec<String> = wanted.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    names
}

fn listed(words: &str, names: &[String]) -> String {
    let shown = names.iter().take(LISTED).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let more = names.len().saturating_sub(LISTED);
    if more == 0 { format!("{words} {shown}") } else { format!("{words} {shown} and {more} more") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in ["press", "saw"] {
            std::fs::create_dir_all(folder.path().join(name).join("plc")).unwrap();
            std::fs::write(folder.path().join(name).join(FILE_NAME), "").unwrap();
            std::fs::write(folder.path().join(name).join("plc/main.st"), "").unwrap();
        }
        folder
    }

    #[test]
    fn a_scenario_that_is_not_there_names_those_that_are() {
        let folder = folder();
        let help = |path: &str| help_for_scenario(&folder.path().join(path));
        assert!(help("pres").starts_with("did you mean `") && help("pres").ends_with("press`?"), "{}", help("pres"));
        assert!(help(FILE_NAME).contains("press`, `") && help(FILE_NAME).ends_with("saw`"), "{}", help(FILE_NAME));
        assert_eq!(help("press/press"), "you are in `press`: leave the name out");
        assert_eq!(help("press/plc/x"), format!("a scenario is a folder with a `{FILE_NAME}`; give the folder"));
    }

    #[test]
    fn a_file_that_is_not_there_names_its_neighbours() {
        let folder = folder();
        let help = |name: &str| help_for_file(&folder.path().join("press"), name);
        assert_eq!(help("plc/mian.st").as_deref(), Some("did you mean `plc/main.st`?"));
        assert_eq!(help("plc/other.st").as_deref(), Some("there are `plc/main.st`"));
        assert_eq!(help("nowhere/main.st"), None);
    }

    #[test]
    fn what_belongs_to_a_plc_is_known_by_its_ending() {
        assert!(help_for_source(Path::new("Plc.plcproj")).is_some_and(|help| help.contains("--from Plc.plcproj")));
        assert_eq!(help_for_source(Path::new("press/variant.toml")), None);
    }
}
